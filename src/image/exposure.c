// Computes an exposure for an image from its luminances.
#include "image/image.h"

#include "base/maths.h"
#include <math.h>

// A histogram of log2 of the luminance, so that the result does not depend on the order of the
// pixels. Its steps of 1/64 stop are not visible, and it covers the range of floats.
#define STEPS 64
#define STOPS_MIN (-150)
#define STOPS_MAX 131 // the weighted sum of three floats is below 2^128
#define BINS ((STOPS_MAX - STOPS_MIN) * STEPS)

#define LEAVES_OUT 20 // one in this many pixels may be brighter than WHITE
#define WHITE 0.5     // fraction of the display's maximum; leaves one stop for highlights

static uint64_t count_luminances(const struct image *image, uint64_t *bins)
{
    uint64_t pixels = (uint64_t)image->width * image->height, count = 0;
    for (uint64_t i = 0; i < pixels; i++) {
        double light = luminance(image->pixels[i]);
        if (!(light > 0) || isinf(light))
            continue;
        double bin = floor((log2(light) - STOPS_MIN) * STEPS);
        bins[(size_t)fmin(fmax(bin, 0), BINS - 1)]++;
        count++;
    }
    return count;
}

float image_measure_exposure(const struct image *image)
{
    uint64_t bins[BINS] = {0};
    uint64_t count = count_luminances(image, bins), above = 0, most = count / LEAVES_OUT;
    size_t bin = BINS;
    while (bin > 0 && above + bins[bin - 1] <= most)
        above += bins[--bin];
    return bin > 0 ? (float)(log2(WHITE) - (STOPS_MIN + (double)bin / STEPS)) : 0.0f;
}
