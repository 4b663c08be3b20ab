// Accessors: the only code that reads the bytes of a glTF document's buffers. Internal to scene/.
#ifndef LAMPYRIS_SCENE_GLTF_GLTF_ACCESSOR_H
#define LAMPYRIS_SCENE_GLTF_GLTF_ACCESSOR_H

#include "scene/gltf/gltf_document.h"

// The codes of the specification minus COMPONENT_CODE_BASE. The specification has no code 5124
// (INT).
enum component_type {
    COMPONENT_I8 = 0,
    COMPONENT_U8 = 1,
    COMPONENT_I16 = 2,
    COMPONENT_U16 = 3,
    COMPONENT_U32 = 5,
    COMPONENT_F32 = 6,
};
#define COMPONENT_CODE_BASE 5120
#define COMPONENT_BIT(type) (1u << (type))
#define COMPONENTS_FLOAT COMPONENT_BIT(COMPONENT_F32)
#define COMPONENTS_SMALL_SIGNED (COMPONENT_BIT(COMPONENT_I8) | COMPONENT_BIT(COMPONENT_I16))
#define COMPONENTS_SMALL_UNSIGNED (COMPONENT_BIT(COMPONENT_U8) | COMPONENT_BIT(COMPONENT_U16))

// The maximum count of an accessor without a buffer view. The elements of such an accessor are
// zero, so the size of the file does not limit their number. 2^24 is more than real files need, and
// takes little memory.
#define ACCESSOR_MAX_UNBACKED_COUNT (UINT64_C(1) << 24)

#define ACCESSOR_MAT4 16 // number of components

// The requirements that a use of an accessor has.
struct accessor_rule {
    const char *use;               // name for messages, such as "POSITION"
    uint32_t components;           // 1 SCALAR, 2 VEC2, 3 VEC3, 4 VEC4, 16 MAT4
    uint32_t fewer_components;     // number of components of another permitted type; 0: none
    uint32_t types;                // COMPONENT_BITs permitted without "normalized"
    uint32_t normalized_types;     // COMPONENT_BITs permitted with "normalized": true
    uint32_t quantized_types;      // like `types`, but only permitted with KHR_mesh_quantization
    uint32_t quantized_normalized; // like `normalized_types`, but only with KHR_mesh_quantization
    bool is_vertex_attribute;      // may be interleaved; elements are aligned to 4 bytes
};

// A checked view of an accessor's elements: every byte of every element lies inside its buffer, and
// sparse indices increase strictly and are below the count. Valid as long as the document exists.
struct accessor_view {
    struct json_node node; // for messages
    uint32_t count, components;
    enum component_type type;
    bool is_normalized;
    const uint8_t *data; // NULL: all elements are zero
    size_t stride;       // bytes from one element to the next
    uint32_t sparse_count;
    enum component_type sparse_index_type;
    const uint8_t *sparse_indices, *sparse_values; // tightly packed
};

// Checks accessor `index`, which is below the document's count, against its buffer views and *rule.
bool accessor_view(const struct gltf_document *document, uint32_t index,
                   const struct accessor_rule *rule, struct accessor_view *out, struct err *err);

// The layout that an accessor declares for its elements. Their bytes are not read.
struct accessor_layout {
    struct json_node node; // for messages
    uint32_t count, components, component_size;
    enum component_type type;
};
bool accessor_layout(const struct gltf_document *document, uint32_t index,
                     struct accessor_layout *out, struct err *err);

// Reads count * components numbers. Fails if a number is not finite, naming its element.
bool accessor_read_floats(const struct accessor_view *view, float *out, struct err *err);
// As accessor_read_floats(), but numbers that are not finite become 0 and are counted in *replaced.
// Always returns true.
bool accessor_read_or_zero(const struct accessor_view *view, float *out, uint32_t *replaced);
// Reads 4 * count unsigned integers of a VEC4 accessor. Each must be below `limit`, the number of
// joints.
bool accessor_read_joints(const struct accessor_view *view, uint32_t limit, uint32_t *out,
                          struct err *err);
// Reads count unsigned integers of a SCALAR accessor. Fails if one is not below `limit`, which
// messages call `limit_name`, such as "the vertex count", or if one is the primitive restart value.
bool accessor_read_indices(const struct accessor_view *view, uint32_t limit, const char *limit_name,
                           uint32_t *out, struct err *err);

// Gets the bytes of buffer view `index`, which is below the document's count. The document owns
// them.
bool gltf_view_bytes(const struct gltf_document *document, uint32_t index, struct file_bytes *out,
                     struct err *err);

#endif
