// Makes small glTF files in memory, and a scene into which they are loaded.
#ifndef LAMPYRIS_TESTS_GLTF_FIXTURE_H
#define LAMPYRIS_TESTS_GLTF_FIXTURE_H

#include "scene/core/scene.h"
#include <stddef.h>
#include <stdint.h>

// Bytes on the heap, to be freed by free(data). A NUL follows the `size` bytes.
struct bytes {
    uint8_t *data;
    size_t size;
};

// Makes JSON from text with ' instead of ", which is easier to read in C.
struct bytes json_bytes(const char *json);
// Makes a GLB file with this JSON and, if size > 0, a binary chunk.
struct bytes glb_bytes(const char *json, const void *binary, size_t size);
// Returns a copy of `text` with the first occurrence of `find` replaced, to be freed by free();
// NULL if there is none.
char *replace_text(const char *text, const char *find, const char *replacement);
// Returns "data:…;base64,…", to be freed by free().
char *data_uri(const void *data, size_t size);

// A memory budget that is sufficient for all small files.
#define FIXTURE_MAX_BYTES ((size_t)64 << 20)

// Makes an empty scene with this budget, as scene_load passes it to a loader.
struct scene empty_scene(const char *path);
// Loads bytes as if they were the file `path`. The scene must be finished in any case.
bool load_bytes(struct scene *scene, const char *path, struct bytes bytes, struct err *err);
// Makes a GLB file, loads it as "test.glb" and frees it.
bool load_glb(struct scene *scene, const char *json, const void *binary, size_t size,
              struct err *err);

// Returns what is wrong with a loaded scene, or NULL: an index beyond its array, a number that is
// not finite, or a missing name.
const char *scene_objection(const struct scene *scene);
// Returns whether one of the notes contains the text.
bool has_note(const struct scene *scene, const char *text);

// A file that uses most functions of the loader: a square with normals, indices and a sparse
// accessor, a second node, a camera and a material.
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
