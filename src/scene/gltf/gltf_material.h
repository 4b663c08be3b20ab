// Declarations that the readers of a glTF document's materials share. Internal to scene/.
#ifndef LAMPYRIS_SCENE_GLTF_GLTF_MATERIAL_H
#define LAMPYRIS_SCENE_GLTF_GLTF_MATERIAL_H

#include "scene/gltf/gltf_load.h"

// One use of a texture by a material, kept until it is known which materials are used.
struct gltf_texture {
    struct gltf_texture *next; // of the same material
    uint32_t image;            // the document's
    bool is_srgb;
    float green[2];         // mix(green[0], green[1], green) stands for green; both 0: as it is
    struct texture texture; // but for its image
};

// Knowledge of one of the document's materials beside what the scene has of it.
struct gltf_material {
    bool is_used; // by a primitive that was loaded
    struct gltf_texture *first_texture, *last_texture;
};

struct gltf_material_reader {
    struct gltf_load *load;
    const struct json_node *node; // of the material
    struct gltf_material *state;
    struct material *material; // no other is added while it is read
};

static const struct range gltf_unit = {0, 1, false};

// Reflectance at normal incidence of the index 1.5, ((1.5 - 1) / (1.5 + 1))^2.
#define GLTF_REFLECTANCE 0.04f

// gltf_texture.c: takes down the textureInfo object.key, where there is one.
struct gltf_texture_use {
    uint32_t flags; // TEXTURE_USE_* and what is scaled, as of texture_scales()
    bool is_srgb;   // its colours are; alpha never is
    float green[2]; // as above
};
bool gltf_texture_read(struct gltf_material_reader *reader, const struct json_node *object,
                       const char *key, const struct gltf_texture_use *use, struct err *err);
// Returns whether a texture was taken down that scales this parameter.
bool gltf_texture_scales(const struct gltf_material_reader *reader, uint32_t parameter);

// gltf_image.c: one image as the scene wants it.
struct gltf_image {
    uint32_t source; // the document's image, below its count
    bool is_srgb;
    float green[2]; // as of gltf_texture
    uint32_t index; // result: the scene's image
};
bool gltf_images_load(struct gltf_load *load, struct gltf_image *images, size_t count,
                      struct err *err);

// gltf_material_layers.c: what extensions add to the metallic-roughness model.
bool gltf_material_read_layers(struct gltf_material_reader *reader, struct err *err);

#endif
