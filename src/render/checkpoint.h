// A render's state in a file: another process continues from it bit for bit.
//
// A file is a header, the identity (lines that must be the same when the render continues), the
// renderer's state, the plan of the tiles, the film's records as they are in device memory, and a
// hash over all that, in the machine's byte order. Nothing in it depends on the wave. It is
// replaced only by a complete file: see file_writer.
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

// Writes the renderer's state; the renderer must be between waves. identity: lines of "name=value",
// each ending with a newline. note: text of the caller, which checkpoint_open() returns. ERR_OUTPUT
// if the file cannot be written: an older file is then unchanged.
bool checkpoint_write(struct renderer *renderer, const char *path, const char *identity,
                      const uint64_t note[CHECKPOINT_NOTE_WORDS], struct err *err);

// A checkpoint that has been read up to its film.
struct checkpoint {
    FILE *file;
    const char *path, *identity;
    uint64_t state[CHECKPOINT_STATE_WORDS];
    uint64_t note[CHECKPOINT_NOTE_WORDS];
    uint64_t chunk_pixels, film_bytes;
    uint32_t tile_count; // 0: the samples are not counted by tile
    uint32_t *counts, *done;
};

// Reads the whole file once to verify its hash, then everything before the film; strings and lists
// live in the arena. Any file may be given: one that is no valid checkpoint is ERR_INPUT. The
// caller closes *out.
bool checkpoint_open(const char *path, struct arena *arena, struct checkpoint *out,
                     struct err *err);
// Does the same for an open file, which remains the caller's to close if this fails.
bool checkpoint_read(FILE *file, const char *path, struct arena *arena, struct checkpoint *out,
                     struct err *err);
void checkpoint_close(struct checkpoint *checkpoint); // accepts NULL and {0}

// Fails with ERR_INPUT, naming the first difference, unless the identities are the same. Identities
// are lines of "name=value".
bool checkpoint_check(const struct checkpoint *checkpoint, const char *identity, struct err *err);

// Puts a new renderer, which has the same identity, into the saved state.
bool checkpoint_restore(struct checkpoint *checkpoint, struct renderer *renderer, struct err *err);

#endif
