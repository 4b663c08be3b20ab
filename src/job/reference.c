#include "job/reference.h"

#include "metrics/metrics.h"
#include "metrics/pixel.h"
#include <stdlib.h>
#include <string.h>

// Sums from which the noise over all finite pixels is computed.
struct noise_sum {
    uint64_t finite;
    double squares, relative, local;
};

// Adds the variance of one channel of a pixel.
static void add_variance(struct noise_sum *sum, double variance, const struct reference *reference,
                         uint64_t pixel, int channel)
{
    double r = (double)reference->image.pixels[pixel][channel];
    double mean = (double)reference->means[pixel][channel];
    sum->squares += variance;
    sum->relative += variance / (r * r + METRICS_RELMSE_EPSILON);
    sum->local += variance / (mean * mean + METRICS_RELMSE_EPSILON);
}

static void set_noise(struct reference *out, const struct noise_sum *sum)
{
    double values = 3.0 * (double)sum->finite;
    out->halves[0] = out->halves[1] = NULL;
    out->noise_known = sum->finite > 0;
    out->reason = sum->finite > 0 ? NULL : "none of its pixels is finite";
    out->mse = sum->finite > 0 ? sum->squares / values : 0.0;
    out->relmse = sum->finite > 0 ? sum->relative / values : 0.0;
    out->local_relmse = sum->finite > 0 ? sum->local / values : 0.0;
}

static uint64_t pixel_count(const struct reference *reference)
{
    return (uint64_t)reference->image.width * reference->image.height;
}

bool reference_find_means(struct reference *out, const struct progress *progress,
                          struct arena *arena, struct err *err)
{
    const struct image *image = &out->image;
    float(*means)[3] = arena_alloc(arena, pixel_count(out), sizeof *means);
    out->means = (const float(*)[3])means;
    if (means && metrics_local_means((const float(*)[3])image->pixels, image->width, image->height,
                                     progress, means))
        return true;
    if (means && progress_should_stop(progress))
        return err_set(err, ERR_STOPPED, "stopped while the reference was evaluated");
    return err_memory(err, "the means around a reference's pixels",
                      pixel_count(out) * sizeof *means);
}

void reference_set_noise(struct reference *out, const float (*half_a)[3], const float (*half_b)[3])
{
    const float(*mean)[3] = (const float(*)[3])out->image.pixels;
    struct noise_sum sum = {0};
    for (uint64_t i = 0; i < pixel_count(out); i++) {
        if (!pixel_is_finite(mean[i]) || !pixel_is_finite(half_a[i]) || !pixel_is_finite(half_b[i]))
            continue;
        sum.finite++;
        for (int k = 0; k < 3; k++) {
            double d = 0.5 * ((double)half_a[i][k] - (double)half_b[i][k]);
            add_variance(&sum, d * d, out, i, k);
        }
    }
    set_noise(out, &sum);
    out->halves[0] = half_a;
    out->halves[1] = half_b;
}

bool reference_set_variance(struct reference *out, const char *path, const float (*variance)[3],
                            struct err *err)
{
    const float(*mean)[3] = (const float(*)[3])out->image.pixels;
    struct noise_sum sum = {0};
    for (uint64_t i = 0; i < pixel_count(out); i++) {
        if (!pixel_is_finite(mean[i]))
            continue;
        sum.finite++;
        for (int k = 0; k < 3; k++) {
            if (!(variance[i][k] >= 0 && isfinite(variance[i][k])))
                return err_set(err, ERR_INPUT,
                               "%s: pixel %u,%u: the variance is %g; expected a finite number >= 0",
                               path, (unsigned)(i % out->image.width),
                               (unsigned)(i / out->image.width), (double)variance[i][k]);
            add_variance(&sum, (double)variance[i][k], out, i, k);
        }
    }
    set_noise(out, &sum);
    return true;
}

void reference_set_even_variance(struct reference *out, double variance)
{
    const float(*mean)[3] = (const float(*)[3])out->image.pixels;
    struct noise_sum sum = {0};
    for (uint64_t i = 0; i < pixel_count(out); i++) {
        sum.finite += pixel_is_finite(mean[i]);
        for (int k = 0; k < 3 && pixel_is_finite(mean[i]); k++)
            add_variance(&sum, variance, out, i, k);
    }
    set_noise(out, &sum);
}

static const char *attribute(const char *path, struct arena *arena, const char *key)
{
    struct image_attribute *list;
    uint32_t count;
    struct err none = {0};
    if (!image_read_attributes(path, arena, &list, &count, &none))
        return NULL;
    for (uint32_t i = 0; i < count; i++)
        if (strcmp(list[i].key, key) == 0)
            return list[i].value;
    return NULL;
}

// Returns why the noise must not be estimated from the halves that the file has; NULL if it may.
// The contiguous halves of one sequence overestimate it by a factor of up to six.
static const char *distrust(const char *path, struct arena *arena)
{
    const char *spp = attribute(path, arena, "lampyris:spp");
    if (spp && strtoull(spp, NULL, 10) < 2)
        return "a picture with one sample per pixel has no halves";
    const char *halves = attribute(path, arena, "lampyris:halves");
    if (halves && strcmp(halves, "independent") != 0)
        return "its halves are not independent";
    return NULL;
}

// Sets the noise from the layer `variance`, if the file has one and all its values are valid.
// Returns false only if `progress` requests a stop.
static bool read_variance(const char *path, const struct progress *progress, struct arena *arena,
                          struct reference *out, struct err *err)
{
    const struct image_read_params params = {
        .path = path, .layer = "variance", .progress = progress};
    struct image variance;
    struct err none = {0};
    if (!image_read(&params, arena, &variance, &none)) {
        *err = none.code == ERR_STOPPED ? none : *err;
        return none.code != ERR_STOPPED;
    }
    const char *reason = distrust(path, arena);
    if (reason)
        out->reason = reason;
    else if (!reference_set_variance(out, path, (const float(*)[3])variance.pixels, &none))
        out->reason = "its layer variance has values that are negative or not finite";
    return true;
}

bool reference_read(const char *path, const struct progress *progress, struct arena *arena,
                    struct reference *out, struct err *err)
{
    static const char *const layers[2] = {"half_a", "half_b"};
    struct image halves[2];
    *out = (struct reference){.reason = "it has neither the layers half_a and half_b (--aov "
                                        "halves) nor variance (--aov variance)"};
    struct image_read_params params = {.path = path, .progress = progress};
    if (!image_read(&params, arena, &out->image, err) ||
        !reference_find_means(out, progress, arena, err))
        return false;
    for (int h = 0; h < 2; h++) {
        struct err none = {0};
        params.layer = layers[h];
        if (image_read(&params, arena, &halves[h], &none))
            continue;
        if (none.code != ERR_STOPPED)
            return read_variance(path, progress, arena, out, err);
        *err = none;
        return false;
    }
    const char *reason = distrust(path, arena);
    if (reason)
        out->reason = reason;
    else
        reference_set_noise(out, (const float(*)[3])halves[0].pixels,
                            (const float(*)[3])halves[1].pixels);
    return true;
}

bool reference_compare(const struct reference *reference, const float (*image)[3],
                       const struct progress *progress, struct reference_errors *out)
{
    const float(*truth)[3] = (const float(*)[3])reference->image.pixels;
    uint64_t pixels = pixel_count(reference);
    struct metrics m;
    if (!metrics_compare(image, truth, pixels, progress, &m))
        return false;
    *out = (struct reference_errors){
        .local_relmse =
            metrics_local_relmse(image, truth, reference->means, pixels) - reference->local_relmse,
        .relmse = m.relmse - reference->relmse,
        .mse = m.mse - reference->mse,
        .smape = m.smape,
        .psnr = m.psnr,
    };
    return true;
}

bool reference_check_size(const struct reference *reference, const char *path, const char *what,
                          uint32_t width, uint32_t height, struct err *err)
{
    const struct image *image = &reference->image;
    return (image->width == width && image->height == height) ||
           err_set(err, ERR_INPUT, "%s is %u x %u pixels, but %s is %u x %u", path, image->width,
                   image->height, what, width, height);
}
