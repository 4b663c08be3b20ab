// Splitting a range in space instead of by its primitives. Private to this folder.
#ifndef LAMPYRIS_BVH_BVH_SPATIAL_H
#define LAMPYRIS_BVH_BVH_SPATIAL_H

#include "bvh/bvh_binary.h"

struct bvh_spatial_split {
    double cost;          // areas times references, summed over both sides
    uint32_t axis, first; // the first bin on the right
    uint32_t counts[2];
    struct bvh_box boxes[2];
};

size_t bvh_spatial_chunk_bytes(void);

// The cheapest plane at which both sides have fewer references than the range, and both together
// no more than it has room for; false when there is none. `fewer_than` is a bound on the cost.
bool bvh_spatial_find(const struct bvh_splitter *splitter, const struct bvh_range *range,
                      unsigned threads, double fewer_than, struct bvh_spatial_split *split);

// Splits there; fills in all of the children but what follows from counts and capacities. False,
// with nothing done, when putting whole references on one side has left the other one empty.
bool bvh_spatial_apply(const struct bvh_splitter *splitter, const struct bvh_range *range,
                       unsigned threads, const struct bvh_spatial_split *split,
                       struct bvh_range children[2]);

#endif
