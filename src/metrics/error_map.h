// Error maps: each pixel's contribution to an error metric, as numbers or in false colours.
#ifndef LAMPYRIS_METRICS_ERROR_MAP_H
#define LAMPYRIS_METRICS_ERROR_MAP_H

#include <stdbool.h>
#include <stdint.h>

enum error_map {
    ERROR_MAP_RELATIVE, // |x - r| / (|r| + 1e-2)
    ERROR_MAP_SQUARED,  // (x - r)^2 / (r^2 + 1e-2), whose mean is relmse
    ERROR_MAP_SMAPE,    // 2 |x - r| / (|x| + |r| + 1e-6), whose mean is smape
    ERROR_MAP_FLIP,     // computed by metrics_flip() or metrics_flip_hdr(); one number per pixel
    ERROR_MAP_HDR_FLIP,
    ERROR_MAP_TOTAL
};

extern const char *const error_map_names[ERROR_MAP_TOTAL];

// Computes one of the first three maps, one number per channel. Pixels that are not finite in
// either image are NaN.
void error_map_values(enum error_map map, const float (*image)[3], const float (*reference)[3],
                      uint64_t count, float (*out)[3]);

// The errors that have the first and the last colour of the palette; values outside of this range
// are clamped.
struct error_scale {
    double low, high;
    bool is_logarithmic;
};
struct error_scale error_map_scale(enum error_map map);
// Returns the position, in [0, 1], of an error on the map's scale; NaN for NaN.
double error_map_level(enum error_map map, double value);

// The palette has colours, as display values, for levels from 0 to 1 in equal steps: black, violet,
// red, orange, pale yellow. Lightness increases evenly, so that the order is visible in greyscale
// as well.
enum { ERROR_MAP_COLORS = 257 };
void error_map_palette(float out[ERROR_MAP_COLORS][3]);

// Computes the colours, as display values, of a map's mean over channels. NaN is shown in green,
// which is not in the palette.
void error_map_picture(enum error_map map, const float (*values)[3], uint64_t count,
                       float (*out)[3]);

#endif
