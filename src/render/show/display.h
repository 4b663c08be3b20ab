// Converts films to the pixels of a window: scaled, and tone mapped or in false colours; one image,
// or two side by side.
//
// The display's own kernels read the film in place; they change nothing in the renderer except that
// they use its command buffer. They are specialized for what is shown, so that unused options cost
// nothing.
#ifndef LAMPYRIS_RENDER_SHOW_DISPLAY_H
#define LAMPYRIS_RENDER_SHOW_DISPLAY_H

#include "render/render.h"
#include "scene/core/settings.h"
#include "shared/display.h"

struct denoiser;

struct display_side {
    const struct renderer *renderer; // must be between two calls of renderer_render
    const struct denoiser *denoiser; // its image is shown instead of the film's, with
                                     // SHOWN_RADIANCE; NULL: none
};

struct display_call {
    struct display_side sides[2];
    uint32_t side_count; // 0: all is black; 2: the second side is to the right of the line
    double split;        // position of the dividing line, as a fraction of the image's width
    uint32_t shown;      // SHOWN_*; the renderer must have the AOVs of display_aovs()
    float exposure_stops;
    enum tone_curve tone;
    double range[2];        // range of false colours; if range[1] <= range[0], it is found from the
                            // image
    uint32_t width, height; // size of the output, in pixels
    uint32_t picture[4];    // rectangle of the image in the output: x, y, width, height; black
                            // around it
    bool nearest;           // shows pixels of a smaller image as squares, without interpolation
    // As long as the film of a side has no sample, shows the image kept by display_keep(), if any.
    bool use_kept;
};

struct display {
    struct gpu *gpu;
    struct gpu_buffer pixels;  // RGBA8, rows from the top, call.width * call.height pixels, with
                               // room for more
    double range[2];           // range used by the last call
    double ms;                 // time of the last call on the device, in milliseconds
    struct display_state *own; // see display.c
};

// Returns the AOVs with which the renderer must have been created to show SHOWN_*.
uint32_t display_aovs(uint32_t shown);
extern const char *const shown_names[SHOWN_COUNT + 1]; // ended by NULL: "radiance", …
// Returns whether the quantity is shown in false colours, which have a range. shown_unit() returns
// the unit of its values for display ("m", "steps").
bool shown_has_range(uint32_t shown);
bool shown_is_logarithmic(uint32_t shown); // whether the false colours are logarithmic
const char *shown_unit(uint32_t shown);

bool display_create(struct gpu *gpu, struct display *out, struct err *err);
void display_finish(struct display *display); // accepts NULL and {0}
// Fills display->pixels, and waits until they are complete.
bool display_draw(struct display *display, const struct display_call *call, struct err *err);
// Keeps the linear image of each side, of any size, as display_draw() has shown it, before exposure
// and tone mapping. It can be shown again while the film, which may be emptied and change its size,
// has no samples.
bool display_keep(struct display *display, const struct display_call *call, struct err *err);
void display_forget(struct display *display); // discards kept images

#endif
