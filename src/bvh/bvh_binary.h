// The binary tree from which the wide tree is made. Private to this folder.
#ifndef LAMPYRIS_BVH_BVH_BINARY_H
#define LAMPYRIS_BVH_BVH_BINARY_H

#include "bvh/bvh.h"
#include "bvh/bvh_box.h"

// A primitive for the build: a triangle (its input index), a shape (BVH_LEAF_SHAPE | index) or an
// instance (BVH_LEAF_INSTANCE | index), with its box. The box has no negative zeros, so that minima
// do not depend on the order.
struct bvh_primitive {
    struct bvh_box box;
    uint32_t id;
};

// Nodes are built in depth-first order: the left child follows its parent, and a subtree with room
// for n leaves takes 2n - 1 nodes. So every subtree knows its position beforehand, whichever thread
// builds it. Optimizing moves subtrees without keeping that order; the root stays first.
struct bvh_binary_node {
    struct bvh_box box;
    uint32_t left;  // leaf: the id of its one primitive
    uint32_t right; // 0: a leaf (the root is nobody's child)
};

// Consecutive primitives that become one subtree.
struct bvh_range {
    struct bvh_box box;
    struct bvh_box centroids; // bounds of bvh_centroid()
    uint32_t first, count;
    uint32_t capacity; // places from `first`: count, and more where triangles may be cut in two
    uint32_t node;     // position of its root
    uint32_t depth;    // depth of that root; the tree's root has 0
    uint32_t side;     // the buffer that holds the primitives
};

// Sets the two boxes from range->count primitives, of which `primitives` is the first.
void bvh_range_bound(struct bvh_range *range, const struct bvh_primitive *primitives);

// Two buffers, because partitioning is stable: it copies from one to the other.
struct bvh_spatial_chunk;

struct bvh_splitter {
    struct bvh_primitive *primitives[2];
    struct bvh_chunk *chunks; // BVH_CHUNKS_MAX, for the one range that is split in parallel
    uint32_t depth_limit;     // no leaf is deeper
    enum bvh_split split;
    // For spatial splits:
    const struct bvh_params *geometry;
    struct bvh_spatial_chunk *spatial_chunks;
    double root_area;                // half
    const struct progress *progress; // NULL: nobody listens
};

// Ranges are binned and partitioned in chunks of at least BVH_CHUNK_MIN primitives.
enum { BVH_CHUNKS_MAX = 256, BVH_CHUNK_MIN = 1 << 14 };

size_t bvh_chunk_bytes(void);

// Computes the positions of a range's children, whose boxes and counts are known: each gets as many
// as it has primitives, and its share of the remaining ones.
void bvh_place_children(const struct bvh_range *range, struct bvh_range children[2]);

// Splits a range of at least two primitives; the children are in depth-first order and not empty.
// With threads > 1 only one call at a time, because it uses splitter->chunks and spatial_chunks.
void bvh_split(const struct bvh_splitter *splitter, const struct bvh_range *range, unsigned threads,
               struct bvh_range children[2]);

// Returns whether a range that is large enough for it is split no matter how, because the work is
// to stop: what the parts hold is void then.
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
    struct bvh_primitive *primitives; // count of them, and room for capacity; reordered
    uint32_t count;                   // at least 1
    uint32_t capacity; // room for leaves; more than count only with BVH_SPLIT_SPATIAL
    const struct bvh_params *geometry;
    uint32_t depth_limit; // at least the binary logarithm of count, rounded up
    unsigned threads;     // at least 1
    enum bvh_split split;
    const struct progress *progress;
};

// The progress at the end of each stage.
#define BVH_PROGRESS_BINARY 0.5
#define BVH_PROGRESS_OPTIMIZED 0.9

// Reports a fraction and returns whether to continue; false with an error if not.
bool bvh_checkpoint(const struct progress *progress, double fraction, struct err *err);

// Returns NULL on failure; otherwise 2 * *leaf_count - 1 nodes in the arena.
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

// Lowers the tree's cost, in place. *usable is false when that made it deeper than the later stages
// permit, which only unusual input causes: then the tree must be built again and not optimized.
bool bvh_optimize(const struct bvh_optimize_params *params, bool *usable, struct err *err);

struct bvh_wide_params {
    const struct bvh_binary_node *nodes;
    uint32_t leaf_count; // at least 1
    const struct bvh_method *method;
    bool plain;       // two levels a wide node, instead of what costs least
    unsigned threads; // at least 1
    const struct progress *progress;
};

// Collapses the binary tree into nodes of out->format, node_count and triangle_order, for which the
// caller has set reference_count, and fills in the statistics except build_seconds.
bool bvh_wide_build(const struct bvh_wide_params *params, struct arena *arena, struct bvh *out,
                    struct err *err);

#endif
