#include "render/adaptive.h"

#include "render/counters.h"
#include "render/wave.h"
#include <math.h>
#include <string.h>

// --- the plan ------------------------------------------------------------------------------------

uint32_t tiles_along(uint32_t length)
{
    return length / TILE_SIDE + (length % TILE_SIDE != 0);
}

static uint32_t side_of(uint32_t tile, uint32_t tiles, uint32_t length)
{
    return tile + 1 < tiles ? TILE_SIDE : length - tile * TILE_SIDE;
}

static uint32_t tile_pixels(uint32_t width, uint32_t height, uint32_t tile)
{
    uint32_t across = tiles_along(width);
    return side_of(tile % across, across, width) *
           side_of(tile / across, tiles_along(height), height);
}

struct tile_plan tile_plan_of(uint32_t width, uint32_t height, uint32_t *counts)
{
    struct tile_plan plan = {
        .tiles_x = tiles_along(width),
        .tiles_y = tiles_along(height),
        .counts = counts,
        .least = UINT32_MAX,
    };
    for (uint32_t tile = 0; tile < plan.tiles_x * plan.tiles_y; tile++) {
        plan.total += (uint64_t)counts[tile] * tile_pixels(width, height, tile);
        plan.least = counts[tile] < plan.least ? counts[tile] : plan.least;
        plan.most = counts[tile] > plan.most ? counts[tile] : plan.most;
    }
    return plan;
}

// A plan in the making: the weights and limits from which the samples of each tile follow.
struct allotment {
    const struct tile_plan_params *params;
    uint32_t tiles_x, tiles_y;
    uint32_t least, most;
    const double *weights;
};

static uint32_t count_at(const struct allotment *a, uint32_t tile, double scale)
{
    double even = 2.0 * floor(0.5 * scale * a->weights[tile] + 0.5);
    return even <= a->least ? a->least : even >= a->most ? a->most : (uint32_t)even;
}

static uint64_t total_at(const struct allotment *a, double scale)
{
    uint64_t total = 0;
    for (uint32_t tile = 0; tile < a->tiles_x * a->tiles_y; tile++)
        total += (uint64_t)count_at(a, tile, scale) *
                 tile_pixels(a->params->width, a->params->height, tile);
    return total;
}

// Returns the greatest scale that keeps within the budget, by bisection between powers of 16. The
// total grows with the scale. A fixed number of steps gives the same result everywhere.
static double find_scale(const struct allotment *a, uint64_t budget)
{
    double low = 0.0, high = 1.0;
    while (high < 1e300 && total_at(a, high) <= budget) {
        low = high;
        high *= 16.0;
    }
    for (int step = 0; step < 64; step++) {
        double middle = 0.5 * (low + high);
        if (total_at(a, middle) <= budget)
            low = middle;
        else
            high = middle;
    }
    return low;
}

// Sets the weights to the square roots of the variances, scaled so that the greatest is 1. A
// pilot's variance of a tile is itself a noisy estimate, and light that the pilot missed is most
// often near light that it found. Each tile's variance is therefore averaged with the mean of its
// neighbours' variances.
static void set_weights(const struct tile_plan_params *p, uint32_t tiles_x, uint32_t tiles_y,
                        double *weights)
{
    double greatest = 0.0;
    for (uint32_t i = 0; i < tiles_x * tiles_y; i++) {
        uint32_t x = i % tiles_x, y = i / tiles_x, count = 0;
        double own = 0.0, around = 0.0;
        for (uint32_t v = y > 0 ? y - 1 : 0; v <= y + 1 && v < tiles_y; v++)
            for (uint32_t u = x > 0 ? x - 1 : 0; u <= x + 1 && u < tiles_x; u++) {
                double variance = p->variances ? p->variances[v * tiles_x + u] : 1.0;
                variance = variance > 0.0 && isfinite(variance) ? variance : 0.0;
                if (u == x && v == y)
                    own = variance;
                else
                    around += variance, count++;
            }
        weights[i] = sqrt(count ? 0.5 * own + 0.5 * around / count : own);
        greatest = fmax(greatest, weights[i]);
    }
    // If no tile has any variance, all tiles get the same weight.
    for (uint32_t i = 0; i < tiles_x * tiles_y; i++)
        weights[i] = greatest > 0.0 ? weights[i] / greatest : 1.0;
}

static uint32_t even_at_least(uint32_t value)
{
    return value + (value & 1u);
}

static void set_limits(struct allotment *a)
{
    const struct tile_plan_params *p = a->params;
    uint64_t most = (uint64_t)p->average * TILE_MOST_FACTOR;
    uint64_t limit = p->most ? p->most : UINT32_MAX;
    a->most = (uint32_t)(most < limit ? most : limit) & ~1u;
    a->least = even_at_least(p->average / TILE_LEAST_DIVISOR);
    if (a->least < TILE_SAMPLES_MIN)
        a->least = TILE_SAMPLES_MIN;
    if (a->most < a->least)
        a->most = a->least;
}

bool tile_plan_make(const struct tile_plan_params *p, struct arena *arena, struct tile_plan *out,
                    struct err *err)
{
    struct allotment a = {
        .params = p, .tiles_x = tiles_along(p->width), .tiles_y = tiles_along(p->height)};
    uint32_t tiles = a.tiles_x * a.tiles_y;
    struct arena scratch = {0};
    double *weights = ARENA_NEW(&scratch, double, tiles);
    *out = (struct tile_plan){.tiles_x = a.tiles_x, .tiles_y = a.tiles_y};
    out->counts = ARENA_NEW(arena, uint32_t, tiles);
    if (!weights || !out->counts) {
        arena_finish(&scratch);
        return err_memory(err, "tiles", tiles * (sizeof *weights + sizeof *out->counts));
    }
    set_weights(p, a.tiles_x, a.tiles_y, weights);
    a.weights = weights;
    set_limits(&a);
    double scale = find_scale(&a, (uint64_t)p->average * p->width * p->height);
    for (uint32_t tile = 0; tile < tiles; tile++)
        out->counts[tile] = count_at(&a, tile, scale);
    *out = tile_plan_of(p->width, p->height, out->counts);
    arena_finish(&scratch);
    return true;
}

// --- passes --------------------------------------------------------------------------------------

bool renderer_set_plan(struct renderer *r, const struct tile_plan *plan, struct err *err)
{
    struct tiles *tiles = &r->tiles;
    uint32_t count = plan->tiles_x * plan->tiles_y;
    if (!tiles->counts) {
        tiles->counts = ARENA_NEW(&r->arena, uint32_t, count);
        tiles->done = ARENA_NEW(&r->arena, uint32_t, count);
        if (!tiles->counts || !tiles->done)
            return err_memory(err, "tiles", 2 * count * sizeof *tiles->counts);
    }
    tiles->across = plan->tiles_x;
    tiles->count = count;
    memcpy(tiles->counts, plan->counts, count * sizeof *tiles->counts);
    memset(tiles->done, 0, count * sizeof *tiles->done);
    return true;
}

struct tile_box {
    uint32_t x, y, width, height;
};

static struct tile_box tile_box(const struct renderer *r, uint32_t tile)
{
    uint32_t x = tile % r->tiles.across * TILE_SIDE, y = tile / r->tiles.across * TILE_SIDE;
    uint32_t right = r->frame.width - x, below = r->frame.height - y;
    return (struct tile_box){
        .x = x,
        .y = y,
        .width = right < TILE_SIDE ? right : TILE_SIDE,
        .height = below < TILE_SIDE ? below : TILE_SIDE,
    };
}

// The tiles of the rows that are rendered. Their numbers are consecutive.
struct tile_range {
    uint32_t first, end;
};

static struct tile_range tiles_rendered(const struct renderer *r)
{
    return (struct tile_range){r->rows.first / TILE_SIDE * r->tiles.across,
                               tiles_along(r->rows.end) * r->tiles.across};
}

uint64_t tile_samples(const struct renderer *r, uint64_t rounds)
{
    const struct tile_range range = tiles_rendered(r);
    uint64_t sum = 0;
    for (uint32_t tile = range.first; tile < range.end; tile++)
        sum += (uint64_t)r->tiles.counts[tile] * tile_pixels(r->frame.width, r->frame.height, tile);
    return sum * rounds;
}

static uint64_t samples_left(const struct renderer *r, uint32_t tile)
{
    return r->tiles.counts[tile] * r->round_target - r->tiles.done[tile];
}

// The plan gives every tile at least TILE_SAMPLES_MIN samples per pixel in a round, so all tiles
// have a sample once the first pass is over.
bool tiles_all_begun(const struct renderer *r)
{
    return r->tiles.count > 0 && r->tiles.done[tiles_rendered(r).first] > 0;
}

static bool takes_part(const struct renderer *r, uint32_t tile, uint32_t shift)
{
    uint64_t left = samples_left(r, tile);
    if (shift == 0 && !tiles_all_begun(r))
        return true;
    return shift < USUAL_SAMPLE_SHIFT ? left >> shift & 1u : left >> shift;
}

// Chooses the samples per pixel, 2^shift, of the next pass: one sample of every pixel first; then
// passes of few samples over all tiles; then passes of many samples, which tiles leave when they
// are done.
static bool choose_shift(const struct renderer *r, uint32_t *shift)
{
    if (!tiles_all_begun(r)) {
        *shift = 0;
        return true;
    }
    const struct tile_range range = tiles_rendered(r);
    uint64_t all = 0;
    for (uint32_t tile = range.first; tile < range.end; tile++)
        all |= samples_left(r, tile);
    if (all == 0)
        return false;
    *shift = (uint32_t)__builtin_ctzll(all);
    if (*shift > USUAL_SAMPLE_SHIFT)
        *shift = USUAL_SAMPLE_SHIFT;
    return true;
}

bool tile_pass_begin(struct renderer *r)
{
    const struct tile_range range = tiles_rendered(r);
    struct pass pass = {0};
    if (!choose_shift(r, &pass.shift))
        return false;
    for (uint32_t tile = range.first; tile < range.end; tile++) {
        struct tile_box box = tile_box(r, tile);
        if (takes_part(r, tile, pass.shift))
            pass.length += (uint64_t)box.width * box.height;
    }
    r->pass = pass;
    return true;
}

void tile_pass_end(struct renderer *r)
{
    const struct tile_range range = tiles_rendered(r);
    // The first tile comes last, because its count tells takes_part() whether this was the first
    // pass.
    for (uint32_t tile = range.end; tile-- > range.first;)
        if (takes_part(r, tile, r->pass.shift))
            r->tiles.done[tile] += 1u << r->pass.shift;
    uint32_t shift;
    if (!choose_shift(r, &shift))
        r->next_sample = r->round_target;
}

// Finds the next pixel of the pass: its tile, and its index in the tile, row by row.
static void find_place(const struct renderer *r, uint32_t *tile, uint32_t *inside)
{
    const struct tile_range range = tiles_rendered(r);
    uint64_t left = r->pass.position;
    for (*tile = range.first; *tile < range.end; ++*tile) {
        struct tile_box box = tile_box(r, *tile);
        uint32_t pixels = box.width * box.height;
        if (!takes_part(r, *tile, r->pass.shift))
            continue;
        if (left < pixels)
            break;
        left -= pixels;
    }
    *inside = (uint32_t)left;
}

static bool upload_lists(struct renderer *r, uint32_t count, struct err *err)
{
    // The lists follow the last queue in the buffer, where lib/buffers.glsl reads them.
    uint64_t row = (uint64_t)r->plan.wave_slots * sizeof(uint32_t);
    uint64_t at = queue_offset(r, QUEUE_COUNT);
    struct gpu_buffer *queues = &r->buffers[BINDING_QUEUES];
    uint64_t bytes = count * sizeof(uint32_t);
    return gpu_upload(r->gpu, queues, at, r->tiles.pixels, bytes, err) &&
           gpu_upload(r->gpu, queues, at + row, r->tiles.first_samples, bytes, err);
}

static bool allocate_lists(struct renderer *r, struct err *err)
{
    struct tiles *tiles = &r->tiles;
    if (tiles->list_length >= r->plan.wave_slots)
        return true;
    tiles->list_length = r->plan.wave_slots;
    tiles->pixels = ARENA_NEW(&r->arena, uint32_t, tiles->list_length);
    tiles->first_samples = ARENA_NEW(&r->arena, uint32_t, tiles->list_length);
    return (tiles->pixels && tiles->first_samples) ||
           err_memory(err, "lists of pixels", 2 * sizeof(uint32_t) * tiles->list_length);
}

bool tile_wave_fill(struct renderer *r, struct wave *wave, struct err *err)
{
    if (!allocate_lists(r, err))
        return false;
    struct tiles *tiles = &r->tiles;
    const uint32_t end = tiles_rendered(r).end;
    uint32_t tile, inside, count = 0, fits = pace_samples(&r->pace, &r->plan) >> r->pass.shift;
    for (find_place(r, &tile, &inside); count < fits && tile < end; tile++, inside = 0) {
        if (!takes_part(r, tile, r->pass.shift))
            continue;
        struct tile_box box = tile_box(r, tile);
        for (; inside < box.width * box.height && count < fits; inside++, count++) {
            uint64_t pixel = (uint64_t)(box.y + inside / box.width) * r->frame.width + box.x +
                             inside % box.width;
            uint32_t chunk = (uint32_t)(pixel / r->plan.film_chunk_pixels);
            if (count == 0)
                wave->film_chunk = chunk;
            else if (chunk != wave->film_chunk)
                goto full;
            tiles->pixels[count] = (uint32_t)pixel;
            tiles->first_samples[count] = tiles->done[tile];
        }
    }
full:
    wave->pixel_count = count;
    return upload_lists(r, count, err);
}
