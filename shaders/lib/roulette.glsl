// Ending paths without bias.
#ifndef ROULETTE_GLSL
#define ROULETTE_GLSL

#include "lib/media.glsl"
#include "lib/random.glsl"

// Stands for a pixel's number, which is less, where all pixels share a random number.
const uint NO_PIXEL = 0xffffffffu;

// Russian roulette: survivors carry those who are ended (Arvo and Kirk 1990), by throughput, with
// one probability for all, or with one depth for all pixels of a sample number. That depth is
// geometric, drawn by a chance a bounce from (seed, sample) alone.
//
// Refraction into a medium of index n divides the throughput by n^2, and leaving it brings that
// back: `scale` undoes it here, so that paths inside of glass do not end for it.
bool survives_roulette(uint slot, inout vec3 throughput, float scale, float u)
{
    if (!HAS(FEATURE_ROULETTE) || ROULETTE == ROULETTE_OFF ||
        push.bounce < frame.roulette_min_bounces)
        return true;
    float survival = frame.roulette_survival;
    if (ROULETTE == ROULETTE_THROUGHPUT)
        survival = min(1.0, ROULETTE_FACTOR * scale *
                                max(throughput.r, max(throughput.g, throughput.b)));
    if (ROULETTE == ROULETTE_FRAME)
        u = random_4d(frame.seed, NO_PIXEL, slot_sample(slot),
                      bounce_dimension(push.bounce, DIMENSION_LIGHT)).w;
    throughput /= survival;
    return u < survival;
}

// (n / n of the camera's medium)^2
float roulette_scale(float ior)
{
    float ratio = ior / camera_ior();
    return RADIANCE_SCALING != 0u ? ratio * ratio : 1.0;
}

#endif
