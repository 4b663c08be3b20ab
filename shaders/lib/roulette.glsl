// Ends paths without bias, by Russian roulette.
#ifndef ROULETTE_GLSL
#define ROULETTE_GLSL

#include "lib/media.glsl"
#include "lib/random.glsl"

// Replaces the pixel's number if all pixels share a random number. It is greater than every pixel's
// number.
const uint NO_PIXEL = 0xffffffffu;

// Russian roulette (Arvo and Kirk 1990): the throughput of a survivor is divided by its probability
// of survival. The probability follows from the throughput, or it is constant. With a constant
// probability, each path decides independently, or all pixels share one decision per sample number.
// In the latter case the depth at which paths end depends only on (seed, sample).
//
// Refraction into a medium of index n divides the throughput by n^2, and refraction out of it
// multiplies it by n^2. `scale` undoes the division, so that paths in glass do not end because of
// it.
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

// Returns (index here / index of the camera's medium)^2.
float roulette_scale(float ior)
{
    float ratio = ior / camera_ior();
    return RADIANCE_SCALING != 0u ? ratio * ratio : 1.0;
}

#endif
