// Tests generated tangents against closed forms, and against a slow search for the same groups of
// triangles.
#include "scene/core/scene.h"
#include "scene/mesh/tangents.h"
#include "test.h"

static const double pi = 3.14159265358979323846;

#define MESH(...)                                                                                  \
    {                                                                                              \
        .name = "test", __VA_ARGS__                                                                \
    }

static bool generate(struct mesh *mesh, struct arena *arena)
{
    struct err err = {0};
    bool ok = mesh_generate_tangents(mesh, 0, NULL, arena, &err);
    CHECK(ok, "%s", err.msg);
    return ok;
}

static const float *tangent_at(const struct mesh *mesh, uint32_t triangle, int corner)
{
    return mesh->tangents[mesh->indices[triangle][corner]];
}

static void check_tangent(const float *tangent, double x, double y, double z, double w,
                          const char *what)
{
    bool is_near = fabs((double)tangent[0] - x) < 1e-6 && fabs((double)tangent[1] - y) < 1e-6 &&
                   fabs((double)tangent[2] - z) < 1e-6 && (double)tangent[3] == w;
    CHECK(is_near, "%s: (%g, %g, %g; %g), expected (%g, %g, %g; %g)", what, (double)tangent[0],
          (double)tangent[1], (double)tangent[2], (double)tangent[3], x, y, z, w);
}

// The image is upright on the square: u increases to the right, t downwards.
TEST(upright_square)
{
    float positions[4][3] = {{0, 0, 0}, {2, 0, 0}, {2, 1, 0}, {0, 1, 0}};
    float normals[4][3] = {{0, 0, 1}, {0, 0, 1}, {0, 0, 1}, {0, 0, 1}};
    float uvs[4][2] = {{0, 1}, {1, 1}, {1, 0}, {0, 0}};
    uint32_t indices[2][3] = {{0, 1, 2}, {0, 2, 3}};
    struct mesh mesh = MESH(.vertex_count = 4, .triangle_count = 2, .positions = positions,
                            .normals = normals, .uvs = {uvs}, .indices = indices);
    struct arena arena = {0};
    if (generate(&mesh, &arena)) {
        CHECK(mesh.vertex_count == 4 && mesh.positions == positions && mesh.indices == indices);
        for (int v = 0; v < 4; v++)
            check_tangent(mesh.tangents[v], 1, 0, 0, 1, "upright");
    }
    arena_finish(&arena);
}

// u increases away from the middle on both sides, so the two vertices there are split.
TEST(mirrored_halves)
{
    float positions[6][3] = {{-1, 0, 0}, {0, 0, 0}, {1, 0, 0}, {-1, 1, 0}, {0, 1, 0}, {1, 1, 0}};
    float normals[6][3] = {{0, 0, 1}, {0, 0, 1}, {0, 0, 1}, {0, 0, 1}, {0, 0, 1}, {0, 0, 1}};
    float uvs[6][2] = {{1, 1}, {0, 1}, {1, 1}, {1, 0}, {0, 0}, {1, 0}};
    float colors[6][4] = {{0}, {.5f}, {1}, {0}, {.5f}, {1}};
    uint32_t indices[4][3] = {{0, 1, 4}, {0, 4, 3}, {1, 2, 5}, {1, 5, 4}};
    uint32_t old_indices[4][3];
    memcpy(old_indices, indices, sizeof indices);
    struct mesh mesh =
        MESH(.vertex_count = 6, .triangle_count = 4, .positions = positions, .normals = normals,
             .uvs = {uvs, uvs}, .colors = colors, .indices = indices);
    struct arena arena = {0};
    if (generate(&mesh, &arena)) {
        CHECK(mesh.vertex_count == 8, "%u vertices", mesh.vertex_count);
        for (uint32_t t = 0; t < 4; t++)
            for (int c = 0; c < 3; c++) {
                uint32_t v = mesh.indices[t][c], old = old_indices[t][c];
                check_tangent(mesh.tangents[v], t < 2 ? -1 : 1, 0, 0, t < 2 ? -1 : 1, "half");
                CHECK(memcmp(mesh.positions[v], positions[old], sizeof positions[0]) == 0 &&
                      memcmp(mesh.normals[v], normals[old], sizeof normals[0]) == 0 &&
                      memcmp(mesh.uvs[0][v], uvs[old], sizeof uvs[0]) == 0 &&
                      memcmp(mesh.uvs[1][v], uvs[old], sizeof uvs[0]) == 0 &&
                      memcmp(mesh.colors[v], colors[old], sizeof colors[0]) == 0);
            }
        // Other meshes may share the arrays.
        CHECK(memcmp(indices, old_indices, sizeof indices) == 0 && mesh.positions != positions);
    }
    arena_finish(&arena);
}

// --- cubes ---------------------------------------------------------------------------------------

// Returns corner `c` (0 … 3, in order) of face f. The face's normal is along axis f / 2.
static void cube_corner(int f, int c, float position[3], float uv[2])
{
    int axis = f / 2, side = f % 2;
    float s = c == 1 || c == 2 ? 1 : 0, t = c >= 2 ? 1 : 0;
    position[axis] = (float)side;
    position[(axis + 1) % 3] = side ? s : 1 - s; // on side 1 u increases along the axis, on side 0
                                                 // against it
    position[(axis + 2) % 3] = t;
    uv[0] = s;
    uv[1] = 1 - t;
}

static void check_cube(const struct mesh *mesh)
{
    for (uint32_t t = 0; t < mesh->triangle_count; t++) {
        double expected[3] = {0, 0, 0};
        int f = (int)t / 2;
        expected[(f / 2 + 1) % 3] = f % 2 ? 1 : -1;
        for (int c = 0; c < 3; c++)
            check_tangent(tangent_at(mesh, t, c), expected[0], expected[1], expected[2], 1, "cube");
    }
}

// Each face has an image of its own, so edges are seams.
TEST(cube_with_seams)
{
    float positions[24][3], normals[24][3] = {{0}}, uvs[24][2];
    uint32_t indices[12][3];
    for (int f = 0; f < 6; f++) {
        for (int c = 0; c < 4; c++) {
            cube_corner(f, c, positions[4 * f + c], uvs[4 * f + c]);
            normals[4 * f + c][f / 2] = f % 2 ? 1 : -1;
        }
        for (uint32_t half = 0; half < 2; half++) {
            indices[2 * f + (int)half][0] = 4 * (uint32_t)f;
            indices[2 * f + (int)half][1] = 4 * (uint32_t)f + 1 + half;
            indices[2 * f + (int)half][2] = 4 * (uint32_t)f + 2 + half;
        }
    }
    struct mesh mesh = MESH(.vertex_count = 24, .triangle_count = 12, .positions = positions,
                            .normals = normals, .uvs = {uvs}, .indices = indices);
    struct arena arena = {0};
    if (generate(&mesh, &arena)) {
        CHECK(mesh.vertex_count == 24, "%u", mesh.vertex_count);
        check_cube(&mesh);
    }
    // Without normals the faces are flat, with the same tangents.
    mesh.normals = NULL;
    mesh.tangents = NULL;
    if (generate(&mesh, &arena)) {
        CHECK(mesh.vertex_count == 24 && !mesh.normals, "%u", mesh.vertex_count);
        check_cube(&mesh);
    }
    // With separate vertices for each corner the result is the same, because equal ones are merged.
    float wide_positions[36][3], wide_uvs[36][2];
    uint32_t wide_indices[12][3];
    for (uint32_t i = 0; i < 36; i++) {
        uint32_t v = indices[i / 3][i % 3];
        memcpy(wide_positions[i], positions[v], sizeof positions[0]);
        memcpy(wide_uvs[i], uvs[v], sizeof uvs[0]);
        wide_indices[i / 3][i % 3] = i;
    }
    struct mesh wide = MESH(.vertex_count = 36, .triangle_count = 12, .positions = wide_positions,
                            .uvs = {wide_uvs}, .indices = wide_indices);
    if (generate(&wide, &arena)) {
        CHECK(wide.vertex_count == 36, "%u", wide.vertex_count);
        check_cube(&wide);
    }
    arena_finish(&arena);
}

// --- sphere --------------------------------------------------------------------------------------

enum { SLICES = 256, STACKS = 32, SPHERE_VERTICES = (SLICES + 1) * (STACKS + 1) };

// Makes a sphere by latitude and longitude, with u along the longitude; it increases `turn` times
// around, or decreases for -1. Vertices of the seam have triangles on one side only, so their
// tangents are off by half a slice: 0.7 degrees.
static void make_sphere(float (*positions)[3], float (*uvs)[2], uint32_t (*indices)[3], float turn)
{
    uint32_t t = 0;
    for (uint32_t j = 0; j <= STACKS; j++)
        for (uint32_t i = 0; i <= SLICES; i++) {
            double theta = pi * j / STACKS, phi = 2 * pi * (i % SLICES) / SLICES;
            uint32_t v = j * (SLICES + 1) + i;
            bool is_pole = j == 0 || j == STACKS;
            positions[v][0] = is_pole ? 0 : (float)(sin(theta) * cos(phi));
            positions[v][1] = is_pole ? 0 : (float)(sin(theta) * sin(phi));
            positions[v][2] = is_pole ? 1 - 2.0f * (float)(j > 0) : (float)cos(theta);
            uvs[v][0] = turn * (float)i / SLICES;
            uvs[v][1] = (float)j / STACKS;
        }
    for (uint32_t j = 0; j < STACKS; j++)
        for (uint32_t i = 0; i < SLICES; i++) {
            uint32_t a = j * (SLICES + 1) + i, b = a + SLICES + 1;
            const uint32_t two[2][3] = {{a, b, b + 1}, {a, b + 1, a + 1}};
            memcpy(indices[t], two, sizeof two);
            t += 2;
        }
}

static void check_sphere(float turn)
{
    static float positions[SPHERE_VERTICES][3], uvs[SPHERE_VERTICES][2];
    static uint32_t indices[2 * SLICES * STACKS][3];
    make_sphere(positions, uvs, indices, turn);
    struct mesh mesh =
        MESH(.vertex_count = SPHERE_VERTICES, .triangle_count = 2 * SLICES * STACKS,
             .positions = positions, .normals = positions, .uvs = {uvs}, .indices = indices);
    struct arena arena = {0};
    double worst = 0;
    if (generate(&mesh, &arena)) {
        CHECK(mesh.vertex_count == SPHERE_VERTICES, "%u", mesh.vertex_count);
        for (uint32_t v = 0; v < mesh.vertex_count; v++) {
            const float *p = mesh.positions[v], *tangent = mesh.tangents[v];
            double radius = hypot((double)p[0], (double)p[1]);
            if (radius == 0) // a pole, where u has no direction
                continue;
            CHECK(tangent[3] == turn, "vertex %u", v);
            double along = (double)turn *
                           ((double)tangent[1] * (double)p[0] - (double)tangent[0] * (double)p[1]) /
                           radius;
            worst = fmax(worst, acos(fmin(along, 1)) * 180 / pi);
        }
        CHECK(worst < 1, "%g degrees from the parallel", worst);
    }
    arena_finish(&arena);
}

TEST(sphere)
{
    check_sphere(1);
}

TEST(mirrored_sphere)
{
    check_sphere(-1);
}

// --- rules ---------------------------------------------------------------------------------------

// At the origin, a triangle with an angle of 90 degrees and the tangent (1, 0) meets one with 45
// degrees and the tangent (1, 1) / sqrt(2), where P = u (1, 1) + v (0, 1).
TEST(weights_are_angles)
{
    float positions[4][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-1, 1, 0}};
    float normals[4][3] = {{0, 0, 1}, {0, 0, 1}, {0, 0, 1}, {0, 0, 1}};
    float uvs[4][2] = {{0, 0}, {1, 0}, {0, -1}, {-1, -2}};
    uint32_t indices[2][3] = {{0, 1, 2}, {0, 2, 3}};
    struct mesh mesh = MESH(.vertex_count = 4, .triangle_count = 2, .positions = positions,
                            .normals = normals, .uvs = {uvs}, .indices = indices);
    struct arena arena = {0};
    if (generate(&mesh, &arena)) {
        double x = 90 + 45 * sqrt(0.5), y = 45 * sqrt(0.5), length = hypot(x, y);
        check_tangent(mesh.tangents[0], x / length, y / length, 0, 1, "shared");
        check_tangent(mesh.tangents[1], 1, 0, 0, 1, "first alone");
        check_tangent(mesh.tangents[3], sqrt(0.5), sqrt(0.5), 0, 1, "second alone");
        // At (0, 1) the first triangle has 45 degrees, and the second one 90.
        x = 45 + 90 * sqrt(0.5), y = 90 * sqrt(0.5), length = hypot(x, y);
        check_tangent(mesh.tangents[2], x / length, y / length, 0, 1, "shared");
    }
    arena_finish(&arena);
}

// The direction is projected onto the plane of the vertex normal.
TEST(tangents_lie_in_the_plane_of_the_normal)
{
    float positions[3][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    float normals[3][3] = {{0.6f, 0, 0.8f}, {0, 0, 1}, {0, 0, 1}};
    float uvs[3][2] = {{0, 0}, {1, 0}, {0, -1}};
    uint32_t indices[1][3] = {{0, 1, 2}};
    struct mesh mesh = MESH(.vertex_count = 3, .triangle_count = 1, .positions = positions,
                            .normals = normals, .uvs = {uvs}, .indices = indices);
    struct arena arena = {0};
    if (generate(&mesh, &arena))
        check_tangent(mesh.tangents[0], 0.8, 0, -0.6, 1, "leaning");
    arena_finish(&arena);
}

// Two triangles that share only one vertex are not connected: each keeps its own direction.
TEST(touching_in_a_point)
{
    float positions[5][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}};
    float normals[5][3] = {{0, 0, 1}, {0, 0, 1}, {0, 0, 1}, {0, 0, 1}, {0, 0, 1}};
    float uvs[5][2] = {{0, 0}, {1, 0}, {0, -1}, {0, -1}, {-1, 0}};
    uint32_t indices[2][3] = {{0, 1, 2}, {0, 3, 4}};
    struct mesh mesh = MESH(.vertex_count = 5, .triangle_count = 2, .positions = positions,
                            .normals = normals, .uvs = {uvs}, .indices = indices);
    struct arena arena = {0};
    if (generate(&mesh, &arena)) {
        CHECK(mesh.vertex_count == 6, "%u", mesh.vertex_count);
        check_tangent(tangent_at(&mesh, 0, 0), 1, 0, 0, 1, "right");
        check_tangent(tangent_at(&mesh, 1, 0), 0, 1, 0, 1, "left");
    }
    arena_finish(&arena);
}

// A triangle whose corners have the same texture coordinates gets the tangents of its neighbour,
// mirrored or not. A triangle without area gets those of triangles that share its vertices.
TEST(triangles_without_a_direction)
{
    for (int mirrored = 0; mirrored < 2; mirrored++) {
        float sign = mirrored ? -1 : 1;
        float positions[5][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}, {1, 0, 0}};
        float normals[5][3] = {{0, 0, 1}, {0, 0, 1}, {0, 0, 1}, {0, 0, 1}, {0, 0, 1}};
        // (1, 0), (0, 1) and (1, 1) have the same u, so the second triangle has no area in texture
        // space.
        float uvs[5][2] = {{-sign, 0}, {0, 0}, {0, -1}, {0, -3}, {0, 0}};
        uint32_t indices[3][3] = {{1, 4, 3}, {0, 1, 2}, {1, 3, 2}};
        struct mesh mesh = MESH(.vertex_count = 5, .triangle_count = 3, .positions = positions,
                                .normals = normals, .uvs = {uvs}, .indices = indices);
        struct arena arena = {0};
        if (generate(&mesh, &arena)) {
            const float *expected = tangent_at(&mesh, 1, 1);
            CHECK(expected[3] == sign);
            CHECK(memcmp(expected, tangent_at(&mesh, 2, 0), 4 * sizeof(float)) == 0);
            CHECK(memcmp(expected, tangent_at(&mesh, 0, 0), 4 * sizeof(float)) == 0);
            CHECK(memcmp(expected, tangent_at(&mesh, 0, 1), 4 * sizeof(float)) == 0);
            // No triangle defines a direction at (1, 1), so any unit vector in the normal's plane
            // is correct.
            const float *free = tangent_at(&mesh, 2, 1);
            CHECK(fabs(hypot((double)free[0], (double)free[1]) - 1) < 1e-6 && free[2] == 0);
        }
        arena_finish(&arena);
    }
}

// A square whose middle has one pair of texture coordinates and whose border is a circle in the
// image; u increases along the sides. All four triangles are connected, and the contributions of
// opposite ones cancel.
TEST(pole)
{
    float positions[6][3] = {{0, 0, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}, {-1, -1, 0}, {1, -1, 0}};
    float normals[6][3], uvs[6][2] = {{0, 0}, {0, 1}, {.25f, 1}, {.5f, 1}, {.75f, 1}, {1, 1}};
    uint32_t indices[4][3] = {{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 5}};
    for (int v = 0; v < 6; v++)
        for (int i = 0; i < 3; i++)
            normals[v][i] = i == 2;
    struct mesh mesh = MESH(.vertex_count = 6, .triangle_count = 4, .positions = positions,
                            .normals = normals, .uvs = {uvs}, .indices = indices);
    struct arena arena = {0};
    if (generate(&mesh, &arena)) {
        CHECK(mesh.vertex_count == 9, "%u", mesh.vertex_count);
        check_tangent(tangent_at(&mesh, 0, 0), 0, 1, 0, 1, "right");
        check_tangent(tangent_at(&mesh, 1, 0), -1, 0, 0, 1, "top");
        check_tangent(tangent_at(&mesh, 2, 0), 0, -1, 0, 1, "left");
        check_tangent(tangent_at(&mesh, 3, 0), 1, 0, 0, 1, "bottom");
    }
    arena_finish(&arena);
}

// Three triangles share an edge: the first two that traverse it in opposite directions are
// connected.
TEST(edge_of_three_triangles)
{
    float positions[5][3] = {{0, 0, 0}, {0, 1, 0}, {1, 0, 0}, {-1, 0, 0}, {0, 0, 1}};
    float normals[5][3] = {{0, 0, 1}, {0, 0, 1}, {0, 0, 1}, {0, 0, 1}, {0, 0, 1}};
    float uvs[5][2] = {{0, 0}, {0, -1}, {1, 0}, {-1, -1}, {-1, 0}};
    uint32_t indices[3][3] = {{0, 2, 1}, {0, 1, 3}, {0, 1, 4}};
    struct mesh mesh = MESH(.vertex_count = 5, .triangle_count = 3, .positions = positions,
                            .normals = normals, .uvs = {uvs}, .indices = indices);
    struct arena arena = {0};
    if (generate(&mesh, &arena)) {
        CHECK(mesh.indices[0][0] == mesh.indices[1][0] && mesh.indices[0][0] != mesh.indices[2][0]);
        CHECK(mesh.vertex_count == 7, "%u", mesh.vertex_count);
    }
    arena_finish(&arena);
}

// --- against a slow search -----------------------------------------------------------------------

enum { GRID = 7, GRID_VERTICES = GRID * GRID, GRID_TRIANGLES = 2 * (GRID - 1) * (GRID - 1) };

struct grid {
    float positions[GRID_VERTICES][3], normals[GRID_VERTICES][3], uvs[GRID_VERTICES][2];
    uint32_t indices[GRID_TRIANGLES][3];
};

static double random_in(uint32_t *state, double low, double high)
{
    *state = *state * 1664525 + 1013904223;
    return low + (high - low) * (*state >> 8) / 16777216;
}

static void make_grid(struct grid *grid, uint32_t seed)
{
    uint32_t t = 0;
    for (uint32_t v = 0; v < GRID_VERTICES; v++) {
        double n[3] = {random_in(&seed, -.5, .5), random_in(&seed, -.5, .5), 1};
        double length = sqrt(n[0] * n[0] + n[1] * n[1] + 1);
        for (int i = 0; i < 3; i++)
            grid->normals[v][i] = (float)(n[i] / length);
        grid->positions[v][0] = (float)(v % GRID);
        grid->positions[v][1] = (float)(v / GRID);
        grid->positions[v][2] = (float)random_in(&seed, 0, .5);
        // The grid is so irregular that some triangles are mirrored.
        grid->uvs[v][0] = (float)((double)(v % GRID) + random_in(&seed, -.7, .7));
        grid->uvs[v][1] = (float)((double)(v / GRID) + random_in(&seed, -.7, .7));
    }
    for (uint32_t y = 0; y + 1 < GRID; y++)
        for (uint32_t x = 0; x + 1 < GRID; x++) {
            uint32_t a = y * GRID + x;
            const uint32_t two[2][3] = {{a, a + 1, a + GRID + 1}, {a, a + GRID + 1, a + GRID}};
            memcpy(grid->indices[t], two, sizeof two);
            t += 2;
        }
}

static void project(const float n[3], const double v[3], double out[3])
{
    double along = 0, square = 0;
    for (int i = 0; i < 3; i++)
        along += (double)n[i] * v[i];
    for (int i = 0; i < 3; i++) {
        out[i] = v[i] - along * (double)n[i];
        square += out[i] * out[i];
    }
    for (int i = 0; i < 3; i++)
        out[i] /= sqrt(square);
}

// Computes dP/du of a triangle by Cramer's rule. Returns the orientation of its map, with v
// upwards.
static double slow_direction(const struct grid *grid, uint32_t t, double out[3])
{
    const uint32_t *k = grid->indices[t];
    double e[2][2];
    for (int i = 0; i < 2; i++)
        for (int j = 0; j < 2; j++)
            e[i][j] = (double)grid->uvs[k[i + 1]][j] - (double)grid->uvs[k[0]][j];
    double determinant = e[0][0] * e[1][1] - e[0][1] * e[1][0];
    for (int i = 0; i < 3; i++) {
        double p0 = (double)grid->positions[k[0]][i];
        out[i] = (e[1][1] * ((double)grid->positions[k[1]][i] - p0) -
                  e[0][1] * ((double)grid->positions[k[2]][i] - p0)) /
                 determinant;
    }
    return determinant < 0 ? 1 : -1;
}

static int find_corner(const struct grid *grid, uint32_t t, uint32_t vertex)
{
    for (int c = 0; c < 3; c++)
        if (grid->indices[t][c] == vertex)
            return c;
    return -1;
}

static double slow_angle(const struct grid *grid, uint32_t t, int c)
{
    double edges[2][3], dot = 0;
    const uint32_t *k = grid->indices[t];
    for (int e = 0; e < 2; e++) {
        double edge[3];
        for (int i = 0; i < 3; i++)
            edge[i] =
                (double)grid->positions[k[(c + 1 + e) % 3]][i] - (double)grid->positions[k[c]][i];
        project(grid->normals[k[c]], edge, edges[e]);
    }
    for (int i = 0; i < 3; i++)
        dot += edges[0][i] * edges[1][i];
    return acos(dot);
}

static bool share_edge_at(const struct grid *grid, uint32_t a, uint32_t b, uint32_t vertex)
{
    int shared = 0;
    for (int c = 0; c < 3; c++)
        shared += find_corner(grid, b, grid->indices[a][c]) >= 0;
    return shared == 2 && find_corner(grid, a, vertex) >= 0 && find_corner(grid, b, vertex) >= 0;
}

// Returns whether triangles of one orientation connect two triangles at a vertex.
static bool in_one_group(const struct grid *grid, uint32_t from, uint32_t to, uint32_t vertex)
{
    bool reached[GRID_TRIANGLES] = {false}, grew = true;
    double d[3], side = slow_direction(grid, from, d);
    reached[from] = true;
    while (grew) {
        grew = false;
        for (uint32_t a = 0; a < GRID_TRIANGLES; a++)
            for (uint32_t b = 0; reached[a] && b < GRID_TRIANGLES; b++)
                if (!reached[b] && share_edge_at(grid, a, b, vertex) &&
                    slow_direction(grid, b, d) == side)
                    reached[b] = grew = true;
    }
    return reached[to];
}

static void slow_tangent(const struct grid *grid, uint32_t t, int c, double out[4])
{
    uint32_t vertex = grid->indices[t][c];
    double sum[3] = {0, 0, 0}, d[3];
    for (uint32_t other = 0; other < GRID_TRIANGLES; other++) {
        int at = find_corner(grid, other, vertex);
        if (at < 0 || !in_one_group(grid, t, other, vertex))
            continue;
        slow_direction(grid, other, d);
        project(grid->normals[vertex], d, d);
        for (int i = 0; i < 3; i++)
            sum[i] += slow_angle(grid, other, at) * d[i];
    }
    project(grid->normals[vertex], sum, out);
    out[3] = slow_direction(grid, t, d);
}

TEST(slow_search_agrees)
{
    static struct grid grid;
    uint32_t mirrored = 0, split = 0;
    for (uint32_t seed = 1; seed <= 4; seed++) {
        make_grid(&grid, seed);
        struct mesh mesh = MESH(.vertex_count = GRID_VERTICES, .triangle_count = GRID_TRIANGLES,
                                .positions = grid.positions, .normals = grid.normals,
                                .uvs = {grid.uvs}, .indices = grid.indices);
        struct arena arena = {0};
        if (!generate(&mesh, &arena))
            continue;
        for (uint32_t t = 0; t < GRID_TRIANGLES; t++)
            for (int c = 0; c < 3; c++) {
                double expected[4];
                slow_tangent(&grid, t, c, expected);
                check_tangent(tangent_at(&mesh, t, c), expected[0], expected[1], expected[2],
                              expected[3], "grid");
                mirrored += expected[3] < 0;
            }
        split += mesh.vertex_count - GRID_VERTICES;
        arena_finish(&arena);
    }
    // Both kinds must occur, or little is tested.
    CHECK(mirrored > 20 && split > 20, "%u mirrored corners, %u more vertices", mirrored, split);
}

// --- robustness ----------------------------------------------------------------------------------

// Triangles with arbitrary vertices, some degenerate, and with few distinct numbers.
TEST(soup)
{
    enum { VERTICES = 40, TRIANGLES = 300 };
    uint32_t seed = 7;
    for (int round = 0; round < 50; round++) {
        float positions[VERTICES][3], normals[VERTICES][3], uvs[VERTICES][2];
        uint32_t indices[TRIANGLES][3];
        for (int v = 0; v < VERTICES; v++) {
            for (int i = 0; i < 3; i++)
                positions[v][i] = (float)floor(random_in(&seed, 0, 3));
            for (int i = 0; i < 2; i++)
                uvs[v][i] = (float)floor(random_in(&seed, 0, 3));
            int axis = (int)random_in(&seed, 0, 4);
            for (int i = 0; i < 3; i++)
                normals[v][i] = i == axis ? 1 : 0; // the normal is zero for 3
        }
        for (int i = 0; i < 3 * TRIANGLES; i++)
            indices[i / 3][i % 3] = (uint32_t)random_in(&seed, 0, VERTICES);
        struct mesh mesh =
            MESH(.vertex_count = VERTICES, .triangle_count = TRIANGLES, .positions = positions,
                 .normals = round % 2 ? normals : NULL, .uvs = {uvs}, .indices = indices);
        struct arena arena = {0};
        if (!generate(&mesh, &arena))
            continue;
        for (uint32_t v = 0; v < mesh.vertex_count; v++) {
            const float *tangent = mesh.tangents[v];
            double square = 0, dot = 0;
            for (int i = 0; i < 3; i++) {
                square += (double)tangent[i] * (double)tangent[i];
                dot += mesh.normals ? (double)(tangent[i] * mesh.normals[v][i]) : 0;
            }
            CHECK(fabs(square - 1) < 1e-6 && fabs(dot) < 1e-6 && fabsf(tangent[3]) == 1);
        }
        for (uint32_t i = 0; i < 3 * mesh.triangle_count; i++)
            CHECK(mesh.indices[i / 3][i % 3] < mesh.vertex_count);
        arena_finish(&arena);
    }
}

TEST(allocation_failures)
{
    float positions[3][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, uvs[3][2] = {{0, 0}, {1, 0}, {0, 1}};
    uint32_t indices[2][3] = {{0, 1, 2}, {0, 2, 1}};
    for (uint64_t n = 1;; n++) {
        struct mesh mesh = MESH(.vertex_count = 3, .triangle_count = 2, .positions = positions,
                                .uvs = {uvs}, .indices = indices);
        struct arena arena = {0};
        struct err err = {0};
        arena_fail_at(n);
        bool ok = mesh_generate_tangents(&mesh, 0, NULL, &arena, &err);
        arena_fail_at(0);
        arena_finish(&arena);
        CHECK(ok || err.code == ERR_SYSTEM, "%s", err.msg);
        if (ok || n > 100) {
            CHECK(n > 10 && n < 100);
            break;
        }
    }
}

// --- scenes --------------------------------------------------------------------------------------

// Finds by which texture coordinates a material's tangents are computed, from the result.
static float tangent_x(const struct texture *textures, uint32_t count, float anisotropic)
{
    float positions[3][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    float uvs[2][3][2] = {{{0, 0}, {1, 0}, {0, -1}}, {{0, 0}, {-1, 0}, {0, -1}}};
    uint32_t indices[1][3] = {{0, 1, 2}};
    struct scene scene = {.path = "test"};
    struct err err = {0};
    struct mesh mesh = MESH(.vertex_count = 3, .triangle_count = 1, .positions = positions,
                            .uvs = {uvs[0], uvs[1]}, .indices = indices);
    struct material *material = scene_add_material(&scene, &mesh.material);
    material_init(material);
    material->anisotropic = anisotropic;
    material->texture_count = count;
    for (uint32_t i = 0; i < count; i++)
        *scene_add_texture(&scene, NULL) = textures[i];
    CHECK(scene_append_mesh(&scene, &mesh, NULL, &err) && scene_place_meshes(&scene, 0, 1, &err) &&
              scene_generate_tangents(&scene, &err),
          "%s", err.msg);
    float x = scene.meshes[0].tangents ? scene.meshes[0].tangents[0][0] : 0;
    scene_finish(&scene);
    return x;
}

TEST(which_meshes_get_tangents)
{
    const struct texture base = {.flags = TEXTURE_UV1};
    const struct texture normal_0 = {.flags = TEXTURE_USE_NORMAL << TEXTURE_USE_SHIFT};
    const struct texture normal_1 = {.flags =
                                         TEXTURE_USE_NORMAL << TEXTURE_USE_SHIFT | TEXTURE_UV1};
    const struct texture turn_1 = {.flags =
                                       TEXTURE_USE_ANISOTROPY << TEXTURE_USE_SHIFT | TEXTURE_UV1};
    CHECK(tangent_x(NULL, 0, 0) == 0);
    CHECK(tangent_x(NULL, 0, 0.5f) == 1);
    CHECK(tangent_x(&base, 1, 0) == 0);
    CHECK(tangent_x((struct texture[]){base, normal_0}, 2, 0) == 1);
    CHECK(tangent_x((struct texture[]){base, normal_1}, 2, 0) == -1);
    CHECK(tangent_x(&turn_1, 1, 0) == 0);
    CHECK(tangent_x(&turn_1, 1, 0.5f) == -1);
    CHECK(tangent_x((struct texture[]){turn_1, normal_0}, 2, 0.5f) == 1);
}

TEST_MAIN(TEST_CASE(upright_square), TEST_CASE(mirrored_halves), TEST_CASE(cube_with_seams),
          TEST_CASE(sphere), TEST_CASE(mirrored_sphere), TEST_CASE(weights_are_angles),
          TEST_CASE(tangents_lie_in_the_plane_of_the_normal), TEST_CASE(touching_in_a_point),
          TEST_CASE(triangles_without_a_direction), TEST_CASE(pole),
          TEST_CASE(edge_of_three_triangles), TEST_CASE(slow_search_agrees), TEST_CASE(soup),
          TEST_CASE(allocation_failures), TEST_CASE(which_meshes_get_tangents))
