// Numbers the routines of check_sampler.comp, for C and GLSL.
#ifndef SHARED_CHECK_SAMPLER_H
#define SHARED_CHECK_SAMPLER_H

#include "shared/bindings.h"
#include "shared/check.h"

#define SAMPLER_ROUTINE_UNIFORMS 0u
#define SAMPLER_ROUTINE_FILTER 1u
#define SAMPLER_ROUTINE_PIXEL 2u

#endif
