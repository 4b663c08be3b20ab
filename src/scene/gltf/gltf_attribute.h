// Vertex attributes of a glTF document as arrays of floats. Internal to scene/.
#ifndef LAMPYRIS_SCENE_GLTF_GLTF_ATTRIBUTE_H
#define LAMPYRIS_SCENE_GLTF_GLTF_ATTRIBUTE_H

#include "scene/gltf/gltf_load.h"

// Reads the attribute `key`, such as "TEXCOORD_1", of the object "attributes". It is decoded into
// the scene's arena in the form of struct mesh: normals of unit length or zero, tangents with the
// bitangent's sign, finite texture coordinates, colours as linear RGBA in [0, 1]. Accessors that
// several primitives use are decoded once. *values is NULL if the primitive lacks the attribute.
// The number of elements must be `count`, unless that is 0.
bool gltf_attribute_read(struct gltf_load *load, const struct json_node *attributes,
                         const char *key, enum gltf_attribute attribute, uint32_t count,
                         float **values, struct err *err);

// Returns the number of elements of an accessor that is read as this attribute; 0 if it cannot be
// read.
uint32_t gltf_attribute_count(const struct gltf_document *document, uint32_t accessor,
                              enum gltf_attribute attribute);
// Returns the number of floats per element in the arrays of gltf_attribute_read().
uint32_t gltf_attribute_width(enum gltf_attribute attribute);

#endif
