#include "image/image_exr.h"

#include "base/memory.h"
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void keep_message(exr_const_context_t context, exr_result_t code, const char *message)
{
    (void)code; // returned as the result of the call, too
    void *user_data = NULL;
    exr_get_user_data(context, &user_data);
    struct exr_stream *stream = user_data;
    if (stream && !stream->message[0])
        snprintf(stream->message, sizeof stream->message, "%s", message);
}

// Drops the library's message. A context for writing is locked while it reports an error
// (OpenEXRCore 3.1.5), so getting its user data would deadlock.
static void drop_message(exr_const_context_t context, exr_result_t code, const char *message)
{
    (void)context, (void)code, (void)message;
}

static int64_t read_bytes(exr_const_context_t context, void *user_data, void *buffer, uint64_t size,
                          uint64_t offset, exr_stream_error_func_ptr_t report)
{
    const struct exr_stream *stream = user_data;
    (void)context;
    (void)report; // the library itself reports short reads
    uint64_t left = offset < stream->size ? stream->size - offset : 0;
    uint64_t count = size < left ? size : left;
    if (count > 0)
        memcpy(buffer, stream->data + offset, (size_t)count);
    return (int64_t)count;
}

static int64_t query_size(exr_const_context_t context, void *user_data)
{
    const struct exr_stream *stream = user_data;
    (void)context;
    return (int64_t)stream->size;
}

static int64_t write_bytes(exr_const_context_t context, void *user_data, const void *buffer,
                           uint64_t size, uint64_t offset, exr_stream_error_func_ptr_t report)
{
    struct exr_stream *stream = user_data;
    (void)context;
    (void)report;
    if (!byte_buffer_write(stream->out, (size_t)offset, buffer, (size_t)size)) {
        stream->out_of_memory = true;
        return -1;
    }
    return (int64_t)size;
}

// Allocates zeroed memory, because for damaged blocks some decompressors fill only a part and
// report success, and the rest must be black, not arbitrary memory.
static void *allocate_zeroed(size_t size)
{
    return memory_alloc(size);
}

exr_context_initializer_t exr_stream_initializer(struct exr_stream *stream)
{
    exr_context_initializer_t initializer = EXR_DEFAULT_CONTEXT_INITIALIZER;
    errno = 0; // exr_fail() reads it
    initializer.error_handler_fn = stream->out ? drop_message : keep_message;
    initializer.alloc_fn = allocate_zeroed;
    initializer.free_fn = memory_free;
    initializer.user_data = stream;
    initializer.read_fn = read_bytes;
    initializer.size_fn = query_size;
    initializer.write_fn = write_bytes;
    // A file with missing chunks is an error, not an image with holes.
    initializer.flags = EXR_CONTEXT_FLAG_DISABLE_CHUNK_RECONSTRUCTION;
    return initializer;
}

bool exr_fail(const struct exr_stream *stream, exr_result_t result, enum err_code code,
              struct err *err)
{
    // Some decompressors report lack of memory for damaged data as well. A failed malloc() also
    // sets errno.
    bool exhausted = result == EXR_ERR_OUT_OF_MEMORY && errno == ENOMEM;
    if (stream->out_of_memory || exhausted)
        return err_memory(err, "the EXR library", 0);
    return err_set(err, code, "EXR: %s",
                   stream->message[0] ? stream->message : exr_get_default_error_message(result));
}

exr_result_t exr_decode_bytes(exr_const_context_t context, const exr_chunk_info_t *chunk,
                              exr_decode_pipeline_t *decoder, bool *is_ready)
{
    bool is_first = !*is_ready;
    exr_result_t result = is_first ? exr_decoding_initialize(context, 0, chunk, decoder)
                                   : exr_decoding_update(context, 0, chunk, decoder);
    *is_ready |= result == EXR_ERR_SUCCESS;
    if (is_first && result == EXR_ERR_SUCCESS) {
        result = exr_decoding_choose_default_routines(context, 0, decoder);
        decoder->unpack_and_convert_fn = NULL; // leaves the decompressed bytes unconverted
    }
    return result == EXR_ERR_SUCCESS ? exr_decoding_run(context, 0, decoder) : result;
}
