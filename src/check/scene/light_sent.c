// Computes in double precision the light of delta lights and suns at a place. lib/light.glsl and
// lib/profile.glsl compute it in single precision.
#include "check/scene/survey.h"

#include "base/maths.h"
#include "scene/core/light.h"
#include "scene/sky/ies.h"
#include "shared/types.h"

// Returns the index of the greatest of the first count - 1 ascending values that is at most x.
// *part receives the relative position of x between this value and the next.
static uint32_t find_interval(const float *values, uint32_t count, double x, double *part)
{
    uint32_t at = 0;
    while (at + 2 < count && (double)values[at + 1] <= x)
        at++;
    double a = (double)values[at], b = at + 1 < count ? (double)values[at + 1] : a;
    *part = b > a ? fmin(fmax((x - a) / (b - a), 0.0), 1.0) : 0.0;
    return at;
}

static double row_at(const float *row, uint32_t at, uint32_t next, double part)
{
    return (1.0 - part) * (double)row[at] + part * (double)row[next];
}

// Returns the light's photometric profile in a unit direction, relative to its greatest intensity.
static double profile_part(const struct light *light, const double way[3])
{
    const struct light_profile *profile = light->profile;
    uint32_t count = profile->vertical_count;
    double y[3], part, part_h;
    vec3_cross(light->profile_x, light->direction, y);
    double across[2] = {vec3_dot(way, light->profile_x), vec3_dot(way, y)};
    double vertical = atan2(hypot(across[0], across[1]), vec3_dot(way, light->direction)) / DEGREE;
    if (vertical < (double)profile->vertical[0] || vertical > (double)profile->vertical[count - 1])
        return 0.0;
    uint32_t v = find_interval(profile->vertical, count, vertical, &part);
    uint32_t next = v + 1 < count ? v + 1 : v;
    if (profile->horizontal_count == 1)
        return row_at(profile->relative, v, next, part);
    double horizontal = atan2(across[1], across[0]) / DEGREE;
    horizontal += horizontal < 0.0 ? 360.0 : 0.0;
    uint32_t h = find_interval(profile->horizontal, profile->horizontal_count, horizontal, &part_h);
    const float *row = &profile->relative[(size_t)h * count];
    return (1.0 - part_h) * row_at(row, v, next, part) +
           part_h * row_at(row + count, v, next, part);
}

// Returns the factor of a spot light's cone (KHR_lights_punctual, "Inner and Outer Cone Angles").
static double cone_part(const struct light *light, double cosine)
{
    double inside = versine((double)light->outer_angle) - (1.0 - cosine);
    double falloff = fmin(fmax(inside / spot_width(light), 0.0), 1.0);
    return falloff * falloff;
}

double light_sent(const struct light *light, const double place[3], double towards[3])
{
    double way[3], radiant = luminance(light->radiant);
    if (light->kind == LIGHT_DIRECTIONAL) {
        for (int c = 0; c < 3; c++)
            towards[c] = -light->direction[c];
        return radiant;
    }
    vec3_subtract(place, light->position, way);
    double distance = vec3_length(way), part = distance / (double)light->range;
    if (!vec3_normalize(way) || part >= 1.0)
        return 0.0;
    for (int c = 0; c < 3; c++)
        towards[c] = -way[c];
    radiant *= (1.0 - part * part * part * part) / (distance * distance);
    if (light->kind == LIGHT_SPOT)
        radiant *= cone_part(light, vec3_dot(way, light->direction));
    return light->profile ? radiant * profile_part(light, way) : radiant;
}
