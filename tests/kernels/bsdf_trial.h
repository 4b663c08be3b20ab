// The trial of one configuration: compares the samples and densities of the renderer's BSDF with
// each other and with the reference in double precision.
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

// The results of a trial. trial_check() judges them, and the tables summarise them.
struct trial {
    double chi_p; // for counts in cells, of deltas and of absorbed samples; the lesser of two tests
    uint32_t chi_degrees;
    double impossible;         // fraction of samples where nothing is expected
    double integral;           // integral of the shipped density
    double reference_integral; // integral of the reference's density
    double excess;             // by how much the integral of the stated density exceeds that of the
                               // sampled one
    double delta_probability;  // probability of the reference's deltas
    double absorbed;           // fraction of the samples that are invalid
    double closure, closure_error; // |integral - excess + ... - 1|, standard error of absorbed
    double resolution;             // in units of the narrowest lobe; above 1/2, directions are not
                                   // resolved
    double weight_error;           // greatest |weight - f / pdf| / weight
    double reference_error;   // greatest relative error of value and density against the reference
    uint32_t ill_conditioned; // omitted from reference_error: see bsdf_trial.c
    double delta_error;       // greatest error of the deltas' directions and weights
    double albedo[3], albedo_error[3]; // energy: refracted radiance is multiplied by eta^2
    uint32_t bad;                      // non-finite, negative, or accepted with density 0
    uint32_t nodes, unresolved;
    char worst[256]; // the greatest difference from the reference
};

// Item `number + 1` is the configuration's material in the device's scene. Returns false if the
// device failed.
bool trial_run(struct bsdf_device *device, const struct configuration *configuration,
               uint32_t number, const struct trial_params *params, struct trial *out);
// Records a failure for each result that is wrong.
void trial_check(const struct configuration *configuration, const struct trial_params *params,
                 const struct trial *trial);

#endif
