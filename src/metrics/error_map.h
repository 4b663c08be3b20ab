// Maps of errors: what each pixel adds to a metric, as numbers and in false colours.
#ifndef LAMPYRIS_METRICS_ERROR_MAP_H
#define LAMPYRIS_METRICS_ERROR_MAP_H

#include <stdbool.h>
#include <stdint.h>

enum error_map {
    ERROR_MAP_RELATIVE, // |x - r| / (|r| + 1e-2)
    ERROR_MAP_SQUARED,  // (x - r)^2 / (r^2 + 1e-2), whose mean is relmse
    ERROR_MAP_SMAPE,    // 2 |x - r| / (|x| + |r| + 1e-6), whose mean is smape
    ERROR_MAP_FLIP,     // by metrics_flip and metrics_flip_hdr; one number a pixel
    ERROR_MAP_HDR_FLIP,
    ERROR_MAP_TOTAL
};

extern const char *const error_map_names[ERROR_MAP_TOTAL];

// The first three maps, of each channel. NaN in pixels that are not finite in either picture.
void error_map_values(enum error_map map, const float (*image)[3], const float (*reference)[3],
                      uint64_t count, float (*out)[3]);

// The errors that are black and that have the last colour; more and less look the same.
struct error_scale {
    double low, high;
    bool is_logarithmic;
};
struct error_scale error_map_scale(enum error_map map);
// A value's place on the scale, in [0, 1]; NaN of NaN.
double error_map_level(enum error_map map, double value);

// Colours of levels 0 to 1 in equal steps, as display values: black, violet, red, orange, pale
// yellow. Lightness rises evenly, so that they keep their order in shades of grey, too.
enum { ERROR_MAP_COLORS = 257 };
void error_map_palette(float out[ERROR_MAP_COLORS][3]);

// False colours, as display values, of numbers that a map has: of the channels' mean. Green, which
// the palette has not, where that is NaN.
void error_map_picture(enum error_map map, const float (*values)[3], uint64_t count,
                       float (*out)[3]);

#endif
