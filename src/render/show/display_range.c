// Finds the range of false colours from the image.
#include "render/show/display_internal.h"

#include <math.h>
#include <string.h>

// The fractions of all values that are below the beginning of the range, and below its end. Ranges
// of heat maps and counts begin at 0.
static const struct {
    double low, high;
    bool from_zero;
} shares[SHOWN_COUNT] = {
    [SHOWN_DEPTH] = {0.01, 0.95, false}, // excludes the horizon, which covers few pixels
    [SHOWN_SAMPLES] = {0, 1, true},
    [SHOWN_VARIANCE] = {0.01, 0.99, false},
    [SHOWN_STEPS] = {0, 0.995, true},
};

static double float_of_bits(uint32_t bits)
{
    float value;
    memcpy(&value, &bits, sizeof value);
    return (double)value;
}

// Returns the value below which the given fraction of all values lies, assuming that values are
// evenly distributed within their bin.
static double quantile(const struct gpu_display_range *found, double share)
{
    double below = 0, wanted = share * found->count;
    uint32_t bin = 0;
    while (bin + 1 < DISPLAY_BINS && below + found->bin[bin] < wanted)
        below += found->bin[bin++];
    double low = float_of_bits(bin << DISPLAY_BIN_SHIFT);
    double high = float_of_bits((bin + 1) << DISPLAY_BIN_SHIFT);
    double inside = found->bin[bin] ? (wanted - below) / found->bin[bin] : 0;
    double value = isfinite(high) ? low + inside * (high - low) : low;
    return fmin(fmax(value, float_of_bits(found->least)), float_of_bits(found->greatest));
}

static bool count_values(struct display *d, uint32_t shown, const struct linear *picture,
                         struct err *err)
{
    uint64_t pixels = (uint64_t)picture->width * picture->height;
    const struct display_work work = {
        .code = DISPLAY_RANGE,
        .constants = {[DISPLAY_CONSTANT_SHOWN] = shown},
        .push = {.items = (uint32_t)pixels},
        .buffers =
            {[DISPLAY_BINDING_FROM] = &picture->buffer, [DISPLAY_BINDING_RANGE] = &d->own->range},
        .threads = (pixels + DISPLAY_RANGE_ITEMS - 1) / DISPLAY_RANGE_ITEMS,
    };
    return display_dispatch(d, &work, err);
}

bool display_find_range(struct display *d, uint32_t shown, const struct linear *const pictures[2],
                        uint32_t count, double range[2], struct err *err)
{
    struct gpu_display_range found = {.least = UINT32_MAX};
    range[0] = 0;
    range[1] = 1;
    if (!display_reserve_bytes(d, "display range", sizeof found, false, &d->own->range, err) ||
        !gpu_upload(d->gpu, &d->own->range, 0, &found, sizeof found, err))
        return false;
    for (uint32_t i = 0; i < count; i++)
        if (!count_values(d, shown, pictures[i], err))
            return false;
    if (!display_end(d, err) ||
        !gpu_download(d->gpu, &d->own->range, 0, &found, sizeof found, err) ||
        !display_begin(d, err))
        return false;
    if (found.count == 0)
        return true;
    range[0] = shares[shown].from_zero ? 0 : quantile(&found, shares[shown].low);
    range[1] = quantile(&found, shares[shown].high);
    if (!(range[1] > range[0])) // all values are equal
        range[1] = range[0] > 0 ? 2 * range[0] : 1;
    return true;
}
