// Splits a range by a plane that may cut triangles, instead of partitioning its primitives. This
// file is private to this folder.
#ifndef LAMPYRIS_BVH_BVH_SPATIAL_H
#define LAMPYRIS_BVH_BVH_SPATIAL_H

#include "bvh/bvh_binary.h"

struct bvh_spatial_split {
    double cost;          // sum of area times number of references over both sides
    uint32_t axis, first; // first: the first bin on the right
    uint32_t counts[2];
    struct bvh_box boxes[2];
};

size_t bvh_spatial_chunk_bytes(void);

// Finds the cheapest plane at which both sides have fewer references than the range, and together
// no more than its capacity. Returns false if there is none that costs less than `fewer_than`.
bool bvh_spatial_find(const struct bvh_splitter *splitter, const struct bvh_range *range,
                      unsigned threads, double fewer_than, struct bvh_spatial_split *split);

// Splits at the plane and fills in the children except for what bvh_place_children() sets. Returns
// false, with nothing changed, if keeping references whole has left one side empty.
bool bvh_spatial_apply(const struct bvh_splitter *splitter, const struct bvh_range *range,
                       unsigned threads, const struct bvh_spatial_split *split,
                       struct bvh_range children[2]);

#endif
