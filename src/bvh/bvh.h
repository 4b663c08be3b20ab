// Builds bounding volume hierarchies from boxes and arrays of triangles: a binary tree, built with
// the binned surface area heuristic (SAH) on all CPU threads, is collapsed into a BVH4 with
// quantised nodes of 64 bytes. For comparison there are simpler builders, and a node of 128 bytes
// with boxes in single precision. Vulkan is not used. Any thread may call these functions; a
// finished BVH is read-only and may be shared.
#ifndef LAMPYRIS_BVH_BVH_H
#define LAMPYRIS_BVH_BVH_H

#include "base/arena.h"
#include "base/err.h"
#include "base/progress.h"
#include <stdbool.h>
#include <stdint.h>

// Methods of splitting ranges of primitives: by the surface area heuristic; at the median of their
// centroids; at the mean of their centroids; by the heuristic with spatial splits, which cut
// triangles in two; in the middle of the box. See bvh_build().
enum bvh_split {
    BVH_SPLIT_SAH,
    BVH_SPLIT_MEDIAN,
    BVH_SPLIT_MEAN,
    BVH_SPLIT_SPATIAL,
    BVH_SPLIT_MIDDLE
};
// The effort of moving subtrees to better places after the build: for a limited time, not at all,
// or as long as improvements are found. It applies only to BVH_SPLIT_SAH and BVH_SPLIT_SPATIAL.
enum bvh_optimize { BVH_OPTIMIZE_NORMAL, BVH_OPTIMIZE_OFF, BVH_OPTIMIZE_LONG };
// Nodes are of type struct bvh_node or struct bvh_node_float.
enum bvh_format { BVH_QUANTISED, BVH_FLOAT };

#define BVH_LEAF_MAX 8u // maximum number of triangles per leaf
#define BVH_LEAF_USUAL 2u
#define BVH_COST_MIN 1e-3
#define BVH_COST_MAX 1e3

struct bvh_method {
    enum bvh_split split;
    enum bvh_format format;
    enum bvh_optimize optimize;
    uint32_t max_leaf; // triangles per leaf, 1 to BVH_LEAF_MAX; 0: BVH_LEAF_USUAL
    // The relative costs of visiting a wide node and of testing a primitive, from BVH_COST_MIN to
    // BVH_COST_MAX; 0 stands for 1. They decide how binary nodes are collapsed into wide nodes and
    // leaves. They apply only to BVH_SPLIT_SAH and BVH_SPLIT_SPATIAL.
    double traversal_cost, intersection_cost;
};

// A BVH4 node, one cache line. Child i's box is, in exact arithmetic,
//   [origin + lo * scale, origin + hi * scale] per axis,  scale = 2^(exponent - 127),
// and contains the child's true box (rounded outwards). Child i's byte is in bits 8i to 8i + 7 of
// the words lo[axis] and hi[axis].
struct bvh_node {
    float origin[3];
    uint32_t exponents; // bits 0-7 x, 8-15 y, 16-23 z: biased like an IEEE exponent, in [1, 254]
    uint32_t child[4];  // see BVH_LEAF, BVH_EMPTY; empty ones come last, with lo 255 and hi 0
    uint32_t lo[3];
    uint32_t hi[3];
    uint32_t spare[2]; // always 0
};
_Static_assert(sizeof(struct bvh_node) == 64, "one cache line");

// A wide node with the children's boxes in single precision, indexed [axis][child]. Boxes of empty
// children are 0.
struct bvh_node_float {
    uint32_t child[4];
    float min[3][4], max[3][4];
    uint32_t spare[4]; // always 0; pads the node to two cache lines
};
_Static_assert(sizeof(struct bvh_node_float) == 128, "two cache lines");

// Child words. The word of an inner child is the index of its node (below 2^31). The word of a leaf
// is BVH_LEAF | flags | index. The triangles of a leaf are consecutive entries of triangle_order;
// the index is that of the first entry, and the bits above the index have the number of entries
// minus one (bvh_leaf_index_bits). A leaf may instead have one shape or one instance; the index is
// then that of the shape or instance.
#define BVH_LEAF 0x80000000u
#define BVH_LEAF_SHAPE 0x40000000u                       // one analytic shape instead of triangles
#define BVH_LEAF_INSTANCE (BVH_LEAF_SHAPE | 0x20000000u) // one instance instead of triangles
#define BVH_LEAF_INDEX 0x1fffffffu
#define BVH_EMPTY 0xffffffffu
#define BVH_INSTANCES_MAX                                                                          \
    0x1ffffff0u // maximum number of instances; up to it no leaf word equals BVH_EMPTY or a stack
                // marker

// The maximum number of references that spatial splits add, as a fraction of the number of
// triangles.
#define BVH_DUPLICATES_MAX 0.3

// Upper bound of stack_entries for trees of bvh_build().
#define BVH_STACK_ENTRIES_MAX 96u

struct bvh_box {
    float min[3], max[3];
};

struct bvh_stats {
    // Expected cost of a random ray that hits the root's box and no primitive: 1 for each wide node
    // visited (including the root) and 1 for each primitive tested, whatever costs were used for
    // the build. It is computed with the boxes as stored in the nodes.
    double sah_cost;
    uint32_t depth; // levels of the wide tree; a single root has 1
    // The maximum number of children (inner ones and leaves) that can be pending besides the
    // current one, when a traversal may visit a node's children in any order: the maximum over all
    // orders and rays.
    uint32_t stack_entries;
    uint32_t node_count, leaf_count; // leaf_count: child words that are leaves
    uint64_t bytes;                  // size of nodes and triangle_order
    double build_seconds;            // time to build the hierarchy, or to load it from a cache
    double cached_seconds;           // build time of a hierarchy from a cache; 0: not from a cache
};

struct bvh {
    // nodes[0] is the root; it exists even for an empty scene (all children empty). Every node
    // comes after its parent. The inner children of a node are adjacent, and so are the triangles
    // of its leaves.
    struct bvh_node *nodes;             // for BVH_QUANTISED, else NULL
    struct bvh_node_float *nodes_float; // for BVH_FLOAT, else NULL
    enum bvh_format format;
    uint32_t max_leaf; // as in struct bvh_method; needed to decode leaf words
    uint32_t node_count;
    // Maps leaf order to the input's triangle indices: reference_count entries for triangle_count
    // triangles; the counts differ only after spatial splits. A triangle that was split has an
    // entry in each leaf that has a part of it, and that leaf's box contains only that part.
    uint32_t *triangle_order;
    uint32_t triangle_count, reference_count;
    // The root nodes of all trees after bvh_join(), that of the world (node 0) first; else NULL.
    uint32_t *roots;
    struct bvh_stats stats;
};

struct bvh_params {
    const float (*triangle_vertices)[3][3]; // see triangle_stride
    size_t triangle_stride;                 // bytes from one triangle to the next; 0: 36
    uint32_t triangle_count;
    const struct bvh_box *shape_boxes; // boxes of analytic shapes; may be larger than necessary
    uint32_t shape_count;
    const struct bvh_box *instance_boxes; // boxes of instances, whose leaves lead to another tree
    uint32_t instance_count;
    struct bvh_method method;
    unsigned threads;                // number of threads; 0: one for each processor
    const struct progress *progress; // shows the phase "Building BVH"
};

// Builds a tree top-down, until every leaf of the binary tree has one primitive. The methods are:
// - SAH: splits by the surface area heuristic; then moves subtrees to better places and collapses
//   the tree into wide nodes at the least expected cost;
// - median: halves the primitives by their centroids along the widest axis of the centroids'
//   bounds;
// - mean: splits at the mean of the centroids on that axis, or at the median if rounding leaves one
//   side empty;
// - spatial: as SAH, but where the children's boxes overlap much, may cut a range by a plane
//   instead; triangles that cross the plane then go to both sides;
// - middle: splits at the middle of the box along its widest axis, by the centroids, or at the
//   median if that leaves one side empty.
// Median, mean and middle are for comparison: two levels of their binary trees make one wide node,
// a subtree becomes a leaf as soon as its triangles fit into one, and no subtrees are moved.
//
// The same input gives the same bits for any number of threads. The depth is bounded, even for a
// million identical triangles (a median split is used where SAH cannot separate them):
// stack_entries <= BVH_STACK_ENTRIES_MAX. Vertices must be finite (ERR_BUG otherwise). There may be
// at most bvh_leaf_index_max() triangles (ERR_INPUT above that), BVH_LEAF_INDEX shapes and
// BVH_INSTANCES_MAX instances (ERR_BUG above these). The result lives in `arena`; scratch memory is
// released before returning. The calling thread reports progress; a requested stop is an error
// (ERR_STOPPED).
bool bvh_build(const struct bvh_params *params, struct arena *arena, struct bvh *out,
               struct err *err);

struct bvh_join_params {
    const struct bvh *world; // must be built with instance_boxes
    const struct bvh *trees; // must have the same format and max_leaf
    uint32_t tree_count;
    const uint32_t *instance_tree; // for each instance, the tree to which its leaf leads
};

// Joins trees into one array of nodes: the world's nodes, then those of the other trees, with
// indices adjusted; triangles are joined in the same order. The input is copied; the result lives
// in `arena`. The statistics describe rays in the world: the leaf of an instance costs 1 plus the
// cost of its tree; stack_entries includes both levels and a marker between them, and so may exceed
// BVH_STACK_ENTRIES_MAX; depth is the sum of the world's depth and that of the deepest tree.
bool bvh_join(const struct bvh_join_params *params, struct arena *arena, struct bvh *out,
              struct err *err);

// Computes at most BVH_CUT_MAX boxes that together contain all primitives of a tree: the boxes of
// nodes near its root. Transforming them one by one and bounding the results gives a tighter box
// than transforming the root's box. Returns the number of boxes.
enum { BVH_CUT_MAX = 16 };
uint32_t bvh_cut(const struct bvh *tree, struct bvh_box out[BVH_CUT_MAX]);

// Returns one of a method's costs, replacing 0 by the default.
static inline double bvh_cost(double cost)
{
    return cost > 0 ? cost : 1;
}

static inline uint32_t bvh_max_leaf(const struct bvh_method *method)
{
    return method->max_leaf > 0 ? method->max_leaf : BVH_LEAF_USUAL;
}

// Returns the number of index bits in a triangle leaf's word, for trees with at most this many
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

// Checks all conditions of this header against the primitives: boxes contain everything below them,
// every primitive appears once, there are no cycles, and the statistics are right (except the
// times). Tests and hierarchies loaded from a cache need it. Fails with ERR_INPUT, naming the
// violated condition.
bool bvh_validate(const struct bvh *bvh, const struct bvh_params *params, struct err *err);

// Visits all primitives in leaves whose boxes the ray crosses, in no particular order: triangles by
// their input index, and instances as BVH_LEAF_INSTANCE | index. A triangle with several references
// may be visited several times. Shapes are omitted.
typedef void (*bvh_visit_fn)(void *context, uint32_t primitive);
void bvh_visit_ray(const struct bvh *bvh, uint32_t root, const double origin[3],
                   const double direction[3], bvh_visit_fn visit, void *context);

#endif
