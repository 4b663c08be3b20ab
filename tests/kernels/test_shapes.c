// Tests analytic shapes on the device against double precision: where rays hit them, the accuracy
// of the hit points, and what rays that start there hit.
//
// Within its rounding errors, single precision may decide either way. A result is correct if it is
// that of the shape, or of the shape enlarged or shrunk by some rounding errors of the coordinates.
// If these do not agree, rounding may have decided. Any other result is an error, and the number of
// decisions by rounding is bounded.
#include "library_fixture.h"
#include "shape_reference.h"
#include "shape_routines.h"

#include "shapes_test.spv.h"

// The greatest relative error of an operation on this device, as in lib/constants.glsl.
static double rounding;
#define ROUNDING rounding

enum {
    SHAPES = 126, // a third for each of three kinds of sizes
    RAYS = 1024,  // rays per shape
    ITEMS = SHAPES * RAYS,
    MODES = 8, // kinds of rays
};

static const struct routine leave = {shapes_spirv, sizeof shapes_spirv, ROUTINE_LEAVE_SHAPE};
static union words items[ITEMS], results[ITEMS];

// --- scenes and rays -----------------------------------------------------------------------------

static double random_magnitude(struct random *random)
{
    return pow(10, random_between(random, -8, 8));
}

// In alternation, shapes of about a metre near the origin, the same elongated by up to 1e6 : 1, and
// sizes and places from 1e-8 to 1e8.
static void add_worlds(struct scene *scene, uint32_t kind, struct random *random)
{
    for (uint32_t i = 0; i < SHAPES; i++) {
        double center[3], size = pow(10, random_between(random, -1, 0));
        for (int c = 0; c < 3; c++)
            center[c] = random_between(random, -1, 1) * (i % 3 == 2 ? random_magnitude(random) : 1);
        if (i % 3 == 2)
            size = random_magnitude(random);
        add_random_shape(scene, kind, center, size, i % 3 == 1 ? 1e6 : 4, i % 4 == 0, random);
    }
}

static double random_sign(struct random *random)
{
    return random_u32(random) & 1u ? 1 : -1;
}

static void vector_to_float(const double v[3], double scale, float out[3])
{
    for (int c = 0; c < 3; c++)
        out[c] = (float)(v[c] * scale);
}

static void random_tangent(const double normal[3], struct random *random, double out[3])
{
    float other[3];
    double v[3];
    random_direction(random, other);
    for (int c = 0; c < 3; c++)
        v[c] = (double)other[c];
    vec3_cross(normal, v, out);
    double norm = vec3_norm(out);
    for (int c = 0; c < 3; c++)
        out[c] /= norm;
}

// Makes ray number `n` to a shape: from near and from far, from inside, at edges, along faces, and
// along the axes of the shape and of the world.
static void random_ray(const struct exact_shape *shape, uint32_t n, struct random *random,
                       float origin[3], float direction[3])
{
    uint32_t mode = n % MODES;
    double target[3], normal[3], away[3], size = exact_size(shape);
    float offset[3];
    exact_point(shape, random, mode == 2 || mode == 3, target, normal);
    random_direction(random, offset);
    double reach = size * pow(10, mode == 3 || mode == 6 ? random_between(random, 2, 4)
                                                         : random_between(random, -2, 1));
    for (int c = 0; c < 3; c++)
        away[c] = (double)offset[c];
    if (mode == 4)
        random_tangent(normal, random, away);
    if (mode == 5)
        memcpy(away, shape->axis[shape->kind == SHAPE_PLANE || shape->kind == SHAPE_DISC ? 2 : 0],
               sizeof away);
    if (mode == 7) {
        memset(away, 0, sizeof away);
        away[n / MODES % 3] = random_sign(random);
    }
    for (int c = 0; c < 3; c++) {
        double inside =
            shape->center[c] + 0.9 * random_unit(random) * (target[c] - shape->center[c]);
        origin[c] = (float)(mode == 1 ? inside : target[c] + reach * away[c]);
    }
    double to_target[3], norm;
    for (int c = 0; c < 3; c++)
        to_target[c] =
            mode == 4 || mode == 5 || mode == 7 ? -away[c] : target[c] - (double)origin[c];
    norm = vec3_norm(to_target);
    vector_to_float(to_target, norm > 0 ? 1 / norm : 0, direction);
    if (!(norm > 0))
        direction[0] = 1;
}

// Any direction, or one that hardly leaves the surface that the ray may have hit.
static void random_next(const struct exact_shape *shape, uint32_t n, struct random *random,
                        float next[3])
{
    double point[3], normal[3], tangent[3];
    random_direction(random, next);
    if (n % 3 != 0)
        return;
    exact_point(shape, random, false, point, normal);
    random_tangent(normal, random, tangent);
    double tilt = random_sign(random) * pow(10, random_between(random, -10, -3));
    for (int c = 0; c < 3; c++)
        next[c] = (float)(tangent[c] + tilt * normal[c]);
}

static void fill_items(const struct flat_scene *flat, struct random *random)
{
    for (uint32_t i = 0; i < ITEMS; i++) {
        struct exact_shape shape = exact_shape(&flat->shapes[i % SHAPES], 0, 0);
        random_ray(&shape, i / SHAPES, random, items[i].f[0], items[i].f[1]);
        items[i].u[0][3] = i % SHAPES;
        random_next(&shape, i / SHAPES, random, items[i].f[2]);
    }
    memcpy(results, items, sizeof items);
}

// --- judging -------------------------------------------------------------------------------------

// A shape, and the same enlarged and shrunk by the possible rounding errors.
enum { VARIANTS = 9 };
struct sizes {
    struct exact_shape shape[VARIANTS];
    double tolerance;
    bool is_along; // the ray lies in a plane of the shape, so that any result is possible
};

static bool is_flat(uint32_t kind)
{
    return kind == SHAPE_DISC || kind == SHAPE_PLANE || kind == SHAPE_QUAD;
}

static double largest(const double v[3])
{
    return fmax(fabs(v[0]), fmax(fabs(v[1]), fabs(v[2])));
}

// With double-float arithmetic, only errors beyond those of the ray itself count. If a ray hits a
// plane at a small angle, its edges are as uncertain as the place.
static struct sizes sizes_of(const struct flat_shape *flat, const double origin[3],
                             const double d[3], double roundings, bool large)
{
    struct sizes s = {.shape = {exact_shape(flat, 0, 0)}};
    double reach = largest(origin) + largest(s.shape[0].center) + exact_size(&s.shape[0]);
    s.tolerance = reach * (large ? 0x1p-42 : roundings * ROUNDING);
    double grown = s.tolerance;
    if (is_flat(flat->kind)) {
        double slope = fabs(vec3_dot(s.shape[0].axis[2], d));
        s.is_along = slope <= 16 * ROUNDING;
        grown /= fmax(slope, ROUNDING);
    }
    // Along an open cylinder, the place of its end is as uncertain as its radius there.
    double across = 1;
    if (flat->kind == SHAPE_TUBE) {
        double along = vec3_dot(s.shape[0].axis[0], d);
        across = sqrt(fmax(vec3_dot(d, d) - along * along, ROUNDING));
    }
    for (int i = 1; i < VARIANTS; i++)
        s.shape[i] = exact_shape(flat, grown * (i % 3 - 1), s.tolerance * 2 / across * (i / 3 - 1));
    s.shape[4] = exact_shape(flat, -grown, -s.tolerance * 2 / across); // the place of the ends
    return s;
}

// Returns whether the result depends only on whether a ray that runs along the side of an open
// cylinder is inside or outside of it.
static bool grazes_tube(const struct sizes *sizes, const double origin[3], const double d[3])
{
    int hits = 0;
    for (int i = 0; i < VARIANTS; i++) {
        struct exact_shape closed = sizes->shape[i];
        double t[2];
        closed.kind = SHAPE_CYLINDER;
        hits += closed.radius > 0 && exact_crossings(&closed, origin, d, t) > 0;
    }
    return sizes->shape[0].kind == SHAPE_TUBE && hits != 0 && hits != VARIANTS;
}

// The first crossing ahead or, for a ray that starts on the shape, the last one; negative: none.
struct range {
    double low, high;
    bool sure_hit, sure_miss;
};

static struct range expected(const struct sizes *sizes, const double origin[3], const double d[3],
                             bool last)
{
    bool unsure = sizes->is_along || grazes_tube(sizes, origin, d);
    struct range r = {INFINITY, -INFINITY, !unsure, !unsure};
    for (int i = 0; i < VARIANTS; i++) {
        double t[2];
        int count = exact_crossings(&sizes->shape[i], origin, d, t);
        double found = -1;
        for (int k = 0; k < count; k++)
            if (t[k] > 0 && (found < 0 || last))
                found = t[k];
        r.sure_hit = r.sure_hit && found > 0;
        r.sure_miss = r.sure_miss && !(found > 0);
        r.low = found > 0 ? fmin(r.low, found) : r.low;
        r.high = fmax(r.high, found);
    }
    return r;
}

enum verdict { RIGHT, ROUNDED, WRONG };

static enum verdict judge(const struct range *r, double t, double slack)
{
    bool hit = t > 0;
    if (hit ? r->sure_miss : r->sure_hit)
        return WRONG;
    if (!hit || !r->sure_hit)
        return hit == !r->sure_miss && hit == r->sure_hit ? RIGHT : ROUNDED;
    double margin = slack + 2 * (r->high - r->low) + 16 * ROUNDING * r->high;
    return t >= r->low - margin && t <= r->high + margin ? RIGHT : WRONG;
}

// --- a kind --------------------------------------------------------------------------------------

struct tally {
    uint32_t hits, rounded, wrong;         // for rays from anywhere
    uint32_t loose, beyond;                // reported errors of points that are too large, or too
                                           // small
    uint32_t wrong_side, met_again;        // for rays that leave the shape
    uint32_t far_found, far_rounded, lost; // for rays that enter it
    uint32_t plain, plain_rounded;         // shapes and rays without special difficulty
    bool is_shown;                         // a wrong ray was printed
};

static void to_double(const float v[3], double out[3])
{
    for (int c = 0; c < 3; c++)
        out[c] = (double)v[c];
}

static double dot_absolute(const double n[3], const double v[3])
{
    return fabs(n[0]) * fabs(v[0]) + fabs(n[1]) * fabs(v[1]) + fabs(n[2]) * fabs(v[2]);
}

static double smallest_size(const struct exact_shape *shape)
{
    double size = INFINITY;
    for (int k = 0; k < 3; k++)
        size = shape->half[k] > 0 ? fmin(size, shape->half[k]) : size;
    return shape->kind == SHAPE_BOX ? size : fmin(size, shape->radius);
}

// Checks the ray that left the hit point of item i.
static void check_leaving(const struct flat_shape *flat, uint32_t i, bool large,
                          struct tally *tally)
{
    const union words *in = &items[i], *out = &results[i];
    double position[3], error[3], normal[3], from[3], next[3];
    to_double(out->f[0], position);
    to_double(out->f[1], error);
    to_double(out->f[2], normal);
    to_double(out->f[3], from);
    to_double(in->f[2], next);
    struct sizes sizes = sizes_of(flat, from, next, 96, false);
    const struct exact_shape *shape = &sizes.shape[0];
    int at = (int)out->f[2][3];
    double bound = dot_absolute(normal, error), t = (double)out->f[1][3];
    double reach = dot_absolute(normal, position) + dot_absolute(normal, shape->center);
    tally->beyond += !(fabs(exact_height(shape, position, at)) <= bound);
    tally->loose += !(bound <= (large ? 4 * ROUNDING * reach + 0x1p-18 * ROUNDING * shape->radius
                                      : 32 * ROUNDING * (reach + exact_size(shape)))) &&
                    !(large && bound < 17 * ROUNDING * shape->radius);
    // The side is decided as in offset_origin().
    double side = 0;
    for (int c = 0; c < 3; c++)
        side += next[c] * normal[c];
    bool unsure = fabs(side) <= 4 * ROUNDING;
    double height = exact_height(shape, from, at);
    if (unsure)
        side = height;
    // If rounding errors are as large as the shape, there is no inside.
    bool has_inside = sizes.tolerance < smallest_size(shape);
    tally->wrong_side += !(height * side > 0) && (side > 0 || has_inside);
    if (is_flat(flat->kind) || side > 0) {
        tally->met_again += t > 0;
        return;
    }
    struct range range = expected(&sizes, from, next, true);
    enum verdict verdict = judge(&range, t, sizes.tolerance);
    tally->far_found += verdict == RIGHT && t > 0;
    tally->far_rounded += verdict == ROUNDED;
    tally->lost += verdict == WRONG;
}

static void check_item(const struct flat_scene *flat, uint32_t i, bool large, struct tally *tally)
{
    const struct flat_shape *shape = &flat->shapes[i % SHAPES];
    double origin[3], d[3], normal[3], t = (double)results[i].f[0][3];
    struct tally before = *tally;
    to_double(items[i].f[0], origin);
    to_double(items[i].f[1], d);
    to_double(results[i].f[2], normal);
    struct sizes sizes = sizes_of(shape, origin, d, 48, large);
    struct range range = expected(&sizes, origin, d, false);
    double slope = fmax(fabs(vec3_dot(normal, d)), ROUNDING);
    enum verdict verdict = judge(&range, t, (sizes.tolerance + 8 * ROUNDING * fabs(t)) / slope);
    tally->hits += t > 0;
    tally->rounded += verdict == ROUNDED;
    tally->wrong += verdict == WRONG;
    uint32_t mode = i / SHAPES % MODES;
    bool is_plain = i % SHAPES % 3 == 0 && mode == 0;
    tally->plain += is_plain;
    tally->plain_rounded += is_plain && verdict == ROUNDED;
    if (t > 0)
        check_leaving(shape, i, large, tally);
    bool bad = tally->wrong + tally->beyond + tally->loose + tally->wrong_side + tally->met_again +
                   tally->lost >
               before.wrong + before.beyond + before.loose + before.wrong_side + before.met_again +
                   before.lost;
    if (bad && !tally->is_shown) {
        tally->is_shown = true;
        fprintf(stderr, "  shape %u, mode %u: origin %a %a %a, direction %a %a %a: t %g, expected ",
                i % SHAPES, i / SHAPES % MODES, origin[0], origin[1], origin[2], d[0], d[1], d[2],
                t);
        fprintf(stderr, range.sure_miss ? "none\n" : "%g to %g\n", range.low, range.high);
    }
}

static void check_kind(const char *name, uint32_t kind, bool large)
{
    struct setup setup;
    struct random random = {41 + kind};
    struct tally tally = {0};
    scene_start(&setup.scene, 8, 8);
    add_worlds(&setup.scene, kind, &random);
    OPEN_SETUP(&setup, LIBRARY_SLOTS);
    rounding = setup.gpu.rounds_to_nearest ? 0x1p-24 : 0x1p-23;
    uint32_t *geometry = &setup.r.specialization.geometry;
    *geometry = large ? *geometry | GEOMETRY_LARGE_SPHERES : *geometry & ~GEOMETRY_LARGE_SPHERES;
    fill_items(&setup.r.flat, &random);
    REQUIRE(routine_run(&setup, &leave, results, ITEMS), "not run");
    for (uint32_t i = 0; i < ITEMS; i++)
        check_item(&setup.r.flat, i, large, &tally);
    printf("  %-13s %6u hits, %5u rounded, %3u of %u plain ones; %6u far sides, %5u rounded\n",
           name, tally.hits, tally.rounded, tally.plain_rounded, tally.plain, tally.far_found,
           tally.far_rounded);
    CHECK(tally.plain_rounded <= tally.plain / 100, "%s: %u of %u plain rays", name,
          tally.plain_rounded, tally.plain);
    CHECK(tally.wrong == 0, "%s: %u rays meet it elsewhere", name, tally.wrong);
    CHECK(tally.beyond == 0, "%s: %u points are off by more than their bounds", name, tally.beyond);
    CHECK(tally.loose == 0, "%s: %u points have loose bounds", name, tally.loose);
    CHECK(tally.wrong_side == 0, "%s: %u rays start on the wrong side", name, tally.wrong_side);
    CHECK(tally.met_again == 0, "%s: %u rays meet what they leave", name, tally.met_again);
    CHECK(tally.lost == 0, "%s: %u rays miss the far side", name, tally.lost);
    CHECK(tally.hits > ITEMS / 8, "%s: %u hits test little", name, tally.hits);
    setup_close(&setup);
}

TEST(spheres)
{
    check_kind("spheres", SHAPE_SPHERE, false);
    check_kind("large spheres", SHAPE_SPHERE, true);
}

TEST(discs)
{
    check_kind("discs", SHAPE_DISC, false);
}

TEST(planes)
{
    check_kind("planes", SHAPE_PLANE, false);
}

TEST(quads)
{
    check_kind("quads", SHAPE_QUAD, false);
}

TEST(boxes)
{
    check_kind("boxes", SHAPE_BOX, false);
}

TEST(cylinders)
{
    check_kind("cylinders", SHAPE_CYLINDER, false);
}

TEST(tubes)
{
    check_kind("tubes", SHAPE_TUBE, false);
}

TEST_MAIN(TEST_CASE(spheres), TEST_CASE(discs), TEST_CASE(planes), TEST_CASE(quads),
          TEST_CASE(boxes), TEST_CASE(cylinders), TEST_CASE(tubes))
