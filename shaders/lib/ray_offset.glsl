// Computes ray origins that cannot be on the wrong side of the surface they leave. All functions
// are pure.
#ifndef RAY_OFFSET_GLSL
#define RAY_OFFSET_GLSL

#include "lib/constants.glsl"

// Returns the neighbouring floats in the direction of `sign_of`, by component; components with sign
// 0 are unchanged. The neighbour of zero is the smallest normal number, because devices may flush
// subnormal numbers.
vec3 next_float_towards(vec3 value, vec3 sign_of)
{
    ivec3 bits = floatBitsToInt(value);
    ivec3 upwards = ivec3(greaterThanEqual(bits, ivec3(0))) * 2 - 1; // the step that increases the
                                                                     // value
    vec3 stepped = intBitsToFloat(bits + upwards * ivec3(sign(sign_of)));
    const float smallest_normal = 1.17549435e-38;
    return mix(stepped, sign(sign_of) * smallest_normal, equal(value, vec3(0.0)));
}

// Moves `point`, which is known to within +-error per component, along the unit geometric normal
// until no point of the error box is on the wrong side, and rounds away from the surface. `side` is
// any vector to the side on which the ray leaves (Pharr, Jakob, Humphreys 2023, section 6.8.6).
vec3 offset_origin(vec3 point, vec3 error, vec3 normal, vec3 side)
{
    vec3 n = dot(side, normal) < 0.0 ? -normal : normal;
    vec3 offset = dot(abs(n), error) * n;
    return next_float_towards(point + offset, offset);
}

#endif
