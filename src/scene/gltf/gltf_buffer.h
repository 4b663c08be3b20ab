// The bytes of a glTF document's buffers: data URIs, files beside the document, and the binary
// chunk of a GLB file. Internal to scene/.
#ifndef LAMPYRIS_SCENE_GLTF_GLTF_BUFFER_H
#define LAMPYRIS_SCENE_GLTF_GLTF_BUFFER_H

#include "scene/gltf/gltf_document.h"

// The two chunks of a GLB file that the specification defines.
struct glb_chunks {
    struct file_bytes json;
    struct file_bytes binary; // data is NULL if there is none
};

bool glb_is_container(const struct file_bytes *bytes); // whether they begin with "glTF"
// Finds the chunks and checks the whole container. Errors do not name the file.
bool glb_open(const struct file_bytes *bytes, struct glb_chunks *out, struct err *err);

// Loads all buffers into document->buffers. `binary` is the GLB file's binary chunk; its data are
// NULL if there is none.
bool gltf_buffers_load(struct gltf_document *document, const struct file_bytes *binary,
                       struct err *err);

// gltf_meshopt.c: decodes the buffer views with EXT_meshopt_compression into
// document->decoded_views. Buffers that only such views use may lack bytes.
bool gltf_meshopt_decode(struct gltf_document *document, struct err *err);

// gltf_draco.c: decodes the primitives with KHR_draco_mesh_compression into
// document->decoded_accessors.
bool gltf_draco_decode(struct gltf_document *document, struct err *err);

// Loads the bytes of a "uri" into `arena`: a data URI, or a file in a permitted folder. *path is
// the file's path; NULL for a data URI.
bool gltf_uri_load(const struct gltf_document *document, const struct json_node *uri,
                   struct arena *arena, struct file_bytes *out, const char **path, struct err *err);

#endif
