// Materials, textures and lights of a scene, as plain data. Part of scene.h.
//
// A material is a model (MATERIAL_LAMBERT …), flags and parameters, numbered by PARAMETER_* of
// shaders/shared/material.h; the table material_parameters[] documents each and is what the scene
// format, its checks and its documentation are made from.
#ifndef LAMPYRIS_SCENE_CORE_SCENE_MATERIAL_H
#define LAMPYRIS_SCENE_CORE_SCENE_MATERIAL_H

#include "base/field.h"
#include "shared/material.h"
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

// Microfacets whose alpha, roughness^2, is below are a perfect mirror: what single precision still
// resolves of GGX's distribution. As SMALLEST_ALPHA of lib/microfacet.glsl.
#define MATERIAL_SMALLEST_ALPHA 1e-4f

struct material_parameter {
    const char *name;      // in scene files: "base_color"
    uint32_t first, count; // PARAMETER_*, 1 or 3 components
    float min, max;        // of each component
    float fallback;        // of each component, where a file says nothing
    uint32_t models;       // bit 1 << MATERIAL_*: the models that take it
    const char *help;      // one sentence, with the unit
};

extern const struct material_parameter material_parameters[];
extern const uint32_t material_parameter_count;
// "diffuse" …, by model; ended by NULL.
extern const char *const material_model_names[MATERIAL_MODEL_COUNT + 1];

struct material {
    const char *name; // never NULL; "" when the file gives none
    uint32_t model;   // MATERIAL_LAMBERT …
    uint32_t flags;   // MATERIAL_ALPHA_MASK …; NORMAL_MAP, MEDIUM and EMITS are derived at upload
    union {
        float parameters[PARAMETER_COUNT];
        struct { // the same by name
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
    uint32_t first_texture, texture_count; // in scene->textures
    // The medium inside of its closed surfaces, for models that transmit and are not thin.
    float extinction[3];      // 1/m; INFINITY is allowed: opaque but for distance 0
    uint32_t medium_priority; // 1 to 255, default 1; where media overlap the highest is there
};

_Static_assert(offsetof(struct material, dispersion) ==
                   offsetof(struct material, parameters[PARAMETER_DISPERSION]),
               "names and numbers of the parameters must agree");
_Static_assert(offsetof(struct material, alpha_cutoff) ==
                   offsetof(struct material, parameters[PARAMETER_ALPHA_CUTOFF]),
               "names and numbers of the parameters must agree");

// A material's flags, but for those that follow from other things at upload: a bit or a choice
// each, by the names of scene files ("alpha", "thin" …).
extern const struct field material_flags[];
extern const size_t material_flag_count;
const struct field *material_flag(const char *key); // one of these

// A grey Lambert surface with every parameter at its fallback.
void material_init(struct material *material);
// Absorption after Beer and Lambert from the colour that white light has `distance` metres (> 0)
// inside: -log(color) / distance; infinite where a channel is 0.
void material_set_absorption(struct material *material, const float color[3], float distance);
// The model that shades it: its own, but MATERIAL_LAMBERT where nothing else of it is left.
uint32_t material_shading_model(const struct material *material);
// CLASS_* that shades it.
uint32_t material_class(const struct material *material);
// The exponent of Phong's distribution of normals stands for a roughness by alpha_p = 2 / alpha^2 -
// 2 (Walter et al. 2007, section 5.2), alpha = roughness^2. It is INFINITY at roughness 0.
double material_phong_exponent(double roughness);
double material_phong_roughness(double exponent);
// Returns whether its surfaces bound a medium: it transmits, refracting or not, and is not
// thin-walled.
bool material_has_inside(const struct material *material);
// Returns whether it may emit light that can be sampled or hit: unlit ones are shown, not sampled.
bool material_emits(const struct material *material);

// Texels in memory, decoded to linear values: RGBA, four halves or four floats.
struct texture_image {
    const char *name;       // for messages
    uint32_t width, height; // at most 65535
    bool is_float;          // 16 bytes a texel, else 8
    bool has_alpha;         // some alpha is below 1
    bool is_missing;        // there is no such file: one texel of pink in its place
    const void *texels;     // row 0 at the top
    float mean[4];          // of all texels
    float greatest;         // component of all texels
    uint64_t zeroed;        // texels that were negative or not finite, and are black
    uint64_t hash;          // of the file's bytes and of how they were decoded
};

// One use of an image by a material: how it is read and what it does.
struct texture {
    uint32_t image;
    uint32_t flags;        // TEXTURE_* but TEXTURE_FLOAT
    float transform[2][3]; // s = row 0 . (u, v, 1), t = row 1 . (u, v, 1); t downwards from the top
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

// Returns whether it scales this parameter, PARAMETER_*; and which of its channels does.
static inline bool texture_scales_parameter(const struct texture *texture, uint32_t parameter)
{
    return texture_is_scale(texture) && texture_group(texture) == parameter / 4 &&
           (texture->flags >> (TEXTURE_MASK_SHIFT + parameter % 4) & 1u);
}

static inline uint32_t texture_channel(const struct texture *texture, uint32_t parameter)
{
    return texture->flags >> (TEXTURE_CHANNELS_SHIFT + 2 * (parameter % 4)) & 3u;
}

extern const char *const light_kind_names[]; // "point" …, by kind; ended by NULL

struct light {
    const char *name;
    uint32_t kind;                  // LIGHT_POINT, LIGHT_SPOT, LIGHT_DIRECTIONAL
    double position[3];             // point, spot
    double direction[3];            // unit, in which light travels: spot, directional
    float radiant[3];               // point, spot: intensity, W/sr; directional: irradiance, W/m^2
    float range;                    // metres, > 0; INFINITY: unlimited
    float inner_angle, outer_angle; // spot: half-angles, radians, 0 <= inner < outer <= pi / 2
    double angular_radius; // directional: of the sun it comes from, radians, to pi / 2; 0: a point
    // Point, spot: what scales the intensity by direction, see ies.h; or NULL. Its angle 0 is
    // `direction`, of a point light too, and its plane at 0 degrees that of profile_x, unit and
    // orthogonal to it.
    const struct light_profile *profile;
    double profile_x[3];
    bool hidden; // left out of the render
};

#endif
