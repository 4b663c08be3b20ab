// SSIM and FLIP: what is known of them. `test_metrics_perceptual --values` prints those of two
// pictures made here, which perceptual.py computes in another way.
#include "perceptual.h"
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

// Noise in [0, scale) from a linear congruential generator that the script repeats.
static void add_noise(float (*out)[3], uint32_t seed, float scale)
{
    for (int i = 0; i < COUNT; i++)
        for (int c = 0; c < 3; c++) {
            seed = seed * 1664525u + 1013904223u;
            out[i][c] += scale * (float)(seed >> 8) * 0x1p-24f;
        }
}

// A ramp with a bright square, and the same with noise.
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
    bool ok = metrics_flip(&p, pixels_per_degree, NULL, &value);
    CHECK(ok);
    return value;
}

static double flip_hdr(void)
{
    struct picture_pair p = pair();
    struct flip_exposures exposures;
    double value = NAN;
    bool ok = metrics_flip_exposures(&p, &exposures) &&
              metrics_flip_hdr(&p, FLIP_PIXELS_PER_DEGREE, &exposures, NULL, NULL, &value);
    CHECK(ok);
    return value;
}

static double ssim(void)
{
    struct picture_pair p = pair();
    double value = NAN;
    bool ok = metrics_ssim(&p, &value);
    CHECK(ok);
    return value;
}

TEST(equal_pictures)
{
    make_pictures();
    memcpy(image, reference, sizeof image);
    CHECK(fabs(ssim() - 1) < 1e-12, "%.17g", ssim());
    CHECK(flip(FLIP_PIXELS_PER_DEGREE) == 0 && flip_hdr() == 0);
}

// 100^.7 between black and white, against that between green and blue.
TEST(black_and_white)
{
    fill(image, 0, 0, 0);
    fill(reference, 1, 1, 1);
    double value = flip(FLIP_PIXELS_PER_DEGREE);
    CHECK(fabs(value - 0.96738) < 2e-6, "%.9g", value);
    double c1 = 0.01 * 0.01; // no structure: (2ab + c1) / (a^2 + b^2 + c1)
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

// Scaling both pictures moves the exposures with them.
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
    reference[5][1] = 1e30f; // a median of 0: as many stops as are allowed
    image[7][0] = NAN;
    image[8][0] = INFINITY;
    image[9][2] = -1e30f;
    double hdr = flip_hdr(), ldr = flip(FLIP_PIXELS_PER_DEGREE), similarity = ssim();
    CHECK(hdr > 0 && hdr <= 1 && ldr > 0 && ldr <= 1, "%g, %g", hdr, ldr);
    CHECK(similarity > -1 && similarity < 1, "%g", similarity);
    struct picture_pair one = {(const float(*)[3])image, (const float(*)[3])reference, 1, 1};
    double value;
    CHECK(metrics_ssim(&one, &value) && value == 1, "%g", value);
    CHECK(metrics_flip(&one, FLIP_PIXELS_PER_DEGREE, NULL, &value) && value == 0, "%g", value);
}

static int print_values(void)
{
    make_pictures();
    printf("%.9g %.9g %.9g\n", ssim(), flip(FLIP_PIXELS_PER_DEGREE), flip_hdr());
    return test_failures > 0;
}

static const struct test_case cases[] = {
    TEST_CASE(equal_pictures),
    TEST_CASE(black_and_white),
    TEST_CASE(green_and_blue_are_the_farthest),
    TEST_CASE(flip_is_symmetric_and_fades_with_the_distance),
    TEST_CASE(hdr_flip_does_not_depend_on_the_exposure),
    TEST_CASE(extreme_pictures),
};

int main(int argc, char **argv)
{
    if (argc == 2 && strcmp(argv[1], "--values") == 0)
        return print_values();
    return test_run(cases, sizeof cases / sizeof cases[0], argc, argv);
}
