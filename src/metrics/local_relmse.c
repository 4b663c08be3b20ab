// The local relMSE of an image with a reference.
#include "metrics/local_mean.h"
#include "metrics/metrics.h"
#include "metrics/pixel.h"
#include <math.h>

static void load_reference(const void *context, uint64_t pixel, struct local_pixel *out)
{
    const float(*reference)[3] = context;
    if (!pixel_is_finite(reference[pixel]))
        return;
    for (int c = 0; c < 3; c++)
        out->mean[c] = reference[pixel][c];
    out->part = 1;
}

bool metrics_local_means(const float (*reference)[3], uint32_t width, uint32_t height,
                         const struct progress *progress, float (*out)[3])
{
    struct local_window window;
    bool ok = local_window_init(&window, width, height, load_reference, reference);
    if (ok)
        local_window_start(&window, 0);
    for (uint32_t y = 0; ok && y < height; y++) {
        ok = !progress_should_stop(progress);
        local_window_enter(&window, y);
        for (uint32_t x = 0; x < width; x++) {
            uint64_t i = (uint64_t)y * width + x;
            struct local_mean around;
            local_mean_at(&window, x, &around);
            for (int c = 0; c < 3; c++)
                out[i][c] =
                    (float)(around.own * reference[i][c] + (1 - around.own) * around.mean[c]);
        }
    }
    local_window_finish(&window);
    return ok;
}

double metrics_local_relmse(const float (*image)[3], const float (*reference)[3],
                            const float (*means)[3], uint64_t pixel_count)
{
    double sum = 0;
    uint64_t finite = 0;
    for (uint64_t i = 0; i < pixel_count; i++) {
        if (!pixel_is_finite(image[i]) || !pixel_is_finite(reference[i]))
            continue;
        finite++;
        for (int c = 0; c < 3; c++) {
            double mean = means[i][c], difference = (double)image[i][c] - reference[i][c];
            sum += difference * difference / (mean * mean + METRICS_RELMSE_EPSILON);
        }
    }
    return finite > 0 ? sum / (3 * (double)finite) : NAN;
}
