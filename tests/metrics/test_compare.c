#include "metrics.h"
#include "test.h"

static bool near(double a, double b)
{
    return fabs(a - b) <= 1e-12 * fabs(b);
}

TEST(compare_matches_hand_values)
{
    // Differences .5, 0, -1 in one pixel and 0, 0, 2 in the next: the squares sum to 5.25.
    const float image[2][3] = {{1.5f, 2, 0}, {4, 0, 5}};
    const float reference[2][3] = {{1, 2, 1}, {4, 0, 3}};
    struct metrics m;
    metrics_compare(image, reference, 2, &m);
    CHECK(near(m.mse, 5.25 / 6), "%.17g", m.mse);
    CHECK(near(m.rmse, sqrt(5.25 / 6)), "%.17g", m.rmse);
    CHECK(near(m.relmse, (0.25 / 1.01 + 1 / 1.01 + 4 / 9.01) / 6), "%.17g", m.relmse);
    CHECK(near(m.psnr, 10 * log10(6 / 5.25)), "%.17g", m.psnr);
    CHECK(m.max == 2 && m.max_pixel == 1);
    CHECK(m.nonfinite == 0 && m.differing == 2);
}

TEST(compare_of_equal_pictures)
{
    const float image[2][3] = {{1, 2, 3}, {0, -0.0f, 5}};
    struct metrics m;
    metrics_compare(image, image, 2, &m);
    CHECK(m.mse == 0 && m.rmse == 0 && m.relmse == 0 && m.max == 0 && m.differing == 0);
    CHECK(isinf(m.psnr) && m.psnr > 0);
    const float other[2][3] = {{1, 2, 3}, {-0.0f, -0.0f, 5}};
    metrics_compare(image, other, 2, &m);
    CHECK(m.mse == 0 && m.differing == 1, "the sign of zero is a different bit");
}

TEST(compare_leaves_out_what_is_not_finite)
{
    const float image[4][3] = {{1, NAN, 1}, {1, 1, 1}, {2, 2, 2}, {1, 1, 1}};
    const float reference[4][3] = {{9, 9, 9}, {1, INFINITY, 1}, {1, 1, 1}, {1, 1, 1}};
    struct metrics m;
    metrics_compare(image, reference, 4, &m);
    CHECK(m.nonfinite == 2 && m.mse == 0.5 && m.max == 1 && m.max_pixel == 2);
    metrics_compare(image, reference, 2, &m);
    CHECK(m.nonfinite == 2 && isnan(m.mse) && isnan(m.relmse) && isnan(m.psnr));
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
    metrics_compare((const float(*)[3])image, (const float(*)[3])reference, COUNT, &m);
    double expected = (4096.0 * 4096.0 + (COUNT - 1) * 0.0625) / COUNT;
    CHECK(near(m.mse, expected), "%.17g, expected %.17g", m.mse, expected);
    free(image);
    free(reference);
}

// The picture's colours at relative differences whose place on the scale is known.
TEST(difference_picture_colours)
{
    // The reference .99 makes the denominator 1; each value is the difference.
    static const struct {
        float difference;
        float colour[3];
    } cases[] = {
        {0, {0, 0, 0}},
        {1e-5f, {0, 0, 0}},
        {1e-4f, {0, 0, 0}},
        {1e-3f, {0, 0, 1}},
        {1e-2f, {0, 1, 0}},
        {1e-1f, {1, 1, 0}},
        {1, {1, 0, 0}},
        {1000, {1, 0, 0}},
        {NAN, {1, 0, 1}},
        {INFINITY, {1, 0, 1}},
        {3.1622777e-4f, {0, 0, 0.5f}},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        const float reference[1][3] = {{0.99f, 0.99f, 0.99f}};
        float value = 0.99f + cases[i].difference, out[1][3];
        const float image[1][3] = {{value, value, value}};
        metrics_difference_picture(image, reference, 1, out);
        for (int c = 0; c < 3; c++)
            CHECK(fabsf(out[0][c] - cases[i].colour[c]) < 2e-3f, "difference %g: %g %g %g",
                  (double)cases[i].difference, (double)out[0][0], (double)out[0][1],
                  (double)out[0][2]);
    }
}

TEST_MAIN(TEST_CASE(compare_matches_hand_values), TEST_CASE(compare_of_equal_pictures),
          TEST_CASE(compare_leaves_out_what_is_not_finite), TEST_CASE(compare_keeps_its_precision),
          TEST_CASE(difference_picture_colours))
