// Computes tangents after Mikkelsen 2008: the tangent of a group of corners is the mean of its
// triangles' directions of increasing u, projected onto the tangent plane and weighted by the angle
// at the corner.
#include "scene/mesh/tangents.h"

#include "scene/core/affine.h"
#include "scene/core/bounds.h"
#include "scene/mesh/tangent_groups.h"
#include <math.h>
#include <string.h>

// --- directions ----------------------------------------------------------------------------------

// Replaces v by its normalized component in the plane perpendicular to the unit normal. Returns
// false if the component is zero.
static bool project(const double normal[3], double v[3])
{
    double along = vec3_dot(normal, v);
    for (int i = 0; i < 3; i++)
        v[i] -= along * normal[i];
    return vec3_normalize(v);
}

// Returns the angle at a corner between its edges, projected along the normal.
static double corner_angle(const struct tangent_work *work, uint32_t corner, const double normal[3])
{
    double at[3], edges[2][3];
    const uint32_t ends[2] = {tangent_next_corner(corner), tangent_previous_corner(corner)};
    mesh_vertex(work->mesh, tangent_vertex(work, corner), at);
    for (int e = 0; e < 2; e++) {
        mesh_vertex(work->mesh, tangent_vertex(work, ends[e]), edges[e]);
        vec3_subtract(edges[e], at, edges[e]);
        if (!project(normal, edges[e]))
            return 0;
    }
    return acos(fmin(fmax(vec3_dot(edges[0], edges[1]), -1), 1));
}

// The sum of directions in a group.
struct direction {
    double sum[3]; // sum of the directions of increasing u, weighted by angle
    bool is_mirrored;
};

// Computes the directions of increasing u and v at a corner, in its tangent plane. Returns false if
// the triangle has none.
static bool corner_directions(const struct tangent_work *work, uint32_t corner, double along_u[3],
                              double along_v[3], bool *is_mirrored)
{
    double normal[3];
    if (work->flags[corner / 3] & (TANGENT_NO_AREA | TANGENT_NO_MAP))
        return false;
    tangent_corner_normal(work, corner, normal);
    return tangent_directions(work, corner / 3, along_u, along_v, is_mirrored) &&
           project(normal, along_u) && project(normal, along_v);
}

// Adds a corner, with direction `along_u`, to the sum.
static void add_corner(const struct tangent_work *work, uint32_t corner, const double along_u[3],
                       bool is_mirrored, struct direction *direction)
{
    double normal[3];
    tangent_corner_normal(work, corner, normal);
    double angle = corner_angle(work, corner, normal);
    direction->is_mirrored = is_mirrored;
    for (int i = 0; i < 3; i++)
        direction->sum[i] += angle * along_u[i];
}

// --- opposite directions -------------------------------------------------------------------------

// In Mikkelsen's program the mean at a corner omits triangles whose direction is opposite to the
// corner's own (their cosine, in single precision, is -1). Such triangles meet at a pole of a
// sphere if the pole is one vertex.

static bool is_opposite(const double a[3], const double b[3])
{
    float dot = 0;
    for (int i = 0; i < 3; i++)
        dot += (float)a[i] * (float)b[i];
    return dot <= -1.0f;
}

// The corners, sorted by group.
struct members {
    uint32_t *corners;
    uint32_t *first; // start of each group, and the end of the last
};

static bool list_members(struct tangent_work *work, struct members *members)
{
    members->corners = ARENA_NEW(&work->arena, uint32_t, work->corner_count);
    members->first = ARENA_NEW(&work->arena, uint32_t, (size_t)work->group_count + 2);
    if (!members->corners || !members->first)
        return false;
    // Sorts by counting. The counts are stored two places further and are shifted by one while
    // filling in.
    for (uint32_t c = 0; c < work->corner_count; c++)
        members->first[work->group[c] + 2]++;
    for (uint32_t g = 1; g <= work->group_count; g++)
        members->first[g + 1] += members->first[g];
    for (uint32_t c = 0; c < work->corner_count; c++)
        members->corners[members->first[work->group[c] + 1]++] = c;
    return true;
}

// Computes the sum of the directions of a group without those opposite to corner `own`. Returns
// false if there are no opposite directions.
static bool sum_without_opposites(const struct tangent_work *work, uint32_t own,
                                  const uint32_t *corners, uint32_t count, struct direction *out)
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

// The maximum number of corners of a group whose pairs are compared. Larger groups would take
// seconds, so no directions are omitted from their sums.
#define MOST_COMPARED 4096

static bool is_same_sum(const struct direction *a, const struct direction *b)
{
    return a->sum[0] == b->sum[0] && a->sum[1] == b->sum[1] && a->sum[2] == b->sum[2];
}

// Moves the corners of a group that have opposite corners in it to new groups, one for each
// distinct sum. `directions` has the sums of all groups so far, and room for one more for each
// corner.
static void divide_group(struct tangent_work *work, const uint32_t *corners, uint32_t count,
                         struct direction *directions)
{
    uint32_t first_new = work->group_count;
    for (uint32_t i = 0; i < count && !work->is_stopped; i++) {
        struct direction *direction = &directions[work->group_count];
        work->steps += count;
        work->is_stopped = progress_should_stop(work->progress);
        if (!sum_without_opposites(work, corners[i], corners, count, direction))
            continue;
        uint32_t g = first_new;
        while (g < work->group_count && !is_same_sum(&directions[g], direction))
            g++;
        work->group[corners[i]] = g;
        work->group_count += g == work->group_count;
    }
}

// Sums the directions of a group. Returns whether some of its corners may be opposite. None are if
// the cosines of all directions with the first corner's are positive.
static bool sum_group(const struct tangent_work *work, const uint32_t *corners, uint32_t count,
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

// Computes the directions of all groups, after moving corners with opposites to new groups; NULL
// when out of memory.
static struct direction *sum_directions(struct tangent_work *work)
{
    struct members members;
    uint32_t groups = work->group_count, wide_corners = 0;
    struct direction *directions = ARENA_NEW(&work->arena, struct direction, groups);
    bool *is_wide = ARENA_NEW(&work->arena, bool, groups);
    if (!directions || !is_wide || !list_members(work, &members))
        return NULL;
    for (uint32_t g = 0; g < groups && tangent_goes_on(work); g++) {
        uint32_t count = members.first[g + 1] - members.first[g];
        is_wide[g] = sum_group(work, members.corners + members.first[g], count, &directions[g]) &&
                     count <= MOST_COMPARED;
        wide_corners += is_wide[g] ? count : 0;
    }
    if (wide_corners == 0 || work->is_stopped)
        return directions;
    // The additional element holds a sum until it has been compared with the others.
    struct direction *all =
        ARENA_NEW(&work->arena, struct direction, (size_t)groups + wide_corners + 1);
    if (!all)
        return NULL;
    memcpy(all, directions, groups * sizeof *directions);
    for (uint32_t g = 0; g < groups && tangent_goes_on(work); g++)
        if (is_wide[g])
            divide_group(work, members.corners + members.first[g],
                         members.first[g + 1] - members.first[g], all);
    return all;
}

// --- tangents ------------------------------------------------------------------------------------

// Chooses a tangent if no direction of increasing u is known: the projection onto the tangent plane
// of the axis that is farthest from the normal.
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

static void corner_tangent(const struct tangent_work *work, uint32_t corner,
                           const struct direction *direction, float out[4])
{
    double tangent[3] = {direction->sum[0], direction->sum[1], direction->sum[2]};
    if (!vec3_normalize(tangent)) {
        double normal[3];
        tangent_corner_normal(work, corner, normal);
        any_tangent(normal, tangent);
    }
    for (int i = 0; i < 3; i++)
        out[i] = (float)tangent[i];
    out[3] = direction->is_mirrored ? -1.0f : 1.0f;
}

// --- vertices ------------------------------------------------------------------------------------

// The vertices of the result: one for each pair of an old vertex and a group.
struct split {
    uint32_t count;
    uint32_t *source, *corner; // for each new vertex: the old one, and a corner that uses it
    uint32_t *next;            // for each new vertex: another new one of the same old vertex
    uint32_t *first;           // for each old vertex: a new one, or TANGENT_NONE
    uint32_t *new_vertex;      // for each corner: its new vertex
};

static bool split_vertices(struct tangent_work *work, struct split *split)
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
        split->first[v] = TANGENT_NONE;
    for (uint32_t c = 0; c < work->corner_count && tangent_goes_on(work); c++) {
        uint32_t old = tangent_vertex(work, c), v = split->first[old];
        while (v != TANGENT_NONE && work->group[split->corner[v]] != work->group[c])
            v = split->next[v];
        if (v == TANGENT_NONE) {
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

// Copies elements of `size` bytes to the new vertices; NULL stays NULL.
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

// --- the whole computation -----------------------------------------------------------------------

// Returns whether the new vertices are the old ones in another order.
static bool keeps_vertices(const struct tangent_work *work, const struct split *split)
{
    uint32_t used = 0;
    for (uint32_t v = 0; v < work->mesh->vertex_count; v++)
        used += split->first[v] != TANGENT_NONE;
    return used == work->mesh->vertex_count && split->count == used;
}

static bool generate(struct tangent_work *work, struct arena *arena, struct mesh *mesh)
{
    struct split split;
    if (!tangent_groups_make(work))
        return false;
    const struct direction *directions = sum_directions(work);
    if (!directions || work->is_stopped || !split_vertices(work, &split) || work->is_stopped)
        return false;
    bool is_kept = keeps_vertices(work, &split);
    float(*tangents)[4] = arena_alloc(arena, split.count, sizeof *tangents);
    if (!tangents)
        return false;
    for (uint32_t v = 0; v < split.count && tangent_goes_on(work); v++)
        corner_tangent(work, split.corner[v], &directions[work->group[split.corner[v]]],
                       tangents[is_kept ? split.source[v] : v]);
    if (work->is_stopped)
        return false;
    mesh->tangents = tangents;
    return is_kept || rebuild(&split, arena, mesh);
}

// The maximum number of triangles. The number of every corner must be below TANGENT_NONE.
#define MOST_TRIANGLES (UINT32_MAX / 3)

bool mesh_generate_tangents(struct mesh *mesh, uint32_t uv_set, const struct progress *progress,
                            struct arena *arena, struct err *err)
{
    if (mesh->triangle_count > MOST_TRIANGLES)
        return err_set(err, ERR_INPUT,
                       "mesh \"%s\": %u triangles need tangents; expected at most %u", mesh->name,
                       mesh->triangle_count, MOST_TRIANGLES);
    struct tangent_work work = {
        .mesh = mesh,
        .uvs = (const float(*)[2])mesh->uvs[uv_set],
        .corner_count = 3 * mesh->triangle_count,
        .progress = progress,
    };
    bool ok = generate(&work, arena, mesh);
    if (!ok && work.is_stopped)
        err_set(err, ERR_STOPPED, "stopped while computing tangents");
    else if (!ok)
        err_memory(err, "tangents", mesh->triangle_count * UINT64_C(200));
    arena_finish(&work.arena);
    return ok;
}
