// Decides where to split a range of primitives, and splits it, by one of six methods:
//   binned   surface area heuristic over bins of the centroids (Wald 2007, "On fast construction
//            of SAH-based bounding volume hierarchies");
//   sweep    surface area heuristic over all positions, for short ranges;
//   median   halves the range, also if centroids coincide or the depth limit is near;
//   mean     splits at the mean of the centroids;
//   middle   splits at the middle of the box;
//   spatial  cuts triangles by a plane: bvh_spatial.c.
// BVH_SPLIT_SAH uses the first two, BVH_SPLIT_SPATIAL these and the last. The results of chunks
// (minima, maxima, counts) do not depend on their order and number, and partitioning is stable: so
// the result depends on the input alone.
#include "base/parallel.h"
#include "bvh/bvh_binary.h"
#include "bvh/bvh_spatial.h"

#include <assert.h>
#include <float.h>
#include <string.h>

enum {
    BIN_COUNT = 32,
    SWEEP_MAX = 16, // ranges of at most this many primitives are swept
};

struct bin {
    struct bvh_box box;
    uint32_t count;
};

// A part of a range, which one thread processes.
struct bvh_chunk {
    struct bin bins[3][BIN_COUNT];
    uint32_t begin, end;            // offsets in the range
    uint32_t next_left, next_right; // positions for the chunk's first primitives on either side
    struct bvh_box centroids[2];
};

struct bin_map {
    float origin[3], scale[3];
};

struct bin_split {
    double cost;    // sum of area times number of primitives over both sides
    uint32_t axis;  // 3: no split was found
    uint32_t first; // first bin or position of the right side
    uint32_t left_count;
    struct bvh_box left, right;
};

// Data shared by the functions that process chunks.
struct split_job {
    const struct progress *progress;
    const struct bvh_primitive *source; // the primitives of the range
    struct bvh_primitive *targets[2];
    struct bvh_chunk *chunks;
    struct bin_map map;
    struct bin_split split;
};

size_t bvh_chunk_bytes(void)
{
    return sizeof(struct bvh_chunk);
}

static void add_centroid(struct bvh_box *centroids, const struct bvh_box *box)
{
    const float centroid[3] = {bvh_centroid(box, 0), bvh_centroid(box, 1), bvh_centroid(box, 2)};
    box_add_point(centroids, centroid);
}

void bvh_range_bound(struct bvh_range *range, const struct bvh_primitive *primitives)
{
    range->box = range->centroids = box_empty();
    for (uint32_t i = 0; i < range->count; i++) {
        box_add_box(&range->box, &primitives[i].box);
        add_centroid(&range->centroids, &primitives[i].box);
    }
}

// --- Binned -------------------------------------------------------------------------------------

static struct bin_map bin_map_for(const struct bvh_box *centroids)
{
    struct bin_map map;
    for (int axis = 0; axis < 3; axis++) {
        float extent = centroids->max[axis] - centroids->min[axis];
        map.origin[axis] = centroids->min[axis];
        // Below this extent the scale would overflow; then all centroids go to bin 0.
        map.scale[axis] = extent > BIN_COUNT * FLT_MIN ? BIN_COUNT / extent : 0;
    }
    return map;
}

static int bin_index(const struct bin_map *map, int axis, const struct bvh_box *box)
{
    int index = (int)((bvh_centroid(box, axis) - map->origin[axis]) * map->scale[axis]);
    return index < BIN_COUNT - 1 ? index : BIN_COUNT - 1;
}

static void bins_clear(struct bin bins[3][BIN_COUNT])
{
    for (int axis = 0; axis < 3; axis++)
        for (int i = 0; i < BIN_COUNT; i++)
            bins[axis][i] = (struct bin){.box = box_empty()};
}

static void chunk_bin(void *context, size_t begin, size_t end, unsigned thread)
{
    (void)thread;
    const struct split_job *job = context;
    for (size_t i = begin; i < end; i++) {
        struct bvh_chunk *chunk = &job->chunks[i];
        bins_clear(chunk->bins);
        for (uint32_t p = chunk->begin; p < chunk->end; p++) {
            if (progress_stops_at(job->progress, p - chunk->begin + 1))
                return;
            const struct bvh_box *box = &job->source[p].box;
            for (int axis = 0; axis < 3; axis++) {
                struct bin *bin = &chunk->bins[axis][bin_index(&job->map, axis, box)];
                box_add_box(&bin->box, box);
                bin->count++;
            }
        }
    }
}

static void bins_merge(struct bin into[3][BIN_COUNT], const struct bin from[3][BIN_COUNT])
{
    for (int axis = 0; axis < 3; axis++) {
        for (int i = 0; i < BIN_COUNT; i++) {
            box_add_box(&into[axis][i].box, &from[axis][i].box);
            into[axis][i].count += from[axis][i].count;
        }
    }
}

// Compares a split with the best so far. At equal cost (in a flat scene all costs may be 0) the
// more even split wins, so that the depth stays small.
static bool split_is_better(double cost, uint32_t left, uint32_t right,
                            const struct bin_split *best, uint32_t count)
{
    if (best->axis == 3 || cost != best->cost)
        return best->axis == 3 || cost < best->cost;
    uint32_t best_right = count - best->left_count;
    uint32_t best_smaller = best->left_count < best_right ? best->left_count : best_right;
    return (left < right ? left : right) > best_smaller;
}

static void axis_best_split(const struct bin bins[BIN_COUNT], uint32_t axis, uint32_t count,
                            struct bin_split *best)
{
    struct bin right[BIN_COUNT]; // right[i]: union of bins i to the last
    right[BIN_COUNT - 1] = bins[BIN_COUNT - 1];
    for (int i = BIN_COUNT - 2; i > 0; i--) {
        right[i] = bins[i];
        box_add_box(&right[i].box, &right[i + 1].box);
        right[i].count += right[i + 1].count;
    }
    struct bin left = bins[0];
    for (uint32_t i = 1; i < BIN_COUNT; i++) {
        if (left.count > 0 && bins[i].count > 0) { // otherwise the split equals an adjacent one
            double cost = box_half_area(&left.box) * left.count +
                          box_half_area(&right[i].box) * right[i].count;
            if (split_is_better(cost, left.count, right[i].count, best, count))
                *best = (struct bin_split){cost, axis, i, left.count, left.box, right[i].box};
        }
        box_add_box(&left.box, &bins[i].box);
        left.count += bins[i].count;
    }
}

static void chunk_partition(void *context, size_t begin, size_t end, unsigned thread)
{
    (void)thread;
    const struct split_job *job = context;
    int axis = (int)job->split.axis, first_right = (int)job->split.first;
    for (size_t i = begin; i < end; i++) {
        struct bvh_chunk *chunk = &job->chunks[i];
        uint32_t next[2] = {chunk->next_left, chunk->next_right};
        struct bvh_box centroids[2] = {box_empty(), box_empty()};
        for (uint32_t p = chunk->begin; p < chunk->end; p++) {
            if (progress_stops_at(job->progress, p - chunk->begin + 1))
                return;
            const struct bvh_primitive *primitive = &job->source[p];
            int side = bin_index(&job->map, axis, &primitive->box) >= first_right;
            add_centroid(&centroids[side], &primitive->box);
            job->targets[side][next[side]++] = *primitive;
        }
        chunk->centroids[0] = centroids[0];
        chunk->centroids[1] = centroids[1];
    }
}

static void run_chunks(struct split_job *job, uint32_t chunk_count, unsigned threads,
                       parallel_fn fn)
{
    if (chunk_count == 1)
        fn(job, 0, 1, 0);
    else
        parallel_for(chunk_count, 1, threads, fn, job);
}

// Computes the positions of each chunk's primitives in the partitioned range: left sides before
// right sides, and chunks in order on each side.
static void chunks_place(struct split_job *job, uint32_t chunk_count)
{
    uint32_t left = 0, right = 0;
    for (uint32_t i = 0; i < chunk_count; i++) {
        struct bvh_chunk *chunk = &job->chunks[i];
        uint32_t left_count = 0;
        for (uint32_t b = 0; b < job->split.first; b++)
            left_count += chunk->bins[job->split.axis][b].count;
        chunk->next_left = left;
        chunk->next_right = right;
        left += left_count;
        right += chunk->end - chunk->begin - left_count;
    }
}

// Finds the best split between bins. Returns false if no axis separates the centroids.
static bool find_binned_split(struct split_job *job, uint32_t count, uint32_t chunk_count,
                              unsigned threads)
{
    run_chunks(job, chunk_count, threads, chunk_bin);
    struct bin merged[3][BIN_COUNT];
    memcpy(merged, job->chunks[0].bins, sizeof merged);
    for (uint32_t i = 1; i < chunk_count; i++)
        bins_merge(merged, (const struct bin(*)[BIN_COUNT])job->chunks[i].bins);
    job->split = (struct bin_split){.axis = 3};
    for (uint32_t axis = 0; axis < 3; axis++)
        axis_best_split(merged[axis], axis, count, &job->split);
    return job->split.axis < 3;
}

// A spatial split is tried if the surface area of the overlap of the children's boxes exceeds this
// fraction of the root's surface area (Stich, Friedrich, Dietrich 2009, section 4.2).
#define OVERLAP_MIN 1e-5
// The overlap must also exceed this fraction of the range's own area: a spatial split gains no more
// than the overlap, and the search is slow.
#define OVERLAP_OF_RANGE_MIN 0.2

// Tries a spatial split in place of an object split, whose children are known except for their
// positions. Returns false if it does not cost less.
static bool split_spatially(const struct bvh_splitter *splitter, const struct bvh_range *range,
                            unsigned threads, const struct bin_split *object,
                            struct bvh_range children[2])
{
    if (splitter->split != BVH_SPLIT_SPATIAL || range->capacity == range->count)
        return false;
    struct bvh_box overlap;
    for (int axis = 0; axis < 3; axis++) {
        const struct bvh_box *a = &object->left, *b = &object->right;
        overlap.min[axis] = a->min[axis] > b->min[axis] ? a->min[axis] : b->min[axis];
        overlap.max[axis] = a->max[axis] < b->max[axis] ? a->max[axis] : b->max[axis];
        if (overlap.min[axis] > overlap.max[axis])
            return false;
    }
    struct bvh_spatial_split split;
    return box_half_area(&overlap) > OVERLAP_MIN * splitter->root_area &&
           box_half_area(&overlap) > OVERLAP_OF_RANGE_MIN * box_half_area(&range->box) &&
           bvh_spatial_find(splitter, range, threads, object->cost, &split) &&
           bvh_spatial_apply(splitter, range, threads, &split, children);
}

// Splits a range by bins, or by a plane, and fills in the children. Returns false if bins cannot
// separate the centroids, or if the work was stopped.
static bool split_binned(const struct bvh_splitter *splitter, const struct bvh_range *range,
                         unsigned threads, struct bvh_range children[2])
{
    struct bvh_chunk only;
    uint32_t chunk_count = threads > 1 ? range->count / BVH_CHUNK_MIN : 1;
    chunk_count = chunk_count > BVH_CHUNKS_MAX ? BVH_CHUNKS_MAX : chunk_count > 1 ? chunk_count : 1;
    struct split_job job = {
        .progress = splitter->progress,
        .source = splitter->primitives[range->side] + range->first,
        .chunks = chunk_count > 1 ? splitter->chunks : &only,
        .map = bin_map_for(&range->centroids),
    };
    for (uint32_t i = 0; i < chunk_count; i++) {
        job.chunks[i].begin = (uint32_t)((uint64_t)range->count * i / chunk_count);
        job.chunks[i].end = (uint32_t)((uint64_t)range->count * (i + 1) / chunk_count);
    }
    if (!find_binned_split(&job, range->count, chunk_count, threads))
        return false;
    if (bvh_split_stopped(splitter, range))
        return false; // stopped: the bins are incomplete
    if (split_spatially(splitter, range, threads, &job.split, children))
        return true;
    children[0].box = job.split.left;
    children[1].box = job.split.right;
    children[0].count = job.split.left_count;
    children[1].count = range->count - job.split.left_count;
    bvh_place_children(range, children);
    for (int side = 0; side < 2; side++)
        job.targets[side] = splitter->primitives[!range->side] + children[side].first;
    chunks_place(&job, chunk_count);
    run_chunks(&job, chunk_count, threads, chunk_partition);
    for (int side = 0; side < 2; side++) {
        children[side].centroids = job.chunks[0].centroids[side];
        for (uint32_t i = 1; i < chunk_count; i++)
            box_add_box(&children[side].centroids, &job.chunks[i].centroids[side]);
        children[side].side = !range->side;
    }
    return true;
}

// --- In place: sweep, median, mean and middle ----------------------------------------------------

static void sort_by_centroid(const struct bvh_primitive *primitives, uint32_t count, int axis,
                             uint8_t order[SWEEP_MAX])
{
    float keys[SWEEP_MAX];
    for (uint32_t i = 0; i < count; i++) {
        float key = bvh_centroid(&primitives[i].box, axis);
        uint32_t at = i;
        for (; at > 0 && keys[at - 1] > key; at--) {
            keys[at] = keys[at - 1];
            order[at] = order[at - 1];
        }
        keys[at] = key;
        order[at] = (uint8_t)i;
    }
}

static void sweep_axis(const struct bvh_primitive *primitives, uint32_t count, uint32_t axis,
                       const uint8_t order[SWEEP_MAX], struct bin_split *best)
{
    double right_area[SWEEP_MAX];
    struct bvh_box box = primitives[order[count - 1]].box;
    right_area[count - 1] = box_half_area(&box);
    for (uint32_t i = count - 2; i > 0; i--) {
        box_add_box(&box, &primitives[order[i]].box);
        right_area[i] = box_half_area(&box);
    }
    box = primitives[order[0]].box;
    for (uint32_t i = 1; i < count; i++) {
        double cost = box_half_area(&box) * i + right_area[i] * (count - i);
        if (split_is_better(cost, i, count - i, best, count))
            *best = (struct bin_split){.cost = cost, .axis = axis, .first = i, .left_count = i};
        box_add_box(&box, &primitives[order[i]].box);
    }
}

// Partitions a short range, whose first `left` primitives belong to the left child.
static void split_in_place(const struct bvh_splitter *splitter, const struct bvh_range *range,
                           uint32_t left, struct bvh_range children[2])
{
    struct bvh_primitive *primitives = splitter->primitives[range->side];
    children[0].side = children[1].side = range->side;
    children[0].count = left;
    children[1].count = range->count - left;
    bvh_range_bound(&children[0], primitives + range->first);
    bvh_range_bound(&children[1], primitives + range->first + left);
    bvh_place_children(range, children);
    memmove(primitives + children[1].first, primitives + range->first + left,
            children[1].count * sizeof *primitives);
}

// Sweeps a short range and sorts it along the best axis.
static void split_swept(const struct bvh_splitter *splitter, const struct bvh_range *range,
                        struct bvh_range children[2])
{
    uint32_t count = range->count;
    struct bvh_primitive *primitives = splitter->primitives[range->side] + range->first;
    uint8_t orders[3][SWEEP_MAX];
    struct bin_split best = {.axis = 3};
    for (uint32_t axis = 0; axis < 3 && count > 2; axis++) {
        sort_by_centroid(primitives, count, (int)axis, orders[axis]);
        sweep_axis(primitives, count, axis, orders[axis], &best);
    }
    if (count > 2) {
        assert(best.axis < 3); // any first split is better than none
        struct bvh_primitive copy[SWEEP_MAX];
        memcpy(copy, primitives, count * sizeof *copy);
        best.left = best.right = box_empty();
        for (uint32_t i = 0; i < count; i++) {
            primitives[i] = copy[orders[best.axis][i]];
            box_add_box(i < best.left_count ? &best.left : &best.right, &primitives[i].box);
        }
        if (split_spatially(splitter, range, 1, &best, children))
            return;
    }
    split_in_place(splitter, range, count > 2 ? best.left_count : 1, children);
}

static bool centroid_less(const struct bvh_primitive *a, const struct bvh_primitive *b, int axis)
{
    float key_a = bvh_centroid(&a->box, axis), key_b = bvh_centroid(&b->box, axis);
    return key_a < key_b || (key_a == key_b && a->id < b->id);
}

static void swap(struct bvh_primitive *a, struct bvh_primitive *b)
{
    struct bvh_primitive copy = *a;
    *a = *b;
    *b = copy;
}

// Moves the `middle` primitives with the smallest centroids to the front (quickselect, Hoare 1961).
// Ids differ, so no keys are equal.
static void select_smallest(struct bvh_primitive *primitives, uint32_t count, uint32_t middle,
                            int axis)
{
    uint32_t begin = 0, end = count;
    while (end - begin > 1) {
        swap(&primitives[begin], &primitives[begin + (end - begin) / 2]); // the pivot
        uint32_t place = begin;
        for (uint32_t i = begin + 1; i < end; i++)
            if (centroid_less(&primitives[i], &primitives[begin], axis))
                swap(&primitives[++place], &primitives[i]);
        swap(&primitives[begin], &primitives[place]);
        if (place == middle)
            return;
        if (place < middle)
            begin = place + 1;
        else
            end = place;
    }
}

static float centroid_extent(const struct bvh_range *range, int axis)
{
    return range->centroids.max[axis] - range->centroids.min[axis];
}

static int widest_axis(const struct bvh_range *range)
{
    int widest = 0;
    for (int axis = 1; axis < 3; axis++)
        widest = centroid_extent(range, axis) > centroid_extent(range, widest) ? axis : widest;
    return widest;
}

// Splits into halves by the centroids on the widest axis; in the current order if all centroids
// coincide.
static uint32_t split_median(struct bvh_primitive *primitives, const struct bvh_range *range)
{
    int axis = widest_axis(range);
    if (centroid_extent(range, axis) > 0)
        select_smallest(primitives, range->count, range->count / 2, axis);
    return range->count / 2;
}

// Moves the primitives whose centroids are below the mean on the widest axis to the front. Splits
// at the median if these are none or all of the primitives. The summation follows the order of the
// range, which does not depend on threads.
static uint32_t split_mean(struct bvh_primitive *primitives, const struct bvh_range *range)
{
    int axis = widest_axis(range);
    double sum = 0;
    for (uint32_t i = 0; i < range->count; i++)
        sum += (double)bvh_centroid(&primitives[i].box, axis);
    double mean = sum / range->count;
    uint32_t left = 0;
    for (uint32_t i = 0; i < range->count; i++)
        if ((double)bvh_centroid(&primitives[i].box, axis) < mean)
            swap(&primitives[left++], &primitives[i]);
    return left > 0 && left < range->count ? left : split_median(primitives, range);
}

static int longest_axis(const struct bvh_box *box)
{
    int longest = 0;
    for (int axis = 1; axis < 3; axis++)
        if (0.25f * box->max[axis] - 0.25f * box->min[axis] >
            0.25f * box->max[longest] - 0.25f * box->min[longest])
            longest = axis;
    return longest;
}

// Moves the primitives whose centroids are below the centre of the box, along its longest axis, to
// the front. Splits at the median if these are none or all of the primitives.
static uint32_t split_middle(struct bvh_primitive *primitives, const struct bvh_range *range)
{
    int axis = longest_axis(&range->box);
    float middle = bvh_centroid(&range->box, axis);
    uint32_t left = 0;
    for (uint32_t i = 0; i < range->count; i++)
        if (bvh_centroid(&primitives[i].box, axis) < middle)
            swap(&primitives[left++], &primitives[i]);
    return left > 0 && left < range->count ? left : split_median(primitives, range);
}

// Returns whether the range must be halved from here on to stay within the depth limit.
static bool depth_runs_out(const struct bvh_splitter *splitter, const struct bvh_range *range)
{
    uint32_t halvings = 32 - (uint32_t)__builtin_clz(range->count - 1); // log2, rounded up
    return range->depth + halvings >= splitter->depth_limit;
}

// --- All methods ---------------------------------------------------------------------------------

// The remaining capacity is divided between the children in proportion to their costs.
void bvh_place_children(const struct bvh_range *range, struct bvh_range children[2])
{
    uint32_t rest = range->capacity - children[0].count - children[1].count, left = 0;
    if (rest > 0) {
        double costs[2];
        for (int side = 0; side < 2; side++)
            costs[side] = box_half_area(&children[side].box) * (children[side].count - 1);
        left = costs[0] + costs[1] > 0 ? (uint32_t)(rest * (costs[0] / (costs[0] + costs[1])))
                                       : rest / 2;
        left = left < rest ? left : rest;
    }
    children[0].capacity = children[0].count + left;
    children[1].capacity = children[1].count + rest - left;
    children[0].first = range->first;
    children[0].node = range->node + 1;
    children[1].first = range->first + children[0].capacity;
    children[1].node = range->node + 2 * children[0].capacity;
    children[0].depth = children[1].depth = range->depth + 1;
}

void bvh_split(const struct bvh_splitter *splitter, const struct bvh_range *range, unsigned threads,
               struct bvh_range children[2])
{
    assert(range->count >= 2);
    enum bvh_split split = depth_runs_out(splitter, range) ? BVH_SPLIT_MEDIAN : splitter->split;
    bool by_cost = split == BVH_SPLIT_SAH || split == BVH_SPLIT_SPATIAL;
    if (by_cost && range->count <= SWEEP_MAX) {
        split_swept(splitter, range, children);
        return;
    }
    if (by_cost && split_binned(splitter, range, threads, children))
        return;
    struct bvh_primitive *primitives = splitter->primitives[range->side] + range->first;
    uint32_t left = bvh_split_stopped(splitter, range) ? range->count / 2
                    : split == BVH_SPLIT_MEAN          ? split_mean(primitives, range)
                    : split == BVH_SPLIT_MIDDLE        ? split_middle(primitives, range)
                                                       : split_median(primitives, range);
    split_in_place(splitter, range, left, children);
}
