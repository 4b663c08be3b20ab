// Bounding volume hierarchy: binned SAH on all CPU threads, collapsed to a wide, quantised node of
// 64 bytes; simpler builders and a wider node to compare with; and a CPU reference traversal. No
// Vulkan, no scene: boxes and plain arrays in. Any thread may call; a finished BVH is only read and
// may be shared.
#ifndef LAMPYRIS_BVH_BVH_H
#define LAMPYRIS_BVH_BVH_H

#include "base/arena.h"
#include "base/err.h"
#include "base/progress.h"
#include <stdbool.h>
#include <stdint.h>

// How primitives are split: by the binned surface area heuristic, at the median of their centres,
// at the mean, by the heuristic with triangles cut in two where that pays, or in the middle of the
// box; see bvh_build().
enum bvh_split {
    BVH_SPLIT_SAH,
    BVH_SPLIT_MEDIAN,
    BVH_SPLIT_MEAN,
    BVH_SPLIT_SPATIAL,
    BVH_SPLIT_MIDDLE
};
// After the build, subtrees are moved to better places: in bounded time, not at all, or until
// nothing is gained any more. Only SAH and spatial do so.
enum bvh_optimize { BVH_OPTIMIZE_NORMAL, BVH_OPTIMIZE_OFF, BVH_OPTIMIZE_LONG };
// A node is a struct bvh_node or a struct bvh_node_float.
enum bvh_format { BVH_QUANTISED, BVH_FLOAT };

#define BVH_LEAF_MAX 8u // triangles
#define BVH_LEAF_USUAL 2u
#define BVH_COST_MIN 1e-3
#define BVH_COST_MAX 1e3

struct bvh_method {
    enum bvh_split split;
    enum bvh_format format;
    enum bvh_optimize optimize;
    uint32_t max_leaf; // triangles a leaf, 1 to BVH_LEAF_MAX; 0: BVH_LEAF_USUAL
    // The costs of a visit to a wide node and of a test of a primitive, by which binary nodes are
    // put together to wide ones and leaves: BVH_COST_MIN to BVH_COST_MAX; 0 stands for 1. Only SAH
    // and spatial use them.
    double traversal_cost, intersection_cost;
};

// A BVH4 node, one cache line. Child i's box is, in exact arithmetic,
//   [origin + lo * scale, origin + hi * scale] per axis,  scale = 2^(exponent - 127),
// and contains the child's true box (rounded outwards). Bytes of child i stand at bits 8i of the
// words lo[axis], hi[axis].
struct bvh_node {
    float origin[3];
    uint32_t exponents; // bits 0-7 x, 8-15 y, 16-23 z: biased like an IEEE exponent, in [1, 254]
    uint32_t child[4];  // see BVH_*; empty ones come last and have lo 255, hi 0
    uint32_t lo[3];
    uint32_t hi[3];
    uint32_t spare[2]; // 0
};
_Static_assert(sizeof(struct bvh_node) == 64, "one cache line");

// A wide node with the children's boxes in single precision, [axis][child]; boxes of empty children
// are 0.
struct bvh_node_float {
    uint32_t child[4];
    float min[3][4], max[3][4];
    uint32_t spare[4]; // 0: fills the second cache line
};
_Static_assert(sizeof(struct bvh_node_float) == 128, "two cache lines");

// Child words. Inner: the node's index (below 2^31). Leaf: BVH_LEAF | flags | first index.
// Triangle leaves hold consecutive entries of triangle_order, whose number less one stands above
// the bits of the first one's index (bvh_leaf_index_bits); shape leaves hold one shape, by its own
// index.
#define BVH_LEAF 0x80000000u
#define BVH_LEAF_SHAPE 0x40000000u                       // an analytic shape instead of triangles
#define BVH_LEAF_INSTANCE (BVH_LEAF_SHAPE | 0x20000000u) // one instance, by its own index
#define BVH_LEAF_INDEX 0x1fffffffu
#define BVH_EMPTY 0xffffffffu
#define BVH_INSTANCES_MAX 0x1ffffff0u // so that none is BVH_EMPTY, nor a mark on a stack

// Spatial splits add at most so many places, as a part of the triangles.
#define BVH_DUPLICATES_MAX 0.3

// No tree of bvh_build has more pending entries; see bvh_stats.stack_entries.
#define BVH_STACK_ENTRIES_MAX 96u

struct bvh_box {
    float min[3], max[3];
};

struct bvh_stats {
    // Expected cost of a random ray that hits the root's box and then nothing: 1 a wide node
    // visited (the root included), 1 a primitive tested, whatever costs the tree was built by. Of
    // the boxes as they are in the nodes.
    double sah_cost;
    uint32_t depth; // of the wide tree; a root alone has 1
    // The most children (inner ones and leaves) that can be pending besides the one in hand, when
    // a traversal goes on with any of a node's children and puts off the other three: the maximum
    // over all orders and rays.
    uint32_t stack_entries;
    uint32_t node_count, leaf_count; // leaves: child words, of one primitive or more
    uint64_t bytes;                  // of nodes and triangle_order
    double build_seconds;            // of building, or of loading from a cache:
    double cached_seconds;           // what building took then; 0: not from a cache
};

struct bvh {
    // nodes[0] is the root; it exists even for an empty scene (all children empty). Every node
    // stands after its parent, inner children of one node stand together, and so do the triangles
    // of its leaves.
    struct bvh_node *nodes;             // BVH_QUANTISED, else NULL
    struct bvh_node_float *nodes_float; // BVH_FLOAT, else NULL
    enum bvh_format format;
    uint32_t max_leaf; // as in the method: says how words of leaves are read
    uint32_t node_count;
    // Leaf order -> triangle as given: reference_count places for triangle_count triangles, which
    // differ after spatial splits alone. Such a triangle has a place in each leaf that has a part
    // of it, of which that leaf's box is the box.
    uint32_t *triangle_order;
    uint32_t triangle_count, reference_count;
    // The nodes at which the world's tree (node 0) and each of the others begin, after bvh_join();
    // else NULL.
    uint32_t *roots;
    struct bvh_stats stats;
};

struct bvh_params {
    const float (*triangle_vertices)[3][3]; // see triangle_stride
    size_t triangle_stride;                 // bytes from one triangle to the next, 0: 36
    uint32_t triangle_count;
    const struct bvh_box *shape_boxes; // boxes of analytic shapes (conservative)
    uint32_t shape_count;
    const struct bvh_box *instance_boxes; // of instances: leaves that lead to another tree
    uint32_t instance_count;
    struct bvh_method method;
    unsigned threads;                // 0: all
    const struct progress *progress; // phase "Building BVH"
};

// Builds a tree, always from the top, until every leaf has one primitive:
// - SAH: by the surface area heuristic, then moved to better places and collapsed into wide nodes
//   at the least expected cost;
// - median: into halves by the centroids along the widest axis of their bounds;
// - mean: at the mean of the centroids on that axis, or the median where rounding leaves one side
//   empty;
// - spatial: as SAH, but where the children's boxes overlap much a range may be cut by a plane
//   instead, and the triangles there go to both sides;
// - middle: by the centroids in the middle of the box along its widest axis, or at the median where
//   that leaves one side empty.
// Median, mean and middle are to compare with: each two levels of their binary trees make a wide
// node, triangles make leaves as soon as a leaf has room for all of a subtree's, and nothing is
// moved.
//
// The same input gives the same bits whatever the number of threads. Bounded depth also for a
// million identical triangles (median split where SAH cannot separate): stack_entries <= 96.
// Vertices must be finite (ERR_BUG otherwise). Counts up to BVH_LEAF_INDEX; triangles up to
// bvh_leaf_index_max() (ERR_INPUT above it).
// The result lives in `arena`; scratch memory is released before returning. Progress is reported by
// the calling thread; being asked to stop is an error (ERR_STOPPED).
bool bvh_build(const struct bvh_params *params, struct arena *arena, struct bvh *out,
               struct err *err);

struct bvh_join_params {
    const struct bvh *world; // built with instance_boxes
    const struct bvh *trees; // of the same format and max_leaf
    uint32_t tree_count;
    const uint32_t *instance_tree; // of each instance: the tree that its leaf leads to
};

// One array of nodes: the world's, then the trees', with children and places counted through. Its
// triangles are the world's, then the trees' ones. Copies; the result lives in `arena`. Statistics
// are those of a ray in the world: instances' leaves cost 1 and then what their trees do,
// stack_entries has room for both levels and a mark between them (so it may exceed
// BVH_STACK_ENTRIES_MAX), depth is the sum of the world's and the deepest tree's.
bool bvh_join(const struct bvh_join_params *params, struct arena *arena, struct bvh *out,
              struct err *err);

// Boxes, at most BVH_CUT_MAX, that together contain all primitives of a tree: what is below its
// top. Transformed one by one they give a closer box of the whole than the root's box does.
enum { BVH_CUT_MAX = 16 };
uint32_t bvh_cut(const struct bvh *tree, struct bvh_box out[BVH_CUT_MAX]);

// One of a method's costs.
static inline double bvh_cost(double cost)
{
    return cost > 0 ? cost : 1;
}

static inline uint32_t bvh_max_leaf(const struct bvh_method *method)
{
    return method->max_leaf > 0 ? method->max_leaf : BVH_LEAF_USUAL;
}

// Bits of the index in the word of a leaf of triangles, in a tree whose leaves have at most so
// many.
static inline uint32_t bvh_leaf_index_bits(uint32_t max_leaf)
{
    return max_leaf > BVH_LEAF_USUAL ? 27 : 29;
}

static inline uint32_t bvh_leaf_index_max(uint32_t max_leaf)
{
    return (1u << bvh_leaf_index_bits(max_leaf)) - 1;
}

static inline uint64_t bvh_node_bytes(enum bvh_format format)
{
    return format == BVH_FLOAT ? sizeof(struct bvh_node_float) : sizeof(struct bvh_node);
}

// All nodes of a BVH, one after the other.
static inline const void *bvh_nodes_data(const struct bvh *bvh)
{
    return bvh->format == BVH_FLOAT ? (const void *)bvh->nodes_float : bvh->nodes;
}

static inline uint64_t bvh_nodes_bytes(const struct bvh *bvh)
{
    return bvh->node_count * bvh_node_bytes(bvh->format);
}

// Checks every invariant above against the primitives: boxes contain what is below them, every
// primitive appears once, no cycle, statistics right (but the time). For tests and loaded caches;
// ERR_INPUT says what is wrong.
bool bvh_validate(const struct bvh *bvh, const struct bvh_params *params, struct err *err);

// All that a ray may hit from its origin on, in no order: triangles, by their index as given, and
// instances, BVH_LEAF_INSTANCE | index, as far as the ray goes through the boxes that lead to them.
// A triangle with several places may come several times. Shapes are left out.
typedef void (*bvh_visit_fn)(void *context, uint32_t primitive);
void bvh_visit_ray(const struct bvh *bvh, uint32_t root, const double origin[3],
                   const double direction[3], bvh_visit_fn visit, void *context);

#endif
