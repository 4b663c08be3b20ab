// Routines that sampler.comp can run: read by C and by GLSL.
#ifndef LAMPYRIS_TESTS_SAMPLER_ROUTINES_H
#define LAMPYRIS_TESTS_SAMPLER_ROUTINES_H

#define CONSTANT_ROUTINE CONSTANT_COUNT

#define ROUTINE_UNIFORMS 0u
#define ROUTINE_FILTER 1u
#define ROUTINE_PIXEL 2u

#endif
