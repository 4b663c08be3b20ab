// Decodes a mesh compressed by Draco. This is an interface in C to the library, which is in C++.
#ifndef LAMPYRIS_SCENE_GLTF_DRACO_MESH_H
#define LAMPYRIS_SCENE_GLTF_DRACO_MESH_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

struct draco_mesh;

// The types of numbers, with the values of enum component_type (gltf_accessor.h).
enum draco_type {
    DRACO_I8 = 0,
    DRACO_U8 = 1,
    DRACO_I16 = 2,
    DRACO_U16 = 3,
    DRACO_U32 = 5,
    DRACO_F32 = 6,
};

// Returns NULL if the data are no valid mesh, with the library's reason in *message, or if there is
// no memory, with an empty message.
struct draco_mesh *draco_mesh_open(const void *data, size_t size, char *message,
                                   size_t message_size);
void draco_mesh_close(struct draco_mesh *mesh); // accepts NULL

uint32_t draco_mesh_points(const struct draco_mesh *mesh);
uint32_t draco_mesh_triangles(const struct draco_mesh *mesh);
// Reads the attribute with this id: `components` numbers for each point, without gaps. Returns
// false if there is no such attribute, or if its numbers do not fit into the type.
bool draco_mesh_read(const struct draco_mesh *mesh, uint32_t id, enum draco_type type,
                     uint32_t components, void *out);
// Reads the three points of each triangle.
void draco_mesh_read_triangles(const struct draco_mesh *mesh, uint32_t (*out)[3]);

#ifdef __cplusplus
}
#endif

#endif
