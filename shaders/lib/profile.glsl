// Evaluates photometric profiles: the relative intensity of a light by direction (scene/sky/ies.h).
// Reads the materials' buffer. A profile begins with a uvec4 word that has the numbers of vertical
// and horizontal angles. The angles in degrees and the rows of values follow, four in a word.
#ifndef PROFILE_GLSL
#define PROFILE_GLSL

#include "lib/angle.glsl"
#include "lib/material.glsl"

float load_profile_value(uint at, uint index)
{
    return load_materials_float(at + 1u + (index >> 2u))[index & 3u];
}

// Returns the index of the greatest of the first count - 1 ascending values, from `first` on, that
// is at most x; 0 if none is. `part` is the position of x between this value and the next, in
// [0, 1].
uint find_interval(uint at, uint first, uint count, float x, out float part)
{
    uint low = 0u;
    uint high = count - 1u;
    while (low + 1u < high) {
        uint middle = (low + high) / 2u;
        if (load_profile_value(at, first + middle) <= x)
            low = middle;
        else
            high = middle;
    }
    float a = load_profile_value(at, first + low);
    float b = load_profile_value(at, first + high);
    part = b > a ? clamp((x - a) / (b - a), 0.0, 1.0) : 0.0;
    return low;
}

float profile_row(uint at, uint first, uint v, uint next, float part)
{
    float low = load_profile_value(at, first + v);
    return low + part * (load_profile_value(at, first + next) - low);
}

// Returns the relative intensity in the unit direction `from_light`. `axis` is the direction with
// vertical angle 0; the half-plane with horizontal angle 0 contains x. Horizontal angles increase
// counter-clockwise as seen against the axis.
float profile_intensity(uint at, vec3 axis, vec3 x, vec3 from_light)
{
    uvec4 head = load_materials(at);
    uint vertical_count = head.x;
    uint horizontal_count = head.y;
    vec3 y = cross(x, axis);
    vec2 across = vec2(dot(from_light, x), dot(from_light, y));
    float vertical = 360.0 * atan_turns(length(across), dot(from_light, axis));
    // Rounding must not exclude angles at the ends of the range.
    float first = load_profile_value(at, 0u);
    float last = load_profile_value(at, vertical_count - 1u);
    const float margin = 2e-4;
    if (vertical < first - margin || vertical > last + margin)
        return 0.0;

    float part_v;
    uint v = find_interval(at, 0u, vertical_count, vertical, part_v);
    uint next_v = min(v + 1u, vertical_count - 1u);
    uint rows = vertical_count + horizontal_count;
    if (horizontal_count == 1u)
        return profile_row(at, rows, v, next_v, part_v);
    float horizontal = 360.0 * atan_turns(across.y, across.x);
    horizontal += horizontal < 0.0 ? 360.0 : 0.0;
    float part_h;
    uint h = find_interval(at, vertical_count, horizontal_count, horizontal, part_h);
    float low = profile_row(at, rows + h * vertical_count, v, next_v, part_v);
    float high = profile_row(at, rows + (h + 1u) * vertical_count, v, next_v, part_v);
    return low + part_h * (high - low);
}

#endif
