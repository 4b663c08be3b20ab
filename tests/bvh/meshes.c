#include "meshes.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define PI 3.14159265358979323846

uint32_t random_u32(struct random *random)
{
    uint64_t old = random->state;
    random->state = old * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    uint32_t shifted = (uint32_t)(((old >> 18) ^ old) >> 27), rotation = (uint32_t)(old >> 59);
    return shifted >> rotation | shifted << (-rotation & 31);
}

double random_unit(struct random *random)
{
    return random_u32(random) * 0x1p-32;
}

double random_between(struct random *random, double min, double max)
{
    return min + (max - min) * random_unit(random);
}

void random_direction(struct random *random, double direction[3])
{
    double z = random_between(random, -1, 1), angle = random_between(random, 0, 2 * PI);
    double radius = sqrt(1 - z * z);
    direction[0] = radius * cos(angle);
    direction[1] = radius * sin(angle);
    direction[2] = z;
}

struct mesh mesh_new(struct arena *arena, uint32_t count)
{
    struct mesh mesh = {arena_alloc(arena, count, sizeof(float[3][3])), count};
    if (!mesh.vertices) {
        fprintf(stderr, "out of memory for %u triangles\n", count);
        exit(1);
    }
    return mesh;
}

struct mesh mesh_soup(struct arena *arena, uint32_t count, double size, uint64_t seed)
{
    struct mesh mesh = mesh_new(arena, count);
    struct random random = {seed};
    for (uint32_t i = 0; i < count; i++) {
        double corner[3];
        for (int axis = 0; axis < 3; axis++)
            corner[axis] = random_between(&random, 0, 1 - size);
        for (int v = 0; v < 3; v++)
            for (int axis = 0; axis < 3; axis++)
                mesh.vertices[i][v][axis] =
                    (float)(corner[axis] + random_between(&random, 0, size));
    }
    return mesh;
}

static void add_triangle(struct mesh *mesh, const float *a, const float *b, const float *c)
{
    memcpy(mesh->vertices[mesh->count][0], a, sizeof(float[3]));
    memcpy(mesh->vertices[mesh->count][1], b, sizeof(float[3]));
    memcpy(mesh->vertices[mesh->count][2], c, sizeof(float[3]));
    mesh->count++;
}

static void sphere_point(uint32_t ring, uint32_t rings, uint32_t segment, uint32_t segments,
                         float point[3])
{
    double theta = PI * ring / rings, phi = 2 * PI * (segment % segments) / segments;
    double radius = ring == 0 || ring == rings ? 0 : sin(theta);
    point[0] = (float)(radius * cos(phi));
    point[1] = (float)(radius * sin(phi));
    point[2] = (float)cos(theta);
}

struct mesh mesh_sphere(struct arena *arena, uint32_t rings, uint32_t segments)
{
    struct mesh mesh = mesh_new(arena, 2 * rings * segments - 2 * segments);
    mesh.count = 0;
    for (uint32_t ring = 0; ring < rings; ring++) {
        for (uint32_t segment = 0; segment < segments; segment++) {
            float p[4][3];
            sphere_point(ring, rings, segment, segments, p[0]);
            sphere_point(ring, rings, segment + 1, segments, p[1]);
            sphere_point(ring + 1, rings, segment, segments, p[2]);
            sphere_point(ring + 1, rings, segment + 1, segments, p[3]);
            if (ring > 0)
                add_triangle(&mesh, p[0], p[2], p[1]);
            if (ring < rings - 1)
                add_triangle(&mesh, p[1], p[2], p[3]);
        }
    }
    return mesh;
}

static void grid_point(uint32_t n, uint32_t x, uint32_t y, float point[3])
{
    double u = (double)x / n, v = (double)y / n;
    point[0] = (float)u;
    point[1] = (float)v;
    point[2] = (float)(0.1 * sin(9 * u) * cos(7 * v) + 0.01 * sin(113 * u + 71 * v));
}

struct mesh mesh_grid(struct arena *arena, uint32_t n)
{
    struct mesh mesh = mesh_new(arena, 2 * n * n);
    mesh.count = 0;
    for (uint32_t y = 0; y < n; y++) {
        for (uint32_t x = 0; x < n; x++) {
            float p[4][3];
            for (uint32_t i = 0; i < 4; i++)
                grid_point(n, x + (i & 1), y + (i >> 1), p[i]);
            add_triangle(&mesh, p[0], p[1], p[2]);
            add_triangle(&mesh, p[1], p[3], p[2]);
        }
    }
    return mesh;
}

struct mesh mesh_identical(struct arena *arena, uint32_t count)
{
    static const float triangle[3][3] = {
        {0.1f, 0.2f, 0.3f}, {0.9f, 0.25f, 0.4f}, {0.3f, 0.8f, 0.7f}};
    struct mesh mesh = mesh_new(arena, count);
    for (uint32_t i = 0; i < count; i++)
        memcpy(mesh.vertices[i], triangle, sizeof triangle);
    return mesh;
}

static void add_quad(struct mesh *mesh, const double middle[3], const double a[3],
                     const double b[3])
{
    float corner[4][3];
    for (int i = 0; i < 4; i++)
        for (int c = 0; c < 3; c++)
            corner[i][c] = (float)(middle[c] + (i & 1 ? a[c] : -a[c]) + (i & 2 ? b[c] : -b[c]));
    add_triangle(mesh, corner[0], corner[1], corner[2]);
    add_triangle(mesh, corner[1], corner[3], corner[2]);
}

struct mesh mesh_among_beams(struct arena *arena, uint32_t rings, uint32_t beams)
{
    struct mesh sphere = mesh_sphere(arena, rings, 2 * rings);
    struct mesh mesh = mesh_new(arena, sphere.count + 2 * beams);
    struct random random = {5};
    memcpy(mesh.vertices, sphere.vertices, sphere.count * sizeof *sphere.vertices);
    mesh.count = sphere.count;
    for (uint32_t i = 0; i < beams; i++) {
        double middle[3], along[3], across[3];
        random_direction(&random, along);
        random_direction(&random, across);
        for (int c = 0; c < 3; c++) {
            middle[c] = random_between(&random, -3, 3);
            along[c] *= 3;
            across[c] *= 0.03;
        }
        add_quad(&mesh, middle, along, across);
    }
    return mesh;
}

struct mesh mesh_strands(struct arena *arena, uint32_t strands, uint32_t pieces)
{
    struct mesh mesh = mesh_new(arena, 2 * strands * pieces);
    struct random random = {7};
    mesh.count = 0;
    for (uint32_t i = 0; i < strands; i++) {
        double at[3], along[3], across[3], turn[3];
        random_direction(&random, at);
        random_direction(&random, along);
        random_direction(&random, across);
        for (uint32_t k = 0; k < pieces; k++) {
            double middle[3], half[3], side[3], length = 0;
            random_direction(&random, turn);
            for (int c = 0; c < 3; c++) {
                along[c] += 0.5 * turn[c];
                length += along[c] * along[c];
            }
            for (int c = 0; c < 3; c++) {
                along[c] /= sqrt(length);
                half[c] = 0.075 * along[c];
                side[c] = 0.0005 * across[c];
                middle[c] = at[c] + half[c];
                at[c] += 2 * half[c];
            }
            add_quad(&mesh, middle, half, side);
        }
    }
    return mesh;
}

// --- Files --------------------------------------------------------------------------------------

static FILE *open_data(const char *name)
{
    char path[4096];
    const char *data = getenv("LAMPYRIS_DATA"), *root = getenv("LAMPYRIS_SOURCE_ROOT");
    if (data)
        snprintf(path, sizeof path, "%s/mesh/%s", data, name);
    else
        snprintf(path, sizeof path, "%s/../shared/data/mesh/%s", root ? root : ".", name);
    return fopen(path, "r");
}

static uint32_t count_lines(FILE *file, const char *prefix)
{
    char line[1024];
    uint32_t count = 0;
    while (fgets(line, sizeof line, file))
        count += strncmp(line, prefix, strlen(prefix)) == 0;
    rewind(file);
    return count;
}

// Adds the triangles of a face "12/3/4 13/…", whose indices are counted from 1.
static void add_face(struct mesh *mesh, float (*points)[3], uint32_t point_count, char *line)
{
    uint32_t corners[3], seen = 0;
    for (char *word = strtok(line, " \t\r\n"); word; word = strtok(NULL, " \t\r\n")) {
        unsigned long index = strtoul(word, NULL, 10) - 1;
        if (index >= point_count)
            return;
        if (seen >= 3)
            corners[1] = corners[2];
        corners[seen < 3 ? seen : 2] = (uint32_t)index;
        if (++seen >= 3)
            add_triangle(mesh, points[corners[0]], points[corners[1]], points[corners[2]]);
    }
}

bool mesh_load(struct arena *arena, const char *name, struct mesh *mesh)
{
    FILE *file = open_data(name);
    if (!file)
        return false;
    uint32_t point_count = count_lines(file, "v "), face_count = count_lines(file, "f ");
    *mesh = mesh_new(arena, 2 * face_count); // all faces may be quads
    mesh->count = 0;
    float(*points)[3] = arena_alloc(arena, point_count, sizeof *points);
    uint32_t next = 0;
    char line[1024];
    while (points && fgets(line, sizeof line, file)) {
        if (strncmp(line, "v ", 2) == 0) {
            float *p = points[next++];
            if (sscanf(line + 2, "%f %f %f", &p[0], &p[1], &p[2]) != 3)
                break;
        } else if (strncmp(line, "f ", 2) == 0) {
            add_face(mesh, points, next, line + 2);
        }
    }
    fclose(file);
    return mesh->count > 0;
}

struct bvh_params mesh_params(const struct mesh *mesh)
{
    return (struct bvh_params){
        .triangle_vertices = (const float(*)[3][3])mesh->vertices,
        .triangle_count = mesh->count,
    };
}
