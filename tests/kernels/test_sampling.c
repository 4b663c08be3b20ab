// Tests the renderer's warps (lib/sampling.glsl) and the choice of a light on the device:
// distributions by chi-square, extreme inputs, and that bases are orthonormal.
#include "library_fixture.h"
#include "metrics/metrics.h"

// --- distributions -------------------------------------------------------------------------------

enum {
    ROWS = 32,
    COLUMNS = 64,
    SAMPLES = 1 << 19,
    DISTRIBUTIONS = 4, // number of tests, among which the significance level is divided
};

static union words samples[SAMPLES];

// Counts of samples in cells of known probability.
struct cells {
    double probability[ROWS][COLUMNS];
    uint32_t count[ROWS][COLUMNS];
};

// Fills in uniforms as in the kernels: multiples of 2^-24 below 1.
static void fill_uniforms(uint64_t seed)
{
    struct random random = {seed};
    for (uint32_t i = 0; i < SAMPLES; i++)
        for (int c = 0; c < 2; c++)
            samples[i].f[0][c] = (float)(random_u32(&random) >> 8) * 0x1p-24f;
}

static uint32_t cell_of(double fraction, uint32_t cells)
{
    double cell = fraction * cells;
    return cell >= cells ? cells - 1 : (uint32_t)cell;
}

// Returns the column of the angle of (x, y).
static uint32_t column_of(const float p[2])
{
    double turn = atan2((double)p[1], (double)p[0]) / (2 * M_PI);
    return cell_of(turn < 0 ? turn + 1 : turn, COLUMNS);
}

// Computes Pearson's statistic as a standard normal deviate (Wilson and Hilferty 1931), at a level
// of 1 % for all distributions together (Sidak 1967).
static void check_cells(const char *name, const struct cells *cells)
{
    double statistic = 0, used = 0, probability = 0;
    for (int r = 0; r < ROWS; r++) {
        for (int c = 0; c < COLUMNS; c++) {
            double expected = cells->probability[r][c] * SAMPLES;
            probability += cells->probability[r][c];
            if (!(expected > 0)) {
                CHECK(cells->count[r][c] == 0, "%s: %u samples outside the domain", name,
                      cells->count[r][c]);
                continue;
            }
            REQUIRE(expected >= 5, "%s: %g expected in a cell", name, expected);
            double difference = cells->count[r][c] - expected;
            statistic += difference * difference / expected;
            used++;
        }
    }
    CHECK(fabs(probability - 1) < 1e-12, "%s: cells of %.15g in all", name, probability);
    double spread = 2 / (9 * (used - 1));
    double deviate = (cbrt(statistic / (used - 1)) - (1 - spread)) / sqrt(spread);
    double limit = stats_t_quantile(pow(0.99, 1.0 / DISTRIBUTIONS), 1e9);
    printf("  %-18s chi-square %.0f in %.0f cells, %.2f deviations (limit %.2f)\n", name, statistic,
           used, deviate, limit);
    CHECK(deviate <= limit, "%s", name);
    // Counts that are too even would be an error, too.
    CHECK(deviate >= -4.5, "%s", name);
}

TEST(cosine_hemisphere)
{
    static struct cells cells;
    struct setup setup;
    scene_start(&setup.scene, 8, 8);
    OPEN_SETUP(&setup, LIBRARY_SLOTS);
    fill_uniforms(31);
    REQUIRE(library_run(&setup, ROUTINE_COSINE_HEMISPHERE, samples, SAMPLES), "not run");
    uint32_t bad = 0;
    for (uint32_t i = 0; i < SAMPLES; i++) {
        const float *d = samples[i].f[0];
        double z = (double)d[2];
        double norm = (double)d[0] * (double)d[0] + (double)d[1] * (double)d[1] + z * z;
        bad += !(fabs(norm - 1) <= 1e-6) || !(z >= 0) || !(fabs((double)d[3] - z / M_PI) <= 1e-7);
        cells.count[cell_of(z, ROWS)][column_of(d)]++;
    }
    CHECK(bad == 0, "%u of %u", bad, SAMPLES);
    for (int r = 0; r < ROWS; r++)
        for (int c = 0; c < COLUMNS; c++) // cos^2 is uniform
            cells.probability[r][c] = (2 * r + 1) / ((double)ROWS * ROWS * COLUMNS);
    check_cells("cosine hemisphere", &cells);
    setup_close(&setup);
}

TEST(sphere)
{
    static struct cells cells;
    struct setup setup;
    scene_start(&setup.scene, 8, 8);
    OPEN_SETUP(&setup, LIBRARY_SLOTS);
    fill_uniforms(32);
    REQUIRE(library_run(&setup, ROUTINE_SPHERE, samples, SAMPLES), "not run");
    uint32_t bad = 0;
    for (uint32_t i = 0; i < SAMPLES; i++) {
        const float *d = samples[i].f[0];
        double z = (double)d[2];
        double norm = (double)d[0] * (double)d[0] + (double)d[1] * (double)d[1] + z * z;
        bad += !(fabs(norm - 1) <= 1e-6);
        cells.count[cell_of((z + 1) / 2, ROWS)][column_of(d)]++;
    }
    CHECK(bad == 0, "%u of %u", bad, SAMPLES);
    for (int r = 0; r < ROWS; r++)
        for (int c = 0; c < COLUMNS; c++)
            cells.probability[r][c] = 1.0 / (ROWS * COLUMNS);
    check_cells("sphere", &cells);
    setup_close(&setup);
}

TEST(disc)
{
    static struct cells cells;
    struct setup setup;
    scene_start(&setup.scene, 8, 8);
    OPEN_SETUP(&setup, LIBRARY_SLOTS);
    fill_uniforms(33);
    REQUIRE(library_run(&setup, ROUTINE_DISC, samples, SAMPLES), "not run");
    uint32_t bad = 0;
    for (uint32_t i = 0; i < SAMPLES; i++) {
        const float *p = samples[i].f[0];
        double radius = sqrt((double)p[0] * (double)p[0] + (double)p[1] * (double)p[1]);
        bad += !(radius <= 1 + 1e-6);
        cells.count[cell_of(radius, ROWS)][column_of(p)]++;
    }
    CHECK(bad == 0, "%u of %u", bad, SAMPLES);
    for (int r = 0; r < ROWS; r++)
        for (int c = 0; c < COLUMNS; c++)
            cells.probability[r][c] = (2 * r + 1) / ((double)ROWS * ROWS * COLUMNS);
    check_cells("disc", &cells);
    setup_close(&setup);
}

// Cells of the unit square of barycentric coordinates. The hypotenuse halves the cells that it
// crosses.
TEST(triangle)
{
    static struct cells cells;
    struct setup setup;
    scene_start(&setup.scene, 8, 8);
    OPEN_SETUP(&setup, LIBRARY_SLOTS);
    fill_uniforms(34);
    REQUIRE(library_run(&setup, ROUTINE_TRIANGLE, samples, SAMPLES), "not run");
    uint32_t bad = 0;
    for (uint32_t i = 0; i < SAMPLES; i++) {
        double u = (double)samples[i].f[0][0], v = (double)samples[i].f[0][1];
        bad += !(u >= 0 && v >= 0 && u + v <= 1 + 1e-7);
        uint32_t row = cell_of(u, ROWS), column = cell_of(v, ROWS);
        // If the sum was rounded beyond 1, the point belongs to a cell that the hypotenuse crosses.
        cells.count[row][column < ROWS - row ? column : ROWS - 1 - row]++;
    }
    CHECK(bad == 0, "%u of %u", bad, SAMPLES);
    for (int r = 0; r < ROWS; r++)
        for (int c = 0; c < ROWS - r; c++)
            cells.probability[r][c] = (c == ROWS - r - 1 ? 1.0 : 2.0) / (ROWS * ROWS);
    check_cells("triangle", &cells);
    setup_close(&setup);
}

// --- the choice of a light -----------------------------------------------------------------------

enum { STEPS = 1 << 24 };

// Of this many emissive triangles one in a hundred is dim: the legs have length 1, or the root of
// DIM.
#define DIM 3e-3

static bool is_dim(uint32_t light)
{
    return light % 100 == 50;
}

static void add_lights(struct scene *scene, uint32_t count)
{
    float(*triangles)[3][3] = arena_alloc(&scene->arena, count, sizeof *triangles);
    REQUIRE(triangles, "out of memory");
    for (uint32_t i = 0; i < count; i++) {
        float side = is_dim(i) ? (float)sqrt(DIM) : 1;
        triangles[i][0][0] = triangles[i][1][0] = triangles[i][2][0] = (float)i;
        triangles[i][1][1] = triangles[i][2][2] = side;
    }
    scene->materials[0].emission[0] = 1;
    add_triangles(scene, (const float(*)[3][3])triangles, count, 0);
}

// Tests all 2^24 values of the first uniform, each with a random one within the bin. Dim lights
// together are chosen as often as their area requires, and each of the others equally often. If the
// number of bins is a power of two, the first uniform alone would have 128 values in each, and
// would choose dim lights 2.6 times too often.
static void check_choice(uint32_t count)
{
    struct setup setup;
    struct random random = {36};
    uint64_t dim = 0, upper = 0;
    scene_start(&setup.scene, 8, 8);
    setup.scene.settings.light_choice = LIGHT_CHOICE_POWER;
    add_lights(&setup.scene, count);
    OPEN_SETUP(&setup, LIBRARY_SLOTS);
    for (uint32_t first = 0; first < STEPS; first += SAMPLES) {
        for (uint32_t i = 0; i < SAMPLES; i++) {
            samples[i].f[0][0] = (float)(first + i) * 0x1p-24f;
            samples[i].f[0][1] = samples[i].f[0][2] = 0.5f;
            samples[i].f[0][3] = (float)(random_u32(&random) >> 8) * 0x1p-24f;
        }
        REQUIRE(library_run(&setup, ROUTINE_PICK_LIGHT, samples, SAMPLES), "not run");
        for (uint32_t i = 0; i < SAMPLES; i++) {
            uint32_t light = setup.r.bvh.triangle_order[samples[i].u[0][0]];
            dim += is_dim(light);
            upper += !is_dim(light) && light >= count / 2;
        }
    }
    double dims[2] = {0}, lights[2] = {0};
    for (uint32_t i = 0; i < count; i++) {
        dims[i >= count / 2] += is_dim(i);
        lights[i >= count / 2] += !is_dim(i);
    }
    double sum = lights[0] + lights[1] + DIM * (dims[0] + dims[1]);
    double expected_dim = STEPS * DIM * (dims[0] + dims[1]) / sum;
    double expected_upper = STEPS * lights[1] / sum;
    double t_dim = ((double)dim - expected_dim) / sqrt(expected_dim);
    // The variance is at most binomial, because the first uniform is stratified.
    double t_upper = ((double)upper - expected_upper) / sqrt(expected_upper / 2);
    printf(
        "  %u lights: %.0f of %.0f dim (%.1f deviations), %.0f of %.0f in the upper half (%.1f)\n",
        count, (double)dim, expected_dim, t_dim, (double)upper, expected_upper, t_upper);
    CHECK(fabs(t_dim) <= 4.5 && fabs(t_upper) <= 4.5, "%u lights: %g, %g", count, t_dim, t_upper);
    setup_close(&setup);
}

TEST(light_choice)
{
    check_choice(100000);
    check_choice(1 << 17);
}

// --- extremes ------------------------------------------------------------------------------------

// Uniforms of 0, the smallest and the largest value must never give NaN, and always a point of the
// domain.
TEST(extreme_uniforms)
{
    static const float extremes[] = {0, 0x1p-24f, 0.25f, 0.5f, 0.75f, 1 - 0x1p-24f};
    static const uint32_t routines[] = {ROUTINE_COSINE_HEMISPHERE, ROUTINE_SPHERE, ROUTINE_DISC,
                                        ROUTINE_TRIANGLE};
    enum { COUNT = sizeof extremes / sizeof extremes[0] };
    struct setup setup;
    scene_start(&setup.scene, 8, 8);
    OPEN_SETUP(&setup, LIBRARY_SLOTS);
    for (int routine = 0; routine < 4; routine++) {
        union words items[COUNT * COUNT] = {0};
        for (int i = 0; i < COUNT * COUNT; i++) {
            items[i].f[0][0] = extremes[i / COUNT];
            items[i].f[0][1] = extremes[i % COUNT];
        }
        if (!library_run(&setup, routines[routine], items, COUNT * COUNT))
            break;
        for (int i = 0; i < COUNT * COUNT; i++) {
            const float *d = items[i].f[0];
            double norm = (double)d[0] * (double)d[0] + (double)d[1] * (double)d[1] +
                          (routine < 2 ? (double)d[2] * (double)d[2] : 0);
            bool on_sphere = fabs(norm - 1) <= 1e-6;
            CHECK(routine < 2 ? on_sphere : norm <= 1 + 1e-6, "routine %d, u %g %g: %g %g %g",
                  routine, (double)extremes[i / COUNT], (double)extremes[i % COUNT], (double)d[0],
                  (double)d[1], (double)d[2]);
        }
    }
    setup_close(&setup);
}

// --- bases ---------------------------------------------------------------------------------------

// Bases are orthonormal and right-handed for random directions, along the axes, and near -z, where
// the construction changes.
TEST(basis_around)
{
    struct setup setup;
    struct random random = {35};
    enum { COUNT = 100000 };
    scene_start(&setup.scene, 8, 8);
    OPEN_SETUP(&setup, LIBRARY_SLOTS);
    for (uint32_t i = 0; i < COUNT; i++) {
        float *n = samples[i].f[0];
        random_direction(&random, n);
        if (i < 6) {
            memset(n, 0, sizeof(float[3]));
            n[i / 2] = i % 2 ? -1.0f : 1.0f;
        } else if (i < 1000) {
            double tilt = pow(10, random_between(&random, -8, -1));
            double turn = random_between(&random, 0, 2 * M_PI);
            n[0] = (float)(sin(tilt) * cos(turn));
            n[1] = (float)(sin(tilt) * sin(turn));
            n[2] = (float)(i % 2 ? -cos(tilt) : cos(tilt));
        } else if (i < 1100) {
            float flat = sqrtf(n[0] * n[0] + n[1] * n[1]);
            n[0] /= flat;
            n[1] /= flat;
            n[2] = i % 2 ? -0.0f : 0.0f;
        }
    }
    static union words inputs[COUNT];
    memcpy(inputs, samples, sizeof inputs);
    REQUIRE(library_run(&setup, ROUTINE_BASIS, samples, COUNT), "not run");
    double worst = 0;
    for (uint32_t i = 0; i < COUNT; i++) {
        double axis[3][3], third[3];
        for (int a = 0; a < 3; a++)
            for (int c = 0; c < 3; c++)
                axis[a][c] = (double)samples[i].f[a][c];
        for (int a = 0; a < 3; a++) {
            worst = fmax(worst, fabs(vec3_dot(axis[a], axis[(a + 1) % 3])));
            worst = fmax(worst, fabs(vec3_norm(axis[a]) - 1));
        }
        vec3_cross(axis[0], axis[1], third);
        for (int c = 0; c < 3; c++) {
            worst = fmax(worst, fabs(third[c] - axis[2][c]));
            CHECK(samples[i].f[2][c] == inputs[i].f[0][c], "the normal changed");
        }
    }
    printf("  worst deviation of %d bases: %.2g\n", COUNT, worst);
    CHECK(worst <= 1e-6, "%g", worst);
    setup_close(&setup);
}

TEST_MAIN(TEST_CASE(cosine_hemisphere), TEST_CASE(sphere), TEST_CASE(disc), TEST_CASE(triangle),
          TEST_CASE(light_choice), TEST_CASE(extreme_uniforms), TEST_CASE(basis_around))
