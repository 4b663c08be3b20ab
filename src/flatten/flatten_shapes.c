// Analytic shapes in single precision, and their boxes.
#include "flatten/flatten_shapes.h"

#include "flatten/flatten_precision.h"
#include "scene/core/affine.h"
#include "scene/core/bounds.h"
#include <float.h>
#include <math.h>

void flatten_bound(struct flat_scene *flat, const float low[3], const float high[3])
{
    for (int i = 0; i < 3; i++) {
        if (low[i] < flat->bounds_min[i])
            flat->bounds_min[i] = low[i];
        if (high[i] > flat->bounds_max[i])
            flat->bounds_max[i] = high[i];
    }
}

// Returns the shape that the rounded numbers describe, in double precision and without its
// material.
static struct shape exact_shape(const struct flat_shape *flat)
{
    struct shape shape = {.kind = flat->kind, .radius = (double)flat->radius, .sdf = flat->sdf};
    for (int i = 0; i < 3; i++) {
        shape.center[i] = (double)flat->center[i];
        shape.normal[i] = (double)flat->normal[i];
        for (int axis = 0; axis < 3; axis++)
            shape.axes[axis][i] = (double)flat->axes[axis][i];
    }
    return shape;
}

// Moves the point that defines a plane to the point of the plane nearest to the origin, because a
// distant one costs accuracy. Textured planes keep their point, because their texture depends on
// it.
static void move_near(const struct scene *scene, const double origin[3], struct shape *plane)
{
    if (plane->kind != SHAPE_PLANE || scene->materials[plane->material].texture_count > 0)
        return;
    double from[3];
    vec3_subtract(plane->center, origin, from);
    double height = vec3_dot(from, plane->normal);
    for (int i = 0; i < 3; i++)
        plane->center[i] = origin[i] + height * plane->normal[i];
}

static bool is_in_range(const struct shape *shape)
{
    return flatten_in_range(shape->center) && shape->radius <= SCENE_COORDINATE_MAX &&
           flatten_in_range(shape->axes[0]) && flatten_in_range(shape->axes[1]) &&
           flatten_in_range(shape->axes[2]);
}

// Returns how many of a shape's axes are edges with a length. The axes of planes, and the axes
// across round shapes, are unit vectors.
static int count_edges(enum shape_kind kind)
{
    switch (kind) {
    case SHAPE_QUAD:
        return 2;
    case SHAPE_BOX:
    case SHAPE_SDF:
        return 3;
    case SHAPE_CYLINDER:
    case SHAPE_TUBE:
        return 1;
    default:
        return 0;
    }
}

struct shape flatten_place_shape(const struct flat_scene *flat, const struct shape *shape)
{
    struct shape placed = *shape;
    flat_from_world(flat, shape->center, placed.center);
    placed.radius *= flat->scale;
    for (int axis = 0; axis < count_edges(shape->kind); axis++)
        for (int i = 0; i < 3; i++)
            placed.axes[axis][i] *= flat->scale;
    return placed;
}

static bool add_shape(struct flat_scene *flat, const struct scene *scene, uint32_t index,
                      struct err *err)
{
    struct shape shape = scene->shapes[index];
    if (!is_in_range(&shape))
        return err_set(err, ERR_INPUT,
                       "%s: shape %u at (%g, %g, %g) with radius %g; expected numbers within +-%g",
                       scene->path ? scene->path : "scene", index, shape.center[0], shape.center[1],
                       shape.center[2], shape.radius, SCENE_COORDINATE_MAX);
    move_near(scene, flat->origin, &shape);
    shape = flatten_place_shape(flat, &shape);
    struct flat_shape *added = &flat->shapes[flat->shape_count++];
    *added = (struct flat_shape){
        .kind = shape.kind,
        .material = shape.material,
        .radius = (float)shape.radius,
        .sdf = shape.sdf,
        .source = index,
    };
    for (int i = 0; i < 3; i++) {
        added->center[i] = (float)shape.center[i];
        added->normal[i] = (float)shape.normal[i];
        for (int axis = 0; axis < 3; axis++)
            added->axes[axis][i] = (float)shape.axes[axis][i];
    }
    // The bounds are those of the rounded shape, rounded outwards.
    const struct shape rounded = exact_shape(added);
    double reach[3];
    float low[3], high[3];
    if (!shape_reach(&rounded, reach))
        return true;
    for (int i = 0; i < 3; i++) {
        low[i] = nextafterf((float)(rounded.center[i] - reach[i]), -INFINITY);
        high[i] = nextafterf((float)(rounded.center[i] + reach[i]), INFINITY);
    }
    flatten_bound(flat, low, high);
    return true;
}

bool flatten_shapes(const struct flatten_params *params, struct flat_scene *out,
                    struct coarse_objects *coarse, struct err *err)
{
    const struct scene *scene = params->scene;
    for (uint32_t i = 0; i < scene->shape_count; i++) {
        if (i % FLATTEN_POLL == 0 && !flatten_goes_on(params, 1, err))
            return false;
        if (scene->shapes[i].hidden)
            continue;
        if (!add_shape(out, scene, i, err))
            return false;
        coarse_add_shape(out, scene, i, coarse);
    }
    return true;
}

// Planes extend to the limit of the kernels' coordinates, but not equally far in all directions. So
// the centre of a plane's box is far from everything else, and the first split of a BVH separates
// the planes from the other primitives.
static void plane_box(const struct flat_shape *shape, float min[3], float max[3])
{
    const float *n = shape->normal;
    for (int c = 0; c < 3; c++) {
        bool is_across = n[(c + 1) % 3] == 0.0f && n[(c + 2) % 3] == 0.0f;
        float margin = 4.0f * FLT_EPSILON * fabsf(shape->center[c]);
        min[c] = is_across ? shape->center[c] - margin : -(float)FLAT_COORDINATE_MAX;
        max[c] = is_across ? shape->center[c] + margin : 0.75f * (float)FLAT_COORDINATE_MAX;
    }
}

void flat_shape_box(const struct flat_shape *shape, float min[3], float max[3])
{
    const struct shape exact = exact_shape(shape);
    double reach[3];
    if (!shape_reach(&exact, reach)) {
        plane_box(shape, min, max);
        return;
    }
    float size = shape->radius;
    for (int c = 0; c < 3; c++)
        size = fmaxf(size, (float)reach[c]);
    for (int c = 0; c < 3; c++) {
        // The extent has one rounding error here and a few in a kernel; the sum of centre and
        // extent has one rounding error of its larger term.
        float margin = 4.0f * FLT_EPSILON * (fabsf(shape->center[c]) + size);
        min[c] = shape->center[c] - (float)reach[c] - margin;
        max[c] = shape->center[c] + (float)reach[c] + margin;
    }
}
