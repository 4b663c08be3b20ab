// Points that next-event estimation chooses on quads, boxes, cylinders and tubes: uniform by area,
// with the density that is said, and only where the shape does not hide them itself.
#include "library_fixture.h"
#include "shape_reference.h"
#include "shape_routines.h"

#include "shapes_test.spv.h"

enum {
    SAMPLES = 1 << 16, // a place
    PLACES = 4,        // that they are chosen from
    GRID = 12,         // cells of a face, each way
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
        cross(s->axis[0], s->axis[1], normal);
        return face == 0 ? 4 * s->half[0] * s->half[1] * length(normal) : 0;
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

static double turn_of(double x, double y)
{
    return atan2(y, x) / (2 * M_PI) + 0.5;
}

// Where on its face a point is, both from 0 to 1 and uniform by area. `at`: as hit records say.
static int place_on_face(const struct exact_shape *s, const double f[3], int at, double place[2])
{
    double other[3], across[3], u[3], v[3];
    switch (s->kind) {
    case SHAPE_QUAD:
        // The coordinates along edges that are at any angle.
        cross(s->axis[2], s->axis[1], u);
        cross(s->axis[2], s->axis[0], v);
        place[0] = 0.5 + dot(f, u) / dot(s->axis[0], u) / s->half[0] / 2;
        place[1] = 0.5 + dot(f, v) / dot(s->axis[1], v) / s->half[1] / 2;
        return 0;
    case SHAPE_BOX: {
        int k = abs(at) - 1;
        for (int i = 0; i < 2; i++) {
            int axis = (k + 1 + i) % 3;
            place[i] = 0.5 + dot(f, s->axis[axis]) / s->half[axis] / 2;
        }
        return 2 * k + (at < 0);
    }
    default:
        memset(other, 0, sizeof other);
        other[fabs(s->axis[0][0]) < 0.5 ? 0 : 1] = 1;
        cross(s->axis[0], other, u);
        cross(s->axis[0], u, v);
        double along = dot(f, s->axis[0]);
        for (int c = 0; c < 3; c++)
            across[c] = f[c] - along * s->axis[0][c];
        place[0] = turn_of(dot(across, u), dot(across, v));
        place[1] =
            at ? dot(across, across) / (s->radius * s->radius) : 0.5 + along / s->half[0] / 2;
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
    uint32_t off, wrong_density, disagree, wrongly_hidden, wrongly_seen, hidden;
};

static void check_sample(const struct exact_shape *s, const union words *out,
                         const double origin[3], struct tally *tally)
{
    double f[3], to_light[3], point[3], normal[3], t[2], place[2];
    for (int c = 0; c < 3; c++) {
        to_light[c] = (double)out->f[0][c];
        point[c] = origin[c] + to_light[c];
        f[c] = point[c] - s->center[c];
        normal[c] = (double)out->f[1][c];
    }
    int at = (int)out->f[1][3], face = place_on_face(s, f, at, place);
    tally->count[face][cell_of(place[0])][cell_of(place[1])]++;
    tally->off += !(fabs(exact_height(s, point, at)) < 1e-6 * (length(origin) + exact_size(s)));

    double distance = length(to_light), slope = fabs(dot(to_light, normal)) / distance;
    double pdf = (double)out->f[0][3], pdf_of_hit = (double)out->f[2][0];
    double expected = distance * distance / (slope * whole_area(s));
    int crossings = exact_crossings(s, origin, to_light, t);
    bool in_between = false;
    for (int i = 0; i < crossings; i++)
        in_between = in_between || (t[i] > 0 && t[i] < 1 - 1e-3);
    tally->hidden += pdf == 0;
    // Edge-on either may be.
    if (slope < 1e-2)
        return;
    tally->wrongly_seen += s->kind != SHAPE_QUAD && in_between && pdf > 0;
    tally->wrongly_hidden += (!in_between || s->kind == SHAPE_QUAD) && pdf == 0 &&
                             !(crossings == 2 && fabs(t[1] - t[0]) < 1e-2);
    tally->wrong_density += pdf > 0 && fabs(pdf / expected - 1) > 1e-4;
    tally->disagree += pdf > 0 && fabs(pdf_of_hit / pdf - 1) > 1e-4;
}

// Pearson's statistic as a standard normal deviate (Wilson and Hilferty 1931).
static double deviate(const struct exact_shape *s, const struct tally *tally)
{
    double statistic = 0, cells = 0, whole = whole_area(s);
    for (int face = 0; face < FACES; face++) {
        double expected = SAMPLES * face_area(s, face) / whole / (GRID * GRID);
        for (int i = 0; i < GRID * GRID; i++) {
            double difference = tally->count[face][i / GRID][i % GRID] - expected;
            if (expected > 0)
                statistic += difference * difference / expected;
            else
                CHECK(tally->count[face][i / GRID][i % GRID] == 0, "points on no face");
            cells += expected > 0;
        }
    }
    double spread = 2 / (9 * (cells - 1));
    return (cbrt(statistic / (cells - 1)) - (1 - spread)) / sqrt(spread);
}

static void check_place(struct setup *setup, const char *name, const double from_center[3],
                        struct random *random)
{
    struct exact_shape shape = exact_shape(&setup->r.flat.shapes[0], 0, 0);
    static struct tally tally;
    double origin[3];
    memset(&tally, 0, sizeof tally);
    for (uint32_t i = 0; i < SAMPLES; i++) {
        memset(&items[i], 0, sizeof items[i]);
        for (int c = 0; c < 3; c++)
            items[i].f[0][c] = (float)(shape.center[c] + from_center[c]);
        for (int c = 0; c < 2; c++)
            items[i].f[1][c] = (float)(random_u32(random) >> 8) * 0x1p-24f;
    }
    for (int c = 0; c < 3; c++)
        origin[c] = (double)items[0].f[0][c];
    memcpy(results, items, sizeof items);
    REQUIRE(routine_run(setup, &aim_at_shape, results, SAMPLES), "not run");
    for (uint32_t i = 0; i < SAMPLES; i++)
        check_sample(&shape, &results[i], origin, &tally);
    double d = deviate(&shape, &tally);
    printf("  %-10s %4.1f %% hidden, %.2f deviations\n", name, 100.0 * tally.hidden / SAMPLES, d);
    // A level of 1e-5 for all places of all kinds together.
    CHECK(fabs(d) <= 5, "%s: %g deviations from uniform", name, d);
    CHECK(tally.off == 0, "%s: %u points off the surface", name, tally.off);
    CHECK(tally.wrong_density == 0, "%s: %u densities", name, tally.wrong_density);
    CHECK(tally.disagree == 0, "%s: %u densities differ from those of hits", name, tally.disagree);
    CHECK(tally.wrongly_seen == 0, "%s: %u hidden points chosen", name, tally.wrongly_seen);
    CHECK(tally.wrongly_hidden == 0, "%s: %u points in sight not chosen", name,
          tally.wrongly_hidden);
}

static void check_kind(const char *name, uint32_t kind)
{
    // From outside, at an edge's side, along the axis, and from inside.
    static const double places[PLACES][3] = {
        {2, 1.5, -1}, {0.1, -3, 0.2}, {0.4, 0.3, 9}, {0.02, 0.01, -0.015}};
    struct setup setup;
    struct random random = {51 + kind};
    scene_start(&setup.scene, 8, 8);
    setup.scene.settings.light_choice = LIGHT_CHOICE_UNIFORM;
    setup.scene.materials[0].emission[0] = 1;
    add_random_shape(&setup.scene, kind, (double[3]){0.5, -0.25, 0.75}, 1, 3, false, &random);
    // A second emitter, so that there is a choice; and a place to choose from.
    add_sphere(&setup.scene, (double[3]){0, 0, 5}, 0.1, 0);
    OPEN_SETUP(&setup, LIBRARY_SLOTS);
    for (int i = 0; i < PLACES; i++)
        check_place(&setup, name, places[i], &random);
    setup_close(&setup);
}

TEST(quads)
{
    check_kind("quad", SHAPE_QUAD);
}

TEST(boxes)
{
    check_kind("box", SHAPE_BOX);
}

TEST(cylinders)
{
    check_kind("cylinder", SHAPE_CYLINDER);
}

TEST(tubes)
{
    check_kind("tube", SHAPE_TUBE);
}

TEST_MAIN(TEST_CASE(quads), TEST_CASE(boxes), TEST_CASE(cylinders), TEST_CASE(tubes))
