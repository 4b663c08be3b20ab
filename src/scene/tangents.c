// Tangents after Mikkelsen 2008. Corners share a tangent when their triangles meet at a vertex of
// the same position, normal and texture coordinates, are connected by edges there, and are mapped
// with the same orientation. It is the mean of the triangles' directions of growing u, projected
// onto the plane of the normal and weighted by the angle at the corner.
#include "tangents.h"

#include "affine.h"
#include "bounds.h"
#include <math.h>
#include <string.h>

#define NONE UINT32_MAX

// Of triangles.
enum {
    IS_MIRRORED = 1, // its picture is turned over
    HAS_NO_AREA = 2, // two corners in one place: takes part in nothing
    HAS_NO_MAP = 4,  // no direction of u or v: goes along with its neighbours
    IS_ORIENTED = 8, // HAS_NO_MAP, and has joined a group, whose orientation it took
};

// A corner is 3 * triangle + 0, 1 or 2; its edge leads to the triangle's next corner.
struct work {
    struct arena arena;
    const struct mesh *mesh;
    const float (*uvs)[2];
    uint32_t corner_count;
    uint8_t *flags;   // of triangles
    uint32_t *weld;   // of corners: the first corner that is the same vertex
    uint32_t *across; // of corners: the triangle on the other side of the edge, or NONE
    uint32_t *group;  // of corners
    uint32_t group_count;
    // A hash table of corners: chains begin at heads[hash & mask] and go on in ascending order.
    uint32_t *heads, *next;
    uint32_t mask;
    uint32_t *stack; // of triangles
};

static uint32_t next_corner(uint32_t corner)
{
    return corner % 3 == 2 ? corner - 2 : corner + 1;
}

static uint32_t previous_corner(uint32_t corner)
{
    return corner % 3 == 0 ? corner + 2 : corner - 1;
}

static uint32_t corner_vertex(const struct work *work, uint32_t corner)
{
    return work->mesh->indices[corner / 3][corner % 3];
}

// --- triangles -----------------------------------------------------------------------------------

// The two edges from the triangle's first corner.
static void triangle_edges(const struct work *work, uint32_t triangle, double edges[2][3])
{
    double p[3][3];
    for (uint32_t c = 0; c < 3; c++)
        mesh_vertex(work->mesh, work->mesh->indices[triangle][c], p[c]);
    for (int e = 0; e < 2; e++)
        vec3_subtract(p[e + 1], p[0], edges[e]);
}

// Unit length; zero where neither the mesh nor the triangle has a normal.
static void corner_normal(const struct work *work, uint32_t corner, double out[3])
{
    if (work->mesh->normals) {
        const float *given = work->mesh->normals[corner_vertex(work, corner)];
        for (int i = 0; i < 3; i++)
            out[i] = (double)given[i];
        if (vec3_normalize(out))
            return;
    }
    double edges[2][3];
    triangle_edges(work, corner / 3, edges);
    vec3_cross(edges[0], edges[1], out);
    if (!vec3_normalize(out))
        memset(out, 0, 3 * sizeof *out);
}

// The directions of growing u and v, of unit length: Mikkelsen 2008, section 3.3. Sets *is_mirrored
// by the orientation of (u, v) with v upwards. False when the texture coordinates give no
// direction.
static bool triangle_directions(const struct work *work, uint32_t triangle, double along_u[3],
                                double along_v[3], bool *is_mirrored)
{
    const uint32_t *corners = work->mesh->indices[triangle];
    const float *uv[3] = {work->uvs[corners[0]], work->uvs[corners[1]], work->uvs[corners[2]]};
    double edges[2][3], du[2], dv[2];
    for (int e = 0; e < 2; e++) {
        du[e] = (double)uv[e + 1][0] - (double)uv[0][0];
        dv[e] = (double)uv[0][1] - (double)uv[e + 1][1]; // upwards
    }
    double area = du[0] * dv[1] - du[1] * dv[0];
    triangle_edges(work, triangle, edges);
    for (int i = 0; i < 3; i++) {
        along_u[i] = copysign(1, area) * (dv[1] * edges[0][i] - dv[0] * edges[1][i]);
        along_v[i] = copysign(1, area) * (du[0] * edges[1][i] - du[1] * edges[0][i]);
    }
    *is_mirrored = area < 0;
    return area != 0 && vec3_normalize(along_v) && vec3_normalize(along_u);
}

static bool is_same_place(const struct work *work, uint32_t a, uint32_t b)
{
    double p[2][3];
    mesh_vertex(work->mesh, a, p[0]);
    mesh_vertex(work->mesh, b, p[1]);
    return p[0][0] == p[1][0] && p[0][1] == p[1][1] && p[0][2] == p[1][2];
}

static void classify_triangles(struct work *work)
{
    for (uint32_t t = 0; t < work->mesh->triangle_count; t++) {
        const uint32_t *corners = work->mesh->indices[t];
        double along_u[3], along_v[3];
        bool is_mirrored;
        if (is_same_place(work, corners[0], corners[1]) ||
            is_same_place(work, corners[1], corners[2]) ||
            is_same_place(work, corners[2], corners[0]))
            work->flags[t] = HAS_NO_AREA;
        else if (!triangle_directions(work, t, along_u, along_v, &is_mirrored))
            work->flags[t] = HAS_NO_MAP;
        else
            work->flags[t] = is_mirrored ? IS_MIRRORED : 0;
    }
}

// --- connections ---------------------------------------------------------------------------------

static void clear_table(struct work *work)
{
    for (size_t i = 0; i <= work->mask; i++)
        work->heads[i] = NONE;
}

// A bijection of 64 bits that mixes them well: the finaliser of SplitMix64 (Steele, Lea, Flood
// 2014) with the constants of Stafford's variant 13.
static uint64_t mix_bits(uint64_t x)
{
    x = (x ^ (x >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
    x = (x ^ (x >> 27)) * UINT64_C(0x94d049bb133111eb);
    return x ^ (x >> 31);
}

struct vertex_key {
    double numbers[8]; // position, normal, texture coordinates
};

static struct vertex_key key_of(const struct work *work, uint32_t corner)
{
    struct vertex_key key;
    uint32_t vertex = corner_vertex(work, corner);
    mesh_vertex(work->mesh, vertex, key.numbers);
    corner_normal(work, corner, key.numbers + 3);
    for (int i = 0; i < 2; i++)
        key.numbers[6 + i] = (double)work->uvs[vertex][i];
    for (int i = 0; i < 8; i++)
        key.numbers[i] += 0.0; // the two zeros are one
    return key;
}

static uint32_t *vertex_chain(const struct work *work, const struct vertex_key *key)
{
    uint64_t words[8], hash = 0;
    memcpy(words, key, sizeof words);
    for (int i = 0; i < 8; i++)
        hash = mix_bits(hash ^ words[i]);
    return &work->heads[hash & work->mask];
}

// Whether the mesh itself has a normal for a vertex: then all corners there are the same.
static bool has_normal(const struct work *work, uint32_t vertex)
{
    const float *normal = work->mesh->normals ? work->mesh->normals[vertex] : NULL;
    return normal && (normal[0] != 0 || normal[1] != 0 || normal[2] != 0);
}

// The first corner that is the same vertex; *chain: where it is put when it is that itself.
static uint32_t find_same(const struct work *work, uint32_t corner, uint32_t **chain)
{
    const struct vertex_key key = key_of(work, corner);
    *chain = vertex_chain(work, &key);
    for (uint32_t same = **chain; same != NONE; same = work->next[same]) {
        const struct vertex_key other = key_of(work, same);
        if (memcmp(&key, &other, sizeof key) == 0)
            return same;
    }
    return corner;
}

// known: for each of the mesh's vertices NONE.
static void weld_corners(struct work *work, uint32_t *known)
{
    clear_table(work);
    for (uint32_t c = 0; c < work->corner_count; c++) {
        uint32_t vertex = corner_vertex(work, c), *chain;
        work->weld[c] = known[vertex];
        if (known[vertex] != NONE)
            continue;
        work->weld[c] = find_same(work, c, &chain);
        if (work->weld[c] == c) {
            work->next[c] = *chain;
            *chain = c;
        }
        if (has_normal(work, vertex))
            known[vertex] = work->weld[c];
    }
}

// Where the chain of edges from one welded vertex to another begins.
static uint32_t *edge_chain(const struct work *work, uint32_t from, uint32_t to)
{
    return &work->heads[mix_bits((uint64_t)from << 32 | to) & work->mask];
}

// Two triangles are connected when they pass the same edge in opposite directions. Where more than
// two meet at an edge, the first that are free are paired.
static void connect_triangles(struct work *work)
{
    clear_table(work);
    for (uint32_t c = work->corner_count; c-- > 0;) {
        work->across[c] = NONE;
        if (work->flags[c / 3] & HAS_NO_AREA)
            continue;
        uint32_t *head = edge_chain(work, work->weld[c], work->weld[next_corner(c)]);
        work->next[c] = *head;
        *head = c;
    }
    for (uint32_t c = 0; c < work->corner_count; c++) {
        if (work->flags[c / 3] & HAS_NO_AREA || work->across[c] != NONE)
            continue;
        uint32_t from = work->weld[c], to = work->weld[next_corner(c)];
        uint32_t other = *edge_chain(work, to, from);
        while (other != NONE && (work->across[other] != NONE || work->weld[other] != to ||
                                 work->weld[next_corner(other)] != from))
            other = work->next[other];
        if (other == NONE)
            continue;
        work->across[c] = other / 3;
        work->across[other] = c / 3;
    }
}

// --- groups --------------------------------------------------------------------------------------

// Puts a corner into a group; returns how many triangles it has put on the stack.
static uint32_t join(struct work *work, uint32_t corner, uint32_t group, uint32_t stacked)
{
    const uint32_t neighbors[2] = {work->across[corner], work->across[previous_corner(corner)]};
    work->group[corner] = group;
    for (int i = 0; i < 2; i++)
        if (neighbors[i] != NONE)
            work->stack[stacked++] = neighbors[i];
    return stacked;
}

// Whether the triangle has the orientation; one without any takes it.
static bool has_orientation(struct work *work, uint32_t triangle, bool is_mirrored)
{
    uint8_t *flags = &work->flags[triangle];
    if ((*flags & HAS_NO_MAP) && !(*flags & IS_ORIENTED))
        *flags |= (uint8_t)(IS_ORIENTED | (is_mirrored ? IS_MIRRORED : 0));
    return ((*flags & IS_MIRRORED) != 0) == is_mirrored;
}

// All corners at one welded vertex that are reached from `start` over edges. A triangle is stacked
// at most twice by each of its neighbours: 2 * triangle_count + 2 places are enough.
static void flood(struct work *work, uint32_t start, uint32_t group)
{
    uint32_t vertex = work->weld[start];
    bool is_mirrored = work->flags[start / 3] & IS_MIRRORED;
    uint32_t stacked = join(work, start, group, 0);
    while (stacked > 0) {
        uint32_t triangle = work->stack[--stacked], corner = 3 * triangle;
        while (work->weld[corner] != vertex)
            corner++;
        if (work->group[corner] == NONE && has_orientation(work, triangle, is_mirrored))
            stacked = join(work, corner, group, stacked);
    }
}

// Gives a group to corners that flood() left out: that of the same vertex in another triangle, else
// one of their own. lent: corner_count places.
static void group_the_rest(struct work *work, uint32_t *lent)
{
    for (uint32_t c = 0; c < work->corner_count; c++)
        lent[c] = NONE;
    for (uint32_t c = 0; c < work->corner_count; c++)
        if (work->group[c] != NONE && lent[work->weld[c]] == NONE)
            lent[work->weld[c]] = work->group[c];
    for (uint32_t c = 0; c < work->corner_count; c++) {
        if (work->group[c] != NONE)
            continue;
        uint32_t *group = &lent[work->weld[c]];
        if (*group == NONE)
            *group = work->group_count++;
        work->group[c] = *group;
    }
}

static void group_corners(struct work *work)
{
    for (uint32_t c = 0; c < work->corner_count; c++)
        work->group[c] = NONE;
    for (uint32_t c = 0; c < work->corner_count; c++)
        if (!(work->flags[c / 3] & (HAS_NO_AREA | HAS_NO_MAP)) && work->group[c] == NONE)
            flood(work, c, work->group_count++);
    group_the_rest(work, work->next); // the chains are done with
}

// --- directions ----------------------------------------------------------------------------------

// The part of v in the plane of the unit normal, of unit length; false when there is none.
static bool project(const double normal[3], double v[3])
{
    double along = vec3_dot(normal, v);
    for (int i = 0; i < 3; i++)
        v[i] -= along * normal[i];
    return vec3_normalize(v);
}

// The angle at a corner, between the edges as seen along the normal.
static double corner_angle(const struct work *work, uint32_t corner, const double normal[3])
{
    double at[3], edges[2][3];
    const uint32_t ends[2] = {next_corner(corner), previous_corner(corner)};
    mesh_vertex(work->mesh, corner_vertex(work, corner), at);
    for (int e = 0; e < 2; e++) {
        mesh_vertex(work->mesh, corner_vertex(work, ends[e]), edges[e]);
        vec3_subtract(edges[e], at, edges[e]);
        if (!project(normal, edges[e]))
            return 0;
    }
    return acos(fmin(fmax(vec3_dot(edges[0], edges[1]), -1), 1));
}

// Of a group.
struct direction {
    double sum[3]; // of the directions of growing u, by angle
    bool is_mirrored;
};

// The directions of growing u and v at a corner, in the plane of its normal; false where the
// triangle has none.
static bool corner_directions(const struct work *work, uint32_t corner, double along_u[3],
                              double along_v[3], bool *is_mirrored)
{
    double normal[3];
    if (work->flags[corner / 3] & (HAS_NO_AREA | HAS_NO_MAP))
        return false;
    corner_normal(work, corner, normal);
    return triangle_directions(work, corner / 3, along_u, along_v, is_mirrored) &&
           project(normal, along_u) && project(normal, along_v);
}

// Adds a corner to the mean, where it has `along_u`.
static void add_corner(const struct work *work, uint32_t corner, const double along_u[3],
                       bool is_mirrored, struct direction *direction)
{
    double normal[3];
    corner_normal(work, corner, normal);
    double angle = corner_angle(work, corner, normal);
    direction->is_mirrored = is_mirrored;
    for (int i = 0; i < 3; i++)
        direction->sum[i] += angle * along_u[i];
}

// --- opposite directions -------------------------------------------------------------------------

// In Mikkelsen's program a corner leaves out of its mean the triangles that are mapped the opposite
// way from its own: those whose cosine, in single precision, is -1. They meet at poles of spheres
// that have one vertex there.

static bool is_opposite(const double a[3], const double b[3])
{
    float dot = 0;
    for (int i = 0; i < 3; i++)
        dot += (float)a[i] * (float)b[i];
    return dot <= -1.0f;
}

// The corners of each group, one group after the other.
struct members {
    uint32_t *corners;
    uint32_t *first; // of groups, and one more
};

static bool list_members(struct work *work, struct members *members)
{
    members->corners = ARENA_NEW(&work->arena, uint32_t, work->corner_count);
    members->first = ARENA_NEW(&work->arena, uint32_t, (size_t)work->group_count + 2);
    if (!members->corners || !members->first)
        return false;
    // Counted two places on, summed up, and moved one place on while they are filled in.
    for (uint32_t c = 0; c < work->corner_count; c++)
        members->first[work->group[c] + 2]++;
    for (uint32_t g = 1; g <= work->group_count; g++)
        members->first[g + 1] += members->first[g];
    for (uint32_t c = 0; c < work->corner_count; c++)
        members->corners[members->first[work->group[c] + 1]++] = c;
    return true;
}

// The mean at corner `own` of a group; false when nothing is left out of it.
static bool sum_without_opposites(const struct work *work, uint32_t own, const uint32_t *corners,
                                  uint32_t count, struct direction *out)
{
    double own_u[3], own_v[3], along_u[3], along_v[3];
    bool is_mirrored, is_complete = true;
    if (!corner_directions(work, own, own_u, own_v, &is_mirrored))
        return false;
    *out = (struct direction){0};
    for (uint32_t i = 0; i < count; i++) {
        bool has_map = corner_directions(work, corners[i], along_u, along_v, &is_mirrored);
        bool is_left_out = has_map && (is_opposite(own_u, along_u) || is_opposite(own_v, along_v));
        is_complete &= !is_left_out;
        if (has_map && !is_left_out)
            add_corner(work, corners[i], along_u, is_mirrored, out);
    }
    return !is_complete;
}

// Beyond this many triangles at a vertex, whose pairs would take seconds, all are in the mean.
#define MOST_COMPARED 4096

// Gives the corners of one group that leave others out groups of their own, shared by those with
// the same sum. directions: of all groups so far, with room for one more a corner.
static void divide_group(struct work *work, const uint32_t *corners, uint32_t count,
                         struct direction *directions)
{
    uint32_t first_new = work->group_count;
    for (uint32_t i = 0; i < count; i++) {
        struct direction *direction = &directions[work->group_count];
        if (!sum_without_opposites(work, corners[i], corners, count, direction))
            continue;
        uint32_t g = first_new;
        while (g < work->group_count &&
               memcmp(directions[g].sum, direction->sum, sizeof direction->sum) != 0)
            g++;
        work->group[corners[i]] = g;
        work->group_count += g == work->group_count;
    }
}

// Sums up a group. Returns whether some of its corners may be opposite: two directions that are
// both on the side of a third one, the first corner's, are not.
static bool sum_group(const struct work *work, const uint32_t *corners, uint32_t count,
                      struct direction *out)
{
    double first_u[3] = {0, 0, 0}, first_v[3] = {0, 0, 0}, along_u[3], along_v[3];
    bool is_mirrored, is_first = true, is_wide = false;
    for (uint32_t i = 0; i < count; i++) {
        if (!corner_directions(work, corners[i], along_u, along_v, &is_mirrored))
            continue;
        if (is_first) {
            memcpy(first_u, along_u, sizeof first_u);
            memcpy(first_v, along_v, sizeof first_v);
        }
        is_first = false;
        is_wide |= !(vec3_dot(along_u, first_u) > 0 && vec3_dot(along_v, first_v) > 0);
        add_corner(work, corners[i], along_u, is_mirrored, out);
    }
    return is_wide;
}

// The directions of all groups, after the corners with opposites have been given their own; NULL
// when out of memory.
static struct direction *sum_directions(struct work *work)
{
    struct members members;
    uint32_t groups = work->group_count, wide_corners = 0;
    struct direction *directions = ARENA_NEW(&work->arena, struct direction, groups);
    bool *is_wide = ARENA_NEW(&work->arena, bool, groups);
    if (!directions || !is_wide || !list_members(work, &members))
        return NULL;
    for (uint32_t g = 0; g < groups; g++) {
        uint32_t count = members.first[g + 1] - members.first[g];
        is_wide[g] = sum_group(work, members.corners + members.first[g], count, &directions[g]) &&
                     count <= MOST_COMPARED;
        wide_corners += is_wide[g] ? count : 0;
    }
    if (wide_corners == 0)
        return directions;
    // One place more for a sum that is compared before it is kept.
    struct direction *all =
        ARENA_NEW(&work->arena, struct direction, (size_t)groups + wide_corners + 1);
    if (!all)
        return NULL;
    memcpy(all, directions, groups * sizeof *directions);
    for (uint32_t g = 0; g < groups; g++)
        if (is_wide[g])
            divide_group(work, members.corners + members.first[g],
                         members.first[g + 1] - members.first[g], all);
    return all;
}

// --- tangents ------------------------------------------------------------------------------------

// Where nothing says which way u grows, any direction in the plane of the normal will do: along the
// axis that is farthest from the normal.
static void any_tangent(const double normal[3], double out[3])
{
    int axis = 0;
    for (int i = 1; i < 3; i++)
        if (fabs(normal[i]) < fabs(normal[axis]))
            axis = i;
    for (int i = 0; i < 3; i++)
        out[i] = i == axis ? 1 : 0;
    project(normal, out);
}

static void corner_tangent(const struct work *work, uint32_t corner,
                           const struct direction *direction, float out[4])
{
    double tangent[3] = {direction->sum[0], direction->sum[1], direction->sum[2]};
    if (!vec3_normalize(tangent)) {
        double normal[3];
        corner_normal(work, corner, normal);
        any_tangent(normal, tangent);
    }
    for (int i = 0; i < 3; i++)
        out[i] = (float)tangent[i];
    out[3] = direction->is_mirrored ? -1.0f : 1.0f;
}

// --- vertices ------------------------------------------------------------------------------------

// The vertices that the mesh will have: one for each pair of an old one and a group.
struct split {
    uint32_t count;
    uint32_t *source, *corner; // of new vertices: the old one, a corner that uses it
    uint32_t *next;            // of new vertices: another one of the same old vertex
    uint32_t *first;           // of old vertices: a new one, or NONE
    uint32_t *new_vertex;      // of corners
};

static bool split_vertices(struct work *work, struct split *split)
{
    struct arena *arena = &work->arena;
    uint32_t vertex_count = work->mesh->vertex_count;
    *split = (struct split){
        .source = ARENA_NEW(arena, uint32_t, work->corner_count),
        .corner = ARENA_NEW(arena, uint32_t, work->corner_count),
        .next = ARENA_NEW(arena, uint32_t, work->corner_count),
        .first = ARENA_NEW(arena, uint32_t, vertex_count),
        .new_vertex = ARENA_NEW(arena, uint32_t, work->corner_count),
    };
    if (!split->source || !split->corner || !split->next || !split->first || !split->new_vertex)
        return false;
    for (uint32_t v = 0; v < vertex_count; v++)
        split->first[v] = NONE;
    for (uint32_t c = 0; c < work->corner_count; c++) {
        uint32_t old = corner_vertex(work, c), v = split->first[old];
        while (v != NONE && work->group[split->corner[v]] != work->group[c])
            v = split->next[v];
        if (v == NONE) {
            v = split->count++;
            split->source[v] = old;
            split->corner[v] = c;
            split->next[v] = split->first[old];
            split->first[old] = v;
        }
        split->new_vertex[c] = v;
    }
    return true;
}

// Copies elements of `size` bytes to where the new vertices are; NULL stays NULL.
static bool take_elements(const struct split *split, struct arena *arena, size_t size, void *array)
{
    const char *old;
    memcpy(&old, array, sizeof old);
    if (!old)
        return true;
    char *copy = arena_alloc(arena, split->count, size);
    if (!copy)
        return false;
    for (uint32_t v = 0; v < split->count; v++)
        memcpy(copy + v * size, old + split->source[v] * size, size);
    memcpy(array, &copy, sizeof copy);
    return true;
}

static bool rebuild(const struct split *split, struct arena *arena, struct mesh *mesh)
{
    uint32_t(*indices)[3] = arena_alloc(arena, mesh->triangle_count, sizeof *indices);
    if (!indices || !take_elements(split, arena, sizeof *mesh->positions, &mesh->positions) ||
        !take_elements(split, arena, sizeof *mesh->exact_positions, &mesh->exact_positions) ||
        !take_elements(split, arena, sizeof *mesh->normals, &mesh->normals) ||
        !take_elements(split, arena, sizeof *mesh->uvs[0], &mesh->uvs[0]) ||
        !take_elements(split, arena, sizeof *mesh->uvs[1], &mesh->uvs[1]) ||
        !take_elements(split, arena, sizeof *mesh->colors, &mesh->colors))
        return false;
    memcpy(indices, split->new_vertex, mesh->triangle_count * sizeof *indices);
    mesh->indices = indices;
    mesh->vertex_count = split->count;
    return true;
}

// --- the whole -----------------------------------------------------------------------------------

static bool start(struct work *work)
{
    struct arena *arena = &work->arena;
    size_t corners = work->corner_count, slots = 1;
    while (slots < corners)
        slots *= 2;
    work->mask = (uint32_t)(slots - 1);
    work->flags = ARENA_NEW(arena, uint8_t, work->mesh->triangle_count);
    work->weld = ARENA_NEW(arena, uint32_t, corners);
    work->across = ARENA_NEW(arena, uint32_t, corners);
    work->group = ARENA_NEW(arena, uint32_t, corners);
    work->heads = ARENA_NEW(arena, uint32_t, slots);
    work->next = ARENA_NEW(arena, uint32_t, corners);
    work->stack = ARENA_NEW(arena, uint32_t, 2 * (size_t)work->mesh->triangle_count + 2);
    return work->flags && work->weld && work->across && work->group && work->heads && work->next &&
           work->stack;
}

// Whether the new vertices are the old ones in another order.
static bool keeps_vertices(const struct work *work, const struct split *split)
{
    uint32_t used = 0;
    for (uint32_t v = 0; v < work->mesh->vertex_count; v++)
        used += split->first[v] != NONE;
    return used == work->mesh->vertex_count && split->count == used;
}

static bool generate(struct work *work, struct arena *arena, struct mesh *mesh)
{
    struct split split;
    if (!start(work))
        return false;
    classify_triangles(work);
    uint32_t *known = ARENA_NEW(&work->arena, uint32_t, mesh->vertex_count);
    if (!known)
        return false;
    for (uint32_t v = 0; v < mesh->vertex_count; v++)
        known[v] = NONE;
    weld_corners(work, known);
    connect_triangles(work);
    group_corners(work);
    const struct direction *directions = sum_directions(work);
    if (!directions || !split_vertices(work, &split))
        return false;
    bool is_kept = keeps_vertices(work, &split);
    float(*tangents)[4] = arena_alloc(arena, split.count, sizeof *tangents);
    if (!tangents)
        return false;
    for (uint32_t v = 0; v < split.count; v++)
        corner_tangent(work, split.corner[v], &directions[work->group[split.corner[v]]],
                       tangents[is_kept ? split.source[v] : v]);
    mesh->tangents = tangents;
    return is_kept || rebuild(&split, arena, mesh);
}

// Every corner has a number below NONE.
#define MOST_TRIANGLES (UINT32_MAX / 3)

bool mesh_generate_tangents(struct mesh *mesh, uint32_t uv_set, struct arena *arena,
                            struct err *err)
{
    if (mesh->triangle_count > MOST_TRIANGLES)
        return err_set(err, ERR_INPUT, "mesh \"%s\": %u triangles to make tangents for; at most %u",
                       mesh->name, mesh->triangle_count, MOST_TRIANGLES);
    struct work work = {
        .mesh = mesh,
        .uvs = (const float(*)[2])mesh->uvs[uv_set],
        .corner_count = 3 * mesh->triangle_count,
    };
    if (arena->limit_bytes > 0)
        work.arena.limit_bytes =
            arena->used_bytes < arena->limit_bytes ? arena->limit_bytes - arena->used_bytes : 1;
    bool ok = generate(&work, arena, mesh) ||
              err_memory(err, "tangents", mesh->triangle_count * UINT64_C(200));
    arena_finish(&work.arena);
    return ok;
}
