// Tests points on triangles that the renderer chooses by solid angle (lib/solid_angle.glsl), on the
// device: solid angles against double precision by other formulas, points against Arvo's own
// construction, and their distribution by chi-square; within the range in which this method is
// used, at its limits, and beyond.
#include "library_fixture.h"
#include "solid_angle_reference.h"

enum {
    SAMPLES = 1 << 16, // samples per triangle
    GRID = 12,         // rows of cells
    CELLS = GRID * GRID,
};

static union words items[SAMPLES], results[SAMPLES];

// A triangle relative to the point: corner 0 and two edges, in floats.
struct place {
    const char *name;
    float corner[3], edge1[3], edge2[3];
};

static void corners_of(const struct place *place, double out[3][3])
{
    for (int c = 0; c < 3; c++) {
        out[0][c] = (double)place->corner[c];
        out[1][c] = (double)place->corner[c] + (double)place->edge1[c];
        out[2][c] = (double)place->corner[c] + (double)place->edge2[c];
    }
}

static void fill_item(const struct place *place, const float u[2], union words *item)
{
    memset(item, 0, sizeof *item);
    memcpy(item->f[0], place->corner, sizeof place->corner);
    memcpy(item->f[1], place->edge1, sizeof place->edge1);
    memcpy(item->f[2], place->edge2, sizeof place->edge2);
    memcpy(item->f[3], u, 2 * sizeof *u);
}

// Computes the point of the triangle with these barycentric coordinates.
static void point_at(double corners[3][3], double b1, double b2, double out[3])
{
    for (int c = 0; c < 3; c++)
        out[c] = (1 - b1 - b2) * corners[0][c] + b1 * corners[1][c] + b2 * corners[2][c];
}

// Cells are small triangles: the lower and the upper half of each square of the grid of (b1, b2).
static int cell_of(double b1, double b2)
{
    int i = (int)(b1 * GRID), j = (int)(b2 * GRID);
    i = i >= GRID ? GRID - 1 : i;
    j = j >= GRID - i ? GRID - 1 - i : j;
    bool upper = b1 * GRID - i + (b2 * GRID - j) > 1 && i + j < GRID - 1;
    // Column i has 2 (GRID - i) - 1 cells.
    return 2 * i * GRID - i * i + 2 * j + upper;
}

static void cell_probabilities(double corners[3][3], double solid_angle, double out[CELLS])
{
    for (int i = 0; i < GRID; i++) {
        for (int k = 0; k < 2 * (GRID - i) - 1; k++) {
            double cell[3][3], x = i, y = k / 2, h = k % 2 ? -1 : 1;
            x += k % 2;
            y += k % 2;
            point_at(corners, x / GRID, y / GRID, cell[0]);
            point_at(corners, (x + h) / GRID, y / GRID, cell[1]);
            point_at(corners, x / GRID, (y + h) / GRID, cell[2]);
            out[2 * i * GRID - i * i + k] = exact_solid_angle(cell) / solid_angle;
        }
    }
}

// Returns Pearson's statistic as a standard normal deviate (Wilson and Hilferty 1931). Cells with
// an expected count below 10 are pooled.
static double deviate(const double probability[CELLS], const uint32_t count[CELLS])
{
    double statistic = 0, cells = 0, rest_expected = 0, rest_count = 0;
    for (int i = 0; i < CELLS; i++) {
        double expected = SAMPLES * probability[i], difference = count[i] - expected;
        if (expected >= 10) {
            statistic += difference * difference / expected;
            cells++;
        } else {
            rest_expected += expected;
            rest_count += count[i];
        }
    }
    if (rest_expected >= 10) {
        statistic += (rest_count - rest_expected) * (rest_count - rest_expected) / rest_expected;
        cells++;
    }
    double spread = 2 / (9 * (cells - 1));
    return (cbrt(statistic / (cells - 1)) - (1 - spread)) / sqrt(spread);
}

// Returns the angle between the chosen point and that of Arvo's construction, in units of the
// triangle's angular size.
static double distance_to_exact(double corners[3][3], const float u[2], const double b[2],
                                double size)
{
    double exact[3], point[3], across[3];
    exact_seen_point(corners, (double[2]){(double)u[0], (double)u[1]}, exact);
    point_at(corners, b[0], b[1], point);
    vec3_cross(exact, point, across);
    return atan2(vec3_norm(across), vec3_dot(exact, point)) / size;
}

static void check_place(struct setup *setup, const struct place *place, struct random *random)
{
    static uint32_t count[CELLS];
    static double probability[CELLS];
    double corners[3][3];
    corners_of(place, corners);
    double solid_angle = exact_solid_angle(corners), size = sqrt(fmin(solid_angle, 1));
    memset(count, 0, sizeof count);
    for (uint32_t i = 0; i < SAMPLES; i++) {
        float u[2];
        for (int c = 0; c < 2; c++)
            u[c] = (float)(random_u32(random) >> 8) * 0x1p-24f;
        fill_item(place, u, &items[i]);
    }
    memcpy(results, items, sizeof items);
    REQUIRE(library_run(setup, ROUTINE_SEE_TRIANGLE, results, SAMPLES), "not run");
    double worst = 0, worst_angle = 0;
    uint32_t outside = 0;
    for (uint32_t i = 0; i < SAMPLES; i++) {
        double b[2] = {(double)results[i].f[0][0], (double)results[i].f[0][1]};
        outside += !(b[0] >= 0 && b[1] >= 0 && b[0] + b[1] <= 1 + 1e-6);
        count[cell_of(b[0], b[1])]++;
        worst = fmax(worst, distance_to_exact(corners, items[i].f[3], b, size));
        worst_angle = fmax(worst_angle, fabs((double)results[i].f[0][2] / solid_angle - 1));
    }
    cell_probabilities(corners, solid_angle, probability);
    double d = deviate(probability, count);
    printf("  %-22s %.3g sr to %.1g, points to %.1g, %.2f deviations\n", place->name, solid_angle,
           worst_angle, worst, d);
    CHECK(results[0].f[0][3] > 0, "%s: not chosen by solid angle", place->name);
    CHECK(worst_angle <= 2e-5, "%s: a solid angle is off by %g", place->name, worst_angle);
    CHECK(worst <= 2e-3, "%s: a point is off by %g", place->name, worst);
    CHECK(outside == 0, "%s: %u points outside", place->name, outside);
    // The level is 1e-5 for all places together.
    CHECK(fabs(d) <= 5.2, "%s: %g deviations from uniform", place->name, d);
}

static const struct place places[] = {
    {"octant", {1, 0, 0}, {-1, 1, 0}, {-1, 0, 1}},
    {"other way round", {1, 0, 0}, {-1, 0, 1}, {-1, 1, 0}},
    {"lamp of a room", {0.4f, 0.9f, 2.0f}, {0.8f, 0, 0}, {0.8f, 0, 0.6f}},
    {"close below", {-1, 0.1f, -1}, {2, 0, 0}, {0, 0, 3}},
    {"all but on it", {-1, 0.03f, -1}, {3, 0, 0}, {0, 0, 3}},
    {"close to an edge", {-1, 4.5e-3f, 4.5e-3f}, {2, 0, 0}, {1, 0, 2}},
    {"close to a corner", {1e-3f, 1e-3f, 1e-3f}, {2, 0, 0}, {1, 0, 2}},
    {"grazing", {1, 0.01f, -1}, {1, 0, 0.5f}, {0, 0, 2}},
    {"a sliver", {-20, 1, 0}, {40, 0, 0}, {20, 0, 0.01f}},
    {"a sliver, end on", {1, 0.1f, 0}, {1000, 0, 10}, {1000, 0, -10}},
    {"just large enough", {5, 5, 5}, {0.3f, 0, 0}, {0, 0.28f, 0}},
    {"of 10^9 m", {-3e9f, 1e9f, -2e9f}, {5e9f, 0, 1e9f}, {1e9f, 2e9f, 4e9f}},
    {"of 10^-6 m", {-3e-6f, 1e-6f, -2e-6f}, {5e-6f, 0, 1e-6f}, {1e-6f, 2e-6f, 4e-6f}},
};

TEST(seen_triangles)
{
    struct setup setup;
    struct random random = {61};
    scene_start(&setup.scene, 8, 8);
    OPEN_SETUP(&setup, LIBRARY_SLOTS);
    for (size_t i = 0; i < sizeof places / sizeof places[0]; i++)
        check_place(&setup, &places[i], &random);
    setup_close(&setup);
}

// Points are chosen by area if the triangle is too small, if the point is in its plane, on it, on
// an edge or at a corner, or if it has no area.
TEST(by_area)
{
    static const struct place by_area[] = {
        {"small", {5, 5, 5}, {0.15f, 0, 0}, {0, 0.15f, 0}},
        {"far away", {1e15f, 0, 0}, {0, 1, 0}, {0, 0, 1}},
        {"edge-on", {1, 0, 0}, {1, 0, 0}, {1, 0, 1}},
        {"on it", {-1, 0, -1}, {3, 0, 0}, {0, 0, 3}},
        {"1e-3 above it", {-1, 1e-3f, -1}, {3, 0, 0}, {0, 0, 3}},
        {"on an edge", {-1, 0, 0}, {2, 0, 0}, {1, 0, 2}},
        {"3e-3 from an edge", {-1, 3e-3f, 0}, {2, 0, 0}, {1, 0, 2}},
        {"at a corner", {0, 0, 0}, {1, 0, 0}, {1, 0, 2}},
        {"no area", {1, 1, 1}, {1, 0, 0}, {2, 0, 0}},
        {"a point", {1, 1, 1}, {0, 0, 0}, {0, 0, 0}},
    };
    enum { COUNT = sizeof by_area / sizeof by_area[0] };
    struct setup setup;
    scene_start(&setup.scene, 8, 8);
    OPEN_SETUP(&setup, LIBRARY_SLOTS);
    for (int i = 0; i < COUNT; i++)
        fill_item(&by_area[i], (float[2]){0.25f, 0.75f}, &items[i]);
    REQUIRE(library_run(&setup, ROUTINE_SEE_TRIANGLE, items, COUNT), "not run");
    for (int i = 0; i < COUNT; i++)
        CHECK(items[i].f[0][3] == 0, "%s: %g", by_area[i].name, (double)items[i].f[0][3]);
    setup_close(&setup);
}

// Uniforms of 0, the smallest and the largest value must never give NaN, and always the point of
// the triangle to which Arvo's construction leads.
TEST(extreme_uniforms)
{
    static const float extremes[] = {0, 0x1p-24f, 0.25f, 0.5f, 0.75f, 1 - 0x1p-24f};
    enum { SIDE = sizeof extremes / sizeof extremes[0], COUNT = SIDE * SIDE };
    struct setup setup;
    scene_start(&setup.scene, 8, 8);
    OPEN_SETUP(&setup, LIBRARY_SLOTS);
    for (size_t p = 0; p < sizeof places / sizeof places[0]; p++) {
        double corners[3][3];
        corners_of(&places[p], corners);
        for (int i = 0; i < COUNT; i++)
            fill_item(&places[p], (float[2]){extremes[i / SIDE], extremes[i % SIDE]}, &items[i]);
        memcpy(results, items, COUNT * sizeof *items);
        REQUIRE(library_run(&setup, ROUTINE_SEE_TRIANGLE, results, COUNT), "not run");
        for (int i = 0; i < COUNT; i++) {
            double b[2] = {(double)results[i].f[0][0], (double)results[i].f[0][1]};
            CHECK(b[0] >= 0 && b[1] >= 0 && b[0] + b[1] <= 1 + 1e-6, "%s, u %g %g: %g %g",
                  places[p].name, (double)items[i].f[3][0], (double)items[i].f[3][1], b[0], b[1]);
        }
    }
    setup_close(&setup);
}

TEST_MAIN(TEST_CASE(seen_triangles), TEST_CASE(by_area), TEST_CASE(extreme_uniforms))
