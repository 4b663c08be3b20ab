// Lamps of triangles that are small relative to their coordinates. Part of flatten.c.
//
// Corners rounded in the scene's coordinates lose the form of such a lamp: areas, normals and
// occlusion. So the lamp gets coordinates of its own: its triangles keep their exact edges, which
// determine their light, and their corners about the lamp's centre, which determine how the lamp
// occludes its own points from a lit surface.
#ifndef LAMPYRIS_FLATTEN_FLATTEN_LAMPS_H
#define LAMPYRIS_FLATTEN_FLATTEN_LAMPS_H

#include "flatten/flatten_census.h"
#include "flatten/flatten_placement.h"

// A lamp: emissive triangles, of any instances, that are nearer to each other than rounding
// resolves.
struct lamp {
    struct bounds bounds; // in the arrays' coordinates
    uint32_t triangle_count;
};

// A triangle of a lamp, by its place in the scene.
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

// Adds a triangle of a lamp to flat->small, which has room, with its index in flat->triangles, and
// gives it corners there that contain it: edges are rounded away from the first corner. `normal`
// becomes that of the exact corners, not normalised. A triangle without area is not added.
void lamp_add_triangle(const struct lamps *lamps, uint32_t number, const double corners[3][3],
                       double normal[3], struct flat_scene *flat);

// Sorts the triangles of each lamp into adjacent places.
bool lamps_finish(const struct lamps *lamps, struct flat_scene *flat, struct arena *scratch,
                  struct err *err);

#endif
