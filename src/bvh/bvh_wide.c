// Collapses the binary tree into the wide one: optimally for the surface area heuristic, by dynamic
// programming (Ylitie, Karras, Laine 2017, "Efficient incoherent ray traversal on GPUs through
// compressed wide BVHs", section 3.1), or simply two levels into one; then lays it out and writes
// the nodes.
#include "base/parallel.h"
#include "bvh/bvh_binary.h"
#include "bvh/bvh_node.h"

enum {
    WIDTH = 4,
    TOP_MAX = 1024, // maximum number of top nodes, whose subtrees are distributed over threads
};

// The best ways to represent a binary subtree by at most 1, 2 or 3 children of one wide node.
struct choice {
    float cost[WIDTH - 1]; // cost[i - 1]: with at most i children
    // left[i - 2]: the number of children, out of i, for the left subtree; 0: fewer children are
    // better. The entry for i = WIDTH applies where the subtree's root becomes a wide node.
    uint8_t left[WIDTH - 1];
    uint8_t is_leaf : 1;   // if there is only one child, it is a leaf, not a wide node
    uint8_t triangles : 7; // number of triangles if they fit into a leaf; else 0
};

_Static_assert(sizeof(struct choice) == 16, "small, because there are two per triangle");

// A wide node before quantisation.
struct draft {
    uint32_t binary[WIDTH]; // the binary subtrees that are the node's children
    uint32_t child_count;
    uint32_t first_inner;    // the wide index of the node's first inner child; the others follow
    uint32_t first_triangle; // position in triangle_order of the first triangle of the node's
                             // leaves
};

struct collapse {
    const struct bvh_wide_params *params;
    struct choice *choices; // one for each binary node
    struct draft *drafts;   // one for each wide node
    uint32_t draft_count;
    double root_area;
    double node_cost, primitive_cost; // expected costs of a node visit and of a test
    uint32_t max_leaf;
    struct bvh *out;
    uint32_t order_count; // number of triangles laid out so far
    bool is_stopped;      // the layout is incomplete because the work was stopped
};

static bool is_binary_leaf(const struct bvh_binary_node *node)
{
    return node->right == 0;
}

static bool is_triangle(const struct bvh_binary_node *node)
{
    return is_binary_leaf(node) && !(node->left & BVH_LEAF_SHAPE);
}

// --- Choosing -----------------------------------------------------------------------------------

static double extent(const struct bvh_box *box, int axis)
{
    return (double)box->max[axis] - (double)box->min[axis];
}

// Quantisation grows a box by about one grid step, 1/128 of the node's box, along each axis. A box
// is lost in a node, for example in one with an infinite plane, if this growth multiplies its area
// by more than LOST_RATIO. Then the box's own children could not be distinguished if they were
// children of the node.
#define GRID_STEP (1.0 / 128)
#define LOST_RATIO 256

static bool is_lost(const struct bvh_box *node, const struct bvh_box *box)
{
    struct bvh_box grown = *box;
    for (int axis = 0; axis < 3; axis++)
        grown.max[axis] += (float)(GRID_STEP * extent(node, axis));
    return box_half_area(&grown) > LOST_RATIO * box_half_area(box);
}

// Returns the least cost of distributing `children` children over both subtrees, and in *left the
// number for the left one.
static double distribute(const struct collapse *collapse, const struct bvh_binary_node *node,
                         uint32_t children, uint8_t *left)
{
    const struct bvh_binary_node *nodes = collapse->params->nodes;
    const struct choice *l = &collapse->choices[node->left], *r = &collapse->choices[node->right];
    bool left_is_lost = is_lost(&node->box, &nodes[node->left].box);
    bool right_is_lost = is_lost(&node->box, &nodes[node->right].box);
    bool is_one_lost = left_is_lost != right_is_lost;
    uint32_t first = is_one_lost && right_is_lost ? children - 1 : 1;
    uint32_t end = is_one_lost && left_is_lost ? 2 : children;
    double best = INFINITY;
    for (uint32_t i = first; i < end; i++) {
        double cost = (double)l->cost[i - 1] + (double)r->cost[children - i - 1];
        if (cost < best) {
            best = cost;
            *left = (uint8_t)i;
        }
    }
    return best;
}

static uint32_t triangles_of(const struct collapse *collapse, const struct bvh_binary_node *node)
{
    if (is_binary_leaf(node))
        return is_triangle(node);
    uint32_t left = collapse->choices[node->left].triangles;
    uint32_t right = collapse->choices[node->right].triangles;
    return left > 0 && right > 0 && left + right <= collapse->max_leaf ? left + right : 0;
}

static void choose(const struct collapse *collapse, uint32_t index)
{
    const struct bvh_binary_node *node = &collapse->params->nodes[index];
    struct choice *choice = &collapse->choices[index];
    double area = box_half_area(&node->box) / collapse->root_area;
    choice->triangles = triangles_of(collapse, node) & 0x7fu;
    if (is_binary_leaf(node)) {
        choice->is_leaf = true;
        for (uint32_t i = 1; i < WIDTH; i++)
            choice->cost[i - 1] = (float)(area * collapse->primitive_cost);
        return;
    }
    choice->cost[0] = (float)(distribute(collapse, node, WIDTH, &choice->left[WIDTH - 2]) +
                              area * collapse->node_cost);
    double leaf_cost = choice->triangles * area * collapse->primitive_cost;
    if (choice->triangles > 0 && leaf_cost <= (double)choice->cost[0]) {
        choice->cost[0] = (float)leaf_cost;
        choice->is_leaf = true;
    }
    for (uint32_t i = 2; i < WIDTH; i++) {
        choice->cost[i - 1] = (float)distribute(collapse, node, i, &choice->left[i - 2]);
        if (choice->cost[i - 1] > choice->cost[i - 2]) {
            choice->cost[i - 1] = choice->cost[i - 2];
            choice->left[i - 2] = 0;
        }
    }
}

// Merges two levels regardless of the cost: grandchildren become children, and triangles that fit
// into a leaf become one.
static void choose_plainly(const struct collapse *collapse, uint32_t index)
{
    const struct bvh_binary_node *node = &collapse->params->nodes[index];
    struct choice *choice = &collapse->choices[index];
    choice->triangles = triangles_of(collapse, node) & 0x7fu;
    choice->is_leaf = is_binary_leaf(node) || choice->triangles > 0;
    choice->left[0] = choice->is_leaf ? 0 : 1;
    choice->left[WIDTH - 2] = WIDTH / 2;
}

static void choose_node(const struct collapse *collapse, uint32_t index)
{
    if (collapse->params->plain)
        choose_plainly(collapse, index);
    else
        choose(collapse, index);
}

// Computes the choices of a subtree bottom-up. The recursion is as deep as the binary tree, whose
// depth is limited.
static void choose_below(const struct collapse *collapse, uint32_t index)
{
    const struct bvh_binary_node *node = &collapse->params->nodes[index];
    if (!is_binary_leaf(node)) {
        choose_below(collapse, node->left);
        choose_below(collapse, node->right);
    }
    choose_node(collapse, index);
}

// The nodes near the root, in breadth-first order.
struct top {
    const struct collapse *collapse;
    uint32_t nodes[TOP_MAX];
    uint32_t opened, count; // nodes in [opened, count) have children that are not in the list
};

static void choose_subtrees(void *context, size_t begin, size_t end, unsigned thread)
{
    (void)thread;
    const struct top *top = context;
    for (size_t i = begin; i < end && !progress_should_stop(top->collapse->params->progress); i++)
        choose_below(top->collapse, top->nodes[top->opened + i]);
}

// Computes the choices of subtrees below the top in parallel, then those of the top.
static void choose_all(const struct collapse *collapse)
{
    const struct bvh_binary_node *nodes = collapse->params->nodes;
    struct top top = {.collapse = collapse, .nodes = {0}, .count = 1};
    for (; top.opened < top.count && top.count + 2 <= TOP_MAX; top.opened++) {
        const struct bvh_binary_node *node = &nodes[top.nodes[top.opened]];
        if (is_binary_leaf(node))
            continue;
        top.nodes[top.count++] = node->left;
        top.nodes[top.count++] = node->right;
    }
    parallel_for(top.count - top.opened, 1, collapse->params->threads, choose_subtrees, &top);
    for (uint32_t i = top.opened; i-- > 0;)
        choose_node(collapse, top.nodes[i]);
}

// --- Layout -------------------------------------------------------------------------------------

static void gather(const struct collapse *collapse, struct draft *draft, uint32_t index,
                   uint32_t children)
{
    const struct bvh_binary_node *node = &collapse->params->nodes[index];
    const struct choice *choice = &collapse->choices[index];
    while (children > 1 && children < WIDTH && choice->left[children - 2] == 0)
        children--;
    if (children == 1 || is_binary_leaf(node)) {
        draft->binary[draft->child_count++] = index;
        return;
    }
    gather(collapse, draft, node->left, choice->left[children - 2]);
    gather(collapse, draft, node->right, children - choice->left[children - 2]);
}

// Appends the triangles of a leaf to triangle_order.
static void append_triangles(struct collapse *collapse, const struct bvh_binary_node *node)
{
    const struct bvh_binary_node *nodes = collapse->params->nodes;
    if (is_triangle(node)) {
        collapse->out->triangle_order[collapse->order_count++] = node->left;
    } else if (!is_binary_leaf(node)) {
        append_triangles(collapse, &nodes[node->left]);
        append_triangles(collapse, &nodes[node->right]);
    }
}

// Drafts the wide node for a binary subtree and all wide nodes below it. The inner children of a
// node are adjacent, as are the triangles of its leaves, and subtrees follow one another in
// depth-first order. The recursion is at most as deep as the binary tree.
static void lay_out(struct collapse *collapse, uint32_t wide, uint32_t binary)
{
    if (progress_stops_at(collapse->params->progress, wide + 1))
        collapse->is_stopped = true;
    if (collapse->is_stopped)
        return;
    struct draft *draft = &collapse->drafts[wide];
    const struct choice *choice = &collapse->choices[binary];
    if (wide == 0 && choice->is_leaf)
        draft->binary[draft->child_count++] = binary; // only the root may have a single child
    else
        gather(collapse, draft, binary, WIDTH);
    draft->first_inner = collapse->draft_count;
    draft->first_triangle = collapse->order_count;
    for (uint32_t i = 0; i < draft->child_count; i++) {
        if (collapse->choices[draft->binary[i]].is_leaf)
            append_triangles(collapse, &collapse->params->nodes[draft->binary[i]]);
        else
            collapse->draft_count++;
    }
    uint32_t inner = draft->first_inner;
    for (uint32_t i = 0; i < draft->child_count; i++)
        if (!collapse->choices[draft->binary[i]].is_leaf)
            lay_out(collapse, inner++, draft->binary[i]);
}

// --- Writing ------------------------------------------------------------------------------------

// Returns the child word of a leaf, and advances *triangle past the leaf's triangles.
static uint32_t leaf_word(const struct collapse *collapse, uint32_t binary, uint32_t *triangle)
{
    const struct bvh_binary_node *node = &collapse->params->nodes[binary];
    uint32_t first = *triangle, count = collapse->choices[binary].triangles;
    if (count == 0)
        return BVH_LEAF | node->left; // the id includes the flag for a shape or an instance
    *triangle += count;
    return BVH_LEAF | (count - 1) << bvh_leaf_index_bits(collapse->max_leaf) | first;
}

static void write_nodes(void *context, size_t begin, size_t end, unsigned thread)
{
    (void)thread;
    const struct collapse *collapse = context;
    for (size_t n = begin; n < end; n++) {
        const struct draft *draft = &collapse->drafts[n];
        uint32_t *words = bvh_children(collapse->out, (uint32_t)n);
        uint32_t inner = draft->first_inner, triangle = draft->first_triangle;
        struct bvh_box boxes[WIDTH];
        for (uint32_t i = 0; i < WIDTH; i++) {
            words[i] = BVH_EMPTY;
            if (i >= draft->child_count)
                continue;
            uint32_t child = draft->binary[i];
            boxes[i] = collapse->params->nodes[child].box;
            words[i] =
                collapse->choices[child].is_leaf ? leaf_word(collapse, child, &triangle) : inner++;
        }
        bvh_set_boxes(collapse->out, (uint32_t)n, boxes, draft->child_count);
    }
}

// Returns the number of wide nodes for a binary subtree whose root becomes a wide node.
static uint32_t count_nodes(const struct collapse *collapse, uint32_t binary)
{
    struct draft draft = {0};
    uint32_t count = 1;
    gather(collapse, &draft, binary, WIDTH);
    for (uint32_t i = 0; i < draft.child_count; i++)
        if (!collapse->choices[draft.binary[i]].is_leaf)
            count += count_nodes(collapse, draft.binary[i]);
    return count;
}

bool bvh_wide_build(const struct bvh_wide_params *params, struct arena *arena, struct bvh *out,
                    struct err *err)
{
    bool ok = false;
    struct arena scratch = {0};
    size_t binary_count = 2 * (size_t)params->leaf_count - 1;
    struct collapse collapse = {
        .params = params,
        .node_cost = bvh_cost(params->method->traversal_cost),
        .primitive_cost = bvh_cost(params->method->intersection_cost),
        .max_leaf = bvh_max_leaf(params->method),
        .out = out,
        .draft_count = 1,
    };
    double root_area = box_half_area(&params->nodes[0].box);
    collapse.root_area = root_area > 0 ? root_area : 1;
    collapse.choices = ARENA_NEW(&scratch, struct choice, binary_count);
    out->triangle_order = ARENA_NEW(arena, uint32_t, out->reference_count);
    if (!collapse.choices || !out->triangle_order) {
        err_memory(err, "collapsing the BVH", binary_count * sizeof(struct choice));
        goto done;
    }
    choose_all(&collapse);
    if (!bvh_checkpoint(params->progress, BVH_PROGRESS_OPTIMIZED, err))
        goto done;
    out->node_count = collapse.choices[0].is_leaf ? 1 : count_nodes(&collapse, 0);
    collapse.drafts = ARENA_NEW(&scratch, struct draft, out->node_count);
    if (!collapse.drafts) {
        err_memory(err, "collapsing the BVH", out->node_count * sizeof(struct draft));
        goto done;
    }
    lay_out(&collapse, 0, 0);
    if (!bvh_checkpoint(params->progress, BVH_PROGRESS_OPTIMIZED, err))
        goto done;
    if (!bvh_nodes_allocate(arena, out, err))
        goto done;
    parallel_for(out->node_count, 1 << 12, params->threads, write_nodes, &collapse);
    ok = bvh_compute_stats(out, &out->stats, err);
done:
    arena_finish(&scratch);
    return ok;
}
