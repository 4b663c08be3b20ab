// Finds the corners that share a tangent, after Mikkelsen 2008 and the rules of his program:
// corners with the same position, normal and texture coordinates, whose triangles are connected by
// edges at that vertex and have the same orientation of the texture.
#include "scene/mesh/tangent_groups.h"

#include "scene/core/affine.h"
#include "scene/core/bounds.h"
#include <math.h>
#include <string.h>

// --- triangles -----------------------------------------------------------------------------------

// Computes the two edges from the triangle's first corner.
static void triangle_edges(const struct tangent_work *work, uint32_t triangle, double edges[2][3])
{
    double p[3][3];
    for (uint32_t c = 0; c < 3; c++)
        mesh_vertex(work->mesh, work->mesh->indices[triangle][c], p[c]);
    for (int e = 0; e < 2; e++)
        vec3_subtract(p[e + 1], p[0], edges[e]);
}

void tangent_corner_normal(const struct tangent_work *work, uint32_t corner, double out[3])
{
    if (work->mesh->normals) {
        const float *given = work->mesh->normals[tangent_vertex(work, corner)];
        vec3_widen(given, out);
        if (vec3_normalize(out))
            return;
    }
    double edges[2][3];
    triangle_edges(work, corner / 3, edges);
    vec3_cross(edges[0], edges[1], out);
    if (!vec3_normalize(out))
        memset(out, 0, 3 * sizeof *out);
}

bool tangent_directions(const struct tangent_work *work, uint32_t triangle, double along_u[3],
                        double along_v[3], bool *is_mirrored)
{
    const uint32_t *corners = work->mesh->indices[triangle];
    const float *uv[3] = {work->uvs[corners[0]], work->uvs[corners[1]], work->uvs[corners[2]]};
    double edges[2][3], du[2], dv[2];
    for (int e = 0; e < 2; e++) {
        du[e] = (double)uv[e + 1][0] - (double)uv[0][0];
        dv[e] = (double)uv[0][1] - (double)uv[e + 1][1]; // v points up
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

static bool is_same_place(const struct tangent_work *work, uint32_t a, uint32_t b)
{
    double p[2][3];
    mesh_vertex(work->mesh, a, p[0]);
    mesh_vertex(work->mesh, b, p[1]);
    return p[0][0] == p[1][0] && p[0][1] == p[1][1] && p[0][2] == p[1][2];
}

static void classify_triangles(struct tangent_work *work)
{
    for (uint32_t t = 0; t < work->mesh->triangle_count && tangent_goes_on(work); t++) {
        const uint32_t *corners = work->mesh->indices[t];
        double along_u[3], along_v[3];
        bool is_mirrored;
        if (is_same_place(work, corners[0], corners[1]) ||
            is_same_place(work, corners[1], corners[2]) ||
            is_same_place(work, corners[2], corners[0]))
            work->flags[t] = TANGENT_NO_AREA;
        else if (!tangent_directions(work, t, along_u, along_v, &is_mirrored))
            work->flags[t] = TANGENT_NO_MAP;
        else
            work->flags[t] = is_mirrored ? TANGENT_MIRRORED : 0;
    }
}

// --- connections ---------------------------------------------------------------------------------

static void clear_table(struct tangent_work *work)
{
    for (size_t i = 0; i <= work->mask; i++)
        work->heads[i] = TANGENT_NONE;
}

// Mixes bits by a bijection: the finaliser of SplitMix64 (Steele, Lea, Flood 2014) with the
// constants of Stafford's variant 13.
static uint64_t mix_bits(uint64_t x)
{
    x = (x ^ (x >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
    x = (x ^ (x >> 27)) * UINT64_C(0x94d049bb133111eb);
    return x ^ (x >> 31);
}

struct vertex_key {
    double numbers[8]; // position, normal, texture coordinates
};

static struct vertex_key key_of(const struct tangent_work *work, uint32_t corner)
{
    struct vertex_key key;
    uint32_t vertex = tangent_vertex(work, corner);
    mesh_vertex(work->mesh, vertex, key.numbers);
    tangent_corner_normal(work, corner, key.numbers + 3);
    for (int i = 0; i < 2; i++)
        key.numbers[6 + i] = (double)work->uvs[vertex][i];
    for (int i = 0; i < 8; i++)
        key.numbers[i] += 0.0; // turns -0 into 0
    return key;
}

static uint32_t *vertex_chain(const struct tangent_work *work, const struct vertex_key *key)
{
    uint64_t words[8], hash = 0;
    memcpy(words, key, sizeof words);
    for (int i = 0; i < 8; i++)
        hash = mix_bits(hash ^ words[i]);
    return &work->heads[hash & work->mask];
}

// Returns whether the mesh has a normal for a vertex. If so, all corners that use the vertex are
// equal.
static bool has_normal(const struct tangent_work *work, uint32_t vertex)
{
    const float *normal = work->mesh->normals ? work->mesh->normals[vertex] : NULL;
    return normal && (normal[0] != 0 || normal[1] != 0 || normal[2] != 0);
}

static bool is_same_key(const struct vertex_key *a, const struct vertex_key *b)
{
    for (int i = 0; i < 8; i++)
        if (a->numbers[i] != b->numbers[i])
            return false;
    return true;
}

// Returns the first corner that is equal to this one. If that is `corner` itself, *chain is where
// to insert it.
static uint32_t find_same(struct tangent_work *work, uint32_t corner, uint32_t **chain)
{
    const struct vertex_key key = key_of(work, corner);
    *chain = vertex_chain(work, &key);
    for (uint32_t same = **chain; same != TANGENT_NONE && tangent_goes_on(work);
         same = work->next[same]) {
        const struct vertex_key other = key_of(work, same);
        if (is_same_key(&key, &other))
            return same;
    }
    return corner;
}

// Finds the first equal corner of each corner. `known` must be TANGENT_NONE for each of the mesh's
// vertices.
static void weld_corners(struct tangent_work *work, uint32_t *known)
{
    clear_table(work);
    for (uint32_t c = 0; c < work->corner_count && tangent_goes_on(work); c++) {
        uint32_t vertex = tangent_vertex(work, c), *chain;
        work->weld[c] = known[vertex];
        if (known[vertex] != TANGENT_NONE)
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

// Returns the start of the hash chain of edges from one welded vertex to another.
static uint32_t *edge_chain(const struct tangent_work *work, uint32_t from, uint32_t to)
{
    return &work->heads[mix_bits((uint64_t)from << 32 | to) & work->mask];
}

// Connects triangles that traverse the same edge in opposite directions. If more than two triangles
// meet at an edge, each is paired with the first one that is not yet paired.
static void connect_triangles(struct tangent_work *work)
{
    clear_table(work);
    for (uint32_t c = work->corner_count; c-- > 0 && tangent_goes_on(work);) {
        work->across[c] = TANGENT_NONE;
        if (work->flags[c / 3] & TANGENT_NO_AREA)
            continue;
        uint32_t *head = edge_chain(work, work->weld[c], work->weld[tangent_next_corner(c)]);
        work->next[c] = *head;
        *head = c;
    }
    for (uint32_t c = 0; c < work->corner_count && tangent_goes_on(work); c++) {
        if (work->flags[c / 3] & TANGENT_NO_AREA || work->across[c] != TANGENT_NONE)
            continue;
        uint32_t from = work->weld[c], to = work->weld[tangent_next_corner(c)];
        uint32_t other = *edge_chain(work, to, from);
        while (other != TANGENT_NONE && tangent_goes_on(work) &&
               (work->across[other] != TANGENT_NONE || work->weld[other] != to ||
                work->weld[tangent_next_corner(other)] != from))
            other = work->next[other];
        if (other == TANGENT_NONE)
            continue;
        work->across[c] = other / 3;
        work->across[other] = c / 3;
    }
}

// --- groups --------------------------------------------------------------------------------------

// Adds a corner to a group and pushes the triangles across its two edges. Returns the new height of
// the stack.
static uint32_t join(struct tangent_work *work, uint32_t corner, uint32_t group, uint32_t stacked)
{
    const uint32_t neighbors[2] = {work->across[corner],
                                   work->across[tangent_previous_corner(corner)]};
    work->group[corner] = group;
    for (int i = 0; i < 2; i++)
        if (neighbors[i] != TANGENT_NONE)
            work->stack[stacked++] = neighbors[i];
    return stacked;
}

// Returns whether the triangle has this orientation. A triangle without an orientation takes this
// one.
static bool has_orientation(struct tangent_work *work, uint32_t triangle, bool is_mirrored)
{
    uint8_t *flags = &work->flags[triangle];
    if ((*flags & TANGENT_NO_MAP) && !(*flags & TANGENT_ORIENTED))
        *flags |= (uint8_t)(TANGENT_ORIENTED | (is_mirrored ? TANGENT_MIRRORED : 0));
    return ((*flags & TANGENT_MIRRORED) != 0) == is_mirrored;
}

// Adds all corners at one welded vertex that are reached from `start` over edges. Each triangle
// joins at most once and pushes at most two neighbours, so the stack needs at most 2 *
// triangle_count + 2 entries.
static void flood(struct tangent_work *work, uint32_t start, uint32_t group)
{
    uint32_t vertex = work->weld[start];
    bool is_mirrored = work->flags[start / 3] & TANGENT_MIRRORED;
    uint32_t stacked = join(work, start, group, 0);
    while (stacked > 0) {
        uint32_t triangle = work->stack[--stacked], corner = 3 * triangle;
        while (work->weld[corner] != vertex)
            corner++;
        if (work->group[corner] == TANGENT_NONE && has_orientation(work, triangle, is_mirrored))
            stacked = join(work, corner, group, stacked);
    }
}

// Assigns a group to each corner that flood() did not reach: the group of the same vertex in
// another triangle, or else a new group. `lent` is scratch memory for corner_count elements.
static void group_the_rest(struct tangent_work *work, uint32_t *lent)
{
    for (uint32_t c = 0; c < work->corner_count; c++)
        lent[c] = TANGENT_NONE;
    for (uint32_t c = 0; c < work->corner_count; c++)
        if (work->group[c] != TANGENT_NONE && lent[work->weld[c]] == TANGENT_NONE)
            lent[work->weld[c]] = work->group[c];
    for (uint32_t c = 0; c < work->corner_count; c++) {
        if (work->group[c] != TANGENT_NONE)
            continue;
        uint32_t *group = &lent[work->weld[c]];
        if (*group == TANGENT_NONE)
            *group = work->group_count++;
        work->group[c] = *group;
    }
}

static void group_corners(struct tangent_work *work)
{
    for (uint32_t c = 0; c < work->corner_count; c++)
        work->group[c] = TANGENT_NONE;
    for (uint32_t c = 0; c < work->corner_count && tangent_goes_on(work); c++)
        if (!(work->flags[c / 3] & (TANGENT_NO_AREA | TANGENT_NO_MAP)) &&
            work->group[c] == TANGENT_NONE)
            flood(work, c, work->group_count++);
    group_the_rest(work, work->next); // the chains are no longer needed
}

// --- the whole computation -----------------------------------------------------------------------

static bool allocate(struct tangent_work *work)
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

bool tangent_groups_make(struct tangent_work *work)
{
    uint32_t vertex_count = work->mesh->vertex_count;
    uint32_t *known = ARENA_NEW(&work->arena, uint32_t, vertex_count);
    if (!known || !allocate(work))
        return false;
    for (uint32_t v = 0; v < vertex_count; v++)
        known[v] = TANGENT_NONE;
    classify_triangles(work);
    if (!work->is_stopped)
        weld_corners(work, known);
    if (!work->is_stopped)
        connect_triangles(work);
    if (!work->is_stopped)
        group_corners(work);
    return !work->is_stopped;
}
