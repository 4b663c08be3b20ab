#include "render/tables/alias_table.h"

bool alias_table_build(const double *weights, uint32_t count, struct arena *scratch,
                       struct alias_bin *bins)
{
    double *share = ARENA_NEW(scratch, double, count); // content of each bin; 1: full
    uint32_t *small = ARENA_NEW(scratch, uint32_t, count);
    uint32_t *large = ARENA_NEW(scratch, uint32_t, count);
    if (!share || !small || !large)
        return false;

    double sum = 0.0;
    for (uint32_t i = 0; i < count; i++)
        sum += weights[i];
    uint32_t small_count = 0, large_count = 0;
    for (uint32_t i = 0; i < count; i++) {
        share[i] = weights[i] / sum * count;
        if (share[i] < 1.0)
            small[small_count++] = i;
        else
            large[large_count++] = i;
    }

    while (small_count && large_count) {
        uint32_t low = small[--small_count], high = large[large_count - 1];
        bins[low] = (struct alias_bin){(float)share[low], high};
        share[high] -= 1.0 - share[low];
        if (share[high] < 1.0) {
            large_count--;
            small[small_count++] = high;
        }
    }
    // The remaining bins are full, up to rounding errors. Rounding may have used up the partner of
    // a bin of weight 0 and left the bin with a positive threshold: such a bin must not select
    // itself.
    while (large_count) {
        uint32_t i = large[--large_count];
        bins[i] = (struct alias_bin){1.0f, i};
    }
    while (small_count) {
        uint32_t i = small[--small_count];
        uint32_t other = i;
        while (weights[other] <= 0.0)
            other = other + 1 < count ? other + 1 : 0;
        bins[i] = (struct alias_bin){weights[i] > 0.0 ? 1.0f : 0.0f, other};
    }
    return true;
}
