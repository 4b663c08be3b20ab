#include "metrics/metrics.h"
#include "random.h"
#include "test.h"

static bool near(double a, double b)
{
    return fabs(a - b) <= 1e-12 * fabs(b);
}

TEST(compare_matches_hand_values)
{
    // The differences are .5, 0, -1 in one pixel and 0, 0, 2 in the next, so the squares sum to
    // 5.25.
    const float image[2][3] = {{1.5f, 2, 0}, {4, 0, 5}};
    const float reference[2][3] = {{1, 2, 1}, {4, 0, 3}};
    struct metrics m;
    metrics_compare(image, reference, 2, NULL, &m);
    CHECK(near(m.mse, 5.25 / 6), "%.17g", m.mse);
    CHECK(near(m.rmse, sqrt(5.25 / 6)), "%.17g", m.rmse);
    CHECK(near(m.relmse, (0.25 / 1.01 + 1 / 1.01 + 4 / 9.01) / 6), "%.17g", m.relmse);
    // After clamping to the display's range only the blue of the first pixel differs: 0 and 1.
    CHECK(near(m.psnr, 10 * log10(6)), "%.17g", m.psnr);
    CHECK(m.max == 2 && m.max_pixel == 1);
    CHECK(m.nonfinite == 0 && m.differing == 2);
}

TEST(compare_of_equal_pictures)
{
    const float image[2][3] = {{1, 2, 3}, {0, -0.0f, 5}};
    struct metrics m;
    metrics_compare(image, image, 2, NULL, &m);
    CHECK(m.mse == 0 && m.rmse == 0 && m.relmse == 0 && m.max == 0 && m.differing == 0);
    CHECK(isinf(m.psnr) && m.psnr > 0);
    const float other[2][3] = {{1, 2, 3}, {-0.0f, -0.0f, 5}};
    metrics_compare(image, other, 2, NULL, &m);
    CHECK(m.mse == 0 && m.differing == 1, "the sign of zero is a different bit");
}

TEST(compare_leaves_out_what_is_not_finite)
{
    const float image[4][3] = {{1, NAN, 1}, {1, 1, 1}, {2, 2, 2}, {1, 1, 1}};
    const float reference[4][3] = {{9, 9, 9}, {1, INFINITY, 1}, {1, 1, 1}, {1, 1, 1}};
    struct metrics m;
    metrics_compare(image, reference, 4, NULL, &m);
    CHECK(m.nonfinite == 2 && m.mse == 0.5 && m.max == 1 && m.max_pixel == 2);
    metrics_compare(image, reference, 2, NULL, &m);
    CHECK(m.nonfinite == 2 && isnan(m.mse) && isnan(m.relmse) && isnan(m.psnr));
}

TEST(psnr_is_of_what_is_shown)
{
    // In the linear part of the curve, with slope 12.92, an error of .001 becomes 12.92 times as
    // large.
    const float image[2][3] = {{0.002f, 0, 0}, {7, 0, 0}},
                reference[2][3] = {{0.001f, 0, 0}, {9, 0, 0}};
    double shown = 12.92 * ((double)0.002f - (double)0.001f);
    double value = metrics_psnr(image, reference, 2, 0, NULL);
    CHECK(near(value, -10 * log10(shown * shown / 6)), "%.17g", value);
    value = metrics_psnr(image, reference, 2, -1, NULL);
    CHECK(near(value, -10 * log10(shown * shown / 24)), "%.17g", value);
    value = metrics_psnr(image, reference, 2, -5, NULL); // 7/32 and 9/32 are in the curved part
    double a = 1.055 * pow(7 / 32.0, 1 / 2.4) - 0.055, b = 1.055 * pow(9 / 32.0, 1 / 2.4) - 0.055;
    double both = (shown * shown / 1024 + (a - b) * (a - b)) / 6;
    CHECK(fabs(value + 10 * log10(both)) < 1e-9, "%.17g", value);
    CHECK(isinf(metrics_psnr(image + 1, reference + 1, 1, 0, NULL)), "both are shown as white");
    CHECK(isinf(metrics_psnr(image, image, 2, 1000, NULL)), "0 times infinity");
}

TEST(compare_keeps_its_precision)
{
    // A single-precision sum would stop growing after 2^24 such terms.
    enum { COUNT = 200000 };
    float(*image)[3] = calloc(COUNT, sizeof *image), (*reference)[3] = calloc(COUNT, sizeof *image);
    REQUIRE(image && reference);
    for (int i = 0; i < COUNT; i++)
        image[i][0] = image[i][1] = image[i][2] = i == 0 ? 4096.0f : 0.25f;
    struct metrics m;
    metrics_compare((const float(*)[3])image, (const float(*)[3])reference, COUNT, NULL, &m);
    double expected = (4096.0 * 4096.0 + (COUNT - 1) * 0.0625) / COUNT;
    CHECK(near(m.mse, expected), "%.17g, expected %.17g", m.mse, expected);
    free(image);
    free(reference);
}

// Images of 32 x 24 pixels; the variance of the left half is ten times that of the right half.
// Seeds are draws of the generator.
TEST(intervals_cover_the_error)
{
    enum { WIDTH = 32, HEIGHT = 24, COUNT = WIDTH * HEIGHT, DRAWS = 1000 };
    static float image[COUNT][3], reference[COUNT][3];
    // E (x - r)^2 = sigma^2; r is .5.
    double truth[3] = {0.0011 / 2, 0.0011 / 2 / 0.26, 0.0011 / 2 / 0.26};
    int covered[3] = {0};
    for (int d = 0; d < DRAWS; d++) {
        for (int i = 0; i < COUNT; i++)
            for (int c = 0; c < 3; c++) {
                reference[i][c] = 0.5f;
                image[i][c] = (float)(0.5 + sqrt(i % WIDTH < 16 ? 1e-3 : 1e-4) * normal());
            }
        struct error_intervals found;
        metrics_intervals((const float(*)[3])image, (const float(*)[3])reference,
                          (const float(*)[3])reference, WIDTH, HEIGHT, NULL, &found);
        const struct interval list[3] = {found.mse, found.relmse, found.local_relmse};
        for (int k = 0; k < 3; k++)
            covered[k] += list[k].low <= truth[k] && truth[k] <= list[k].high;
    }
    printf("  covered: %d, %d and %d of %d\n", covered[0], covered[1], covered[2], DRAWS);
    // Differences between parts widen the intervals: they contain the truth in at least 95 % of
    // draws. The 99.9 % range of the count is +-23 of 1,000.
    for (int k = 0; k < 3; k++)
        CHECK(covered[k] >= 927, "%d", covered[k]);
}

// With the same variance everywhere, and tiles cut off at the border, coverage is neither more nor
// less than 95 %.
TEST(intervals_of_even_noise_are_no_wider_than_need_be)
{
    enum { WIDTH = 41, HEIGHT = 27, COUNT = WIDTH * HEIGHT, DRAWS = 1000 };
    static float image[COUNT][3], reference[COUNT][3];
    int covered[2] = {0};
    for (int d = 0; d < DRAWS; d++) {
        for (int i = 0; i < COUNT; i++)
            for (int c = 0; c < 3; c++)
                image[i][c] = (float)(0.1 * normal());
        struct error_intervals found;
        metrics_intervals((const float(*)[3])image, (const float(*)[3])reference,
                          (const float(*)[3])reference, WIDTH, HEIGHT, NULL, &found);
        covered[0] += found.mse.low <= 0.01 && 0.01 <= found.mse.high;
        covered[1] += found.relmse.low <= 1 && 1 <= found.relmse.high;
    }
    printf("  covered: %d and %d of %d\n", covered[0], covered[1], DRAWS);
    for (int k = 0; k < 2; k++)
        CHECK(covered[k] >= 927 && covered[k] <= 973, "%d", covered[k]);
}

TEST(intervals_of_what_is_hardly_there)
{
    const float image[4][3] = {{1, NAN, 1}, {1, 1, 1}, {2, 2, 2}, {1, 1, 1}};
    const float reference[4][3] = {{9, 9, 9}, {1, INFINITY, 1}, {1, 1, 1}, {1, 1, 1}};
    struct error_intervals found;
    const struct interval *mse = &found.mse;
    metrics_intervals(image, reference, reference, 2, 2, NULL,
                      &found); // tiles of one pixel, of which two are left
    CHECK(mse->value == 0.5 && isfinite(mse->low) && mse->high > 0.5, "%g %g %g", mse->low,
          mse->value, mse->high);
    metrics_intervals(image + 2, reference + 2, reference + 2, 1, 1, NULL, &found);
    CHECK(mse->value == 1 && isnan(mse->low) && isnan(mse->high));
    metrics_intervals(image, reference, reference, 2, 1, NULL, &found);
    CHECK(isnan(mse->value) && isnan(found.relmse.value) && isnan(mse->low));
    CHECK(isnan(found.local_relmse.value));
    metrics_intervals(image, image + 1, image + 1, 1, 1, NULL, &found);
    metrics_intervals(reference + 2, reference + 2, reference + 2, 2, 1, NULL, &found);
    CHECK(mse->value == 0 && mse->low == 0 && mse->high == 0);
}

TEST_MAIN(TEST_CASE(compare_matches_hand_values), TEST_CASE(compare_of_equal_pictures),
          TEST_CASE(compare_leaves_out_what_is_not_finite), TEST_CASE(compare_keeps_its_precision),
          TEST_CASE(psnr_is_of_what_is_shown), TEST_CASE(intervals_cover_the_error),
          TEST_CASE(intervals_of_even_noise_are_no_wider_than_need_be),
          TEST_CASE(intervals_of_what_is_hardly_there))
