// Tests the points that next-event estimation chooses on quads, boxes, cylinders and open
// cylinders: uniform by solid angle on quads that subtend enough of it, by area on the visible
// parts of boxes and cylinders, and on all of the others. The density must be the stated one, which
// hits know as well, and the shape must not occlude the point itself.
#include "library_fixture.h"
#include "shape_reference.h"
#include "shape_routines.h"
#include "solid_angle_reference.h"

#include "shapes_test.spv.h"

enum {
    SAMPLES = 1 << 16, // samples per place
    GRID = 12,         // cells per face along each axis
    FACES = 6,
};

static const struct routine aim_at_shape = {shapes_spirv, sizeof shapes_spirv,
                                            ROUTINE_AIM_AT_SHAPE};
static union words items[SAMPLES], results[SAMPLES];

static double face_area(const struct exact_shape *s, int face)
{
    double normal[3];
    switch (s->kind) {
    case SHAPE_QUAD:
        vec3_cross(s->axis[0], s->axis[1], normal);
        return face == 0 ? 4 * s->half[0] * s->half[1] * vec3_norm(normal) : 0;
    case SHAPE_BOX:
        return 4 * s->half[(face / 2 + 1) % 3] * s->half[(face / 2 + 2) % 3];
    default:
        if (face > 2 || (face > 0 && s->kind == SHAPE_TUBE))
            return 0;
        return face == 0 ? 4 * M_PI * s->radius * s->half[0] : M_PI * s->radius * s->radius;
    }
}

static double whole_area(const struct exact_shape *s)
{
    double area = 0;
    for (int face = 0; face < FACES; face++)
        area += face_area(s, face);
    return area;
}

// The faces of a shape on which points are sampled, as seen from one place.
struct aim {
    double area[FACES]; // areas of these faces
    double whole;       // sum of these areas
    double axis[3];     // axis of a cylinder
    double across[2][3]; // two directions across it; the first one is on the visible side
    double arc;          // half of the visible angle about the axis
    double solid_angle;  // solid angle of a quad whose points are chosen by solid angle; otherwise
                         // 0
};

// Returns the solid angle of the part of a quad from x[0] to x[1] and y[0] to y[1], which are in -1
// ... 1 along its edges, from the place `f` relative to its centre.
static double part_solid_angle(const struct exact_shape *s, const double f[3], const double x[2],
                               const double y[2])
{
    double corners[4][3], half[2][3][3];
    for (int i = 0; i < 4; i++) {
        double along[2] = {x[i == 1 || i == 2] * s->half[0], y[i >= 2] * s->half[1]};
        for (int c = 0; c < 3; c++)
            corners[i][c] = along[0] * s->axis[0][c] + along[1] * s->axis[1][c] - f[c];
    }
    for (int i = 0; i < 3; i++) {
        memcpy(half[0][i], corners[i], sizeof corners[i]);
        memcpy(half[1][i], corners[(i + 2) % 4], sizeof corners[i]);
    }
    return exact_solid_angle(half[0]) + exact_solid_angle(half[1]);
}

// Computes directions across a cylinder's axis, the first one towards the place `f` relative to its
// centre.
static double directions_across(const struct exact_shape *s, const double f[3], double across[2][3])
{
    double along = vec3_dot(f, s->axis[0]), away;
    for (int c = 0; c < 3; c++)
        across[0][c] = f[c] - along * s->axis[0][c];
    away = vec3_norm(across[0]);
    for (int c = 0; c < 3; c++)
        across[0][c] /= away;
    vec3_cross(s->axis[0], across[0], across[1]);
    return away;
}

static struct aim aim_from(const struct exact_shape *s, const double f[3])
{
    struct aim aim = {.arc = M_PI};
    bool sees[FACES] = {false}, sees_any = false;
    if (s->kind == SHAPE_BOX)
        for (int face = 0; face < FACES; face++)
            sees[face] = (face % 2 ? -1 : 1) * vec3_dot(f, s->axis[face / 2]) > s->half[face / 2];
    if (s->kind == SHAPE_CYLINDER || s->kind == SHAPE_TUBE) {
        double away = directions_across(s, f, aim.across), along = vec3_dot(f, s->axis[0]);
        sees[0] = s->kind == SHAPE_CYLINDER && away > s->radius;
        sees[1] = s->kind == SHAPE_CYLINDER && along > s->half[0];
        sees[2] = s->kind == SHAPE_CYLINDER && along < -s->half[0];
        aim.arc = sees[0] ? acos(s->radius / away) : M_PI;
    }
    if (s->kind == SHAPE_QUAD) {
        const double all[2] = {-1, 1};
        aim.solid_angle = part_solid_angle(s, f, all, all);
        aim.solid_angle *= is_chosen_by_solid_angle(aim.solid_angle);
    }
    for (int face = 0; face < FACES; face++)
        sees_any = sees_any || sees[face];
    for (int face = 0; face < FACES; face++) {
        aim.area[face] = sees_any && !sees[face] ? 0 : face_area(s, face);
        aim.area[face] *= face == 0 ? aim.arc / M_PI : 1;
        aim.whole += aim.area[face];
    }
    return aim;
}

// Computes the place of a point on its face: two numbers from 0 to 1, uniform by area. `at` is as
// in hit records.
static int place_on_face(const struct exact_shape *s, const struct aim *aim, const double f[3],
                         int at, double place[2])
{
    double u[3], v[3];
    switch (s->kind) {
    case SHAPE_QUAD:
        // Coordinates along the edges, which may have any angle.
        vec3_cross(s->axis[2], s->axis[1], u);
        vec3_cross(s->axis[2], s->axis[0], v);
        place[0] = 0.5 + vec3_dot(f, u) / vec3_dot(s->axis[0], u) / s->half[0] / 2;
        place[1] = 0.5 + vec3_dot(f, v) / vec3_dot(s->axis[1], v) / s->half[1] / 2;
        return 0;
    case SHAPE_BOX: {
        int k = abs(at) - 1;
        for (int i = 0; i < 2; i++) {
            int axis = (k + 1 + i) % 3;
            place[i] = 0.5 + vec3_dot(f, s->axis[axis]) / s->half[axis] / 2;
        }
        return 2 * k + (at < 0);
    }
    default:
        u[0] = vec3_dot(f, aim->across[0]);
        u[1] = vec3_dot(f, aim->across[1]);
        place[0] = 0.5 + 0.5 * atan2(u[1], u[0]) / (at ? M_PI : aim->arc);
        place[1] = at ? (u[0] * u[0] + u[1] * u[1]) / (s->radius * s->radius)
                      : 0.5 + vec3_dot(f, s->axis[0]) / s->half[0] / 2;
        return at == 0 ? 0 : at > 0 ? 1 : 2;
    }
}

static int cell_of(double place)
{
    int cell = (int)(place * GRID);
    return cell < 0 ? 0 : cell >= GRID ? GRID - 1 : cell;
}

// --- a place -------------------------------------------------------------------------------------

struct tally {
    uint32_t count[FACES][GRID][GRID];
    uint32_t off, beyond, wrong_density, disagree, wrongly_hidden, wrongly_seen, hidden;
};

// `pick` is the probability of choosing the shape.
static void check_sample(const struct exact_shape *s, const struct aim *aim, double pick,
                         const union words *out, const double origin[3], struct tally *tally)
{
    double f[3], to_light[3], point[3], normal[3], t[2], place[2];
    for (int c = 0; c < 3; c++) {
        to_light[c] = (double)out->f[0][c];
        point[c] = origin[c] + to_light[c];
        f[c] = point[c] - s->center[c];
        normal[c] = (double)out->f[1][c];
    }
    int at = (int)out->f[1][3], face = place_on_face(s, aim, f, at, place);
    tally->count[face][cell_of(place[0])][cell_of(place[1])]++;
    double beyond = fmax(fabs(place[0] - 0.5), fabs(place[1] - 0.5)) - 0.5;
    tally->beyond += !(beyond < 1e-5 + 1e-6 * vec3_norm(origin));
    tally->off += !(fabs(exact_height(s, point, at)) < 1e-6 * (vec3_norm(origin) + exact_size(s)));

    double distance = vec3_norm(to_light), slope = fabs(vec3_dot(to_light, normal)) / distance;
    double pdf = (double)out->f[0][3], pdf_of_hit = (double)out->f[2][0];
    double expected = pick * distance * distance / (slope * aim->whole);
    if (aim->solid_angle > 0)
        expected = pick / aim->solid_angle;
    bool may_hide = s->kind == SHAPE_TUBE;
    int crossings = exact_crossings(s, origin, to_light, t);
    bool in_between = false;
    for (int i = 0; i < crossings; i++)
        in_between = in_between || (t[i] > 0 && t[i] < 1 - 1e-3);
    tally->hidden += pdf == 0;
    // Seen edge-on, both results are possible.
    if (slope < 1e-2)
        return;
    tally->wrongly_seen += s->kind != SHAPE_QUAD && in_between && pdf > 0;
    tally->wrongly_hidden += !(may_hide && in_between) && pdf == 0 &&
                             !(may_hide && crossings == 2 && fabs(t[1] - t[0]) < 1e-2);
    // Nearby, the rounding errors of both places matter; far away, those of a side's normal.
    double rounding = 1e-6 * (vec3_norm(origin) + exact_size(s));
    double tolerance = 1e-4 + rounding / (slope * fmin(distance, s->radius > 0 ? s->radius : 1));
    tally->wrong_density += pdf > 0 && fabs(pdf / expected - 1) > tolerance;
    tally->disagree += pdf > 0 && fabs(pdf_of_hit / pdf - 1) > tolerance;
}

// Returns the probability of a cell of a face.
static double cell_probability(const struct exact_shape *s, const struct aim *aim,
                               const double f[3], int face, int cell)
{
    if (!(aim->solid_angle > 0))
        return aim->area[face] / aim->whole / (GRID * GRID);
    if (face > 0)
        return 0;
    double x = 2.0 * (cell / GRID) / GRID - 1, y = 2.0 * (cell % GRID) / GRID - 1;
    return part_solid_angle(s, f, (double[2]){x, x + 2.0 / GRID}, (double[2]){y, y + 2.0 / GRID}) /
           aim->solid_angle;
}

// Pearson's statistic as a standard normal deviate (Wilson and Hilferty 1931).
static double deviate(const struct exact_shape *s, const struct aim *aim, const double f[3],
                      const struct tally *tally)
{
    double statistic = 0, cells = 0;
    for (int face = 0; face < FACES; face++) {
        for (int i = 0; i < GRID * GRID; i++) {
            double expected = SAMPLES * cell_probability(s, aim, f, face, i);
            double difference = tally->count[face][i / GRID][i % GRID] - expected;
            if (expected > 0)
                statistic += difference * difference / expected;
            else
                CHECK(tally->count[face][i / GRID][i % GRID] == 0, "points on face %d", face);
            cells += expected > 0;
        }
    }
    double spread = 2 / (9 * (cells - 1));
    return (cbrt(statistic / (cells - 1)) - (1 - spread)) / sqrt(spread);
}

static void check_place(struct setup *setup, const char *name, const double from_center[3],
                        double pick, struct random *random)
{
    struct exact_shape shape = exact_shape(&setup->r.flat.shapes[0], 0, 0);
    static struct tally tally;
    double origin[3], f[3];
    memset(&tally, 0, sizeof tally);
    for (uint32_t i = 0; i < SAMPLES; i++) {
        memset(&items[i], 0, sizeof items[i]);
        for (int c = 0; c < 3; c++)
            items[i].f[0][c] = (float)(shape.center[c] + from_center[c]);
        for (int c = 0; c < 2; c++)
            items[i].f[1][c] = (float)(random_u32(random) >> 8) * 0x1p-24f;
    }
    for (int c = 0; c < 3; c++) {
        origin[c] = (double)items[0].f[0][c];
        f[c] = origin[c] - shape.center[c];
    }
    struct aim aim = aim_from(&shape, f);
    memcpy(results, items, sizeof items);
    REQUIRE(routine_run(setup, &aim_at_shape, results, SAMPLES), "not run");
    for (uint32_t i = 0; i < SAMPLES; i++)
        check_sample(&shape, &aim, pick, &results[i], origin, &tally);
    double d = deviate(&shape, &aim, f, &tally);
    printf("  %-10s %3.0f %% aimed at, %4.1f %% hidden, %.2f deviations\n", name,
           100 * aim.whole / whole_area(&shape), 100.0 * tally.hidden / SAMPLES, d);
    // The level is 1e-5 for all places of all kinds together.
    CHECK(fabs(d) <= 5.2, "%s: %g deviations from uniform", name, d);
    CHECK(tally.off == 0, "%s: %u points off the surface", name, tally.off);
    CHECK(tally.beyond == 0, "%s: %u points beyond what is seen", name, tally.beyond);
    CHECK(tally.wrong_density == 0, "%s: %u densities", name, tally.wrong_density);
    CHECK(tally.disagree == 0, "%s: %u densities differ from those of hits", name, tally.disagree);
    CHECK(tally.wrongly_seen == 0, "%s: %u hidden points chosen", name, tally.wrongly_seen);
    CHECK(tally.wrongly_hidden == 0, "%s: %u points in sight not chosen", name,
          tally.wrongly_hidden);
}

// Computes a place along the shape's own directions, in units of its half edges, half height and
// radius.
static void place_by_shape(const struct exact_shape *s, const double by[3], double place[3])
{
    double across[2][3];
    const double *axes[3] = {s->axis[0], s->axis[1], s->axis[2]};
    double size[3] = {s->half[0], s->half[1], s->half[2]};
    if (s->kind != SHAPE_BOX) {
        directions_across(s, (double[3]){0.3, 0.5, 0.7}, across);
        axes[1] = across[0];
        axes[2] = across[1];
        size[1] = size[2] = s->radius;
    }
    for (int c = 0; c < 3; c++)
        place[c] = by[0] * size[0] * axes[0][c] + by[1] * size[1] * axes[1][c] +
                   by[2] * size[2] * axes[2][c];
}

static void check_kind(const char *name, uint32_t kind, uint32_t choice)
{
    // From outside, beside an edge, along the axis, and from inside.
    static const double places[][3] = {
        {2, 1.5, -1}, {0.1, -3, 0.2}, {0.4, 0.3, 9}, {0.02, 0.01, -0.015}};
    // Over faces, near and far; at edges and corners; close to a face, and to where two meet; and
    // in the corners inside.
    static const double own[][3] = {{0.3, -0.2, 1.5},  {-1.01, 0.4, 0.3},  {40, 0.1, 0.2},
                                    {-0.5, 1.8, -2.5}, {2, -0.3, -1.7},    {-1.2, 1.3, 1.4},
                                    {30, -50, 40},     {0.6, 1.001, 0.01}, {1.01, 1.02, -0.1},
                                    {0, 1e3, 0.5},     {0.9, -0.65, 0.7},  {-0.99, 0.69, -0.7}};
    // In front of a quad, in units of its half edges and its normal: nearby, close to its diagonal,
    // to an edge, to a corner, and far away.
    static const double before[][3] = {{0.3, -0.2, 0.05}, {0.5, 0.5, 0.1}, {-0.4, 0.99, 0.05},
                                       {1, 1, 0.05},      {3, -2, 0.3},    {20, 10, 60}};
    struct setup setup;
    struct random random = {51 + kind + 16 * choice};
    scene_start(&setup.scene, 8, 8);
    setup.scene.settings.light_choice = choice;
    setup.scene.materials[0].emission[0] = 1;
    add_random_shape(&setup.scene, kind, (double[3]){0.5, -0.25, 0.75}, 1, 3, false, &random);
    // A second emitter, so that there is a choice, and a place from which to choose.
    add_sphere(&setup.scene, (double[3]){0, 0, 5}, 0.1, 0);
    OPEN_SETUP(&setup, LIBRARY_SLOTS);
    struct exact_shape shape = exact_shape(&setup.r.flat.shapes[0], 0, 0);
    double area = whole_area(&shape), pick = 0.5;
    bool is_convex = kind == SHAPE_BOX || kind == SHAPE_CYLINDER;
    if (choice == LIGHT_CHOICE_POWER)
        pick = area / (area + 4 * M_PI * 0.1 * 0.1);
    for (size_t i = 0; i < sizeof places / sizeof places[0]; i++)
        check_place(&setup, name, places[i], pick, &random);
    if (kind == SHAPE_QUAD)
        for (size_t i = 0; i < sizeof before / sizeof before[0]; i++) {
            double place[3];
            for (int c = 0; c < 3; c++)
                place[c] = before[i][0] * shape.half[0] * shape.axis[0][c] +
                           before[i][1] * shape.half[1] * shape.axis[1][c] +
                           before[i][2] * shape.half[0] * shape.axis[2][c];
            check_place(&setup, name, place, pick, &random);
        }
    for (size_t i = 0; i < sizeof own / sizeof own[0] && is_convex; i++) {
        double place[3];
        place_by_shape(&shape, own[i], place);
        check_place(&setup, name, place, pick, &random);
    }
    setup_close(&setup);
}

TEST(quads)
{
    check_kind("quad", SHAPE_QUAD, LIGHT_CHOICE_UNIFORM);
}

TEST(boxes)
{
    check_kind("box", SHAPE_BOX, LIGHT_CHOICE_UNIFORM);
    check_kind("box", SHAPE_BOX, LIGHT_CHOICE_POWER);
}

TEST(cylinders)
{
    check_kind("cylinder", SHAPE_CYLINDER, LIGHT_CHOICE_UNIFORM);
    check_kind("cylinder", SHAPE_CYLINDER, LIGHT_CHOICE_POWER);
}

TEST(tubes)
{
    check_kind("tube", SHAPE_TUBE, LIGHT_CHOICE_UNIFORM);
}

TEST_MAIN(TEST_CASE(quads), TEST_CASE(boxes), TEST_CASE(cylinders), TEST_CASE(tubes))
