#include "render/tables/light_tree.h"

#include "base/maths.h"
#include "base/parallel.h"
#include "render/tables/octahedral.h"
#include <float.h>
#include <math.h>
#include <string.h>

#define BUCKETS 12
#define FEW 32 // ranges of up to this many emitters use FEW_BUCKETS
#define FEW_BUCKETS 4
// Splits of ranges with more than JUDGED items are evaluated with a sample of about JUDGED items.
// Ranges of fewer than HALVED items are halved.
#define JUDGED 1024
#define HALVED 4
// Maximum depth: the number of bits of a trail.
#define DEPTH_MAX 64
// Subtrees with at most TASK_LEAVES emitters, or 1 / TASK_PARTS of all emitters, are built by one
// thread.
#define TASK_LEAVES 4096
#define TASK_PARTS 32
#define TASKS_MAX 1024

// The items of one layer of the tree: the upper layer has lamps, the lower one the emitters of a
// lamp.
struct layer {
    const struct light_bounds *bounds;
    uint32_t *order; // indices of the items; a subtree is a range of them
    uint32_t below;  // maximum number of levels of the tree below an item
};

struct builder {
    struct layer lamps, emitters;
    const uint32_t *lamp_first; // for each lamp, the position of its first emitter; one more entry
                                // is the end
    const uint32_t *primitives;
    double total_power;
    struct light_tree *tree;
    const struct progress *progress; // NULL: no progress is reported
};

// A subtree: its range of items in a layer, the number of its emitters, the index of the pair of
// its root's children, and the path to it.
struct range {
    const struct layer *layer;
    uint32_t first, count, leaves, node, depth;
    uint64_t trail;
};

// Returns the bounds of an item of a range.
static const struct light_bounds *bounds_at(const struct range *range, uint32_t i)
{
    return &range->layer->bounds[range->layer->order[range->first + i]];
}

// --- bounds --------------------------------------------------------------------------------------

static double angle_between(const double a[3], const double b[3])
{
    double normal[3];
    vec3_cross(a, b, normal);
    return atan2(vec3_norm(normal), vec3_dot(a, b));
}

// Replaces the cone of *a by the smallest cone that contains the cones of *a and *b (Pharr, Jakob,
// Humphreys 2023, section 3.8.4). The axis of a two-sided emitter may be reversed first.
static void join_cones(struct light_bounds *a, const struct light_bounds *b)
{
    double other[3], angle;
    bool flip = (a->two_sided || b->two_sided) && vec3_dot(a->axis, b->axis) < 0.0;
    for (int c = 0; c < 3; c++)
        other[c] = flip ? -b->axis[c] : b->axis[c];
    angle = angle_between(a->axis, other);
    if (fmin(angle + b->theta_o, M_PI) <= a->theta_o)
        return;
    if (fmin(angle + a->theta_o, M_PI) <= b->theta_o) {
        memcpy(a->axis, other, sizeof other);
        a->theta_o = b->theta_o;
        return;
    }
    double theta = 0.5 * (a->theta_o + angle + b->theta_o);
    double turn = theta - a->theta_o, sine = sin(angle);
    if (theta >= M_PI || !(sine > 1e-9)) {
        a->theta_o = sine > 1e-9 || angle > 1.0 ? M_PI : theta;
        return;
    }
    for (int c = 0; c < 3; c++)
        a->axis[c] = (sin(angle - turn) * a->axis[c] + sin(turn) * other[c]) / sine;
    double length = vec3_norm(a->axis);
    for (int c = 0; c < 3; c++)
        a->axis[c] /= length;
    a->theta_o = theta;
}

static double distance(vec3s a, vec3s b)
{
    double from[3], to[3];
    vec3_widen(a.raw, from);
    vec3_widen(b.raw, to);
    vec3_subtract(to, from, to);
    return vec3_norm(to);
}

// A factor that exceeds the rounding error of a radius in single precision.
#define RADIUS_MARGIN (1.0 + 1e-6)

// Sets a bounding sphere around the middle of the box. Its radius is the distance to the corners of
// the box, or to the far side of the parts' spheres if that is less.
static void bound_by_sphere(struct light_bounds *out, const struct light_bounds *a,
                            const struct light_bounds *b)
{
    out->center = light_bounds_middle(out);
    double corner = fmax(distance(out->center, out->min), distance(out->center, out->max));
    double spheres = fmax(distance(out->center, a->center) + (double)a->radius,
                          distance(out->center, b->center) + (double)b->radius);
    out->radius = (float)(fmin(corner, spheres) * RADIUS_MARGIN);
}

static struct light_bounds join(const struct light_bounds *a, const struct light_bounds *b)
{
    struct light_bounds out = *a;
    out.min = glms_vec3_minv(a->min, b->min);
    out.max = glms_vec3_maxv(a->max, b->max);
    bound_by_sphere(&out, a, b);
    join_cones(&out, b);
    out.theta_e = fmax(a->theta_e, b->theta_e);
    out.power = a->power + b->power;
    out.two_sided = a->two_sided || b->two_sided;
    return out;
}

// An upper bound of the error, in radians, of an octahedral axis of 2 x 16 bits.
#define AXIS_RESOLUTION 2e-4

static struct gpu_light_bounds encode(const struct builder *b, const struct light_bounds *bounds,
                                      uint32_t child)
{
    struct gpu_light_bounds out = {.radius = bounds->radius, .child = child};
    float axis[3];
    for (int c = 0; c < 3; c++)
        axis[c] = (float)bounds->axis[c];
    memcpy(out.center, bounds->center.raw, sizeof out.center);
    out.axis = encode_normal(axis);
    double cos_o = cos(fmin(bounds->theta_o + AXIS_RESOLUTION, M_PI));
    double cos_e = cos(bounds->theta_e);
    // The cosines are rounded down, so that the cone becomes wider.
    uint32_t o = (uint32_t)floor((0.5 + 0.5 * cos_o) * LIGHT_COS_O_SCALE);
    uint32_t e = (uint32_t)floor((0.5 + 0.5 * cos_e) * LIGHT_COS_E_SCALE);
    out.cosines = o | e << 16 | (bounds->two_sided ? LIGHT_TWO_SIDED : 0u);
    out.power = (float)(bounds->power / b->total_power);
    return out;
}

// --- splitting -----------------------------------------------------------------------------------

static float middle(const struct light_bounds *bounds, int axis)
{
    return light_bounds_middle(bounds).raw[axis];
}

// Sums over one side of a split, from which its cost is computed.
struct part {
    vec3s min, max;
    double axis[3]; // sum of the axes
    double power, theta_o, theta_e;
    uint32_t count;
};

static struct part empty_part(void)
{
    struct part part = {.min = {{INFINITY, INFINITY, INFINITY}},
                        .max = {{-INFINITY, -INFINITY, -INFINITY}}};
    return part;
}

// Adds an item. The axis of a two-sided emitter is turned towards `reference`.
static void part_add(struct part *part, const struct light_bounds *bounds,
                     const double reference[3])
{
    bool flip = bounds->two_sided && vec3_dot(bounds->axis, reference) < 0.0;
    part->min = glms_vec3_minv(part->min, bounds->min);
    part->max = glms_vec3_maxv(part->max, bounds->max);
    for (int c = 0; c < 3; c++)
        part->axis[c] += flip ? -bounds->axis[c] : bounds->axis[c];
    part->power += bounds->power;
    part->theta_o = fmax(part->theta_o, bounds->theta_o);
    part->theta_e = fmax(part->theta_e, bounds->theta_e);
    part->count++;
}

static void part_join(struct part *a, const struct part *b)
{
    a->min = glms_vec3_minv(a->min, b->min);
    a->max = glms_vec3_maxv(a->max, b->max);
    for (int c = 0; c < 3; c++)
        a->axis[c] += b->axis[c];
    a->power += b->power;
    a->theta_o = fmax(a->theta_o, b->theta_o);
    a->theta_e = fmax(a->theta_e, b->theta_e);
    a->count += b->count;
}

// Returns the surface area of the box, plus a small part of its squared diagonal, so that items on
// a line have an area, too.
static double part_area(const struct part *part)
{
    double e[3];
    for (int c = 0; c < 3; c++)
        e[c] = (double)part->max.raw[c] - (double)part->min.raw[c];
    return 2.0 * (e[0] * e[1] + e[1] * e[2] + e[2] * e[0]) + 1e-3 * vec3_dot(e, e);
}

// Returns the measure of the directions in which the items may emit (Conty Estevez and Kulla 2018,
// section 4.4). The half-angle theta of their axes' cone is estimated from the length of the mean
// axis, which is (1 + cos theta) / 2 for axes distributed uniformly over the cone. Exact bounds
// would need another pass.
static double part_orientation(const struct part *part)
{
    double mean = vec3_norm(part->axis) / part->count;
    double spread = acos(fmax(-1.0, fmin(1.0, 2.0 * mean - 1.0)));
    double o = fmin(spread + part->theta_o, M_PI), w = fmin(o + part->theta_e, M_PI);
    return 2.0 * M_PI * (1.0 - cos(o)) +
           0.5 * M_PI * (2.0 * w * sin(o) - cos(o - 2.0 * w) - 2.0 * o * sin(o) + cos(o));
}

static double part_cost(const struct part *part)
{
    return part->count ? part->power * part_orientation(part) * part_area(part) : 0.0;
}

struct split {
    double cost;
    int axis;
    int position; // items in buckets below this one go to the left
};

static int bucket_count(const struct range *range)
{
    return range->count < FEW ? FEW_BUCKETS : BUCKETS;
}

static int bucket_of(float position, float low, float high, int count)
{
    float bucket = (float)count * ((position - low) / (high - low));
    return bucket >= (float)count ? count - 1 : (int)bucket;
}

// Finds the best split along one axis. `low` and `high` are the bounds of the items' middles, and
// differ.
static void try_axis(const struct range *range, int axis, float low, float high, double regularity,
                     struct split *best)
{
    struct part parts[BUCKETS], above[BUCKETS];
    const double *reference = bounds_at(range, 0)->axis;
    int count = bucket_count(range);
    for (int i = 0; i < count; i++)
        parts[i] = empty_part();
    uint32_t stride = (range->count + JUDGED - 1) / JUDGED;
    for (uint32_t i = 0; i < range->count; i += stride) {
        const struct light_bounds *bounds = bounds_at(range, i);
        part_add(&parts[bucket_of(middle(bounds, axis), low, high, count)], bounds, reference);
    }
    above[count - 1] = parts[count - 1];
    for (int i = count - 2; i > 0; i--) {
        above[i] = parts[i];
        part_join(&above[i], &above[i + 1]);
    }
    struct part below = empty_part();
    for (int i = 1; i < count; i++) {
        part_join(&below, &parts[i - 1]);
        if (below.count == 0 || above[i].count == 0)
            continue;
        double cost = regularity * (part_cost(&below) + part_cost(&above[i]));
        if (cost < best->cost)
            *best = (struct split){cost, axis, i};
    }
}

// Moves the items of the left buckets to the front; returns their number.
static uint32_t partition(const struct range *range, const struct split *split, float low,
                          float high)
{
    uint32_t *order = range->layer->order + range->first, left = 0;
    for (uint32_t i = 0; i < range->count; i++) {
        uint32_t moved = order[i];
        float position = middle(bounds_at(range, i), split->axis);
        if (bucket_of(position, low, high, bucket_count(range)) >= split->position)
            continue;
        order[i] = order[left];
        order[left++] = moved;
    }
    return left;
}

static uint32_t levels_needed(uint32_t count)
{
    return count > 1 ? 32u - (uint32_t)__builtin_clz(count - 1) : 0;
}

// Sorts a few items by their middles, in ascending order.
static void sort_few(const struct range *range, int axis)
{
    uint32_t *order = range->layer->order + range->first;
    for (uint32_t i = 1; i < range->count; i++)
        for (uint32_t j = i;
             j > 0 && middle(bounds_at(range, j), axis) < middle(bounds_at(range, j - 1), axis);
             j--) {
            uint32_t moved = order[j];
            order[j] = order[j - 1];
            order[j - 1] = moved;
        }
}

// Returns how many items of a range, which has at least 2, go to the left. Halves the range if it
// has few items, if no split is better, or if only as many bits of the trail are left as halving
// needs.
static uint32_t split_range(const struct range *range)
{
    uint32_t half = range->count / 2;
    uint32_t needed = levels_needed(range->count) + range->layer->below;
    if (range->count == 2 || needed >= DEPTH_MAX - range->depth)
        return half;
    vec3s low = {{INFINITY, INFINITY, INFINITY}}, high = {{-INFINITY, -INFINITY, -INFINITY}};
    for (uint32_t i = 0; i < range->count; i++) {
        vec3s position = light_bounds_middle(bounds_at(range, i));
        low = glms_vec3_minv(low, position);
        high = glms_vec3_maxv(high, position);
    }
    vec3s size = glms_vec3_sub(high, low);
    float longest = glms_vec3_max(size);
    if (range->count < HALVED) {
        int axis = longest > size.x ? longest > size.y ? 2 : 1 : 0;
        sort_few(range, axis);
        return half;
    }
    struct split best = {.cost = INFINITY};
    for (int c = 0; c < 3; c++)
        if (size.raw[c] > 0.0f && isfinite(size.raw[c]))
            try_axis(range, c, low.raw[c], high.raw[c], (double)(longest / size.raw[c]), &best);
    if (!isfinite(best.cost))
        return half;
    return partition(range, &best, low.raw[best.axis], high.raw[best.axis]);
}

// --- building ------------------------------------------------------------------------------------

static uint32_t child_word(const struct builder *b, const struct range *range)
{
    return range->leaves == 1 ? LIGHT_LEAF | b->primitives[range->layer->order[range->first]]
                              : range->node;
}

// Turns a range that consists of one lamp into the range of the lamp's emitters.
static struct range enter_lamp(const struct builder *b, const struct range *range)
{
    if (range->layer != &b->lamps || range->count > 1)
        return *range;
    struct range own = *range;
    uint32_t lamp = b->lamps.order[range->first];
    own.layer = &b->emitters;
    own.first = b->lamp_first[lamp];
    own.count = range->leaves;
    b->tree->lamps[lamp] = (struct gpu_lamp){.child = child_word(b, &own), .depth = own.depth};
    return own;
}

static uint32_t count_leaves(const struct builder *b, const struct range *range, uint32_t count)
{
    uint32_t leaves = 0;
    if (range->layer == &b->emitters)
        return count;
    for (uint32_t i = 0; i < count; i++) {
        uint32_t lamp = b->lamps.order[range->first + i];
        leaves += b->lamp_first[lamp + 1] - b->lamp_first[lamp];
    }
    return leaves;
}

// The pair of a subtree's root is followed by the pairs of the left subtree, then those of the
// right one. n emitters have n - 1 pairs.
static void split_children(const struct builder *b, const struct range *range, struct range out[2])
{
    uint32_t left = split_range(range), leaves = count_leaves(b, range, left);
    struct range half = *range;
    half.depth++;
    half.node++;
    half.count = left;
    half.leaves = leaves;
    out[0] = enter_lamp(b, &half);
    half.node = range->node + leaves;
    half.first += left;
    half.count = range->count - left;
    half.leaves = range->leaves - leaves;
    half.trail |= UINT64_C(1) << range->depth;
    out[1] = enter_lamp(b, &half);
}

static struct light_bounds set_pair(const struct builder *b, uint32_t node,
                                    const struct range children[2],
                                    const struct light_bounds bounds[2])
{
    for (int i = 0; i < 2; i++)
        b->tree->nodes[2 * (size_t)node + (size_t)i] =
            encode(b, &bounds[i], child_word(b, &children[i]));
    return join(&bounds[0], &bounds[1]);
}

// Small ranges are not worth polling for a stop.
static bool is_stopped(const struct builder *b, const struct range *range)
{
    return range->leaves > 1024 && progress_should_stop(b->progress);
}

static struct light_bounds build_range(const struct builder *b, const struct range *range)
{
    if (range->leaves == 1) {
        struct gpu_light_trail *trail = &b->tree->trails[range->layer->order[range->first]];
        trail->low = (uint32_t)range->trail;
        trail->high = (uint32_t)(range->trail >> 32);
        trail->depth = range->depth;
        return *bounds_at(range, 0);
    }
    struct range children[2];
    struct light_bounds bounds[2];
    if (is_stopped(b, range))
        return (struct light_bounds){0};
    split_children(b, range, children);
    for (int i = 0; i < 2; i++)
        bounds[i] = build_range(b, &children[i]);
    return set_pair(b, range->node, children, bounds);
}

// The upper part of a large tree: its pairs, parents first, and the subtrees below them, which are
// built in parallel.
struct upper {
    const struct builder *b;
    struct range pairs[TASKS_MAX][2];
    struct range roots[TASKS_MAX]; // indexed by pair
    struct range tasks[2 * TASKS_MAX];
    struct light_bounds task_bounds[2 * TASKS_MAX];
    uint32_t pair_count, task_count, largest;
};

static void list_tasks(struct upper *u, const struct range *range)
{
    if (range->leaves <= u->largest || u->pair_count == TASKS_MAX || is_stopped(u->b, range)) {
        u->tasks[u->task_count++] = *range;
        return;
    }
    uint32_t pair = u->pair_count++;
    u->roots[pair] = *range;
    split_children(u->b, range, u->pairs[pair]);
    for (int i = 0; i < 2; i++)
        list_tasks(u, &u->pairs[pair][i]);
}

static void run_tasks(void *context, size_t begin, size_t end, unsigned thread)
{
    struct upper *u = context;
    (void)thread;
    for (size_t i = begin; i < end; i++)
        u->task_bounds[i] = build_range(u->b, &u->tasks[i]);
}

// Joins the bounds of the subtrees, in the order of list_tasks().
static struct light_bounds join_tasks(const struct upper *u, const struct range *range,
                                      uint32_t *pair, uint32_t *task)
{
    bool is_pair = *pair < u->pair_count && u->roots[*pair].node == range->node &&
                   u->roots[*pair].leaves == range->leaves;
    if (!is_pair)
        return u->task_bounds[(*task)++];
    const struct range *children = u->pairs[(*pair)++];
    struct light_bounds bounds[2];
    for (int i = 0; i < 2; i++)
        bounds[i] = join_tasks(u, &children[i], pair, task);
    return set_pair(u->b, range->node, children, bounds);
}

static bool build(const struct builder *b, uint32_t lamp_count, uint32_t count, struct err *err)
{
    struct arena scratch = {0};
    struct upper *u = ARENA_NEW(&scratch, struct upper, 1);
    if (!u)
        return err_memory(err, "light tree", sizeof *u);
    struct range all = {.layer = &b->lamps, .count = lamp_count, .leaves = count};
    all = enter_lamp(b, &all);
    u->b = b;
    u->largest = count / TASK_PARTS > TASK_LEAVES ? count / TASK_PARTS : TASK_LEAVES;
    list_tasks(u, &all);
    parallel_for(u->task_count, 1, 0, run_tasks, u);
    uint32_t pair = 0, task = 0;
    join_tasks(u, &all, &pair, &task);
    b->tree->root = child_word(b, &all);
    arena_finish(&scratch);
    return true;
}

// Sorts the emitters by lamp. Returns the number of lamps that have emitters; `lamp_order` lists
// these lamps.
static uint32_t sort_by_lamps(const struct light_tree_params *p, uint32_t *first, uint32_t *order,
                              uint32_t *lamp_order)
{
    uint32_t used = 0, sum = 0;
    for (uint32_t i = 0; i < p->count; i++)
        first[p->lamps[i] + 1]++;
    for (uint32_t lamp = 0; lamp < p->lamp_count; lamp++) {
        uint32_t size = first[lamp + 1];
        if (size > 0)
            lamp_order[used++] = lamp;
        first[lamp + 1] = sum; // becomes the beginning of the next lamp
        sum += size;
    }
    for (uint32_t i = 0; i < p->count; i++)
        order[first[p->lamps[i] + 1]++] = i;
    return used;
}

static void bound_lamps(const struct light_tree_params *p, struct builder *b,
                        struct light_bounds *bounds)
{
    uint32_t largest = 1;
    for (uint32_t lamp = 0; lamp < p->lamp_count; lamp++) {
        uint32_t first = b->lamp_first[lamp], end = b->lamp_first[lamp + 1];
        for (uint32_t i = first; i < end; i++) {
            const struct light_bounds *own = &p->bounds[b->emitters.order[i]];
            bounds[lamp] = i == first ? *own : join(&bounds[lamp], own);
        }
        largest = end - first > largest ? end - first : largest;
    }
    b->lamps.bounds = bounds;
    b->lamps.below = levels_needed(largest);
}

static bool build_over_lamps(const struct light_tree_params *p, struct light_tree *out,
                             struct arena *scratch, struct err *err)
{
    uint32_t *first = ARENA_NEW(scratch, uint32_t, (size_t)p->lamp_count + 1);
    struct light_bounds *lamp_bounds = ARENA_NEW(scratch, struct light_bounds, p->lamp_count);
    struct builder b = {
        .lamps = {.order = ARENA_NEW(scratch, uint32_t, p->lamp_count)},
        .emitters = {.bounds = p->bounds, .order = ARENA_NEW(scratch, uint32_t, p->count)},
        .lamp_first = first,
        .primitives = p->primitives,
        .tree = out,
        .progress = p->progress,
    };
    if (!first || !lamp_bounds || !b.lamps.order || !b.emitters.order)
        return err_memory(err, "light tree", p->lamp_count * sizeof *lamp_bounds);
    for (uint32_t i = 0; i < p->count; i++) {
        b.total_power += p->bounds[i].power;
        out->trails[i].lamp = p->lamps[i];
    }
    for (uint32_t lamp = 0; lamp < p->lamp_count; lamp++)
        out->lamps[lamp] = (struct gpu_lamp){.child = LIGHT_LEAF, .depth = LIGHT_NOWHERE};
    uint32_t used = sort_by_lamps(p, first, b.emitters.order, b.lamps.order);
    bound_lamps(p, &b, lamp_bounds);
    return build(&b, used, p->count, err);
}

bool light_tree_build(const struct light_tree_params *p, struct arena *arena,
                      struct light_tree *out, struct err *err)
{
    struct arena scratch = {0};
    *out = (struct light_tree){
        .nodes = ARENA_NEW(arena, struct gpu_light_bounds, 2 * (size_t)p->count),
        .trails = ARENA_NEW(arena, struct gpu_light_trail, p->count),
        .lamps = ARENA_NEW(arena, struct gpu_lamp, p->lamp_count),
    };
    bool ok = out->nodes && out->trails && out->lamps;
    if (!ok)
        err_memory(err, "light tree", (uint64_t)p->count * 80);
    ok = ok && build_over_lamps(p, out, &scratch, err);
    if (ok && progress_should_stop(p->progress))
        ok = err_set(err, ERR_STOPPED, "stopped while building the light tree");
    arena_finish(&scratch);
    return ok;
}
