// Controls sample counts by tile of the image (--adaptive): makes the plan that allots samples to
// tiles, and the passes that take them.
//
// A plan states how many samples each tile takes in one round; a render is a number of whole
// rounds. The plan alone decides which pixels a wave takes, whatever was rendered so far, so that
// sample counts do not depend on the samples' values.
#ifndef LAMPYRIS_RENDER_ADAPTIVE_H
#define LAMPYRIS_RENDER_ADAPTIVE_H

#include "render/render.h"

struct wave;

#define TILE_SIDE 16u // in pixels
// A tile takes at most the average number of samples times this.
#define TILE_MOST_FACTOR 16u
// A tile takes at least the average divided by this, so that regions whose variance the pilot
// missed are sampled, too.
#define TILE_LEAST_DIVISOR 4u
#define TILE_SAMPLES_MIN 2u // one for each half-buffer

struct tile_plan {
    uint32_t tiles_x, tiles_y;
    uint32_t *counts;     // samples per pixel in a round, even numbers; tiles in rows from the top
    uint32_t least, most; // the smallest and the largest count
    uint64_t total;       // samples of all pixels in a round
};

struct tile_plan_params {
    uint32_t width, height;
    // For each tile the mean over its pixels of the relative variance: the variance of one sample
    // divided by the square of the pixel's value. NULL: all tiles are alike. Values that are not
    // finite or below 0 count as 0.
    const double *variances;
    uint32_t average; // mean samples per pixel in a round, at least TILE_SAMPLES_MIN; the plan does
                      // not exceed it
    uint32_t most;    // a second limit of a tile's count, besides TILE_MOST_FACTOR; 0: none
};

// Returns the number of tiles along `length` pixels.
uint32_t tiles_along(uint32_t length);
// Makes the plan with the least relative mean squared error for its number of samples. As in
// stratified sampling (Neyman 1934), samples are allotted in proportion to the standard deviation.
// The counts live in `arena`.
bool tile_plan_make(const struct tile_plan_params *params, struct arena *arena,
                    struct tile_plan *out, struct err *err);

// Returns the plan with these counts, which the caller keeps alive.
struct tile_plan tile_plan_of(uint32_t width, uint32_t height, uint32_t *counts);

// Copies the plan. From then on render_call.samples counts rounds of this plan. The film must be
// empty, and the renderer must have been created with `tiles`.
bool renderer_set_plan(struct renderer *renderer, const struct tile_plan *plan, struct err *err);

// --- for render.c -------------------------------------------------------------------------------
// Begins the next pass of the rounds up to round_target. Returns false when there is none.
bool tile_pass_begin(struct renderer *renderer);
// Returns whether the first pass, which takes one sample of every pixel, is over.
bool tiles_all_begun(const struct renderer *renderer);
// Lists as many of the pass's pixels as the wave can take, and uploads the list.
bool tile_wave_fill(struct renderer *renderer, struct wave *wave, struct err *err);
void tile_pass_end(struct renderer *renderer);
// Returns the number of samples of all pixels in `rounds` rounds.
uint64_t tile_samples(const struct renderer *renderer, uint64_t rounds);

#endif
