#include "instanced.h"

#include "scene/generate/generate.h"
#include "scene/generate/scatter.h"

static void *allocate(struct scene *scene, size_t count, size_t bytes)
{
    void *memory = arena_alloc(&scene->arena, count, bytes);
    if (!memory) {
        fprintf(stderr, "out of memory\n");
        exit(1);
    }
    return memory;
}

uint32_t blob_mesh(struct scene *scene, uint32_t triangles, uint32_t material)
{
    uint32_t mesh;
    struct err err = {0};
    if (!generate_blob(scene, triangles, material, &mesh, &err)) {
        fprintf(stderr, "%s\n", err.msg);
        exit(1);
    }
    return mesh;
}

uint32_t ball_mesh(struct scene *scene, uint32_t subdivision, uint32_t material)
{
    uint32_t mesh;
    struct err err = {0};
    if (!generate_icosphere(scene, subdivision, &mesh, &err)) {
        fprintf(stderr, "%s\n", err.msg);
        exit(1);
    }
    scene->meshes[mesh].material = material;
    scene->meshes[mesh].normals = NULL;
    return mesh;
}

// Adds triangles that share no vertices, without an instance.
static uint32_t soup_mesh(struct scene *scene, uint32_t triangles, uint32_t material)
{
    uint32_t index;
    struct mesh *mesh = scene_add_mesh(scene, &index);
    if (!mesh)
        exit(1);
    mesh->triangle_count = triangles;
    mesh->vertex_count = 3 * triangles;
    mesh->material = material;
    mesh->positions = allocate(scene, mesh->vertex_count, sizeof *mesh->positions);
    mesh->indices = allocate(scene, triangles, sizeof *mesh->indices);
    for (uint32_t v = 0; v < mesh->vertex_count; v++)
        mesh->indices[v / 3][v % 3] = v;
    return index;
}

uint32_t cube_mesh(struct scene *scene, uint32_t cells, uint32_t material)
{
    uint32_t index = soup_mesh(scene, 12 * cells * cells, material), at = 0;
    float(*positions)[3] = scene->meshes[index].positions;
    for (uint32_t face = 0; face < 6; face++) {
        uint32_t axis = face / 2, u = (axis + (face % 2 ? 1 : 2)) % 3, v = 3 - axis - u;
        for (uint32_t i = 0; i < cells * cells * 6; i++, at++) {
            // Corners 0 1 3 and 0 3 2 of a square.
            static const uint32_t order[6] = {0, 1, 3, 0, 3, 2};
            uint32_t cell = i / 6, corner = order[i % 6];
            double step = 2.0 / cells;
            positions[at][axis] = face % 2 ? 1 : -1;
            positions[at][u] = (float)(-1 + step * (cell % cells + (corner & 1u)));
            positions[at][v] = (float)(-1 + step * (cell / cells + (corner >> 1u)));
        }
    }
    return index;
}

uint32_t pile_mesh(struct scene *scene, uint32_t count, uint32_t material)
{
    static const float corners[3][3] = {
        {-1.1f, -0.3f, 0.1f}, {1.3f, -0.1f, -0.2f}, {-0.2f, 1.8f, 0}};
    uint32_t index = soup_mesh(scene, count, material);
    for (uint32_t v = 0; v < 3 * count; v++)
        memcpy(scene->meshes[index].positions[v], corners[v % 3], sizeof corners[0]);
    return index;
}

void place_mesh(struct scene *scene, uint32_t mesh, const double m[3][4], uint32_t material)
{
    struct instance *instance = scene_add_instance(scene, NULL);
    if (!instance)
        exit(1);
    instance->mesh = mesh;
    instance->material = material;
    memcpy(instance->transform, m, sizeof instance->transform);
}

void add_anchor(struct scene *scene, const double at[3])
{
    float triangle[1][3][3];
    double size = 1e-6 * sqrt(at[0] * at[0] + at[1] * at[1] + at[2] * at[2]);
    for (int i = 0; i < 3; i++)
        for (int c = 0; c < 3; c++)
            triangle[0][i][c] = (float)(at[c] + (i == c ? size : 0));
    add_triangles(scene, (const float(*)[3][3])triangle, 1, 0);
}

const char *placing_name(enum placing placing)
{
    static const char *const names[PLACINGS] = {
        [TURNED] = "turned",   [MIRRORED] = "mirrored", [SQUASHED] = "squashed",
        [SHEARED] = "sheared", [TINY] = "tiny",         [HUGE_SCALE] = "huge"};
    return names[placing];
}

static void turn(struct random *random, double m[3][4])
{
    float axis[3];
    double turned[3][4];
    random_direction(random, axis);
    affine_rotation((const double[3]){(double)axis[0], (double)axis[1], (double)axis[2]},
                    random_between(random, 0, 6.28), turned);
    affine_multiply(turned, m, m);
}

void make_placing(enum placing placing, struct random *random, double m[3][4])
{
    double scales[2];
    placing_scales(placing, scales);
    memcpy(m, AFFINE_IDENTITY, sizeof AFFINE_IDENTITY);
    turn(random, m);
    for (int c = 0; c < 3; c++) {
        if (placing == MIRRORED)
            m[1][c] = -m[1][c];
        if (placing == SQUASHED)
            m[2][c] *= 0.01;
        if (placing == SHEARED)
            m[0][c] += 3 * m[1][c];
        for (int row = 0; row < 3 && (placing == TINY || placing == HUGE_SCALE); row++)
            m[row][c] *= scales[0];
    }
    turn(random, m);
}

void placing_scales(enum placing placing, double scales[2])
{
    static const double known[PLACINGS][2] = {
        [TURNED] = {1, 1},      [MIRRORED] = {1, 1},   [SQUASHED] = {0.01, 1},
        [SHEARED] = {0.3, 3.4}, [TINY] = {1e-3, 1e-3}, [HUGE_SCALE] = {1e3, 1e3}};
    memcpy(scales, known[placing], sizeof known[placing]);
}

void to_world(const struct flat_instance *instance, const double point[3], float out[3])
{
    for (int row = 0; row < 3; row++) {
        double sum = (double)instance->to_world[row][3];
        for (int c = 0; c < 3; c++)
            sum += (double)instance->to_world[row][c] * point[c];
        out[row] = (float)sum;
    }
}
