// The random spheres of a well-known tutorial (see generate_phong_spheres.c). All numbers are drawn
// from one sequence in the tutorial's order, so that a seed gives the tutorial's scene.
#ifndef LAMPYRIS_SCENE_GENERATE_PHONG_SPHERES_H
#define LAMPYRIS_SCENE_GENERATE_PHONG_SPHERES_H

#include "base/err.h"
#include "base/progress.h"
#include <stdint.h>

#define PHONG_SPHERES_COUNT_MAX 65536

struct phong_spheres {
    uint32_t count, seed;          // count: number of spheres that are tried
    double min_radius, max_radius; // 0 < min <= max
    double disc_radius; // radius of the disc about the origin, in y = 0, in which the spheres stand
    const struct progress *progress; // NULL: no listener
};

struct phong_sphere {
    float center[3], radius;
    float base_color[3], specular_color[3]; // in [0, 1]; the sum is at most 1 in each channel
    float smoothness;                       // [0, 1]; phong_exponent() converts it
    float emission[3];                      // radiance; if it is not 0, the colours are black
};

// Returns Phong's exponent for a smoothness s: 1000^(s^2), from 1 to 1000.
double phong_exponent(double smoothness);

// Tries `count` spheres on the plane y = 0 and keeps those that do not overlap an earlier one (86
// of 10000 for the tutorial's parameters). `out` must have room for `count` spheres. Fails with
// ERR_STOPPED when `progress` requests a stop.
bool phong_spheres_place(const struct phong_spheres *params, struct phong_sphere *out,
                         uint32_t *placed, struct err *err);

#endif
