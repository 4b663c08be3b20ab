#include "scene/generate/scatter.h"

#include "base/maths.h"
#include <math.h>

#define TRIES 1024
#define GRID_CELLS_MAX 1024 // cells per side
#define NOTHING UINT32_MAX

// --- random numbers ------------------------------------------------------------------------------

// Mixes bits by the finalizer of MurmurHash3 (Appleby 2011): a bijection in which every output bit
// depends on all input bits.
static uint32_t mix(uint32_t x)
{
    x = (x ^ x >> 16) * 0x85ebca6bu;
    x = (x ^ x >> 13) * 0xc2b2ae35u;
    return x ^ x >> 16;
}

uint32_t scatter_bits(uint32_t seed, uint32_t item, uint32_t n)
{
    return mix(mix(mix(seed + 0x9e3779b9u) ^ item) + n * 0x9e3779b9u);
}

// Returns a number in [0, 1).
static double random_number(const struct scatter *scatter, uint32_t sphere, uint32_t n)
{
    return scatter_bits(scatter->seed, sphere, n) * 0x1p-32;
}

// --- placing -------------------------------------------------------------------------------------

// A grid that lists the spheres by the cell of their centre. A cell is at least as wide as the
// largest horizontal distance between the centres of two overlapping spheres.
struct grid {
    uint32_t side;
    double origin, cells_per_metre;
    uint32_t *first, *next; // first sphere of each cell; next sphere in the same cell
};

static uint32_t cell_of(const struct grid *grid, double x)
{
    double cell = floor((x - grid->origin) * grid->cells_per_metre);
    return cell < 0 ? 0 : cell >= grid->side ? grid->side - 1 : (uint32_t)cell;
}

// Returns whether two spheres on a plane overlap: they touch if the squared distance of their
// contact points with the plane is 4 r1 r2.
static bool overlap(const struct scattered_sphere *a, const struct scattered_sphere *b)
{
    double x = a->center[0] - b->center[0], z = a->center[2] - b->center[2];
    return x * x + z * z < 4 * a->radius * b->radius;
}

static bool is_free(const struct grid *grid, const struct scattered_sphere *spheres,
                    const struct scattered_sphere *sphere, uint64_t *compared)
{
    uint32_t x = cell_of(grid, sphere->center[0]), z = cell_of(grid, sphere->center[2]);
    for (uint32_t j = z > 0 ? z - 1 : 0; j <= z + 1 && j < grid->side; j++)
        for (uint32_t i = x > 0 ? x - 1 : 0; i <= x + 1 && i < grid->side; i++)
            for (uint32_t s = grid->first[j * grid->side + i]; s != NOTHING; s = grid->next[s])
                if (++*compared, overlap(sphere, &spheres[s]))
                    return false;
    return true;
}

// Counts tries and comparisons, so that stops are polled for at even intervals. A position may take
// a thousand tries, and a try as many comparisons as there are spheres.
struct polling {
    uint64_t work, polled; // comparisons and tries, in total and at the last poll
    bool is_stopped;
};

static void poll(struct polling *polling, const struct progress *progress)
{
    if (polling->work - polling->polled < 65536)
        return;
    polling->polled = polling->work;
    polling->is_stopped = progress_should_stop(progress);
}

// Finds a free position. Positions are uniform over the part of the disc in which the whole sphere
// lies above the disc.
static bool find_place(const struct scatter *scatter, const struct grid *grid,
                       const struct scattered_sphere *spheres, uint32_t number,
                       struct scattered_sphere *sphere, struct polling *polling)
{
    double reach = scatter->disc_radius - sphere->radius;
    for (uint32_t try = 0; try < TRIES && !polling->is_stopped; try++, polling->work++) {
        double x = 2 * random_number(scatter, number, 2 + 2 * try) - 1;
        double z = 2 * random_number(scatter, number, 3 + 2 * try) - 1;
        if (x * x + z * z > 1)
            continue;
        sphere->center[0] = reach * x;
        sphere->center[2] = reach * z;
        if (is_free(grid, spheres, sphere, &polling->work))
            return true;
        poll(polling, scatter->progress);
    }
    return false;
}

static bool grid_init(const struct scatter *scatter, struct arena *scratch, struct grid *grid)
{
    double side = fmin(scatter->disc_radius / scatter->max_radius, GRID_CELLS_MAX);
    *grid = (struct grid){.side = side < 1 ? 1 : (uint32_t)side, .origin = -scatter->disc_radius};
    grid->cells_per_metre = grid->side / (2 * scatter->disc_radius);
    uint32_t cells = grid->side * grid->side;
    grid->first = ARENA_NEW(scratch, uint32_t, cells);
    grid->next = ARENA_NEW(scratch, uint32_t, scatter->count);
    for (uint32_t i = 0; grid->first && i < cells; i++)
        grid->first[i] = NOTHING;
    return grid->first && grid->next;
}

uint64_t scatter_spheres_bytes(uint32_t count)
{
    const struct grid *grid = NULL;
    return count * (uint64_t)(sizeof(struct scattered_sphere) + sizeof *grid->next);
}

bool scatter_spheres(const struct scatter *scatter, struct arena *scratch,
                     struct scattered_sphere *out, uint32_t *placed, struct err *err)
{
    struct grid grid;
    if (!grid_init(scatter, scratch, &grid))
        return err_memory(err, "the grid of scattered spheres", 4ull * scatter->count);
    struct polling polling = {0};
    *placed = 0;
    for (uint32_t number = 0; number < scatter->count; number++) {
        struct scattered_sphere sphere = {.choice = scatter_bits(scatter->seed, number, 0)};
        double u = random_number(scatter, number, 1);
        sphere.radius =
            scatter->min_radius + (scatter->max_radius - scatter->min_radius) * u * u * u;
        sphere.center[1] = sphere.radius;
        bool is_placed = find_place(scatter, &grid, out, number, &sphere, &polling);
        poll(&polling, scatter->progress);
        if (polling.is_stopped)
            return err_set(err, ERR_STOPPED, "stopped while scattering spheres");
        if (!is_placed)
            continue;
        uint32_t cell =
            cell_of(&grid, sphere.center[2]) * grid.side + cell_of(&grid, sphere.center[0]);
        grid.next[*placed] = grid.first[cell];
        grid.first[cell] = *placed;
        out[(*placed)++] = sphere;
    }
    return true;
}

// --- spheres of triangles ------------------------------------------------------------------------

static void to_sphere(const double p[3], float out[3])
{
    double length = vec3_norm(p);
    for (int c = 0; c < 3; c++)
        out[c] = (float)(p[c] / length);
}

static void between(const double a[3], const double b[3], double out[3])
{
    double sum[3] = {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
    double length = vec3_norm(sum);
    for (int c = 0; c < 3; c++)
        out[c] = sum[c] / length;
}

// Splits a triangle recursively. Vertices are not shared, but neighbours compute equal midpoints,
// because they use the same two ends.
static void split(struct mesh *mesh, const double a[3], const double b[3], const double c[3],
                  uint32_t subdivision)
{
    if (subdivision > 0) {
        double ab[3], bc[3], ca[3];
        between(a, b, ab);
        between(b, c, bc);
        between(c, a, ca);
        split(mesh, a, ab, ca, subdivision - 1);
        split(mesh, ab, b, bc, subdivision - 1);
        split(mesh, ca, bc, c, subdivision - 1);
        split(mesh, ab, bc, ca, subdivision - 1);
        return;
    }
    const double *const corners[3] = {a, b, c};
    uint32_t triangle = mesh->triangle_count++;
    for (int i = 0; i < 3; i++) {
        uint32_t vertex = mesh->vertex_count++;
        mesh->indices[triangle][i] = vertex;
        to_sphere(corners[i], mesh->positions[vertex]);
        to_sphere(corners[i], mesh->normals[vertex]);
    }
}

static uint32_t icosphere_triangles(uint32_t subdivision)
{
    return 20u << 2 * subdivision;
}

uint64_t generate_icosphere_bytes(uint32_t subdivision)
{
    const struct mesh *mesh = NULL;
    return icosphere_triangles(subdivision) *
           (uint64_t)(3 * (sizeof *mesh->positions + sizeof *mesh->normals) +
                      sizeof *mesh->indices);
}

bool generate_icosphere(struct scene *scene, uint32_t subdivision, uint32_t *index, struct err *err)
{
    // The corners of an icosahedron are those of three golden rectangles. The faces are
    // counter-clockwise as seen from outside.
    static const double g = 1.6180339887498949;
    const double corners[12][3] = {{-1, g, 0}, {1, g, 0}, {-1, -g, 0}, {1, -g, 0},
                                   {0, -1, g}, {0, 1, g}, {0, -1, -g}, {0, 1, -g},
                                   {g, 0, -1}, {g, 0, 1}, {-g, 0, -1}, {-g, 0, 1}};
    static const uint32_t faces[20][3] = {
        {0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
        {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
        {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
    uint32_t triangles = icosphere_triangles(subdivision);
    struct mesh mesh = {.name = "icosphere"};
    struct arena *arena = &scene->arena;
    mesh.positions = arena_alloc(arena, 3ull * triangles, sizeof *mesh.positions);
    mesh.normals = arena_alloc(arena, 3ull * triangles, sizeof *mesh.normals);
    mesh.indices = arena_alloc(arena, triangles, sizeof *mesh.indices);
    if (!mesh.positions || !mesh.normals || !mesh.indices)
        return err_memory(err, "a sphere of triangles", generate_icosphere_bytes(subdivision));
    for (int f = 0; f < 20; f++)
        split(&mesh, corners[faces[f][0]], corners[faces[f][1]], corners[faces[f][2]], subdivision);
    return scene_append_mesh(scene, &mesh, index, err);
}
