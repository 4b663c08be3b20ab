// Builds a binary tree over emitters. Kernels descend the tree to select an emitter in proportion
// to a bound on its contribution to a point (Conty Estevez and Kulla 2018, "Importance Sampling of
// Many Lights with Adaptive Tree Splitting"; bounds of directions as in Pharr, Jakob, Humphreys
// 2023, section 12.6.3).
#ifndef LAMPYRIS_RENDER_TABLES_LIGHT_TREE_H
#define LAMPYRIS_RENDER_TABLES_LIGHT_TREE_H

#include "base/arena.h"
#include "base/err.h"
#include "base/progress.h"
#include "shared/types.h"
#include <cglm/struct/vec3.h>
#include <stdbool.h>
#include <stdint.h>

// Bounds of emitters' positions and of the directions in which they emit. Boxes are in single
// precision, like the triangles in them. Each emitter emits within an angle theta_e of some
// direction that is within theta_o of the axis. Only cglm's functions of three components are used,
// because these are scalar on every machine.
struct light_bounds {
    vec3s min, max;
    vec3s center; // centre of the bounding sphere
    float radius;
    double axis[3];          // unit vector
    double theta_o, theta_e; // radians, in [0, pi] and [0, pi / 2]
    double power;            // upper bound over all directions of the intensity's luminance
    bool two_sided;          // emission is the same in opposite directions
};

// Returns the middle of the box. The corners are halved before they are added, so that the sum
// cannot overflow.
static inline vec3s light_bounds_middle(const struct light_bounds *bounds)
{
    return glms_vec3_add(glms_vec3_scale(bounds->min, 0.5f), glms_vec3_scale(bounds->max, 0.5f));
}

struct light_tree {
    struct gpu_light_bounds *nodes; // count - 1 pairs; parents come before children, the root first
    struct gpu_light_trail *trails; // count trails, in the order of the emitters
    struct gpu_lamp *lamps;         // lamp_count lamps
    uint32_t root;                  // the root, encoded as gpu_light_bounds.child
};

// The input: at least one emitter; all have positive power.
struct light_tree_params {
    const struct light_bounds *bounds;
    const uint32_t *primitives; // primitive words of the emitters
    const uint32_t *lamps;      // lamp of each emitter; the emitters of a lamp form one subtree
    uint32_t count, lamp_count;
    const struct progress *progress;
};

// Builds the tree on all CPU threads; the result lives in `arena`.
bool light_tree_build(const struct light_tree_params *params, struct arena *arena,
                      struct light_tree *out, struct err *err);

#endif
