// Defines the estimators of direct light that tests compare. They all converge to the same image.
#ifndef LAMPYRIS_CHECK_ESTIMATORS_H
#define LAMPYRIS_CHECK_ESTIMATORS_H

#include "scene/core/settings.h"

enum light_estimator {
    // Next-event estimation and BSDF sampling with the power heuristic; environment images are
    // sampled by luminance.
    ESTIMATOR_MIS,
    ESTIMATOR_NEE,  // only next-event estimation, for lights that can be sampled
    ESTIMATOR_BSDF, // BSDF sampling only
    // Like ESTIMATOR_MIS but with ENVIRONMENT_SAMPLING_COMPENSATED, which is the default.
    ESTIMATOR_COMPENSATED,
    // Like ESTIMATOR_MIS, with light paths as a third strategy: --integrator bidir.
    ESTIMATOR_LIGHT_PATHS,
};

static inline void set_estimator(struct settings *settings, enum light_estimator estimator)
{
    settings->nee = estimator != ESTIMATOR_BSDF;
    bool compensates = estimator == ESTIMATOR_COMPENSATED;
    bool has_light_paths = estimator == ESTIMATOR_LIGHT_PATHS;
    settings->mis =
        estimator == ESTIMATOR_MIS || compensates || has_light_paths ? MIS_POWER : MIS_NONE;
    settings->integrator = has_light_paths ? INTEGRATOR_BIDIR : settings->integrator;
    settings->environment_sampling =
        compensates ? ENVIRONMENT_SAMPLING_COMPENSATED : ENVIRONMENT_SAMPLING_LUMINANCE;
}

#endif
