// A stream that writes to memory, for use with fprintf() and similar functions.
#ifndef LAMPYRIS_BASE_MEMORY_STREAM_H
#define LAMPYRIS_BASE_MEMORY_STREAM_H

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

// It must not be moved while it is open.
struct memory_stream {
    FILE *file; // NULL while it is not open
    char *text; // known once the stream is closed, and followed by a NUL byte
    size_t size;
};

// Returns false when out of memory.
bool memory_stream_open(struct memory_stream *stream);
// Returns false if not everything could be stored. Accepts {0}.
bool memory_stream_close(struct memory_stream *stream);
// Closes it and frees the text. Accepts {0}.
void memory_stream_finish(struct memory_stream *stream);

#endif
