// The device, the pictures that accumulate on it, and what is seen of them.
#ifndef LAMPYRIS_VIEWER_CORE_STAGE_H
#define LAMPYRIS_VIEWER_CORE_STAGE_H

#include "gpu/screen.h"
#include "render/show/display.h"
#include "viewer/core/edit.h"
#include "viewer/core/view.h"
#include "viewer/window/swapchain.h"

#define VIEWER_SIDES 2u

// What is seen of what is rendered. Plain data, undone as TARGET_DISPLAY.
struct shown {
    uint32_t what;      // SHOWN_*
    float exposure;     // stops
    uint32_t tone;      // enum tone_curve
    uint32_t automatic; // range of false colours: found from the picture
    double range[2];
    uint32_t denoise, denoise_temporal, denoise_iterations;
    uint32_t split;  // two sides
    double split_at; // part of the width
    uint32_t nearest;
    uint32_t spp_limit;        // samples of a pixel after which the picture rests; 0: none
    uint32_t exposure_is_auto; // 1: found from the picture
    uint32_t error_by;         // 0: nothing; else 1 + enum error_kind: what its error is split by
};

// Figures of the last frames for the panel.
struct frame_stats {
    double fps;      // over the last half second
    double frame_ms; // the last frame, all of it
    double render_ms, denoise_ms, display_ms, panel_ms, present_ms;
    uint64_t frames;
    double kernel_ms[KERNEL_COUNT];             // a frame, a running mean
    double rays_per_second, samples_per_second; // of one pixel each; over the last half second
};

// Times of all frames of a kind, for the report at the end.
struct frame_times {
    float *ms;
    uint32_t count, capacity; // the first ones
};

// Since the rates were told last.
struct frame_rate {
    double since, rays, samples;
    uint32_t frames;
};

struct stage {
    struct gpu gpu;
    struct swapchain swapchain;
    struct gpu_screen screen;
    struct display display;
    uint32_t recoveries; // of lost devices

    struct view sides[VIEWER_SIDES];
    uint32_t side_count;
    uint32_t edited_side;                  // whose method the panel shows
    enum change changes[VIEWER_SIDES];     // asked for in this frame, by side
    const struct kernel_set *kernels;      // of reload.c; NULL: the embedded ones
    const struct kernel_set *good_kernels; // with which all sides were built
    bool shaders_changed;                  // reload.c made new kernels
    bool is_paused;
    bool is_resting; // nothing is left to do but to wait for events

    struct shown shown;
    uint64_t exposure_samples;     // of a pixel, at which the exposure is to be found; 0: it stays
    struct display_call last_call; // what is on the screen; without sides: they may have changed
    bool has_kept;                 // display_keep: shown where there are no samples yet

    struct progress frame_progress; // of renderers: stops them when the frame's time is over
    uint64_t render_until_ns;       // the clock's time then
    double frame_samples;           // of single pixels, in the frame that runs
    double render_seconds;          // of all frames
    struct frame_stats stats;
    struct frame_rate rate;
    struct frame_times moving_times, resting_times;
};

#endif
