// The mean of an image around each pixel, to which the local relMSE relates errors. Internal to
// this module.
//
// The window is that of SSIM (Wang, Bovik, Sheikh and Simoncelli 2004, "Image Quality Assessment:
// From Error Visibility to Structural Similarity", section III.C): a Gaussian with a standard
// deviation of 1.5 pixels, over 11 x 11 pixels. Pixels outside of the image and pixels that are not
// finite are left out, and the weights of the others are scaled to a sum of 1.
#ifndef LAMPYRIS_METRICS_LOCAL_MEAN_H
#define LAMPYRIS_METRICS_LOCAL_MEAN_H

#include <stdbool.h>
#include <stdint.h>

enum { LOCAL_REACH = 5, LOCAL_ROWS = 2 * LOCAL_REACH + 1 };

struct local_pixel {
    double mean[3];
    double noise[3]; // the variance of `mean`
    // 1, or 0 if the pixel is not finite; then it is left out and the other members are 0.
    double part;
};

// The mean over the neighbours of a pixel, without the pixel itself.
struct local_mean {
    double mean[3];
    double mean_noise[3]; // the variance of `mean`
    double noise[3];      // mean variance of a neighbour
    // Fraction of the window's weight at the pixel itself; 1 if it has no finite neighbours.
    double own;
};

typedef void (*local_load_fn)(const void *context, uint64_t pixel, struct local_pixel *out);

// A window that moves over the rows from top to bottom. `load` returns a pixel; it is called once
// for each pixel.
struct local_window {
    local_load_fn load;
    const void *context;
    uint32_t width, height;
    uint32_t loaded;              // number of rows loaded so far
    struct local_pixel *pixels;   // the last LOCAL_ROWS rows, row y at y % LOCAL_ROWS
    struct local_column *columns; // for each column, the sums over the rows around the current one
    struct local_column *others;  // the same sums without the current row
};

// Initialises a window. Returns false when out of memory; call local_window_finish() in any case.
bool local_window_init(struct local_window *window, uint32_t width, uint32_t height,
                       local_load_fn load, const void *context);
void local_window_finish(struct local_window *window);
// Restarts at row y. Rows above y are loaded only as far as its neighbourhood needs them.
void local_window_start(struct local_window *window, uint32_t y);
// Moves to row y, for local_mean_at(): the first row, or the row after the previous one.
void local_window_enter(struct local_window *window, uint32_t y);
void local_mean_at(const struct local_window *window, uint32_t x, struct local_mean *out);
// Returns the weight of a neighbour, at most LOCAL_REACH pixels away on each axis, relative to the
// weight 1 of the pixel itself.
double local_window_weight(int dx, int dy);

// The weight of a squared error if the pixel's own value is known: a third of 1 / (L^2 + epsilon),
// for three channels, and its derivative with respect to the neighbours' mean. It accounts for the
// noise of that mean as described in half_error.c.
struct local_weight {
    double value, slope;
};
struct local_weight local_weigh(double own_value, const struct local_mean *around, int channel);

#endif
