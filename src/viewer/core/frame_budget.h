// How much work a frame gets, from what work took: plain numbers, no clock of its own.
#ifndef LAMPYRIS_VIEWER_CORE_FRAME_BUDGET_H
#define LAMPYRIS_VIEWER_CORE_FRAME_BUDGET_H

#include <stdbool.h>
#include <stdint.h>

struct frame_budget {
    double target_ms;     // of a whole frame
    double ms_per_sample; // of one sample of one pixel, a running mean; 0: not known yet
    double ms_per_small;  // the same of small pictures, of which dispatches cost more; 0: not known
    double ms_per_pixel;  // of what is done once for every pixel of a picture, denoising; 0: none
    double overhead_ms;   // of a frame besides rendering: display, panel, presenting
    uint32_t shrink;      // the picture's sides are divided by this while the camera moves; >= 1
};

#define FRAME_BUDGET_SHRINK_MAX 16u
#define FRAME_BUDGET_WAVE_MIN 4096u // below, the work a dispatch costs besides its paths shows
#define FRAME_BUDGET_WAVE_MAX (1u << 20)

void frame_budget_init(struct frame_budget *pace, double target_ms);
// Takes in one frame's figures: samples of single pixels, the time of rendering and all other time.
void frame_budget_measure(struct frame_budget *pace, double samples, double render_ms,
                          double overhead_ms);
// Measures small pictures: `shrink` is chosen by that.
void frame_budget_measure_small(struct frame_budget *pace, double samples, double render_ms);
void frame_budget_measure_pixels(struct frame_budget *pace, double pixels, double ms);
// Returns the time that a frame may take for rendering; never below a quarter of the target, so
// that the picture goes on where all else takes long.
double frame_budget_render_ms(const struct frame_budget *pace);
// Returns that time while nothing is done but looking: longer, so that most of the time goes into
// the picture.
double frame_budget_calm_render_ms(const struct frame_budget *pace);
// Paths in flight, a power of two, that take no longer than that: a frame ends between two waves.
uint32_t frame_budget_wave(const struct frame_budget *pace, double render_ms);
// Chooses `shrink` so that a sample of every pixel of the smaller picture, and what is done once
// for each, fits; with hysteresis, so that it does not flicker.
void frame_budget_choose(struct frame_budget *pace, uint32_t width, uint32_t height);
// A side of the picture, divided and rounded up.
uint32_t frame_budget_shrunk(uint32_t side, uint32_t shrink);

#endif
