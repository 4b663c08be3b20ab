// Transforms of instances in single precision, between world space and their meshes' spaces.
#include "flatten/flatten_instances.h"

#include "flatten/flatten_shapes.h"
#include "scene/core/affine.h"
#include <math.h>

static void round_matrix(const double m[3][4], float out[3][4])
{
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 4; j++)
            out[i][j] = (float)m[i][j];
}

// Computes the map from the mesh's array, which has its own origin and unit, to the scene's
// coordinates, in double precision. The inverse is that of the rounded map, so that both agree.
static bool set_transforms(const double transform[3][4], const struct bounds *mesh,
                           const struct flat_scene *flat, struct flat_instance *out)
{
    double to_world[3][4], to_object[3][4], origin[3], unit = 1 / flatten_choose_scale(mesh);
    flatten_choose_origin(mesh, origin);
    affine_multiply(transform, AFFINE_IDENTITY, to_world);
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++)
            to_world[i][3] += transform[i][j] * origin[j];
        to_world[i][3] = (to_world[i][3] - flat->origin[i]) * flat->scale;
        for (int j = 0; j < 3; j++)
            to_world[i][j] *= unit * flat->scale;
    }
    round_matrix(to_world, out->to_world);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 4; j++)
            to_world[i][j] = (double)out->to_world[i][j];
    if (!affine_inverse(to_world, to_object))
        return false;
    round_matrix(to_object, out->to_object);
    return true;
}

// Adds the box of the mesh's rounded vertices after the rounded transform to the bounds. It has a
// margin for the rounding errors of each coordinate, which is a sum of four terms.
static void bound_instance(struct flat_scene *flat, const struct flat_instance *instance)
{
    const struct flat_mesh *mesh = &flat->meshes[instance->mesh];
    double m[3][4], low[3], high[3];
    float min[3], max[3];
    for (int i = 0; i < 3; i++) {
        low[i] = (double)mesh->bounds_min[i];
        high[i] = (double)mesh->bounds_max[i];
        for (int j = 0; j < 4; j++)
            m[i][j] = (double)instance->to_world[i][j];
    }
    affine_box(m, low, high, low, high);
    for (int i = 0; i < 3; i++) {
        min[i] = nextafterf((float)low[i], -INFINITY);
        max[i] = nextafterf((float)high[i], INFINITY);
    }
    flatten_bound(flat, min, max);
}

bool flatten_instances(const struct flatten_params *params, const struct census *census,
                       struct flat_scene *out, struct coarse_objects *coarse, struct err *err)
{
    const struct scene *scene = params->scene;
    for (uint32_t i = 0; i < scene->instance_count; i++) {
        if (i % FLATTEN_POLL == 0 && !flatten_goes_on(params, 1, err))
            return false;
        const struct instance *instance = &scene->instances[i];
        const struct mesh_use *use = &census->meshes[instance->mesh];
        if (census->instances[i] != INSTANCE_SHARES)
            continue;
        struct flat_instance *placed = &out->instances[out->placed_count];
        // All triangles of the mesh may have been dropped because they have no area in its own
        // space.
        if (out->meshes[use->flat].triangle_count == 0)
            continue;
        *placed = (struct flat_instance){
            .mesh = use->flat,
            .material = instance->material,
            .source = i,
            .is_mirrored = affine_determinant(instance->transform) < 0,
        };
        if (!set_transforms(instance->transform, &use->bounds, out, placed))
            return err_set(err, ERR_BUG, "instance %u: its transform has no inverse", i);
        bound_instance(out, placed);
        coarse_add_instance(out, scene, i, &use->bounds, coarse);
        out->placed_count++;
    }
    return true;
}
