// Reads the attributes of triangles' corners. The features determine the word offsets;
// render/attributes.h computes the same offsets.
#ifndef ATTRIBUTES_GLSL
#define ATTRIBUTES_GLSL

#include "lib/buffers.glsl"

const uint ATTRIBUTE_TANGENTS = HAS(FEATURE_NORMALS) ? 1u : 0u;
const uint ATTRIBUTE_UV0 = ATTRIBUTE_TANGENTS + (HAS(FEATURE_TANGENTS) ? 1u : 0u);
const uint ATTRIBUTE_UV1 = ATTRIBUTE_UV0 + (HAS(FEATURE_UV0) ? 2u : 0u);
const uint ATTRIBUTE_COLORS = ATTRIBUTE_UV1 + (HAS(FEATURE_UV1) ? 2u : 0u);
const uint ATTRIBUTE_WORDS = ATTRIBUTE_COLORS + (HAS(FEATURE_COLORS) ? 2u : 0u);

#endif
