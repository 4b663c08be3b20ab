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
// After the build, subtrees are moved to better places: in bounded time, not at all, or until no
// improvement is found. Only for SAH and spatial.
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
    // The costs of visiting a wide node and of testing a primitive, by which binary nodes are
    // collapsed to wide ones and leaves: BVH_COST_MIN to BVH_COST_MAX; 0 stands for 1. Only SAH and
    // spatial use them.
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

// Child words. Inner: the node's index (below 2^31). Leaf: BVH_LEAF | flags | first index. Triangle
// leaves have consecutive entries of triangle_order; their number minus one is stored above the
// bits of the first one's index (bvh_leaf_index_bits). Shape leaves have one shape, by its own
// index.
#define BVH_LEAF 0x80000000u
#define BVH_LEAF_SHAPE 0x40000000u                       // an analytic shape instead of triangles
#define BVH_LEAF_INSTANCE (BVH_LEAF_SHAPE | 0x20000000u) // one instance, by its own index
#define BVH_LEAF_INDEX 0x1fffffffu
#define BVH_EMPTY 0xffffffffu
#define BVH_INSTANCES_MAX 0x1ffffff0u // so that none equals BVH_EMPTY or a mark on a stack

// The greatest number of references that spatial splits add, as a fraction of the triangles.
#define BVH_DUPLICATES_MAX 0.3

// No tree of bvh_build needs more stack entries; see bvh_stats.stack_entries.
#define BVH_STACK_ENTRIES_MAX 96u

struct bvh_box {
    float min[3], max[3];
};

struct bvh_stats {
    // Expected cost of a random ray that hits the root's box and then nothing: 1 for each wide node
    // visited (including the root) and 1 for each primitive tested, whatever costs were used for
    // the build. Computed with the boxes as stored in the nodes.
    double sah_cost;
    uint32_t depth; // depth of the wide tree; a single root has 1
    // The greatest number of children (inner ones and leaves) that can be pending besides the
    // current one, when a traversal continues with any of a node's children and defers the other
    // three: the maximum over all orders and rays.
    uint32_t stack_entries;
    uint32_t node_count, leaf_count; // leaves: child words, of one primitive or more
    uint64_t bytes;                  // bytes of nodes and triangle_order
    double build_seconds;            // time to build it, or to load it from a cache
    double cached_seconds;           // build time of a cached hierarchy; 0: not from a cache
};

struct bvh {
    // nodes[0] is the root; it exists even for an empty scene (all children empty). Every node
    // comes after its parent; the inner children of a node are adjacent, and so are the triangles
    // of its leaves.
    struct bvh_node *nodes;             // BVH_QUANTISED, else NULL
    struct bvh_node_float *nodes_float; // BVH_FLOAT, else NULL
    enum bvh_format format;
    uint32_t max_leaf; // as in the method: needed to decode the words of leaves
    uint32_t node_count;
    // Maps leaf order to the input's triangle indices: reference_count entries for triangle_count
    // triangles, which differ only after spatial splits. A triangle that was split has an entry in
    // each leaf with a part of it, and that leaf's box is the box of the part.
    uint32_t *triangle_order;
    uint32_t triangle_count, reference_count;
    // The root nodes of the world's tree (node 0) and of each other tree, after bvh_join(); else
    // NULL.
    uint32_t *roots;
    struct bvh_stats stats;
};

struct bvh_params {
    const float (*triangle_vertices)[3][3]; // see triangle_stride
    size_t triangle_stride;                 // bytes from one triangle to the next, 0: 36
    uint32_t triangle_count;
    const struct bvh_box *shape_boxes; // boxes of analytic shapes (conservative)
    uint32_t shape_count;
    const struct bvh_box *instance_boxes; // boxes of instances: leaves that lead to another tree
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
    const struct bvh *trees; // with the same format and max_leaf
    uint32_t tree_count;
    const uint32_t *instance_tree; // for each instance: the tree to which its leaf leads
};

// One array of nodes: the world's, then the trees', with children and places counted through. Its
// triangles are the world's, then the trees' ones. Copies; the result lives in `arena`. Statistics
// are those of a ray in the world: instances' leaves cost 1 and then what their trees do,
// stack_entries has room for both levels and a mark between them (so it may exceed
// BVH_STACK_ENTRIES_MAX), depth is the sum of the world's and the deepest tree's.
bool bvh_join(const struct bvh_join_params *params, struct arena *arena, struct bvh *out,
              struct err *err);

// Computes boxes, at most BVH_CUT_MAX, that together contain all primitives of a tree: those of the
// nodes below its top. Transformed one by one they give a tighter box than the root's box does.
enum { BVH_CUT_MAX = 16 };
uint32_t bvh_cut(const struct bvh *tree, struct bvh_box out[BVH_CUT_MAX]);

// Returns one of a method's costs, with its default.
static inline double bvh_cost(double cost)
{
    return cost > 0 ? cost : 1;
}

static inline uint32_t bvh_max_leaf(const struct bvh_method *method)
{
    return method->max_leaf > 0 ? method->max_leaf : BVH_LEAF_USUAL;
}

// Returns the bits of the index in a triangle leaf's word, for trees with this greatest number of
// triangles per leaf.
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

// Returns all nodes of a BVH, one after the other.
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

// Visits everything that a ray may hit, in no order: triangles, by their input index, and
// instances, BVH_LEAF_INSTANCE | index, for all boxes that the ray crosses. A triangle with several
// references may be visited several times. Shapes are omitted.
typedef void (*bvh_visit_fn)(void *context, uint32_t primitive);
void bvh_visit_ray(const struct bvh *bvh, uint32_t root, const double origin[3],
                   const double direction[3], bvh_visit_fn visit, void *context);

#endif
