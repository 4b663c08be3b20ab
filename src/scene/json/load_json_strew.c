// Scattered copies of named shapes, such as trees or stones, on a disc or a rectangle.
#include "scene/json/load_json.h"

#include "scene/core/affine.h"
#include "scene/generate/scatter.h"
#include <math.h>
#include <string.h>

#define KINDS_MAX 64

struct strew {
    struct scene_part kinds[KINDS_MAX]; // the shapes that are copied
    uint32_t kind_count;
    uint32_t count, seed;
    double size[2]; // along x and z; for a disc, of its bounding square
    bool is_disc;
    double scale[2]; // minimum and maximum
    double tilt;     // tangent of half of the maximum angle
    uint32_t drawn;  // number of random numbers drawn for the current copy
};

// --- random numbers ------------------------------------------------------------------------------

// Returns the next random number of a copy, in [0, 1).
static double draw(struct strew *strew, uint32_t copy)
{
    return scatter_bits(strew->seed, copy, strew->drawn++) * 0x1p-32;
}

// Draws a direction in the plane, using only correctly rounded operations, so that it is the same
// on every machine.
static void draw_direction(struct strew *strew, uint32_t copy, double out[2])
{
    double square;
    do {
        for (int i = 0; i < 2; i++)
            out[i] = 2 * draw(strew, copy) - 1;
        square = out[0] * out[0] + out[1] * out[1];
    } while (!(square > 0.01 && square <= 1));
    for (int i = 0; i < 2; i++)
        out[i] /= sqrt(square);
}

// --- places --------------------------------------------------------------------------------------

// A low-discrepancy sequence by Roberts (2018, "The unreasonable effectiveness of quasirandom
// sequences"). Its steps are 1/p and 1/p^2 with the plastic number p; the multiples of these,
// modulo 1, are spread evenly for any count. Each position is moved at random by up to a fifth of
// the mean distance, so that no rows are visible.
static const double steps[2] = {0.7548776662466927, 0.5698402909980532};
#define MOVE 0.2

// Finds the next position at or after number *n of the sequence that lies in the area.
static void next_place(struct strew *strew, uint32_t copy, uint64_t *n, double out[2])
{
    const double spacing = sqrt(strew->size[0] * strew->size[1] / strew->count);
    bool inside = false;
    while (!inside) {
        double square = 0;
        for (int i = 0; i < 2; i++) {
            double at = scatter_bits(strew->seed, SCENE_NONE, (uint32_t)i) * 0x1p-32 +
                        (double)*n * steps[i];
            double move = spacing * MOVE * (2 * draw(strew, copy) - 1);
            double half = strew->size[i] / 2;
            out[i] = strew->size[i] * (at - floor(at)) - half;
            out[i] = fmin(fmax(out[i] + move, -half), half);
            square += (out[i] / half) * (out[i] / half);
        }
        (*n)++;
        inside = !strew->is_disc || square <= 1;
    }
}

// Makes a transform: scale, rotation about +y, a random tilt, translation.
static void make_transform(struct strew *strew, uint32_t copy, const double place[2],
                           double out[3][4])
{
    double turn[2], to[2];
    double scale = strew->scale[0] + draw(strew, copy) * (strew->scale[1] - strew->scale[0]);
    draw_direction(strew, copy, turn);
    const double upright[3][4] = {
        {scale * turn[0], 0, scale * turn[1], 0},
        {0, scale, 0, 0},
        {-scale * turn[1], 0, scale * turn[0], 0},
    };
    memcpy(out, upright, sizeof upright);
    if (strew->tilt > 0) {
        // For the tilt's angle a, tan(a/2) is uniform in its range. The tilt is towards the
        // direction `to`.
        double t = strew->tilt * draw(strew, copy);
        double cosine = (1 - t * t) / (1 + t * t), sine = 2 * t / (1 + t * t);
        draw_direction(strew, copy, to);
        double x = to[0], z = to[1], versine = 1 - cosine;
        const double tilted[3][4] = {
            {1 - versine * x * x, sine * x, -versine * x * z, 0},
            {-sine * x, cosine, -sine * z, 0},
            {-versine * x * z, sine * z, 1 - versine * z * z, 0},
        };
        affine_multiply(tilted, out, out);
    }
    out[0][3] = place[0];
    out[2][3] = place[1];
}

// --- copies --------------------------------------------------------------------------------------

// Appends a copy, for which memory has been reserved.
static bool add_copy(struct scene *scene, const struct scene_part *part, const double m[3][4],
                     const struct json_node *node, struct err *err)
{
    for (uint32_t i = 0; i < part->instance_count; i++) {
        struct instance *copy = scene_add_instance(scene, NULL);
        *copy = scene->instances[part->first_instance + i];
        affine_multiply(m, copy->transform, copy->transform);
    }
    for (uint32_t i = 0; i < part->shape_count; i++) {
        struct shape *copy = scene_add_shape(scene, NULL);
        *copy = scene->shapes[part->first_shape + i];
        if (!load_json_move_shape(node, m, copy, err))
            return false;
    }
    return true;
}

static bool add_copies(const struct json_loader *loader, struct strew *strew,
                       const struct json_node *node, struct err *err)
{
    uint64_t n = 0, added = 0;
    for (uint32_t copy = 0; copy < strew->count; copy++) {
        double place[2], m[3][4];
        strew->drawn = 0;
        uint32_t kind = (uint32_t)(draw(strew, copy) * strew->kind_count);
        next_place(strew, copy, &n, place);
        make_transform(strew, copy, place, m);
        if (!add_copy(loader->scene, &strew->kinds[kind], m, node, err))
            return false;
        added += strew->kinds[kind].instance_count + strew->kinds[kind].shape_count;
        if (added >= 65536 || copy % 65536 == 0) {
            added = 0;
            if (!scene_goes_on(loader->scene, 0, err))
                return false;
        }
    }
    return true;
}

// --- reading -------------------------------------------------------------------------------------

static bool read_kinds(const struct json_loader *loader, const struct json_node *node,
                       const struct scene_part *parts, struct strew *strew, struct err *err)
{
    const struct json_node of = node_member(node, "of");
    bool is_list = json_is_array(of.value);
    if (is_list && !node_check_array(&of, 1, KINDS_MAX, err))
        return false;
    strew->kind_count = is_list ? (uint32_t)json_array_size(of.value) : 1;
    for (uint32_t i = 0; i < strew->kind_count; i++) {
        const struct json_node element = is_list ? node_element(&of, i) : of;
        if (!load_json_find_part(loader, &element, parts, &strew->kinds[i], err))
            return false;
    }
    return true;
}

// Reserves all memory once, because ten million instances take a gigabyte.
static bool reserve(struct scene *scene, const struct strew *strew, const struct json_node *node,
                    struct err *err)
{
    uint64_t instances = 0, shapes = 0;
    for (uint32_t i = 0; i < strew->kind_count; i++) {
        const struct scene_part *kind = &strew->kinds[i];
        instances = kind->instance_count > instances ? kind->instance_count : instances;
        shapes = kind->shape_count > shapes ? kind->shape_count : shapes;
    }
    const struct json_node count = node_member(node, "count");
    if (strew->count * (instances + shapes) > STREW_COUNT_MAX)
        return node_fail(&count, err,
                         "%u copies of up to %llu instances and %llu shapes; expected at most %u "
                         "in all",
                         strew->count, (unsigned long long)instances, (unsigned long long)shapes,
                         STREW_COUNT_MAX);
    if (scene_reserve_instances(scene, strew->count * instances) &&
        scene_reserve_shapes(scene, strew->count * shapes))
        return true;
    err_memory(err, "the copies",
               strew->count *
                   (instances * sizeof(struct instance) + shapes * sizeof(struct shape)));
    return node_prepend(node, err);
}

static bool read_area(const struct json_node *node, struct strew *strew, struct err *err)
{
    const struct json_node size = node_member(node, "size");
    double radius = 0;
    strew->is_disc = node_member(node, "disc_radius").value != NULL;
    if (strew->is_disc == (size.value != NULL))
        return node_fail(node, err, "expected either \"disc_radius\" or \"size\"");
    if (!strew->is_disc)
        return node_numbers(&size, 2, RANGE_RADIUS, strew->size, err);
    if (!node_read_number(node, "disc_radius", RANGE_RADIUS, &radius, err))
        return false;
    strew->size[0] = strew->size[1] = 2 * radius;
    return true;
}

bool load_json_strew(struct json_loader *loader, const struct json_node *node,
                     const struct scene_part *parts, struct err *err)
{
    const struct range angles = {0, 90, false};
    struct strew strew = {.scale = {1, 1}};
    uint64_t count = 0, seed = 1;
    double tilt = 0;
    if (!node_read_integer(node, "count", 1, STREW_COUNT_MAX, &count, err) ||
        !node_read_integer(node, "seed", 0, UINT32_MAX, &seed, err) ||
        !read_area(node, &strew, err) ||
        !node_read_pair(node, "scale", RANGE_RADIUS, strew.scale, err) ||
        !node_read_number(node, "tilt_degrees", angles, &tilt, err) ||
        !read_kinds(loader, node, parts, &strew, err))
        return false;
    strew.count = (uint32_t)count;
    strew.seed = (uint32_t)seed;
    strew.tilt = tan(tilt * (M_PI / 360));
    return reserve(loader->scene, &strew, node, err) && add_copies(loader, &strew, node, err);
}
