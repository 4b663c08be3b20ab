// Attributes of triangles' corners on the device; see shared/types.h and lib/attributes.glsl.
#ifndef LAMPYRIS_RENDER_ATTRIBUTES_H
#define LAMPYRIS_RENDER_ATTRIBUTES_H

#include "shared/bindings.h"
#include <stdint.h>

// Returns the number of words of four between the attributes of one triangle and those of the next.
static inline uint32_t attribute_words(uint32_t features)
{
    return !!(features & FEATURE_NORMALS) + !!(features & FEATURE_TANGENTS) +
           2u * (!!(features & FEATURE_UV0) + !!(features & FEATURE_UV1) +
                 !!(features & FEATURE_COLORS));
}

#endif
