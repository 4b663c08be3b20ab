#include "flatten/flatten_placement.h"

#include "scene/core/affine.h"
#include "scene/core/bounds.h"

struct placement placement_create(const struct scene *scene, const struct instance *instance,
                                  const double origin[3], double scale)
{
    struct placement placement = {
        .mesh = &scene->meshes[instance->mesh],
        .instance = instance,
        .origin = {origin[0], origin[1], origin[2]},
        .scale = scale,
        .is_mirrored = affine_determinant(instance->transform) < 0,
    };
    // The cofactor matrix is the inverse transpose times the determinant; the determinant's sign is
    // removed here.
    affine_cofactors(instance->transform, placement.normals);
    for (int i = 0; i < 9 && placement.is_mirrored; i++)
        placement.normals[i / 3][i % 3] *= -1;
    return placement;
}

void placement_vertex(const struct placement *placement, uint32_t vertex, double out[3])
{
    mesh_vertex(placement->mesh, vertex, out);
    affine_point(placement->instance->transform, out, out);
    for (int i = 0; i < 3; i++)
        out[i] = (out[i] - placement->origin[i]) * placement->scale;
}

void placement_corners(const struct placement *placement, uint32_t triangle, double corners[3][3])
{
    for (int corner = 0; corner < 3; corner++)
        placement_vertex(placement, placement->mesh->indices[triangle][corner], corners[corner]);
}
