// Makes spatial splits (Stich, Friedrich, Dietrich 2009, "Spatial splits in bounding volume
// hierarchies"): a range is cut by a plane, and triangles that cross the plane go to both sides,
// each time with the box of the part on that side. There are two deviations: whether a triangle
// stays whole ("reference unsplitting", section 4.3) is decided for each triangle independently,
// from the boxes and counts of the chosen plane, so that the result depends neither on order nor on
// threads; the children get tight boxes, while candidate planes are compared by boxes that are
// faster to compute.
#include "bvh/bvh_spatial.h"

#include "base/parallel.h"
#include "bvh/bvh_clip.h"
#include "bvh/bvh_triangle.h"

enum {
    BINS_MAX = 32,
    BINS_FEW = 8, // bins for at most FEW_MAX references, to limit the clipping
    FEW_MAX = 16,
    LEFT = 1,
    RIGHT = 2,
};

struct bin {
    struct bvh_box box;
    uint32_t enter, leave; // numbers of references that begin and that end in this bin
};

struct bvh_spatial_chunk {
    struct bin bins[3][BINS_MAX];
    uint32_t begin, end;
    uint32_t counts[2], next[2];
    struct bvh_box boxes[2], centroids[2];
};

// Planes that divide the range's box into equal bins. The last entry, [bin_count], is the end of
// the box.
struct grid {
    int bin_count;
    double planes[3][BINS_MAX + 1];
    double scale[3]; // bins per unit of length
};

struct spatial_job {
    const struct bvh_splitter *splitter;
    const struct bvh_primitive *source;
    struct bvh_primitive *targets[2];
    struct bvh_spatial_chunk *chunks;
    struct grid grid;
    const struct bvh_spatial_split *split;
    double areas[2];
};

size_t bvh_spatial_chunk_bytes(void)
{
    return sizeof(struct bvh_spatial_chunk);
}

static struct grid grid_for(const struct bvh_box *box, uint32_t count)
{
    struct grid grid = {.bin_count = count > FEW_MAX ? BINS_MAX : BINS_FEW};
    for (int axis = 0; axis < 3; axis++) {
        double min = box->min[axis], extent = (double)box->max[axis] - min;
        for (int i = 0; i <= grid.bin_count; i++)
            grid.planes[axis][i] = min + extent * i / grid.bin_count;
        grid.scale[axis] = extent > 0 ? grid.bin_count / extent : 0;
    }
    return grid;
}

// Computes the first and last bin of an interval. An interval that ends at a plane ends in the bin
// below it.
static void bins_of(const struct grid *grid, int axis, float min, float max, int bins[2])
{
    const double *planes = grid->planes[axis];
    int end = grid->bin_count - 1;
    int first = (int)(((double)min - planes[0]) * grid->scale[axis]);
    int last = (int)(((double)max - planes[0]) * grid->scale[axis]);
    first = first > end ? end : first < 0 ? 0 : first;
    last = last > end ? end : last < 0 ? 0 : last;
    while (first > 0 && planes[first] > (double)min)
        first--;
    while (first < end && planes[first + 1] <= (double)min)
        first++;
    while (last < end && planes[last + 1] < (double)max)
        last++;
    while (last > first && planes[last] >= (double)max)
        last--;
    bins[0] = first;
    bins[1] = last > first ? last : first;
}

// Computes the bins of a primitive. Primitives that are not triangles are never cut: they are in
// the bin of their centre only.
static void bins_of_primitive(const struct grid *grid, int axis,
                              const struct bvh_primitive *primitive, int bins[2])
{
    float min = primitive->box.min[axis], max = primitive->box.max[axis];
    if (primitive->id & BVH_LEAF_SHAPE)
        min = max = 0.5f * min + 0.5f * max;
    bins_of(grid, axis, min, max, bins);
}

static struct bvh_clip clip_for(const struct spatial_job *job, uint32_t triangle)
{
    float vertices[3][3];
    bvh_triangle_load(job->splitter->geometry, triangle, vertices);
    return bvh_clip_for((const float(*)[3])vertices);
}

static void bin_primitive(const struct spatial_job *job, const struct bvh_primitive *primitive,
                          struct bin bins[3][BINS_MAX])
{
    struct bvh_clip clip;
    bool have_clip = false;
    for (int axis = 0; axis < 3; axis++) {
        int range[2];
        bins_of_primitive(&job->grid, axis, primitive, range);
        bins[axis][range[0]].enter++;
        bins[axis][range[1]].leave++;
        struct bvh_box rest = primitive->box;
        if (range[0] < range[1] && !have_clip) {
            clip = clip_for(job, primitive->id);
            have_clip = true;
        }
        for (int i = range[0]; i < range[1]; i++) {
            struct bvh_box parts[2];
            bvh_clip_quickly(&clip, &rest, axis, job->grid.planes[axis][i + 1], parts);
            box_add_box(&bins[axis][i].box, &parts[0]);
            rest = parts[1];
        }
        box_add_box(&bins[axis][range[1]].box, &rest);
    }
}

static void chunk_bin(void *context, size_t begin, size_t end, unsigned thread)
{
    (void)thread;
    const struct spatial_job *job = context;
    for (size_t i = begin; i < end; i++) {
        struct bvh_spatial_chunk *chunk = &job->chunks[i];
        for (int axis = 0; axis < 3; axis++)
            for (int b = 0; b < job->grid.bin_count; b++)
                chunk->bins[axis][b] = (struct bin){.box = box_empty()};
        for (uint32_t p = chunk->begin; p < chunk->end; p++) {
            if (progress_stops_at(job->splitter->progress, p - chunk->begin + 1))
                return;
            bin_primitive(job, &job->source[p], chunk->bins);
        }
    }
}

static void run_chunks(struct spatial_job *job, uint32_t chunk_count, unsigned threads,
                       parallel_fn fn)
{
    if (chunk_count == 1)
        fn(job, 0, 1, 0);
    else
        parallel_for(chunk_count, 1, threads, fn, job);
}

static uint32_t make_chunks(const struct bvh_splitter *splitter, const struct bvh_range *range,
                            unsigned threads, struct bvh_spatial_chunk *only,
                            struct spatial_job *job)
{
    uint32_t count = threads > 1 ? range->count / BVH_CHUNK_MIN : 1;
    count = count > BVH_CHUNKS_MAX ? BVH_CHUNKS_MAX : count > 1 ? count : 1;
    *job = (struct spatial_job){
        .splitter = splitter,
        .source = splitter->primitives[range->side] + range->first,
        .chunks = count > 1 ? splitter->spatial_chunks : only,
        .grid = grid_for(&range->box, range->count),
    };
    for (uint32_t i = 0; i < count; i++) {
        job->chunks[i].begin = (uint32_t)((uint64_t)range->count * i / count);
        job->chunks[i].end = (uint32_t)((uint64_t)range->count * (i + 1) / count);
    }
    return count;
}

static void best_plane(const struct bin bins[BINS_MAX], uint32_t bin_count, uint32_t axis,
                       const struct bvh_range *range, struct bvh_spatial_split *best)
{
    struct bvh_box right[BINS_MAX]; // right[i]: union of bins i to the last
    right[bin_count - 1] = bins[bin_count - 1].box;
    for (uint32_t i = bin_count - 2; i > 0; i--) {
        right[i] = bins[i].box;
        box_add_box(&right[i], &right[i + 1]);
    }
    struct bvh_box left = bins[0].box;
    uint32_t entered = bins[0].enter, to_leave = range->count - bins[0].leave;
    for (uint32_t i = 1; i < bin_count; i++) {
        if (entered > 0 && to_leave > 0 && entered < range->count && to_leave < range->count &&
            (uint64_t)entered + to_leave <= range->capacity) {
            double cost = box_half_area(&left) * entered + box_half_area(&right[i]) * to_leave;
            if (cost < best->cost)
                *best = (struct bvh_spatial_split){
                    cost, axis, i, {entered, to_leave}, {left, right[i]}};
        }
        box_add_box(&left, &bins[i].box);
        entered += bins[i].enter;
        to_leave -= bins[i].leave;
    }
}

// Adds the bins of another chunk. Chunks are large enough to use all bins.
static void bins_merge(struct bin into[3][BINS_MAX], const struct bin from[3][BINS_MAX])
{
    for (int axis = 0; axis < 3; axis++) {
        for (int i = 0; i < BINS_MAX; i++) {
            box_add_box(&into[axis][i].box, &from[axis][i].box);
            into[axis][i].enter += from[axis][i].enter;
            into[axis][i].leave += from[axis][i].leave;
        }
    }
}

bool bvh_spatial_find(const struct bvh_splitter *splitter, const struct bvh_range *range,
                      unsigned threads, double fewer_than, struct bvh_spatial_split *split)
{
    struct bvh_spatial_chunk only;
    struct spatial_job job;
    uint32_t chunk_count = make_chunks(splitter, range, threads, &only, &job);
    run_chunks(&job, chunk_count, threads, chunk_bin);
    if (bvh_split_stopped(splitter, range))
        return false;
    struct bin(*merged)[BINS_MAX] = job.chunks[0].bins;
    for (uint32_t i = 1; i < chunk_count; i++)
        bins_merge(merged, (const struct bin(*)[BINS_MAX])job.chunks[i].bins);
    *split = (struct bvh_spatial_split){.cost = fewer_than, .axis = 3};
    for (uint32_t axis = 0; axis < 3; axis++)
        best_plane(merged[axis], (uint32_t)job.grid.bin_count, axis, range, split);
    return split->axis < 3;
}

// --- Splitting ----------------------------------------------------------------------------------

static double grown_half_area(const struct bvh_box *a, const struct bvh_box *b)
{
    struct bvh_box grown = *a;
    box_add_box(&grown, b);
    return box_half_area(&grown);
}

// Returns LEFT, RIGHT or both. Both are returned if cutting the reference costs less than putting
// all of it on one side.
static int sides_of(const struct spatial_job *job, const struct bvh_primitive *primitive)
{
    const struct bvh_spatial_split *split = job->split;
    int bins[2], first_right = (int)split->first;
    bins_of_primitive(&job->grid, (int)split->axis, primitive, bins);
    if (bins[1] < first_right)
        return LEFT;
    if (bins[0] >= first_right)
        return RIGHT;
    double counts[2] = {split->counts[0], split->counts[1]};
    double left = grown_half_area(&split->boxes[0], &primitive->box) * counts[0] +
                  job->areas[1] * (counts[1] - 1);
    double right = job->areas[0] * (counts[0] - 1) +
                   grown_half_area(&split->boxes[1], &primitive->box) * counts[1];
    double both = job->areas[0] * counts[0] + job->areas[1] * counts[1];
    if (both <= left && both <= right)
        return LEFT | RIGHT;
    return left <= right ? LEFT : RIGHT;
}

static void chunk_count_sides(void *context, size_t begin, size_t end, unsigned thread)
{
    (void)thread;
    const struct spatial_job *job = context;
    for (size_t i = begin; i < end; i++) {
        struct bvh_spatial_chunk *chunk = &job->chunks[i];
        chunk->counts[0] = chunk->counts[1] = 0;
        for (uint32_t p = chunk->begin; p < chunk->end; p++) {
            if (progress_stops_at(job->splitter->progress, p - chunk->begin + 1))
                return;
            int sides = sides_of(job, &job->source[p]);
            chunk->counts[0] += (sides & LEFT) != 0;
            chunk->counts[1] += (sides & RIGHT) != 0;
        }
    }
}

static void put(const struct spatial_job *job, struct bvh_spatial_chunk *chunk, int side,
                const struct bvh_primitive *primitive)
{
    const struct bvh_box *box = &primitive->box;
    const float centroid[3] = {bvh_centroid(box, 0), bvh_centroid(box, 1), bvh_centroid(box, 2)};
    box_add_box(&chunk->boxes[side], box);
    box_add_point(&chunk->centroids[side], centroid);
    job->targets[side][chunk->next[side]++] = *primitive;
}

static void chunk_partition(void *context, size_t begin, size_t end, unsigned thread)
{
    (void)thread;
    const struct spatial_job *job = context;
    int axis = (int)job->split->axis;
    for (size_t i = begin; i < end; i++) {
        struct bvh_spatial_chunk *chunk = &job->chunks[i];
        for (int side = 0; side < 2; side++)
            chunk->boxes[side] = chunk->centroids[side] = box_empty();
        for (uint32_t p = chunk->begin; p < chunk->end; p++) {
            if (progress_stops_at(job->splitter->progress, p - chunk->begin + 1))
                return;
            struct bvh_primitive primitive = job->source[p];
            int sides = sides_of(job, &primitive);
            struct bvh_box parts[2] = {primitive.box, primitive.box};
            if (sides == (LEFT | RIGHT)) {
                struct bvh_clip clip = clip_for(job, primitive.id);
                bvh_clip_exactly(&clip, &primitive.box, axis,
                                 job->grid.planes[axis][job->split->first], parts);
            }
            for (int side = 0; side < 2; side++)
                if (sides & (side == 0 ? LEFT : RIGHT))
                    put(job, chunk, side,
                        &(struct bvh_primitive){.box = parts[side], .id = primitive.id});
        }
    }
}

bool bvh_spatial_apply(const struct bvh_splitter *splitter, const struct bvh_range *range,
                       unsigned threads, const struct bvh_spatial_split *split,
                       struct bvh_range children[2])
{
    struct bvh_spatial_chunk only;
    struct spatial_job job;
    uint32_t chunk_count = make_chunks(splitter, range, threads, &only, &job);
    job.split = split;
    job.areas[0] = box_half_area(&split->boxes[0]);
    job.areas[1] = box_half_area(&split->boxes[1]);
    run_chunks(&job, chunk_count, threads, chunk_count_sides);
    if (bvh_split_stopped(splitter, range))
        return false;
    uint32_t totals[2] = {0, 0};
    for (uint32_t i = 0; i < chunk_count; i++)
        for (int side = 0; side < 2; side++) {
            job.chunks[i].next[side] = totals[side];
            totals[side] += job.chunks[i].counts[side];
        }
    if (totals[0] == 0 || totals[1] == 0 || totals[0] == range->count || totals[1] == range->count)
        return false;
    children[0].count = totals[0];
    children[1].count = totals[1];
    children[0].box = split->boxes[0]; // needed for the distribution of the remaining capacity
    children[1].box = split->boxes[1];
    bvh_place_children(range, children);
    for (int side = 0; side < 2; side++) {
        children[side].side = !range->side;
        job.targets[side] = splitter->primitives[!range->side] + children[side].first;
    }
    run_chunks(&job, chunk_count, threads, chunk_partition);
    for (int side = 0; side < 2; side++) {
        children[side].box = children[side].centroids = box_empty();
        for (uint32_t i = 0; i < chunk_count; i++) {
            box_add_box(&children[side].box, &job.chunks[i].boxes[side]);
            box_add_box(&children[side].centroids, &job.chunks[i].centroids[side]);
        }
    }
    return true;
}
