// The groups of corners that share a tangent. Internal to scene/: the first half of tangents.c.
#ifndef LAMPYRIS_SCENE_MESH_TANGENT_GROUPS_H
#define LAMPYRIS_SCENE_MESH_TANGENT_GROUPS_H

#include "scene/core/scene.h"

#define TANGENT_NONE UINT32_MAX

// Of triangles.
enum {
    TANGENT_MIRRORED = 1, // its picture is turned over
    TANGENT_NO_AREA = 2,  // two corners in one place: takes part in nothing
    TANGENT_NO_MAP = 4,   // no direction of u or v: goes along with its neighbours
    TANGENT_ORIENTED = 8, // TANGENT_NO_MAP, and has joined a group, whose orientation it took
};

// A corner is 3 * triangle + 0, 1 or 2; its edge leads to the triangle's next corner.
struct tangent_work {
    struct arena arena;
    const struct mesh *mesh;
    const float (*uvs)[2];
    uint32_t corner_count;
    uint8_t *flags;   // of triangles
    uint32_t *weld;   // of corners: the first corner that is the same vertex
    uint32_t *across; // of corners: the triangle on the other side of the edge, or TANGENT_NONE
    uint32_t *group;  // of corners
    uint32_t group_count;
    // A hash table of corners: chains begin at heads[hash & mask] and go on in ascending order.
    uint32_t *heads, *next;
    uint32_t mask;
    uint32_t *stack;                 // of triangles
    const struct progress *progress; // NULL: nobody listens
    uint64_t steps;                  // of loops, so far
    bool is_stopped;                 // what has been made is not whole
};

// For loops over corners and triangles: whether to go on.
static inline bool tangent_goes_on(struct tangent_work *work)
{
    work->is_stopped = work->is_stopped || progress_stops_at(work->progress, ++work->steps);
    return !work->is_stopped;
}

// Fills in the arrays of *work, whose mesh, uvs and corner_count are set; memory comes from its
// arena. False when that is out, or when asked to stop.
bool tangent_groups_make(struct tangent_work *work);

static inline uint32_t tangent_next_corner(uint32_t corner)
{
    return corner % 3 == 2 ? corner - 2 : corner + 1;
}

static inline uint32_t tangent_previous_corner(uint32_t corner)
{
    return corner % 3 == 0 ? corner + 2 : corner - 1;
}

static inline uint32_t tangent_vertex(const struct tangent_work *work, uint32_t corner)
{
    return work->mesh->indices[corner / 3][corner % 3];
}

// The mesh's normal at a corner, else the triangle's, of unit length; zero where neither has one.
void tangent_corner_normal(const struct tangent_work *work, uint32_t corner, double out[3]);

// The directions of growing u and v, of unit length: Mikkelsen 2008, section 3.3. Sets *is_mirrored
// by the orientation of (u, v) with v upwards. False when the texture coordinates give no
// direction.
bool tangent_directions(const struct tangent_work *work, uint32_t triangle, double along_u[3],
                        double along_v[3], bool *is_mirrored);

#endif
