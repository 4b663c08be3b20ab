// What bsdf.comp can run, and what it says of a sample: read by C and by GLSL.
#ifndef LAMPYRIS_TESTS_BSDF_ITEM_H
#define LAMPYRIS_TESTS_BSDF_ITEM_H

#include "routines.h" // CONSTANT_ROUTINE

#define BSDF_ROUTINE_SAMPLE 0u
#define BSDF_ROUTINE_EVAL 1u
#define BSDF_ROUTINE_MICROFACET 2u
#define BSDF_ROUTINE_FRESNEL 3u
#define BSDF_ROUTINES 4

#define BSDF_VALID 1u
#define BSDF_SPECULAR 2u
#define BSDF_TRANSMITTED 4u

#endif
