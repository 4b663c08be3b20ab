// Loads images as textures of a scene.
#ifndef LAMPYRIS_SCENE_CORE_TEXTURE_LOAD_H
#define LAMPYRIS_SCENE_CORE_TEXTURE_LOAD_H

#include "scene/core/scene.h"

struct texture_source {
    const char *path; // already checked for permission; NULL: use `data`
    const void *data; // the bytes of an image file (image/image.h)
    size_t size;
    const char *name; // for messages; NULL: the path
    bool is_srgb;     // colours of 8 or 16 bits are sRGB-encoded; ignored for HDR, EXR and PFM
};

// Decodes an image into scene->images, or returns the index of an image with the same bytes and
// encoding that was loaded before. Fails with ERR_INPUT if it cannot be decoded or if a side
// exceeds 65535 pixels. Texels that are negative or not finite become 0, and a note counts them.
// The file's bytes are added to the scene's hash.
bool texture_image_load(struct scene *scene, const struct texture_source *source, uint32_t *index,
                        struct err *err);

// Handles an image that cannot be read because of `reason`. Unless the scene is strict, *index
// becomes a pink image, one for each reason; the materials that use it become pink when the scene
// is complete (material_mark_missing). If the scene is strict, returns false, and `reason` becomes
// *err.
bool texture_image_missing(struct scene *scene, const struct err *reason, uint32_t *index,
                           struct err *err);
// Returns whether a texture of the material is a missing image. If so, the material becomes a pink
// Lambert material without textures.
bool material_mark_missing(const struct scene *scene, struct material *material);
// Returns whether material_mark_missing() made the material pink.
bool material_is_missing(const struct material *material);

// Appends a texture to the material. The material's textures must be the last ones of the scene, so
// textures are added material by material. *texture is copied. Texels above 1 count as 1, except
// for emission; a note names an image that has such texels.
bool material_add_texture(struct scene *scene, struct material *material,
                          const struct texture *texture, struct err *err);

// Gets a texel as RGBA. Texels are numbered row by row from the top.
void texture_texel(const struct texture_image *image, uint64_t index, float out[4]);

// Returns the flags of a texture that scales parameters of a group: channel[i] of the texel (0 red
// … 3 alpha) scales component i of the group; -1: none does.
uint32_t texture_scales(uint32_t group, const int channel[4]);
// Sets (s, t) = offset + R (scale * (u, v)), where R = (cos, sin; -sin, cos) of the angle in
// radians.
void texture_transform(struct texture *texture, const double offset[2], const double scale[2],
                       double angle);

#endif
