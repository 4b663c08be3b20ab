#include "base/memory_stream.h"

#include <stdlib.h>

bool memory_stream_open(struct memory_stream *stream)
{
    *stream = (struct memory_stream){0};
    stream->file = open_memstream(&stream->text, &stream->size);
    return stream->file != NULL;
}

bool memory_stream_close(struct memory_stream *stream)
{
    bool ok = stream->file && fclose(stream->file) == 0;
    stream->file = NULL;
    return ok;
}

void memory_stream_finish(struct memory_stream *stream)
{
    memory_stream_close(stream);
    free(stream->text);
    *stream = (struct memory_stream){0};
}
