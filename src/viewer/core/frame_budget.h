// Decides from measured times how much work a frame gets. It only computes, and reads no clock.
#ifndef LAMPYRIS_VIEWER_CORE_FRAME_BUDGET_H
#define LAMPYRIS_VIEWER_CORE_FRAME_BUDGET_H

#include <stdbool.h>
#include <stdint.h>

struct frame_budget {
    double target_ms; // time that a whole frame should take
    // Rendering time per sample of one pixel, a running mean; 0: not known yet.
    double ms_per_sample;
    // Rendering time per sample for small images, in which the fixed cost of dispatches has more
    // weight; 0: not known yet.
    double ms_per_small;
    // Time per pixel of passes that run once per frame (denoising); 0: there are none.
    double ms_per_pixel;
    double overhead_ms; // time of a frame besides rendering: display, panel, presentation
    uint32_t shrink;    // width and height are divided by this while the camera moves; at least 1
};

#define FRAME_BUDGET_SHRINK_MAX 16u
// Smallest wave; below it the fixed cost of a dispatch is significant.
#define FRAME_BUDGET_WAVE_MIN 4096u
#define FRAME_BUDGET_WAVE_MAX (1u << 20)

void frame_budget_init(struct frame_budget *pace, double target_ms);
// Adds the measurements of a frame: samples (over all pixels), time of rendering, and time of all
// other work.
void frame_budget_measure(struct frame_budget *pace, double samples, double render_ms,
                          double overhead_ms);
// Adds a measurement of a small image. These measurements determine `shrink`.
void frame_budget_measure_small(struct frame_budget *pace, double samples, double render_ms);
void frame_budget_measure_pixels(struct frame_budget *pace, double pixels, double ms);
// Returns the rendering time of a frame, in milliseconds. It is at least a quarter of the target,
// so that the image progresses even if all other work is slow.
double frame_budget_render_ms(const struct frame_budget *pace);
// Returns the rendering time of a frame, in milliseconds, while there is no input. It is at least
// frame_budget_render_ms(), and longer if possible, so that most of the time is spent on the image.
double frame_budget_calm_render_ms(const struct frame_budget *pace);
// Returns the number of paths in flight, a power of two, that take at most `render_ms`. A frame can
// only end between two waves.
uint32_t frame_budget_wave(const struct frame_budget *pace, double render_ms);
// Chooses `shrink` so that a sample per pixel of the smaller image, and the passes over its pixels,
// fit into the time. Hysteresis prevents the size from flickering.
void frame_budget_choose(struct frame_budget *pace, uint32_t width, uint32_t height);
// Returns a width or height divided by `shrink`, rounded up.
uint32_t frame_budget_shrunk(uint32_t side, uint32_t shrink);

#endif
