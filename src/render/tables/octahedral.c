#include "render/tables/octahedral.h"

#include <math.h>

uint32_t encode_normal(const float n[3])
{
    // Cigolle et al. 2014, "A Survey of Efficient Representations for Independent Unit Vectors",
    // listing 1.
    float norm = fabsf(n[0]) + fabsf(n[1]) + fabsf(n[2]);
    float x = n[0] / norm, y = n[1] / norm;
    if (n[2] < 0.0f) {
        float folded = copysignf(1.0f - fabsf(y), x);
        y = copysignf(1.0f - fabsf(x), y);
        x = folded;
    }
    uint32_t high = (uint16_t)(int16_t)lrintf(y * 32767.0f);
    return high << 16 | (uint16_t)(int16_t)lrintf(x * 32767.0f);
}
