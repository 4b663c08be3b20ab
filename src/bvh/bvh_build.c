// Builds a hierarchy in four steps: checks the input, computes the boxes of primitives, builds the
// binary tree, and collapses it into the wide tree.
#include "base/clock.h"
#include "base/memory.h"
#include "base/parallel.h"
#include "bvh/bvh_binary.h"
#include "bvh/bvh_node.h"
#include "bvh/bvh_triangle.h"

#include <stdatomic.h>

// The limits of each attempt to build. The second attempt is for inputs for which the first needs
// too large a stack. The wide tree is at most as deep as the binary one, and each level leaves at
// most 3 children pending, so 32 binary levels stay within BVH_STACK_ENTRIES_MAX for every input;
// they also suffice for 2^32 primitives.
static const struct attempt {
    uint32_t depth_limit;
    bool optimize;
} attempts[] = {{64, true}, {32, false}};

// --- Input --------------------------------------------------------------------------------------

struct gather_job {
    const struct bvh_params *params;
    struct bvh_primitive *primitives;
    _Atomic uint32_t first_bad; // lowest primitive index with an invalid box
};

static bool box_is_valid(const struct bvh_box *box)
{
    for (int axis = 0; axis < 3; axis++)
        if (!isfinite(box->min[axis]) || !isfinite(box->max[axis]) ||
            box->min[axis] > box->max[axis])
            return false;
    return true;
}

static bool triangle_bounds(const struct bvh_params *params, uint32_t triangle, struct bvh_box *box)
{
    float vertices[3][3];
    bvh_triangle_load(params, triangle, vertices);
    *box = box_empty();
    bool finite = true;
    for (int corner = 0; corner < 3; corner++) {
        for (int axis = 0; axis < 3; axis++)
            finite = finite && isfinite(vertices[corner][axis]);
        box_add_point(box, vertices[corner]);
    }
    return finite;
}

static void note_bad(struct gather_job *job, uint32_t primitive)
{
    uint32_t first = atomic_load(&job->first_bad);
    while (primitive < first && !atomic_compare_exchange_weak(&job->first_bad, &first, primitive))
        continue;
}

static void gather_primitives(void *context, size_t begin, size_t end, unsigned thread)
{
    (void)thread;
    struct gather_job *job = context;
    uint32_t triangles = job->params->triangle_count;
    if (progress_should_stop(job->params->progress))
        return; // make_primitives() polls again, and fails
    for (size_t i = begin; i < end; i++) {
        struct bvh_primitive *primitive = &job->primitives[i];
        bool valid;
        if (i < triangles) {
            primitive->id = (uint32_t)i;
            valid = triangle_bounds(job->params, primitive->id, &primitive->box);
        } else {
            uint32_t index = (uint32_t)i - triangles, shapes = job->params->shape_count;
            bool is_shape = index < shapes;
            primitive->id =
                is_shape ? BVH_LEAF_SHAPE | index : BVH_LEAF_INSTANCE | (index - shapes);
            primitive->box = is_shape ? job->params->shape_boxes[index]
                                      : job->params->instance_boxes[index - shapes];
            valid = box_is_valid(&primitive->box);
        }
        if (!valid)
            note_bad(job, (uint32_t)i);
        for (int axis = 0; axis < 3; axis++) { // -0 + 0 is +0
            primitive->box.min[axis] += 0.0f;
            primitive->box.max[axis] += 0.0f;
        }
    }
}

static bool check_cost(const char *name, double cost, struct err *err)
{
    return cost == 0 || (cost >= BVH_COST_MIN && cost <= BVH_COST_MAX) ||
           err_set(err, ERR_BUG, "BVH: %s_cost: %g is outside [%g, %g]", name, cost, BVH_COST_MIN,
                   BVH_COST_MAX);
}

static bool check_method(const struct bvh_method *method, struct err *err)
{
    if (method->max_leaf > BVH_LEAF_MAX)
        return err_set(err, ERR_BUG, "BVH: max_leaf: %u is more than %u", method->max_leaf,
                       BVH_LEAF_MAX);
    return check_cost("traversal", method->traversal_cost, err) &&
           check_cost("intersection", method->intersection_cost, err);
}

// Checks the number of triangles: larger leaves leave fewer bits for a triangle's index.
static bool check_triangle_count(const struct bvh_params *params, struct err *err)
{
    uint32_t most = bvh_leaf_index_max(params->method.max_leaf);
    return params->triangle_count <= most ||
           err_set(err, ERR_INPUT,
                   "%u triangles are too many for leaves of %u (--bvh-leaf); expected at most %u, "
                   "or leaves of %u, which allow %u",
                   params->triangle_count, params->method.max_leaf, most, BVH_LEAF_USUAL,
                   BVH_LEAF_INDEX);
}

static bool check_params(const struct bvh_params *params, struct err *err)
{
    if (params->triangle_count > BVH_LEAF_INDEX || params->shape_count > BVH_LEAF_INDEX ||
        params->instance_count > BVH_INSTANCES_MAX)
        return err_set(err, ERR_BUG,
                       "BVH: %u triangles, %u shapes, %u instances; expected at most %u, %u and %u",
                       params->triangle_count, params->shape_count, params->instance_count,
                       BVH_LEAF_INDEX, BVH_LEAF_INDEX, BVH_INSTANCES_MAX);
    if ((params->triangle_count > 0 && !params->triangle_vertices) ||
        (params->shape_count > 0 && !params->shape_boxes) ||
        (params->instance_count > 0 && !params->instance_boxes))
        return err_set(err, ERR_BUG,
                       "BVH: there are primitives, but their vertices or boxes are missing");
    if (params->triangle_stride != 0 && params->triangle_stride < sizeof(float[3][3]))
        return err_set(err, ERR_BUG, "BVH: triangle_stride: %zu is less than 36",
                       params->triangle_stride);
    return check_method(&params->method, err) && check_triangle_count(params, err);
}

static bool make_primitives(const struct bvh_params *params, unsigned threads,
                            struct bvh_primitive *primitives, struct err *err)
{
    struct gather_job job = {params, primitives, UINT32_MAX};
    parallel_for(bvh_primitive_count(params), 1 << 14, threads, gather_primitives, &job);
    if (!bvh_checkpoint(params->progress, 0, err))
        return false;
    uint32_t bad = atomic_load(&job.first_bad);
    if (bad == UINT32_MAX)
        return true;
    if (bad < params->triangle_count)
        return err_set(err, ERR_BUG, "BVH: triangle %u has a vertex that is not finite", bad);
    bad -= params->triangle_count;
    bool is_shape = bad < params->shape_count;
    return err_set(err, ERR_BUG, "BVH: the box of %s %u is not finite or has min > max",
                   is_shape ? "shape" : "instance", is_shape ? bad : bad - params->shape_count);
}

// --- Trees --------------------------------------------------------------------------------------

static bool build_empty(struct arena *arena, struct bvh *out, struct err *err)
{
    out->node_count = 1;
    out->triangle_order = ARENA_NEW(arena, uint32_t, 0);
    if (!out->triangle_order)
        return err_memory(err, "the BVH's order of triangles", 0);
    if (!bvh_nodes_allocate(arena, out, err))
        return false;
    for (int i = 0; i < 4; i++)
        bvh_children(out, 0)[i] = BVH_EMPTY;
    bvh_set_boxes(out, 0, NULL, 0);
    return bvh_compute_stats(out, &out->stats, err);
}

// Returns the maximum number of leaves: with spatial splits, triangles may be in several.
static uint32_t capacity_for(const struct bvh_params *params, uint32_t count)
{
    if (params->method.split != BVH_SPLIT_SPATIAL)
        return count;
    uint64_t more = (uint64_t)((double)params->triangle_count * BVH_DUPLICATES_MAX);
    uint64_t most = bvh_leaf_index_max(params->method.max_leaf) - params->triangle_count;
    return count + (uint32_t)(more < most ? more : most);
}

// Builds once. Sets *fits if the tree stays within the limits; otherwise the tree remains unused in
// the arena.
static bool build_once(const struct bvh_params *params, const struct attempt *attempt,
                       struct arena *arena, struct bvh *out, bool *fits, struct err *err)
{
    bool ok = false;
    struct arena scratch = {0}, input = {0};
    unsigned threads = params->threads > 0 ? params->threads : cpu_count();
    uint32_t count = bvh_primitive_count(params);
    uint32_t capacity = capacity_for(params, count), leaf_count = 0;
    // While the binary tree is built, there are two copies of the primitives, in addition to the
    // nodes; later steps need no more. The budget is checked now, before minutes are spent.
    uint64_t bytes =
        capacity * 2ull * (sizeof(struct bvh_primitive) + sizeof(struct bvh_binary_node));
    if (!memory_check(bytes, "building the BVH", err))
        return false;
    struct bvh_primitive *primitives = ARENA_NEW(&input, struct bvh_primitive, capacity);
    if (!primitives) {
        err_memory(err, "the BVH's primitives", (uint64_t)capacity * sizeof *primitives);
        goto done;
    }
    if (!make_primitives(params, threads, primitives, err))
        goto done;
    struct bvh_binary_node *nodes =
        bvh_binary_build(&(struct bvh_binary_params){.primitives = primitives,
                                                     .count = count,
                                                     .capacity = capacity,
                                                     .geometry = params,
                                                     .depth_limit = attempt->depth_limit,
                                                     .threads = threads,
                                                     .split = params->method.split,
                                                     .progress = params->progress},
                         &scratch, &leaf_count, err);
    arena_finish(&input);
    if (!nodes)
        goto done;
    out->reference_count = leaf_count - params->shape_count - params->instance_count;
    *fits = true;
    bool plain = params->method.split != BVH_SPLIT_SAH && params->method.split != BVH_SPLIT_SPATIAL;
    bool optimize = attempt->optimize && params->method.optimize != BVH_OPTIMIZE_OFF && !plain;
    if (optimize && !bvh_optimize(&(struct bvh_optimize_params){.nodes = nodes,
                                                                .leaf_count = leaf_count,
                                                                .effort = params->method.optimize,
                                                                .threads = threads,
                                                                .progress = params->progress},
                                  fits, err))
        goto done;
    ok = !*fits || bvh_wide_build(&(struct bvh_wide_params){.nodes = nodes,
                                                            .leaf_count = leaf_count,
                                                            .method = &params->method,
                                                            .threads = threads,
                                                            .plain = plain,
                                                            .progress = params->progress},
                                  arena, out, err);
    *fits = *fits && out->stats.stack_entries <= BVH_STACK_ENTRIES_MAX;
done:
    arena_finish(&input);
    arena_finish(&scratch);
    return ok;
}

static bool build_tree(const struct bvh_params *params, struct arena *arena, struct bvh *out,
                       struct err *err)
{
    if (bvh_primitive_count(params) == 0)
        return build_empty(arena, out, err);
    bool ok = true, fits = false;
    for (size_t i = 0; ok && !fits; i++) // the second attempt always fits
        ok = build_once(params, &attempts[i], arena, out, &fits, err);
    return ok;
}

bool bvh_build(const struct bvh_params *params, struct arena *arena, struct bvh *out,
               struct err *err)
{
    uint64_t start = clock_ns();
    *out = (struct bvh){.format = params->method.format,
                        .max_leaf = params->method.max_leaf,
                        .triangle_count = params->triangle_count,
                        .reference_count = params->triangle_count};
    if (!check_params(params, err) || !bvh_checkpoint(params->progress, 0, err))
        return false;
    if (!build_tree(params, arena, out, err))
        return false;
    out->stats.build_seconds = clock_seconds_since(start);
    progress_report(params->progress, "Building BVH", 1);
    return true;
}
