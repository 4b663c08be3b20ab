#include "check/made_mesh.h"

#include "scene/core/affine.h"
#include <string.h>

struct mesh *made_mesh_add(struct scene *scene, uint32_t triangles, struct err *err)
{
    uint32_t index;
    struct mesh *mesh = scene_add_mesh(scene, &index);
    struct instance *instance = scene_add_instance(scene, NULL);
    if (mesh && instance) {
        *instance = (struct instance){
            .mesh = index, .material = SCENE_NONE, .transform = {{1}, {0, 1}, {0, 0, 1}}};
        *mesh = (struct mesh){
            .name = "made", .vertex_count = 3 * triangles, .triangle_count = triangles};
        mesh->positions = arena_alloc(&scene->arena, mesh->vertex_count, sizeof *mesh->positions);
        mesh->indices = arena_alloc(&scene->arena, triangles, sizeof *mesh->indices);
    }
    if (!mesh || !instance || !mesh->positions || !mesh->indices) {
        err_memory(err, "triangles", triangles);
        return NULL;
    }
    for (uint32_t i = 0; i < mesh->vertex_count; i++)
        mesh->indices[i / 3][i % 3] = i;
    return mesh;
}

void made_mesh_set(struct mesh *mesh, uint32_t vertex, double x, double y, double z)
{
    mesh->positions[vertex][0] = (float)x;
    mesh->positions[vertex][1] = (float)y;
    mesh->positions[vertex][2] = (float)z;
}

// The corners of a square's two triangles, 0 1 3 and 0 3 2.
static const int square_corners[6] = {0, 1, 3, 0, 3, 2};

struct mesh *made_mesh_add_square(struct scene *scene, double side, double y, struct err *err)
{
    struct mesh *mesh = made_mesh_add(scene, 2, err);
    for (uint32_t i = 0; mesh && i < 6; i++)
        made_mesh_set(mesh, i, square_corners[i] & 2 ? side : -side, y,
                      square_corners[i] & 1 ? side : -side);
    return mesh;
}

struct mesh *made_mesh_add_cube(struct scene *scene, double side, struct err *err)
{
    struct mesh *mesh = made_mesh_add(scene, 12, err);
    for (uint32_t i = 0; mesh && i < 36; i++) {
        uint32_t axis = i / 12, corner = i % 6;
        bool is_upper = i / 6 % 2;
        // The lower side has the opposite orientation.
        int at = square_corners[is_upper ? corner : 5 - corner];
        float *vertex = mesh->positions[i];
        vertex[axis] = (float)(is_upper ? side : -side);
        vertex[(axis + 1) % 3] = (float)(at & 1 ? side : -side);
        vertex[(axis + 2) % 3] = (float)(at & 2 ? side : -side);
    }
    return mesh;
}

bool made_mesh_blacken(struct scene *scene, struct mesh *mesh, double emission, struct err *err)
{
    struct material *material = scene_add_material(scene, &mesh->material);
    if (!material)
        return err_memory(err, "a material", sizeof *material);
    for (int c = 0; c < 3; c++) {
        material->base_color[c] = 0;
        material->emission[c] = (float)(emission * (1 << c));
    }
    return true;
}
