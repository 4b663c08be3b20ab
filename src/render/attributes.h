// Computes the layout of the attributes of triangles' corners in device memory: see shared/types.h
// and lib/attributes.glsl.
#ifndef LAMPYRIS_RENDER_ATTRIBUTES_H
#define LAMPYRIS_RENDER_ATTRIBUTES_H

#include "shared/bindings.h"
#include <stdint.h>

// Returns the stride of triangles' attributes in uvec4 words.
static inline uint32_t attribute_words(uint32_t features)
{
    return !!(features & FEATURE_NORMALS) + !!(features & FEATURE_TANGENTS) +
           2u * (!!(features & FEATURE_UV0) + !!(features & FEATURE_UV1) +
                 !!(features & FEATURE_COLORS));
}

#endif
