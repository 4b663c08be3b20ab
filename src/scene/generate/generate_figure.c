// Converts a figure's field to a mesh by surface nets (Gibson 1998, "Constrained elastic surface
// nets"), with each vertex at the mean of its cell's crossings. The quadrilaterals are split into
// four as often as needed. Then the vertices are moved to the surface and displaced along its
// normal. Figures with few triangles are simplified from a finer mesh (Garland and Heckbert 1997,
// by meshoptimizer), so that the triangles are where the shape needs them.
#include "scene/generate/figure_field.h"

#include "base/maths.h"
#include "base/parallel.h"
#include <math.h>
#include <meshoptimizer.h>
#include <string.h>

#define NOTHING UINT32_MAX
// The maximum number of quadrilaterals in the net; finer meshes are made by splitting these.
#define NET_MAX 40000.0
// Figures of fewer than SIMPLIFIED_BELOW triangles are simplified from a mesh with SIMPLIFIED_OF
// times as many triangles, and at least SIMPLIFIED_MIN.
#define SIMPLIFIED_BELOW 50000u
#define SIMPLIFIED_OF 12.0
#define SIMPLIFIED_MIN 24000.0
#define FIRST_STEPS 40 // grid steps along the figure's longest side, while its area is unknown

struct grid {
    double origin[3], step;
    uint32_t size[3]; // number of samples along each axis
    float *values;
    uint32_t *vertices; // for each sample, the vertex of the cell that begins there
};

struct net {
    double (*positions)[3];
    uint32_t (*quads)[4];
    uint32_t vertex_count, quad_count;
};

// --- sampling ------------------------------------------------------------------------------------

// The distance to the surface is at least this fraction of the field's value. The values of
// ellipsoids overestimate distances by at most a factor of two in these figures.
#define SAFE_PART 0.4

struct sampling {
    const struct figure_field *field;
    struct grid *grid;
    const struct progress *progress;
};

static size_t sample_index(const struct grid *grid, uint32_t x, uint32_t y, uint32_t z)
{
    return ((size_t)z * grid->size[1] + y) * grid->size[0] + x;
}

static void sample_rows(void *context, size_t begin, size_t end, unsigned thread)
{
    (void)thread;
    const struct sampling *s = context;
    const struct grid *g = s->grid;
    for (size_t row = begin; row < end && !progress_should_stop(s->progress); row++)
        for (uint32_t x = 0, next; x < g->size[0]; x = next) {
            const double p[3] = {g->origin[0] + g->step * x,
                                 g->origin[1] + g->step * (double)(row % g->size[1]),
                                 g->origin[2] + g->step * (double)(row / g->size[1])};
            double value = figure_field_value(s->field, p, NULL);
            // Samples that are nearer than the distance to the surface are on the same side of the
            // surface.
            double known = SAFE_PART * fabs(value) / g->step;
            next = x + 1 + (known < g->size[0] - x - 1 ? (uint32_t)known : g->size[0] - x - 1);
            for (uint32_t i = x; i < next; i++)
                g->values[row * g->size[0] + i] = (float)value;
        }
}

// Makes a grid with a margin of one cell around the figure.
static bool grid_make(const struct figure_field *field, double step,
                      const struct progress *progress, struct arena *arena, struct grid *out)
{
    *out = (struct grid){.step = step};
    size_t count = 1;
    for (int i = 0; i < 3; i++) {
        out->origin[i] = field->low[i] - 1.5 * step;
        out->size[i] = (uint32_t)ceil((field->high[i] - field->low[i]) / step) + 4;
        count *= out->size[i];
    }
    out->values = ARENA_NEW(arena, float, count);
    out->vertices = ARENA_NEW(arena, uint32_t, count);
    if (!out->values || !out->vertices)
        return false;
    struct sampling sampling = {field, out, progress};
    parallel_for((size_t)out->size[1] * out->size[2], 64, 0, sample_rows, &sampling);
    return true;
}

// --- the net -------------------------------------------------------------------------------------

// Computes the mean of the points where the surface crosses the edges of a cell. Returns false if
// it crosses none.
static bool cell_vertex(const struct grid *g, const uint32_t cell[3], double out[3])
{
    double sum[3] = {0, 0, 0};
    uint32_t crossings = 0;
    for (uint32_t edge = 0; edge < 12; edge++) {
        uint32_t axis = edge / 4, from[3], to[3];
        for (uint32_t i = 0; i < 3; i++)
            from[i] = to[i] = cell[i];
        from[(axis + 1) % 3] = to[(axis + 1) % 3] += edge & 1;
        from[(axis + 2) % 3] = to[(axis + 2) % 3] += edge >> 1 & 1;
        to[axis]++;
        double a = (double)g->values[sample_index(g, from[0], from[1], from[2])];
        double b = (double)g->values[sample_index(g, to[0], to[1], to[2])];
        if ((a < 0) == (b < 0))
            continue;
        crossings++;
        for (uint32_t i = 0; i < 3; i++)
            sum[i] += from[i] + (i == axis ? a / (a - b) : 0);
    }
    for (int i = 0; i < 3 && crossings > 0; i++)
        out[i] = g->origin[i] + g->step * sum[i] / crossings;
    return crossings > 0;
}

// Places a vertex in each cell that the surface crosses. Stores the positions unless `positions` is
// NULL, and returns their number.
static uint32_t place_vertices(struct grid *g, double (*positions)[3])
{
    uint32_t count = 0;
    for (uint32_t z = 0; z + 1 < g->size[2]; z++)
        for (uint32_t y = 0; y + 1 < g->size[1]; y++)
            for (uint32_t x = 0; x + 1 < g->size[0]; x++) {
                double place[3];
                size_t index = sample_index(g, x, y, z);
                g->vertices[index] = NOTHING;
                if (!cell_vertex(g, (const uint32_t[]){x, y, z}, place))
                    continue;
                if (positions)
                    memcpy(positions[count], place, sizeof place);
                g->vertices[index] = count++;
            }
    return count;
}

// Makes a quadrilateral around each edge of the grid that the surface crosses, from the vertices of
// the four adjacent cells, counter-clockwise as seen from outside.
static uint32_t place_quads(const struct grid *g, uint32_t (*quads)[4])
{
    const size_t strides[3] = {1, g->size[0], (size_t)g->size[0] * g->size[1]};
    uint32_t count = 0;
    for (uint32_t z = 1; z + 1 < g->size[2]; z++)
        for (uint32_t y = 1; y + 1 < g->size[1]; y++)
            for (uint32_t x = 1; x + 1 < g->size[0]; x++)
                for (int axis = 0; axis < 3; axis++) {
                    size_t at = sample_index(g, x, y, z);
                    size_t u = strides[(axis + 1) % 3], v = strides[(axis + 2) % 3];
                    bool inside = g->values[at] < 0;
                    if (inside == (g->values[at + strides[axis]] < 0))
                        continue;
                    const uint32_t around[4] = {g->vertices[at - u - v], g->vertices[at - v],
                                                g->vertices[at], g->vertices[at - u]};
                    for (int i = 0; i < 4 && quads; i++)
                        quads[count][i] = around[inside ? i : 3 - i];
                    count++;
                }
    return count;
}

static bool net_make(struct grid *grid, struct arena *arena, struct net *out)
{
    out->vertex_count = place_vertices(grid, NULL);
    out->quad_count = place_quads(grid, NULL);
    out->positions = arena_alloc(arena, out->vertex_count, sizeof *out->positions);
    out->quads = arena_alloc(arena, out->quad_count, sizeof *out->quads);
    if (!out->positions || !out->quads)
        return false;
    place_vertices(grid, out->positions);
    place_quads(grid, out->quads);
    return true;
}

// --- splitting -----------------------------------------------------------------------------------

// A hash table of the midpoints of edges, indexed by the edges' ends; at most half full.
struct middles {
    struct {
        uint32_t ends[2], vertex;
    } * slots;
    uint32_t mask;
};

static uint32_t middle_of(struct middles *table, struct net *net, uint32_t a, uint32_t b)
{
    uint32_t low = a < b ? a : b, high = a < b ? b : a;
    uint32_t slot = (low * 0x9e3779b1u ^ high * 0x85ebca77u) >> 3 & table->mask;
    while (table->slots[slot].vertex != 0) { // vertex 0 is never a midpoint
        if (table->slots[slot].ends[0] == low && table->slots[slot].ends[1] == high)
            return table->slots[slot].vertex;
        slot = (slot + 1) & table->mask;
    }
    uint32_t vertex = net->vertex_count++;
    for (int i = 0; i < 3; i++)
        net->positions[vertex][i] = 0.5 * (net->positions[a][i] + net->positions[b][i]);
    table->slots[slot].ends[0] = low;
    table->slots[slot].ends[1] = high;
    table->slots[slot].vertex = vertex;
    return vertex;
}

// Splits each quadrilateral into four around its centre.
static bool net_split(struct arena *arena, struct net *net)
{
    struct net old = *net;
    struct arena scratch = {0};
    struct middles table = {.mask = 1};
    // A closed net has twice as many edges as quadrilaterals.
    while (table.mask < 4 * (uint64_t)old.quad_count)
        table.mask *= 2;
    table.slots = arena_alloc(&scratch, table.mask--, sizeof *table.slots);
    net->positions = arena_alloc(arena, (size_t)old.vertex_count + 3 * (size_t)old.quad_count,
                                 sizeof *net->positions);
    net->quads = arena_alloc(arena, 4 * (size_t)old.quad_count, sizeof *net->quads);
    bool ok = table.slots && net->positions && net->quads;
    if (ok)
        memcpy(net->positions, old.positions, old.vertex_count * sizeof *old.positions);
    net->quad_count = 0;
    for (uint32_t q = 0; ok && q < old.quad_count; q++) {
        const uint32_t *corner = old.quads[q];
        uint32_t middle[4], center = net->vertex_count++;
        for (int i = 0; i < 4; i++)
            middle[i] = middle_of(&table, net, corner[i], corner[(i + 1) % 4]);
        for (int i = 0; i < 3; i++)
            net->positions[center][i] =
                0.5 * (net->positions[middle[0]][i] + net->positions[middle[2]][i]);
        for (int i = 0; i < 4; i++) {
            const uint32_t part[4] = {corner[i], middle[i], center, middle[(i + 3) % 4]};
            memcpy(net->quads[net->quad_count++], part, sizeof part);
        }
    }
    arena_finish(&scratch);
    return ok;
}

// --- the surface ---------------------------------------------------------------------------------

struct displacement {
    const struct figure_field *field;
    const struct net *net;
    double edge; // edge length of the mesh
    const struct progress *progress;
};

// Moves vertices to the surface by one step of Newton's method, then outwards by the detail at that
// point.
static void displace(void *context, size_t begin, size_t end, unsigned thread)
{
    (void)thread;
    const struct displacement *d = context;
    for (size_t v = begin; v < end && !progress_should_stop(d->progress); v++) {
        double *p = d->net->positions[v], n[3];
        enum part_skin skin = SKIN_PLAIN;
        figure_field_normal(d->field, p, 0.5 * d->edge, n);
        double away = figure_field_value(d->field, p, &skin);
        // The step is limited to the edge length, because the field's value is not a distance where
        // parts join.
        double limit = d->edge;
        away = fmin(fmax(away, -limit), limit);
        double out = figure_detail(skin, p, d->edge) - away;
        for (int i = 0; i < 3; i++)
            p[i] += out * n[i];
    }
}

// Splits a quadrilateral along its shorter diagonal.
static void split_quad(const struct net *net, uint32_t quad, uint32_t triangles[2][3])
{
    const uint32_t *q = net->quads[quad];
    double squares[2] = {0, 0};
    for (int k = 0; k < 2; k++)
        for (int i = 0; i < 3; i++) {
            double side = net->positions[q[k]][i] - net->positions[q[k + 2]][i];
            squares[k] += side * side;
        }
    uint32_t first = squares[1] < squares[0];
    for (uint32_t t = 0; t < 2; t++)
        for (uint32_t i = 0; i < 3; i++)
            triangles[t][i] = q[(first + 2 * t + i) % 4];
}

// Sets each normal to the mean of the adjacent triangles' normals, weighted by area.
static void set_normals(struct mesh *mesh)
{
    for (uint32_t t = 0; t < mesh->triangle_count; t++) {
        const uint32_t *corners = mesh->indices[t];
        double e[2][3], n[3];
        for (int k = 0; k < 2; k++)
            for (int i = 0; i < 3; i++)
                e[k][i] = (double)mesh->positions[corners[k + 1]][i] -
                          (double)mesh->positions[corners[0]][i];
        vec3_cross(e[0], e[1], n);
        for (int k = 0; k < 3; k++)
            for (int i = 0; i < 3; i++)
                mesh->normals[corners[k]][i] += (float)n[i];
    }
    for (uint32_t v = 0; v < mesh->vertex_count; v++) {
        double n[3];
        for (int i = 0; i < 3; i++)
            n[i] = (double)mesh->normals[v][i];
        bool has_direction = vec3_normalize(n);
        for (int i = 0; i < 3; i++)
            mesh->normals[v][i] = has_direction ? (float)n[i] : 0.0f;
    }
}

// --- the complete mesh ---------------------------------------------------------------------------

uint64_t generate_figure_bytes(uint32_t triangles)
{
    const struct mesh *mesh = NULL;
    uint64_t vertices = triangles / 2 + triangles / 16;
    return vertices * (sizeof *mesh->positions + sizeof *mesh->normals) +
           (triangles + triangles / 8) * (uint64_t)sizeof *mesh->indices;
}

// Makes a figure's field and a net of about `quads` quadrilaterals. Each of at most five tries
// chooses the grid step from the number of quadrilaterals that the previous try made. *step becomes
// the grid step, or after the fifth unsuccessful try, the step that a sixth try would use.
static bool fit_net(enum figure figure, double quads, const struct progress *progress,
                    struct arena *arena, struct figure_field *field, double *step, struct net *net)
{
    double longest = 0;
    figure_field_make(figure, 0, field);
    for (int i = 0; i < 3; i++)
        longest = fmax(longest, field->high[i] - field->low[i]);
    *step = longest / FIRST_STEPS;
    for (int try = 0; try < 5; try++) {
        struct grid grid;
        arena_finish(arena);
        figure_field_make(figure, *step, field);
        if (!grid_make(field, *step, progress, arena, &grid) || !net_make(&grid, arena, net))
            return false;
        double ratio = net->quad_count / quads;
        if (progress_should_stop(progress) || (ratio > 0.95 && ratio < 1.05))
            return true;
        *step *= sqrt(fmin(fmax(ratio, 0.01), 100));
    }
    return true;
}

static bool mesh_allocate(struct arena *arena, uint32_t vertices, uint32_t triangles,
                          struct mesh *mesh)
{
    mesh->vertex_count = vertices;
    mesh->triangle_count = triangles;
    mesh->positions = arena_alloc(arena, vertices, sizeof *mesh->positions);
    mesh->normals = arena_alloc(arena, vertices, sizeof *mesh->normals);
    mesh->indices = arena_alloc(arena, triangles, sizeof *mesh->indices);
    return mesh->positions && mesh->normals && mesh->indices;
}

static bool mesh_of_net(const struct net *net, struct arena *arena, struct mesh *mesh)
{
    if (!mesh_allocate(arena, net->vertex_count, 2 * net->quad_count, mesh))
        return false;
    for (uint32_t v = 0; v < mesh->vertex_count; v++)
        for (int i = 0; i < 3; i++)
            mesh->positions[v][i] = (float)net->positions[v][i];
    for (uint32_t q = 0; q < net->quad_count; q++)
        split_quad(net, q, &mesh->indices[2 * q]);
    return true;
}

// Makes a mesh of about `triangles` triangles from a finer one by collapsing edges; the remaining
// vertices keep their positions.
static bool mesh_simplify(const struct mesh *fine, uint32_t triangles, struct arena *scratch,
                          struct arena *arena, struct mesh *out)
{
    uint32_t *kept = arena_alloc(scratch, 3 * (size_t)fine->triangle_count, sizeof *kept);
    uint32_t *places = arena_alloc(scratch, fine->vertex_count, sizeof *places);
    if (!kept || !places)
        return false;
    size_t corners = meshopt_simplify(
        kept, fine->indices[0], 3 * (size_t)fine->triangle_count, fine->positions[0],
        fine->vertex_count, sizeof *fine->positions, 3 * (size_t)triangles, 1.0f, 0, NULL);
    uint32_t vertices = 0;
    memset(places, 0xff, fine->vertex_count * sizeof *places);
    for (size_t i = 0; i < corners; i++)
        if (places[kept[i]] == NOTHING)
            places[kept[i]] = vertices++;
    if (!mesh_allocate(arena, vertices, (uint32_t)(corners / 3), out))
        return false;
    for (uint32_t v = 0; v < fine->vertex_count; v++)
        if (places[v] != NOTHING)
            memcpy(out->positions[places[v]], fine->positions[v], sizeof *fine->positions);
    for (size_t i = 0; i < corners; i++)
        out->indices[i / 3][i % 3] = places[kept[i]];
    return true;
}

static bool make_mesh(struct scene *scene, const struct net *net, uint32_t triangles,
                      struct arena *scratch, struct mesh *mesh)
{
    if (triangles >= SIMPLIFIED_BELOW)
        return mesh_of_net(net, &scene->arena, mesh);
    struct mesh fine = {0};
    return mesh_of_net(net, scratch, &fine) &&
           mesh_simplify(&fine, triangles, scratch, &scene->arena, mesh);
}

bool generate_figure(struct scene *scene, enum figure figure, uint32_t triangles, uint32_t material,
                     uint32_t *index, struct err *err)
{
    struct arena scratch = {0}, field_arena = {0};
    struct figure_field *field = ARENA_NEW(&field_arena, struct figure_field, 1);
    struct mesh mesh = {.name = figure_names[figure], .material = material};
    struct net net = {0};
    double quads = 0.5 * triangles, step = 0;
    uint32_t splits = 0;
    if (triangles < SIMPLIFIED_BELOW)
        quads = fmax(SIMPLIFIED_OF * quads, 0.5 * SIMPLIFIED_MIN);
    for (; quads > NET_MAX; quads /= 4)
        splits++;
    bool ok = field && fit_net(figure, quads, scene->progress, &scratch, field, &step, &net);
    for (uint32_t i = 0; ok && i < splits; i++, step /= 2)
        ok = net_split(&scratch, &net);
    if (ok) {
        struct displacement job = {field, &net, step, scene->progress};
        parallel_for(net.vertex_count, 1024, 0, displace, &job);
        ok = make_mesh(scene, &net, triangles, &scratch, &mesh);
    }
    arena_finish(&scratch);
    arena_finish(&field_arena);
    if (!ok)
        return err_memory(err, "a figure", generate_figure_bytes(triangles));
    set_normals(&mesh);
    return scene_goes_on(scene, 0, err) && scene_append_mesh(scene, &mesh, index, err);
}
