// A render's state in a file: what is needed to go on with it, bit for bit, in another process.
//
// A file is a header, the identity (what must be the same when the render goes on), the renderer's
// state, the plan of the tiles, the film's records as they are in device memory, and a hash over
// all that, in the machine's byte order. It holds nothing that depends on the wave. It is replaced
// only by whole files: see file_writer.
#ifndef LAMPYRIS_RENDER_CHECKPOINT_H
#define LAMPYRIS_RENDER_CHECKPOINT_H

#include "render/render.h"
#include <stdio.h>

#define CHECKPOINT_STATE_WORDS 32
#define CHECKPOINT_NOTE_WORDS 2u
#define CHECKPOINT_IDENTITY_MAX (1u << 20)

// identity: lines of "name=value", each ending with a newline. note: the caller's own, which
// checkpoint_open() gives back. The renderer must be between waves.
// ERR_OUTPUT where the file cannot be written: an older one is then as it was.
bool checkpoint_write(struct renderer *renderer, const char *path, const char *identity,
                      const uint64_t note[CHECKPOINT_NOTE_WORDS], struct err *err);

// A checkpoint that was read as far as its film.
struct checkpoint {
    FILE *file;
    const char *path, *identity;
    uint64_t state[CHECKPOINT_STATE_WORDS];
    uint64_t note[CHECKPOINT_NOTE_WORDS];
    uint64_t chunk_pixels, film_bytes;
    uint32_t tile_count; // 0: the samples are not counted by tile
    uint32_t *counts, *done;
};

// Reads all of the file once to see whether it is whole, then what stands before the film; strings
// and lists live in the arena. The file may be anything: ERR_INPUT. *out is to be closed.
bool checkpoint_open(const char *path, struct arena *arena, struct checkpoint *out,
                     struct err *err);
// The same of a file that is open already, which is the caller's to close when this fails.
bool checkpoint_read(FILE *file, const char *path, struct arena *arena, struct checkpoint *out,
                     struct err *err);
void checkpoint_close(struct checkpoint *checkpoint); // accepts NULL and {0}

// ERR_INPUT, naming the first thing that differs, unless the identities are the same. Identities
// are lines "name=value".
bool checkpoint_check(const struct checkpoint *checkpoint, const char *identity, struct err *err);

// Puts a new renderer, of the same identity, into the state that was saved.
bool checkpoint_restore(struct checkpoint *checkpoint, struct renderer *renderer, struct err *err);

#endif
