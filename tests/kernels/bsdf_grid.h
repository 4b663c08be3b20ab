// The configurations in which BSDFs are tested: materials, directions and indices of refraction
// from the grid of parameters, such that every two values of two axes occur together, and the
// corners of the grid.
#ifndef LAMPYRIS_TESTS_BSDF_GRID_H
#define LAMPYRIS_TESTS_BSDF_GRID_H

#include "bsdf_cells.h"
#include "bsdf_reference.h"
#include "scene/core/scene_material.h"

struct configuration {
    char name[160];
    struct material material; // its name is `name`
    float wo[3];
    double angle; // angle between wo and the normal, in degrees
    float eta;
    struct bsdf_choices choices;
};

// Writes at most `capacity` configurations to `out`. Returns their number.
uint32_t grid_covering(struct configuration *out, uint32_t capacity);
// Draws configurations at random; continuous axes also have values between those of the grid.
uint32_t grid_random(struct configuration *out, uint32_t count, uint64_t seed);

// Returns whether the material may reflect more than it receives, according to its documentation.
bool grid_gains(const struct configuration *configuration);

// Lobes narrower than this are treated as delta distributions by all models.
#define SMALLEST_SCALE 1e-4

// Chooses charts that follow the lobes of a configuration.
void grid_charts(const struct configuration *configuration, struct chart charts[SIDES]);

#endif
