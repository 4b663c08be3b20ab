// Tests environment images whose texels are constant, and suns: the sampling tables against the
// image, samples against the tables, lookups of directions, and the angles in both.
#include "base/maths.h"
#include "bsdf_statistics.h"
#include "environment_texel.h"
#include "library_fixture.h"
#include "render/tables/environment_table.h"

static void make_image(struct scene *scene, uint32_t width, uint32_t height)
{
    add_environment_image(scene, width, height);
    scene->settings.environment_filter = ENVIRONMENT_FILTER_NEAREST;
    scene->settings.environment_sampling = ENVIRONMENT_SAMPLING_LUMINANCE;
    memset(scene->environment.texels, 0,
           (size_t)width * height * sizeof *scene->environment.texels);
}

static void set_texel(struct scene *scene, uint32_t column, uint32_t row, float value)
{
    const struct environment *environment = &scene->environment;
    for (int c = 0; c < 3; c++)
        environment->texels[row * environment->width + column][c] = value;
}

// --- tables --------------------------------------------------------------------------------------

// The densities must be proportional to the luminances. Only black texels have none, and the
// integral is 1.
static void check_table(const char *name, const struct scene *scene, double tolerance)
{
    const struct environment *e = &scene->environment;
    uint32_t count = e->width * e->height, wrong = 0;
    struct arena arena = {0};
    const struct environment_table table = {
        .environment = e, .filter = ENVIRONMENT_FILTER_NEAREST, .is_sampled = true};
    uint32_t(*words)[4] = arena_alloc(&arena, environment_table_words(&table), sizeof *words);
    REQUIRE(words && environment_table_build(&table, words), "out of memory");
    double total = 0, integral = 0, worst = 0;
    for (uint32_t i = 0; i < count; i++)
        total += luminance(e->texels[i]) * environment_texel_solid_angle(e, i / e->width);
    for (uint32_t i = 0; i < count; i++) {
        float pdf;
        memcpy(&pdf, &words[i][3], sizeof pdf);
        double solid_angle = environment_texel_solid_angle(e, i / e->width);
        double part = luminance(e->texels[i]) * solid_angle / total;
        integral += (double)pdf * solid_angle;
        wrong += !(pdf >= 0) || (part > 0) != (pdf > 0.0f);
        worst = fmax(worst, fabs((double)pdf * solid_angle - part));
    }
    printf("  %-26s integral 1 %+.1e, probabilities off by %.1e at most\n", name, integral - 1,
           worst);
    CHECK(wrong == 0, "%s: %u texels without a density that should have one, or the other way",
          name, wrong);
    CHECK(fabs(integral - 1) <= 1e-6, "%s: the densities integrate to %.9g", name, integral);
    CHECK(worst <= tolerance, "%s: a probability is off by %g", name, worst);
    arena_finish(&arena);
}

TEST(densities_are_the_luminances)
{
    static const uint32_t sizes[][2] = {{1, 1},  {1, 7},    {9, 1},   {4, 4},    {5, 16},
                                        {17, 5}, {64, 257}, {257, 3}, {1025, 65}};
    struct random random = {81};
    for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; i++) {
        struct scene scene = {0};
        char name[64];
        make_image(&scene, sizes[i][0], sizes[i][1]);
        // The texels span 12 orders of magnitude; a third of them is black, but not the first one.
        for (uint32_t t = 0; t < sizes[i][0] * sizes[i][1]; t++)
            for (int c = 0; c < 3; c++)
                scene.environment.texels[t][c] =
                    t > 0 && random_u32(&random) % 3 == 0
                        ? 0.0f
                        : (float)pow(10, random_between(&random, -6, 6));
        snprintf(name, sizeof name, "%u x %u", sizes[i][0], sizes[i][1]);
        // A bin may have a number of 2^32 too much or too little, in rows and columns; bins that
        // deserve less than one have one.
        check_table(name, &scene, 4e-7);
        scene_finish(&scene);
    }
}

// One texel is bright and the others are black or dim; it is in a corner, whose bins are first or
// last.
TEST(one_bright_texel)
{
    static const uint32_t places[][2] = {{0, 0}, {1023, 255}, {0, 255}, {511, 100}, {1023, 0}};
    for (size_t i = 0; i < sizeof places / sizeof places[0]; i++) {
        struct scene scene = {0};
        make_image(&scene, 1024, 256);
        set_texel(&scene, places[i][0], places[i][1], 1e6f);
        check_table("sun alone", &scene, 1e-7);
        for (uint32_t t = 0; t < 1024 * 256; t++)
            scene.environment.texels[t][1] += 1e-3f;
        check_table("sun and night", &scene, 1e-6);
        set_texel(&scene, places[i][0], places[i][1], 1e30f);
        check_table("1e30", &scene, 1e-4);
        scene_finish(&scene);
    }
}

// --- samples -------------------------------------------------------------------------------------

#define SAMPLES (1u << 20)

static union words *items; // SAMPLES items

static void fill_uniforms(uint64_t seed)
{
    struct random random = {seed};
    for (uint32_t i = 0; i < SAMPLES; i++)
        for (int c = 0; c < 4; c++)
            items[i].f[0][c] = (float)(random_u32(&random) >> 8) * 0x1p-24f;
}

// Returns the texel that the image has in a direction, in double precision.
static uint32_t texel_of(const struct environment *e, const float direction[3], double rotation)
{
    double x = (double)direction[0], z = (double)direction[2];
    const double turned[3] = {x * cos(rotation) - z * sin(rotation), (double)direction[1],
                              x * sin(rotation) + z * cos(rotation)};
    return environment_texel(e, turned);
}

// Compares the directions per texel with the image, and tests that they are uniform by solid angle
// within texels.
static void check_samples(const char *name, struct scene *scene, uint64_t seed)
{
    struct setup setup = {.scene = *scene};
    const struct environment *e = &setup.scene.environment;
    uint32_t texels = e->width * e->height;
    OPEN_SETUP(&setup, LIBRARY_SLOTS);
    fill_uniforms(seed);
    if (!library_run(&setup, ROUTINE_SAMPLE_ENVIRONMENT, items, SAMPLES)) {
        setup_close(&setup);
        return;
    }
    // Each texel is divided into 4 x 4 parts.
    uint32_t *counts = calloc(16 * (size_t)texels, sizeof *counts), other = 0, not_unit = 0;
    double *expected = calloc(16 * (size_t)texels, sizeof *expected), total = 0;
    struct environment fine = *e;
    fine.width *= 4;
    fine.height *= 4;
    REQUIRE(counts && expected, "out of memory");
    for (uint32_t i = 0; i < SAMPLES; i++) {
        counts[texel_of(&fine, items[i].f[0], e->rotation)]++;
        // Near an edge, the lookup may find the neighbouring texel, which has another density.
        other += items[i].f[0][3] != items[i].f[1][3];
        const double d[3] = {(double)items[i].f[0][0], (double)items[i].f[0][1],
                             (double)items[i].f[0][2]};
        not_unit += !(fabs(vec3_norm(d) - 1) <= 5e-7);
    }
    for (uint32_t t = 0; t < 16 * texels; t++) {
        uint32_t row = t / fine.width, column = t % fine.width;
        expected[t] = luminance(e->texels[row / 4 * e->width + column / 4]) *
                      environment_texel_solid_angle(&fine, row);
        total += expected[t];
    }
    for (uint32_t t = 0; t < 16 * texels; t++)
        expected[t] *= SAMPLES / total;
    struct pearson pearson = pearson_test(expected, counts, 16 * texels);
    printf("  %-18s p %.3g of %u degrees, %llu outside, %u at edges\n", name, pearson.p,
           pearson.degrees, (unsigned long long)pearson.impossible, other);
    // For five images together, the probability of an error is 1e-3.
    CHECK(pearson.p >= 2e-4, "%s: statistic %g, %u degrees, p %g", name, pearson.statistic,
          pearson.degrees, pearson.p);
    CHECK(pearson.impossible <= SAMPLES / 100000, "%s: %llu samples of black texels", name,
          (unsigned long long)pearson.impossible);
    CHECK(other <= SAMPLES / 1000, "%s: %u samples see another texel", name, other);
    CHECK(not_unit == 0, "%s: %u directions are not of unit length", name, not_unit);
    free(counts);
    free(expected);
    setup_close(&setup);
}

static void start(struct scene *scene, uint32_t width, uint32_t height)
{
    scene_start(scene, 16, 16);
    add_sphere(scene, (const double[3]){0, 0, 0}, 1, 0);
    make_image(scene, width, height);
}

TEST(samples_are_those_of_the_image)
{
    static const struct {
        const char *name;
        uint32_t width, height;
        double rotation;
    } images[] = {{"1 x 1", 1, 1, 0},
                  {"13 x 7", 13, 7, 0},
                  {"turned", 32, 17, 2.5},
                  {"1 x 16", 1, 16, 0},
                  {"64 x 1", 64, 1, -0.3}};
    struct random random = {82};
    items = calloc(SAMPLES, sizeof *items);
    REQUIRE(items, "out of memory");
    for (size_t i = 0; i < sizeof images / sizeof images[0]; i++) {
        struct scene scene;
        start(&scene, images[i].width, images[i].height);
        scene.environment.rotation = images[i].rotation;
        for (uint32_t t = 0; t < images[i].width * images[i].height; t++)
            for (int c = 0; c < 3; c++)
                scene.environment.texels[t][c] =
                    t > 0 && random_u32(&random) % 3 == 0
                        ? 0.0f
                        : (float)pow(10, random_between(&random, -1, 1));
        check_samples(images[i].name, &scene, 100 + i);
    }
    free(items);
}

// Extreme uniforms must give a lit texel, its density, and a direction in it or at its edge.
TEST(extreme_uniforms)
{
    static const float values[] = {0, 0x1p-24f, 0.25f, 0.5f, 1 - 0x1p-24f};
    struct scene scene;
    struct setup setup;
    start(&scene, 13, 9);
    for (uint32_t t = 13; t < 13 * 8; t += 2)
        set_texel(&scene, t % 13, t / 13, (float)t);
    setup.scene = scene;
    OPEN_SETUP(&setup, LIBRARY_SLOTS);
    items = calloc(625, sizeof *items);
    REQUIRE(items, "out of memory");
    for (int i = 0; i < 625; i++)
        for (int c = 0, n = i; c < 4; c++, n /= 5)
            items[i].f[0][c] = values[n % 5];
    if (library_run(&setup, ROUTINE_SAMPLE_ENVIRONMENT, items, 625))
        for (int i = 0; i < 625; i++) {
            const float *direction = items[i].f[0], *radiance = items[i].f[1];
            const double d[3] = {(double)direction[0], (double)direction[1], (double)direction[2]};
            CHECK(fabs(vec3_norm(d) - 1) <= 5e-7, "%d: length %.9g", i, vec3_norm(d));
            CHECK(direction[3] > 0 && isfinite(direction[3]) && radiance[0] > 0,
                  "%d: density %g, radiance %g", i, (double)direction[3], (double)radiance[0]);
            CHECK(radiance[0] == radiance[1] && fmodf(radiance[0], 1) == 0, "%d", i);
        }
    free(items);
    setup_close(&setup);
}

// A sun of one texel in a night sky of 2^19 texels (docs/verification.md, C33).
TEST(a_sun_of_one_texel)
{
    enum { WIDTH = 8192, HEIGHT = 64, COLUMN = 5000, ROW = 10 };
    struct scene scene;
    struct setup setup;
    start(&scene, WIDTH, HEIGHT);
    for (uint32_t t = 0; t < WIDTH * HEIGHT; t++)
        set_texel(&scene, t % WIDTH, t / WIDTH, 0.5f);
    set_texel(&scene, COLUMN, ROW, 1e6f);
    setup.scene = scene;
    OPEN_SETUP(&setup, LIBRARY_SLOTS);
    items = calloc(SAMPLES, sizeof *items);
    REQUIRE(items, "out of memory");
    fill_uniforms(83);
    if (library_run(&setup, ROUTINE_SAMPLE_ENVIRONMENT, items, SAMPLES)) {
        const struct environment *e = &setup.scene.environment;
        double sun = 1e6 * environment_texel_solid_angle(e, ROW), sum = 0;
        double night = 0.5 * (4 * M_PI - environment_texel_solid_angle(e, ROW));
        uint32_t hits = 0, wrong = 0;
        for (uint32_t i = 0; i < SAMPLES; i++) {
            bool is_sun = items[i].f[1][0] > 1;
            hits += is_sun;
            sum += (double)items[i].f[1][0] / (double)items[i].f[0][3];
            wrong += is_sun && texel_of(e, items[i].f[0], 0) != ROW * WIDTH + COLUMN;
        }
        double expected = sun / (sun + night), sigma = sqrt(expected * (1 - expected) / SAMPLES);
        printf("  sun chosen %.4f, expected %.4f +- %.4f; integral off by %.1e; %u beside it\n",
               (double)hits / SAMPLES, expected, sigma, sum / SAMPLES / (sun + night) - 1, wrong);
        CHECK(fabs((double)hits / SAMPLES - expected) <= 4 * sigma, "%u of %u", hits, SAMPLES);
        // Luminance over density must be the same for all texels.
        CHECK(fabs(sum / SAMPLES / (sun + night) - 1) <= 1e-5, "%.9g", sum / SAMPLES);
        CHECK(wrong <= hits / 500, "%u of %u directions are beside the texel", wrong, hits);
    }
    free(items);
    setup_close(&setup);
}

// --- lookups -------------------------------------------------------------------------------------

TEST(angles)
{
    enum { COUNT = 1 << 16 };
    struct scene scene;
    struct setup setup;
    struct random random = {84};
    scene_start(&scene, 16, 16);
    setup.scene = scene;
    OPEN_SETUP(&setup, LIBRARY_SLOTS);
    union words *given = calloc(2 * COUNT, sizeof *given), *found = given + COUNT;
    REQUIRE(given, "out of memory");
    for (uint32_t i = 0; i < COUNT; i++) {
        double scale = pow(10, random_between(&random, -12, 0));
        double angle = random_between(&random, 0, 2 * M_PI);
        given[i].f[0][0] = (float)(cos(angle) * (i % 3 == 1 ? scale : 1));
        given[i].f[0][1] = (float)(sin(angle) * (i % 3 == 2 ? scale : 1));
        given[i].f[0][2] = (float)random_between(&random, -1, 1);
        if (i < 9) {
            given[i].f[0][0] = (float)(i / 3) - 1;
            given[i].f[0][1] = (float)(i % 3) - 1;
            given[i].f[0][2] = (float)i / 8;
        }
    }
    memcpy(found, given, COUNT * sizeof *given);
    double worst_atan = 0, worst_cos = 0;
    if (library_run(&setup, ROUTINE_ANGLES, found, COUNT))
        for (uint32_t i = 0; i < COUNT; i++) {
            const float *in = given[i].f[0], *out = found[i].f[0];
            double turns = atan2((double)in[1], (double)in[0]) / (2 * M_PI);
            double angle = 2 * M_PI * (double)in[2];
            double error = in[0] == 0 && in[1] == 0 ? 0 : fabs((double)out[0] - turns);
            worst_atan = fmax(worst_atan, fmin(error, 1 - error));
            worst_cos = fmax(worst_cos, fabs((double)out[1] - cos(angle)));
            worst_cos = fmax(worst_cos, fabs((double)out[2] - sin(angle)));
        }
    printf("  arctangents off by %.2g turns, cosines by %.2g\n", worst_atan, worst_cos);
    CHECK(worst_atan <= 1e-7, "%g turns", worst_atan);
    CHECK(worst_cos <= 2e-7, "%g", worst_cos);
    free(given);
    setup_close(&setup);
}

// Rows must be distinguished up to the poles, where the height alone would not suffice.
TEST(rows_at_the_poles)
{
    enum { HEIGHT = 4096 };
    struct scene scene;
    struct setup setup;
    start(&scene, 1, HEIGHT);
    for (uint32_t row = 0; row < HEIGHT; row++)
        set_texel(&scene, 0, row, (float)(row + 1));
    setup.scene = scene;
    OPEN_SETUP(&setup, LIBRARY_SLOTS);
    items = calloc(HEIGHT, sizeof *items);
    REQUIRE(items, "out of memory");
    for (uint32_t row = 0; row < HEIGHT; row++) {
        double theta = M_PI * (row + 0.5) / HEIGHT;
        items[row].f[0][0] = (float)(sin(theta) * cos(1.0 * row));
        items[row].f[0][1] = (float)cos(theta);
        items[row].f[0][2] = (float)(sin(theta) * sin(1.0 * row));
    }
    if (library_run(&setup, ROUTINE_SEE_ENVIRONMENT, items, HEIGHT))
        for (uint32_t row = 0; row < HEIGHT; row++)
            CHECK(items[row].f[0][0] == (float)(row + 1), "row %u sees row %g", row,
                  (double)items[row].f[0][0] - 1);
    free(items);
    setup_close(&setup);
}

// --- suns ----------------------------------------------------------------------------------------

// Directions must be uniform in the cone, be recognised as inside it, and have its density.
static void check_sun(struct setup *setup, double degrees, const double axis[3])
{
    enum { COUNT = 1 << 17, BINS = 32 };
    double radius = degrees * M_PI / 360, versine = 2 * sin(radius / 2) * sin(radius / 2);
    uint32_t counts[BINS][BINS] = {{0}}, outside = 0, unseen = 0, not_unit = 0;
    double expected[BINS * BINS];
    fill_uniforms((uint64_t)(degrees * 1e6));
    for (uint32_t i = 0; i < COUNT; i++) {
        items[i].f[1][0] = items[i].f[0][0];
        items[i].f[1][1] = items[i].f[0][1];
        for (int c = 0; c < 3; c++)
            items[i].f[0][c] = (float)(axis[c] / vec3_norm(axis));
        items[i].f[0][3] = (float)versine;
    }
    double n[3], t[3], b[3];
    for (int c = 0; c < 3; c++)
        n[c] = (double)items[0].f[0][c];
    vec3_cross(n, fabs(n[0]) < 0.6 ? (const double[3]){1, 0, 0} : (const double[3]){0, 1, 0}, t);
    const double tangent = vec3_norm(t);
    for (int c = 0; c < 3; c++)
        t[c] /= tangent;
    vec3_cross(n, t, b);
    if (!library_run(setup, ROUTINE_SUN, items, COUNT))
        return;
    for (uint32_t i = 0; i < COUNT; i++) {
        const double d[3] = {(double)items[i].f[0][0], (double)items[i].f[0][1],
                             (double)items[i].f[0][2]};
        const double chord[3] = {d[0] - n[0], d[1] - n[1], d[2] - n[2]};
        double part = 0.5 * vec3_dot(chord, chord) / versine;
        double turn = atan2(vec3_dot(d, b), vec3_dot(d, t)) / (2 * M_PI) + 0.5;
        not_unit += !(fabs(vec3_norm(d) - 1) <= 5e-7);
        outside += part > 1 + 1e-6;
        unseen += items[i].f[1][0] == 0;
        counts[(int)fmin(part * BINS, BINS - 1)][(int)fmin(turn * BINS, BINS - 1)]++;
        CHECK(fabs((double)items[i].f[0][3] * 2 * M_PI * versine - 1) <= 1e-6, "density %g",
              (double)items[i].f[0][3]);
    }
    for (int i = 0; i < BINS * BINS; i++)
        expected[i] = (double)COUNT / (BINS * BINS);
    struct pearson pearson = pearson_test(expected, &counts[0][0], BINS * BINS);
    printf("  %8g degrees: p %.3g, %u outside, %u not seen\n", degrees, pearson.p, outside, unseen);
    // Directions are accurate to about 1e-7, so below one degree their places form a lattice that
    // the bins show.
    CHECK(degrees < 1 || pearson.p >= 1e-4, "%g degrees: p %g", degrees, pearson.p);
    double slack = 4e-7 / radius; // fraction of the cone at its edge
    CHECK(outside <= slack * COUNT + 5 && unseen <= slack * COUNT + 5, "%g degrees: %u, %u",
          degrees, outside, unseen);
    CHECK(not_unit == 0, "%u directions are not of unit length", not_unit);
}

TEST(suns_fill_their_cones)
{
    static const double degrees[] = {1e-4, 1e-2, 0.53, 5, 60, 180};
    static const double axes[][3] = {{0, 1, 0}, {-1, 0.3, 2}};
    struct scene scene;
    struct setup setup;
    scene_start(&scene, 16, 16);
    setup.scene = scene;
    OPEN_SETUP(&setup, LIBRARY_SLOTS);
    items = calloc(SAMPLES, sizeof *items);
    REQUIRE(items, "out of memory");
    for (size_t i = 0; i < sizeof degrees / sizeof degrees[0]; i++)
        for (int a = 0; a < 2; a++)
            check_sun(&setup, degrees[i], axes[a]);
    free(items);
    setup_close(&setup);
}

TEST_MAIN(TEST_CASE(densities_are_the_luminances), TEST_CASE(one_bright_texel),
          TEST_CASE(samples_are_those_of_the_image), TEST_CASE(extreme_uniforms),
          TEST_CASE(a_sun_of_one_texel), TEST_CASE(angles), TEST_CASE(rows_at_the_poles),
          TEST_CASE(suns_fill_their_cones))
