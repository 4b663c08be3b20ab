#include "metrics/perceptual.h"

#include "base/maths.h"
#include "base/memory.h"
#include "metrics/pixel.h"
#include <math.h>

enum { RADIUS = 5, SIDE = 2 * RADIUS + 1 };

// Returns the BT.709 luma of display values.
static double luma(const float pixel[3])
{
    double shown[3];
    for (int c = 0; c < 3; c++)
        shown[c] = display_value((double)pixel[c]);
    return vec3_luminance(shown);
}

struct moments {
    double weight, a, b, aa, bb, ab;
};

static void add(struct moments *m, double weight, double a, double b)
{
    m->weight += weight;
    m->a += weight * a;
    m->b += weight * b;
    m->aa += weight * a * a;
    m->bb += weight * b * b;
    m->ab += weight * a * b;
}

static void add_scaled(struct moments *sum, double weight, const struct moments *m)
{
    sum->weight += weight * m->weight;
    sum->a += weight * m->a;
    sum->b += weight * m->b;
    sum->aa += weight * m->aa;
    sum->bb += weight * m->bb;
    sum->ab += weight * m->ab;
}

static double similarity(const struct moments *m)
{
    const double c1 = 0.01 * 0.01, c2 = 0.03 * 0.03; // (K L)^2 with L = 1
    double a = m->a / m->weight, b = m->b / m->weight;
    double var_a = m->aa / m->weight - a * a, var_b = m->bb / m->weight - b * b;
    double covariance = m->ab / m->weight - a * b;
    return (2 * a * b + c1) * (2 * covariance + c2) / ((a * a + b * b + c1) * (var_a + var_b + c2));
}

// Computes the window's weights along one axis. They are not normalised, because similarity()
// divides by their sum.
static void fill_window(double window[SIDE])
{
    for (int i = -RADIUS; i <= RADIUS; i++)
        window[i + RADIUS] = exp(-i * i / (2 * 1.5 * 1.5));
}

// Computes, for each pixel of a row, the weighted sums along the row.
static void sum_row(const struct picture_pair *p, const double (*values)[2], uint32_t y,
                    const double window[SIDE], struct moments *out)
{
    for (uint32_t x = 0; x < p->width; x++) {
        out[x] = (struct moments){0};
        for (int i = -RADIUS; i <= RADIUS; i++) {
            int64_t at = (int64_t)x + i;
            if (at < 0 || at >= (int64_t)p->width)
                continue;
            const double *v = values[(uint64_t)y * p->width + (uint64_t)at];
            add(&out[x], window[i + RADIUS], v[0], v[1]);
        }
    }
}

// Adds the similarities of all pixels. Returns false when stopped. A row takes hundreds of
// operations per pixel, so `progress` is asked at each row.
static bool sum_similarities(const struct picture_pair *p, const double (*values)[2],
                             const struct progress *progress, struct moments *rows, double *out)
{
    double window[SIDE], sum = 0;
    fill_window(window);
    uint32_t summed = 0; // number of rows summed so far; `rows` is a ring of the last SIDE of them
    for (uint32_t y = 0; y < p->height; y++) {
        if (progress_should_stop(progress))
            return false;
        for (; summed < p->height && summed <= y + RADIUS; summed++)
            sum_row(p, values, summed, window, rows + (uint64_t)(summed % SIDE) * p->width);
        for (uint32_t x = 0; x < p->width; x++) {
            struct moments m = {0};
            for (int i = -RADIUS; i <= RADIUS; i++) {
                int64_t at = (int64_t)y + i;
                if (at >= 0 && at < (int64_t)p->height)
                    add_scaled(&m, window[i + RADIUS], &rows[(uint64_t)(at % SIDE) * p->width + x]);
            }
            sum += similarity(&m);
        }
    }
    *out = sum;
    return true;
}

uint64_t metrics_ssim_bytes(uint32_t width, uint32_t height)
{
    return (uint64_t)width * height * sizeof(double[2]) +
           (uint64_t)SIDE * width * sizeof(struct moments);
}

bool metrics_ssim(const struct picture_pair *p, const struct progress *progress, double *out)
{
    uint64_t count = (uint64_t)p->width * p->height;
    double(*values)[2] = memory_alloc(count * sizeof *values), sum;
    struct moments *rows = memory_alloc((uint64_t)SIDE * p->width * sizeof *rows);
    bool ok = values && rows;
    for (uint64_t i = 0; i < count && ok; i++) {
        ok = !progress_stops_at(progress, i);
        if (!pixel_is_finite(p->image[i]) || !pixel_is_finite(p->reference[i]))
            continue;
        values[i][0] = luma(p->image[i]);
        values[i][1] = luma(p->reference[i]);
    }
    ok = ok && sum_similarities(p, (const double(*)[2])values, progress, rows, &sum);
    if (ok)
        *out = sum / (double)count;
    memory_free(values);
    memory_free(rows);
    return ok;
}
