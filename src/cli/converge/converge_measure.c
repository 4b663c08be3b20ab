// Measures an image for `lampyris converge`.
#include "cli/converge/converge.h"

#include "metrics/perceptual.h"
#include <math.h>
#include <string.h>

// SSIM and FLIP take 1.3 us per pixel on one processor. On a CPU this is about the time of one
// sample, but on a GPU that of a hundred samples. Images with at most this many pixels are measured
// in every replicate, in a tenth of a second each.
#define PERCEPTION_PIXELS (256u * 256u)

// Compares an image with the reference. Returns false if there is no memory for the perceptual
// metrics. If the comparison was stopped, some metrics remain NAN and the replicate does not count.
static bool compare(const struct reference *reference, const struct film_image *film,
                    bool with_perception, const struct progress *progress,
                    double metric[CONVERGE_METRICS], struct err *err)
{
    const float(*image)[3] = (const float(*)[3])film->mean;
    const float(*truth)[3] = (const float(*)[3])reference->image.pixels;
    struct reference_errors errors;
    if (!reference_compare(reference, image, progress, &errors))
        return true;
    metric[CONVERGE_LOCAL_RELMSE] = errors.local_relmse;
    metric[CONVERGE_RELMSE] = errors.relmse;
    metric[CONVERGE_MSE] = errors.mse;
    metric[CONVERGE_SMAPE] = errors.smape;
    metric[CONVERGE_PSNR] = errors.psnr;
    const struct picture_pair pair = {image, truth, film->width, film->height};
    return !with_perception ||
           (metrics_ssim(&pair, progress, &metric[CONVERGE_SSIM]) &&
            metrics_flip(&pair, FLIP_PIXELS_PER_DEGREE, progress, NULL, &metric[CONVERGE_FLIP])) ||
           progress_should_stop(progress) ||
           err_memory(err, "SSIM and FLIP", metrics_flip_bytes(film->width, film->height));
}

// Estimates the error from the half-buffers if there is no reference, as in the summary of a
// render. For relMSE this gives only a bound.
static bool estimate(struct job *job, struct converge_sample *sample, struct err *err)
{
    if (!job_judge_film(job, err))
        return false;
    sample->metric[CONVERGE_LOCAL_RELMSE] = job->error.local_relmse;
    sample->metric[CONVERGE_MSE] = job->error.mse;
    if (job->error.bounded)
        sample->at_most = job->error.at_most;
    return true;
}

static bool keep_picture(struct converge *c, struct converge_curve *curve, uint32_t replicate,
                         const struct film_image *film, struct err *err)
{
    uint64_t pixels = (uint64_t)film->width * film->height;
    float(*kept)[3] = arena_alloc(&c->arena, pixels, sizeof *kept);
    if (!kept)
        return err_memory(err, "a picture", pixels * sizeof *kept);
    memcpy(kept, film->mean, pixels * sizeof *kept);
    curve->pictures[replicate] = kept;
    return true;
}

bool converge_measure_point(struct converge *c, struct converge_curve *curve, uint32_t replicate,
                            uint32_t point, struct err *err)
{
    struct job *job = &curve->job;
    struct converge_sample *sample = converge_at(c, curve, replicate, point);
    const struct converge_reference *reference = &c->references[curve->variant.scene];
    for (int m = 0; m < CONVERGE_METRICS; m++)
        sample->metric[m] = NAN;
    sample->at_most = NAN;
    bool ok = job_fetch_film(job, err);
    if (ok && reference->name)
        ok = compare(&reference->picture, &job->film, replicate == 0 || converge_is_small(curve),
                     &c->progress, sample->metric, err);
    else if (ok)
        ok = estimate(job, sample, err);
    if (ok && point + 1 == c->point_count)
        ok = converge_split_error(c, curve, replicate, err);
    // The mean of the images of all replicates shows the bias, so the images are kept.
    bool is_needed = reference->name || replicate == 0 || c->options->converge.images;
    if (ok && point + 1 == c->point_count && is_needed)
        ok = keep_picture(c, curve, replicate, &job->film, err);
    return ok;
}

bool converge_is_small(const struct converge_curve *curve)
{
    const struct settings *settings = &curve->scene_data.settings;
    return (uint64_t)settings->width * settings->height <= PERCEPTION_PIXELS;
}
