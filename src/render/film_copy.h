// The film's records in the host's memory, and what of the renderer belongs to them: from these the
// same renderer goes on, bit for bit, once its device was opened again.
#ifndef LAMPYRIS_RENDER_FILM_COPY_H
#define LAMPYRIS_RENDER_FILM_COPY_H

#include "render/render.h"

struct film_copy {
    char *records;  // of all film buffers, one after the other; NULL: the film is empty
    uint32_t *done; // of each tile; NULL without tiles
    uint32_t seed;
    uint64_t next_sample, round_target, emptied_at;
    struct pass pass;
    struct render_stats stats;
};

// Bytes that the records take.
uint64_t film_copy_bytes(const struct renderer *renderer);
// Between waves. The arrays live in the arena. is_empty: the film has no sample, and no records are
// copied.
bool film_copy_take(struct renderer *renderer, bool is_empty, struct arena *arena,
                    struct film_copy *out, struct err *err);
// Into the film of a renderer that was reopened. The seconds in its statistics go on.
bool film_copy_put(const struct film_copy *copy, struct renderer *renderer, struct err *err);
// Adds the film `part` to `to`, both of them copies of films of this renderer or of one of the same
// scene, settings and device: in any order and grouping the bits are those of one film with all
// samples. Both have records, and no sample is in both. The sample numbers of `to` then span both;
// its statistics stay. Refuses films whose samples have an order (--accumulation sum or running,
// --halves contiguous), films by tiles, other seeds, and films that begin with an odd sample, which
// would be the other half's.
bool film_copy_add(const struct renderer *renderer, const struct film_copy *part,
                   struct film_copy *to, struct err *err);

#endif
