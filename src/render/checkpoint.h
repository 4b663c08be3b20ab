// A render's state in a file: another process continues from it bit for bit.
//
// A file is a header, the identity (lines that must be the same when the render continues), the
// command line, the renderer's state, the plan of the tiles, a hash over all that, and the film's
// records as they are in device memory, in blocks that each have a hash: any bit that is changed or
// missing is found. It is in the machine's byte order, and nothing in it depends on the wave. It is
// replaced only by a complete file: see file_writer.
#ifndef LAMPYRIS_RENDER_CHECKPOINT_H
#define LAMPYRIS_RENDER_CHECKPOINT_H

#include "render/film_copy.h"
#include "render/render.h"
#include <stdio.h>

#define CHECKPOINT_STATE_WORDS 32
#define CHECKPOINT_NOTE_WORDS 4u
#define CHECKPOINT_TEXT_MAX (1u << 20) // bytes of the identity, and of the command line

#define CHECKPOINT_BLOCK_BYTES (UINT64_C(1) << 20) // at most; each block of the film has a hash

struct checkpoint_text {
    const char *identity; // lines of "name=value", each ending with a newline
    const char *command;  // as a shell takes it; not compared
};

// note: the caller's own, which checkpoint_open() gives back. The renderer must be between waves.
// ERR_OUTPUT where the file cannot be written: an older one is then as it was.
bool checkpoint_write(struct renderer *renderer, const char *path,
                      const struct checkpoint_text *text,
                      const uint64_t note[CHECKPOINT_NOTE_WORDS], struct err *err);
// Writes a checkpoint of a film in the host's memory, without tiles, likewise. bytes: the size of
// its records; aovs: the renderer's specialization.aovs.
bool checkpoint_write_copy(const struct film_copy *film, uint64_t bytes, uint32_t aovs,
                           const char *path, const struct checkpoint_text *text,
                           const uint64_t note[CHECKPOINT_NOTE_WORDS], struct err *err);

// A checkpoint that has been read up to its film.
struct checkpoint {
    FILE *file;
    const char *path, *identity, *command;
    uint64_t state[CHECKPOINT_STATE_WORDS];
    uint64_t note[CHECKPOINT_NOTE_WORDS];
    uint64_t film_bytes;
    uint32_t tile_count; // 0: the samples are not counted by tile
    uint32_t *counts, *done;
    uint32_t block_bytes;
    uint64_t head_hash, block; // the next one of the film's blocks
};

// Reads what stands before the film, and checks that the file is as long as it says; strings and
// lists live in the arena. The file may be anything: ERR_INPUT. *out is to be closed.
bool checkpoint_open(const char *path, struct arena *arena, struct checkpoint *out,
                     struct err *err);
// Does the same for an open file, which remains the caller's to close if this fails.
bool checkpoint_read(FILE *file, const char *path, struct arena *arena, struct checkpoint *out,
                     struct err *err);
void checkpoint_close(struct checkpoint *checkpoint); // accepts NULL and {0}

// Returns the bytes of the film's next block, at most checkpoint->block_bytes: whole records but in
// files that lie. 0: there is none.
uint64_t checkpoint_next_bytes(const struct checkpoint *checkpoint);
// Reads that block and checks its hash. ERR_INPUT where the file is damaged.
bool checkpoint_next_block(struct checkpoint *checkpoint, void *block, struct err *err);
// Returns the state of the renderer, without records and tiles.
struct film_copy checkpoint_film(const struct checkpoint *checkpoint);

// ERR_INPUT, naming the first thing that differs, unless the identities are the same. Identities
// are lines "name=value".
bool checkpoint_check(const struct checkpoint *checkpoint, const char *identity, struct err *err);
// Compares the identity `was` of the file at `path` with another one, `is`, likewise. The message
// says `whose` that is.
bool checkpoint_compare(const char *path, const char *was, const char *whose, const char *is,
                        struct err *err);

// Puts a new renderer, of the same identity, into the state that was saved, and reads the rest of
// the file, which may turn out to be damaged.
bool checkpoint_restore(struct checkpoint *checkpoint, struct renderer *renderer, struct err *err);

#endif
