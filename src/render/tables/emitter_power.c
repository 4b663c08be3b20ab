#include "render/tables/emitter_power.h"

#include "scene/core/affine.h"
#include "scene/core/environment.h"
#include "scene/core/light.h"
#include "scene/sky/ies.h"
#include <math.h>

double triangle_area(const struct flat_scene *flat, uint32_t id)
{
    double e[2][3], normal[3];
    flat_triangle_edges(flat, id, e);
    vec3_cross(e[0], e[1], normal);
    return 0.5 * vec3_norm(normal);
}

// Returns the area of the parallelogram that two vectors span.
static double span(const float a[3], const float b[3])
{
    double u[3], v[3], normal[3];
    vec3_widen(a, u);
    vec3_widen(b, v);
    vec3_cross(u, v, normal);
    return vec3_norm(normal);
}

double shape_area(const struct flat_shape *shape)
{
    const float(*axes)[3] = shape->axes;
    double radius = (double)shape->radius, disc = M_PI * radius * radius;
    double axis[3];
    vec3_widen(axes[0], axis);
    double half = vec3_length(axis);
    switch (shape->kind) {
    case SHAPE_SPHERE:
        return 4.0 * disc;
    case SHAPE_DISC:
        return disc;
    case SHAPE_QUAD:
        return 4.0 * span(axes[0], axes[1]);
    case SHAPE_BOX:
        return 8.0 * (span(axes[0], axes[1]) + span(axes[1], axes[2]) + span(axes[2], axes[0]));
    case SHAPE_CYLINDER:
        return 4.0 * M_PI * radius * half + 2.0 * disc;
    case SHAPE_TUBE:
        return 4.0 * M_PI * radius * half;
    default:
        return 0.0;
    }
}

bool has_planes(const struct flat_scene *flat)
{
    for (uint32_t i = 0; i < flat->shape_count; i++)
        if (flat->shapes[i].kind == SHAPE_PLANE)
            return true;
    return false;
}

double bounding_radius(const struct flat_scene *flat)
{
    double square = 0.0;
    // Without bounds, because the scene has only planes, a radius of one metre is assumed.
    if (!(flat->bounds_min[0] <= flat->bounds_max[0]) && has_planes(flat))
        return 1.0;
    for (int c = 0; c < 3; c++) {
        double extent = (double)flat->bounds_max[c] - (double)flat->bounds_min[c];
        square += extent > 0.0 ? extent * extent : 0.0;
    }
    return 0.5 * sqrt(square);
}

static double profile_solid_angle(const struct light *light)
{
    return light->profile ? light->profile->solid_angle : 4.0 * M_PI;
}

struct light flat_light(const struct flat_scene *flat, const struct light *light)
{
    struct light placed = *light;
    if (light->kind == LIGHT_DIRECTIONAL)
        return placed;
    flat_from_world(flat, light->position, placed.position);
    for (int c = 0; c < 3; c++)
        placed.radiant[c] = (float)((double)light->radiant[c] * flat->scale * flat->scale);
    placed.range = (float)((double)light->range * flat->scale);
    return placed;
}

double light_power(const struct light *light, const struct flat_scene *flat)
{
    double radius = bounding_radius(flat), brightness = luminance(light->radiant) / (2.0 * M_PI);
    switch (light->kind) {
    case LIGHT_DIRECTIONAL:
        return brightness * M_PI * radius * radius;
    case LIGHT_SPOT:
        // With a photometric profile, the solid angle is at most the smaller of cone and profile.
        return brightness * fmin(spot_solid_angle(light), profile_solid_angle(light));
    default:
        return brightness * profile_solid_angle(light);
    }
}

double environment_power(const struct environment *environment, double floor,
                         const struct flat_scene *flat)
{
    double radius = bounding_radius(flat);
    return 2.0 * M_PI * radius * radius * environment_luminance_above(environment, floor);
}
