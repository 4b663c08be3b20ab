#include "render/tables/emitter_lamps.h"

#include "base/hash.h"
#include "base/maths.h"
#include "render/tables/emitter_power.h"
#include "render/tables/emitters.h"
#include "scene/core/bounds.h"
#include <math.h>
#include <string.h>

// An emissive triangle, as a node of a union-find forest.
struct member {
    uint32_t triangle;
    uint32_t parent; // another triangle of the same lamp, or itself
};

struct search {
    const struct flat_scene *flat;
    struct member *members;
    uint32_t count;
    // A hash table, with open addressing, from the position of a corner to one triangle that has
    // it. An entry is 1 + 3 * member + corner; 0: free.
    uint64_t *table, mask;
    uint32_t *of_small; // for each small lamp (flatten.h), 1 + its first member
};

static uint32_t find_root(struct member *members, uint32_t i)
{
    while (members[i].parent != i) {
        members[i].parent = members[members[i].parent].parent;
        i = members[i].parent;
    }
    return i;
}

static void join(struct member *members, uint32_t a, uint32_t b)
{
    a = find_root(members, a);
    b = find_root(members, b);
    members[a > b ? a : b].parent = a < b ? a : b;
}

// Joins a triangle to an earlier one that has the same corner, or enters the corner into the table.
// Only members from `first` on may be joined, because they belong to the same instance.
static void join_at_corner(struct search *s, uint32_t first, uint32_t member, uint32_t corner)
{
    const float *v = s->flat->triangles[s->members[member].triangle].v[corner];
    // Adding 0 turns negative zeros into positive ones.
    const float place[3] = {v[0] + 0.0f, v[1] + 0.0f, v[2] + 0.0f};
    uint64_t at = hash_bytes(hash_bytes(HASH_INIT, &first, sizeof first), place, sizeof place);
    for (at &= s->mask; s->table[at]; at = (at + 1) & s->mask) {
        uint32_t other = (uint32_t)((s->table[at] - 1) / 3);
        const float *w = s->flat->triangles[s->members[other].triangle].v[(s->table[at] - 1) % 3];
        if (other >= first && w[0] == v[0] && w[1] == v[1] && w[2] == v[2]) {
            join(s->members, other, member);
            return;
        }
    }
    s->table[at] = 1 + 3 * (uint64_t)member + corner;
}

static bool is_emissive(const struct scene *scene, const struct flat_scene *flat, uint32_t triangle)
{
    return mean_radiance(scene, &scene->materials[flat->triangles[triangle].material]) > 0.0;
}

static bool list_members(const struct scene *scene, struct search *s, struct arena *scratch,
                         struct err *err)
{
    const struct flat_scene *flat = s->flat;
    for (uint32_t i = 0; i < flat->triangle_count; i++)
        s->count += is_emissive(scene, flat, i);
    uint64_t size = 64;
    while (size < 6 * (uint64_t)s->count)
        size *= 2;
    s->mask = size - 1;
    s->members = ARENA_NEW(scratch, struct member, s->count);
    s->table = ARENA_NEW(scratch, uint64_t, size);
    s->of_small = ARENA_NEW(scratch, uint32_t, flat->small_count);
    if (!s->members || !s->table || !s->of_small)
        return err_memory(err, "lamps", s->count * sizeof *s->members + size * sizeof *s->table);
    uint32_t count = 0;
    for (uint32_t i = 0; i < flat->triangle_count; i++)
        if (is_emissive(scene, flat, i)) {
            s->members[count] = (struct member){.triangle = i, .parent = count};
            count++;
        }
    return true;
}

// Joins a triangle of a small lamp. The corners of such triangles are too inexact for a comparison;
// flattening has found their lamps from the exact corners.
static void join_small(struct search *s, uint32_t member, uint32_t lamp)
{
    if (s->of_small[lamp])
        join(s->members, s->of_small[lamp] - 1, member);
    else
        s->of_small[lamp] = 1 + member;
}

// Joins the triangles of each instance. They are sorted by instance.
static void join_members(struct search *s)
{
    uint32_t first = 0, last_instance = 0;
    for (uint32_t i = 0; i < s->count; i++) {
        uint32_t instance, triangle;
        flat_triangle_source(s->flat, s->members[i].triangle, &instance, &triangle);
        first = i > 0 && instance == last_instance ? first : i;
        last_instance = instance;
        const struct flat_small_triangle *small = flat_find_small(s->flat, s->members[i].triangle);
        if (small)
            join_small(s, i, small->lamp);
        for (uint32_t corner = 0; !small && corner < 3; corner++)
            join_at_corner(s, first, i, corner);
    }
}

static bool number_triangles(struct search *s, struct arena *arena, struct emitter_lamps *out,
                             struct err *err)
{
    out->of_triangles = ARENA_NEW(arena, uint32_t, s->count);
    if (!out->of_triangles)
        return err_memory(err, "lamps", s->count * sizeof *out->of_triangles);
    out->triangle_count = s->count;
    for (uint32_t i = 0; i < s->count; i++) {
        uint32_t root = find_root(s->members, i);
        out->of_triangles[i] = root == i ? out->triangle_lamps++ : out->of_triangles[root];
    }
    return true;
}

static double diagonal(const struct bounds *b)
{
    const double extent[3] = {b->max[0] - b->min[0], b->max[1] - b->min[1], b->max[2] - b->min[2]};
    return vec3_length(extent);
}

// Returns whether all triangles are small relative to the lamp: compares the longest diagonal of a
// triangle's bounds with the diagonal of the bounds of all triangles.
static bool are_small_in_lamp(const struct search *s)
{
    struct bounds all = BOUNDS_EMPTY;
    double longest = 0.0;
    for (uint32_t i = 0; i < s->count; i++) {
        struct bounds own = BOUNDS_EMPTY;
        for (int corner = 0; corner < 3; corner++) {
            const float *v = s->flat->triangles[s->members[i].triangle].v[corner];
            const double place[3] = {v[0], v[1], v[2]};
            bounds_add_point(&own, place);
            bounds_add_point(&all, place);
        }
        longest = fmax(longest, diagonal(&own));
    }
    return longest < 0.5 * diagonal(&all);
}

bool emitter_lamps_find(const struct scene *scene, const struct flat_scene *flat,
                        struct arena *arena, struct emitter_lamps *out, struct err *err)
{
    struct arena scratch = {0};
    struct search search = {.flat = flat};
    struct emitter_counts counts = emitters_count(scene, flat);
    *out = (struct emitter_lamps){0};
    bool ok = counts.triangles == 0 || list_members(scene, &search, &scratch, err);
    if (ok && counts.triangles > 0) {
        join_members(&search);
        ok = number_triangles(&search, arena, out, err);
    }
    out->count = out->triangle_lamps + counts.lights + counts.suns + counts.environment;
    for (uint32_t kind = 0; kind < SHAPE_KIND_COUNT; kind++)
        out->count += counts.shapes[kind];
    out->is_spread =
        ok && out->count == 1 && out->triangle_lamps == 1 && are_small_in_lamp(&search);
    arena_finish(&scratch);
    return ok;
}

uint32_t emitter_lamp_of(const struct emitter_lamps *lamps, uint32_t emitter)
{
    return emitter < lamps->triangle_count
               ? lamps->of_triangles[emitter]
               : lamps->triangle_lamps + (emitter - lamps->triangle_count);
}
