// Sample counts by tiles of the picture: how many each is given, and the passes that take them.
//
// A plan says how many samples a tile takes in one round; a render is a number of whole rounds.
// Which pixels a wave takes depends on the plan, never on what was rendered so far, so the counts
// stay independent of the samples that they count.
#ifndef LAMPYRIS_RENDER_ADAPTIVE_H
#define LAMPYRIS_RENDER_ADAPTIVE_H

#include "render/render.h"

struct wave;

#define TILE_SIDE 16u // pixels
// A tile has no more samples than this many times the average.
#define TILE_MOST_FACTOR 16u
// And no fewer than the average divided by this, so that what a pilot missed is seen as well.
#define TILE_LEAST_DIVISOR 4u
#define TILE_SAMPLES_MIN 2u // one for each half-buffer

struct tile_plan {
    uint32_t tiles_x, tiles_y;
    uint32_t *counts;     // even; tiles in rows from the top
    uint32_t least, most; // of them
    uint64_t total;       // samples of all pixels in a round
};

struct tile_plan_params {
    uint32_t width, height;
    // Of each tile, the variance of one sample over the square of the value, a mean over the tile's
    // pixels. NULL: all alike. Those that are not finite or below 0 count as 0.
    const double *variances;
    uint32_t average; // samples a pixel in a round, at least TILE_SAMPLES_MIN: never exceeded
    uint32_t most;    // samples a pixel at most, besides TILE_MOST_FACTOR; 0: no other limit
};

// How many tiles lie along `length` pixels.
uint32_t tiles_along(uint32_t length);
// The plan with the least relative mean squared error for its number of samples: as Neyman 1934
// allots them to strata, by the root of the variance. The counts live in `arena`.
bool tile_plan_make(const struct tile_plan_params *params, struct arena *arena,
                    struct tile_plan *out, struct err *err);

// The plan that has these counts, which are not copied.
struct tile_plan tile_plan_of(uint32_t width, uint32_t height, uint32_t *counts);

// From now on a render_call's samples are rounds of this plan, of which a copy is made. The film
// must be empty. The renderer must have been created with `tiles`.
bool renderer_set_plan(struct renderer *renderer, const struct tile_plan *plan, struct err *err);

// --- for render.c -------------------------------------------------------------------------------
// Begins the next pass of the rounds up to round_target; false when there is none.
bool tile_pass_begin(struct renderer *renderer);
// Returns whether the first pass, which takes one sample of every pixel, is over.
bool tiles_all_begun(const struct renderer *renderer);
// Lists as many of the pass's pixels as the wave can take, and uploads the list.
bool tile_wave_fill(struct renderer *renderer, struct wave *wave, struct err *err);
void tile_pass_end(struct renderer *renderer);
// Of all tiles in so many rounds, over all pixels.
uint64_t tile_samples(const struct renderer *renderer, uint64_t rounds);

#endif
