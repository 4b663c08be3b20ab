// Signed distance fields: evaluates programs of shared/sdf.h.
#ifndef SDF_GLSL
#define SDF_GLSL

#include "lib/buffers.glsl"
#include "lib/primitive.glsl"
#include "shared/sdf.h"

#endif
