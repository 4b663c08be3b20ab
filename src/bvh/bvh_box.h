// Defines axis-aligned boxes in single precision, for the builder, the collapse and the checks.
#ifndef LAMPYRIS_BVH_BVH_BOX_H
#define LAMPYRIS_BVH_BVH_BOX_H

#include "bvh/bvh.h"
#include <math.h>

static inline struct bvh_box box_empty(void)
{
    return (struct bvh_box){{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
}

// Comparisons compile to one instruction each, unlike fminf().
static inline void box_add_box(struct bvh_box *box, const struct bvh_box *other)
{
    for (int axis = 0; axis < 3; axis++) {
        box->min[axis] = other->min[axis] < box->min[axis] ? other->min[axis] : box->min[axis];
        box->max[axis] = other->max[axis] > box->max[axis] ? other->max[axis] : box->max[axis];
    }
}

static inline void box_add_point(struct bvh_box *box, const float point[3])
{
    for (int axis = 0; axis < 3; axis++) {
        box->min[axis] = point[axis] < box->min[axis] ? point[axis] : box->min[axis];
        box->max[axis] = point[axis] > box->max[axis] ? point[axis] : box->max[axis];
    }
}

// Returns half the surface area of a box that is not empty. It is computed in double precision,
// because the square of a float above 1.8e19 overflows.
static inline double box_half_area(const struct bvh_box *box)
{
    double x = (double)box->max[0] - box->min[0];
    double y = (double)box->max[1] - box->min[1];
    double z = (double)box->max[2] - box->min[2];
    return x * y + y * z + z * x;
}

#endif
