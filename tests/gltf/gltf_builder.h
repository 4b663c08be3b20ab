// Makes glTF files from arrays, with an accessor and a buffer view for each.
#ifndef LAMPYRIS_TESTS_GLTF_BUILDER_H
#define LAMPYRIS_TESTS_GLTF_BUILDER_H

#include "gltf_fixture.h"
#include "scene/gltf/gltf_load.h"

// {0} is an empty builder. The program ends if its arrays are full.
struct gltf_builder {
    char accessors[4096], views[4096];
    uint8_t binary[16384];
    size_t size;
    uint32_t accessor_count, view_count;
};

#define BYTE_CODE 5120
#define UNSIGNED_BYTE_CODE 5121
#define SHORT_CODE 5122
#define UNSIGNED_SHORT_CODE 5123
#define UNSIGNED_INT_CODE 5125
#define FLOAT_CODE 5126

// Adds `size` bytes as a buffer view. `members` are further members, such as "'byteStride':8", or
// "".
uint32_t builder_view(struct gltf_builder *builder, const void *data, size_t size,
                      const char *members);
// Adds `count` elements as an accessor with a buffer view of its own. The type is "VEC3" or, with
// further members, "VEC4,'normalized':true". Returns the accessor's index.
uint32_t builder_accessor(struct gltf_builder *builder, int code, const char *type, uint32_t count,
                          const void *data, size_t size);
#define BUILDER_FLOATS(builder, type, count, ...)                                                  \
    builder_accessor(builder, FLOAT_CODE, type, count, (const float[]){__VA_ARGS__},               \
                     sizeof((const float[]){__VA_ARGS__}))

// Makes a GLB file. `lists` are the other members of the document: "'nodes':[…],'meshes':[…]".
struct bytes builder_glb(const struct gltf_builder *builder, const char *lists);
// Loads the file. `params` selects pose and scene; its bytes are set here. NULL: the defaults.
bool builder_load(const struct gltf_builder *builder, const char *lists,
                  const struct gltf_load_params *params, struct scene *scene, struct err *err);

#endif
