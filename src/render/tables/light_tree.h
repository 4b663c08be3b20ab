// A binary tree over emitters. Kernels descend it to choose an emitter by its bound on the
// contribution to a point (Conty Estevez and Kulla 2018, "Importance Sampling of Many Lights with
// Adaptive Tree Splitting"; the bounds of directions as in Pharr, Jakob, Humphreys 2023, section
// 12.6.3).
#ifndef LAMPYRIS_RENDER_TABLES_LIGHT_TREE_H
#define LAMPYRIS_RENDER_TABLES_LIGHT_TREE_H

#include "base/arena.h"
#include "base/err.h"
#include "base/progress.h"
#include "shared/types.h"
#include <cglm/struct/vec3.h>
#include <stdbool.h>
#include <stdint.h>

// Bounds of the positions of emitters and of the directions that they send light to. Boxes are in
// single precision, as their triangles are. Emitters send light at most theta_e away from some
// direction that is within theta_o of the axis. Only cglm's functions of three components are used:
// they are scalar on every machine.
struct light_bounds {
    vec3s min, max;
    vec3s center; // centre of a bounding sphere
    float radius;
    double axis[3];          // unit
    double theta_o, theta_e; // radians, [0, pi] and [0, pi / 2]
    double power;            // the greatest in any direction: luminance of an intensity
    bool two_sided;          // they send as much in the opposite directions
};

// Returns the middle of the box: corners are halved first, so that the sum cannot overflow.
static inline vec3s light_bounds_middle(const struct light_bounds *bounds)
{
    return glms_vec3_add(glms_vec3_scale(bounds->min, 0.5f), glms_vec3_scale(bounds->max, 0.5f));
}

struct light_tree {
    struct gpu_light_bounds *nodes; // count - 1 pairs, parents before children, the root first
    struct gpu_light_trail *trails; // count, in the order of the emitters
    struct gpu_lamp *lamps;         // lamp_count
    uint32_t root;                  // a child's word
};

// The input: emitters of positive power, at least one.
struct light_tree_params {
    const struct light_bounds *bounds;
    const uint32_t *primitives; // their primitive words
    const uint32_t *lamps;      // the lamp of each: the emitters of a lamp are one subtree
    uint32_t count, lamp_count;
    const struct progress *progress;
};

// Builds the tree on all CPU threads; the result lives in `arena`.
bool light_tree_build(const struct light_tree_params *params, struct arena *arena,
                      struct light_tree *out, struct err *err);

#endif
