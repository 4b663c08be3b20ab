// EXT_meshopt_compression: buffer views with compressed vertices or indices. All are decoded when
// the document is opened; accessors then check the decoded bytes like any others.
#include "scene/gltf/gltf_buffer.h"

#include <meshoptimizer.h>

enum mode { ATTRIBUTES, TRIANGLES, INDICES };
enum filter { NONE, OCTAHEDRAL, QUATERNION, EXPONENTIAL };

#define MAX_STRIDE 256 // maximum stride in mode ATTRIBUTES

struct compressed {
    struct json_node node; // JSON object of the extension
    const uint8_t *data;
    size_t size;
    uint64_t count, stride;
    enum mode mode;
    enum filter filter;
};

// --- reading -------------------------------------------------------------------------------------

static bool read_bytes(const struct gltf_document *document, struct compressed *out,
                       struct err *err)
{
    const struct json_node *node = &out->node;
    uint64_t offset = 0, length = 0, end;
    uint32_t index = 0;
    if (!gltf_require(node, "buffer", err) || !gltf_require(node, "byteLength", err) ||
        !gltf_read_index(node, "buffer", document->counts[GLTF_BUFFERS], &index, err) ||
        !node_read_integer(node, "byteOffset", 0, INT64_MAX, &offset, err) ||
        !node_read_integer(node, "byteLength", 1, INT64_MAX, &length, err))
        return false;
    const struct gltf_buffer *buffer = &document->buffers[index];
    if (!buffer->data)
        return node_fail(node, err, "buffers[%u] has no \"uri\" and no binary chunk", index);
    if (__builtin_add_overflow(offset, length, &end) || end > buffer->size)
        return node_fail(node, err,
                         "byteOffset %llu + byteLength %llu is beyond buffers[%u] of %llu bytes",
                         (unsigned long long)offset, (unsigned long long)length, index,
                         (unsigned long long)buffer->size);
    out->data = buffer->data + (size_t)offset;
    out->size = (size_t)length;
    return true;
}

static bool read_layout(struct compressed *out, struct err *err)
{
    static const char *const modes[] = {"ATTRIBUTES", "TRIANGLES", "INDICES", NULL};
    static const char *const filters[] = {"NONE", "OCTAHEDRAL", "QUATERNION", "EXPONENTIAL", NULL};
    const struct json_node *node = &out->node;
    uint32_t mode = 0, filter = NONE;
    if (!gltf_require(node, "mode", err) || !gltf_require(node, "count", err) ||
        !gltf_require(node, "byteStride", err) ||
        !node_read_choice(node, "mode", modes, &mode, err) ||
        !node_read_choice(node, "filter", filters, &filter, err) ||
        !node_read_integer(node, "count", 1, GLTF_MAX_COUNT, &out->count, err) ||
        !node_read_integer(node, "byteStride", 1, MAX_STRIDE, &out->stride, err))
        return false;
    out->mode = (enum mode)mode;
    out->filter = (enum filter)filter;
    return true;
}

// Checks the rules of the extension on which the decoder relies.
static bool check_layout(const struct compressed *in, struct err *err)
{
    unsigned long long stride = in->stride, count = in->count;
    if (in->mode == ATTRIBUTES ? stride % 4 != 0 : stride != 2 && stride != 4)
        return node_fail(&in->node, err, "a byteStride of %llu; expected %s", stride,
                         in->mode == ATTRIBUTES ? "a multiple of 4" : "2 or 4");
    if (in->mode == TRIANGLES && count % 3 != 0)
        return node_fail(&in->node, err, "%llu indices of triangles; expected a multiple of 3",
                         count);
    if (in->mode != ATTRIBUTES && in->filter != NONE)
        return node_fail(&in->node, err, "a filter is given for indices; expected \"NONE\"");
    if (in->filter == OCTAHEDRAL && stride != 4 && stride != 8)
        return node_fail(&in->node, err, "OCTAHEDRAL with a byteStride of %llu; expected 4 or 8",
                         stride);
    if (in->filter == QUATERNION && stride != 8)
        return node_fail(&in->node, err, "QUATERNION with a byteStride of %llu; expected 8",
                         stride);
    return true;
}

// Checks that the buffer view that contains the extension has the size of the decoded data.
static bool check_view(const struct json_node *view, const struct compressed *in, struct err *err)
{
    uint64_t length = 0, stride = in->stride, size = in->count * in->stride;
    if (!gltf_require(view, "byteLength", err) ||
        !node_read_integer(view, "byteLength", 1, INT64_MAX, &length, err) ||
        !node_read_integer(view, "byteStride", 1, INT64_MAX, &stride, err))
        return false;
    if (length != size)
        return node_fail(view, err,
                         "byteLength is %llu; expected the size of %llu elements of %llu bytes",
                         (unsigned long long)length, (unsigned long long)in->count,
                         (unsigned long long)in->stride);
    if (stride != in->stride)
        return node_fail(view, err, "byteStride is %llu; expected %llu, that of the extension",
                         (unsigned long long)stride, (unsigned long long)in->stride);
    return true;
}

// --- decoding ------------------------------------------------------------------------------------

static bool decode(const struct compressed *in, uint8_t *out)
{
    size_t count = (size_t)in->count, stride = (size_t)in->stride;
    switch (in->mode) {
    case ATTRIBUTES:
        return meshopt_decodeVertexBuffer(out, count, stride, in->data, in->size) == 0;
    case TRIANGLES:
        return meshopt_decodeIndexBuffer(out, count, stride, in->data, in->size) == 0;
    case INDICES:
        break;
    }
    return meshopt_decodeIndexSequence(out, count, stride, in->data, in->size) == 0;
}

static void apply_filter(const struct compressed *in, uint8_t *data)
{
    size_t count = (size_t)in->count, stride = (size_t)in->stride;
    switch (in->filter) {
    case NONE:
        return;
    case OCTAHEDRAL:
        meshopt_decodeFilterOct(data, count, stride);
        return;
    case QUATERNION:
        meshopt_decodeFilterQuat(data, count, stride);
        return;
    case EXPONENTIAL:
        meshopt_decodeFilterExp(data, count, stride);
        return;
    }
}

static bool decode_view(struct gltf_document *document, uint32_t index, struct err *err)
{
    const struct json_node view = gltf_item(document, GLTF_BUFFER_VIEWS, index);
    struct json_node extensions;
    struct compressed in = {0};
    if (!gltf_read_extension(&view, "EXT_meshopt_compression", &extensions, &in.node, err))
        return false;
    if (!in.node.value)
        return true;
    if (!read_bytes(document, &in, err) || !read_layout(&in, err) || !check_layout(&in, err) ||
        !check_view(&view, &in, err))
        return false;
    uint8_t *data = arena_alloc(&document->arena, (size_t)in.count, (size_t)in.stride);
    if (!data)
        return gltf_no_memory(document, "decompressed views", in.count * in.stride, err);
    if (!decode(&in, data))
        return node_fail(&in.node, err, "the %zu bytes are not a valid stream of %llu elements",
                         in.size, (unsigned long long)in.count);
    apply_filter(&in, data);
    document->decoded_views[index] = data;
    return true;
}

bool gltf_meshopt_decode(struct gltf_document *document, struct err *err)
{
    uint32_t count = document->counts[GLTF_BUFFER_VIEWS];
    document->decoded_views = ARENA_NEW(&document->arena, const uint8_t *, count);
    if (!document->decoded_views)
        return gltf_no_memory(document, "buffer views", count * sizeof(uint8_t *), err);
    for (uint32_t i = 0; i < count; i++)
        if (!decode_view(document, i, err))
            return false;
    return true;
}
