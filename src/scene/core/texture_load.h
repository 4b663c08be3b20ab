// Images as textures of a scene.
#ifndef LAMPYRIS_SCENE_CORE_TEXTURE_LOAD_H
#define LAMPYRIS_SCENE_CORE_TEXTURE_LOAD_H

#include "scene/core/scene.h"

struct texture_source {
    const char *path; // trusted, or confined by the caller; NULL: `data`
    const void *data; // a PNG, JPEG, HDR or EXR file in memory
    size_t size;
    const char *name; // for messages; NULL: the path
    bool is_srgb;     // colours of 8 or 16 bits are sRGB-encoded; of no account for HDR and EXR
};

// Decodes an image into scene->images; an image of the same bytes and encoding that is there
// already is returned instead. ERR_INPUT for what cannot be decoded and for sides above 65535.
// Texels that are not finite become 0, with a note that counts them. Continues scene->hash over the
// file's bytes.
bool texture_image_load(struct scene *scene, const struct texture_source *source, uint32_t *index,
                        struct err *err);

// For an image that cannot be read, for this reason: unless the scene is strict, an image of pink,
// one for each reason, that makes its materials pink when the scene is complete
// (material_mark_missing). False, with the reason as *err, where it is.
bool texture_image_missing(struct scene *scene, const struct err *reason, uint32_t *index,
                           struct err *err);
// Returns whether a texture of the material is of such an image; it is pink then, Lambert's, and
// has no textures any more.
bool material_mark_missing(const struct scene *scene, struct material *material);
// Whether it was made so.
bool material_is_missing(const struct material *material);

// Appends a texture to the material, whose textures must be the last ones of the scene's: a
// material's are added one after the other. *texture is copied. Texels above 1 count as 1 but for
// emission: a note says so of an image that has some.
bool material_add_texture(struct scene *scene, struct material *material,
                          const struct texture *texture, struct err *err);

// Returns in `out` the RGBA of a texel. Texels are counted by rows from the top.
void texture_texel(const struct texture_image *image, uint64_t index, float out[4]);

// Flags of a texture that scales parameters of a group: component i of the group by channel c[i] of
// the texel (0 red … 3 alpha), or not at all where that is -1.
uint32_t texture_scales(uint32_t group, const int channel[4]);
// (s, t) = offset + R (scale * (u, v)), R = (cos, sin; -sin, cos) of the angle in radians.
void texture_transform(struct texture *texture, const double offset[2], const double scale[2],
                       double angle);

#endif
