// Declarations shared by the display's files.
#ifndef LAMPYRIS_RENDER_SHOW_DISPLAY_INTERNAL_H
#define LAMPYRIS_RENDER_SHOW_DISPLAY_INTERNAL_H

#include "render/show/display.h"
#include "render/show/paced.h"

enum display_code { DISPLAY_READ, DISPLAY_SCALE, DISPLAY_SHOW, DISPLAY_RANGE, DISPLAY_CODES };

#define DISPLAY_KERNELS 32u // the most that are kept
#define DISPLAY_SETS 32u    // the most that one submission uses

// A linear picture: see shared/display.h. Its buffer may be larger.
struct linear {
    struct gpu_buffer buffer;
    uint32_t width, height;
};

// A scaled picture and the table of its filter: see display_scale.
struct sized {
    struct linear picture;
    struct gpu_buffer taps; // struct gpu_display_taps
    uint32_t key[5];        // the sizes that they were made for
};

// The pictures of one side.
struct display_pictures {
    struct linear film; // has its own size; the chunks of a film follow each other
    struct sized sized; // has the size on the screen, if that differs
    struct linear kept, kept_next;
    struct sized kept_sized;
    struct gpu_buffer sources; // see DISPLAY_BINDING_SOURCES
    bool is_kept;
    uint32_t kept_shown; // SHOWN_*
};

struct display_state {
    struct paced paced;
    struct gpu_kernel kernels[DISPLAY_KERNELS];
    uint32_t kernel_count; // kernels so far; beyond DISPLAY_KERNELS the oldest is destroyed
    struct gpu_bindings sets[DISPLAY_SETS]; // created when needed, and used again
    uint32_t set_count;                     // sets in the commands that are recorded
    struct display_pictures sides[2];
    struct gpu_buffer palette; // linear colours
    struct gpu_buffer range;   // struct gpu_display_range
};

// A dispatch.
struct display_work {
    enum display_code code;
    uint32_t constants[DISPLAY_CONSTANT_COUNT]; // texels and workgroup are added
    struct gpu_display_push push;
    const struct gpu_buffer *buffers[DISPLAY_BINDING_COUNT]; // by binding
    uint64_t threads;
};

// --- display_work.c ------------------------------------------------------------------------------
bool display_begin(struct display *display, struct err *err);
// Records a dispatch and a barrier after it; see paced.h.
bool display_dispatch(struct display *display, const struct display_work *work, struct err *err);
// Submits and waits; adds the time that it took to display->ms.
bool display_end(struct display *display, struct err *err);
// Makes room for a picture; a buffer that grows loses its contents.
bool display_reserve(struct display *display, const char *name, uint32_t width, uint32_t height,
                     struct linear *out, struct err *err);
// Does the same for any buffer, of `bytes`.
bool display_reserve_bytes(struct display *display, const char *name, uint64_t bytes, bool texel,
                           struct gpu_buffer *out, struct err *err);
void display_work_finish(struct display *display);

// --- display_scale.c -----------------------------------------------------------------------------
// Pixels [first, first + count) of a film, in one of its buffers.
struct display_part {
    uint32_t chunk, first, count;
};
// Makes to->picture, whose size is set, from `from`; or, with a part, adds the contribution of that
// part, which is in the first pixels of `from`. part NULL: `from` is the whole picture.
bool display_scale(struct display *display, const struct linear *from,
                   const struct display_part *part, bool nearest, struct sized *to,
                   struct err *err);

// --- display_range.c -----------------------------------------------------------------------------
// Finds the range of the values in the pictures that are shown. *low < *high.
bool display_find_range(struct display *display, uint32_t shown,
                        const struct linear *const pictures[2], uint32_t count, double range[2],
                        struct err *err);

#endif
