// Functions for OpenEXRCore that reading, writing and verifying share.
#ifndef LAMPYRIS_IMAGE_IMAGE_EXR_H
#define LAMPYRIS_IMAGE_IMAGE_EXR_H

#include "image/image_internal.h"
#include <openexr.h>

// The user data of a context. When reading fails, only the library's first message is kept, because
// later ones are consequences of it.
struct exr_stream {
    const uint8_t *data; // input when reading
    size_t size;
    struct byte_buffer *out; // output when writing
    bool out_of_memory;
    char message[256];
};

// Returns callbacks that keep the library from printing and from opening files.
exr_context_initializer_t exr_stream_initializer(struct exr_stream *stream);

// Fills in *err from a failed call and its message; returns false. Lack of memory is ERR_SYSTEM,
// all else `code`.
bool exr_fail(const struct exr_stream *stream, exr_result_t result, enum err_code code,
              struct err *err);

// Decodes a chunk to its decompressed bytes, decoder->unpacked_buffer. The library's own unpacking
// is not used, because with three channels, version 3.1.5 writes through the null pointer that
// should make it skip a channel. *is_ready says whether an earlier call has initialised the
// decoder.
exr_result_t exr_decode_bytes(exr_const_context_t context, const exr_chunk_info_t *chunk,
                              exr_decode_pipeline_t *decoder, bool *is_ready);

#endif
