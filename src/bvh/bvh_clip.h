// Parts of triangles, by their boxes. Private to this folder.
#ifndef LAMPYRIS_BVH_BVH_CLIP_H
#define LAMPYRIS_BVH_BVH_CLIP_H

#include "bvh/bvh.h"

// A triangle that is cut, and how much larger than a part the part's box is. Whoever computes where
// a ray meets the triangle, and is off by less, still finds that place in the box of a part.
struct bvh_clip {
    double vertices[3][3];
    double pad;
};

struct bvh_clip bvh_clip_for(const float vertices[3][3]);

// Boxes of the two parts of what is in `box`, below and above a plane: quickly, from the edges
// alone, which may be more than is needed where `box` is a part already.
void bvh_clip_quickly(const struct bvh_clip *clip, const struct bvh_box *box, int axis,
                      double plane, struct bvh_box parts[2]);
// Cuts into boxes as small as the parts allow.
void bvh_clip_exactly(const struct bvh_clip *clip, const struct bvh_box *box, int axis,
                      double plane, struct bvh_box parts[2]);

#endif
