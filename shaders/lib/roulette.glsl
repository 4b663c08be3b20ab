// Ending paths without bias.
#ifndef ROULETTE_GLSL
#define ROULETTE_GLSL

#include "lib/media.glsl"

// Russian roulette by throughput: survivors carry those who are ended (Arvo and Kirk 1990).
// Refraction into a medium of index n divides the throughput by n^2, and leaving it brings that back:
// `scale` undoes it here, so that paths inside of glass do not end for it.
bool survives_roulette(inout vec3 throughput, float scale, float u)
{
    if (!HAS(FEATURE_ROULETTE) || push.bounce < frame.roulette_min_bounces)
        return true;
    float survival =
        min(1.0, max(throughput.r, max(throughput.g, throughput.b)) * scale);
    throughput /= survival;
    return u < survival;
}

// (n / n of the camera's medium)^2
float roulette_scale(float ior)
{
    float ratio = ior / uintBitsToFloat(load_materials(1u).y);
    return ratio * ratio;
}

#endif
