// Saves a render's state in a file, from which another process continues bit for bit.
//
// A file consists of a header, the identity (lines that must be the same when the render
// continues), the command line, the renderer's state, the tiles' plan, a hash of all that, and the
// film's records as they are in device memory, in blocks that each have a hash. Any bit that is
// changed or missing is detected. The file has the machine's byte order, and nothing in it depends
// on the wave size. An existing file is replaced atomically: see file_writer.
#ifndef LAMPYRIS_RENDER_CHECKPOINT_H
#define LAMPYRIS_RENDER_CHECKPOINT_H

#include "render/film_copy.h"
#include "render/render.h"
#include <stdio.h>

#define CHECKPOINT_STATE_WORDS 32
#define CHECKPOINT_NOTE_WORDS 4u
#define CHECKPOINT_TEXT_MAX (1u << 20) // limit in bytes, for the identity and for the command line

#define CHECKPOINT_BLOCK_BYTES                                                                     \
    (UINT64_C(1) << 20) // limit in bytes of a block of the film, without its hash

struct checkpoint_text {
    const char *identity; // lines of "name=value", each ending with a newline
    const char *command;  // quoted for a shell; not compared
};

// Writes a checkpoint. The renderer must be between waves. note: the caller's own data, which
// checkpoint_open() returns. Fails with ERR_OUTPUT if the file cannot be written; an older file
// then remains unchanged.
bool checkpoint_write(struct renderer *renderer, const char *path,
                      const struct checkpoint_text *text,
                      const uint64_t note[CHECKPOINT_NOTE_WORDS], struct err *err);
// Writes a checkpoint of a film in the host's memory. bytes: the size of its records; aovs: the
// renderer's specialization.aovs; tiles: NULL without a plan, otherwise film->done has the numbers
// of samples of the tiles.
bool checkpoint_write_copy(const struct film_copy *film, uint64_t bytes, uint32_t aovs,
                           const struct tiles *tiles, const char *path,
                           const struct checkpoint_text *text,
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
    uint64_t head_hash, block; // hash of everything before the film, and the number of the film's
                               // next block
};

// Reads everything before the film, and checks that the file has the length that its header states.
// Strings and lists live in the arena. Any content of the file is safe; ERR_INPUT if it is not
// valid. Close *out with checkpoint_close().
bool checkpoint_open(const char *path, struct arena *arena, struct checkpoint *out,
                     struct err *err);
// Opens a checkpoint as checkpoint_open() does, but from an open file. On failure the file still
// belongs to the caller.
bool checkpoint_read(FILE *file, const char *path, struct arena *arena, struct checkpoint *out,
                     struct err *err);
void checkpoint_close(struct checkpoint *checkpoint); // accepts NULL and {0}

// Returns the size of the film's next block, at most checkpoint->block_bytes; a valid file has a
// whole number of records in each block. 0: there is no further block.
uint64_t checkpoint_next_bytes(const struct checkpoint *checkpoint);
// Reads the film's next block and checks its hash. Fails with ERR_INPUT if the file is damaged.
bool checkpoint_next_block(struct checkpoint *checkpoint, void *block, struct err *err);
// Returns the saved state, without records and tiles.
struct film_copy checkpoint_film(const struct checkpoint *checkpoint);

// Fails with ERR_INPUT, naming the first difference, unless the identities are the same. An
// identity consists of lines "name=value".
bool checkpoint_check(const struct checkpoint *checkpoint, const char *identity, struct err *err);
// Compares `was`, the identity in the file at `path`, with `is`, as checkpoint_check() does.
// `whose` names the owner of `is` in the message.
bool checkpoint_compare(const char *path, const char *was, const char *whose, const char *is,
                        struct err *err);

// Puts a new renderer with the same identity into the saved state, and reads the rest of the file.
// Fails with ERR_INPUT if the rest is damaged.
bool checkpoint_restore(struct checkpoint *checkpoint, struct renderer *renderer, struct err *err);

#endif
