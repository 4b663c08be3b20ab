// A copy of the film's records and of the renderer's state about them in the host's memory: the
// same renderer continues from it bit for bit after its device was opened again.
#ifndef LAMPYRIS_RENDER_FILM_COPY_H
#define LAMPYRIS_RENDER_FILM_COPY_H

#include "render/render.h"

struct film_copy {
    char *records;  // records of all film buffers, one after the other; NULL: the film is empty
    uint32_t *done; // samples of each tile so far; NULL without tiles
    uint32_t seed;
    uint64_t next_sample, round_target, emptied_at;
    struct pass pass;
    struct render_stats stats;
};

// Returns the bytes that the records take.
uint64_t film_copy_bytes(const struct renderer *renderer);
// Returns what of the renderer belongs to a film, without records and tiles.
struct film_copy film_copy_state(const struct renderer *renderer);
// Copy bytes of the records, from `at` on, from the device or to it.
bool film_copy_get_bytes(struct renderer *renderer, uint64_t at, void *out, uint64_t bytes,
                         struct err *err);
bool film_copy_put_bytes(struct renderer *renderer, uint64_t at, const void *data, uint64_t bytes,
                         struct err *err);
// Between waves. The arrays live in the arena. is_empty: the film has no sample, and no records are
// copied.
bool film_copy_take(struct renderer *renderer, bool is_empty, struct arena *arena,
                    struct film_copy *out, struct err *err);
// Puts the copy into the film of a renderer that was reopened. The seconds in its statistics go on.
bool film_copy_put(const struct film_copy *copy, struct renderer *renderer, struct err *err);
// Adds the film `part` to `to`. Both must be copies of films of this renderer, or of another with
// the same scene, settings and device; both must have records, and no sample may be in both. In any
// order and grouping the result has the bits of one film with all the samples. The sample numbers
// of `to` then span both films; its statistics are unchanged. Fails for films whose samples have an
// order (--accumulation sum or running, --halves contiguous), for films by tiles, for different
// seeds, and for films that begin with an odd sample, since that belongs to the other half-buffer.
bool film_copy_add(const struct renderer *renderer, const struct film_copy *part,
                   struct film_copy *to, struct err *err);
// Adds the records of `pixels` pixels of such films. aovs: the renderers' specialization.aovs;
// precedes: the part's first sample comes before the first one of `to`.
void film_records_add(uint32_t aovs, const char *part, char *to, uint64_t pixels, bool precedes);

#endif
