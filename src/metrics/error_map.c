#include "metrics/error_map.h"

#include "base/false_color.h"
#include "metrics/metrics.h"
#include "metrics/pixel.h"
#include <string.h>

const char *const error_map_names[ERROR_MAP_TOTAL] = {"relative", "squared", "smape", "flip",
                                                      "hdr-flip"};

static double value_of(enum error_map map, double x, double r)
{
    double d = fabs(x - r);
    if (map == ERROR_MAP_SQUARED)
        return d * d / (r * r + METRICS_RELMSE_EPSILON);
    if (map == ERROR_MAP_SMAPE)
        return 2 * d / (fabs(x) + fabs(r) + METRICS_SMAPE_EPSILON);
    return d / (fabs(r) + METRICS_RELMSE_EPSILON);
}

void error_map_values(enum error_map map, const float (*image)[3], const float (*reference)[3],
                      uint64_t count, float (*out)[3])
{
    for (uint64_t i = 0; i < count; i++) {
        bool finite = pixel_is_finite(image[i]) && pixel_is_finite(reference[i]);
        for (int c = 0; c < 3; c++)
            out[i][c] = finite ? (float)value_of(map, image[i][c], reference[i][c]) : NAN;
    }
}

struct error_scale error_map_scale(enum error_map map)
{
    static const struct error_scale scales[ERROR_MAP_TOTAL] = {
        [ERROR_MAP_RELATIVE] = {1e-4, 1, true}, [ERROR_MAP_SQUARED] = {1e-6, 1, true},
        [ERROR_MAP_SMAPE] = {1e-4, 1, true},    [ERROR_MAP_FLIP] = {0, 1, false},
        [ERROR_MAP_HDR_FLIP] = {0, 1, false},
    };
    return scales[map];
}

double error_map_level(enum error_map map, double value)
{
    struct error_scale scale = error_map_scale(map);
    if (isnan(value))
        return NAN;
    // The logarithm of 0 is -inf, which is clamped below.
    double level = scale.is_logarithmic ? log10(value / scale.low) / log10(scale.high / scale.low)
                                        : (value - scale.low) / (scale.high - scale.low);
    return fmin(fmax(level, 0), 1);
}

// --- colours -------------------------------------------------------------------------------------

void error_map_palette(float out[ERROR_MAP_COLORS][3])
{
    for (int i = 0; i < ERROR_MAP_COLORS; i++) {
        double rgb[3];
        false_color(i / (double)(ERROR_MAP_COLORS - 1), rgb);
        for (int c = 0; c < 3; c++)
            out[i][c] = (float)display_value(rgb[c]);
    }
}

static void pick(const float (*palette)[3], double level, float out[3])
{
    static const float none[3] = {0, 1, 0};
    int i = isnan(level) ? -1 : (int)(level * (ERROR_MAP_COLORS - 1) + 0.5);
    memcpy(out, i < 0 ? none : palette[i], 3 * sizeof *out);
}

void error_map_picture(enum error_map map, const float (*values)[3], uint64_t count,
                       float (*out)[3])
{
    float palette[ERROR_MAP_COLORS][3];
    error_map_palette(palette);
    for (uint64_t i = 0; i < count; i++) {
        double mean = ((double)values[i][0] + (double)values[i][1] + (double)values[i][2]) / 3;
        pick((const float(*)[3])palette, error_map_level(map, mean), out[i]);
    }
}

void metrics_difference_picture(const float (*image)[3], const float (*reference)[3],
                                uint64_t pixel_count, float (*out)[3])
{
    error_map_values(ERROR_MAP_RELATIVE, image, reference, pixel_count, out);
    error_map_picture(ERROR_MAP_RELATIVE, (const float(*)[3])out, pixel_count, out);
}
