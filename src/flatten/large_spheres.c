#include "flatten/large_spheres.h"

#include "base/maths.h"
#include "flatten/flatten_shapes.h"
#include <math.h>

// The ratio 1e-3 / (14 * 2^-24) (see large_spheres.h), rounded to a power of two.
#define LARGE_RATIO 1024.0

static double half_diagonal(const float min[3], const float max[3])
{
    double half[3];
    for (int c = 0; c < 3; c++)
        half[c] = ((double)max[c] - (double)min[c]) / 2;
    return vec3_norm(half);
}

static double shape_size(const struct flat_shape *shape)
{
    float min[3], max[3];
    if (shape->kind == SHAPE_SPHERE)
        return (double)shape->radius;
    if (shape->kind == SHAPE_PLANE)
        return INFINITY;
    flat_shape_box(shape, min, max);
    return half_diagonal(min, max);
}

static double camera_height(const struct flat_scene *flat, const struct camera *camera,
                            const struct flat_shape *sphere)
{
    double center[3], from[3];
    flat_from_world(flat, camera->position, from);
    vec3_widen(sphere->center, center);
    vec3_subtract(from, center, from);
    return fabs(vec3_norm(from) - (double)sphere->radius);
}

// Returns the smallest half diagonal of the bounds of the world's triangles and of each shared
// mesh.
static double triangles_size(const struct flat_scene *flat)
{
    float min[3] = {INFINITY, INFINITY, INFINITY}, max[3] = {-INFINITY, -INFINITY, -INFINITY};
    for (uint32_t i = 0; i < flat->world_triangle_count; i++)
        for (int v = 0; v < 3; v++)
            for (int c = 0; c < 3; c++) {
                min[c] = fminf(min[c], flat->triangles[i].v[v][c]);
                max[c] = fmaxf(max[c], flat->triangles[i].v[v][c]);
            }
    double size = min[0] <= max[0] ? half_diagonal(min, max) : INFINITY;
    for (uint32_t i = 0; i < flat->mesh_count; i++)
        size = fmin(size, half_diagonal(flat->meshes[i].bounds_min, flat->meshes[i].bounds_max));
    return size;
}

bool is_close_to_large_sphere(const struct flat_scene *flat, const struct camera *camera)
{
    for (uint32_t i = 0; i < flat->shape_count; i++) {
        const struct flat_shape *shape = &flat->shapes[i];
        if (shape->kind == SHAPE_SPHERE &&
            (double)shape->radius > LARGE_RATIO * camera_height(flat, camera, shape))
            return true;
    }
    return false;
}

bool has_large_spheres_anyway(const struct flat_scene *flat)
{
    double largest = 0, detail = INFINITY;
    for (uint32_t i = 0; i < flat->shape_count; i++) {
        const struct flat_shape *shape = &flat->shapes[i];
        detail = fmin(detail, shape_size(shape));
        if (shape->kind == SHAPE_SPHERE)
            largest = fmax(largest, (double)shape->radius);
    }
    // The triangles are tested last, because there may be many.
    return largest > 0 &&
           (largest > LARGE_RATIO * detail || largest > LARGE_RATIO * triangles_size(flat));
}

bool has_large_spheres(const struct flat_scene *flat, const struct camera *camera)
{
    return is_close_to_large_sphere(flat, camera) || has_large_spheres_anyway(flat);
}
