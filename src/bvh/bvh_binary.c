// Builds the binary tree: first splits the ranges near the root one after the other, each on all
// threads; then builds the subtrees below them in parallel.
#include "bvh/bvh_binary.h"
#include "base/parallel.h"
#include "bvh/bvh_spatial.h"

#include <stdatomic.h>
#include <stdlib.h>

enum {
    // Subtrees of at most this many primitives are one thread's task, unless the tree is so small
    // that the threads would get too few tasks.
    TASK_MAX = 1 << 15,
    TASK_MIN = 1 << 10,
    TASKS_PER_THREAD = 8,
    TASK_WORTH = 64, // smaller ranges are not worth a task of their own
};

struct binary_builder {
    struct bvh_splitter splitter;
    struct bvh_binary_node *nodes;
    const struct bvh_binary_params *params;
    struct bvh_range *tasks;
    uint32_t task_count, task_size;
    double task_start;           // fraction of all work that was done before the tasks began
    _Atomic uint32_t tasks_done; // number of primitives in finished tasks
    _Atomic bool stopped;
    struct err *err; // why the build was stopped
};

static void write_leaf(const struct binary_builder *builder, const struct bvh_range *range)
{
    const struct bvh_primitive *primitives = builder->splitter.primitives[range->side];
    builder->nodes[range->node] =
        (struct bvh_binary_node){.box = range->box, .left = primitives[range->first].id};
}

// Splits a range of at least two primitives and writes the node above both parts.
static void split_range(const struct binary_builder *builder, const struct bvh_range *range,
                        unsigned threads, struct bvh_range children[2])
{
    bvh_split(&builder->splitter, range, threads, children);
    builder->nodes[range->node] = (struct bvh_binary_node){
        .box = range->box, .left = children[0].node, .right = children[1].node};
}

// Builds a subtree. The recursion is as deep as the tree, whose depth is limited.
static void build_subtree(const struct binary_builder *builder, const struct bvh_range *range)
{
    if (range->count == 1) {
        write_leaf(builder, range);
        return;
    }
    struct bvh_range children[2];
    split_range(builder, range, 1, children);
    build_subtree(builder, &children[0]);
    build_subtree(builder, &children[1]);
}

bool bvh_checkpoint(const struct progress *progress, double fraction, struct err *err)
{
    progress_report(progress, "Building BVH", fraction);
    if (progress_should_stop(progress))
        return err_set(err, ERR_STOPPED, "building the BVH was stopped");
    return true;
}

// Reports progress and polls for a stop. Only the thread that called bvh_build() may call this.
static void checkpoint(struct binary_builder *builder, double fraction)
{
    if (!bvh_checkpoint(builder->params->progress, BVH_PROGRESS_BINARY * fraction, builder->err))
        atomic_store(&builder->stopped, true);
}

static void run_task(void *context, size_t begin, size_t end, unsigned thread)
{
    struct binary_builder *builder = context;
    for (size_t i = begin; i < end; i++) {
        if (atomic_load(&builder->stopped))
            return;
        uint32_t count = builder->tasks[i].count;
        build_subtree(builder, &builder->tasks[i]);
        uint32_t done = atomic_fetch_add(&builder->tasks_done, count) + count;
        double part = (double)done / builder->params->count; // above 1 where triangles are cut
        if (thread == 0)
            checkpoint(builder,
                       builder->task_start + (1 - builder->task_start) * (part < 1 ? part : 1));
    }
}

// Sorts tasks by descending size, so that no thread starts a large task after the other threads
// have finished.
static int compare_tasks(const void *a, const void *b)
{
    const struct bvh_range *x = a, *y = b;
    if (x->count != y->count)
        return x->count > y->count ? -1 : 1;
    return x->first < y->first ? -1 : 1;
}

// Splits the ranges above the task size and leaves the others in builder->tasks. The array is also
// the stack: tasks grow from its start, ranges to be split from its end.
static void split_top(struct binary_builder *builder, const struct bvh_range *root,
                      uint32_t capacity)
{
    double levels = 1; // each split costs about as much as one level of its subtree
    for (uint32_t size = root->count; size > 1; size /= 2)
        levels++;
    double all = levels * root->count, done = 0;
    uint32_t stack = capacity;
    builder->tasks[--stack] = *root;
    while (stack < capacity && !atomic_load(&builder->stopped)) {
        struct bvh_range range = builder->tasks[stack++], children[2];
        if (range.count < TASK_WORTH) {
            build_subtree(builder, &range);
            continue;
        }
        if (range.count <= builder->task_size) {
            builder->tasks[builder->task_count++] = range;
            continue;
        }
        split_range(builder, &range, builder->params->threads, children);
        builder->tasks[--stack] = children[1];
        builder->tasks[--stack] = children[0];
        done += range.count;
        builder->task_start = done / all < 1 ? done / all : 1;
        checkpoint(builder, builder->task_start);
    }
}

static struct bvh_range root_range(const struct bvh_binary_params *params)
{
    struct bvh_range root = {.count = params->count, .capacity = params->capacity};
    bvh_range_bound(&root, params->primitives);
    return root;
}

// Removes the gaps between the nodes of a subtree without changing their order; returns the end.
// The recursion is at most as deep as the tree.
static uint32_t compact(struct bvh_binary_node *nodes, uint32_t from, uint32_t to)
{
    struct bvh_binary_node node = nodes[from];
    uint32_t end = to + 1;
    if (node.right != 0) {
        uint32_t left = node.left, right = node.right;
        node.left = end;
        end = compact(nodes, left, end);
        node.right = end;
        end = compact(nodes, right, end);
    }
    nodes[to] = node;
    return end;
}

static uint32_t task_size_for(uint32_t count, unsigned threads)
{
    uint32_t size = count / (TASKS_PER_THREAD * threads);
    return size < TASK_MIN ? TASK_MIN : size > TASK_MAX ? TASK_MAX : size;
}

static bool allocate(struct binary_builder *builder, struct arena *arena, struct arena *scratch,
                     uint32_t task_capacity, struct err *err)
{
    const struct bvh_binary_params *params = builder->params;
    struct bvh_splitter *splitter = &builder->splitter;
    size_t capacity = params->capacity;
    builder->tasks = ARENA_NEW(scratch, struct bvh_range, task_capacity);
    splitter->primitives[0] = params->primitives;
    splitter->primitives[1] = ARENA_NEW(scratch, struct bvh_primitive, capacity);
    splitter->chunks = arena_alloc(scratch, BVH_CHUNKS_MAX, bvh_chunk_bytes());
    splitter->spatial_chunks =
        arena_alloc(scratch, params->split == BVH_SPLIT_SPATIAL ? BVH_CHUNKS_MAX : 0,
                    bvh_spatial_chunk_bytes());
    builder->nodes = ARENA_NEW(arena, struct bvh_binary_node, 2 * capacity - 1);
    if (builder->tasks && splitter->primitives[1] && splitter->chunks && splitter->spatial_chunks &&
        builder->nodes)
        return true;
    return err_memory(err, "the BVH's binary tree",
                      capacity * (2 * sizeof *builder->nodes + sizeof *params->primitives));
}

struct bvh_binary_node *bvh_binary_build(const struct bvh_binary_params *params,
                                         struct arena *arena, uint32_t *leaf_count, struct err *err)
{
    struct bvh_binary_node *nodes = NULL;
    struct arena scratch = {0};
    struct binary_builder builder = {.params = params, .err = err};
    builder.task_size = task_size_for(params->count, params->threads);
    // Tasks are disjoint and have at least TASK_WORTH primitives; the stack has at most one entry
    // per level, plus one.
    uint32_t task_capacity = params->capacity / TASK_WORTH + params->depth_limit + 1;
    if (!allocate(&builder, arena, &scratch, task_capacity, err))
        goto done;
    struct bvh_range root = root_range(params);
    builder.splitter.depth_limit = params->depth_limit;
    builder.splitter.split = params->split;
    builder.splitter.progress = params->progress;
    builder.splitter.geometry = params->geometry;
    builder.splitter.root_area = box_half_area(&root.box);
    split_top(&builder, &root, task_capacity);
    qsort(builder.tasks, builder.task_count, sizeof *builder.tasks, compare_tasks);
    parallel_for(builder.task_count, 1, params->threads, run_task, &builder);
    if (atomic_load(&builder.stopped))
        goto done;
    nodes = builder.nodes;
    *leaf_count =
        params->capacity == params->count ? params->count : (compact(nodes, 0, 0) + 1) / 2;
done:
    arena_finish(&scratch);
    return nodes;
}
