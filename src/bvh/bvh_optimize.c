// Improves the binary tree by reinsertion: subtrees are moved from places where they cost much to
// where they cost least (Bittner, Hapala, Havran 2013, "Fast insertion-based optimization of
// bounding volume hierarchies"), with the search of Meister and Bittner 2018, "Parallel reinsertion
// for bounding volume hierarchy optimization", which starts at the old place. This mends a flaw of
// top-down building: a large triangle among small ones is put far down with them and makes all
// boxes above it large.
//
// The best places for a batch of subtrees are searched at the same time, on all threads; then the
// moves that still lower the cost are made one after the other. The result does not depend on the
// number of threads.
#include "base/parallel.h"
#include "bvh/bvh_binary.h"

#include <stdlib.h>
#include <string.h>

enum {
    SEARCH_MAX = 1000, // maximum number of nodes that a search may visit
    BATCH = 4096,      // number of searches before the tree is changed
    SEARCH_GRAIN = 64, // number of searches that a thread takes at once
    DEPTH_MAX = 128,   // maximum depth of the result; a deeper tree is not used
    WASTE_SHIFT = 47,  // keeps five bits of the mantissa
    WASTE_BINS = 1 << (63 - WASTE_SHIFT),
};

// The limits of the optimization.
struct effort {
    uint32_t candidates_of; // each round has one candidate per this many nodes
    uint32_t rounds_max;
    // Bounds on the time in the worst case: the number of nodes that one search may visit, and the
    // number that all searches and refits may visit, as a multiple of the number of leaves.
    uint32_t search_max, work_of_leaves;
    double gain_min; // rounds end when a round lowers the cost by less than this fraction
};

static const struct effort normal_effort = {10, 6, 100, 32, 0.002};
static const struct effort long_effort = {2, 100, SEARCH_MAX, 1u << 15, 1e-5};

struct candidate {
    double waste;
    uint32_t node;
};

struct place {
    uint32_t node; // the subtree becomes the sibling of this node
    double gain;   // decrease of the sum of surface areas
};

// The result of a search, and the number of nodes that it has visited.
struct search {
    struct place place;
    uint32_t looked_at;
};

// A subtree in which to search, and the gain so far of inserting the moving subtree there: the
// savings from removing the moving subtree minus the growth of the nodes above.
struct search_entry {
    double gain;
    uint32_t node;
};

struct optimizer {
    const struct bvh_optimize_params *params;
    struct effort effort;
    struct bvh_binary_node *nodes; // in any order; the root stays first
    uint32_t *parents;
    struct candidate *candidates;
    uint32_t *histogram;              // histogram of waste_of()
    struct search *searches;          // BATCH entries
    const struct candidate *searched; // first candidate of the current batch
    uint32_t node_count;
    int64_t work; // remaining number of node visits; see work_of_leaves
};

static double merged_half_area(const struct bvh_box *a, const struct bvh_box *b)
{
    struct bvh_box merged = *a;
    box_add_box(&merged, b);
    return box_half_area(&merged);
}

static bool is_inner(const struct bvh_binary_node *node)
{
    return node->right != 0;
}

static uint32_t sibling_of(const struct optimizer *optimizer, uint32_t node)
{
    const struct bvh_binary_node *parent = &optimizer->nodes[optimizer->parents[node]];
    return parent->left == node ? parent->right : parent->left;
}

// --- Searching ----------------------------------------------------------------------------------

static void search_subtree(const struct optimizer *optimizer, const struct bvh_box *moving,
                           struct search_entry entry, struct search *search)
{
    struct search_entry stack[SEARCH_MAX + 2];
    struct place *best = &search->place;
    double area = box_half_area(moving);
    uint32_t size = 0;
    stack[size++] = entry;
    while (size > 0 && search->looked_at < optimizer->effort.search_max) {
        entry = stack[--size];
        if (entry.gain - area <= best->gain) // the new parent is at least as large
            continue;
        search->looked_at++;
        const struct bvh_binary_node *node = &optimizer->nodes[entry.node];
        double gain = entry.gain - merged_half_area(&node->box, moving);
        if (gain > best->gain)
            *best = (struct place){entry.node, gain};
        double below = gain + box_half_area(&node->box);
        if (is_inner(node) && below - area > best->gain) {
            stack[size++] = (struct search_entry){below, node->right};
            stack[size++] = (struct search_entry){below, node->left};
        }
    }
}

// Finds the best position for a subtree whose parent is not the root. The gain is 0 if no position
// is better.
static struct search find_place(const struct optimizer *optimizer, uint32_t index)
{
    const struct bvh_binary_node *nodes = optimizer->nodes;
    const struct bvh_box *moving = &nodes[index].box;
    struct search search = {{0, 0}, 0};
    uint32_t pivot = optimizer->parents[index];
    double gain = box_half_area(&nodes[pivot].box); // the parent is removed
    struct bvh_box rest = nodes[sibling_of(optimizer, index)].box;
    search_subtree(optimizer, moving, (struct search_entry){gain, sibling_of(optimizer, index)},
                   &search);
    while (pivot != 0) {
        uint32_t sibling = sibling_of(optimizer, pivot);
        search_subtree(optimizer, moving, (struct search_entry){gain, sibling}, &search);
        pivot = optimizer->parents[pivot];
        box_add_box(&rest, &nodes[sibling].box); // `rest` bounds all nodes below the pivot except
                                                 // the moving subtree
        gain += box_half_area(&nodes[pivot].box) - box_half_area(&rest);
    }
    return search;
}

static void run_searches(void *context, size_t begin, size_t end, unsigned thread)
{
    (void)thread;
    const struct optimizer *optimizer = context;
    for (size_t i = begin; i < end; i++) {
        uint32_t node = optimizer->searched[i].node;
        optimizer->searches[i] = (struct search){{0, 0}, 0};
        if (optimizer->parents[node] != 0) // an earlier move may have made it a child of the root
            optimizer->searches[i] = find_place(optimizer, node);
    }
}

static uint32_t depth_of(const struct optimizer *optimizer, uint32_t node)
{
    uint32_t depth = 0;
    for (; node != 0; node = optimizer->parents[node])
        depth++;
    return depth;
}

// Returns the lowest common ancestor, which may be one of the two nodes.
static uint32_t common_ancestor(const struct optimizer *optimizer, uint32_t a, uint32_t b)
{
    uint32_t depth_a = depth_of(optimizer, a), depth_b = depth_of(optimizer, b);
    for (; depth_a > depth_b; depth_a--)
        a = optimizer->parents[a];
    for (; depth_b > depth_a; depth_b--)
        b = optimizer->parents[b];
    while (a != b) {
        a = optimizer->parents[a];
        b = optimizer->parents[b];
    }
    return a;
}

// Returns the gain of a move in the current tree; 0 if the move is no longer valid. Nodes above
// both positions keep their boxes.
static double gain_of_move(const struct optimizer *optimizer, uint32_t index, uint32_t target)
{
    const struct bvh_binary_node *nodes = optimizer->nodes;
    const struct bvh_box *moving = &nodes[index].box;
    const uint32_t *parents = optimizer->parents;
    uint32_t from = parents[index], above = common_ancestor(optimizer, from, target);
    if (from == 0 || above == target || target == index)
        return 0;
    double gain = box_half_area(&nodes[from].box) - merged_half_area(&nodes[target].box, moving);
    for (uint32_t n = parents[target]; n != above; n = parents[n]) {
        if (n == index)
            return 0;
        gain -= merged_half_area(&nodes[n].box, moving) - box_half_area(&nodes[n].box);
    }
    struct bvh_box rest = nodes[sibling_of(optimizer, index)].box;
    for (uint32_t n = from; n != above && parents[n] != above; n = parents[n]) {
        box_add_box(&rest, &nodes[sibling_of(optimizer, n)].box);
        gain += box_half_area(&nodes[parents[n]].box) - box_half_area(&rest);
    }
    return gain;
}

// --- Moving -------------------------------------------------------------------------------------

static void replace_child(struct optimizer *optimizer, uint32_t parent, uint32_t from, uint32_t to)
{
    struct bvh_binary_node *node = &optimizer->nodes[parent];
    if (node->left == from)
        node->left = to;
    else
        node->right = to;
    optimizer->parents[to] = parent;
}

static void refit_upwards(struct optimizer *optimizer, uint32_t index)
{
    for (;; index = optimizer->parents[index]) {
        struct bvh_binary_node *node = &optimizer->nodes[index];
        node->box = optimizer->nodes[node->left].box;
        box_add_box(&node->box, &optimizer->nodes[node->right].box);
        optimizer->work--;
        if (index == 0)
            return;
    }
}

// Moves a subtree next to `target`. Its parent moves along: the sibling takes the parent's old
// position, and the parent becomes the parent of the subtree and of `target`.
static void move(struct optimizer *optimizer, uint32_t index, uint32_t target)
{
    uint32_t parent = optimizer->parents[index], grandparent = optimizer->parents[parent];
    replace_child(optimizer, grandparent, parent, sibling_of(optimizer, index));
    replace_child(optimizer, optimizer->parents[target], target, parent);
    optimizer->nodes[parent].left = target;
    optimizer->nodes[parent].right = index;
    optimizer->parents[target] = optimizer->parents[index] = parent;
    refit_upwards(optimizer, parent);
    refit_upwards(optimizer, grandparent);
}

// --- Rounds -------------------------------------------------------------------------------------

static bool comes_first(const struct candidate *a, const struct candidate *b)
{
    return a->waste > b->waste || (a->waste == b->waste && a->node < b->node);
}

static int compare_candidates(const void *a, const void *b)
{
    return comes_first(a, b) ? -1 : 1;
}

// Returns a histogram bin. Bins are 1/32 of an octave wide, because they are the high bits of
// non-negative doubles, which have the order of the numbers.
static uint32_t waste_bin(double waste)
{
    uint64_t bits;
    memcpy(&bits, &waste, sizeof bits);
    return (uint32_t)(bits >> WASTE_SHIFT);
}

// Returns the difference between the area of a node's parent and the node's own; 0 if the node
// cannot move.
static double waste_of(const struct optimizer *optimizer, uint32_t node)
{
    uint32_t parent = optimizer->parents[node];
    return parent == 0 ? 0
                       : box_half_area(&optimizer->nodes[parent].box) -
                             box_half_area(&optimizer->nodes[node].box);
}

static uint32_t candidates_max(const struct effort *effort, uint32_t node_count)
{
    return node_count / effort->candidates_of + 1;
}

// Chooses the nodes with the largest waste, which is the upper bound of the gain of a move, apart
// from the shrinking of ancestors. If the last bin has more nodes than are wanted, those with the
// lowest indices are chosen.
static uint32_t choose_candidates(struct optimizer *optimizer)
{
    uint32_t wanted = candidates_max(&optimizer->effort, optimizer->node_count), count = 0;
    memset(optimizer->histogram, 0, WASTE_BINS * sizeof *optimizer->histogram);
    for (uint32_t i = 1; i < optimizer->node_count; i++) {
        double waste = waste_of(optimizer, i);
        if (waste > 0)
            optimizer->histogram[waste_bin(waste)]++;
    }
    uint32_t last = WASTE_BINS, above = 0; // the bin that is taken in part; the number of nodes in
                                           // higher bins
    while (last > 0 && above + optimizer->histogram[last - 1] <= wanted)
        above += optimizer->histogram[--last];
    uint32_t in_part = wanted - above;
    for (uint32_t i = 1; i < optimizer->node_count; i++) {
        double waste = waste_of(optimizer, i);
        if (!(waste > 0) || waste_bin(waste) + 1 < last)
            continue;
        if (waste_bin(waste) + 1 == last) {
            if (in_part == 0)
                continue;
            in_part--;
        }
        optimizer->candidates[count++] = (struct candidate){waste, i};
    }
    qsort(optimizer->candidates, count, sizeof *optimizer->candidates, compare_candidates);
    return count;
}

// Makes those moves of the batch that lower the cost. Returns the decrease of the sum of areas.
static double run_batch(struct optimizer *optimizer, const struct candidate *batch, uint32_t count)
{
    double sum = 0;
    optimizer->searched = batch;
    parallel_for(count, SEARCH_GRAIN, optimizer->params->threads, run_searches, optimizer);
    for (uint32_t i = 0; i < count; i++) {
        const struct search *search = &optimizer->searches[i];
        optimizer->work -= search->looked_at;
        if (!(search->place.gain > 0))
            continue;
        double gain = gain_of_move(optimizer, batch[i].node, search->place.node);
        if (gain > 0) {
            move(optimizer, batch[i].node, search->place.node);
            sum += gain;
        }
    }
    return sum;
}

// Reports progress. With BVH_OPTIMIZE_LONG the number of rounds is not known in advance, so each
// round reports a part of the remaining fraction.
static bool report(const struct optimizer *optimizer, double rounds, struct err *err)
{
    double part = optimizer->params->effort == BVH_OPTIMIZE_LONG
                      ? 1 - pow(0.9, rounds)
                      : rounds / optimizer->effort.rounds_max;
    return bvh_checkpoint(
        optimizer->params->progress,
        BVH_PROGRESS_BINARY + (BVH_PROGRESS_OPTIMIZED - BVH_PROGRESS_BINARY) * part, err);
}

// Runs one round. *gain is the decrease of the sum of areas by all its moves.
static bool run_round(struct optimizer *optimizer, uint32_t round, double *gain, struct err *err)
{
    *gain = 0;
    uint32_t count = choose_candidates(optimizer);
    for (uint32_t i = 0; i < count && optimizer->work > 0; i += BATCH) {
        if (!report(optimizer, round + (double)i / count, err))
            return false;
        *gain +=
            run_batch(optimizer, &optimizer->candidates[i], count - i < BATCH ? count - i : BATCH);
    }
    return true;
}

static double sum_of_areas(const struct optimizer *optimizer)
{
    double sum = 0;
    for (uint32_t i = 0; i < optimizer->node_count; i++)
        if (is_inner(&optimizer->nodes[i]))
            sum += box_half_area(&optimizer->nodes[i].box);
    return sum;
}

// --- The whole optimization ----------------------------------------------------------------------

// Checks the depth of the tree without recursion, because later stages recurse on the tree.
static bool is_shallow(const struct bvh_binary_node *nodes)
{
    struct {
        uint32_t node, depth;
    } stack[DEPTH_MAX + 1]; // one waiting sibling per level, and the last two nodes
    uint32_t size = 1;
    stack[0].node = stack[0].depth = 0;
    while (size > 0) {
        uint32_t depth = stack[--size].depth;
        const struct bvh_binary_node *node = &nodes[stack[size].node];
        if (!is_inner(node))
            continue;
        if (depth == DEPTH_MAX)
            return false;
        stack[size].node = node->right;
        stack[size++].depth = depth + 1;
        stack[size].node = node->left;
        stack[size++].depth = depth + 1;
    }
    return true;
}

static void link_parents(struct optimizer *optimizer)
{
    for (uint32_t i = 0; i < optimizer->node_count; i++) {
        if (is_inner(&optimizer->nodes[i])) {
            optimizer->parents[optimizer->nodes[i].left] = i;
            optimizer->parents[optimizer->nodes[i].right] = i;
        }
    }
}

bool bvh_optimize(const struct bvh_optimize_params *params, bool *usable, struct err *err)
{
    *usable = true;
    bool ok = false;
    struct arena scratch = {0};
    uint32_t node_count = 2 * params->leaf_count - 1;
    struct optimizer optimizer = {
        .params = params,
        .effort = params->effort == BVH_OPTIMIZE_LONG ? long_effort : normal_effort,
        .nodes = params->nodes,
        .node_count = node_count,
        .parents = ARENA_NEW(&scratch, uint32_t, node_count),
        .histogram = ARENA_NEW(&scratch, uint32_t, WASTE_BINS),
        .searches = ARENA_NEW(&scratch, struct search, BATCH),
    };
    optimizer.candidates =
        ARENA_NEW(&scratch, struct candidate, candidates_max(&optimizer.effort, node_count));
    if (!optimizer.parents || !optimizer.histogram || !optimizer.candidates ||
        !optimizer.searches) {
        err_memory(err, "optimizing the BVH", node_count * sizeof *optimizer.parents);
        goto done;
    }
    optimizer.work = (int64_t)optimizer.effort.work_of_leaves * params->leaf_count;
    link_parents(&optimizer);
    double cost = sum_of_areas(&optimizer), gain = cost;
    for (uint32_t round = 0;
         round < optimizer.effort.rounds_max && gain > optimizer.effort.gain_min * cost; round++) {
        if (!run_round(&optimizer, round, &gain, err))
            goto done;
        cost -= gain;
    }
    *usable = is_shallow(params->nodes);
    ok = true;
done:
    arena_finish(&scratch);
    return ok;
}
