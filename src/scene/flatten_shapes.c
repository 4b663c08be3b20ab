// Analytic shapes in single precision, and their boxes.
#include "flatten_shapes.h"

#include "bounds.h"
#include <math.h>

bool flatten_in_range(const double point[3])
{
    for (int i = 0; i < 3; i++)
        if (!(fabs(point[i]) <= SCENE_COORDINATE_MAX))
            return false;
    return true;
}

void flatten_bound(struct flat_scene *flat, const float low[3], const float high[3])
{
    for (int i = 0; i < 3; i++) {
        if (low[i] < flat->bounds_min[i])
            flat->bounds_min[i] = low[i];
        if (high[i] > flat->bounds_max[i])
            flat->bounds_max[i] = high[i];
    }
}

static bool add_shape(struct flat_scene *flat, const struct scene *scene, uint32_t index,
                      struct err *err)
{
    const struct shape *shape = &scene->shapes[index];
    if (!flatten_in_range(shape->center) || !(shape->radius <= SCENE_COORDINATE_MAX))
        return err_set(err, ERR_INPUT,
                       "%s: shape %u at (%g, %g, %g) with radius %g; expected numbers within +-%g",
                       scene->path ? scene->path : "scene", index, shape->center[0],
                       shape->center[1], shape->center[2], shape->radius, SCENE_COORDINATE_MAX);
    struct flat_shape *added = &flat->shapes[flat->shape_count++];
    added->kind = shape->kind;
    added->material = shape->material;
    added->radius = (float)shape->radius;
    for (int i = 0; i < 3; i++) {
        added->center[i] = (float)(shape->center[i] - flat->origin[i]);
        added->normal[i] = (float)shape->normal[i];
    }
    // The bounds of the shape as it was rounded, rounded outwards.
    struct shape rounded = *shape;
    struct bounds bounds = BOUNDS_EMPTY;
    float low[3], high[3];
    rounded.radius = (double)added->radius;
    for (int i = 0; i < 3; i++) {
        rounded.center[i] = (double)added->center[i];
        rounded.normal[i] = (double)added->normal[i];
    }
    bounds_add_shape(&bounds, &rounded);
    for (int i = 0; i < 3; i++) {
        low[i] = nextafterf((float)bounds.min[i], -INFINITY);
        high[i] = nextafterf((float)bounds.max[i], INFINITY);
    }
    flatten_bound(flat, low, high);
    return true;
}

bool flatten_shapes(const struct scene *scene, struct flat_scene *out, struct err *err)
{
    for (uint32_t i = 0; i < scene->shape_count; i++)
        if (!add_shape(out, scene, i, err))
            return false;
    return true;
}

void flat_shape_box(const struct flat_shape *shape, float min[3], float max[3])
{
    for (int c = 0; c < 3; c++) {
        float n = shape->normal[c];
        float extent = shape->kind == SHAPE_SPHERE
                           ? shape->radius
                           : shape->radius * sqrtf(fmaxf(0.0f, 1.0f - n * n));
        // The extent has a handful of roundings, and a sum one: four ulps of the largest term.
        float margin = 4.0f * 1.1920929e-7f * (fabsf(shape->center[c]) + shape->radius);
        min[c] = shape->center[c] - extent - margin;
        max[c] = shape->center[c] + extent + margin;
    }
}
