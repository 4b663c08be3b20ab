// A stream whose text is kept in memory, for what is written by fprintf() and the like.
#ifndef LAMPYRIS_BASE_MEMORY_STREAM_H
#define LAMPYRIS_BASE_MEMORY_STREAM_H

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

// Must not be moved while it is open.
struct memory_stream {
    FILE *file; // NULL while it is not open
    char *text; // known once the stream is closed, and followed by a NUL byte
    size_t size;
};

// False without memory.
bool memory_stream_open(struct memory_stream *stream);
// False where not everything could be kept. Accepts {0}.
bool memory_stream_close(struct memory_stream *stream);
// Closes it, and frees the text. Accepts {0}.
void memory_stream_finish(struct memory_stream *stream);

#endif
