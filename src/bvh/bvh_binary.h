// Builds the binary tree that is collapsed into the wide tree. This file is private to this folder.
#ifndef LAMPYRIS_BVH_BVH_BINARY_H
#define LAMPYRIS_BVH_BVH_BINARY_H

#include "bvh/bvh.h"
#include "bvh/bvh_box.h"

// A primitive of the build: the id of a triangle (its input index), of a shape (BVH_LEAF_SHAPE |
// index) or of an instance (BVH_LEAF_INSTANCE | index), and its box. The box has no negative zeros,
// so that minima do not depend on the order of primitives.
struct bvh_primitive {
    struct bvh_box box;
    uint32_t id;
};

// Nodes are built in depth-first order: the left child follows its parent, and a subtree with room
// for n leaves takes 2n - 1 nodes. The position of every subtree is therefore known in advance,
// whichever thread builds it. bvh_optimize() does not keep that order, but the root stays first.
struct bvh_binary_node {
    struct bvh_box box;
    uint32_t left;  // left child; in a leaf, the id of the leaf's only primitive
    uint32_t right; // right child; 0: this is a leaf (the root is nobody's child)
};

// A range of consecutive primitives that becomes one subtree.
struct bvh_range {
    struct bvh_box box;
    struct bvh_box centroids; // bounds of bvh_centroid()
    uint32_t first, count;
    uint32_t capacity; // room for references; above count where triangles may be cut
    uint32_t node;     // position of the subtree's root
    uint32_t depth;    // depth of the subtree's root; the tree's root has 0
    uint32_t side;     // which of the two buffers holds the primitives
};

// Sets the two boxes of a range from its count primitives, which begin at `primitives`.
void bvh_range_bound(struct bvh_range *range, const struct bvh_primitive *primitives);

// Shared data of a build. There are two buffers because partitioning is stable: it copies from one
// to the other.
struct bvh_spatial_chunk;

struct bvh_splitter {
    struct bvh_primitive *primitives[2];
    struct bvh_chunk *chunks; // BVH_CHUNKS_MAX chunks, for the one range that is split in parallel
    uint32_t depth_limit;     // maximum depth of a leaf
    enum bvh_split split;
    // The following are for spatial splits.
    const struct bvh_params *geometry;
    struct bvh_spatial_chunk *spatial_chunks;
    double root_area;                // half the surface area of the root's box
    const struct progress *progress; // NULL: no progress is reported
};

// Ranges are binned and partitioned in chunks of at least BVH_CHUNK_MIN primitives.
enum { BVH_CHUNKS_MAX = 256, BVH_CHUNK_MIN = 1 << 14 };

size_t bvh_chunk_bytes(void);

// Computes the node positions and capacities of a range's children, whose boxes and counts are
// known: each child has capacity for its primitives and for a share of the remaining references.
void bvh_place_children(const struct bvh_range *range, struct bvh_range children[2]);

// Splits a range of at least two primitives. The children are in depth-first order and not empty.
// Only one call at a time may have threads > 1, because it uses splitter->chunks and
// spatial_chunks.
void bvh_split(const struct bvh_splitter *splitter, const struct bvh_range *range, unsigned threads,
               struct bvh_range children[2]);

// Returns whether to split a range arbitrarily because the work is to stop. The result is true only
// for large ranges; the children are then not usable.
static inline bool bvh_split_stopped(const struct bvh_splitter *splitter,
                                     const struct bvh_range *range)
{
    return range->count > 65536 && progress_should_stop(splitter->progress);
}

// Returns a quarter of min + max, which is half of the centre. The factor keeps the difference of
// two centres finite for every pair of floats.
static inline float bvh_centroid(const struct bvh_box *box, int axis)
{
    return 0.25f * box->min[axis] + 0.25f * box->max[axis];
}

struct bvh_binary_params {
    struct bvh_primitive *primitives; // holds count primitives, with room for capacity; reordered
    uint32_t count;                   // at least 1
    uint32_t capacity; // maximum number of leaves; above count only with BVH_SPLIT_SPATIAL
    const struct bvh_params *geometry;
    uint32_t depth_limit; // at least the binary logarithm of count, rounded up
    unsigned threads;     // at least 1
    enum bvh_split split;
    const struct progress *progress;
};

// The overall progress, in [0, 1], at the end of each stage.
#define BVH_PROGRESS_BINARY 0.5
#define BVH_PROGRESS_OPTIMIZED 0.9

// Reports progress. Returns false with ERR_STOPPED if the work is to stop.
bool bvh_checkpoint(const struct progress *progress, double fraction, struct err *err);

// Builds the tree. Returns 2 * *leaf_count - 1 nodes in the arena, or NULL on failure.
struct bvh_binary_node *bvh_binary_build(const struct bvh_binary_params *params,
                                         struct arena *arena, uint32_t *leaf_count,
                                         struct err *err);

struct bvh_optimize_params {
    struct bvh_binary_node *nodes;
    uint32_t leaf_count;      // at least 1
    enum bvh_optimize effort; // normal or long
    unsigned threads;         // at least 1
    const struct progress *progress;
};

// Lowers the tree's cost, in place. *usable is false when the tree became deeper than later stages
// permit, which only unusual input causes: then the tree must be built again and not optimized.
bool bvh_optimize(const struct bvh_optimize_params *params, bool *usable, struct err *err);

struct bvh_wide_params {
    const struct bvh_binary_node *nodes;
    uint32_t leaf_count; // at least 1
    const struct bvh_method *method;
    bool plain;       // merge two levels into a wide node each time, regardless of cost
    unsigned threads; // at least 1
    const struct progress *progress;
};

// Collapses the binary tree: fills in the nodes of out->format, node_count, triangle_order, and the
// statistics except build_seconds. The caller has set reference_count.
bool bvh_wide_build(const struct bvh_wide_params *params, struct arena *arena, struct bvh *out,
                    struct err *err);

#endif
