// Copies the film's records, and the renderer's state that belongs to them, to host memory. After
// its device was reopened, the same renderer can continue from the copy bit for bit.
#ifndef LAMPYRIS_RENDER_FILM_COPY_H
#define LAMPYRIS_RENDER_FILM_COPY_H

#include "render/render.h"

struct film_copy {
    char *records;  // records of all film buffers, one after the other; NULL: the film is empty
    uint32_t *done; // samples that each tile has so far; NULL without tiles
    uint32_t seed;
    uint64_t next_sample, round_target, emptied_at;
    struct pass pass;
    struct render_stats stats;
};

// Returns the bytes that the records take.
uint64_t film_copy_bytes(const struct renderer *renderer);
// A range of the records, from byte `first` on.
struct film_range {
    uint64_t first, bytes;
};
// Returns the range that can have samples: the rows that are rendered, or all rows if there are
// light paths.
struct film_range film_copy_range(const struct renderer *renderer);
// Returns the members of the renderer that belong to the film, without records and tiles.
struct film_copy film_copy_state(const struct renderer *renderer);
// Copy `bytes` bytes of the records, from offset `at`, from the device or to it.
bool film_copy_get_bytes(struct renderer *renderer, uint64_t at, void *out, uint64_t bytes,
                         struct err *err);
bool film_copy_put_bytes(struct renderer *renderer, uint64_t at, const void *data, uint64_t bytes,
                         struct err *err);
// Copies the film and its state; call it between waves. The arrays live in the arena. is_empty: the
// film has no sample, and no records are copied.
bool film_copy_take(struct renderer *renderer, bool is_empty, struct arena *arena,
                    struct film_copy *out, struct err *err);
// Writes the copy to the film of a reopened renderer. The renderer keeps the seconds of its own
// statistics.
bool film_copy_put(const struct film_copy *copy, struct renderer *renderer, struct err *err);
// Adds the film `part` to `to`. Both must be copies of films of this renderer, or of another one
// with the same scene, settings and device. Both must have records, and no sample may be in both.
// Any order and grouping of additions gives the bits of one film with all the samples. Afterwards
// the sample numbers of `to` span both films; its statistics are unchanged. Fails for films whose
// sums depend on the order of samples (--accumulation sum or running, --halves contiguous), for
// films by tiles, for different seeds, and for films that begin with an odd sample, since that
// sample belongs to the other half-buffer.
bool film_copy_add(const struct renderer *renderer, const struct film_copy *part,
                   struct film_copy *to, struct err *err);
// Adds the records of `pixels` pixels of films that film_copy_add() accepts. aovs: the renderers'
// specialization.aovs; precedes: the first sample of the part is before that of `to`.
void film_records_add(uint32_t aovs, const char *part, char *to, uint64_t pixels, bool precedes);

#endif
