// The mean of an image around a pixel, relative to which the local relMSE measures errors. Internal
// to the module.
//
// The window is the one of SSIM (Wang, Bovik, Sheikh and Simoncelli 2004, "Image Quality
// Assessment: From Error Visibility to Structural Similarity", section III.C): a Gaussian with a
// standard deviation of 1.5 pixels over 11 x 11 of them. At the picture's border, and where pixels
// are not finite, the weights of the others are scaled to a sum of one.
#ifndef LAMPYRIS_METRICS_LOCAL_MEAN_H
#define LAMPYRIS_METRICS_LOCAL_MEAN_H

#include <stdbool.h>
#include <stdint.h>

enum { LOCAL_REACH = 5, LOCAL_ROWS = 2 * LOCAL_REACH + 1 };

struct local_pixel {
    double mean[3];
    double noise[3]; // the variance of `mean`
    double part;     // 1, or 0: not finite, and left out; the others are 0 then
};

// The neighbours of a pixel, without the pixel itself.
struct local_mean {
    double mean[3];
    double mean_noise[3]; // the variance of `mean`
    double noise[3];      // the mean of the neighbours' noise
    double own;           // the pixel's share of the window's weight; 1 without finite neighbours
};

typedef void (*local_load_fn)(const void *context, uint64_t pixel, struct local_pixel *out);

// Advances over rows from top to bottom. `load` provides the pixels, each of them once.
struct local_window {
    local_load_fn load;
    const void *context;
    uint32_t width, height;
    uint32_t loaded;              // the rows before this one have been loaded
    struct local_pixel *pixels;   // the last LOCAL_ROWS rows, row y at y % LOCAL_ROWS
    struct local_column *columns; // sums over the rows around the present one
    struct local_column *others;  // the same without the current one
};

// Returns false when out of memory; call local_window_finish() in any case.
bool local_window_init(struct local_window *window, uint32_t width, uint32_t height,
                       local_load_fn load, const void *context);
void local_window_finish(struct local_window *window);
// Restarts at a row; the rows above it are only loaded for its neighbourhood.
void local_window_start(struct local_window *window, uint32_t y);
// Makes row y, the first or the one after the last, ready for local_mean_at().
void local_window_enter(struct local_window *window, uint32_t y);
void local_mean_at(const struct local_window *window, uint32_t x, struct local_mean *out);
// Returns the window's weight of a neighbour, at most LOCAL_REACH pixels away on each axis; that of
// the pixel itself is 1.
double local_window_weight(int dx, int dy);

// The weight of a squared error for a known value of the pixel, a third of 1 / (L^2 + epsilon), and
// its derivative by the neighbours' mean. half_error.c accounts for the noise of that mean.
struct local_weight {
    double value, slope;
};
struct local_weight local_weigh(double own_value, const struct local_mean *around, int channel);

#endif
