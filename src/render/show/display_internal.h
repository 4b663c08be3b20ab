// Declares what the display's files share.
#ifndef LAMPYRIS_RENDER_SHOW_DISPLAY_INTERNAL_H
#define LAMPYRIS_RENDER_SHOW_DISPLAY_INTERNAL_H

#include "render/show/display.h"
#include "render/show/paced.h"

enum display_code { DISPLAY_READ, DISPLAY_SCALE, DISPLAY_SHOW, DISPLAY_RANGE, DISPLAY_CODES };

#define DISPLAY_KERNELS 32u // maximum number of kernels that are kept
#define DISPLAY_SETS 32u    // maximum number of sets in one submission

// A linear image: see shared/display.h. Its buffer may be larger than the image.
struct linear {
    struct gpu_buffer buffer;
    uint32_t width, height;
};

// A scaled image, and the table of the filter that scales it: see display_scale().
struct sized {
    struct linear picture;
    struct gpu_buffer taps; // struct gpu_display_taps
    uint32_t key[5];        // the sizes for which the taps were computed
};

// The images of one side.
struct display_pictures {
    struct linear film; // of the film's size; the chunks of a film use it one after the other
    struct sized sized; // of the size on the screen, if that differs from the film's
    struct linear kept, kept_next;
    struct sized kept_sized;
    struct gpu_buffer sources; // see DISPLAY_BINDING_SOURCES
    bool is_kept;
    uint32_t kept_shown; // SHOWN_* of the kept image
};

struct display_state {
    struct paced paced;
    struct gpu_kernel kernels[DISPLAY_KERNELS];
    uint32_t kernel_count; // kernels created so far; beyond DISPLAY_KERNELS the oldest is destroyed
    struct gpu_bindings sets[DISPLAY_SETS]; // created when first needed, then reused
    uint32_t set_count;                     // sets in the commands being recorded
    struct display_pictures sides[2];
    struct gpu_buffer palette; // linear colours
    struct gpu_buffer range;   // struct gpu_display_range
};

// A dispatch of one of the display's kernels.
struct display_work {
    enum display_code code;
    uint32_t constants[DISPLAY_CONSTANT_COUNT]; // texel use and workgroup size are added
    struct gpu_display_push push;
    const struct gpu_buffer *buffers[DISPLAY_BINDING_COUNT]; // indexed by binding
    uint64_t threads;
};

// --- display_work.c ------------------------------------------------------------------------------
bool display_begin(struct display *display, struct err *err);
// Records a dispatch and a barrier after it; see paced.h.
bool display_dispatch(struct display *display, const struct display_work *work, struct err *err);
// Submits and waits; adds the time on the device to display->ms.
bool display_end(struct display *display, struct err *err);
// Makes room for an image. A buffer that grows loses its contents.
bool display_reserve(struct display *display, const char *name, uint32_t width, uint32_t height,
                     struct linear *out, struct err *err);
// Does the same for a buffer of `bytes` bytes.
bool display_reserve_bytes(struct display *display, const char *name, uint64_t bytes, bool texel,
                           struct gpu_buffer *out, struct err *err);
void display_work_finish(struct display *display);

// --- display_scale.c -----------------------------------------------------------------------------
// A part of a film in one of its buffers: pixels [first, first + count).
struct display_part {
    uint32_t chunk, first, count;
};
// Computes to->picture, whose size is set, by scaling `from`. With a part, `from` begins with that
// part's pixels, and only their contribution is added. part NULL: `from` is the whole image.
bool display_scale(struct display *display, const struct linear *from,
                   const struct display_part *part, bool nearest, struct sized *to,
                   struct err *err);

// --- display_range.c -----------------------------------------------------------------------------
// Finds the range of the values in the images that are shown; range[0] < range[1].
bool display_find_range(struct display *display, uint32_t shown,
                        const struct linear *const pictures[2], uint32_t count, double range[2],
                        struct err *err);

#endif
