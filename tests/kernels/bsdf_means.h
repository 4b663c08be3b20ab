// Computes means over low-discrepancy samples: the reflected and transmitted light, and the
// fraction of samples that are absorbed.
#ifndef LAMPYRIS_TESTS_BSDF_MEANS_H
#define LAMPYRIS_TESTS_BSDF_MEANS_H

#include "bsdf_fixture.h"
#include "bsdf_grid.h"

struct bsdf_means {
    double absorbed, absorbed_error;   // fraction of the samples that are invalid, and its standard
                                       // error
    double albedo[3], albedo_error[3]; // energy: refracted radiance is multiplied by eta^2
};

// Uses `replicates` (2 to 64) independently shifted sets of `samples` points. Returns false if the
// device failed.
bool bsdf_measure(struct bsdf_device *device, const struct configuration *configuration,
                  uint32_t number, uint32_t replicates, uint32_t samples, struct bsdf_means *out);

#endif
