// Ending paths without bias.
#ifndef ROULETTE_GLSL
#define ROULETTE_GLSL

#include "lib/media.glsl"
#include "lib/random.glsl"

// Takes the place of the pixel's number where all pixels share a random number. Every pixel's
// number is less.
const uint NO_PIXEL = 0xffffffffu;

// Russian roulette (Arvo and Kirk 1990): a survivor's throughput is divided by its probability to
// survive, which follows from the throughput or is constant, for each path by itself or for all
// pixels of a sample number at once. Their common depth depends on (seed, sample) alone.
//
// Refraction into a medium of index n divides the throughput by n^2, and refraction out of it
// multiplies it by n^2: `scale` undoes the division here, so that it does not end paths in glass.
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
