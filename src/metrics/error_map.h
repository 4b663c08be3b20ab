// Maps of errors: the contribution of each pixel to a metric, as numbers and in false colours.
#ifndef LAMPYRIS_METRICS_ERROR_MAP_H
#define LAMPYRIS_METRICS_ERROR_MAP_H

#include <stdbool.h>
#include <stdint.h>

enum error_map {
    ERROR_MAP_RELATIVE, // |x - r| / (|r| + 1e-2)
    ERROR_MAP_SQUARED,  // (x - r)^2 / (r^2 + 1e-2), whose mean is relmse
    ERROR_MAP_SMAPE,    // 2 |x - r| / (|x| + |r| + 1e-6), whose mean is smape
    ERROR_MAP_FLIP,     // by metrics_flip and metrics_flip_hdr; one number per pixel
    ERROR_MAP_HDR_FLIP,
    ERROR_MAP_TOTAL
};

extern const char *const error_map_names[ERROR_MAP_TOTAL];

// Computes the first three maps, for each channel. NaN for pixels that are not finite in either
// image.
void error_map_values(enum error_map map, const float (*image)[3], const float (*reference)[3],
                      uint64_t count, float (*out)[3]);

// The errors that are shown in black and in the last colour; values outside of this range are
// clamped.
struct error_scale {
    double low, high;
    bool is_logarithmic;
};
struct error_scale error_map_scale(enum error_map map);
// Returns a value's position on the scale, in [0, 1]; NaN for NaN.
double error_map_level(enum error_map map, double value);

// The colours of levels 0 to 1 in equal steps, as display values: black, violet, red, orange, pale
// yellow. Lightness increases evenly, so that the order is also visible in shades of grey.
enum { ERROR_MAP_COLORS = 257 };
void error_map_palette(float out[ERROR_MAP_COLORS][3]);

// Computes false colours, as display values, of a map's mean over channels. NaN is shown in green,
// which is not in the palette.
void error_map_picture(enum error_map map, const float (*values)[3], uint64_t count,
                       float (*out)[3]);

#endif
