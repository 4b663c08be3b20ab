// Chooses the arrays' origin if the objects of a scene are too far apart for single precision, and
// reports objects that are too far from it.
//
// A position at distance d from the origin has an error of up to 2^-24 d. A camera at the origin
// sees this error at an angle of at most 2^-24, whatever d is: far less than a pixel. So the origin
// is moved to the camera if objects differ so much in size and position that the centre of the
// scene is unsuitable. The form of small, distant objects is then wrong, but they are too small for
// the camera to resolve.
#include "flatten/flatten_precision.h"

#include "base/log.h"
#include "scene/core/affine.h"
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

// --- the origin ----------------------------------------------------------------------------------

// The origin follows the camera if the ratio of a visible object's coordinates to its size or
// distance, whichever is larger, exceeds this. Rounding then moves the object by more than 2^-24 *
// 2^12 of that length: a tenth of a pixel if the object fills an image of 800 pixels, as in
// render/far_camera.c.
#define FOLLOW_RATIO 4096.0

// The object with the smallest `scale`, which is the greater of the object's size and its distance
// from the camera; and the point of its box that is nearest to the camera.
struct nearest {
    double scale;
    double point[3];
};

static void look_at_box(const struct camera *camera, const double low[3], const double high[3],
                        struct nearest *nearest)
{
    double point[3], way[3], extent = 0;
    for (int i = 0; i < 3; i++) {
        point[i] = fmin(fmax(camera->position[i], low[i]), high[i]);
        extent = fmax(extent, high[i] - low[i]);
    }
    vec3_subtract(point, camera->position, way);
    double scale = fmax(extent, vec3_length(way));
    if (!(extent > 0) || !(scale < nearest->scale))
        return;
    nearest->scale = scale;
    memcpy(nearest->point, point, sizeof point);
}

static struct nearest find_nearest(const struct flatten_params *params, const struct census *census)
{
    const struct scene *scene = params->scene;
    struct nearest nearest = {.scale = INFINITY};
    for (uint32_t i = 0; i < scene->instance_count; i++) {
        const struct instance *instance = &scene->instances[i];
        const struct bounds *mesh = &census->meshes[instance->mesh].bounds;
        double low[3], high[3];
        bool is_seen =
            census->instances[i] == INSTANCE_FLATTENED || census->instances[i] == INSTANCE_SHARES;
        if (!is_seen || bounds_is_empty(mesh))
            continue;
        affine_box(instance->transform, mesh->min, mesh->max, low, high);
        look_at_box(params->camera, low, high, &nearest);
    }
    for (uint32_t i = 0; i < scene->shape_count; i++) {
        struct bounds bounds = BOUNDS_EMPTY;
        if (scene->shapes[i].hidden)
            continue;
        bounds_add_shape(&bounds, &scene->shapes[i]);
        if (!bounds_is_empty(&bounds))
            look_at_box(params->camera, bounds.min, bounds.max, &nearest);
    }
    return nearest;
}

static double farthest_coordinate(const double point[3], const double origin[3])
{
    double farthest = 0;
    for (int i = 0; i < 3; i++)
        farthest = fmax(farthest, fabs(point[i] - origin[i]));
    return farthest;
}

void flatten_follow_camera(const struct flatten_params *params, const struct census *census,
                           struct flat_scene *out)
{
    if (!params->camera)
        return;
    const struct nearest nearest = find_nearest(params, census);
    if (isfinite(nearest.scale) &&
        farthest_coordinate(nearest.point, out->origin) > FOLLOW_RATIO * nearest.scale)
        memcpy(out->origin, nearest.point, sizeof out->origin);
}

// --- warnings ------------------------------------------------------------------------------------

// Adds an object with this bounding box in the world if it is coarse. Returns true for the first
// such object, whose name the caller must set.
static bool add_box(const struct flat_scene *flat, const double low[3], const double high[3],
                    struct coarse_objects *coarse)
{
    struct bounds bounds;
    double extent, farthest;
    vec3_subtract(low, flat->origin, bounds.min);
    vec3_subtract(high, flat->origin, bounds.max);
    if (!flatten_is_coarse(&bounds, &extent, &farthest) || coarse->count++ > 0)
        return false;
    coarse->extent = extent;
    coarse->farthest = farthest;
    for (int i = 0; i < 3; i++)
        coarse->place[i] = low[i] + (high[i] - low[i]) / 2;
    return true;
}

void coarse_add_instance(const struct flat_scene *flat, const struct scene *scene, uint32_t index,
                         const struct bounds *mesh, struct coarse_objects *coarse)
{
    const struct instance *instance = &scene->instances[index];
    double low[3], high[3];
    if (bounds_is_empty(mesh))
        return;
    affine_box(instance->transform, mesh->min, mesh->max, low, high);
    if (add_box(flat, low, high, coarse))
        snprintf(coarse->first, sizeof coarse->first, "instance %u, of mesh \"%s\",", index,
                 scene->meshes[instance->mesh].name);
}

static const char *const kind_names[SHAPE_KIND_COUNT] = {
    "a sphere", "a disc",     "a plane",          "a quad",
    "a box",    "a cylinder", "an open cylinder", "a distance field",
};

void coarse_add_shape(const struct flat_scene *flat, const struct scene *scene, uint32_t index,
                      struct coarse_objects *coarse)
{
    const struct shape *shape = &scene->shapes[index];
    struct bounds bounds = BOUNDS_EMPTY;
    if (flatten_is_lamp(scene, shape->kind, shape->material))
        return;
    bounds_add_shape(&bounds, shape);
    if (!bounds_is_empty(&bounds) && add_box(flat, bounds.min, bounds.max, coarse))
        snprintf(coarse->first, sizeof coarse->first, "shape %u, %s,", index,
                 kind_names[shape->kind]);
}

void coarse_warn(const struct coarse_objects *coarse)
{
    double step = coarse->farthest * (double)FLT_EPSILON;
    if (coarse->count > 0)
        log_warn("%u objects are too small for their distance from the coordinates' origin: %s is "
                 "%g m across and lies at (%g, %g, %g), %g m from that origin; single precision "
                 "resolves it in steps of %.2g m, %.2g %% of its size, so that its form, its "
                 "shadows and the light that it emits are wrong; expected larger objects, or a "
                 "camera near them, because the origin follows the camera",
                 coarse->count, coarse->first, coarse->extent, coarse->place[0], coarse->place[1],
                 coarse->place[2], coarse->farthest, step, 100 * step / coarse->extent);
}
