// Tests known properties of SSIM and FLIP. `test_metrics_perceptual --values` prints those of two
// images made here, which perceptual.py computes in another way.
#include "base/memory.h"
#include "metrics/metrics.h"
#include "metrics/perceptual.h"
#include "test.h"

enum { WIDTH = 24, HEIGHT = 18, COUNT = WIDTH * HEIGHT };

static float image[COUNT][3], reference[COUNT][3];

static struct picture_pair pair(void)
{
    return (struct picture_pair){(const float(*)[3])image, (const float(*)[3])reference, WIDTH,
                                 HEIGHT};
}

static void fill(float (*out)[3], float r, float g, float b)
{
    for (int i = 0; i < COUNT; i++) {
        out[i][0] = r;
        out[i][1] = g;
        out[i][2] = b;
    }
}

// Adds noise in [0, scale) from a linear congruential generator that the script repeats.
static void add_noise(float (*out)[3], uint32_t seed, float scale)
{
    for (int i = 0; i < COUNT; i++)
        for (int c = 0; c < 3; c++) {
            seed = seed * 1664525u + 1013904223u;
            out[i][c] += scale * (float)(seed >> 8) * 0x1p-24f;
        }
}

// Makes a ramp with a bright square, and the same with noise.
static void make_pictures(void)
{
    for (int i = 0; i < COUNT; i++)
        for (int c = 0; c < 3; c++) {
            int x = i % WIDTH, y = i / WIDTH;
            bool square = x >= 12 && x < 20 && y >= 8 && y < 16;
            reference[i][c] = square ? 4.0f : 0.015625f * (float)(x + c * y % 7);
        }
    memcpy(image, reference, sizeof image);
    add_noise(image, 7, 0.25f);
}

static double flip(double pixels_per_degree)
{
    struct picture_pair p = pair();
    double value = NAN;
    bool ok = metrics_flip(&p, pixels_per_degree, NULL, NULL, &value);
    CHECK(ok);
    return value;
}

static double flip_hdr(void)
{
    struct picture_pair p = pair();
    struct flip_exposures exposures;
    double value = NAN;
    bool ok = metrics_flip_exposures(&p, NULL, &exposures) &&
              metrics_flip_hdr(&p, FLIP_PIXELS_PER_DEGREE, &exposures, NULL, NULL, &value);
    CHECK(ok);
    return value;
}

static double ssim(void)
{
    struct picture_pair p = pair();
    double value = NAN;
    bool ok = metrics_ssim(&p, NULL, &value);
    CHECK(ok);
    return value;
}

// Returns whether metric 0, 1 or 2 succeeds with this budget, in bytes.
static bool fits_into(int metric, const struct picture_pair *p, uint64_t bytes)
{
    const struct flip_exposures exposures = {0, 1, 2};
    double value;
    memory_set_budget(memory_used() + bytes);
    bool ok = metric == 0 ? metrics_ssim(p, NULL, &value)
              : metric == 1
                  ? metrics_flip(p, FLIP_PIXELS_PER_DEGREE, NULL, NULL, &value)
                  : metrics_flip_hdr(p, FLIP_PIXELS_PER_DEGREE, &exposures, NULL, NULL, &value);
    memory_set_budget(0);
    return ok;
}

// The reported memory equals the memory that the metrics take, except for pages that are not full.
TEST(bytes_that_are_told)
{
    enum { SIDE = 256, PAGES = 32 * 4096 };
    static const float zero[SIDE * SIDE][3];
    const struct picture_pair p = {zero, zero, SIDE, SIDE};
    const uint64_t bytes[3] = {metrics_ssim_bytes(SIDE, SIDE), metrics_flip_bytes(SIDE, SIDE),
                               metrics_flip_hdr_bytes(SIDE, SIDE)};
    for (int metric = 0; metric < 3; metric++) {
        CHECK(fits_into(metric, &p, bytes[metric] + PAGES), "%d: %llu", metric,
              (unsigned long long)bytes[metric]);
        CHECK(!fits_into(metric, &p, bytes[metric] - 1), "%d: %llu", metric,
              (unsigned long long)bytes[metric]);
        CHECK(memory_used() == 0, "all is given back");
    }
}

struct patience {
    _Atomic int polls;
    int most; // requests a stop after this many polls
};

static bool is_impatient(void *context)
{
    struct patience *patience = context;
    return ++patience->polls > patience->most;
}

// Wherever a stop is requested, the metrics end after a few more polls: one per thread and loop.
TEST(all_stop)
{
    enum { SIDE = 512, COUNT_OF_THESE = 8 };
    static float noise[SIDE * SIDE][3], means[SIDE * SIDE][3];
    const struct picture_pair p = {(const float(*)[3])noise, (const float(*)[3])noise, SIDE, SIDE};
    for (int metric = 0; metric < COUNT_OF_THESE; metric++)
        for (int most = 0; most < 3; most++) {
            struct patience patience = {.most = most};
            const struct progress progress = {.should_stop = is_impatient, .context = &patience};
            struct flip_exposures exposures = {0, 1, 2};
            struct metrics m;
            struct error_intervals intervals;
            double value = 0;
            bool done[COUNT_OF_THESE] = {
                metric == 0 && metrics_ssim(&p, &progress, &value),
                metric == 1 && metrics_flip(&p, FLIP_PIXELS_PER_DEGREE, &progress, NULL, &value),
                metric == 2 && metrics_flip_hdr(&p, FLIP_PIXELS_PER_DEGREE, &exposures, &progress,
                                                NULL, &value),
                metric == 3 && metrics_flip_exposures(&p, &progress, &exposures),
                metric == 4 && metrics_compare(p.image, p.reference, SIDE * SIDE, &progress, &m),
                metric == 5 &&
                    !isnan(metrics_psnr(p.image, p.reference, SIDE * SIDE, 0, &progress)),
                metric == 6 && metrics_intervals(p.image, p.reference, p.reference, SIDE, SIDE,
                                                 &progress, &intervals),
                metric == 7 && metrics_local_means(p.reference, SIDE, SIDE, &progress, means),
            };
            CHECK(!done[metric] && patience.polls > most, "%d: %d polls", metric, patience.polls);
        }
}

TEST(equal_pictures)
{
    make_pictures();
    memcpy(image, reference, sizeof image);
    CHECK(fabs(ssim() - 1) < 1e-12, "%.17g", ssim());
    CHECK(flip(FLIP_PIXELS_PER_DEGREE) == 0 && flip_hdr() == 0);
}

// 100^.7 between black and white, relative to the difference between green and blue.
TEST(black_and_white)
{
    fill(image, 0, 0, 0);
    fill(reference, 1, 1, 1);
    double value = flip(FLIP_PIXELS_PER_DEGREE);
    CHECK(fabs(value - 0.96738) < 2e-6, "%.9g", value);
    double c1 = 0.01 * 0.01; // without structure: (2ab + c1) / (a^2 + b^2 + c1)
    CHECK(fabs(ssim() - c1 / (1 + c1)) < 1e-9, "%.9g", ssim());
}

TEST(green_and_blue_are_the_farthest)
{
    fill(image, 0, 1, 0);
    fill(reference, 0, 0, 1);
    double value = flip(FLIP_PIXELS_PER_DEGREE);
    CHECK(fabs(value - 1) < 1e-6, "%.9g", value);
}

TEST(flip_is_symmetric_and_fades_with_the_distance)
{
    make_pictures();
    double there = flip(FLIP_PIXELS_PER_DEGREE), far = flip(2 * FLIP_PIXELS_PER_DEGREE);
    float kept[COUNT][3];
    memcpy(kept, image, sizeof kept);
    memcpy(image, reference, sizeof image);
    memcpy(reference, kept, sizeof reference);
    CHECK(flip(FLIP_PIXELS_PER_DEGREE) == there);
    CHECK(far < there, "%g of %g", far, there);
}

// --- pieces in closed form -----------------------------------------------------------------------

// Returns the greatest distance, between green and blue, from their CIE L*a*b* for D65 as in
// tables. a* and b* are scaled by L* / 100, and the distance is HyAB to the power of .7. The
// tables' white differs in the fifth digit, which changes results by 2e-5.
static double greatest(void)
{
    const double green[3] = {87.7347, -86.1827, 83.1793}, blue[3] = {32.2970, 79.1875, -107.8602};
    double a = 0.01 * (green[0] * green[1] - blue[0] * blue[1]);
    double b = 0.01 * (green[0] * green[2] - blue[0] * blue[2]);
    return pow(fabs(green[0] - blue[0]) + hypot(a, b), 0.7);
}

// Returns FLIP between two greys above .0089, which have no chroma, in images without features.
static double between_greys(double x, double y)
{
    double d = pow(fabs(116 * (cbrt(x) - cbrt(y))), 0.7), knee = 0.4 * greatest();
    return d < knee ? 0.95 * d / knee : 0.95 + 0.05 * (d - knee) / (greatest() - knee);
}

TEST(greys)
{
    static const float greys[][2] = {{0.5f, 0.51f}, {0.1f, 0.2f}, {0.02f, 0.9f}, {1, 0.3f}};
    for (size_t i = 0; i < sizeof greys / sizeof greys[0]; i++) {
        float a = greys[i][0], b = greys[i][1];
        fill(image, a, a, a);
        fill(reference, b, b, b);
        double expected = between_greys((double)a, (double)b), value = flip(FLIP_PIXELS_PER_DEGREE);
        CHECK(fabs(value - expected) < 2e-5, "%g and %g: %.9g, not %.9g", (double)a, (double)b,
              value, expected);
    }
}

// Next to a step of height h, the edge detector returns h, because its weights on either side sum
// to 1; the point detector returns less. Contrast sensitivity blurs the step by the Gaussian with b
// = .0047, part of which is beyond the edge.
TEST(a_step_in_an_even_picture)
{
    enum { EDGE = 12, RADIUS = 10 };
    const double step = 0.2, base = 0.4;
    fill(reference, (float)base, (float)base, (float)base);
    memcpy(image, reference, sizeof image);
    for (int i = 0; i < COUNT; i++)
        for (int c = 0; c < 3; c++)
            image[i][c] += i % WIDTH >= EDGE ? (float)step : 0;
    double part = 0, sum = 0;
    for (int i = -RADIUS; i <= RADIUS; i++) {
        double d = i / FLIP_PIXELS_PER_DEGREE;
        double weight = exp(-acos(-1.0) * acos(-1.0) * d * d / 0.0047);
        sum += weight;
        part += i >= 1 ? weight : 0;
    }
    double color = between_greys(base + step * part / sum, base);
    double expected = pow(color, 1 - sqrt(step / sqrt(2.0)));
    static float map[COUNT];
    struct picture_pair p = pair();
    double mean;
    CHECK(metrics_flip(&p, FLIP_PIXELS_PER_DEGREE, NULL, map, &mean));
    for (int y = 0; y < HEIGHT; y++) {
        double value = (double)map[y * WIDTH + EDGE - 1];
        CHECK(fabs(value - expected) < 1e-5, "row %d: %.9g, not %.9g", y, value, expected);
    }
}

static double aces(double x) // Narkowicz 2015, with the exposure .6
{
    x *= 0.6;
    return x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14);
}

// Each end of the reference's range is mapped to .85. A range of s stops takes ceil(s) exposures:
// 14 for the 13.485 stops of NVIDIA's own test images.
TEST(exposures)
{
    fill(reference, 0.03125f, 0.03125f, 0.03125f);
    float bright = (float)(0.03125 * exp2(13.485));
    for (int c = 0; c < 3; c++)
        reference[3][c] = bright;
    memcpy(image, reference, sizeof image);
    image[5][0] = NAN; // this pixel does not count
    struct picture_pair p = pair();
    struct flip_exposures found;
    CHECK(metrics_flip_exposures(&p, NULL, &found));
    CHECK(fabs(aces(exp2(found.start) * (double)bright) - 0.85) < 1e-6, "start %g", found.start);
    CHECK(fabs(aces(exp2(found.stop) * 0.03125) - 0.85) < 1e-6, "stop %g", found.stop);
    CHECK(found.count == 14, "%u", found.count);
}

// The reference is displayed as .85, whatever its value is, and the image as the curve maps it.
TEST(hdr_flip_of_even_pictures)
{
    fill(reference, 40, 40, 40);
    fill(image, 30, 30, 30);
    double x = 1; // the curve maps it to .85
    for (int i = 0; i < 100; i++)
        x -= (aces(x) - 0.85) / ((aces(x + 1e-6) - aces(x - 1e-6)) / 2e-6);
    double expected = between_greys(aces(0.75 * x), 0.85), value = flip_hdr();
    CHECK(fabs(value - expected) < 1e-5, "%.9g, not %.9g", value, expected);
}

// --- what must rise, and what must stay ----------------------------------------------------------

// Draws a bright bar, `shift` pixels to the right.
static void draw_bar(float (*out)[3], int shift, float brightness)
{
    fill(out, 0.2f, 0.25f, 0.3f);
    for (int i = 0; i < COUNT; i++)
        for (int c = 0; c < 3; c++)
            if (i % WIDTH >= 4 + shift && i % WIDTH < 7 + shift)
                out[i][c] = brightness;
}

TEST(rises_with_contrast)
{
    double before = 0;
    draw_bar(reference, 0, 0.3f);
    for (int i = 1; i <= 7; i++) {
        draw_bar(image, 0, 0.3f + 0.1f * (float)i);
        double value = flip(FLIP_PIXELS_PER_DEGREE);
        CHECK(value > before && value < 1, "step %d: %g after %g", i, value, before);
        before = value;
    }
}

TEST(rises_with_displacement)
{
    double before = 0;
    draw_bar(reference, 0, 0.9f);
    for (int shift = 1; shift <= 8; shift++) {
        draw_bar(image, shift, 0.9f);
        double value = flip(FLIP_PIXELS_PER_DEGREE);
        CHECK(value > before && value < 1, "shift %d: %g after %g", shift, value, before);
        before = value;
    }
}

// where() gives the place to which pixel i is moved. Means do not depend on the order of pixels,
// nor detectors on the direction.
static int mirrored(int i)
{
    return i / WIDTH * WIDTH + WIDTH - 1 - i % WIDTH;
}

static int upside_down(int i)
{
    return (HEIGHT - 1 - i / WIDTH) * WIDTH + i % WIDTH;
}

static void move_pixels(float (*pixels)[3], int (*where)(int))
{
    static float moved[COUNT][3];
    for (int i = 0; i < COUNT; i++)
        memcpy(moved[where(i)], pixels[i], sizeof moved[0]);
    memcpy(pixels, moved, sizeof moved);
}

static void transpose(const float (*pixels)[3], float (*out)[3])
{
    for (int i = 0; i < COUNT; i++)
        memcpy(out[i % WIDTH * HEIGHT + i / WIDTH], pixels[i], sizeof out[0]);
}

TEST(does_not_depend_on_the_direction)
{
    make_pictures();
    double before = flip(FLIP_PIXELS_PER_DEGREE);
    int (*const where[])(int) = {mirrored, upside_down};
    for (int i = 0; i < 2; i++) {
        move_pixels(image, where[i]);
        move_pixels(reference, where[i]);
        double value = flip(FLIP_PIXELS_PER_DEGREE);
        CHECK(fabs(value - before) < 1e-6, "%.9g, not %.9g", value, before);
    }
    static float turned[2][COUNT][3];
    transpose((const float(*)[3])image, turned[0]);
    transpose((const float(*)[3])reference, turned[1]);
    struct picture_pair p = {(const float(*)[3])turned[0], (const float(*)[3])turned[1], HEIGHT,
                             WIDTH};
    double value;
    CHECK(metrics_flip(&p, FLIP_PIXELS_PER_DEGREE, NULL, NULL, &value));
    CHECK(fabs(value - before) < 1e-6, "%.9g, not %.9g", value, before);
}

// Values that a display cannot show make no difference. A map's values are in [0, 1].
TEST(what_is_not_shown_is_no_difference)
{
    make_pictures();
    double before = flip(FLIP_PIXELS_PER_DEGREE);
    for (int i = 0; i < COUNT; i++)
        for (int c = 0; c < 3; c++)
            reference[i][c] = fmaxf(fminf(reference[i][c], 1), 0);
    CHECK(flip(FLIP_PIXELS_PER_DEGREE) == before);
    static float map[COUNT];
    struct picture_pair p = pair();
    double mean, sum = 0;
    CHECK(metrics_flip(&p, FLIP_PIXELS_PER_DEGREE, NULL, map, &mean));
    for (int i = 0; i < COUNT; i++) {
        CHECK(map[i] >= 0 && map[i] <= 1, "%g", (double)map[i]);
        sum += (double)map[i] / COUNT;
    }
    CHECK(fabs(sum - mean) < 1e-12);
}

// If both images are scaled, the exposures change accordingly.
TEST(hdr_flip_does_not_depend_on_the_exposure)
{
    make_pictures();
    double before = flip_hdr();
    for (int i = 0; i < COUNT; i++)
        for (int c = 0; c < 3; c++) {
            image[i][c] *= 1024;
            reference[i][c] *= 1024;
        }
    CHECK(fabs(flip_hdr() - before) < 1e-6 * before, "%.9g, not %.9g", flip_hdr(), before);
}

TEST(extreme_pictures)
{
    fill(image, 0, 0, 0);
    fill(reference, 0, 0, 0);
    CHECK(flip_hdr() == 0 && ssim() == 1);
    reference[5][1] = 1e30f; // with a median of 0 the number of stops reaches its limit
    image[7][0] = NAN;
    image[8][0] = INFINITY;
    image[9][2] = -1e30f;
    double hdr = flip_hdr(), ldr = flip(FLIP_PIXELS_PER_DEGREE), similarity = ssim();
    CHECK(hdr > 0 && hdr <= 1 && ldr > 0 && ldr <= 1, "%g, %g", hdr, ldr);
    CHECK(similarity > -1 && similarity < 1, "%g", similarity);
    struct picture_pair one = {(const float(*)[3])image, (const float(*)[3])reference, 1, 1};
    double value;
    CHECK(metrics_ssim(&one, NULL, &value) && value == 1, "%g", value);
    CHECK(metrics_flip(&one, FLIP_PIXELS_PER_DEGREE, NULL, NULL, &value) && value == 0, "%g",
          value);
}

static int print_values(void)
{
    make_pictures();
    printf("%.9g %.9g %.9g\n", ssim(), flip(FLIP_PIXELS_PER_DEGREE), flip_hdr());
    struct picture_pair p = pair();
    struct metrics m;
    struct error_intervals found;
    metrics_compare(p.image, p.reference, COUNT, NULL, &m);
    static float means[COUNT][3];
    bool ok = metrics_local_means(p.reference, WIDTH, HEIGHT, NULL, means);
    metrics_intervals(p.image, p.reference, (const float(*)[3])means, WIDTH, HEIGHT, NULL, &found);
    printf("%.9g %.9g %.9g %.9g %.9g\n", m.mse, m.relmse, m.smape, m.psnr,
           metrics_psnr(p.image, p.reference, COUNT, -2.5, NULL));
    printf("%.9g %.9g %.9g %.9g %.9g %.9g %.9g\n", found.mse.low, found.mse.high, found.relmse.low,
           found.relmse.high, found.local_relmse.value, found.local_relmse.low,
           found.local_relmse.high);
    static float map[COUNT];
    struct flip_exposures exposures;
    double mean;
    ok = ok && metrics_flip(&p, FLIP_PIXELS_PER_DEGREE, NULL, map, &mean);
    for (int i = 0; i < COUNT && ok; i++)
        printf("%.9g ", (double)map[i]);
    ok = ok && metrics_flip_exposures(&p, NULL, &exposures) &&
         metrics_flip_hdr(&p, FLIP_PIXELS_PER_DEGREE, &exposures, NULL, map, &mean);
    for (int i = 0; i < COUNT && ok; i++)
        printf("%.9g ", (double)map[i]);
    CHECK(ok);
    return test_failures > 0;
}

static const struct test_case cases[] = {
    TEST_CASE(bytes_that_are_told),
    TEST_CASE(all_stop),
    TEST_CASE(equal_pictures),
    TEST_CASE(black_and_white),
    TEST_CASE(green_and_blue_are_the_farthest),
    TEST_CASE(flip_is_symmetric_and_fades_with_the_distance),
    TEST_CASE(greys),
    TEST_CASE(a_step_in_an_even_picture),
    TEST_CASE(exposures),
    TEST_CASE(hdr_flip_of_even_pictures),
    TEST_CASE(rises_with_contrast),
    TEST_CASE(rises_with_displacement),
    TEST_CASE(does_not_depend_on_the_direction),
    TEST_CASE(what_is_not_shown_is_no_difference),
    TEST_CASE(hdr_flip_does_not_depend_on_the_exposure),
    TEST_CASE(extreme_pictures),
};

int main(int argc, char **argv)
{
    if (argc == 2 && strcmp(argv[1], "--values") == 0)
        return print_values();
    return test_run(cases, sizeof cases / sizeof cases[0], argc, argv);
}
