// Plans a render's memory on the device before anything is allocated.
#ifndef LAMPYRIS_RENDER_MEMORY_PLAN_H
#define LAMPYRIS_RENDER_MEMORY_PLAN_H

#include "render/specialize.h"
#include "render/tables/shading_tables.h"
#include "shared/bindings.h"

struct planned_buffer {
    const char *name;        // NULL: the scene does not need it
    uint64_t bytes;          // 0 where not needed
    uint64_t unneeded_bytes; // what leaving it out saves
    uint32_t copies; // buffers of `bytes` each: of the film, the last of which may be smaller,
                     // and of what each wave in flight has
    uint32_t parts;  // storage bindings; more than one where a range is too short for all
};

struct memory_plan {
    struct planned_buffer buffers[BINDING_COUNT];
    uint32_t waves;             // in flight: 1 or 2
    uint32_t wave_slots;        // paths of a wave, a multiple of the workgroup size
    uint32_t wave_samples;      // that these paths are of: as many, but where paths split
    uint32_t part_items;        // items of a queue that one dispatch takes at most
    uint64_t film_chunk_pixels; // pixels a film buffer holds
    uint32_t film_chunks;
    uint64_t resolve_pixels; // pixels that are read back at a time
    uint64_t total_bytes;
    // Scene buffers may be in parts, all as long but the last. `parts` is the constant PARTS,
    // part_shift the logarithm of their length in words of four.
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
    uint64_t pixels; // of the largest picture; 0: of what the settings say
    uint32_t wave;   // wanted; 0: the device's default. Lowered where a limit asks for it.
    uint32_t waves;  // in flight; 0: as many as suit the device
    // Lowered without a warning, to the default where memory is too small for what is wanted.
    bool wave_is_wish;
    uint64_t replaced_bytes; // of buffers that there are already, and that the plan's replace
};

// Fails with ERR_GPU, naming buffer, bytes, limit and what would help, when the scene cannot fit.
// *s, which is params->specialization, gets what depends on the plan: storage buffers where one of
// the scene's cannot be read as texels, and how long ones are split.
bool memory_plan_make(const struct memory_plan_params *params, struct specialization *s,
                      struct memory_plan *out, struct err *err);

// Bytes of all buffers that `params->specialization` needs in a wave of `slots` paths, but for the
// film and what is read back of it. Allocates nothing and refuses nothing.
uint64_t memory_plan_bytes(const struct memory_plan_params *params, uint32_t slots);

// Bytes of what grows with the picture: its film, and what is read back of it at a time. 0 where no
// buffer holds a pixel. Refuses nothing either.
uint64_t memory_plan_picture_bytes(const struct memory_plan_params *params);

// Puts in front of why kernels were refused which of the scene's buffers is too long for texels,
// where that is why they bind so many storage buffers. Returns false.
bool memory_plan_refused(const struct memory_plan *plan, const struct gpu *gpu, struct err *err);

// Returns whether each wave in flight has a buffer of its own for this binding.
bool memory_plan_is_of_wave(const struct specialization *specialization, uint32_t binding);

// Returns what is said behind the number of a wave's paths: nothing where one wave is in flight.
const char *memory_plan_in_flight(const struct memory_plan *plan);

const char *binding_name(uint32_t binding);

#endif
