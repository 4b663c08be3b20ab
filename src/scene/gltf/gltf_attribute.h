// Vertex attributes of a glTF document as arrays of floats. Internal to scene/.
#ifndef LAMPYRIS_SCENE_GLTF_GLTF_ATTRIBUTE_H
#define LAMPYRIS_SCENE_GLTF_GLTF_ATTRIBUTE_H

#include "scene/gltf/gltf_load.h"

// Reads the attribute that `key` names, "TEXCOORD_1", from "attributes", decoded into the scene's
// arena as struct mesh has it: normals of unit length or zero, tangents with the bitangent's sign,
// texture coordinates finite, colours as linear RGBA in [0, 1]. Accessors that several primitives
// use are decoded once. *values is NULL where the primitive has no such attribute; their number is
// checked to be `count`, unless that is 0.
bool gltf_attribute_read(struct gltf_load *load, const struct json_node *attributes,
                         const char *key, enum gltf_attribute attribute, uint32_t count,
                         float **values, struct err *err);

// The elements of an accessor, as that attribute; 0 where it cannot be read so.
uint32_t gltf_attribute_count(const struct gltf_document *document, uint32_t accessor,
                              enum gltf_attribute attribute);
// Numbers of an element in the arrays above.
uint32_t gltf_attribute_width(enum gltf_attribute attribute);

#endif
