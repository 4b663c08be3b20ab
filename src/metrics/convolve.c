#include "convolve.h"

static int64_t clamp(int64_t i, uint32_t count)
{
    return i < 0 ? 0 : i >= (int64_t)count ? (int64_t)count - 1 : i;
}

static void along_rows(const float *plane, uint32_t width, uint32_t height,
                       const struct kernel_1d *k, float *out)
{
    for (uint32_t y = 0; y < height; y++) {
        const float *row = plane + (uint64_t)y * width;
        for (uint32_t x = 0; x < width; x++) {
            double sum = 0;
            for (int i = -k->radius; i <= k->radius; i++)
                sum += k->weight[i + k->radius] * (double)row[clamp((int64_t)x + i, width)];
            out[(uint64_t)y * width + x] = (float)sum;
        }
    }
}

static void along_columns(const float *plane, uint32_t width, uint32_t height,
                          const struct kernel_1d *k, float *out)
{
    for (uint32_t y = 0; y < height; y++)
        for (uint32_t x = 0; x < width; x++) {
            double sum = 0;
            for (int i = -k->radius; i <= k->radius; i++)
                sum += k->weight[i + k->radius] *
                       (double)plane[(uint64_t)clamp((int64_t)y + i, height) * width + x];
            out[(uint64_t)y * width + x] = (float)sum;
        }
}

void convolve(const float *plane, uint32_t width, uint32_t height, const struct kernel_1d *x,
              const struct kernel_1d *y, float *scratch, float *out)
{
    along_rows(plane, width, height, x, scratch);
    along_columns(scratch, width, height, y, out);
}
