// Lamps of triangles that are small for where they are. Part of flatten.c.
//
// Rounded corners in the scene's coordinates say little of the form of such a lamp: areas, normals,
// and what hides what are lost. So the lamp gets coordinates of its own: its triangles keep their
// edges, which is what they send light by, and their corners about the lamp's middle, by which it
// is found what of the lamp hides a point of it from what is lit.
#ifndef LAMPYRIS_FLATTEN_FLATTEN_LAMPS_H
#define LAMPYRIS_FLATTEN_FLATTEN_LAMPS_H

#include "flatten/flatten_census.h"
#include "flatten/flatten_placement.h"

// One lamp: emissive triangles, of whatever instances, that are nearer to each other than rounding
// can tell.
struct lamp {
    struct bounds bounds; // in the arrays' space
    uint32_t triangle_count;
};

// A triangle of one, as it stands in the scene.
struct lamp_triangle {
    uint32_t instance, triangle, lamp;
};

struct lamps {
    struct lamp *items;
    uint32_t count;
    struct lamp_triangle *triangles; // ascending by instance and triangle
    uint32_t triangle_count;
};

// Finds the lamps among the instances that are flattened into the world. Memory comes from
// `scratch`. out->origin and out->scale are set.
bool flatten_find_lamps(const struct flatten_params *params, const struct census *census,
                        const struct flat_scene *flat, struct arena *scratch, struct lamps *out,
                        struct err *err);

// Takes a triangle of a lamp into flat->small, which has room, under the number that it will have
// among flat->triangles, and gives it corners there that contain it: edges rounded away from the
// first one. `normal` becomes that of the exact corners, not normalised. What has no area stays
// out.
void lamp_add_triangle(const struct lamps *lamps, uint32_t number, const double corners[3][3],
                       double normal[3], struct flat_scene *flat);

// Gives the triangles of each lamp their places beside each other.
bool lamps_finish(const struct lamps *lamps, struct flat_scene *flat, struct arena *scratch,
                  struct err *err);

#endif
