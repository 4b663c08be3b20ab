#include "viewer/core/frame_budget.h"

// The weight of the newest measurement in the running means. With this value a change takes effect
// within a few frames, but a single slow frame does not change the size of the image.
#define NEWEST 0.25
// The image is only made larger if it then fits into this fraction of a frame. The remaining time
// exceeds the variation between frames.
#define MARGIN 0.8
// Without input, rendering may take this many times as long as all other work of the frame, up to a
// limit that keeps the response to new input fast.
#define CALM_SHARE 4.0
#define CALM_FRAME_MS 200.0
// The initial value of `shrink`, with which the first image appears quickly on any device.
#define FIRST_SHRINK 8u

void frame_budget_init(struct frame_budget *pace, double target_ms)
{
    *pace = (struct frame_budget){.target_ms = target_ms, .shrink = FIRST_SHRINK};
}

static double mean(double old, double value)
{
    return old > 0.0 ? old + NEWEST * (value - old) : value;
}

void frame_budget_measure(struct frame_budget *pace, double samples, double render_ms,
                          double overhead_ms)
{
    if (samples > 0.0 && render_ms > 0.0)
        pace->ms_per_sample = mean(pace->ms_per_sample, render_ms / samples);
    pace->overhead_ms = mean(pace->overhead_ms, overhead_ms);
}

void frame_budget_measure_small(struct frame_budget *pace, double samples, double render_ms)
{
    if (samples > 0.0 && render_ms > 0.0)
        pace->ms_per_small = mean(pace->ms_per_small, render_ms / samples);
}

void frame_budget_measure_pixels(struct frame_budget *pace, double pixels, double ms)
{
    pace->ms_per_pixel = pixels > 0.0 ? mean(pace->ms_per_pixel, ms / pixels) : 0.0;
}

double frame_budget_render_ms(const struct frame_budget *pace)
{
    double left = pace->target_ms - pace->overhead_ms, least = 0.25 * pace->target_ms;
    return left > least ? left : least;
}

// Rendering takes more time if there is no input; on a slow device, display and panel would
// otherwise take more time than the image.
double frame_budget_calm_render_ms(const struct frame_budget *pace)
{
    double ms = CALM_SHARE * pace->overhead_ms, most = CALM_FRAME_MS - pace->overhead_ms;
    if (ms > most)
        ms = most;
    double usual = frame_budget_render_ms(pace);
    return ms > usual ? ms : usual;
}

uint32_t frame_budget_shrunk(uint32_t side, uint32_t shrink)
{
    return (side + shrink - 1) / shrink;
}

uint32_t frame_budget_wave(const struct frame_budget *pace, double render_ms)
{
    uint32_t wave = FRAME_BUDGET_WAVE_MAX;
    if (!(pace->ms_per_sample > 0.0))
        return wave;
    double fit = render_ms / pace->ms_per_sample;
    while (wave > FRAME_BUDGET_WAVE_MIN && (double)wave > fit)
        wave /= 2;
    return wave;
}

static double cost_ms(const struct frame_budget *pace, uint32_t width, uint32_t height,
                      uint32_t shrink)
{
    double sample = pace->ms_per_small > 0.0 ? pace->ms_per_small : pace->ms_per_sample;
    return (double)frame_budget_shrunk(width, shrink) * frame_budget_shrunk(height, shrink) *
           (sample + pace->ms_per_pixel);
}

void frame_budget_choose(struct frame_budget *pace, uint32_t width, uint32_t height)
{
    double budget = frame_budget_render_ms(pace);
    if (!(pace->ms_per_sample > 0.0) && !(pace->ms_per_small > 0.0))
        return;
    while (pace->shrink < FRAME_BUDGET_SHRINK_MAX &&
           cost_ms(pace, width, height, pace->shrink) > budget)
        pace->shrink++;
    while (pace->shrink > 1 && cost_ms(pace, width, height, pace->shrink - 1) <= MARGIN * budget)
        pace->shrink--;
}
