#include "metrics/convolve.h"

#include "metrics/stoppable.h"

// Pixels are processed in blocks of a fixed length, which compilers vectorise. For each pixel, the
// terms are added in the order of the weights, so the result does not depend on the block length.
enum { BLOCK = 128, ROWS_A_CHUNK = 8 };

struct pass {
    const float *plane;
    uint32_t width, height;
    const struct kernel_1d *kernel;
    float *out;
};

static int64_t clamp(int64_t i, uint32_t count)
{
    return i < 0 ? 0 : i >= (int64_t)count ? (int64_t)count - 1 : i;
}

static void store(const double sum[BLOCK], uint32_t x, uint32_t width, float *row)
{
    for (uint32_t i = 0; i < BLOCK && x + i < width; i++)
        row[x + i] = (float)sum[i];
}

static void filter_row(const struct pass *p, uint64_t y)
{
    const float *row = p->plane + y * p->width;
    int radius = p->kernel->radius;
    for (uint32_t x = 0; x < p->width; x += BLOCK) {
        double values[BLOCK + 2 * KERNEL_RADIUS_MAX], sum[BLOCK] = {0};
        for (int i = 0; i < BLOCK + 2 * radius; i++)
            values[i] = (double)row[clamp((int64_t)x + i - radius, p->width)];
        for (int k = 0; k <= 2 * radius; k++)
            for (int i = 0; i < BLOCK; i++)
                sum[i] += p->kernel->weight[k] * values[i + k];
        store(sum, x, p->width, p->out + y * p->width);
    }
}

static void filter_column(const struct pass *p, uint64_t y)
{
    int radius = p->kernel->radius;
    for (uint32_t x = 0; x < p->width; x += BLOCK) {
        double sum[BLOCK] = {0};
        uint32_t count = p->width - x < BLOCK ? p->width - x : BLOCK;
        for (int k = 0; k <= 2 * radius; k++) {
            int64_t line = clamp((int64_t)y + k - radius, p->height);
            const float *row = p->plane + (uint64_t)line * p->width + x;
            double weight = p->kernel->weight[k];
            if (count == BLOCK)
                for (uint32_t i = 0; i < BLOCK; i++)
                    sum[i] += weight * (double)row[i];
            else
                for (uint32_t i = 0; i < count; i++)
                    sum[i] += weight * (double)row[i];
        }
        store(sum, x, p->width, p->out + y * p->width);
    }
}

static void filter_rows(void *context, size_t begin, size_t end, unsigned thread)
{
    (void)thread;
    for (size_t y = begin; y < end; y++)
        filter_row(context, y);
}

static void filter_columns(void *context, size_t begin, size_t end, unsigned thread)
{
    (void)thread;
    for (size_t y = begin; y < end; y++)
        filter_column(context, y);
}

bool convolve(const float *plane, uint32_t width, uint32_t height, const struct kernel_1d *x,
              const struct kernel_1d *y, const struct progress *progress, float *scratch,
              float *out)
{
    struct pass rows = {plane, width, height, x, scratch};
    struct pass columns = {scratch, width, height, y, out};
    return stoppable_for(height, ROWS_A_CHUNK, progress, filter_rows, &rows) &&
           stoppable_for(height, ROWS_A_CHUNK, progress, filter_columns, &columns);
}
