// A torus.
#include "scene/generate/generate.h"

#include <math.h>

// Computes the point at angle `around` about the torus's axis and angle `about` about the tube, in
// radians.
static void evaluate(double around, double about, double tube, float position[3], float normal[3])
{
    const double n[3] = {cos(about) * cos(around), sin(about), -cos(about) * sin(around)};
    const double center[3] = {cos(around), 0.0, -sin(around)};
    for (int c = 0; c < 3; c++) {
        position[c] = (float)(center[c] + tube * n[c]);
        normal[c] = (float)n[c];
    }
}

uint64_t generate_torus_bytes(const struct torus *torus)
{
    const struct mesh *mesh = NULL;
    uint64_t vertices = (uint64_t)torus->segments * torus->tube_segments;
    return vertices * (sizeof *mesh->positions + sizeof *mesh->normals + 2 * sizeof *mesh->indices);
}

bool generate_torus(struct scene *scene, const struct torus *torus, uint32_t material,
                    uint32_t *index, struct err *err)
{
    uint32_t rings = torus->segments, columns = torus->tube_segments, next = 0;
    struct mesh mesh = {
        .name = "torus",
        .vertex_count = rings * columns,
        .triangle_count = 2 * rings * columns,
        .material = material,
    };
    struct arena *arena = &scene->arena;
    mesh.positions = arena_alloc(arena, mesh.vertex_count, sizeof *mesh.positions);
    mesh.normals = arena_alloc(arena, mesh.vertex_count, sizeof *mesh.normals);
    mesh.indices = arena_alloc(arena, mesh.triangle_count, sizeof *mesh.indices);
    if (!mesh.positions || !mesh.normals || !mesh.indices)
        return err_memory(err, "a torus", generate_torus_bytes(torus));
    for (uint32_t ring = 0; ring < rings; ring++) {
        for (uint32_t column = 0; column < columns; column++) {
            if (!scene_goes_on(scene, next, err))
                return false;
            uint32_t at = ring * columns + column, above = ring * columns + (column + 1) % columns;
            uint32_t across = (ring + 1) % rings * columns;
            uint32_t beside = across + column, opposite = across + (column + 1) % columns;
            evaluate(2 * M_PI * ring / rings, 2 * M_PI * column / columns, torus->tube,
                     mesh.positions[at], mesh.normals[at]);
            // Triangles are counter-clockwise as seen from outside.
            const uint32_t corners[2][3] = {{at, beside, opposite}, {at, opposite, above}};
            for (int t = 0; t < 2; t++, next++)
                for (int c = 0; c < 3; c++)
                    mesh.indices[next][c] = corners[t][c];
        }
    }
    return scene_append_mesh(scene, &mesh, index, err);
}
