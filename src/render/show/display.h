// From films to what a window shows: scaled, toned, in false colours, two pictures side by side.
//
// Kernels of its own read the film where it is; nothing of the renderer changes, but for its
// command buffer's use. What is not shown costs nothing: its kernel is specialized for what is.
#ifndef LAMPYRIS_RENDER_SHOW_DISPLAY_H
#define LAMPYRIS_RENDER_SHOW_DISPLAY_H

#include "render/render.h"
#include "scene/core/settings.h"
#include "shared/display.h"

struct denoiser;

struct display_side {
    const struct renderer *renderer; // between two calls of renderer_render
    const struct denoiser *denoiser; // whose picture is shown instead, with SHOWN_RADIANCE; or NULL
};

struct display_call {
    struct display_side sides[2];
    uint32_t side_count; // 0: all is black; 1, or 2: the second is right of the line
    double split;        // where the line is, as a part of the picture's width
    uint32_t shown;      // SHOWN_*; needs the AOVs of display_aovs
    float exposure_stops;
    enum tone_curve tone;
    double range[2];        // of false colours; range[1] <= range[0]: found from the picture itself
    uint32_t width, height; // of what is made, pixels
    uint32_t picture[4];    // where in it the picture is: x, y, width, height; black around it
    bool nearest;           // pixels of a smaller picture as squares, not interpolated
    // Where the film of a side has no sample yet: what display_keep kept, if anything.
    bool use_kept;
};

struct display {
    struct gpu *gpu;
    struct gpu_buffer pixels;  // RGBA8, rows from the top, call.width * call.height; there is room
                               // for more
    double range[2];           // that was used
    double ms;                 // of the last call on the device
    struct display_state *own; // see display.c
};

// What a renderer has to have been created with for SHOWN_*.
uint32_t display_aovs(uint32_t shown);
extern const char *const shown_names[SHOWN_COUNT + 1]; // ended by NULL: "radiance" …
// Returns whether false colours are used, so that a range matters; and its unit for people ("m",
// "steps").
bool shown_has_range(uint32_t shown);
bool shown_is_logarithmic(uint32_t shown); // its false colours go by the logarithm
const char *shown_unit(uint32_t shown);

bool display_create(struct gpu *gpu, struct display *out, struct err *err);
void display_finish(struct display *display); // accepts NULL and {0}
// Fills display->pixels; waits.
bool display_draw(struct display *display, const struct display_call *call, struct err *err);
// Keeps each side's picture (of any size, as display_draw showed it, before exposure and tone), to
// be shown until the film, emptied and perhaps of another size, has samples.
bool display_keep(struct display *display, const struct display_call *call, struct err *err);
void display_forget(struct display *display); // nothing is kept any more

#endif
