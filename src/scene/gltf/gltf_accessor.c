// Reads accessors (glTF 2.0, section 3.6.2).
#include "scene/gltf/gltf_accessor.h"

#include <math.h>
#include <string.h>

static const struct {
    const char *name;
    uint32_t size;
} components[] = {
    [COMPONENT_I8] = {"BYTE", 1},          [COMPONENT_U8] = {"UNSIGNED_BYTE", 1},
    [COMPONENT_I16] = {"SHORT", 2},        [COMPONENT_U16] = {"UNSIGNED_SHORT", 2},
    [COMPONENT_U32] = {"UNSIGNED_INT", 4}, [COMPONENT_F32] = {"FLOAT", 4},
};
enum { COMPONENT_TYPE_COUNT = sizeof components / sizeof components[0] };

static const char *const type_names[] = {
    [1] = "SCALAR", [2] = "VEC2", [3] = "VEC3", [4] = "VEC4", [ACCESSOR_MAT4] = "MAT4"};

#define INDEX_TYPES                                                                                \
    (COMPONENT_BIT(COMPONENT_U8) | COMPONENT_BIT(COMPONENT_U16) | COMPONENT_BIT(COMPONENT_U32))

// --- the window ----------------------------------------------------------------------------------

// A range of elements of a buffer view, claimed by an accessor or its sparse part.
struct claim {
    const struct json_node *holder; // the JSON object with "bufferView" and "byteOffset"
    uint32_t count, size, component_size;
    bool is_vertex_attribute;
};

struct buffer_view {
    struct json_node node;
    uint64_t offset, length, stride; // stride 0: the file gives none
    const uint8_t *data;
};

static bool read_buffer_view(const struct gltf_document *document, uint32_t index,
                             struct buffer_view *out, struct err *err)
{
    *out = (struct buffer_view){.node = gltf_item(document, GLTF_BUFFER_VIEWS, index)};
    const struct json_node *node = &out->node;
    uint32_t buffer = 0;
    if (!gltf_require(node, "buffer", err) || !gltf_require(node, "byteLength", err) ||
        !gltf_read_index(node, "buffer", document->counts[GLTF_BUFFERS], &buffer, err) ||
        !node_read_integer(node, "byteOffset", 0, INT64_MAX, &out->offset, err) ||
        !node_read_integer(node, "byteLength", 1, INT64_MAX, &out->length, err) ||
        !node_read_integer(node, "byteStride", 4, 252, &out->stride, err))
        return false;
    const struct gltf_buffer *its = &document->buffers[buffer];
    const uint8_t *decoded = document->decoded_views[index];
    if (!its->data && !decoded)
        return node_fail(node, err, "buffers[%u] has no \"uri\" and no binary chunk", buffer);
    uint64_t end;
    if (__builtin_add_overflow(out->offset, out->length, &end) || end > its->size)
        return node_fail(node, err,
                         "byteOffset %llu + byteLength %llu is beyond buffers[%u] of %llu bytes",
                         (unsigned long long)out->offset, (unsigned long long)out->length, buffer,
                         (unsigned long long)its->size);
    if (out->stride % 4 != 0)
        return node_fail(node, err, "byteStride %llu is not a multiple of 4",
                         (unsigned long long)out->stride);
    out->data = decoded ? decoded : its->data + (size_t)out->offset;
    if (decoded)
        out->offset = 0;
    return true;
}

bool gltf_view_bytes(const struct gltf_document *document, uint32_t index, struct file_bytes *out,
                     struct err *err)
{
    struct buffer_view view;
    if (!read_buffer_view(document, index, &view, err))
        return false;
    *out = (struct file_bytes){view.data, (size_t)view.length};
    return true;
}

// Chooses the distance between elements: the view's stride, or the size of an element if the view
// has no stride.
static bool choose_stride(const struct buffer_view *view, const struct claim *claim,
                          uint64_t *stride, struct err *err)
{
    *stride = view->stride ? view->stride : claim->size;
    if (*stride < claim->size)
        return node_fail(claim->holder, err, "elements of %u bytes overlap at a byteStride of %llu",
                         claim->size, (unsigned long long)*stride);
    // Only vertex attributes may have a stride. A stride that equals the element's size is
    // harmless.
    if (!claim->is_vertex_attribute && *stride != claim->size)
        return node_fail(claim->holder, err,
                         "a byteStride of %llu; expected elements of %u bytes without gaps",
                         (unsigned long long)*stride, claim->size);
    if (claim->is_vertex_attribute && *stride % 4 != 0)
        return node_fail(claim->holder, err,
                         "vertices are %llu bytes apart; expected a multiple of 4",
                         (unsigned long long)*stride);
    return true;
}

// Converts a claim to a pointer to its first byte, and a stride. Checks that every byte of the
// claim lies inside the buffer view, and the buffer view inside the buffer.
static bool open_window(const struct gltf_document *document, const struct claim *claim,
                        const uint8_t **data, size_t *stride_out, struct err *err)
{
    uint32_t index = 0;
    uint64_t offset = 0, stride, span, end;
    struct buffer_view view;
    if (!gltf_read_index(claim->holder, "bufferView", document->counts[GLTF_BUFFER_VIEWS], &index,
                         err) ||
        !node_read_integer(claim->holder, "byteOffset", 0, INT64_MAX, &offset, err) ||
        !read_buffer_view(document, index, &view, err) ||
        !choose_stride(&view, claim, &stride, err))
        return false;
    if (__builtin_mul_overflow(stride, (uint64_t)claim->count - 1, &span) ||
        __builtin_add_overflow(span, claim->size, &span) ||
        __builtin_add_overflow(offset, span, &end) || end > view.length)
        return node_fail(claim->holder, err,
                         "%u elements of %u bytes from byteOffset %llu on do not fit into "
                         "bufferViews[%u] of %llu bytes",
                         claim->count, claim->size, (unsigned long long)offset, index,
                         (unsigned long long)view.length);
    uint64_t start = view.offset + offset; // below the buffer's size, so there is no overflow
    uint32_t alignment = claim->is_vertex_attribute ? 4 : claim->component_size;
    if (offset % alignment != 0 || start % claim->component_size != 0)
        return node_fail(claim->holder, err,
                         "begins at byte %llu of bufferViews[%u], byte %llu of the buffer; "
                         "expected multiples of %u and %u",
                         (unsigned long long)offset, index, (unsigned long long)start, alignment,
                         claim->component_size);
    *data = view.data + (size_t)offset;
    *stride_out = (size_t)stride;
    return true;
}

// --- type ----------------------------------------------------------------------------------------

static bool read_component_type(const struct json_node *object, uint32_t allowed, const char *use,
                                enum component_type *out, struct err *err)
{
    const struct json_node node = node_member(object, "componentType");
    uint64_t code = 0;
    if (!gltf_require(object, "componentType", err) ||
        !node_read_integer(object, "componentType", 0, INT64_MAX, &code, err))
        return false;
    uint64_t type = code - COMPONENT_CODE_BASE; // a code that is too small wraps to a large number
    if (type >= COMPONENT_TYPE_COUNT || !components[type].name)
        return node_fail(&node, err,
                         "%llu is not a component type; expected 5120 to 5123, 5125 or 5126",
                         (unsigned long long)code);
    if (!(allowed & COMPONENT_BIT(type)))
        return node_fail(&node, err, "%llu (%s) is not allowed for %s", (unsigned long long)code,
                         components[type].name, use);
    *out = (enum component_type)type;
    return true;
}

static bool read_type_name(const struct json_node *node, const struct accessor_rule *rule,
                           uint32_t *components_out, struct err *err)
{
    const char *name = NULL;
    const struct json_node type = node_member(node, "type");
    if (!gltf_require(node, "type", err) || !node_read_string(node, "type", &name, err))
        return false;
    *components_out = rule->components;
    if (rule->fewer_components > 0 && strcmp(name, type_names[rule->fewer_components]) == 0)
        *components_out = rule->fewer_components;
    else if (strcmp(name, type_names[rule->components]) != 0)
        return node_fail(&type, err, "%s; expected \"%s\" for %s", node_describe(type.value).text,
                         type_names[rule->components], rule->use);
    return true;
}

static bool read_type(const struct gltf_document *document, const struct accessor_rule *rule,
                      struct accessor_view *out, struct err *err)
{
    const struct json_node *node = &out->node;
    if (!read_type_name(node, rule, &out->components, err) ||
        !node_read_boolean(node, "normalized", &out->is_normalized, err))
        return false;
    uint32_t always = out->is_normalized ? rule->normalized_types : rule->types;
    uint32_t quantized = out->is_normalized ? rule->quantized_normalized : rule->quantized_types;
    if (!read_component_type(node, always | quantized, rule->use, &out->type, err))
        return false;
    if (!(always & COMPONENT_BIT(out->type)) && !document->is_quantized)
        return node_fail(node, err,
                         "%s for %s needs KHR_mesh_quantization, which the file does not declare",
                         components[out->type].name, rule->use);
    return true;
}

// --- sparse --------------------------------------------------------------------------------------

static uint32_t load_unsigned(const uint8_t *at, enum component_type type)
{
    switch (type) {
    case COMPONENT_U8:
        return at[0];
    case COMPONENT_U16:
        return (uint32_t)at[0] | (uint32_t)at[1] << 8;
    default:
        return (uint32_t)at[0] | (uint32_t)at[1] << 8 | (uint32_t)at[2] << 16 |
               (uint32_t)at[3] << 24;
    }
}

static uint32_t sparse_index(const struct accessor_view *view, uint32_t i)
{
    size_t size = components[view->sparse_index_type].size;
    return load_unsigned(view->sparse_indices + i * size, view->sparse_index_type);
}

static bool check_sparse_indices(const struct accessor_view *view, const struct json_node *node,
                                 struct err *err)
{
    uint32_t least = 0;
    for (uint32_t i = 0; i < view->sparse_count; i++) {
        uint32_t index = sparse_index(view, i);
        if (index < least || index >= view->count)
            return node_fail(node, err,
                             "element %u is %u; expected strictly increasing indices below the "
                             "accessor's count, %u",
                             i, index, view->count);
        least = index + 1; // no overflow: count is at most GLTF_MAX_COUNT
    }
    return true;
}

static bool open_sparse(const struct gltf_document *document, const struct json_node *sparse,
                        struct accessor_view *out, struct err *err)
{
    uint64_t count = 0;
    struct json_node indices, values;
    if (!gltf_require(sparse, "count", err) || !gltf_require(sparse, "indices", err) ||
        !gltf_require(sparse, "values", err) ||
        !node_read_integer(sparse, "count", 1, out->count, &count, err) ||
        !gltf_read_object(sparse, "indices", &indices, err) ||
        !gltf_read_object(sparse, "values", &values, err) ||
        !gltf_require(&indices, "bufferView", err) || !gltf_require(&values, "bufferView", err) ||
        !read_component_type(&indices, INDEX_TYPES, "sparse indices", &out->sparse_index_type, err))
        return false;
    out->sparse_count = (uint32_t)count;
    uint32_t index_size = components[out->sparse_index_type].size;
    uint32_t component_size = components[out->type].size;
    struct claim index_claim = {&indices, out->sparse_count, index_size, index_size, false};
    struct claim value_claim = {&values, out->sparse_count, component_size * out->components,
                                component_size, false};
    size_t stride;
    return open_window(document, &index_claim, &out->sparse_indices, &stride, err) &&
           open_window(document, &value_claim, &out->sparse_values, &stride, err) &&
           check_sparse_indices(out, &indices, err);
}

// --- the view ------------------------------------------------------------------------------------

static bool open_base(const struct gltf_document *document, uint32_t index,
                      const struct accessor_rule *rule, struct accessor_view *out, struct err *err)
{
    if (document->decoded_accessors[index]) {
        out->data = document->decoded_accessors[index];
        out->stride = components[out->type].size * out->components;
        return true;
    }
    if (!json_object_get(out->node.value, "bufferView")) {
        if (json_object_get(out->node.value, "byteOffset"))
            return node_fail(&out->node, err, "has \"byteOffset\" but no \"bufferView\"");
        if (out->count > ACCESSOR_MAX_UNBACKED_COUNT)
            return node_fail(&out->node, err,
                             "has %u elements without \"bufferView\"; expected at most %llu",
                             out->count, (unsigned long long)ACCESSOR_MAX_UNBACKED_COUNT);
        return true;
    }
    uint32_t component_size = components[out->type].size;
    struct claim claim = {
        .holder = &out->node,
        .count = out->count,
        .size = component_size * out->components,
        .component_size = component_size,
        .is_vertex_attribute = rule->is_vertex_attribute,
    };
    return open_window(document, &claim, &out->data, &out->stride, err);
}

static bool read_count(const struct json_node *node, uint32_t *out, struct err *err)
{
    uint64_t count = 0;
    if (!gltf_require(node, "count", err) ||
        !node_read_integer(node, "count", 1, GLTF_MAX_COUNT, &count, err))
        return false;
    *out = (uint32_t)count;
    return true;
}

bool accessor_layout(const struct gltf_document *document, uint32_t index,
                     struct accessor_layout *out, struct err *err)
{
    static const char *const names[] = {"SCALAR", "VEC2", "VEC3", "VEC4", NULL};
    uint32_t type = 0;
    *out = (struct accessor_layout){.node = gltf_item(document, GLTF_ACCESSORS, index)};
    if (!read_count(&out->node, &out->count, err) || !gltf_require(&out->node, "type", err) ||
        !node_read_choice(&out->node, "type", names, &type, err) ||
        !read_component_type(&out->node, UINT32_MAX, "a compressed mesh", &out->type, err))
        return false;
    out->components = type + 1;
    out->component_size = components[out->type].size;
    return true;
}

bool accessor_view(const struct gltf_document *document, uint32_t index,
                   const struct accessor_rule *rule, struct accessor_view *out, struct err *err)
{
    *out = (struct accessor_view){
        .node = gltf_item(document, GLTF_ACCESSORS, index),
    };
    struct json_node sparse;
    return read_count(&out->node, &out->count, err) && read_type(document, rule, out, err) &&
           open_base(document, index, rule, out, err) &&
           gltf_read_object(&out->node, "sparse", &sparse, err) &&
           (!sparse.value || open_sparse(document, &sparse, out, err));
}

// --- reading -------------------------------------------------------------------------------------

// Converts a signed integer; section 3.6.2.2 defines the conversions of normalized integers.
static float signed_to_float(int32_t value, int32_t max, bool is_normalized)
{
    return is_normalized ? fmaxf((float)value / (float)max, -1.0f) : (float)value;
}

static float load_float(const uint8_t *at, enum component_type type, bool is_normalized)
{
    uint32_t bits;
    float value;
    switch (type) {
    case COMPONENT_I8:
        return signed_to_float((int8_t)at[0], INT8_MAX, is_normalized);
    case COMPONENT_I16:
        return signed_to_float((int16_t)load_unsigned(at, COMPONENT_U16), INT16_MAX, is_normalized);
    case COMPONENT_U8:
        return (float)at[0] / (is_normalized ? (float)UINT8_MAX : 1.0f);
    case COMPONENT_U16:
        return (float)load_unsigned(at, type) / (is_normalized ? (float)UINT16_MAX : 1.0f);
    case COMPONENT_U32:
        return (float)load_unsigned(at, type);
    case COMPONENT_F32:
        break;
    }
    bits = load_unsigned(at, COMPONENT_U32);
    memcpy(&value, &bits, sizeof value);
    return value;
}

// Reads an element. If `replaced` is not NULL, numbers that are not finite become 0 and are counted
// there; if it is NULL, they are errors.
static bool read_element(const struct accessor_view *view, const uint8_t *at, uint32_t element,
                         float *out, uint32_t *replaced, struct err *err)
{
    size_t size = components[view->type].size;
    for (uint32_t i = 0; i < view->components; i++) {
        out[i] = load_float(at + i * size, view->type, view->is_normalized);
        if (isfinite(out[i]))
            continue;
        if (!replaced)
            return node_fail(&view->node, err,
                             "element %u, component %u is %g; expected a finite number", element, i,
                             (double)out[i]);
        out[i] = 0;
        ++*replaced;
    }
    return true;
}

static bool read_elements(const struct accessor_view *view, float *out, uint32_t *replaced,
                          struct err *err)
{
    size_t n = view->components;
    for (uint32_t i = 0; i < view->count; i++) {
        if (!view->data)
            memset(out + i * n, 0, n * sizeof *out);
        else if (!read_element(view, view->data + i * view->stride, i, out + i * n, replaced, err))
            return false;
    }
    size_t value_size = n * components[view->type].size;
    for (uint32_t i = 0; i < view->sparse_count; i++) {
        uint32_t element = sparse_index(view, i);
        if (!read_element(view, view->sparse_values + i * value_size, element, out + element * n,
                          replaced, err))
            return false;
    }
    return true;
}

bool accessor_read_floats(const struct accessor_view *view, float *out, struct err *err)
{
    return read_elements(view, out, NULL, err);
}

bool accessor_read_or_zero(const struct accessor_view *view, float *out, uint32_t *replaced)
{
    return read_elements(view, out, replaced, NULL);
}

static bool check_index(const struct accessor_view *view, uint32_t element, uint32_t limit,
                        const char *limit_name, uint32_t index, struct err *err)
{
    // The largest value of the type is not allowed, because it would restart the primitive on some
    // systems (section 3.7.2.1).
    uint32_t restart = view->type == COMPONENT_U8    ? UINT8_MAX
                       : view->type == COMPONENT_U16 ? UINT16_MAX
                                                     : UINT32_MAX;
    if (index == restart)
        return node_fail(&view->node, err,
                         "element %u is %u, the primitive restart value, which is not allowed",
                         element, index);
    if (index >= limit)
        return node_fail(&view->node, err, "element %u is %u; expected an index below %s, %u",
                         element, index, limit_name, limit);
    return true;
}

// Reads the components of element `at` as integers.
static void load_joints(const struct accessor_view *view, const uint8_t *at, uint32_t out[4])
{
    for (size_t c = 0; c < 4; c++)
        out[c] = load_unsigned(at + c * components[view->type].size, view->type);
}

bool accessor_read_joints(const struct accessor_view *view, uint32_t limit, uint32_t *out,
                          struct err *err)
{
    memset(out, 0, 4 * view->count * sizeof *out);
    for (uint32_t i = 0; view->data && i < view->count; i++)
        load_joints(view, view->data + i * view->stride, out + 4 * (size_t)i);
    size_t size = 4 * (size_t)components[view->type].size;
    for (uint32_t i = 0; i < view->sparse_count; i++)
        load_joints(view, view->sparse_values + i * size, out + 4 * (size_t)sparse_index(view, i));
    for (size_t i = 0; i < 4 * (size_t)view->count; i++)
        if (out[i] >= limit)
            return node_fail(&view->node, err,
                             "element %zu, component %zu is %u; expected an index below the number "
                             "of joints, %u",
                             i / 4, i % 4, out[i], limit);
    return true;
}

bool accessor_read_indices(const struct accessor_view *view, uint32_t limit, const char *limit_name,
                           uint32_t *out, struct err *err)
{
    for (uint32_t i = 0; i < view->count; i++)
        out[i] = view->data ? load_unsigned(view->data + i * view->stride, view->type) : 0;
    size_t size = components[view->type].size;
    for (uint32_t i = 0; i < view->sparse_count; i++)
        out[sparse_index(view, i)] = load_unsigned(view->sparse_values + i * size, view->type);
    for (uint32_t i = 0; i < view->count; i++)
        if (!check_index(view, i, limit, limit_name, out[i], err))
            return false;
    return true;
}
