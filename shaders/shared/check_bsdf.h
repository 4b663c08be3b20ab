// Numbers the routines of check_bsdf.comp, and defines flags in its output for a sample, for C and
// GLSL.
#ifndef SHARED_CHECK_BSDF_H
#define SHARED_CHECK_BSDF_H

#include "shared/bindings.h"
#include "shared/check.h"

#define BSDF_ROUTINE_SAMPLE 0u
#define BSDF_ROUTINE_EVAL 1u
#define BSDF_ROUTINE_MICROFACET 2u
#define BSDF_ROUTINE_FRESNEL 3u
#define BSDF_ROUTINES 4

#define BSDF_VALID 1u
#define BSDF_SPECULAR 2u
#define BSDF_TRANSMITTED 4u

#endif
