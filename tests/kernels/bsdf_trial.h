// One configuration's trial: the shipped BSDF's samples and densities against each other and
// against the reference in double precision.
#ifndef LAMPYRIS_TESTS_BSDF_TRIAL_H
#define LAMPYRIS_TESTS_BSDF_TRIAL_H

#include "bsdf_fixture.h"
#include "bsdf_grid.h"

struct trial_params {
    uint32_t samples;    // samples for the chi-square test
    uint32_t replicates; // sets of low-discrepancy points, independently shifted
    uint32_t replicate_samples;
    uint32_t compared;   // samples and nodes compared with the reference, each
    double significance; // significance of each chi-square test
};

// A trial's findings; trial_check() judges them, the tables sum them up.
struct trial {
    double chi_p; // for counts in cells, of deltas and of absorbed samples; the lesser of two tests
    uint32_t chi_degrees;
    double impossible;         // part of the samples where nothing is expected
    double integral;           // integral of the shipped density
    double reference_integral; // integral of the reference's density
    double excess;             // integral of the density that is stated over the one that is drawn
    double delta_probability;  // probability of the reference's deltas
    double absorbed;           // part of the samples that are invalid
    double closure, closure_error; // |integral - excess + ... - 1|, standard error of absorbed
    double resolution;      // in units of the narrowest lobe; above 1/2 directions are not resolved
    double weight_error;    // worst |weight - f / pdf| / weight
    double reference_error; // worst of value and density against the reference, relative
    uint32_t ill_conditioned;          // left out of that: see bsdf_trial.c
    double delta_error;                // worst of the deltas' directions and weights
    double albedo[3], albedo_error[3]; // energy: refracted radiance is scaled back by eta^2
    uint32_t bad;                      // non-finite, negative, or accepted with density 0
    uint32_t nodes, unresolved;
    char worst[256]; // what differs most from the reference
};

// Item `number + 1` is the configuration's material in the device's scene. False: it could not run.
bool trial_run(struct bsdf_device *device, const struct configuration *configuration,
               uint32_t number, const struct trial_params *params, struct trial *out);
// Records failures.
void trial_check(const struct configuration *configuration, const struct trial_params *params,
                 const struct trial *trial);

#endif
