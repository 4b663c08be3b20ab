// Declarations that the readers of a glTF document's materials share. Internal to scene/.
#ifndef LAMPYRIS_SCENE_GLTF_GLTF_MATERIAL_H
#define LAMPYRIS_SCENE_GLTF_GLTF_MATERIAL_H

#include "scene/gltf/gltf_load.h"

// A use of a texture by a material, stored until the used materials are known.
struct gltf_texture {
    struct gltf_texture *next; // next texture of the same material
    uint32_t image;            // index of the image in the document
    bool is_srgb;
    float green[2];         // channel g becomes mix(green[0], green[1], g); both 0: unchanged
    struct texture texture; // complete except for its image
};

// State of one of the document's materials during loading.
struct gltf_material {
    bool is_used; // a loaded primitive uses it
    struct gltf_texture *first_texture, *last_texture;
};

struct gltf_material_reader {
    struct gltf_load *load;
    const struct json_node *node; // the material's JSON object
    struct gltf_material *state;
    struct material *material; // no other material is added while this one is read
};

static const struct range gltf_unit = {0, 1, false};

// Reflectance at normal incidence for the index of refraction 1.5, ((1.5 - 1) / (1.5 + 1))^2.
#define GLTF_REFLECTANCE 0.04f

// gltf_texture.c: records the textureInfo object.key, if it exists.
struct gltf_texture_use {
    uint32_t flags; // TEXTURE_USE_* and what the texture scales, see texture_scales()
    bool is_srgb;   // its colours are sRGB-encoded; alpha never is
    float green[2]; // see struct gltf_texture
};
bool gltf_texture_read(struct gltf_material_reader *reader, const struct json_node *object,
                       const char *key, const struct gltf_texture_use *use, struct err *err);
// Returns whether a recorded texture scales this parameter.
bool gltf_texture_scales(const struct gltf_material_reader *reader, uint32_t parameter);

// gltf_image.c: an image to be loaded in the form that the scene needs.
struct gltf_image {
    uint32_t source; // index of the image in the document
    bool is_srgb;
    float green[2]; // see struct gltf_texture
    uint32_t index; // result: index of the image in the scene
};
bool gltf_images_load(struct gltf_load *load, struct gltf_image *images, size_t count,
                      struct err *err);

// gltf_material_layers.c: reads the extensions of the metallic-roughness model.
bool gltf_material_read_layers(struct gltf_material_reader *reader, struct err *err);

#endif
