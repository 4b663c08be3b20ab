// Computes boxes of parts of triangles. This file is private to this folder.
#ifndef LAMPYRIS_BVH_BVH_CLIP_H
#define LAMPYRIS_BVH_BVH_CLIP_H

#include "bvh/bvh.h"

// A triangle to be clipped, and the padding of the boxes of its parts. Ray intersections that are
// computed with a smaller error are still inside the box of a part.
struct bvh_clip {
    double vertices[3][3];
    double pad;
};

struct bvh_clip bvh_clip_for(const float vertices[3][3]);

// Computes the boxes of the two parts inside `box`, below and above a plane, from the edges only.
// This is fast, but the boxes may be larger than necessary if `box` already cuts the triangle.
void bvh_clip_quickly(const struct bvh_clip *clip, const struct bvh_box *box, int axis,
                      double plane, struct bvh_box parts[2]);
// As bvh_clip_quickly(), but the boxes are as small as the parts permit.
void bvh_clip_exactly(const struct bvh_clip *clip, const struct bvh_box *box, int axis,
                      double plane, struct bvh_box parts[2]);

#endif
