// Plans a render's memory on the device before anything is allocated.
#ifndef LAMPYRIS_RENDER_MEMORY_PLAN_H
#define LAMPYRIS_RENDER_MEMORY_PLAN_H

#include "render/specialize.h"
#include "render/tables/shading_tables.h"
#include "shared/bindings.h"

struct planned_buffer {
    const char *name;        // NULL: the scene does not need it
    uint64_t bytes;          // size of one copy; 0 if not needed
    uint64_t unneeded_bytes; // bytes that leaving the buffer out saves
    uint32_t copies;         // number of buffers of this size: one for each chunk of the film, the
                             // last of which may be smaller, or one for each wave in flight
    uint32_t parts;          // storage bindings; more than one if the buffer exceeds a storage
                             // range
};

struct memory_plan {
    struct planned_buffer buffers[BINDING_COUNT];
    uint32_t waves;             // number of waves in flight, 1 or 2
    uint32_t wave_slots;        // path slots of a wave, a multiple of the workgroup size
    uint32_t wave_samples;      // samples of a wave; fewer than slots if paths split
    uint32_t part_items;        // maximum number of a queue's items that one dispatch processes
    uint64_t film_chunk_pixels; // pixels that one film buffer holds
    uint32_t film_chunks;
    uint64_t resolve_pixels; // pixels that are read back at a time
    uint64_t total_bytes;
    // Scene buffers may consist of parts of the same length; the last part may be shorter. `parts`
    // is the specialization constant PARTS, and part_shift is the base-2 logarithm of a part's
    // length in uvec4 words.
    uint32_t parts, part_shift;
    uint64_t part_bytes;
};

struct memory_plan_params {
    const struct scene *scene;
    const struct flat_scene *flat;
    const struct bvh *bvh;
    const struct specialization *specialization;
    const struct shading_tables *tables;
    const struct gpu *gpu;
    uint64_t pixels; // pixels of the largest picture; 0: as many as in the settings
    uint32_t wave;   // paths wanted in a wave; 0: the device's default. A limit may lower it.
    uint32_t waves;  // waves in flight; 0: as many as suit the device
    // Lowers `wave` without a warning. If memory does not suffice for `wave`, lowers it to the
    // default.
    bool wave_is_wish;
    uint64_t replaced_bytes; // size of the existing buffers that the plan's buffers replace
};

// Plans all buffers. Fails with ERR_GPU, naming the buffer, its size, the limit and a remedy, if
// the scene cannot fit. Sets the members of *s, which is params->specialization, that depend on the
// plan: whether storage buffers are used because a scene buffer has too many texels, and the length
// of the parts of long buffers.
bool memory_plan_make(const struct memory_plan_params *params, struct specialization *s,
                      struct memory_plan *out, struct err *err);

// Returns the bytes of all buffers that `params->specialization` needs for a wave of `slots` paths,
// without the film and the buffer by which the film is read back. Allocates nothing and never
// fails.
uint64_t memory_plan_bytes(const struct memory_plan_params *params, uint32_t slots);

// Returns the bytes of the buffers that grow with the picture: the film, and the buffer that reads
// it back in pieces. 0 if no buffer can hold a pixel. Never fails.
uint64_t memory_plan_picture_bytes(const struct memory_plan_params *params);

// Explains why kernels were refused for binding too many storage buffers. If the cause is a scene
// buffer with too many texels, prepends this reason, with the buffer's name, to the message.
// Returns false.
bool memory_plan_refused(const struct memory_plan *plan, const struct gpu *gpu, struct err *err);

// Returns whether each wave in flight has its own buffer for this binding.
bool memory_plan_is_of_wave(const struct specialization *specialization, uint32_t binding);

// Returns the text printed after the number of a wave's paths; empty if one wave is in flight.
const char *memory_plan_in_flight(const struct memory_plan *plan);

const char *binding_name(uint32_t binding);

#endif
