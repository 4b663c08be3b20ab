// Turns films into what a window shows: scaled, tone mapped or in false colours, one picture or two
// side by side.
//
// The display's own kernels read the film in place; nothing of the renderer changes except the use
// of its command buffer. The kernels are specialized for what is shown, so that everything else
// costs nothing.
#ifndef LAMPYRIS_RENDER_SHOW_DISPLAY_H
#define LAMPYRIS_RENDER_SHOW_DISPLAY_H

#include "render/render.h"
#include "scene/core/settings.h"
#include "shared/display.h"

struct denoiser;

struct display_side {
    const struct renderer *renderer; // between two calls of renderer_render
    const struct denoiser *denoiser; // its picture is shown instead, with SHOWN_RADIANCE; or NULL
};

struct display_call {
    struct display_side sides[2];
    uint32_t side_count; // 0: all is black; 2: the second one is right of the line
    double split;        // position of the line, as a fraction of the picture's width
    uint32_t shown;      // SHOWN_*; needs the AOVs of display_aovs
    float exposure_stops;
    enum tone_curve tone;
    double range[2];        // range of false colours; range[1] <= range[0]: found from the picture
    uint32_t width, height; // size of the output, in pixels
    uint32_t picture[4];    // rectangle of the picture in it: x, y, width, height; black around it
    bool nearest;           // show pixels of a smaller picture as squares, without interpolation
    // Where the film of a side has no sample yet, show the picture kept by display_keep, if any.
    bool use_kept;
};

struct display {
    struct gpu *gpu;
    struct gpu_buffer pixels;  // RGBA8, rows from the top, call.width * call.height pixels, with
                               // room for more
    double range[2];           // the range in use
    double ms;                 // time of the last call on the device
    struct display_state *own; // see display.c
};

// Returns the AOVs that the renderer must have been created with for SHOWN_*.
uint32_t display_aovs(uint32_t shown);
extern const char *const shown_names[SHOWN_COUNT + 1]; // ended by NULL: "radiance" …
// Returns whether false colours are used, so that a range matters. shown_unit() returns the unit of
// the values as people write it ("m", "steps").
bool shown_has_range(uint32_t shown);
bool shown_is_logarithmic(uint32_t shown); // whether false colours are logarithmic
const char *shown_unit(uint32_t shown);

bool display_create(struct gpu *gpu, struct display *out, struct err *err);
void display_finish(struct display *display); // accepts NULL and {0}
// Fills display->pixels, and waits for it.
bool display_draw(struct display *display, const struct display_call *call, struct err *err);
// Keeps each side's picture (of any size, as display_draw showed it, before exposure and tone), to
// show it until the film, which is emptied and may change its size, has samples.
bool display_keep(struct display *display, const struct display_call *call, struct err *err);
void display_forget(struct display *display); // discards the pictures kept

#endif
