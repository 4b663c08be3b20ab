// The Gaussian is separable: for each row, sums down the columns are computed, and each pixel adds
// the sums of the columns around it. The neighbours' sum never includes the pixel itself, because
// subtracting a very bright pixel afterwards would leave its rounding error.
#include "metrics/local_mean.h"

#include "metrics/metrics.h"
#include <math.h>

#include <stdlib.h>
#include <string.h>

// Weighted sums of one column. The sums with squared weights give the variance of the mean.
struct local_column {
    double mean[3], noise[3], mean_noise[3];
    double part;
};

// exp(-d^2 / (2 1.5^2)) for d = 0 … 5, not normalised.
static const double gaussian[LOCAL_REACH + 1] = {
    1,
    0.8007374029168081,
    0.41111229050718745,
    0.1353352832366127,
    0.028565500784550377,
    0.0038659201394728076,
};

double local_window_weight(int dx, int dy)
{
    return gaussian[abs(dx)] * gaussian[abs(dy)];
}

bool local_window_init(struct local_window *window, uint32_t width, uint32_t height,
                       local_load_fn load, const void *context)
{
    *window = (struct local_window){
        .load = load,
        .context = context,
        .width = width,
        .height = height,
        .pixels = calloc((size_t)width * LOCAL_ROWS, sizeof *window->pixels),
        .columns = calloc(width, sizeof *window->columns),
        .others = calloc(width, sizeof *window->others),
    };
    return window->pixels && window->columns && window->others;
}

void local_window_finish(struct local_window *window)
{
    free(window->pixels);
    free(window->columns);
    free(window->others);
}

// Returns the first row in the window of row y.
static uint32_t first_row(uint32_t y)
{
    return y > LOCAL_REACH ? y - LOCAL_REACH : 0;
}

void local_window_start(struct local_window *window, uint32_t y)
{
    window->loaded = first_row(y);
}

static struct local_pixel *row_of(const struct local_window *window, uint32_t y)
{
    return &window->pixels[(size_t)(y % LOCAL_ROWS) * window->width];
}

static void load_rows(struct local_window *window, uint32_t y)
{
    for (; window->loaded < window->height && window->loaded <= y + LOCAL_REACH; window->loaded++) {
        struct local_pixel *row = row_of(window, window->loaded);
        uint64_t first = (uint64_t)window->loaded * window->width;
        memset(row, 0, window->width * sizeof *row);
        for (uint32_t x = 0; x < window->width; x++)
            window->load(window->context, first + x, &row[x]);
    }
}

static void add_pixel(struct local_column *sum, const struct local_pixel *pixel, double weight)
{
    for (int c = 0; c < 3; c++) {
        sum->mean[c] += weight * pixel->mean[c];
        sum->noise[c] += weight * pixel->noise[c];
        sum->mean_noise[c] += weight * weight * pixel->noise[c];
    }
    sum->part += weight * pixel->part;
}

static void add_column(struct local_column *sum, const struct local_column *column, double weight)
{
    for (int c = 0; c < 3; c++) {
        sum->mean[c] += weight * column->mean[c];
        sum->noise[c] += weight * column->noise[c];
        sum->mean_noise[c] += weight * weight * column->mean_noise[c];
    }
    sum->part += weight * column->part;
}

void local_window_enter(struct local_window *window, uint32_t y)
{
    load_rows(window, y);
    memset(window->others, 0, window->width * sizeof *window->others);
    for (uint32_t row = first_row(y); row < window->loaded; row++) {
        const struct local_pixel *pixels = row_of(window, row);
        double weight = gaussian[row < y ? y - row : row - y];
        for (uint32_t x = 0; row != y && x < window->width; x++)
            add_pixel(&window->others[x], &pixels[x], weight);
    }
    memcpy(window->columns, window->others, window->width * sizeof *window->columns);
    const struct local_pixel *own = row_of(window, y);
    for (uint32_t x = 0; x < window->width; x++)
        add_pixel(&window->columns[x], &own[x], gaussian[0]);
}

void local_mean_at(const struct local_window *window, uint32_t x, struct local_mean *out)
{
    struct local_column sum = window->others[x];
    for (int d = 1; d <= LOCAL_REACH; d++) {
        if (x >= (uint32_t)d)
            add_column(&sum, &window->columns[x - (uint32_t)d], gaussian[d]);
        if ((uint64_t)x + (uint32_t)d < window->width)
            add_column(&sum, &window->columns[x + (uint32_t)d], gaussian[d]);
    }
    double part = sum.part;
    *out = (struct local_mean){.own = gaussian[0] / (gaussian[0] + part)};
    for (int c = 0; part > 0 && c < 3; c++) {
        out->mean[c] = sum.mean[c] / part;
        out->noise[c] = sum.noise[c] / part;
        out->mean_noise[c] = sum.mean_noise[c] / (part * part);
    }
}

struct local_weight local_weigh(double own_value, const struct local_mean *around, int c)
{
    double share = 1 - around->own;
    double mean = around->own * own_value + share * around->mean[c];
    double square = mean * mean + METRICS_RELMSE_EPSILON;
    double variance = share * share * around->mean_noise[c];
    double curvature = fmax(3 * mean * mean - METRICS_RELMSE_EPSILON, 0);
    double value = 1 / (square + curvature * variance / square) / 3;
    return (struct local_weight){value, 2 * fabs(mean) / square * value * share};
}
