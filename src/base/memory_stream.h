// A stream that writes to memory, for use with fprintf() and similar functions.
#ifndef LAMPYRIS_BASE_MEMORY_STREAM_H
#define LAMPYRIS_BASE_MEMORY_STREAM_H

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

// The struct must not be moved while the stream is open.
struct memory_stream {
    FILE *file; // NULL while the stream is closed
    char *text; // set when the stream is closed; NUL-terminated
    size_t size;
};

// Opens the stream. Returns false when out of memory.
bool memory_stream_open(struct memory_stream *stream);
// Closes the stream, and sets `text` and `size`. Returns false if not everything could be stored.
// Accepts {0}.
bool memory_stream_close(struct memory_stream *stream);
// Closes the stream and frees the text. Accepts {0}.
void memory_stream_finish(struct memory_stream *stream);

#endif
