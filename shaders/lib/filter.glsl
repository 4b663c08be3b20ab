// Where in or around its pixel a sample lies, drawn from the pixel filter.
#ifndef FILTER_GLSL
#define FILTER_GLSL

#include "lib/constants.glsl"

// In pixels, from the pixel's upper left corner; u in [0, 1)^2.
vec2 filter_position(vec2 u)
{
    return u;
}

#endif
