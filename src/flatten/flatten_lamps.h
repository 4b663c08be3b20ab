// Mesh lamps that are small relative to their coordinates. Part of flatten.c.
//
// Rounding the corners of such a lamp in the scene's coordinates changes areas, normals and
// occlusion too much. The lamp therefore gets coordinates of its own. Its triangles keep their
// exact edges, which determine their light, and corners relative to the lamp's centre, which
// determine how the lamp occludes its own points as seen from a surface that it lights.
#ifndef LAMPYRIS_FLATTEN_FLATTEN_LAMPS_H
#define LAMPYRIS_FLATTEN_FLATTEN_LAMPS_H

#include "flatten/flatten_census.h"
#include "flatten/flatten_placement.h"

// A lamp: emissive triangles, of any instances, that are closer to each other than single precision
// resolves.
struct lamp {
    struct bounds bounds; // in the arrays' coordinates
    uint32_t triangle_count;
};

// A triangle of a lamp: an instance, a triangle in its mesh, and the index of the lamp.
struct lamp_triangle {
    uint32_t instance, triangle, lamp;
};

struct lamps {
    struct lamp *items;
    uint32_t count;
    struct lamp_triangle *triangles; // in ascending order of instance and triangle
    uint32_t triangle_count;
};

// Finds the small lamps among the instances that are flattened into the world. Memory comes from
// `scratch`. flat->origin and flat->scale must be set.
bool flatten_find_lamps(const struct flatten_params *params, const struct census *census,
                        const struct flat_scene *flat, struct arena *scratch, struct lamps *out,
                        struct err *err);

// Adds a triangle of lamp `number` to flat->small, which has room, as the next flat triangle. Its
// edges in flat->triangles are rounded away from the first corner, so that their box contains the
// triangle. `normal` becomes the normal of the exact corners, not normalised. A triangle without
// area is not added.
void lamp_add_triangle(const struct lamps *lamps, uint32_t number, const double corners[3][3],
                       double normal[3], struct flat_scene *flat);

// Numbers the small triangles by lamp: sets their place, first and count.
bool lamps_finish(const struct lamps *lamps, struct flat_scene *flat, struct arena *scratch,
                  struct err *err);

#endif
