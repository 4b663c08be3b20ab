// Small glTF files made in memory, and a scene to load them into.
#ifndef LAMPYRIS_TESTS_GLTF_FIXTURE_H
#define LAMPYRIS_TESTS_GLTF_FIXTURE_H

#include "scene/core/scene.h"
#include <stddef.h>
#include <stdint.h>

// Bytes on the heap; finish with free(data). `size` bytes and a NUL that is not counted.
struct bytes {
    uint8_t *data;
    size_t size;
};

// JSON with ' for ", so that it reads well in C.
struct bytes json_bytes(const char *json);
// A GLB file with that JSON and, where size > 0, a binary chunk.
struct bytes glb_bytes(const char *json, const void *binary, size_t size);
// A copy of `text` with the first `find` replaced; NULL when there is none. free() it.
char *replace_text(const char *text, const char *find, const char *replacement);
// "data:…;base64,…". free() it.
char *data_uri(const void *data, size_t size);

// A memory budget that no small file should need.
#define FIXTURE_MAX_BYTES ((size_t)64 << 20)

// An empty scene as scene_load would hand it to a loader, with that budget.
struct scene empty_scene(const char *path);
// Loads bytes as if they were the file `path`. The scene is to be finished either way.
bool load_bytes(struct scene *scene, const char *path, struct bytes bytes, struct err *err);
// Makes a GLB, loads it as "test.glb" and frees it.
bool load_glb(struct scene *scene, const char *json, const void *binary, size_t size,
              struct err *err);

// Returns the fault of a loaded scene, or NULL: an index beyond its array, a number that is not
// finite, or a missing name.
const char *scene_objection(const struct scene *scene);
// Returns whether one of the notes contains the text.
bool has_note(const struct scene *scene, const char *text);

// A file that uses most of what the loader reads: a square with normals, indices and a sparse
// accessor, a second node, a camera, a material.
extern const char sample_json[];
struct sample_binary {
    float positions[4][3];
    float normals[4][3];
    uint16_t indices[6];
    uint16_t sparse_indices[2];
    float sparse_positions[2][3];
};
extern const struct sample_binary sample_binary;

#endif
