// The Utah teapot: 32 bicubic Bezier patches (M. Newell, University of Utah, 1975; the four patches
// of the bottom were added later: F. Crow, "The Origins of the Teapot", IEEE CG&A 7(1), 1987).
//
// The published patches are of two kinds, so that a few numbers define them all: surfaces of
// revolution, in which each control point of a profile makes a quarter circle, and tubes, in which
// each section makes two halves. z is up in these numbers; the mesh has y up.
#include "scene/generate/generate.h"

#include "base/maths.h"
#include <math.h>
#include <string.h>

// A control point of a profile. A quarter circle about the axis is approximated by the control
// points (radius, 0), (radius, handle), (handle, radius), (0, radius).
struct ring {
    double radius, handle, height;
};

// Profiles: the body from the rim's inner edge to the bottom's edge, the lid from its knob to its
// edge, the bottom from its edge to its centre. The outside is to the right along each profile.
static const struct ring body[] = {
    {1.4, 0.784, 2.4},   {1.3375, 0.749, 2.53125}, {1.4375, 0.805, 2.53125}, {1.5, 0.84, 2.4},
    {1.75, 0.98, 1.875}, {2.0, 1.12, 1.35},        {2.0, 1.12, 0.9},         {2.0, 1.12, 0.45},
    {1.5, 0.84, 0.225},  {1.5, 0.84, 0.15},
};
static const struct ring lid[] = {
    {0.0, 0.0, 3.15},   {0.8, 0.45, 3.15},  {0.0, 0.0, 2.85},  {0.2, 0.112, 2.7},
    {0.4, 0.224, 2.55}, {1.3, 0.728, 2.55}, {1.3, 0.728, 2.4},
};
static const struct ring bottom[] = {
    {1.5, 0.84, 0.15},
    {1.5, 0.84, 0.075},
    {1.425, 0.798, 0.0},
    {0.0, 0.0, 0.0},
};

// A control point of a tube: (x, z) of the sides on which the first half begins and ends, and the
// distance from the plane y = 0 of the two control points between these sides.
struct section {
    double near[2], far[2], half_width;
};

static const struct section handle[] = {
    {{-1.6, 2.025}, {-1.5, 2.25}, 0.3}, {{-2.3, 2.025}, {-2.5, 2.25}, 0.3},
    {{-2.7, 2.025}, {-3.0, 2.25}, 0.3}, {{-2.7, 1.8}, {-3.0, 1.8}, 0.3},
    {{-2.7, 1.575}, {-3.0, 1.35}, 0.3}, {{-2.5, 1.125}, {-2.65, 0.9375}, 0.3},
    {{-2.0, 0.9}, {-1.9, 0.6}, 0.3},
};
static const struct section spout[] = {
    {{1.7, 1.425}, {1.7, 0.6}, 0.66},       {{2.6, 1.425}, {3.1, 0.825}, 0.66},
    {{2.3, 2.1}, {2.4, 2.025}, 0.25},       {{2.7, 2.4}, {3.3, 2.4}, 0.25},
    {{2.8, 2.475}, {3.525, 2.49375}, 0.25}, {{2.9, 2.475}, {3.45, 2.5125}, 0.15},
    {{2.8, 2.4}, {3.2, 2.4}, 0.15},
};

// A profile or a tube: a chain of curves, each of which begins at the last point of the previous
// one, swept over two halves or four quarters.
static const struct part {
    const struct ring *rings;       // NULL: a tube
    const struct section *sections; // NULL: a profile
    uint32_t curves, turns;
} parts[] = {
    {body, NULL, 3, 4},   {lid, NULL, 2, 4},   {bottom, NULL, 1, 4},
    {NULL, handle, 2, 2}, {NULL, spout, 2, 2},
};
#define PART_COUNT (sizeof parts / sizeof *parts)
#define PATCH_COUNT 32

// --- patches -------------------------------------------------------------------------------------

struct patch {
    double points[4][4][3];      // [along the profile][across it]
    bool pole_first, pole_last;  // the first or last row is one point
    double s, s_size, t, t_size; // range of the texture coordinates
};

static void revolve(const struct ring *rings, uint32_t turn, struct patch *patch)
{
    for (int row = 0; row < 4; row++) {
        const struct ring *ring = &rings[row];
        const double quarter[4][2] = {
            {ring->radius, 0},
            {ring->radius, ring->handle},
            {ring->handle, ring->radius},
            {0, ring->radius},
        };
        for (int column = 0; column < 4; column++) {
            double x = quarter[column][0], y = quarter[column][1],
                   *point = patch->points[row][column];
            for (uint32_t i = 0; i < turn; i++) {
                double turned = x;
                x = -y;
                y = turned;
            }
            point[0] = x;
            point[1] = y;
            point[2] = ring->height;
        }
    }
    patch->pole_first = rings[0].radius == 0.0;
    patch->pole_last = rings[3].radius == 0.0;
}

// The second half begins where the first one ends, so that the outside stays on the same side.
static void sweep(const struct section *sections, uint32_t turn, struct patch *patch)
{
    for (int row = 0; row < 4; row++) {
        const struct section *section = &sections[row];
        const double *begin = turn ? section->far : section->near;
        const double *end = turn ? section->near : section->far;
        double width = turn ? -section->half_width : section->half_width;
        for (int column = 0; column < 4; column++) {
            const double *side = column < 2 ? begin : end;
            double *point = patch->points[row][column];
            point[0] = side[0];
            point[1] = column == 1 || column == 2 ? width : 0.0;
            point[2] = side[1];
        }
    }
    patch->pole_first = patch->pole_last = false;
}

static struct patch make_patch(const struct part *part, uint32_t curve, uint32_t turn)
{
    struct patch patch = {
        .s = (double)turn / part->turns,
        .s_size = 1.0 / part->turns,
        .t = (double)curve / part->curves,
        .t_size = 1.0 / part->curves,
    };
    if (part->rings)
        revolve(part->rings + 3 * curve, turn, &patch);
    else
        sweep(part->sections + 3 * curve, turn, &patch);
    return patch;
}

// --- points on a patch ---------------------------------------------------------------------------

// Computes the weights of the four control points for a point and for the derivative of a cubic
// curve. The derivative's weights apply to differences of control points, so that it is exactly 0
// where these are 0.
static void bernstein(double t, double point[4], double difference[3])
{
    double s = 1.0 - t;
    point[0] = s * s * s;
    point[1] = 3.0 * s * s * t;
    point[2] = 3.0 * s * t * t;
    point[3] = t * t * t;
    difference[0] = 3.0 * s * s;
    difference[1] = 6.0 * s * t;
    difference[2] = 3.0 * t * t;
}

// Computes a point and the derivative at v for one row of control points.
static void evaluate_row(const double row[4][3], const double weight[4], const double difference[3],
                         double point[3], double derivative[3])
{
    for (int i = 0; i < 3; i++) {
        point[i] = derivative[i] = 0.0;
        for (int j = 0; j < 4; j++)
            point[i] += weight[j] * row[j][i];
        for (int j = 0; j < 3; j++)
            derivative[i] += difference[j] * (row[j + 1][i] - row[j][i]);
    }
}

// Computes the point and the normal dP/du x dP/dv. At a pole, dP/dv vanishes like u or 1 - u; its
// direction is that of d2P/dudv at u = 0, and the opposite at u = 1.
static void evaluate(const struct patch *patch, double u, double v, double point[3],
                     double normal[3])
{
    double across[4], across_difference[3], along[4], along_difference[3];
    double rows[4][3], row_slopes[4][3];
    bernstein(v, across, across_difference);
    bernstein(u, along, along_difference);
    for (int row = 0; row < 4; row++)
        evaluate_row(patch->points[row], across, across_difference, rows[row], row_slopes[row]);
    double du[3], dv[3], dudv[3];
    evaluate_row(rows, along, along_difference, point, du);
    evaluate_row(row_slopes, along, along_difference, dv, dudv);
    bool at_first = patch->pole_first && u == 0.0, at_last = patch->pole_last && u == 1.0;
    for (int i = 0; i < 3; i++)
        dv[i] = at_first ? dudv[i] : at_last ? -dudv[i] : dv[i];
    vec3_cross(du, dv, normal);
    double length = vec3_norm(normal);
    for (int i = 0; i < 3; i++)
        normal[i] /= length;
}

// --- the mesh ------------------------------------------------------------------------------------

// Converts from z up to y up.
static void store(const double v[3], float out[3])
{
    out[0] = (float)v[0];
    out[1] = (float)v[2];
    out[2] = (float)-v[1];
}

static void add_triangle(struct mesh *mesh, uint32_t a, uint32_t b, uint32_t c)
{
    uint32_t *corners = mesh->indices[mesh->triangle_count++];
    corners[0] = a;
    corners[1] = b;
    corners[2] = c;
}

static void add_patch(const struct patch *patch, uint32_t resolution, struct mesh *mesh)
{
    uint32_t first = mesh->vertex_count, side = resolution + 1;
    for (uint32_t row = 0; row <= resolution; row++) {
        for (uint32_t column = 0; column <= resolution; column++) {
            double u = (double)row / resolution, v = (double)column / resolution;
            double point[3], normal[3];
            uint32_t vertex = mesh->vertex_count++;
            evaluate(patch, u, v, point, normal);
            store(point, mesh->positions[vertex]);
            store(normal, mesh->normals[vertex]);
            mesh->uvs[0][vertex][0] = (float)(patch->s + v * patch->s_size);
            mesh->uvs[0][vertex][1] = (float)(patch->t + u * patch->t_size);
        }
    }
    for (uint32_t row = 0; row < resolution; row++) {
        for (uint32_t column = 0; column < resolution; column++) {
            uint32_t a = first + row * side + column, b = a + 1, c = a + side, d = c + 1;
            if (!patch->pole_last || row + 1 < resolution)
                add_triangle(mesh, a, c, d);
            if (!patch->pole_first || row > 0)
                add_triangle(mesh, a, d, b);
        }
    }
}

uint64_t generate_teapot_bytes(uint32_t resolution)
{
    const struct mesh *mesh = NULL;
    uint64_t cells = (uint64_t)resolution * resolution, side = resolution + 1ull;
    return PATCH_COUNT *
           (side * side * (sizeof *mesh->positions + sizeof *mesh->normals + sizeof *mesh->uvs[0]) +
            2 * cells * sizeof *mesh->indices);
}

bool generate_teapot(struct scene *scene, uint32_t resolution, uint32_t material, uint32_t *index,
                     struct err *err)
{
    struct arena *arena = &scene->arena;
    struct mesh mesh = {.name = "teapot", .material = material};
    uint32_t vertices = PATCH_COUNT * (resolution + 1) * (resolution + 1);
    uint32_t triangles = PATCH_COUNT * 2 * resolution * resolution;
    mesh.positions = arena_alloc(arena, vertices, sizeof *mesh.positions);
    mesh.normals = arena_alloc(arena, vertices, sizeof *mesh.normals);
    mesh.uvs[0] = arena_alloc(arena, vertices, sizeof *mesh.uvs[0]);
    mesh.indices = arena_alloc(arena, triangles, sizeof *mesh.indices);
    if (!mesh.positions || !mesh.normals || !mesh.uvs[0] || !mesh.indices)
        return err_memory(err, "a teapot", generate_teapot_bytes(resolution));
    for (size_t p = 0; p < PART_COUNT; p++) {
        for (uint32_t curve = 0; curve < parts[p].curves; curve++) {
            for (uint32_t turn = 0; turn < parts[p].turns; turn++) {
                if (!scene_goes_on(scene, 0, err))
                    return false;
                struct patch patch = make_patch(&parts[p], curve, turn);
                add_patch(&patch, resolution, &mesh);
            }
        }
    }
    return scene_append_mesh(scene, &mesh, index, err);
}
