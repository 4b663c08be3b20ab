// Tests error maps as numbers, their scales and their colours.
#include "metrics/error_map.h"
#include "metrics/metrics.h"
#include "test.h"

enum { COUNT = 4 };
static const float image[COUNT][3] = {{1.5f, 2, 0}, {4, 0, 5}, {1, 1, 1}, {0, -1, 1e30f}};
static const float reference[COUNT][3] = {{1, 2, 1}, {4, 0, 3}, {1, 1, 1}, {0, 1, 1e30f}};

// The mean of a map's values is its metric.
TEST(means_are_the_metrics)
{
    struct metrics m;
    metrics_compare(image, reference, COUNT, NULL, &m);
    float values[COUNT][3];
    for (int map = ERROR_MAP_RELATIVE; map <= ERROR_MAP_SMAPE; map++) {
        error_map_values((enum error_map)map, image, reference, COUNT, values);
        double sum = 0;
        for (int i = 0; i < COUNT; i++)
            for (int c = 0; c < 3; c++)
                sum += (double)values[i][c] / (3 * COUNT);
        double expected = map == ERROR_MAP_SQUARED ? m.relmse
                          : map == ERROR_MAP_SMAPE
                              ? m.smape
                              : (0.5 / 1.01 + 1 / 1.01 + 2 / 3.01 + 2 / 1.01) / 12;
        CHECK(fabs(sum - expected) < 1e-6 * expected, "%s: %.9g, not %.9g", error_map_names[map],
              sum, expected);
    }
}

TEST(what_is_not_finite_has_no_number)
{
    const float bad[3][3] = {{1, NAN, 1}, {1, 1, INFINITY}, {1, 1, 1}};
    const float good[3][3] = {{1, 1, 1}, {1, 1, 1}, {1, 1, -INFINITY}};
    float values[3][3], colors[3][3];
    for (int map = ERROR_MAP_RELATIVE; map <= ERROR_MAP_SMAPE; map++) {
        error_map_values((enum error_map)map, bad, good, 3, values);
        error_map_picture((enum error_map)map, (const float(*)[3])values, 3, colors);
        for (int i = 0; i < 3; i++)
            CHECK(isnan(values[i][0]) && isnan(values[i][1]) && isnan(values[i][2]) &&
                      colors[i][0] == 0 && colors[i][1] == 1 && colors[i][2] == 0,
                  "%s", error_map_names[map]);
    }
}

TEST(levels)
{
    static const struct {
        enum error_map map;
        double value, level;
    } cases[] = {
        {ERROR_MAP_RELATIVE, 0, 0},       {ERROR_MAP_RELATIVE, 1e-5, 0},
        {ERROR_MAP_RELATIVE, 1e-3, 0.25}, {ERROR_MAP_RELATIVE, 1, 1},
        {ERROR_MAP_RELATIVE, 1000, 1},    {ERROR_MAP_RELATIVE, INFINITY, 1},
        {ERROR_MAP_SQUARED, 1e-3, 0.5},   {ERROR_MAP_SMAPE, 1e-2, 0.5},
        {ERROR_MAP_FLIP, 0.3, 0.3},       {ERROR_MAP_FLIP, 0, 0},
        {ERROR_MAP_HDR_FLIP, 1, 1},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        double level = error_map_level(cases[i].map, cases[i].value);
        CHECK(fabs(level - cases[i].level) < 1e-12, "%s of %g: %g", error_map_names[cases[i].map],
              cases[i].value, level);
    }
    CHECK(isnan(error_map_level(ERROR_MAP_FLIP, NAN)));
}

static double linear(double shown)
{
    return shown <= 0.04045 ? shown / 12.92 : pow((shown + 0.055) / 1.055, 2.4);
}

// Returns Oklab's L of linear Rec. 709, by the matrices of Ottosson 2020.
static double lightness(const float color[3])
{
    double r = linear((double)color[0]), g = linear((double)color[1]), b = linear((double)color[2]);
    return 0.2104542553 * cbrt(0.4122214708 * r + 0.5363325363 * g + 0.0514459929 * b) +
           0.7936177850 * cbrt(0.2119034982 * r + 0.6806995451 * g + 0.1073969566 * b) -
           0.0040720468 * cbrt(0.0883024619 * r + 0.2817188376 * g + 0.6299787005 * b);
}

TEST(lightness_rises_evenly)
{
    float palette[ERROR_MAP_COLORS][3];
    error_map_palette(palette);
    CHECK(palette[0][0] == 0 && palette[0][1] == 0 && palette[0][2] == 0);
    for (int i = 1; i < ERROR_MAP_COLORS; i++) {
        double wanted = 0.97 * i / (ERROR_MAP_COLORS - 1), step = 0;
        for (int c = 0; c < 3; c++) {
            CHECK(palette[i][c] >= 0 && palette[i][c] <= 1);
            step = fmax(step, fabs((double)palette[i][c] - (double)palette[i - 1][c]));
        }
        CHECK(fabs(lightness(palette[i]) - wanted) < 1e-6, "%d: %g, not %g", i,
              lightness(palette[i]), wanted);
        CHECK(step < 0.03, "%d: a step of %g shows", i, step);
    }
}

TEST(pictures_show_the_mean_of_the_channels)
{
    const float values[3][3] = {{3e-3f, 0, 0}, {1e-3f, 1e-3f, 1e-3f}, {0, 0, 0}};
    float colors[3][3];
    error_map_picture(ERROR_MAP_RELATIVE, values, 3, colors);
    CHECK(memcmp(colors[0], colors[1], sizeof colors[0]) == 0 && colors[0][0] > 0);
    CHECK(colors[2][0] == 0 && colors[2][1] == 0 && colors[2][2] == 0);
}

TEST_MAIN(TEST_CASE(means_are_the_metrics), TEST_CASE(what_is_not_finite_has_no_number),
          TEST_CASE(levels), TEST_CASE(lightness_rises_evenly),
          TEST_CASE(pictures_show_the_mean_of_the_channels))
