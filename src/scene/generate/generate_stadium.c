// An elliptic stadium.
#include "scene/generate/generate.h"

#include <math.h>

// Semi-axes of the field and of the outer wall along x and z, and the height of the stands.
static const double field[2] = {0.6, 0.4}, outside[2] = {1.0, 0.8}, height = 0.25;

// Computes point `at` of the cross section, which runs from the field's edge up the steps and down
// the outer wall. *out grows from 0 at the field to 1 outside; *y is the height.
static void section(uint32_t steps, uint32_t at, double *out, double *y)
{
    uint32_t trodden = at / 2, risen = (at + 1) / 2; // risers and treads alternate
    *out = (double)trodden / steps;
    *y = risen <= steps ? height * risen / steps : 0.0;
}

static void add_ring(struct mesh *mesh, const struct stadium *stadium, uint32_t at)
{
    double out, y;
    section(stadium->steps, at, &out, &y);
    double x_axis = field[0] + out * (outside[0] - field[0]);
    double z_axis = field[1] + out * (outside[1] - field[1]);
    for (uint32_t i = 0; i < stadium->segments; i++) {
        double around = 2 * M_PI * i / stadium->segments;
        float *position = mesh->positions[mesh->vertex_count++];
        position[0] = (float)(x_axis * cos(around));
        position[1] = (float)y;
        position[2] = (float)(-z_axis * sin(around));
    }
}

static void add_triangle(struct mesh *mesh, uint32_t a, uint32_t b, uint32_t c)
{
    uint32_t *corners = mesh->indices[mesh->triangle_count++];
    corners[0] = a;
    corners[1] = b;
    corners[2] = c;
}

uint64_t generate_stadium_bytes(const struct stadium *stadium)
{
    const struct mesh *mesh = NULL;
    uint64_t segments = stadium->segments, rings = 2ull * stadium->steps + 2;
    return (1 + rings * segments) * sizeof *mesh->positions +
           (2 * rings - 1) * segments * sizeof *mesh->indices;
}

bool generate_stadium(struct scene *scene, const struct stadium *stadium, uint32_t material,
                      uint32_t *index, struct err *err)
{
    uint32_t segments = stadium->segments, rings = 2 * stadium->steps + 2;
    uint32_t vertices = 1 + rings * segments, triangles = (2 * rings - 1) * segments;
    struct mesh mesh = {.name = "stadium", .material = material};
    struct arena *arena = &scene->arena;
    mesh.positions = arena_alloc(arena, vertices, sizeof *mesh.positions);
    mesh.indices = arena_alloc(arena, triangles, sizeof *mesh.indices);
    if (!mesh.positions || !mesh.indices)
        return err_memory(err, "a stadium", generate_stadium_bytes(stadium));
    mesh.vertex_count = 1; // the centre of the field
    for (uint32_t at = 0; at < rings; at++) {
        if (!scene_goes_on(scene, 0, err))
            return false;
        add_ring(&mesh, stadium, at);
    }
    // The triangles of the field and the stands are counter-clockwise as seen from above the field,
    // those of the wall as seen from outside.
    for (uint32_t i = 0; i < segments; i++) {
        uint32_t next = (i + 1) % segments;
        add_triangle(&mesh, 0, 1 + i, 1 + next);
        for (uint32_t at = 0; at + 1 < rings; at++) {
            uint32_t in = 1 + at * segments, out = in + segments;
            add_triangle(&mesh, in + i, out + i, out + next);
            add_triangle(&mesh, in + i, out + next, in + next);
        }
    }
    return scene_append_mesh(scene, &mesh, index, err);
}
