// Tests bilinear environment images: lookups of directions, also across poles and edges of the
// image, and samples against densities and the image.
#include "bsdf_statistics.h"
#include "environment_reference.h"
#include "library_fixture.h"
#include "render/tables/environment_table.h"

#define SAMPLES (1u << 18)

static union words *items; // SAMPLES items

static const struct image {
    const char *name;
    uint32_t width, height;
    double rotation;
    double black; // fraction of black texels
    double decades;
} images[] = {
    {"1 x 1", 1, 1, 0, 0, 0},
    {"4 x 2", 4, 2, 0, 0, 1},
    {"4 x 2, turned", 4, 2, 2.5, 0.4, 2},
    {"5 x 3", 5, 3, 0, 0.3, 1},
    {"13 x 7", 13, 7, 0, 0.4, 2},
    {"1 x 16", 1, 16, 0, 0.3, 1},
    {"2 x 1", 2, 1, 0, 0, 1},
    {"63 x 1, turned", 63, 1, -0.3, 0.3, 2},
    {"32 x 17, turned", 32, 17, 4, 0.3, 2},
};
enum { IMAGE_COUNT = sizeof images / sizeof images[0] };

static void start(struct scene *scene, uint32_t width, uint32_t height)
{
    scene_start(scene, 16, 16);
    add_sphere(scene, (const double[3]){0, 0, 0}, 1, 0);
    add_environment_image(scene, width, height);
    scene->settings.environment_sampling = ENVIRONMENT_SAMPLING_LUMINANCE;
}

static void start_at_random(struct scene *scene, const struct image *image, struct random *random)
{
    start(scene, image->width, image->height);
    scene->environment.rotation = image->rotation;
    for (uint32_t t = 0; t < image->width * image->height; t++) {
        bool is_black = t > 0 && random_unit(random) < image->black;
        for (int c = 0; c < 3; c++)
            scene->environment.texels[t][c] =
                is_black ? 0 : (float)pow(10, random_between(random, 0, image->decades));
    }
}

static float greatest(const struct environment *e)
{
    float most = 0;
    for (uint32_t t = 0; t < e->width * e->height; t++)
        for (int c = 0; c < 3; c++)
            most = fmaxf(most, e->texels[t][c]);
    return most;
}

static void in_image(const struct environment *e, const float direction[3], double out[3])
{
    double x = (double)direction[0], z = (double)direction[2];
    double c = cos(e->rotation), s = sin(e->rotation);
    out[0] = x * c - z * s;
    out[1] = (double)direction[1];
    out[2] = x * s + z * c;
}

static void towards(double angle, double around, float out[3])
{
    out[0] = (float)(sin(angle) * cos(around));
    out[1] = (float)cos(angle);
    out[2] = (float)(sin(angle) * sin(around));
}

// --- lookups -------------------------------------------------------------------------------------

// Radiance is accurate to the single precision of the direction: rounding errors of 1e-7, as a
// fraction of a texel, times the difference from the neighbouring texel.
static double tolerance(const struct environment *e)
{
    return 1e-6 * (1 + e->width + e->height) * (double)greatest(e);
}

// A third of the directions are near the poles, where the height of a direction is inaccurate.
static void check_lookups(const struct image *image, struct random *random)
{
    enum { COUNT = 1 << 14 };
    struct scene scene;
    start_at_random(&scene, image, random);
    struct setup setup = {.scene = scene};
    const struct environment *e = &setup.scene.environment;
    OPEN_SETUP(&setup, LIBRARY_SLOTS);
    float(*given)[3] = calloc(COUNT, sizeof *given);
    union words *found = calloc(COUNT, sizeof *found);
    REQUIRE(given && found, "out of memory");
    for (uint32_t i = 0; i < COUNT; i++) {
        double angle =
            i % 3 ? acos(random_between(random, -1, 1)) : pow(10, random_between(random, -6, 0));
        towards(i % 6 == 3 ? M_PI - angle : angle, random_between(random, 0, 2 * M_PI), given[i]);
        memcpy(found[i].f[0], given[i], sizeof given[i]);
    }
    double worst = 0;
    if (library_run(&setup, ROUTINE_SEE_ENVIRONMENT, found, COUNT))
        for (uint32_t i = 0; i < COUNT; i++) {
            double direction[3], rgb[3];
            in_image(e, given[i], direction);
            struct reference_place place = reference_place_of(e, direction);
            reference_radiance(e, &place, rgb);
            for (int c = 0; c < 3; c++)
                worst = fmax(worst, fabs((double)found[i].f[0][c] - rgb[c]));
        }
    printf("  %-18s off by %.1e of the greatest at most\n", image->name,
           worst / (double)greatest(e));
    CHECK(worst <= tolerance(e), "%s: off by %g", image->name, worst);
    free(given);
    free(found);
    setup_close(&setup);
}

TEST(lookups_are_those_of_the_reference)
{
    struct random random = {91};
    for (int i = 0; i < IMAGE_COUNT; i++)
        check_lookups(&images[i], &random);
}

// In the direction of a texel's centre, only that texel is seen.
TEST(centres_see_their_texels)
{
    enum { WIDTH = 64, HEIGHT = 33, COUNT = WIDTH * HEIGHT };
    struct scene scene;
    start(&scene, WIDTH, HEIGHT);
    struct setup setup = {.scene = scene};
    OPEN_SETUP(&setup, LIBRARY_SLOTS);
    items = calloc(COUNT, sizeof *items);
    REQUIRE(items, "out of memory");
    for (uint32_t t = 0; t < COUNT; t++)
        towards(M_PI * (t / WIDTH + 0.5) / HEIGHT, 2 * M_PI * ((t % WIDTH + 0.5) / WIDTH - 0.5),
                items[t].f[0]);
    if (library_run(&setup, ROUTINE_SEE_ENVIRONMENT, items, COUNT))
        for (uint32_t t = 0; t < COUNT; t++)
            for (int c = 0; c < 3; c++) {
                float expected = setup.scene.environment.texels[t][c];
                CHECK(fabsf(items[t].f[0][c] - expected) <=
                          (float)tolerance(&setup.scene.environment),
                      "texel %u: %g, not %g", t, (double)items[t].f[0][c], (double)expected);
            }
    free(items);
    setup_close(&setup);
}

// Along each of 16 meridians across a pole, and along a parallel across the image's edge, radiance
// must not change by more than its slope permits. At the pole itself it is the mean.
static void check_continuity(uint32_t width, uint32_t height)
{
    enum { MERIDIANS = 16, STEPS = 257, COUNT = MERIDIANS * STEPS };
    const struct image image = {"", width, height, 0, 0, 2};
    struct random random = {92 + width};
    struct scene scene;
    start_at_random(&scene, &image, &random);
    struct setup setup = {.scene = scene};
    const struct environment *e = &setup.scene.environment;
    OPEN_SETUP(&setup, LIBRARY_SLOTS);
    for (int path = 0; path < 3; path++) { // zenith, nadir and edge
        double reach = 0.75 * M_PI / height, step = 2 * reach / (STEPS - 1), jump = 0, mean = 0;
        for (int i = 0; i < COUNT; i++) {
            double along = step * (i % STEPS) - reach, around = 2 * M_PI * (i / STEPS) / MERIDIANS;
            if (path == 2)
                towards(M_PI * (i / STEPS + 0.5) / MERIDIANS, M_PI + along, items[i].f[0]);
            else
                towards(path ? M_PI - along : along, around, items[i].f[0]);
        }
        if (!library_run(&setup, ROUTINE_SEE_ENVIRONMENT, items, COUNT))
            break;
        for (int i = 1; i < COUNT; i++)
            if (i % STEPS != 0)
                jump = fmax(jump, fabs((double)items[i].f[0][0] - (double)items[i - 1].f[0][0]));
        // From the pole to the centres it is half a texel, so the slope is doubled.
        double slope = (double)greatest(e) * fmax(2 * height / M_PI, width / (2 * M_PI));
        CHECK(jump <= slope * step + tolerance(e), "%u x %u, path %d: a jump of %g, slope %g",
              width, height, path, jump, slope * step);
        for (uint32_t x = 0; path < 2 && x < width; x++)
            mean += (double)e->texels[path * (height - 1) * width + x][0] / width;
        for (int m = 0; path < 2 && m < MERIDIANS; m++) {
            double seen = (double)items[m * STEPS + STEPS / 2].f[0][0];
            CHECK(fabs(seen / mean - 1) <= 1e-5, "%u x %u: pole %d is %g, not %g", width, height,
                  path, seen, mean);
        }
    }
    setup_close(&setup);
}

TEST(radiance_is_continuous)
{
    items = calloc(SAMPLES, sizeof *items);
    REQUIRE(items, "out of memory");
    check_continuity(1, 1);
    check_continuity(4, 2);
    check_continuity(7, 5);
    check_continuity(32, 16);
    free(items);
}

// --- tables --------------------------------------------------------------------------------------

// The mean densities of cells must be proportional to their luminances and integrate to 1.
static void check_table(const char *name, const struct scene *scene, double most)
{
    const struct environment *e = &scene->environment;
    const struct environment_table table = {.environment = e, .is_sampled = true};
    struct arena arena = {0};
    uint32_t(*words)[4] = arena_alloc(&arena, environment_table_words(&table), sizeof *words);
    REQUIRE(words && environment_table_build(&table, words), "out of memory");
    double total = reference_total(e, 0), integral = 0, sphere = 0, worst = 0, corners[4];
    uint32_t wrong = 0;
    for (uint32_t i = 0; i < e->width * (e->height + 1); i++) {
        uint32_t row = i / e->width;
        double solid_angle = environment_cell_solid_angle(e, row);
        float density;
        memcpy(&density, &words[i][3], sizeof density);
        reference_luminances(e, 0, row, i % e->width, corners);
        double part = reference_mix(corners, 0.5, 0.5) * solid_angle / total;
        sphere += solid_angle;
        integral += (double)density * solid_angle;
        wrong += !(density >= 0) || (part > 0) != (density > 0);
        worst = fmax(worst, fabs((double)density * solid_angle - part));
    }
    printf("  %-18s integral 1 %+.1e, probabilities off by %.1e at most\n", name, integral - 1,
           worst);
    CHECK(fabs(sphere / (4 * M_PI) - 1) <= 1e-12, "%s: cells of %.15g", name, sphere);
    CHECK(wrong == 0, "%s: %u cells without a density that should have one, or the reverse", name,
          wrong);
    CHECK(fabs(integral - 1) <= 1e-6, "%s: the densities integrate to %.9g", name, integral);
    CHECK(worst <= most, "%s: a probability is off by %g", name, worst);
    arena_finish(&arena);
}

TEST(densities_are_the_luminances)
{
    static const uint32_t places[][2] = {{0, 0}, {127, 63}, {0, 63}, {50, 20}};
    struct random random = {93};
    for (int i = 0; i < IMAGE_COUNT; i++) {
        struct scene scene;
        start_at_random(&scene, &images[i], &random);
        check_table(images[i].name, &scene, 4e-7);
        scene_finish(&scene);
    }
    for (size_t i = 0; i < sizeof places / sizeof places[0]; i++) {
        struct scene scene;
        start(&scene, 128, 64);
        float(*texels)[3] = scene.environment.texels;
        memset(texels, 0, 128 * 64 * sizeof *texels);
        texels[places[i][1] * 128 + places[i][0]][1] = 1e6f;
        check_table("sun alone", &scene, 1e-7);
        for (uint32_t t = 0; t < 128 * 64; t++)
            texels[t][1] += 1e-3f;
        check_table("sun and night", &scene, 1e-6);
        texels[places[i][1] * 128 + places[i][0]][1] = 1e30f;
        check_table("1e30", &scene, 1e-4);
        scene_finish(&scene);
    }
}

// --- samples -------------------------------------------------------------------------------------

static void fill_uniforms(uint64_t seed)
{
    struct random random = {seed};
    for (uint32_t i = 0; i < SAMPLES; i++)
        for (int c = 0; c < 4; c++)
            items[i].f[0][c] = (float)(random_u32(&random) >> 8) * 0x1p-24f;
}

// The differences between the samples' densities and those of the reference and of lookups, and the
// estimated integral of radiance over all directions.
struct differences {
    double density, lookup, radiance, integral, variance;
    uint32_t not_unit;
};

static struct differences compare_samples(const struct environment *e, double floor, double total)
{
    struct differences d = {0};
    double most = 0;
    for (uint32_t t = 0; t < e->width * e->height; t++) {
        const double rgb[3] = {(double)e->texels[t][0], (double)e->texels[t][1],
                               (double)e->texels[t][2]};
        most = fmax(most, vec3_luminance(rgb) / total);
    }
    for (uint32_t i = 0; i < SAMPLES; i++) {
        const float *sample = items[i].f[0], *seen = items[i].f[1];
        double direction[3], corners[4], rgb[3];
        in_image(e, sample, direction);
        struct reference_place place = reference_place_of(e, direction);
        reference_luminances(e, floor, place.row, place.column, corners);
        reference_radiance(e, &place, rgb);
        double density = reference_mix(corners, place.right, place.down) / total;
        d.density = fmax(d.density, fabs((double)sample[3] - density) / most);
        d.lookup = fmax(d.lookup, fabs((double)sample[3] - (double)seen[3]) / most);
        for (int c = 0; c < 3; c++)
            d.radiance = fmax(d.radiance, fabs((double)seen[c] - rgb[c]) / (double)greatest(e));
        const double found[3] = {(double)seen[0], (double)seen[1], (double)seen[2]};
        double value = vec3_luminance(found) / (double)sample[3] / total;
        d.integral += value / SAMPLES;
        d.variance += value * value / SAMPLES;
        d.not_unit += !(fabs(vec3_norm(direction) - 1) <= 5e-7);
    }
    d.variance -= d.integral * d.integral;
    return d;
}

// Integrates the image's luminance over all directions with 64 points per cell and row. It is exact
// in longitude, and of fourth order in the angle.
static double integrate_luminance(const struct environment *e)
{
    enum { STEPS = 64 };
    double sum = 0, corners[4];
    for (uint32_t row = 0; row <= e->height; row++) {
        double top = reference_node_angle(e, row), bottom = reference_node_angle(e, row + 1);
        double upper = 0, lower = 0;
        for (int i = 0; i <= STEPS; i++) { // Simpson's rule
            double part = (double)i / STEPS, weight = i % STEPS == 0 ? 1 : i % 2 ? 4 : 2;
            weight *= sin(top + (bottom - top) * part) * (bottom - top) / (3 * STEPS);
            upper += weight * (1 - part);
            lower += weight * part;
        }
        for (uint32_t column = 0; column < e->width; column++) {
            reference_luminances(e, 0, row, column, corners);
            sum += M_PI / e->width *
                   (upper * (corners[0] + corners[1]) + lower * (corners[2] + corners[3]));
        }
    }
    return sum;
}

// Each cell is divided into 4 x 4 parts. The integral of the density over a part is the value in
// its middle.
static struct pearson count_directions(const struct environment *e, double floor, double total)
{
    uint32_t cells = e->width * (e->height + 1);
    uint32_t *counts = calloc(16 * (size_t)cells, sizeof *counts);
    double *expected = calloc(16 * (size_t)cells, sizeof *expected), corners[4];
    struct pearson pearson = {0};
    for (uint32_t i = 0; counts && expected && i < SAMPLES; i++) {
        double direction[3];
        in_image(e, items[i].f[0], direction);
        struct reference_place p = reference_place_of(e, direction);
        uint32_t x = (uint32_t)fmin(4 * p.right, 3), y = (uint32_t)fmin(4 * fmax(p.down, 0), 3);
        counts[16 * (p.row * e->width + p.column) + 4 * y + x]++;
    }
    for (uint32_t i = 0; counts && expected && i < 16 * cells; i++) {
        uint32_t row = i / 16 / e->width;
        reference_luminances(e, floor, row, i / 16 % e->width, corners);
        expected[i] = SAMPLES / total / 16 * environment_cell_solid_angle(e, row) *
                      reference_mix(corners, (i % 4 + 0.5) / 4, (i / 4 % 4 + 0.5) / 4);
    }
    if (counts && expected)
        pearson = pearson_test(expected, counts, 16 * cells);
    free(counts);
    free(expected);
    return pearson;
}

static void check_samples(const struct image *image, struct random *random, uint32_t sampling,
                          uint64_t seed)
{
    struct scene scene;
    start_at_random(&scene, image, random);
    scene.settings.environment_sampling = sampling;
    struct setup setup = {.scene = scene};
    const struct environment *e = &setup.scene.environment;
    OPEN_SETUP(&setup, LIBRARY_SLOTS);
    fill_uniforms(seed);
    if (library_run(&setup, ROUTINE_SAMPLE_ENVIRONMENT, items, SAMPLES)) {
        // A constant image is sampled by its luminance.
        bool is_compensated =
            sampling == ENVIRONMENT_SAMPLING_COMPENSATED && e->width * e->height > 1;
        double floor = is_compensated ? (double)(float)environment_luminance(e) : 0;
        double total = reference_total(e, floor), exact = integrate_luminance(e);
        struct differences d = compare_samples(e, floor, total);
        struct pearson pearson = count_directions(e, floor, total);
        double t = (d.integral - exact / total) / sqrt(fmax(d.variance, 1e-20) / SAMPLES);
        printf("  %-18s p %.3g of %3u degrees, %llu outside; densities off by %.1e, lookups %.1e, "
               "radiance %.1e; integral off by %+.1e (t %+.1f), variance %.2g\n",
               image->name, pearson.p, pearson.degrees, (unsigned long long)pearson.impossible,
               d.density, d.lookup, d.radiance, d.integral * total / exact - 1, t, d.variance);
        double rounding = 1e-6 * (1 + e->width + e->height);
        // For nine images, twice, the probability of an error is 2e-3.
        CHECK(pearson.p >= 1e-4, "%s: p %g", image->name, pearson.p);
        CHECK(pearson.impossible <= SAMPLES / 100000, "%s: %llu samples of black cells",
              image->name, (unsigned long long)pearson.impossible);
        CHECK(d.density <= rounding && d.lookup <= rounding && d.radiance <= rounding,
              "%s: off by %g, %g, %g", image->name, d.density, d.lookup, d.radiance);
        // Where the density is 0, only scattered rays find the radiance.
        CHECK(is_compensated || fabs(t) <= 4 || fabs(d.integral * total / exact - 1) <= 1e-6,
              "%s: t = %g", image->name, t);
        CHECK(d.not_unit == 0, "%s: %u directions are not of unit length", image->name, d.not_unit);
    }
    setup_close(&setup);
}

TEST(samples_are_those_of_the_image)
{
    struct random random = {94};
    items = calloc(SAMPLES, sizeof *items);
    REQUIRE(items, "out of memory");
    for (int i = 0; i < IMAGE_COUNT; i++)
        check_samples(&images[i], &random, ENVIRONMENT_SAMPLING_LUMINANCE, 200 + (uint64_t)i);
    free(items);
}

TEST(samples_are_those_of_what_exceeds_the_mean)
{
    struct random random = {94};
    items = calloc(SAMPLES, sizeof *items);
    REQUIRE(items, "out of memory");
    for (int i = 0; i < IMAGE_COUNT; i++)
        check_samples(&images[i], &random, ENVIRONMENT_SAMPLING_COMPENSATED, 300 + (uint64_t)i);
    free(items);
}

// Extreme uniforms must give a unit direction and a finite density, and radiance exactly if the
// density is not 0.
TEST(extreme_uniforms)
{
    static const float values[] = {0, 0x1p-24f, 0.25f, 0.5f, 1 - 0x1p-24f};
    struct scene scene;
    start(&scene, 13, 9);
    for (uint32_t t = 0; t < 13 * 9; t++)
        for (int c = 0; c < 3; c++)
            scene.environment.texels[t][c] = t % 3 ? 0 : (float)t * (t % 2 ? 1e-36f : 1e30f);
    struct setup setup = {.scene = scene};
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
            CHECK(direction[3] >= 0 && isfinite(direction[3]) && radiance[0] >= 0 &&
                      isfinite(radiance[0]),
                  "%d: density %g, radiance %g", i, (double)direction[3], (double)radiance[0]);
            CHECK((direction[3] > 0) == (radiance[0] > 0), "%d: density %g, radiance %g", i,
                  (double)direction[3], (double)radiance[0]);
        }
    free(items);
    setup_close(&setup);
}

// A sun of one texel in a night sky of 2^19 texels (docs/verification.md, C33). The integral over
// solid angle of its tent about the angle t, with sides of h, is 2 pi / width sin t (2 - 2 cos h) /
// h.
TEST(a_sun_of_one_texel)
{
    enum { WIDTH = 8192, HEIGHT = 64, COLUMN = 5000, ROW = 10 };
    struct scene scene;
    start(&scene, WIDTH, HEIGHT);
    for (uint32_t t = 0; t < WIDTH * HEIGHT; t++)
        for (int c = 0; c < 3; c++)
            scene.environment.texels[t][c] = t == ROW * WIDTH + COLUMN ? 1e6f : 0.5f;
    struct setup setup = {.scene = scene};
    OPEN_SETUP(&setup, LIBRARY_SLOTS);
    items = calloc(SAMPLES, sizeof *items);
    REQUIRE(items, "out of memory");
    fill_uniforms(95);
    if (library_run(&setup, ROUTINE_SAMPLE_ENVIRONMENT, items, SAMPLES)) {
        double h = M_PI / HEIGHT, night = 0.5 * 4 * M_PI, sum = 0, squares = 0;
        double sun = (1e6 - 0.5) * 2 * M_PI / WIDTH * sin((ROW + 0.5) * h) * (2 - 2 * cos(h)) / h;
        uint32_t hits = 0;
        for (uint32_t i = 0; i < SAMPLES; i++) {
            double value = (double)items[i].f[1][0] / (double)items[i].f[0][3];
            hits += items[i].f[1][0] > 0.5001f;
            sum += value / SAMPLES;
            squares += value * value / SAMPLES;
        }
        double error = sqrt(fmax(squares - sum * sum, 0) / SAMPLES);
        double expected = sun / (sun + night), sigma = sqrt(expected * (1 - expected) / SAMPLES);
        printf("  sun chosen %.4f, expected %.4f +- %.4f; integral off by %.1e +- %.1e\n",
               (double)hits / SAMPLES, expected, sigma, sum / (sun + night) - 1,
               error / (sun + night));
        CHECK(fabs((double)hits / SAMPLES - expected) <= 4 * sigma, "%u of %u", hits, SAMPLES);
        CHECK(fabs(sum - sun - night) <= 4 * error + 2e-6 * sum, "%.9g, not %.9g", sum,
              sun + night);
        // Luminance over density is nearly constant: a fraction t of a cell by angle is about t - h
        // / 2 cot(angle) t (1 - t) by solid angle, here up to 0.011 less.
        CHECK(error * sqrt(SAMPLES) <= 0.02 * sum, "relative deviation %g",
              error * sqrt(SAMPLES) / sum);
    }
    free(items);
    setup_close(&setup);
}

TEST_MAIN(TEST_CASE(lookups_are_those_of_the_reference), TEST_CASE(centres_see_their_texels),
          TEST_CASE(radiance_is_continuous), TEST_CASE(densities_are_the_luminances),
          TEST_CASE(samples_are_those_of_the_image),
          TEST_CASE(samples_are_those_of_what_exceeds_the_mean), TEST_CASE(extreme_uniforms),
          TEST_CASE(a_sun_of_one_texel))
