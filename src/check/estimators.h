// The estimators of direct light that tests compare: all converge to the same image.
#ifndef LAMPYRIS_CHECK_ESTIMATORS_H
#define LAMPYRIS_CHECK_ESTIMATORS_H

#include "scene/core/settings.h"

enum light_estimator {
    // next-event estimation and BSDF sampling, power heuristic; images by their luminance
    ESTIMATOR_MIS,
    ESTIMATOR_NEE,         // next-event estimation only, where a light can be sampled
    ESTIMATOR_BSDF,        // BSDF sampling only
    ESTIMATOR_COMPENSATED, // like ESTIMATOR_MIS, with ENVIRONMENT_SAMPLING_COMPENSATED: the default
};

static inline void set_estimator(struct settings *settings, enum light_estimator estimator)
{
    settings->nee = estimator != ESTIMATOR_BSDF;
    bool compensates = estimator == ESTIMATOR_COMPENSATED;
    settings->mis = estimator == ESTIMATOR_MIS || compensates ? MIS_POWER : MIS_NONE;
    settings->environment_sampling =
        compensates ? ENVIRONMENT_SAMPLING_COMPENSATED : ENVIRONMENT_SAMPLING_LUMINANCE;
}

#endif
