// The device, the images that accumulate on it, and their display.
#ifndef LAMPYRIS_VIEWER_CORE_STAGE_H
#define LAMPYRIS_VIEWER_CORE_STAGE_H

#include "gpu/screen.h"
#include "render/show/display.h"
#include "viewer/core/edit.h"
#include "viewer/core/view.h"
#include "viewer/window/swapchain.h"

#define VIEWER_SIDES 2u

// The display settings. They are plain data, so that the history can restore them (TARGET_DISPLAY).
struct shown {
    uint32_t what;      // SHOWN_*
    float exposure;     // stops
    uint32_t tone;      // enum tone_curve
    uint32_t automatic; // the range of false colours is computed from the image
    double range[2];
    uint32_t denoise, denoise_temporal, denoise_iterations;
    uint32_t split;  // both sides are shown
    double split_at; // position of the dividing line, as a fraction of the width
    uint32_t nearest;
    uint32_t spp_limit;        // samples per pixel at which rendering stops; 0: no limit
    uint32_t exposure_is_auto; // 1 if the exposure is computed from the image
    uint32_t error_by; // how the error is split: 0 not at all, otherwise 1 + enum error_kind
};

// Measurements of the last frames, for the panel.
struct frame_stats {
    // Frames per second, and the time from one frame to the next, waiting included: both are means
    // over the same half second.
    double fps, frame_ms;
    // Times of the last frame.
    double render_ms, denoise_ms, display_ms, panel_ms, present_ms;
    uint64_t frames;
    double kernel_ms[KERNEL_COUNT]; // time per frame, a running mean
    // Rays, and samples over all pixels, per second in the last half second.
    double rays_per_second, samples_per_second;
};

// Times of all frames of one kind, for the report at the end.
struct frame_times {
    float *ms;
    // The number of times, and the number for which there is memory. Only about the first hour of
    // frames is kept.
    uint32_t count, capacity;
};

// Counts since the last update of the rates.
struct frame_rate {
    double since, rays, samples;
    uint32_t frames;
};

struct stage {
    struct gpu gpu;
    struct swapchain swapchain;
    struct gpu_screen screen;
    struct display display;
    uint32_t recoveries; // number of times that a lost device was recovered

    struct view sides[VIEWER_SIDES];
    uint32_t side_count;
    uint32_t edited_side;                  // side whose method the panel shows
    enum change changes[VIEWER_SIDES];     // changes requested in this frame, for each side
    const struct kernel_set *kernels;      // owned by reload.c; NULL: the embedded kernels
    const struct kernel_set *good_kernels; // the last set with which all sides could be built
    bool shaders_changed;                  // reload.c has compiled new kernels
    bool is_paused;
    bool is_resting; // nothing is left to do but to wait for events

    struct shown shown;
    // Samples per pixel at which the exposure is computed next; 0: it is fixed.
    uint64_t exposure_samples;
    // The call that drew the screen's content; its sides may have changed since.
    struct display_call last_call;
    bool has_kept; // display_keep() holds an image to show while there are no samples

    // Progress listener that stops renderers at the end of the frame's time.
    struct progress frame_progress;
    uint64_t render_until_ns; // clock time at which rendering stops
    double frame_samples;     // samples over all pixels in the current frame
    double render_seconds;    // total rendering time of all frames
    struct frame_stats stats;
    struct frame_rate rate;
    struct frame_times moving_times, resting_times;
};

#endif
