// The configurations that the BSDFs are tested in: materials, directions and indices from the grid
// of parameters, so that every two values of two axes meet, and the corners.
#ifndef LAMPYRIS_TESTS_BSDF_GRID_H
#define LAMPYRIS_TESTS_BSDF_GRID_H

#include "bsdf_cells.h"
#include "bsdf_reference.h"
#include "scene/core/scene_material.h"

struct configuration {
    char name[160];
    struct material material; // its name is `name`
    float wo[3];
    double angle; // angle of wo, degrees
    float eta;
    struct bsdf_choices choices;
};

// In out, at most `capacity`; returns how many.
uint32_t grid_covering(struct configuration *out, uint32_t capacity);
// Points drawn at random from the axes, with continuous values between theirs.
uint32_t grid_random(struct configuration *out, uint32_t count, uint64_t seed);

// Returns whether the material may reflect more than it receives, as its documentation says.
bool grid_gains(const struct configuration *configuration);

// Lobes narrower than this are deltas to every model, or as good as one.
#define SMALLEST_SCALE 1e-4

// Charts that follow the lobes of a configuration.
void grid_charts(const struct configuration *configuration, struct chart charts[SIDES]);

#endif
