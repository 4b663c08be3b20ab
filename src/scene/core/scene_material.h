// Materials, textures and lights of a scene, as plain data. Part of scene.h.
//
// A material is a model (MATERIAL_LAMBERT …), flags and parameters, numbered by PARAMETER_* of
// shaders/shared/material.h. The table material_parameters[] documents each parameter; the reader
// of scene files, its checks and the documentation use it.
#ifndef LAMPYRIS_SCENE_CORE_SCENE_MATERIAL_H
#define LAMPYRIS_SCENE_CORE_SCENE_MATERIAL_H

#include "base/field.h"
#include "shared/material.h"
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

// Microfacet distributions with alpha = roughness^2 below this are treated as perfectly specular,
// because single precision does not resolve a narrower GGX distribution. Equals SMALLEST_ALPHA of
// lib/microfacet.glsl.
#define MATERIAL_SMALLEST_ALPHA 1e-4f

struct material_parameter {
    const char *name;      // in scene files: "base_color"
    uint32_t first, count; // PARAMETER_* and number of components, 1 or 3
    float min, max;        // range of each component
    float fallback;        // default of each component
    uint32_t models;       // bits 1 << MATERIAL_* of the models that use it
    const char *help;      // one sentence, with the unit
};

extern const struct material_parameter material_parameters[];
extern const uint32_t material_parameter_count;
// Names such as "diffuse", indexed by model; ended by NULL.
extern const char *const material_model_names[MATERIAL_MODEL_COUNT + 1];

struct material {
    const char *name; // never NULL; "" if the file gives none
    uint32_t model;   // MATERIAL_LAMBERT …
    uint32_t flags; // MATERIAL_ALPHA_MASK …; NORMAL_MAP, MEDIUM and EMITS are only set at upload
    union {
        float parameters[PARAMETER_COUNT];
        struct { // the same memory, by name
            float base_color[3], opacity;
            float emission[3], pick_density;
            float anisotropic, roughness, metallic, anisotropic_rotation;
            float specular_color[3], specular_weight;
            float transmission, ior, specular, specular_tint;
            float clearcoat, clearcoat_roughness, clearcoat_gloss, normal_scale;
            float sheen_color[3], sheen_roughness;
            float subsurface, sheen, sheen_tint, diffuse_transmission;
            float iridescence, film_thickness, film_ior, dispersion;
            float conductor_eta[3], exponent;
            float conductor_k[3], alpha_cutoff;
        };
    };
    uint32_t first_texture, texture_count; // range in scene->textures
    // The medium inside the material's closed surfaces, for models that transmit and are not
    // thin-walled.
    float extinction[3];      // 1/m; INFINITY is opaque at any distance but 0
    uint32_t medium_priority; // 1 to 255, default 1; the highest priority wins where media overlap
};

_Static_assert(offsetof(struct material, dispersion) ==
                   offsetof(struct material, parameters[PARAMETER_DISPERSION]),
               "names and numbers of the parameters must agree");
_Static_assert(offsetof(struct material, alpha_cutoff) ==
                   offsetof(struct material, parameters[PARAMETER_ALPHA_CUTOFF]),
               "names and numbers of the parameters must agree");

// The flags of a material that scene files set, with their names there ("alpha", "thin" …). Each
// row is a bit or a choice. Flags that are derived at upload are not listed.
extern const struct field material_flags[];
extern const size_t material_flag_count;
const struct field *material_flag(const char *key); // returns the row with this key

// Initialises a grey Lambert material with the default of every parameter.
void material_init(struct material *material);
// Sets the absorption (Beer-Lambert law) so that white light has `color` after `distance` metres (>
// 0): -log(color) / distance; infinite where a channel is 0.
void material_set_absorption(struct material *material, const float color[3], float distance);
// Returns the model that shades the material: MATERIAL_LAMBERT if its other lobes have no weight,
// else its own.
uint32_t material_shading_model(const struct material *material);
// Returns the CLASS_* that shades the material.
uint32_t material_class(const struct material *material);
// Convert between Phong's exponent and roughness by alpha_p = 2 / alpha^2 - 2 (Walter et al. 2007,
// section 5.2), with alpha = roughness^2. The exponent is INFINITY at roughness 0.
double material_phong_exponent(double roughness);
double material_phong_roughness(double exponent);
// Returns whether the material's surfaces bound a medium: it transmits light, refracted or not, and
// is not thin-walled.
bool material_has_inside(const struct material *material);
// Returns whether the material may emit light to rays that hit it. Unlit materials may, too, but no
// shadow rays are sent to them.
bool material_emits(const struct material *material);

// Texels in memory: RGBA as four 8-bit codes or as four linear floats.
struct texture_image {
    const char *name;       // for messages
    uint32_t width, height; // at most 65535
    bool has_alpha;         // some texel has an alpha below 1
    bool is_missing;        // the file is missing, and one pink texel replaces it
    const void *texels;     // row 0 at the top
    // The linear value of each of the 256 codes in each channel; NULL: the texels are floats.
    const float (*values)[4];
    // How codes become values: whether colours are sRGB-encoded, and that the value of green, once
    // decoded, is green[0] + green[1] * green.
    bool is_srgb;
    float green[2];
    float mean[4];   // mean of all texels
    float greatest;  // greatest component of all texels
    uint64_t zeroed; // number of texels that were negative or not finite, and became 0
    uint64_t hash;   // hash of the file and of the decoding parameters
};

static inline uint64_t texture_image_bytes(const struct texture_image *image)
{
    return (uint64_t)image->width * image->height * (image->values ? 4u : 16u);
}

// One use of an image by a material: the texture transform, and what the texels scale.
struct texture {
    uint32_t image;
    uint32_t flags;        // TEXTURE_* except those that the image determines
    float transform[2][3]; // s = row 0 . (u, v, 1), t = row 1 . (u, v, 1); t points down
};

static inline bool texture_is_scale(const struct texture *texture)
{
    return (texture->flags >> TEXTURE_USE_SHIFT & 3u) == TEXTURE_USE_SCALE;
}

// Returns the group of parameters that the texture scales, GROUP_*.
static inline uint32_t texture_group(const struct texture *texture)
{
    return texture->flags >> TEXTURE_GROUP_SHIFT & 15u;
}

// Returns whether the texture scales this parameter, PARAMETER_*; texture_channel returns the
// channel that does.
static inline bool texture_scales_parameter(const struct texture *texture, uint32_t parameter)
{
    return texture_is_scale(texture) && texture_group(texture) == parameter / 4 &&
           (texture->flags >> (TEXTURE_MASK_SHIFT + parameter % 4) & 1u);
}

static inline uint32_t texture_channel(const struct texture *texture, uint32_t parameter)
{
    return texture->flags >> (TEXTURE_CHANNELS_SHIFT + 2 * (parameter % 4)) & 3u;
}

extern const char *const light_kind_names[]; // "point" …, indexed by kind; ended by NULL

struct light {
    const char *name;
    uint32_t kind;                  // LIGHT_POINT, LIGHT_SPOT, LIGHT_DIRECTIONAL
    double position[3];             // point, spot
    double direction[3];            // spot, directional: unit vector in which light travels
    float radiant[3];               // point, spot: intensity, W/sr; directional: irradiance, W/m^2
    float range;                    // metres, > 0; INFINITY: unlimited
    float inner_angle, outer_angle; // spot: half-angles, radians, 0 <= inner < outer <= pi / 2
    double angular_radius;          // directional: the disc's, radians, <= pi / 2; 0: delta light
    // Point, spot: scales the intensity by direction (see ies.h); NULL: no profile. The vertical
    // angle is 0 along `direction`, for point lights too. The horizontal angle is 0 in the
    // half-plane of profile_x, a unit vector orthogonal to `direction`.
    const struct light_profile *profile;
    double profile_x[3];
    bool hidden; // omitted from the render
};

#endif
