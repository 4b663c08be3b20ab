// Means over low-discrepancy samples: what a surface reflects and lets through, and what it absorbs
// of the samples.
#ifndef LAMPYRIS_TESTS_BSDF_MEANS_H
#define LAMPYRIS_TESTS_BSDF_MEANS_H

#include "bsdf_fixture.h"
#include "bsdf_grid.h"

struct bsdf_means {
    double absorbed, absorbed_error;   // part of the samples that are invalid; standard error
    double albedo[3], albedo_error[3]; // energy: refracted radiance is scaled back by eta^2
};

// `replicates` (2 to 64) independently shifted sets of `samples` points. False: it could not run.
bool bsdf_measure(struct bsdf_device *device, const struct configuration *configuration,
                  uint32_t number, uint32_t replicates, uint32_t samples, struct bsdf_means *out);

#endif
