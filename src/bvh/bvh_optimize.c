// Improving the binary tree by reinsertion: subtrees that cost much where they are move to where
// they cost least (Bittner, Hapala, Havran 2013, "Fast insertion-based optimization of bounding
// volume hierarchies"), with the search of Meister and Bittner 2018, "Parallel reinsertion for
// bounding volume hierarchy optimization", which starts at the old place. Top-down building cannot
// do that: a large triangle among small ones goes down with them and makes all their boxes large.
#include "bvh_binary.h"

#include <stdlib.h>

enum {
    CANDIDATES_OF_NODES = 10, // one in so many nodes is a candidate, each round
    ROUNDS_MAX = 6,
    // Bounds on the time that the worst input takes: nodes that one search may look at, and those
    // that all may look at or refit, as a multiple of the primitives.
    SEARCH_MAX = 100,
    WORK_OF_PRIMITIVES = 32,
    DEPTH_MAX = 128, // of the improved tree: a deeper one is not used
};

// A round that does not lower the cost by this part of it is the last one.
#define ROUND_GAIN_MIN 0.002

struct candidate {
    double waste;
    uint32_t node;
};

struct place {
    uint32_t node; // next to which to insert
    double gain;   // by how much the sum of areas becomes less
};

// A subtree to be searched, and the gain of inserting in it so far: what taking the moving subtree
// out saves, less what the nodes above grow.
struct search_entry {
    double gain;
    uint32_t node;
};

struct optimizer {
    struct bvh_binary_node *nodes; // in any order; the root stays first
    uint32_t *parents;
    struct candidate *candidates;
    struct search_entry stack[SEARCH_MAX + 2];
    uint32_t node_count;
    int64_t work; // that may still be done
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

// Searches the subtree of the entry; `left` is the number of nodes that may still be looked at.
static void search_subtree(struct optimizer *optimizer, const struct bvh_box *moving,
                           struct search_entry entry, uint32_t *left, struct place *best)
{
    double area = box_half_area(moving);
    uint32_t size = 0;
    optimizer->stack[size++] = entry;
    while (size > 0 && *left > 0) {
        entry = optimizer->stack[--size];
        if (entry.gain - area <= best->gain) // the new parent is no smaller than what moves
            continue;
        --*left;
        optimizer->work--;
        const struct bvh_binary_node *node = &optimizer->nodes[entry.node];
        double gain = entry.gain - merged_half_area(&node->box, moving);
        if (gain > best->gain)
            *best = (struct place){entry.node, gain};
        double below = gain + box_half_area(&node->box);
        if (is_inner(node) && below - area > best->gain) {
            optimizer->stack[size++] = (struct search_entry){below, node->right};
            optimizer->stack[size++] = (struct search_entry){below, node->left};
        }
    }
}

// The best place for a subtree whose parent is not the root; gain 0 when none is better.
static struct place find_place(struct optimizer *optimizer, uint32_t index)
{
    const struct bvh_binary_node *nodes = optimizer->nodes;
    const struct bvh_box *moving = &nodes[index].box;
    struct place best = {0, 0};
    uint32_t left = SEARCH_MAX, pivot = optimizer->parents[index];
    double gain = box_half_area(&nodes[pivot].box); // the parent goes
    struct bvh_box rest = nodes[sibling_of(optimizer, index)].box;
    search_subtree(optimizer, moving, (struct search_entry){gain, sibling_of(optimizer, index)},
                   &left, &best);
    while (pivot != 0) {
        uint32_t sibling = sibling_of(optimizer, pivot);
        search_subtree(optimizer, moving, (struct search_entry){gain, sibling}, &left, &best);
        pivot = optimizer->parents[pivot];
        box_add_box(&rest, &nodes[sibling].box); // all that is below the pivot but what moves
        gain += box_half_area(&nodes[pivot].box) - box_half_area(&rest);
    }
    return best;
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

// The parent moves along: its old place goes to the sibling, and it becomes the parent of the
// subtree and the node at the new place.
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

static void swap(struct candidate *a, struct candidate *b)
{
    struct candidate copy = *a;
    *a = *b;
    *b = copy;
}

// Puts the `wanted` first candidates in front (quickselect, Hoare 1961) and sorts them.
static void sort_first(struct candidate *candidates, uint32_t count, uint32_t wanted)
{
    uint32_t begin = 0, end = count;
    while (end - begin > 1) {
        swap(&candidates[begin], &candidates[begin + (end - begin) / 2]); // the pivot
        uint32_t place = begin;
        for (uint32_t i = begin + 1; i < end; i++)
            if (comes_first(&candidates[i], &candidates[begin]))
                swap(&candidates[++place], &candidates[i]);
        swap(&candidates[begin], &candidates[place]);
        if (place == wanted)
            break;
        if (place < wanted)
            begin = place + 1;
        else
            end = place;
    }
    qsort(candidates, wanted, sizeof *candidates, compare_candidates);
}

// Candidates are the subtrees with the largest difference between their parent's area and their
// own, which is what taking them out and putting them in elsewhere gains at most, ancestors aside.
static uint32_t choose_candidates(struct optimizer *optimizer)
{
    uint32_t count = 0, wanted = optimizer->node_count / CANDIDATES_OF_NODES + 1;
    for (uint32_t i = 1; i < optimizer->node_count; i++) {
        uint32_t parent = optimizer->parents[i];
        double waste =
            box_half_area(&optimizer->nodes[parent].box) - box_half_area(&optimizer->nodes[i].box);
        if (parent != 0 && waste > 0)
            optimizer->candidates[count++] = (struct candidate){waste, i};
    }
    wanted = wanted < count ? wanted : count;
    sort_first(optimizer->candidates, count, wanted);
    return wanted;
}

// Returns what all moves together took from the sum of areas.
static double run_round(struct optimizer *optimizer)
{
    double gain = 0;
    uint32_t count = choose_candidates(optimizer);
    for (uint32_t i = 0; i < count && optimizer->work > 0; i++) {
        uint32_t node = optimizer->candidates[i].node;
        if (optimizer->parents[node] == 0) // earlier moves have lifted it
            continue;
        struct place place = find_place(optimizer, node);
        if (place.gain > 0) {
            move(optimizer, node, place.node);
            gain += place.gain;
        }
    }
    return gain;
}

static double sum_of_areas(const struct optimizer *optimizer)
{
    double sum = 0;
    for (uint32_t i = 0; i < optimizer->node_count; i++)
        if (is_inner(&optimizer->nodes[i]))
            sum += box_half_area(&optimizer->nodes[i].box);
    return sum;
}

// --- Whole ---------------------------------------------------------------------------------------

// Later stages recurse on the tree, so its depth is checked without recursion.
static bool is_shallow(const struct bvh_binary_node *nodes)
{
    struct {
        uint32_t node, depth;
    } stack[DEPTH_MAX + 1]; // one sibling a level waits, and the two last
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

bool bvh_optimize(struct bvh_binary_node *nodes, uint32_t leaf_count,
                  const struct progress *progress, bool *usable, struct err *err)
{
    *usable = true;
    bool ok = false;
    struct arena scratch = {0};
    struct optimizer *optimizer = ARENA_NEW(&scratch, struct optimizer, 1);
    uint32_t node_count = 2 * leaf_count - 1;
    uint32_t *parents = ARENA_NEW(&scratch, uint32_t, node_count);
    struct candidate *candidates = ARENA_NEW(&scratch, struct candidate, node_count);
    if (!optimizer || !parents || !candidates) {
        err_memory(err, "optimizing the BVH", node_count * sizeof *candidates);
        goto done;
    }
    optimizer->nodes = nodes;
    optimizer->parents = parents;
    optimizer->candidates = candidates;
    optimizer->node_count = node_count;
    optimizer->work = (int64_t)WORK_OF_PRIMITIVES * leaf_count;
    link_parents(optimizer);
    double cost = sum_of_areas(optimizer), gain = cost;
    for (int round = 0; round < ROUNDS_MAX && gain > ROUND_GAIN_MIN * cost; round++) {
        double part = (double)round / ROUNDS_MAX;
        if (!bvh_checkpoint(
                progress,
                BVH_PROGRESS_BINARY + (BVH_PROGRESS_OPTIMIZED - BVH_PROGRESS_BINARY) * part, err))
            goto done;
        gain = run_round(optimizer);
        cost -= gain;
    }
    *usable = is_shallow(nodes);
    ok = true;
done:
    arena_finish(&scratch);
    return ok;
}
