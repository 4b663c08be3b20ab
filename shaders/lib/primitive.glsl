// The encoding of primitives' and leaves' words.
#ifndef PRIMITIVE_GLSL
#define PRIMITIVE_GLSL

#include "lib/constants.glsl"
#include "shared/types.h"

// True for a primitive's word, or a leaf's that is no instance, that is of a shape and not of
// triangles. A macro, so that what is constant remains one where it is asked.
#define IS_SHAPE(word)                                                                             \
    (HAS_GEOMETRY(GEOMETRY_SHAPES) &&                                                              \
     (HAS(FEATURE_TRIANGLES) ? ((word)&PRIMITIVE_SHAPE) != 0u : true))

// True where a shape's kind, of those that the scene has, is this one.
#define IS_KIND(kind, which)                                                                       \
    (HAS_GEOMETRY(SHAPE_KIND_BIT(which)) && (kind) == (which))

// True for a leaf's word, or for what ends an instance on the stack, that leads to another space.
#define IS_INSTANCE_LEAF(word)                                                                     \
    (HAS_GEOMETRY(GEOMETRY_INSTANCES) && ((word)&BVH_LEAF_INSTANCE) == BVH_LEAF_INSTANCE)

#endif
