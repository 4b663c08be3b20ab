// Scales linear images.
#include "render/show/display_internal.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

// Returns the filter weights for pixel `at` of an axis that is reduced from `from` to `to` pixels:
// the pixel covers the interval [at, at + 1] * from / to.
static struct gpu_display_taps taps_of_area(uint64_t at, uint64_t from, uint64_t to)
{
    uint64_t first = at * from / to, last = ((at + 1) * from - 1) / to;
    double head = 1 - (double)(at * from % to) / (double)to;
    double tail = (double)((at + 1) * from - last * to) / (double)to;
    uint64_t step = (last - first) / DISPLAY_TAPS_MAX + 1, count = (last - first) / step + 1;
    double sum = head + tail + (double)count - 2; // at least two pixels, because `from` is greater
                                                  // than `to`
    if (count == 1)
        return (struct gpu_display_taps){(uint32_t)first, 1 | (uint32_t)step << 8, 1, 0};
    return (struct gpu_display_taps){
        .first = (uint32_t)first,
        .count_step = (uint32_t)count | (uint32_t)step << 8,
        .head = (float)(head / sum),
        .tail = (float)(tail / sum),
    };
}

static struct gpu_display_taps taps_between(uint64_t at, uint64_t from, uint64_t to, bool nearest)
{
    // The position of the pixel's centre in pixels of `from`, times 2 * to. The subtraction below
    // makes it relative to the centre of the first pixel.
    uint64_t twice = (2 * at + 1) * from;
    if (nearest)
        return (struct gpu_display_taps){(uint32_t)(twice / (2 * to)), 1 | 1 << 8, 1, 0};
    twice = twice > to ? twice - to : 0;
    uint64_t first = twice / (2 * to);
    if (first + 1 >= from)
        return (struct gpu_display_taps){(uint32_t)from - 1, 1 | 1 << 8, 1, 0};
    float tail = (float)((double)(twice % (2 * to)) / (double)(2 * to));
    return (struct gpu_display_taps){(uint32_t)first, 2 | 1 << 8, 1 - tail, tail};
}

static void fill_taps(struct gpu_display_taps *out, uint32_t from, uint32_t to, bool nearest)
{
    for (uint32_t at = 0; at < to; at++)
        out[at] = from > to ? taps_of_area(at, from, to) : taps_between(at, from, to, nearest);
}

// Makes the table of weights for these sizes, unless it exists already.
static bool make_table(struct display *d, const struct linear *from, bool nearest, struct sized *to,
                       struct err *err)
{
    const uint32_t key[] = {from->width, from->height, to->picture.width, to->picture.height,
                            nearest};
    uint32_t count = to->picture.width + to->picture.height;
    if (to->taps.handle && memcmp(to->key, key, sizeof key) == 0)
        return true;
    struct gpu_display_taps *taps = malloc(count * sizeof *taps);
    if (!taps)
        return err_memory(err, "display", count * sizeof *taps);
    fill_taps(taps, from->width, to->picture.width, nearest);
    fill_taps(taps + to->picture.width, from->height, to->picture.height, nearest);
    bool ok =
        display_reserve_bytes(d, "display taps", count * sizeof *taps, true, &to->taps, err) &&
        gpu_upload(d->gpu, &to->taps, 0, taps, count * sizeof *taps, err);
    memcpy(to->key, key, sizeof key);
    free(taps);
    return ok;
}

// Finds the rows of `to` that depend on the pixels of a part, with one more row at each end for
// interpolation.
static void rows_of_part(const struct linear *from, const struct linear *to,
                         const struct display_part *part, uint32_t *first, uint32_t *count)
{
    assert(from->width > 0 && from->height > 0);
    double scale = to->height / (double)from->height;
    uint32_t first_row = part->first / from->width;
    uint32_t last_row = (part->first + part->count - 1) / from->width;
    double low = floor((first_row - 1.0) * scale) - 1;
    double high = ceil((last_row + 2.0) * scale) + 1;
    *first = low > 0 ? (uint32_t)low : 0;
    *count = (high < to->height ? (uint32_t)high : to->height) - *first;
}

bool display_scale(struct display *d, const struct linear *from, const struct display_part *part,
                   bool nearest, struct sized *to, struct err *err)
{
    const struct linear *picture = &to->picture;
    bool is_larger = picture->width >= from->width && picture->height >= from->height;
    if (!make_table(d, from, nearest, to, err))
        return false;
    struct display_work work = {
        .code = DISPLAY_SCALE,
        .constants = {[DISPLAY_CONSTANT_FLAGS] = !is_larger ? 0
                                                 : nearest  ? DISPLAY_NEAREST
                                                            : DISPLAY_LARGER},
        .push =
            {
                .from_count = from->width * from->height,
                .from_width = from->width,
                .to_width = picture->width,
            },
        .buffers = {[DISPLAY_BINDING_FROM] = &from->buffer,
                    [DISPLAY_BINDING_TAPS] = &to->taps,
                    [DISPLAY_BINDING_TO] = &picture->buffer},
    };
    uint32_t rows = picture->height;
    if (part) {
        rows_of_part(from, picture, part, &work.push.first_row, &rows);
        work.push.from_first = part->first;
        work.push.from_count = part->count;
        work.push.is_added = 1;
    }
    work.push.items = rows * picture->width;
    work.threads = work.push.items;
    return display_dispatch(d, &work, err);
}
