// A procedural mesh for tests and benchmarks.
#include "scene/generate/generate.h"

#include "base/maths.h"
#include <math.h>
#include <string.h>

#define PI 3.14159265358979323846

// The surface is r(d) d over unit directions d, with r(d) = 1 + sum of a_i sin(k_i . d). The sine
// of a linear form is odd in d, so that the mean radius over all directions is exactly 1. The
// amplitudes add up to 0.32, so the radius stays within [0.68, 1.32]. The wave vectors k_i are
// arbitrary; their lengths of 3 to 20 give bumps from a third of the circumference down to a
// twentieth.
static const struct wave {
    double amplitude, vector[3];
} waves[] = {
    {0.16, {2.1, 1.3, -1.7}},
    {0.09, {-3.7, 4.9, 2.3}},
    {0.05, {6.1, -5.3, 7.7}},
    {0.02, {-11.3, 9.1, 13.7}},
};

// Computes the point and the unit normal in the direction d. The surface is where F(p) = |p| - r(p
// / |p|) vanishes; its gradient there is d - (g - (g . d) d) / r with g = sum of a_i k_i cos(k_i .
// d), the gradient of r's formula.
static void evaluate(const double d[3], float position[3], float normal[3])
{
    double radius = 1.0, g[3] = {0.0, 0.0, 0.0};
    for (size_t i = 0; i < sizeof waves / sizeof waves[0]; i++) {
        const double *k = waves[i].vector;
        double phase = vec3_dot(k, d);
        radius += waves[i].amplitude * sin(phase);
        for (int c = 0; c < 3; c++)
            g[c] += waves[i].amplitude * k[c] * cos(phase);
    }
    double along = vec3_dot(g, d), n[3];
    for (int c = 0; c < 3; c++)
        n[c] = d[c] - (g[c] - along * d[c]) / radius;
    double length = vec3_norm(n); // at least 1, because n . d is 1
    for (int c = 0; c < 3; c++) {
        position[c] = (float)(radius * d[c]);
        normal[c] = (float)(n[c] / length);
    }
}

// A latitude-longitude grid: `rings` circles of latitude between the poles, each of `columns`
// vertices. The vertices are in the order north pole, rings from north to south, south pole.
struct grid {
    uint32_t rings, columns;
};

// Chooses a grid. With n bands of latitude, n - 1 rings and 2 n columns there are 4 n (n - 1)
// triangles, because the bands at the poles have one triangle per column, the others two.
static struct grid choose_grid(uint32_t triangles)
{
    double bands = floor(0.5 * (1.0 + sqrt(1.0 + (double)triangles)));
    uint32_t n = bands < 2.0 ? 2 : (uint32_t)bands;
    return (struct grid){.rings = n - 1, .columns = 2 * n};
}

static uint32_t vertex_at(struct grid grid, uint32_t ring, uint32_t column)
{
    return 1 + ring * grid.columns + column % grid.columns;
}

static void fill_vertices(struct grid grid, const struct progress *progress, struct mesh *mesh)
{
    const double north[3] = {0.0, 1.0, 0.0}, south[3] = {0.0, -1.0, 0.0};
    evaluate(north, mesh->positions[0], mesh->normals[0]);
    for (uint32_t ring = 0; ring < grid.rings; ring++) {
        double theta = PI * (ring + 1.0) / (grid.rings + 1.0);
        for (uint32_t column = 0; column < grid.columns; column++) {
            double phi = 2.0 * PI * column / grid.columns;
            double d[3] = {sin(theta) * cos(phi), cos(theta), -sin(theta) * sin(phi)};
            uint32_t vertex = vertex_at(grid, ring, column);
            evaluate(d, mesh->positions[vertex], mesh->normals[vertex]);
            if (progress_stops_at(progress, vertex))
                return;
        }
    }
    uint32_t last = mesh->vertex_count - 1;
    evaluate(south, mesh->positions[last], mesh->normals[last]);
}

static void set_triangle(struct mesh *mesh, uint32_t *next, uint32_t a, uint32_t b, uint32_t c)
{
    uint32_t *corners = mesh->indices[(*next)++];
    corners[0] = a;
    corners[1] = b;
    corners[2] = c;
}

// Triangles are counter-clockwise as seen from outside. Columns run eastwards, and rings
// southwards.
static void fill_triangles(struct grid grid, struct mesh *mesh)
{
    uint32_t next = 0, south = mesh->vertex_count - 1;
    for (uint32_t column = 0; column < grid.columns; column++)
        set_triangle(mesh, &next, 0, vertex_at(grid, 0, column), vertex_at(grid, 0, column + 1));
    for (uint32_t ring = 0; ring + 1 < grid.rings; ring++) {
        for (uint32_t column = 0; column < grid.columns; column++) {
            uint32_t west = vertex_at(grid, ring, column);
            uint32_t east = vertex_at(grid, ring, column + 1);
            uint32_t south_west = vertex_at(grid, ring + 1, column);
            uint32_t south_east = vertex_at(grid, ring + 1, column + 1);
            set_triangle(mesh, &next, west, south_west, south_east);
            set_triangle(mesh, &next, west, south_east, east);
        }
    }
    uint32_t last = grid.rings - 1;
    for (uint32_t column = 0; column < grid.columns; column++)
        set_triangle(mesh, &next, vertex_at(grid, last, column), south,
                     vertex_at(grid, last, column + 1));
}

uint64_t generate_blob_bytes(uint32_t triangles)
{
    const struct mesh *mesh = NULL;
    const struct grid grid = choose_grid(triangles);
    uint64_t cells = (uint64_t)grid.rings * grid.columns;
    return (2 + cells) * (sizeof *mesh->positions + sizeof *mesh->normals) +
           2 * cells * sizeof *mesh->indices;
}

bool generate_blob(struct scene *scene, uint32_t triangles, uint32_t material, uint32_t *mesh,
                   struct err *err)
{
    struct grid grid = choose_grid(triangles);
    struct mesh blob = {
        .name = "blob",
        .vertex_count = 2 + grid.rings * grid.columns,
        .triangle_count = 2 * grid.rings * grid.columns,
        .material = material,
    };
    struct arena *arena = &scene->arena;
    blob.positions = arena_alloc(arena, blob.vertex_count, sizeof *blob.positions);
    blob.normals = arena_alloc(arena, blob.vertex_count, sizeof *blob.normals);
    blob.indices = arena_alloc(arena, blob.triangle_count, sizeof *blob.indices);
    if (!blob.positions || !blob.normals || !blob.indices)
        return err_memory(err, "a blob", generate_blob_bytes(triangles));
    fill_vertices(grid, scene->progress, &blob);
    if (!scene_goes_on(scene, 0, err))
        return false;
    fill_triangles(grid, &blob);
    return scene_append_mesh(scene, &blob, mesh, err);
}
