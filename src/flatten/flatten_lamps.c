#include "flatten/flatten_lamps.h"

#include "scene/core/affine.h"
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

// The ratio of distance to size above which rounding may change the areas of an object's triangles
// by SMALL_TOLERANCE.
#define SMALL_RATIO 4096
// The maximum relative change of an emitter's area and normal by rounding.
#define SMALL_TOLERANCE 0x1p-11
// Parts of a lamp are connected if their distance is at most this fraction of their coordinates,
// which is 16 rounding errors, because a ray's rounded origin may be on the wrong side of such a
// part.
#define NEAR_TOLERANCE 0x1p-20
// A light sample tests all triangles of its lamp for occlusion. This number is below the number of
// iterations that a driver permits (shaders/shared/methods.h).
#define LAMP_TRIANGLES_MAX 4096
// The maximum number of such occlusion tests for all light samples of one vertex if the vertex
// samples every emitter.
#define LAMP_TESTS_MAX 32768

// Connected triangles that may belong to a lamp: a node of a union-find forest, whose roots
// represent all nodes below them.
struct part {
    struct bounds bounds;
    uint32_t triangle_count;
    uint32_t lamp;
    bool is_lost; // rounding changes some triangle too much
};

struct search {
    const struct flatten_params *params;
    const struct census *census;
    const struct flat_scene *flat;
    struct arena *scratch;
    struct part *parts;
    uint32_t *parents; // the union-find forest, by parts
    uint32_t part_count, part_capacity, parent_count, parent_capacity;
    struct lamp_triangle *triangles; // `lamp` is the index of a part until lamps are numbered
    uint32_t triangle_count, triangle_capacity;
};

static double box_extent(const struct bounds *bounds)
{
    double extent = 0;
    for (int i = 0; i < 3; i++)
        extent = fmax(extent, bounds->max[i] - bounds->min[i]);
    return extent;
}

static double box_farthest(const struct bounds *bounds)
{
    double farthest = 0;
    for (int i = 0; i < 3; i++)
        farthest = fmax(farthest, fmax(fabs(bounds->min[i]), fabs(bounds->max[i])));
    return farthest;
}

static bool is_small(const struct bounds *bounds)
{
    return box_farthest(bounds) > SMALL_RATIO * box_extent(bounds);
}

static void edges_of(const double corners[3][3], double edges[2][3])
{
    vec3_subtract(corners[1], corners[0], edges[0]);
    vec3_subtract(corners[2], corners[0], edges[1]);
}

// Not inlined: GCC 12.2 would optimise away the conversion of two adjacent numbers to single
// precision and back in a loop.
__attribute__((noinline)) static void round_corners(const double corners[3][3], float out[3][3])
{
    for (int corner = 0; corner < 3; corner++)
        for (int i = 0; i < 3; i++)
            out[corner][i] = (float)corners[corner][i];
}

// Returns whether rounding moves points of a triangle too far relative to its size. This may be so
// even if the corners are exact in single precision, because the points of light samples and of
// occluders are rounded, too.
static bool is_coarse(const double corners[3][3], const double edges[2][3])
{
    double farthest = 0;
    for (int corner = 0; corner < 3; corner++)
        for (int i = 0; i < 3; i++)
            farthest = fmax(farthest, fabs(corners[corner][i]));
    double longest = fmax(vec3_length(edges[0]), vec3_length(edges[1]));
    return farthest * (double)FLT_EPSILON / 2 > SMALL_TOLERANCE * longest;
}

// Returns whether rounding changes a triangle's points, its area or its normal too much.
static bool is_lost(const double corners[3][3])
{
    double edges[2][3], exact[3], normal[3], difference[3];
    float rounded[3][3];
    edges_of(corners, edges);
    if (is_coarse(corners, (const double(*)[3])edges))
        return true;
    vec3_cross(edges[0], edges[1], exact);
    round_corners(corners, rounded);
    for (int e = 0; e < 2; e++)
        for (int i = 0; i < 3; i++)
            edges[e][i] = (double)rounded[e + 1][i] - (double)rounded[0][i];
    vec3_cross(edges[0], edges[1], normal);
    vec3_subtract(exact, normal, difference);
    return vec3_length(difference) > SMALL_TOLERANCE * vec3_length(exact);
}

// --- union-find forest ---------------------------------------------------------------------------

static uint32_t find_root(uint32_t *parents, uint32_t i)
{
    while (parents[i] != i) {
        parents[i] = parents[parents[i]]; // path halving
        i = parents[i];
    }
    return i;
}

// Joins two trees. Returns the root that became a child, or the common root if the two were in one
// tree already.
static uint32_t join_roots(uint32_t *parents, uint32_t a, uint32_t b)
{
    a = find_root(parents, a);
    b = find_root(parents, b);
    parents[a < b ? b : a] = a < b ? a : b;
    return a < b ? b : a;
}

static void join_parts(struct search *s, uint32_t a, uint32_t b)
{
    uint32_t below = join_roots(s->parents, a, b), above = s->parents[below];
    struct part *child = &s->parts[below], *root = &s->parts[above];
    if (below == above)
        return;
    bounds_add_point(&root->bounds, child->bounds.min);
    bounds_add_point(&root->bounds, child->bounds.max);
    root->triangle_count += child->triangle_count;
    root->is_lost |= child->is_lost;
}

// --- parts of one instance -----------------------------------------------------------------------

static bool is_emissive(const struct search *s, const struct placement *placement, uint32_t t)
{
    return flatten_emits(s->params->scene,
                         instance_material(placement->mesh, placement->instance, t));
}

static bool may_emit(const struct search *s, const struct placement *placement)
{
    bool is_of_one =
        placement->instance->material != SCENE_NONE || !placement->mesh->triangle_material;
    for (uint32_t t = 0; t < placement->mesh->triangle_count; t++) {
        if (is_emissive(s, placement, t))
            return true;
        if (is_of_one)
            return false;
    }
    return false;
}

static struct bounds triangle_bounds(const double corners[3][3])
{
    struct bounds bounds = BOUNDS_EMPTY;
    for (int corner = 0; corner < 3; corner++)
        bounds_add_point(&bounds, corners[corner]);
    return bounds;
}

static bool has_small_triangles(const struct search *s, const struct placement *placement)
{
    double corners[3][3];
    for (uint32_t t = 0; t < placement->mesh->triangle_count; t++) {
        if (!is_emissive(s, placement, t))
            continue;
        placement_corners(placement, t, corners);
        const struct bounds bounds = triangle_bounds((const double(*)[3])corners);
        if (is_small(&bounds))
            return true;
    }
    return false;
}

// Returns a union-find forest of the mesh's vertices, in which the vertices of connected emissive
// triangles have a common root.
static uint32_t *connect_vertices(const struct search *s, const struct placement *placement,
                                  struct arena *arena)
{
    const struct mesh *mesh = placement->mesh;
    uint32_t *roots = arena_alloc(arena, mesh->vertex_count, sizeof *roots);
    for (uint32_t v = 0; roots && v < mesh->vertex_count; v++)
        roots[v] = v;
    for (uint32_t t = 0; roots && t < mesh->triangle_count; t++) {
        const uint32_t *corners = mesh->indices[t];
        if (!is_emissive(s, placement, t))
            continue;
        join_roots(roots, corners[0], corners[1]);
        join_roots(roots, corners[0], corners[2]);
    }
    return roots;
}

static bool add_part(struct search *s, uint32_t *part, struct err *err)
{
    struct part *added =
        arena_append(s->scratch, &s->parts, &s->part_count, &s->part_capacity, sizeof *added, part);
    uint32_t *parent = arena_append(s->scratch, &s->parents, &s->parent_count, &s->parent_capacity,
                                    sizeof *parent, NULL);
    if (!added || !parent)
        return err_memory(err, "small lamps", sizeof *added);
    added->bounds = BOUNDS_EMPTY;
    *parent = *part;
    return true;
}

static void measure_triangle(struct search *s, uint32_t part, const double corners[3][3])
{
    struct part *p = &s->parts[part];
    for (int corner = 0; corner < 3; corner++)
        bounds_add_point(&p->bounds, corners[corner]);
    p->triangle_count++;
    p->is_lost = p->is_lost || is_lost(corners);
}

// Adds the emissive triangles of an instance as parts: one for each connected set of triangles, or
// one for all if `roots` is NULL.
static bool add_parts(struct search *s, const struct placement *placement, uint32_t *roots,
                      uint32_t *part_of_root, struct err *err)
{
    const struct mesh *mesh = placement->mesh;
    uint32_t instance = (uint32_t)(placement->instance - s->params->scene->instances);
    uint32_t whole = SCENE_NONE;
    for (uint32_t t = 0; t < mesh->triangle_count; t++) {
        double corners[3][3];
        if (t % FLATTEN_POLL == 0 && !flatten_goes_on(s->params, FLATTEN_CENSUS_PART, err))
            return false;
        if (!is_emissive(s, placement, t))
            continue;
        uint32_t *part = roots ? &part_of_root[find_root(roots, mesh->indices[t][0])] : &whole;
        if (*part == SCENE_NONE && !add_part(s, part, err))
            return false;
        struct lamp_triangle *added = arena_append(s->scratch, &s->triangles, &s->triangle_count,
                                                   &s->triangle_capacity, sizeof *added, NULL);
        if (!added)
            return err_memory(err, "small lamps", sizeof *added);
        *added = (struct lamp_triangle){instance, t, *part};
        placement_corners(placement, t, corners);
        measure_triangle(s, *part, (const double(*)[3])corners);
    }
    return true;
}

static bool search_mesh(struct search *s, const struct placement *placement, struct err *err)
{
    struct arena arena = {0};
    uint32_t count = placement->mesh->vertex_count;
    uint32_t *roots = connect_vertices(s, placement, &arena);
    uint32_t *part_of_root = arena_alloc(&arena, count, sizeof *part_of_root);
    bool ok = (roots && part_of_root) ||
              err_memory(err, "the parts of an emissive mesh", 8 * (uint64_t)count);
    for (uint32_t v = 0; ok && v < count; v++)
        part_of_root[v] = SCENE_NONE;
    ok = ok && add_parts(s, placement, roots, part_of_root, err);
    arena_finish(&arena);
    return ok;
}

static bool search_instance(struct search *s, uint32_t index, struct err *err)
{
    const struct instance *instance = &s->params->scene->instances[index];
    const struct bounds *mesh = &s->census->meshes[instance->mesh].bounds;
    const struct placement placement =
        placement_create(s->params->scene, instance, s->flat->origin, s->flat->scale);
    struct bounds world, bounds;
    if (bounds_is_empty(mesh) || !may_emit(s, &placement))
        return true;
    affine_box(instance->transform, mesh->min, mesh->max, world.min, world.max);
    flat_from_world(s->flat, world.min, bounds.min);
    flat_from_world(s->flat, world.max, bounds.max);
    if (is_small(&bounds))
        return add_parts(s, &placement, NULL, NULL, err);
    return !has_small_triangles(s, &placement) || search_mesh(s, &placement, err);
}

// --- lamps of several parts ----------------------------------------------------------------------

static int compare_parts(const void *a, const void *b)
{
    const struct part *p = *(const struct part *const *)a, *q = *(const struct part *const *)b;
    return (p->bounds.min[0] > q->bounds.min[0]) - (p->bounds.min[0] < q->bounds.min[0]);
}

static bool are_near(const struct part *a, const struct part *b, double margin)
{
    for (int i = 0; i < 3; i++)
        if (a->bounds.min[i] - b->bounds.max[i] > margin ||
            b->bounds.min[i] - a->bounds.max[i] > margin)
            return false;
    return true;
}

// Joins small parts that are near each other, by a sweep along x over overlapping ranges.
static bool join_near_parts(struct search *s, struct err *err)
{
    uint32_t count = 0, open = 0;
    struct part **order = ARENA_NEW(s->scratch, struct part *, s->part_count);
    struct part *boxes = ARENA_NEW(s->scratch, struct part, s->part_count);
    uint32_t *reaching = ARENA_NEW(s->scratch, uint32_t, s->part_count);
    if (!order || !boxes || !reaching)
        return err_memory(err, "small lamps", s->part_count * (sizeof *order + sizeof *boxes));
    memcpy(boxes, s->parts, s->part_count * sizeof *boxes); // joining parts changes bounds
    for (uint32_t i = 0; i < s->part_count; i++)
        if (is_small(&boxes[i].bounds))
            order[count++] = &boxes[i];
    qsort(order, count, sizeof *order, compare_parts);
    for (uint32_t i = 0; i < count; i++) {
        double margin = NEAR_TOLERANCE * box_farthest(&order[i]->bounds);
        uint32_t kept = 0;
        if (i % 1024 == 0 && !flatten_goes_on(s->params, FLATTEN_CENSUS_PART, err))
            return false;
        for (uint32_t k = 0; k < open; k++) {
            const struct part *other = order[reaching[k]];
            if (order[i]->bounds.min[0] - other->bounds.max[0] > margin)
                continue;
            reaching[kept++] = reaching[k];
            if (are_near(order[i], other, margin))
                join_parts(s, (uint32_t)(order[i] - boxes), (uint32_t)(other - boxes));
        }
        open = kept;
        reaching[open++] = i;
    }
    return true;
}

static uint32_t most_triangles(const struct search *s)
{
    const struct settings *settings = &s->params->scene->settings;
    bool connects_to_all =
        settings->integrator == INTEGRATOR_WHITTED || settings->light_choice == LIGHT_CHOICE_ALL;
    if (!connects_to_all || s->triangle_count == 0)
        return LAMP_TRIANGLES_MAX;
    return LAMP_TESTS_MAX / s->triangle_count;
}

static bool list_lamps(struct search *s, struct lamps *out, struct err *err)
{
    uint32_t most = most_triangles(s);
    out->items = ARENA_NEW(s->scratch, struct lamp, s->part_count);
    if (!out->items)
        return err_memory(err, "small lamps", s->part_count * sizeof *out->items);
    for (uint32_t i = 0; i < s->part_count; i++) {
        struct part *part = &s->parts[i];
        bool is_lamp = s->parents[i] == i && part->is_lost && is_small(&part->bounds) &&
                       part->triangle_count <= most;
        part->lamp = is_lamp ? out->count : SCENE_NONE;
        if (is_lamp)
            out->items[out->count++] = (struct lamp){part->bounds, part->triangle_count};
    }
    out->triangles = s->triangles;
    for (uint32_t i = 0; i < s->triangle_count; i++) {
        struct lamp_triangle triangle = s->triangles[i];
        triangle.lamp = s->parts[find_root(s->parents, triangle.lamp)].lamp;
        if (triangle.lamp != SCENE_NONE)
            out->triangles[out->triangle_count++] = triangle;
    }
    return true;
}

bool flatten_find_lamps(const struct flatten_params *params, const struct census *census,
                        const struct flat_scene *flat, struct arena *scratch, struct lamps *out,
                        struct err *err)
{
    struct search s = {.params = params, .census = census, .flat = flat, .scratch = scratch};
    *out = (struct lamps){0};
    for (uint32_t i = 0; i < params->scene->instance_count; i++)
        if (census->instances[i] == INSTANCE_FLATTENED && !search_instance(&s, i, err))
            return false;
    return s.part_count == 0 || (join_near_parts(&s, err) && list_lamps(&s, out, err));
}

// --- triangles of lamps --------------------------------------------------------------------------

// Returns the end of an edge that starts at `from`, rounded away from it.
static float round_away(float from, float edge)
{
    double end = (double)from + (double)edge;
    float rounded = (float)end;
    if (edge > 0.0f ? (double)rounded < end : (double)rounded > end)
        rounded = nextafterf(rounded, edge > 0.0f ? INFINITY : -INFINITY);
    return rounded;
}

void lamp_add_triangle(const struct lamps *lamps, uint32_t number, const double corners[3][3],
                       double normal[3], struct flat_scene *flat)
{
    const struct lamp *lamp = &lamps->items[number];
    struct flat_triangle *triangle = &flat->triangles[flat->triangle_count];
    double edges[2][3], exact[3];
    // The lamp's own unit is a power of two that prevents underflow of products of its coordinates.
    double unit = ldexp(1, -ilogb(box_extent(&lamp->bounds)));
    edges_of(corners, edges);
    vec3_cross(edges[0], edges[1], exact);
    if (!(vec3_length(exact) > 0))
        return;
    memcpy(normal, exact, sizeof exact);
    struct flat_small_triangle *small = &flat->small[flat->small_count++];
    *small = (struct flat_small_triangle){.triangle = flat->triangle_count, .lamp = number};
    for (int i = 0; i < 3; i++) {
        double middle = (lamp->bounds.min[i] + lamp->bounds.max[i]) / 2;
        small->corner[i] = (float)((corners[0][i] - middle) * unit);
        for (int e = 0; e < 2; e++) {
            small->edges[e][i] = (float)edges[e][i];
            small->own_edges[e][i] = (float)(edges[e][i] * unit);
            triangle->v[e + 1][i] = round_away(triangle->v[0][i], small->edges[e][i]);
        }
    }
}

bool lamps_finish(const struct lamps *lamps, struct flat_scene *flat, struct arena *scratch,
                  struct err *err)
{
    uint32_t *counts = ARENA_NEW(scratch, uint32_t, lamps->count);
    uint32_t *firsts = ARENA_NEW(scratch, uint32_t, lamps->count);
    uint32_t sum = 0;
    if (!counts || !firsts)
        return err_memory(err, "small lamps", lamps->count * 2 * sizeof *counts);
    for (uint32_t i = 0; i < flat->small_count; i++)
        counts[flat->small[i].lamp]++;
    for (uint32_t i = 0; i < lamps->count; i++) {
        firsts[i] = sum;
        sum += counts[i];
    }
    for (uint32_t i = flat->small_count; i-- > 0;) {
        struct flat_small_triangle *small = &flat->small[i];
        uint32_t lamp = small->lamp;
        small->first = firsts[lamp];
        small->place = firsts[lamp] + --counts[lamp];
    }
    for (uint32_t i = 0; i < flat->small_count; i++) {
        uint32_t next = flat->small[i].lamp + 1;
        flat->small[i].count = (next < lamps->count ? firsts[next] : sum) - flat->small[i].first;
    }
    return true;
}
