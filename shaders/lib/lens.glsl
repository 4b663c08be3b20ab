// Samples apertures. All functions are pure.
#ifndef LENS_GLSL
#define LENS_GLSL

#include "lib/sampling.glsl"

// Returns a uniformly distributed point of an aperture of radius 1: a disc, or a regular polygon
// whose corners are on the circle, the first one at the angle `rotation` (radians, from right to
// up).
vec2 sample_aperture(vec2 u, uint blades, float rotation)
{
    if (blades == 0u)
        return sample_disc(u);
    float scaled = u.x * float(blades);
    float blade = min(floor(scaled), float(blades) - 1.0);
    vec2 between = sample_triangle(vec2(scaled - blade, u.y));
    float start = rotation * (0.5 * INV_PI);
    return between.x * cos_sin_turns(start + blade / float(blades)) +
           between.y * cos_sin_turns(start + (blade + 1.0) / float(blades));
}

#endif
