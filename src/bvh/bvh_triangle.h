// Accesses the caller's primitives. This file is private to this folder.
#ifndef LAMPYRIS_BVH_BVH_TRIANGLE_H
#define LAMPYRIS_BVH_BVH_TRIANGLE_H

#include "bvh/bvh.h"

#include <string.h>

static inline void bvh_triangle_load(const struct bvh_params *params, uint32_t triangle,
                                     float vertices[3][3])
{
    size_t stride = params->triangle_stride > 0 ? params->triangle_stride : sizeof(float[3][3]);
    const char *bytes = (const char *)params->triangle_vertices + triangle * stride;
    memcpy(vertices, bytes, sizeof(float[3][3]));
}

// The sum does not overflow, because each count is below 2^29.
static inline uint32_t bvh_primitive_count(const struct bvh_params *params)
{
    return params->triangle_count + params->shape_count + params->instance_count;
}

#endif
