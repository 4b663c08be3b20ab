// Decodes primitives whose vertices and triangles are compressed together
// (KHR_draco_mesh_compression). All such primitives are decoded when the document is opened, into
// the layout that their accessors describe. The loader then reads these accessors like any others.
#include "scene/gltf/draco_mesh.h"
#include "scene/gltf/gltf_accessor.h"
#include "scene/gltf/gltf_buffer.h"

#define EXTENSION "KHR_draco_mesh_compression"
#define MODE_TRIANGLES 4

struct primitive {
    struct json_node node, attributes;          // the primitive and its attributes' accessors
    struct json_node extension, its_attributes; // the extension and its attributes' ids
    struct draco_mesh *mesh;
};

_Static_assert(COMPONENT_I8 == (int)DRACO_I8 && COMPONENT_U8 == (int)DRACO_U8 &&
                   COMPONENT_I16 == (int)DRACO_I16 && COMPONENT_U16 == (int)DRACO_U16 &&
                   COMPONENT_U32 == (int)DRACO_U32 && COMPONENT_F32 == (int)DRACO_F32,
               "a component type is cast to a type of Draco");

// Reads the layout that an accessor declares, and allocates its elements. *out is NULL if the
// accessor has been decoded already, because several primitives use it.
static bool allocate(struct gltf_document *document, uint32_t accessor, uint64_t decoded,
                     struct accessor_layout *layout, void **out, struct err *err)
{
    *out = NULL;
    if (document->decoded_accessors[accessor])
        return true;
    if (!accessor_layout(document, accessor, layout, err))
        return false;
    if (layout->count != decoded)
        return node_fail(&layout->node, err, "the count is %u, but " EXTENSION " has %llu elements",
                         layout->count, (unsigned long long)decoded);
    const size_t size = (size_t)layout->components * layout->component_size;
    *out = arena_alloc(&document->arena, layout->count, size);
    return *out || gltf_no_memory(document, "decompressed vertices", layout->count * size, err);
}

static bool decode_attribute(struct gltf_document *document, const struct primitive *primitive,
                             const char *key, struct err *err)
{
    struct accessor_layout layout;
    uint32_t accessor;
    uint64_t id = 0;
    void *data;
    if (!gltf_require(&primitive->attributes, key, err) ||
        !gltf_read_index(&primitive->attributes, key, document->counts[GLTF_ACCESSORS], &accessor,
                         err) ||
        !node_read_integer(&primitive->its_attributes, key, 0, UINT32_MAX, &id, err) ||
        !allocate(document, accessor, draco_mesh_points(primitive->mesh), &layout, &data, err))
        return false;
    if (!data)
        return true;
    if (!draco_mesh_read(primitive->mesh, (uint32_t)id, (enum draco_type)layout.type,
                         layout.components, data))
        return node_fail(&primitive->its_attributes, err,
                         "%s: the compressed mesh has no attribute %u that fits its accessor", key,
                         (unsigned)id);
    document->decoded_accessors[accessor] = data;
    return true;
}

// Converts the indices to the type of their accessor.
static bool store_indices(const struct accessor_layout *layout, const uint32_t *indices, void *out,
                          struct err *err)
{
    for (uint32_t i = 0; i < layout->count; i++) {
        const uint32_t index = indices[i];
        if (layout->component_size == 4)
            ((uint32_t *)out)[i] = index;
        else if (index >> (8 * layout->component_size))
            return node_fail(&layout->node, err, "index %u does not fit into %u bytes", index,
                             layout->component_size);
        else if (layout->component_size == 2)
            ((uint16_t *)out)[i] = (uint16_t)index;
        else
            ((uint8_t *)out)[i] = (uint8_t)index;
    }
    return true;
}

static bool decode_indices(struct gltf_document *document, const struct primitive *primitive,
                           struct err *err)
{
    struct accessor_layout layout;
    uint32_t accessor;
    void *data;
    const uint64_t count = 3 * (uint64_t)draco_mesh_triangles(primitive->mesh);
    if (!gltf_require(&primitive->node, "indices", err) ||
        !gltf_read_index(&primitive->node, "indices", document->counts[GLTF_ACCESSORS], &accessor,
                         err) ||
        !allocate(document, accessor, count, &layout, &data, err))
        return false;
    if (!data)
        return true;
    if (layout.components != 1 || layout.type == COMPONENT_F32)
        return node_fail(&layout.node, err, "expected unsigned integers of type \"SCALAR\"");
    struct arena scratch = {0};
    uint32_t(*triangles)[3] = arena_alloc(&scratch, (size_t)(count / 3), sizeof *triangles);
    bool ok = triangles || gltf_no_memory(document, "decompressed indices", 4 * count, err);
    if (ok) {
        draco_mesh_read_triangles(primitive->mesh, triangles);
        ok = store_indices(&layout, triangles[0], data, err);
    }
    arena_finish(&scratch);
    document->decoded_accessors[accessor] = ok ? data : NULL;
    return ok;
}

static bool decode_content(struct gltf_document *document, const struct primitive *primitive,
                           struct err *err)
{
    const char *key;
    json_t *value;
    json_object_foreach(primitive->its_attributes.value, key, value)
    {
        (void)value;
        if (!decode_attribute(document, primitive, key, err))
            return false;
    }
    return decode_indices(document, primitive, err);
}

static bool open_mesh(const struct gltf_document *document, struct primitive *primitive,
                      struct err *err)
{
    struct file_bytes bytes;
    uint32_t view;
    uint64_t mode = MODE_TRIANGLES;
    char message[128];
    if (!gltf_require(&primitive->extension, "bufferView", err) ||
        !gltf_read_index(&primitive->extension, "bufferView", document->counts[GLTF_BUFFER_VIEWS],
                         &view, err) ||
        !gltf_view_bytes(document, view, &bytes, err) ||
        !node_read_integer(&primitive->node, "mode", 0, UINT32_MAX, &mode, err))
        return false;
    if (mode != MODE_TRIANGLES)
        return node_fail(&primitive->node, err,
                         "\"mode\" is %u; expected 4 (triangles) with " EXTENSION, (unsigned)mode);
    primitive->mesh = draco_mesh_open(bytes.data, bytes.size, message, sizeof message);
    if (primitive->mesh)
        return true;
    return message[0] ? node_fail(&primitive->extension, err, "its %zu bytes are no valid mesh: %s",
                                  bytes.size, message)
                      : gltf_no_memory(document, "a compressed mesh", 0, err);
}

static bool decode_primitive(struct gltf_document *document, const struct json_node *node,
                             struct err *err)
{
    struct primitive primitive = {.node = *node};
    struct json_node extensions;
    if (!gltf_read_extension(node, EXTENSION, &extensions, &primitive.extension, err))
        return false;
    if (!primitive.extension.value)
        return true;
    if (!gltf_require(node, "attributes", err) ||
        !gltf_read_object(node, "attributes", &primitive.attributes, err) ||
        !gltf_require(&primitive.extension, "attributes", err) ||
        !gltf_read_object(&primitive.extension, "attributes", &primitive.its_attributes, err))
        return false;
    bool ok = open_mesh(document, &primitive, err) && decode_content(document, &primitive, err);
    draco_mesh_close(primitive.mesh);
    return ok;
}

bool gltf_draco_decode(struct gltf_document *document, struct err *err)
{
    for (uint32_t i = 0; i < document->counts[GLTF_MESHES]; i++) {
        const struct json_node mesh = gltf_item(document, GLTF_MESHES, i);
        struct json_node primitives;
        if (!gltf_read_array(&mesh, "primitives", &primitives, err))
            return false;
        for (size_t k = 0; k < json_array_size(primitives.value); k++) {
            const struct json_node primitive = node_element(&primitives, k);
            // The loader of meshes reports primitives that are not objects.
            if (json_is_object(primitive.value) && !decode_primitive(document, &primitive, err))
                return false;
        }
    }
    return true;
}
