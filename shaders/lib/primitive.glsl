// Decodes primitive words and leaf words.
#ifndef PRIMITIVE_GLSL
#define PRIMITIVE_GLSL

#include "lib/constants.glsl"
#include "shared/types.h"

// True if a primitive's word, or the word of a leaf that is not an instance, refers to a shape
// instead of triangles. The tests in this file are macros, so that constant arguments give constant
// results.
#define IS_SHAPE(word)                                                                             \
    (HAS_GEOMETRY(GEOMETRY_SHAPES) &&                                                              \
     (HAS(FEATURE_TRIANGLES) ? ((word)&PRIMITIVE_SHAPE) != 0u : true))

// True if a shape has this kind; false if the scene has no shapes of the kind.
#define IS_KIND(kind, which)                                                                       \
    (HAS_GEOMETRY(SHAPE_KIND_BIT(which)) && (kind) == (which))

// True if a word on the stack changes the space of the ray: a leaf that is an instance, or the
// marker after which the traversal of an instance returns to world space.
#define IS_INSTANCE_LEAF(word)                                                                     \
    (HAS_GEOMETRY(GEOMETRY_INSTANCES) && ((word)&BVH_LEAF_INSTANCE) == BVH_LEAF_INSTANCE)

#endif
