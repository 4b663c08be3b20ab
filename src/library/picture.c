// Reads pictures from files, and compares them.
#include "library/library.h"

#include "image/image.h"
#include "metrics/metrics.h"
#include "metrics/perceptual.h"
#include <stdlib.h>

struct lampyris_picture {
    struct lampyris_context *context;
    struct arena arena;
    struct image image;
};

void lampyris_picture_release(struct lampyris_picture *picture)
{
    if (!picture)
        return;
    struct lampyris_context *context = picture->context;
    arena_finish(&picture->arena);
    free(picture);
    library_unref(context);
}

enum lampyris_status lampyris_picture_load(struct lampyris_context *context, const char *path,
                                           const char *layer, struct lampyris_picture **out)
{
    *out = NULL;
    if (!library_enter(context))
        return LAMPYRIS_INPUT;
    struct lampyris_picture *picture = calloc(1, sizeof *picture);
    if (!picture)
        return library_leave(context, err_memory(&context->err, "a picture", sizeof *picture));
    picture->context = context;
    context->refs++;
    const struct image_read_params params = {.path = path, .layer = layer};
    bool ok = image_read(&params, &picture->arena, &picture->image, &context->err);
    if (!ok)
        err_locate(&context->err, path, "");
    enum lampyris_status status = library_leave(context, ok);
    *out = ok ? picture : NULL;
    if (!ok)
        lampyris_picture_release(picture);
    return status;
}

const float *lampyris_picture_pixels(const struct lampyris_picture *picture, uint32_t *width,
                                     uint32_t *height)
{
    *width = picture->image.width;
    *height = picture->image.height;
    return &picture->image.pixels[0][0];
}

// --- comparison ----------------------------------------------------------------------------------

static struct lampyris_interval interval_of(struct interval interval)
{
    // The error cannot be negative, so its interval is clamped at 0.
    double low = interval.low < 0 ? 0 : interval.low;
    return (struct lampyris_interval){interval.value, low, interval.high};
}

static bool measure(const struct picture_pair *pair, struct arena *scratch,
                    struct lampyris_metrics *out, struct err *err)
{
    uint64_t count = (uint64_t)pair->width * pair->height;
    float(*means)[3] = arena_alloc(scratch, count, sizeof *means);
    struct metrics m;
    struct error_intervals intervals;
    struct flip_exposures exposures;
    if (!means || !metrics_local_means(pair->reference, pair->width, pair->height, NULL, means) ||
        !metrics_compare(pair->image, pair->reference, count, NULL, &m) ||
        !metrics_intervals(pair->image, pair->reference, (const float(*)[3])means, pair->width,
                           pair->height, NULL, &intervals) ||
        !metrics_ssim(pair, NULL, &out->ssim) ||
        !metrics_flip(pair, FLIP_PIXELS_PER_DEGREE, NULL, NULL, &out->flip) ||
        !metrics_flip_exposures(pair, NULL, &exposures) ||
        !metrics_flip_hdr(pair, FLIP_PIXELS_PER_DEGREE, &exposures, NULL, NULL, &out->hdr_flip))
        return err_memory(err, "a comparison", count * sizeof *means);
    out->mse = interval_of(intervals.mse);
    out->relmse = interval_of(intervals.relmse);
    out->local_relmse = interval_of(intervals.local_relmse);
    out->mse.value = m.mse;
    out->relmse.value = m.relmse;
    out->smape = m.smape;
    out->psnr = m.psnr;
    out->max = m.max;
    out->pixels_nonfinite = m.nonfinite;
    out->pixels_differing = m.differing;
    return true;
}

static bool compare(const float *picture, const float *reference, uint32_t width, uint32_t height,
                    struct lampyris_metrics *out, struct err *err)
{
    struct arena scratch = {0};
    struct lampyris_metrics metrics = {0};
    const struct picture_pair pair = {
        .image = (const float(*)[3])picture,
        .reference = (const float(*)[3])reference,
        .width = width,
        .height = height,
    };
    if (width == 0 || height == 0 || (uint64_t)width * height > SETTINGS_PIXELS_MAX)
        return err_set(err, ERR_USAGE, "pictures of %u x %u pixels; expected 1 to %llu pixels",
                       width, height, (unsigned long long)SETTINGS_PIXELS_MAX);
    bool ok = measure(&pair, &scratch, &metrics, err);
    arena_finish(&scratch);
    return ok && library_give(out, &metrics, sizeof metrics, err);
}

enum lampyris_status lampyris_compare(struct lampyris_context *context, const float *picture,
                                      const float *reference, uint32_t width, uint32_t height,
                                      struct lampyris_metrics *out)
{
    if (!library_enter(context))
        return LAMPYRIS_INPUT;
    return library_leave(context, compare(picture, reference, width, height, out, &context->err));
}
