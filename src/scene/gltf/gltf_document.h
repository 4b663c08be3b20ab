// An opened glTF 2.0 file (JSON or binary container). Its JSON has been checked for structure, and
// its buffers are in memory. Internal to scene/.
#ifndef LAMPYRIS_SCENE_GLTF_GLTF_DOCUMENT_H
#define LAMPYRIS_SCENE_GLTF_GLTF_DOCUMENT_H

#include "base/arena.h"
#include "base/err.h"
#include "base/file.h"
#include "json/json_node.h"
#include <stdbool.h>
#include <stdint.h>

#define GLTF_NONE UINT32_MAX // no index
// The maximum number of elements. Indices have 32 bits, and GLTF_NONE is reserved.
#define GLTF_MAX_COUNT (UINT32_MAX - 1u)

// The document's arrays of objects.
enum gltf_list {
    GLTF_ACCESSORS,
    GLTF_ANIMATIONS,
    GLTF_BUFFERS,
    GLTF_BUFFER_VIEWS,
    GLTF_CAMERAS,
    GLTF_IMAGES,
    GLTF_MATERIALS,
    GLTF_MESHES,
    GLTF_NODES,
    GLTF_SAMPLERS,
    GLTF_SCENES,
    GLTF_SKINS,
    GLTF_TEXTURES,
    GLTF_LIST_COUNT,
};

// The bytes of a file, and how to read them.
struct gltf_source {
    const char *path;         // for messages, and for the folder of the buffers
    struct file_bytes bytes;  // must outlive the document
    bool allow_outside_paths; // permits buffers outside the file's folder
};

struct gltf_buffer {
    const uint8_t *data; // NULL: no bytes, as for the fallback of a compressed view
    uint64_t size;       // byteLength; all these bytes are in memory unless data is NULL
    bool is_external;    // read from a file of its own
};

struct gltf_document {
    const struct gltf_source *source;
    struct arena arena; // owns the buffers and other data that lives as long as the document
    json_t *json;
    struct json_node root; // nodes point into this struct, so do not copy it
    struct json_node lists[GLTF_LIST_COUNT];
    uint32_t counts[GLTF_LIST_COUNT];
    struct gltf_buffer *buffers; // counts[GLTF_BUFFERS] elements
    // counts[GLTF_BUFFER_VIEWS] elements: the decompressed bytes of a view (byteLength of them);
    // NULL: the view is not compressed.
    const uint8_t **decoded_views;
    // counts[GLTF_ACCESSORS] elements: the decompressed elements without gaps; NULL: the accessor
    // is not part of a compressed mesh.
    const void **decoded_accessors;
    bool is_quantized;              // the file declares KHR_mesh_quantization
    const char *ignored_extensions; // "A, B": unknown extensions that the file uses; NULL: none
};

// Parses and checks *source, which must outlive *document, and loads all buffers. Compressed meshes
// are not decoded (gltf_draco_decode()).
bool gltf_document_open(struct gltf_document *document, const struct gltf_source *source,
                        struct err *err);
void gltf_document_close(struct gltf_document *document); // accepts {0} and partly opened ones

// Sets ERR_SYSTEM with the file's name as prefix. Returns false.
bool gltf_no_memory(const struct gltf_document *document, const char *what, uint64_t bytes,
                    struct err *err);
// Shows static analysers that the result is false (see err.h).
#define gltf_no_memory(...) (gltf_no_memory(__VA_ARGS__), err_false())

// Returns element `index`, below document->counts[list], of one of the arrays. It is always an
// object.
struct json_node gltf_item(const struct gltf_document *document, enum gltf_list list,
                           uint32_t index);

// --- readers of glTF's data types, in addition to json_node.h ------------------------------------

bool gltf_require(const struct json_node *object, const char *key, struct err *err);
// Reads an index below `count`; GLTF_NONE if the key is absent.
bool gltf_read_index(const struct json_node *object, const char *key, uint32_t count, uint32_t *out,
                     struct err *err);
// Finds the element of a list with this name, or else with this index. `what` names the kind of
// element in messages, such as "animation". Fails with ERR_USAGE if there is none, because the name
// comes from the command line.
bool gltf_find(const struct gltf_document *document, enum gltf_list list, const char *what,
               const char *wanted, uint32_t *out, struct err *err);
// Read a member that must be an object or an array. If it is absent, out->value becomes NULL.
bool gltf_read_object(const struct json_node *object, const char *key, struct json_node *out,
                      struct err *err);
bool gltf_read_array(const struct json_node *object, const char *key, struct json_node *out,
                     struct err *err);
// Reads object.extensions.NAME. The caller must keep *extensions, because *out points to it.
bool gltf_read_extension(const struct json_node *object, const char *name,
                         struct json_node *extensions, struct json_node *out, struct err *err);
// Copies object.name into the arena; "" if it is absent.
bool gltf_read_name(const struct json_node *object, struct arena *arena, const char **out,
                    struct err *err);
// Reads a number in single precision. If the key is absent, *out is unchanged.
bool gltf_read_float(const struct json_node *object, const char *key, struct range range,
                     float *out, struct err *err);
// Reads exactly `count` finite numbers. If the key is absent, *out is unchanged.
bool gltf_read_numbers(const struct json_node *object, const char *key, size_t count, double *out,
                       struct err *err);

#endif
