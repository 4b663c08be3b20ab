// Groups of corners that share a tangent: the first step of tangents.c. Internal to scene/.
#ifndef LAMPYRIS_SCENE_MESH_TANGENT_GROUPS_H
#define LAMPYRIS_SCENE_MESH_TANGENT_GROUPS_H

#include "scene/core/scene.h"

#define TANGENT_NONE UINT32_MAX

// Flags of triangles.
enum {
    TANGENT_MIRRORED = 1, // the texture is mirrored
    TANGENT_NO_AREA = 2,  // two corners coincide; the triangle is ignored
    TANGENT_NO_MAP = 4,   // texture coordinates give no direction; follows its neighbours
    TANGENT_ORIENTED = 8, // a TANGENT_NO_MAP triangle that took the orientation of a group
};

// Working data. A corner is 3 * triangle + 0, 1 or 2; its edge leads to the triangle's next corner.
struct tangent_work {
    struct arena arena;
    const struct mesh *mesh;
    const float (*uvs)[2];
    uint32_t corner_count;
    uint8_t *flags;   // flags for each triangle
    uint32_t *weld;   // for each corner, the first corner that is equal to it
    uint32_t *across; // for each corner, the triangle across its edge, or TANGENT_NONE
    uint32_t *group;  // for each corner, its group
    uint32_t group_count;
    // A hash table of corners. Chains begin at heads[hash & mask] and are in ascending order.
    uint32_t *heads, *next;
    uint32_t mask;
    uint32_t *stack;                 // triangles to visit
    const struct progress *progress; // NULL: no listener
    uint64_t steps;                  // loop iterations so far
    bool is_stopped;                 // the listener requested a stop; the results are incomplete
};

// Must be called in loops over corners and triangles. Returns whether to go on.
static inline bool tangent_goes_on(struct tangent_work *work)
{
    work->is_stopped = work->is_stopped || progress_stops_at(work->progress, ++work->steps);
    return !work->is_stopped;
}

// Fills in the arrays of *work, whose mesh, uvs and corner_count must be set. Memory comes from its
// arena. Returns false when out of memory or when the listener requests a stop.
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

// Gets the mesh's normal at a corner, or else the triangle's, of unit length; zero if neither
// exists.
void tangent_corner_normal(const struct tangent_work *work, uint32_t corner, double out[3]);

// Computes the unit directions of increasing u and v (Mikkelsen 2008, section 3.3). Sets
// *is_mirrored by the orientation of (u, v) with v upwards. Returns false if the texture
// coordinates give no direction.
bool tangent_directions(const struct tangent_work *work, uint32_t triangle, double along_u[3],
                        double along_v[3], bool *is_mirrored);

#endif
