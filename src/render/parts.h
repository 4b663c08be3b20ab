// Lists the parts that a renderer may have (features of its kernels, kernels, buffers): which are
// in use, why the others are left out, and how much that saves.
#ifndef LAMPYRIS_RENDER_PARTS_H
#define LAMPYRIS_RENDER_PARTS_H

#include "render/render.h"

enum part_kind {
    PART_FEATURE,
    PART_GEOMETRY,
    PART_SPLIT_BUFFERS,
    PART_LOBE,
    PART_EMITTER,
    PART_KERNEL,
    PART_BUFFER
};

struct part {
    enum part_kind kind;
    uint32_t id; // bit in the part's specialization constant; for a kernel or a buffer, the index
    const char *name;
    bool is_kept;
    uint64_t bytes; // size of a buffer, even if it is left out
};

typedef void (*part_fn)(void *context, const struct part *part);
// Calls fn for every part, sorted by kind.
void parts_visit(const struct renderer *r, part_fn fn, void *context);

// Returns "feature", "lobe", "emitter", "kernel" or "buffer".
const char *part_kind_name(enum part_kind kind);

// Returns the reason why a part is left out, for display.
const char *part_reason(const struct renderer *r, const struct part *part);

// The cost of adding a part that is left out, and no other part: bytes of buffers, and SPIR-V
// instructions summed over all kernels. Parts that need each other cost more together.
struct part_cost {
    int64_t bytes, instructions;
};
struct part_cost part_find_cost(const struct renderer *r, const struct part *part);

// SPIR-V instructions of the renderer's kernels, and of all kernels before any part is left out.
struct part_totals {
    uint64_t instructions, all_instructions;
};
struct part_totals parts_count_instructions(const struct renderer *r);

#endif
