// Loads the bytes of a glTF document's buffers.
#include "scene/gltf/gltf_buffer.h"

#include "base/ascii.h"
#include <string.h>

// --- GLB -----------------------------------------------------------------------------------------

// The binary container (glTF 2.0, section 4.4): a header of magic, version and total length, then
// chunks of length, type and content, all little-endian and aligned to 4 bytes.
enum {
    GLB_HEADER_BYTES = 12,
    GLB_CHUNK_HEADER_BYTES = 8,
    GLB_ALIGNMENT = 4,
};
#define GLB_TYPE_JSON 0x4e4f534au
#define GLB_TYPE_BINARY 0x004e4942u

static uint32_t load_u32(const uint8_t *at)
{
    return (uint32_t)at[0] | (uint32_t)at[1] << 8 | (uint32_t)at[2] << 16 | (uint32_t)at[3] << 24;
}

bool glb_is_container(const struct file_bytes *bytes)
{
    return bytes->size >= 4 && memcmp(bytes->data, "glTF", 4) == 0;
}

static bool glb_check_header(const struct file_bytes *bytes, struct err *err)
{
    if (bytes->size < GLB_HEADER_BYTES)
        return err_set(err, ERR_INPUT, "GLB: ends within its header, after %zu bytes", bytes->size);
    uint32_t version = load_u32(bytes->data + 4), length = load_u32(bytes->data + 8);
    if (version != 2)
        return err_set(err, ERR_INPUT, "GLB: version %u; expected 2", version);
    if (length != bytes->size)
        return err_set(err, ERR_INPUT, "GLB: the header states %u bytes, but the file has %zu",
                       length, bytes->size);
    return true;
}

struct glb_chunk {
    uint32_t type;
    struct file_bytes content;
};

// Reads the chunk at *at and advances *at to its end.
static bool glb_next_chunk(const struct file_bytes *bytes, size_t *at, struct glb_chunk *out,
                           struct err *err)
{
    size_t remaining = bytes->size - *at;
    if (remaining < GLB_CHUNK_HEADER_BYTES)
        return err_set(err, ERR_INPUT, "GLB: %zu bytes remain at byte %zu, too few for a chunk",
                       remaining, *at);
    uint32_t length = load_u32(bytes->data + *at);
    remaining -= GLB_CHUNK_HEADER_BYTES;
    if (length % GLB_ALIGNMENT != 0)
        return err_set(err, ERR_INPUT,
                       "GLB: the chunk at byte %zu has %u bytes; expected a multiple of 4", *at,
                       length);
    if (length > remaining)
        return err_set(err, ERR_INPUT, "GLB: the chunk at byte %zu has %u bytes, but %zu remain",
                       *at, length, remaining);
    out->type = load_u32(bytes->data + *at + 4);
    out->content = (struct file_bytes){bytes->data + *at + GLB_CHUNK_HEADER_BYTES, length};
    *at += GLB_CHUNK_HEADER_BYTES + (size_t)length;
    return true;
}

bool glb_open(const struct file_bytes *bytes, struct glb_chunks *out, struct err *err)
{
    *out = (struct glb_chunks){0};
    if (!glb_check_header(bytes, err))
        return false;
    struct glb_chunk chunk;
    size_t at = GLB_HEADER_BYTES;
    if (!glb_next_chunk(bytes, &at, &chunk, err))
        return false;
    if (chunk.type != GLB_TYPE_JSON)
        return err_set(err, ERR_INPUT, "GLB: the first chunk is of type 0x%08x; expected JSON",
                       chunk.type);
    out->json = chunk.content;
    for (int number = 2; at < bytes->size; number++) {
        if (!glb_next_chunk(bytes, &at, &chunk, err))
            return false;
        if (chunk.type == GLB_TYPE_JSON || (chunk.type == GLB_TYPE_BINARY && number > 2))
            return err_set(err, ERR_INPUT, "GLB: chunk %d is of type %s; only the %s chunk may be",
                           number, chunk.type == GLB_TYPE_JSON ? "JSON" : "BIN",
                           chunk.type == GLB_TYPE_JSON ? "first" : "second");
        if (chunk.type == GLB_TYPE_BINARY)
            out->binary = chunk.content;
    }
    return true;
}

// --- URIs ----------------------------------------------------------------------------------------

// Returns the value of a base64 digit, or -1.
static int base64_digit(char c)
{
    return c >= 'A' && c <= 'Z'   ? c - 'A'
           : c >= 'a' && c <= 'z' ? c - 'a' + 26
           : c >= '0' && c <= '9' ? c - '0' + 52
           : c == '+'             ? 62
           : c == '/'             ? 63
                                  : -1;
}

// Decodes base64 (RFC 4648, section 4). `out` must have room for length / 4 * 3 bytes. Returns
// false if padding is missing, a character is invalid, or an unused bit is set.
static bool base64_decode(const char *text, size_t length, uint8_t *out, size_t *size)
{
    if (length % 4 != 0)
        return false;
    size_t padding = length > 0 && text[length - 1] == '=' ? 1 : 0;
    padding += padding && text[length - 2] == '=' ? 1 : 0;
    uint8_t *to = out;
    for (size_t i = 0; i < length; i += 4) {
        size_t digits = i + 4 == length ? 4 - padding : 4;
        uint32_t group = 0;
        for (size_t j = 0; j < 4; j++) {
            int digit = j < digits ? base64_digit(text[i + j]) : 0;
            if (digit < 0)
                return false;
            group = group << 6 | (uint32_t)digit;
        }
        uint32_t unused_bits = digits == 4 ? 0 : digits == 3 ? 0xff : 0xffff;
        if (group & unused_bits)
            return false;
        for (size_t j = 0; j + 1 < digits; j++)
            *to++ = (uint8_t)(group >> (16 - 8 * j));
    }
    *size = (size_t)(to - out);
    return true;
}

// Decodes data:MEDIA-TYPE;base64,TEXT (RFC 2397), the only form of data URI that glTF files use.
static bool decode_data_uri(const struct json_node *uri, const char *text, struct arena *arena,
                            struct file_bytes *out, struct err *err)
{
    const char *comma = strchr(text, ',');
    static const char marker[] = ";base64";
    const size_t marker_length = sizeof marker - 1;
    if (!comma || (size_t)(comma - text) < marker_length ||
        !ascii_begins(comma - marker_length, marker))
        return node_fail(uri, err, "the data URI lacks \";base64,\"");
    const char *encoded = comma + 1;
    size_t length = strlen(encoded);
    uint8_t *data = arena_alloc(arena, length / 4, 3);
    if (!data) {
        err_memory(err, "a data URI", length / 4 * 3);
        return node_prepend(uri, err);
    }
    *out = (struct file_bytes){.data = data};
    if (!base64_decode(encoded, length, data, &out->size))
        return node_fail(uri, err, "the data URI is not valid base64");
    return true;
}

static bool is_data_uri(const char *uri)
{
    return ascii_begins(uri, "data:");
}

static bool read_external(const struct gltf_document *document, const struct json_node *node,
                          const char *uri, struct arena *arena, struct file_bytes *out,
                          const char **path, struct err *err)
{
    const struct file_reference reference = {
        .folder = path_folder(arena, document->source->path),
        .percent_decode = true,
        .allow_outside = document->source->allow_outside_paths,
    };
    if (!reference.folder) {
        err_memory(err, "a path", strlen(document->source->path) + 1);
        return node_prepend(node, err);
    }
    *path = file_resolve(arena, &reference, uri, err);
    return (*path && file_read(arena, *path, 0, out, err)) || node_prepend(node, err);
}

bool gltf_uri_load(const struct gltf_document *document, const struct json_node *uri,
                   struct arena *arena, struct file_bytes *out, const char **path, struct err *err)
{
    const char *text = json_string_value(uri->value);
    *path = NULL;
    if (!text)
        return node_unexpected(uri, "a string", err);
    if (is_data_uri(text))
        return decode_data_uri(uri, text, arena, out, err);
    return read_external(document, uri, text, arena, out, path, err);
}

// --- buffers -------------------------------------------------------------------------------------

// Finds the bytes of one buffer. *out stays without data if the file names none.
static bool find_bytes(struct gltf_document *document, const struct json_node *node,
                       const struct file_bytes *binary, struct file_bytes *out, bool *is_external,
                       struct err *err)
{
    const struct json_node uri = node_member(node, "uri");
    const char *path = NULL;
    if (!uri.value) {
        // The first buffer of a GLB file is its binary chunk.
        *out = node->index == 0 ? *binary : (struct file_bytes){0};
        return true;
    }
    if (!gltf_uri_load(document, &uri, &document->arena, out, &path, err))
        return false;
    *is_external = path != NULL;
    return true;
}

static bool load_buffer(struct gltf_document *document, uint32_t index,
                        const struct file_bytes *binary, struct err *err)
{
    struct gltf_buffer *buffer = &document->buffers[index];
    const struct json_node node = gltf_item(document, GLTF_BUFFERS, index);
    struct file_bytes bytes = {0};
    struct json_node extensions, meshopt;
    bool is_fallback = false; // the buffer is only for readers without EXT_meshopt_compression
    if (!gltf_require(&node, "byteLength", err) ||
        !node_read_integer(&node, "byteLength", 1, INT64_MAX, &buffer->size, err) ||
        !gltf_read_extension(&node, "EXT_meshopt_compression", &extensions, &meshopt, err) ||
        !node_read_boolean(&meshopt, "fallback", &is_fallback, err))
        return false;
    if (is_fallback)
        return true;
    if (!find_bytes(document, &node, binary, &bytes, &buffer->is_external, err))
        return false;
    // There may be more bytes than byteLength, because the chunk of a GLB file is padded.
    if (bytes.data && bytes.size < buffer->size)
        return node_fail(&node, err, "\"byteLength\" is %llu, but there are %zu bytes",
                         (unsigned long long)buffer->size, bytes.size);
    buffer->data = bytes.data;
    return true;
}

bool gltf_buffers_load(struct gltf_document *document, const struct file_bytes *binary,
                       struct err *err)
{
    uint32_t count = document->counts[GLTF_BUFFERS];
    document->buffers = ARENA_NEW(&document->arena, struct gltf_buffer, count);
    if (!document->buffers)
        return gltf_no_memory(document, "buffers", count * sizeof *document->buffers, err);
    for (uint32_t i = 0; i < count; i++)
        if (!load_buffer(document, i, binary, err))
            return false;
    return true;
}
