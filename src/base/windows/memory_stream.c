#include "base/memory_stream.h"

#include "base/file_system.h"
#include <stdlib.h>

// Windows has no streams into memory: the stream is a temporary file, which is read when it is
// closed.
bool memory_stream_open(struct memory_stream *stream)
{
    *stream = (struct memory_stream){.file = file_stream_temporary()};
    return stream->file != NULL;
}

static bool read_back(struct memory_stream *stream)
{
    uint64_t size;
    if (fflush(stream->file) != 0 || ferror(stream->file) || !file_stream_size(stream->file, &size))
        return false;
    stream->text = malloc((size_t)size + 1);
    if (!stream->text)
        return false;
    stream->size = fread(stream->text, 1, (size_t)size, stream->file);
    stream->text[stream->size] = '\0';
    return stream->size == size;
}

bool memory_stream_close(struct memory_stream *stream)
{
    const bool ok = stream->file && read_back(stream);
    if (stream->file)
        fclose(stream->file);
    stream->file = NULL;
    return ok;
}

void memory_stream_finish(struct memory_stream *stream)
{
    if (stream->file)
        fclose(stream->file);
    free(stream->text);
    *stream = (struct memory_stream){0};
}
