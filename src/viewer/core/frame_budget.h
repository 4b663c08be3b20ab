// Decides how much work a frame gets from measured times. Plain numbers, without a clock of its
// own.
#ifndef LAMPYRIS_VIEWER_CORE_FRAME_BUDGET_H
#define LAMPYRIS_VIEWER_CORE_FRAME_BUDGET_H

#include <stdbool.h>
#include <stdint.h>

struct frame_budget {
    double target_ms;     // time of a whole frame
    double ms_per_sample; // per sample of one pixel, a running mean; 0: not known yet
    double ms_per_small;  // the same for small images, whose dispatches cost more per sample; 0:
                          // not known
    double ms_per_pixel;  // cost per pixel of per-frame passes (denoising); 0: none
    double overhead_ms;   // time of a frame in addition to rendering: display, panel, presenting
    uint32_t shrink;      // the picture's sides are divided by this while the camera moves; >= 1
};

#define FRAME_BUDGET_SHRINK_MAX 16u
#define FRAME_BUDGET_WAVE_MIN 4096u // below this, the fixed cost of a dispatch is significant
#define FRAME_BUDGET_WAVE_MAX (1u << 20)

void frame_budget_init(struct frame_budget *pace, double target_ms);
// Adds the measurements of a frame: pixel samples, the time of rendering and all other time.
void frame_budget_measure(struct frame_budget *pace, double samples, double render_ms,
                          double overhead_ms);
// Adds a measurement of small images, by which `shrink` is chosen.
void frame_budget_measure_small(struct frame_budget *pace, double samples, double render_ms);
void frame_budget_measure_pixels(struct frame_budget *pace, double pixels, double ms);
// Returns the rendering time of a frame; at least a quarter of the target, so that the image
// progresses even if everything else is slow.
double frame_budget_render_ms(const struct frame_budget *pace);
// Returns the rendering time while there is no input: it is longer, so that most of the time is
// spent on the image.
double frame_budget_calm_render_ms(const struct frame_budget *pace);
// Returns the number of paths in flight, a power of two, that take at most that long: a frame ends
// between two waves.
uint32_t frame_budget_wave(const struct frame_budget *pace, double render_ms);
// Chooses `shrink` so that one sample per pixel of the smaller image, and the passes over its
// pixels, fit; with hysteresis, so that the size does not flicker.
void frame_budget_choose(struct frame_budget *pace, uint32_t width, uint32_t height);
// Returns the width or height divided by `shrink`, rounded up.
uint32_t frame_budget_shrunk(uint32_t side, uint32_t shrink);

#endif
