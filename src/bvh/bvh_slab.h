// Tests rays against boxes in double precision. The boxes are widened by more than the rounding
// errors of a triangle test, so that a ray that hits a triangle also enters every box around it.
#ifndef LAMPYRIS_BVH_BVH_SLAB_H
#define LAMPYRIS_BVH_BVH_SLAB_H

#include <math.h>
#include <stdbool.h>

// The triangle test computes coordinates relative to the ray's origin, and products of these, with
// a relative error of a few 2^-53 of the largest coordinate. The padding, 2^-46 of that coordinate,
// is 128 times 2^-53 of it, and 2^-22 of the spacing of floats there.
#define SLAB_PAD 0x1p-46

struct slab_ray {
    double origin[3], inverse[3];
    bool negative[3];
};

static inline struct slab_ray slab_ray_for(const double origin[3], const double direction[3])
{
    struct slab_ray slab;
    for (int axis = 0; axis < 3; axis++) {
        slab.origin[axis] = origin[axis];
        slab.inverse[axis] = 1 / direction[axis]; // for zeros, infinity with their sign
        slab.negative[axis] = signbit(direction[axis]);
    }
    return slab;
}

// Computes the interval of t in which the ray is in the widened box. Returns false if it is empty
// or wholly behind the origin. A plane that contains the ray gives 0 * infinity, a NaN; the
// comparisons below are then false, so that the plane does not limit the interval.
static inline bool slab_test(const struct slab_ray *ray, const double min[3], const double max[3],
                             double interval[2])
{
    double reach = 0;
    for (int axis = 0; axis < 3; axis++) {
        reach = fmax(reach, fabs(min[axis] - ray->origin[axis]));
        reach = fmax(reach, fabs(max[axis] - ray->origin[axis]));
    }
    double pad = reach * SLAB_PAD, near = -INFINITY, far = INFINITY;
    for (int axis = 0; axis < 3; axis++) {
        double lo = (min[axis] - ray->origin[axis] - pad) * ray->inverse[axis];
        double hi = (max[axis] - ray->origin[axis] + pad) * ray->inverse[axis];
        double enter = ray->negative[axis] ? hi : lo, leave = ray->negative[axis] ? lo : hi;
        near = enter > near ? enter : near;
        far = leave < far ? leave : far;
    }
    interval[0] = near;
    interval[1] = far;
    return near <= far && far >= 0;
}

#endif
