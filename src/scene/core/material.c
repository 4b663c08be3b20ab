// Materials: the table of their parameters, and properties that are derived from them.
#include "scene/core/scene_material.h"

#include <math.h>
#include <string.h>

#define ONLY(model) (1u << (model))
#define ALL ((1u << MATERIAL_MODEL_COUNT) - 1u)
#define PRINCIPLED ONLY(MATERIAL_PRINCIPLED)
#define CLASSICAL (ONLY(MATERIAL_PHONG) | ONLY(MATERIAL_BLINN_PHONG) | ONLY(MATERIAL_MICROFACET))
#define MICROFACETS                                                                                \
    (PRINCIPLED | ONLY(MATERIAL_DIELECTRIC) | ONLY(MATERIAL_CONDUCTOR) | ONLY(MATERIAL_MICROFACET))

// Squares and sums of values up to this limit do not overflow in single precision; see
// SCENE_RADIANCE_MAX.
#define RADIANCE_MAX 1e30f
#define EXPONENT_MAX 1e6f

const struct material_parameter material_parameters[] = {
    {"base_color", PARAMETER_BASE_COLOR, 3, 0, 1, 0.5f,
     ALL & ~(ONLY(MATERIAL_DIELECTRIC) | ONLY(MATERIAL_CONDUCTOR)),
     "Reflectance of the diffuse part, of a mirror, or of a metal at normal incidence."},
    {"opacity", PARAMETER_OPACITY, 1, 0, 1, 1, ALL,
     "Probability that a ray hits the surface; needs \"alpha\"."},
    {"emission", PARAMETER_EMISSION, 3, 0, RADIANCE_MAX, 0, ALL,
     "Radiance emitted from both sides, W/(sr m^2)."},
    {"anisotropic", PARAMETER_ANISOTROPIC, 1, 0, 1, 0, PRINCIPLED,
     "Stretches highlights along the tangent: aspect = sqrt(1 - 0.9 anisotropic)."},
    {"roughness", PARAMETER_ROUGHNESS, 1, 0, 1, 0.5f, MICROFACETS,
     "Perceptual roughness; alpha = roughness^2, and 0 is perfectly specular."},
    {"metallic", PARAMETER_METALLIC, 1, 0, 1, 0, PRINCIPLED,
     "Blends from a dielectric (0) to a metal (1)."},
    {"anisotropic_rotation", PARAMETER_ANISOTROPIC_ROTATION, 1, -1, 1, 0, PRINCIPLED,
     "Rotates the tangent counter-clockwise; 1 is a full turn."},
    {"specular_color", PARAMETER_SPECULAR_COLOR, 3, 0, 1e3f, 1, PRINCIPLED | CLASSICAL,
     "Scales the reflectance at normal incidence; the specular reflectance of the classical "
     "models."},
    {"specular_weight", PARAMETER_SPECULAR_WEIGHT, 1, 0, 1, 1, PRINCIPLED,
     "Scales all of the dielectric's specular reflection, at grazing incidence too (glTF)."},
    {"transmission", PARAMETER_TRANSMISSION, 1, 0, 1, 0, PRINCIPLED,
     "Blends the dielectric from opaque (0) to transmitting (1)."},
    {"ior", PARAMETER_IOR, 1, 0.01f, 100, 1.5f,
     PRINCIPLED | ONLY(MATERIAL_DIELECTRIC) | ONLY(MATERIAL_MICROFACET),
     "Index of refraction against vacuum."},
    {"specular", PARAMETER_SPECULAR, 1, 0, 1, 0.5f, PRINCIPLED,
     "Scales the ior's reflectance at normal incidence by 2 specular (Burley; 0.5: unchanged)."},
    {"specular_tint", PARAMETER_SPECULAR_TINT, 1, 0, 1, 0, PRINCIPLED,
     "Tints reflection at normal incidence towards the base colour."},
    {"clearcoat", PARAMETER_CLEARCOAT, 1, 0, 1, 0, PRINCIPLED, "Weight of the coat."},
    {"clearcoat_roughness", PARAMETER_CLEARCOAT_ROUGHNESS, 1, 0, 1, 0, PRINCIPLED,
     "Perceptual roughness of a GGX coat (glTF); setting it selects that coat."},
    {"clearcoat_gloss", PARAMETER_CLEARCOAT_GLOSS, 1, 0, 1, 1, PRINCIPLED,
     "Gloss of Burley's coat (GTR1), from satin (0) to glossy (1)."},
    {"normal_scale", PARAMETER_NORMAL_SCALE, 1, -1e3f, 1e3f, 1, ALL,
     "Scales x and y of the normal map."},
    {"sheen_color", PARAMETER_SHEEN_COLOR, 3, 0, 1, 0, PRINCIPLED,
     "Reflectance of the layer of fibres (glTF, Charlie)."},
    {"sheen_roughness", PARAMETER_SHEEN_ROUGHNESS, 1, 0, 1, 0, PRINCIPLED,
     "Perceptual roughness of the layer of fibres."},
    {"subsurface", PARAMETER_SUBSURFACE, 1, 0, 1, 0, PRINCIPLED,
     "Blends the diffuse part towards Burley's approximation of subsurface scattering."},
    {"sheen", PARAMETER_SHEEN, 1, 0, 1, 0, PRINCIPLED, "Burley's grazing reflection of cloth."},
    {"sheen_tint", PARAMETER_SHEEN_TINT, 1, 0, 1, 0.5f, PRINCIPLED,
     "Tints the sheen towards the base colour."},
    {"diffuse_transmission", PARAMETER_DIFFUSE_TRANSMISSION, 1, 0, 1, 0, PRINCIPLED,
     "Fraction of the diffuse light that leaves on the other side (thin-walled only)."},
    {"iridescence", PARAMETER_IRIDESCENCE, 1, 0, 1, 0, PRINCIPLED, "Weight of the thin film."},
    {"film_thickness", PARAMETER_FILM_THICKNESS, 1, 0, 1e6f, 400, PRINCIPLED,
     "Thickness of the film, nm."},
    {"film_ior", PARAMETER_FILM_IOR, 1, 1, 100, 1.3f, PRINCIPLED,
     "Index of refraction of the film."},
    {"dispersion", PARAMETER_DISPERSION, 1, 0, 10, 0, PRINCIPLED | ONLY(MATERIAL_DIELECTRIC),
     "Dispersion: 20 / Abbe number."},
    {"conductor_eta", PARAMETER_CONDUCTOR_ETA, 3, 1e-3f, 100, 0.2f, ONLY(MATERIAL_CONDUCTOR),
     "Real part of the index of refraction, for red, green and blue."},
    {"exponent", PARAMETER_EXPONENT, 1, 0, EXPONENT_MAX, 32,
     ONLY(MATERIAL_PHONG) | ONLY(MATERIAL_BLINN_PHONG),
     "Exponent of the cosine; \"smoothness\" s in [0, 1] sets it to 1000^(s^2)."},
    {"conductor_k", PARAMETER_CONDUCTOR_K, 3, 0, 100, 3.9f, ONLY(MATERIAL_CONDUCTOR),
     "Imaginary part of the index of refraction, for red, green and blue."},
    {"alpha_cutoff", PARAMETER_ALPHA_CUTOFF, 1, 0, 1e3f, 0.5f, ALL,
     "With \"alpha\": \"mask\", the least opacity at which the surface is present."},
};
const uint32_t material_parameter_count = sizeof material_parameters / sizeof *material_parameters;

const char *const material_model_names[MATERIAL_MODEL_COUNT + 1] = {
    [MATERIAL_LAMBERT] = "diffuse",         [MATERIAL_MIRROR] = "mirror",
    [MATERIAL_PRINCIPLED] = "principled",   [MATERIAL_DIELECTRIC] = "dielectric",
    [MATERIAL_CONDUCTOR] = "conductor",     [MATERIAL_PHONG] = "phong",
    [MATERIAL_BLINN_PHONG] = "blinn_phong", [MATERIAL_MICROFACET] = "microfacet",
};

#define FLAGS(key_, mask_) .key = key_, FIELD_OF(material, flags), .mask = mask_
#define CHOICE(...)                                                                                \
    .type = FIELD_CHOICE, .words = (const char *const[])                                           \
    {                                                                                              \
        __VA_ARGS__, NULL                                                                          \
    }

const struct field material_flags[] = {
    {FLAGS("alpha", MATERIAL_ALPHA_MASK | MATERIAL_ALPHA_BLEND), CHOICE("opaque", "mask", "blend")},
    {FLAGS("coat", MATERIAL_COAT_GGX), CHOICE("burley", "ggx")},
    {FLAGS("layers", MATERIAL_GLTF_LAYERS), CHOICE("burley", "gltf")},
    {FLAGS("distribution", 3u << MATERIAL_DISTRIBUTION_SHIFT),
     CHOICE([DISTRIBUTION_GGX] = "ggx", [DISTRIBUTION_BECKMANN] = "beckmann",
            [DISTRIBUTION_PHONG] = "phong")},
    {FLAGS("masking", 7u << MATERIAL_MASKING_SHIFT),
     CHOICE([MASKING_SMITH] = "smith", [MASKING_SCHLICK_GGX] = "schlick_ggx", [MASKING_LH] = "lh",
            [MASKING_RATIONAL] = "rational", [MASKING_SCHLICK] = "schlick",
            [MASKING_SCHLICK_REMAPPED] = "schlick_remapped",
            [MASKING_RATIONAL_UNBOUNDED] = "rational_unbounded")},
    {FLAGS("fresnel", MATERIAL_EXACT_FRESNEL), CHOICE("schlick", "exact")},
    {FLAGS("diffuse", MATERIAL_UNCOUPLED), CHOICE("coupled", "uncoupled")},
    {FLAGS("specular_fresnel", MATERIAL_MIXED_FRESNEL), CHOICE("shifted", "mixed")},
    {FLAGS("coat_fresnel", MATERIAL_EXACT_COAT), CHOICE("schlick", "exact")},
    {FLAGS("thin", MATERIAL_THIN)},
    {FLAGS("unlit", MATERIAL_UNLIT)},
    {FLAGS("compensate", MATERIAL_COMPENSATE)},
    {FLAGS("tint_each", MATERIAL_TINT_EACH)},
    {FLAGS("separable", MATERIAL_SEPARABLE)},
};
const size_t material_flag_count = sizeof material_flags / sizeof *material_flags;

const struct field *material_flag(const char *key)
{
    const struct field *field = material_flags;
    while (strcmp(field->key, key) != 0)
        field++;
    return field;
}

void material_init(struct material *material)
{
    *material = (struct material){
        .name = "",
        .model = MATERIAL_LAMBERT,
        .flags = MATERIAL_COMPENSATE,
        .medium_priority = 1,
    };
    for (uint32_t i = 0; i < material_parameter_count; i++)
        for (uint32_t c = 0; c < material_parameters[i].count; c++)
            material->parameters[material_parameters[i].first + c] =
                material_parameters[i].fallback;
}

void material_set_absorption(struct material *material, const float color[3], float distance)
{
    for (int c = 0; c < 3; c++)
        material->extinction[c] = color[c] < 1.0f ? -logf(color[c]) / distance : 0.0f;
}

// Textures only scale parameters down, so a parameter that is 0 stays 0.
static bool transmits(const struct material *material)
{
    return material->model == MATERIAL_DIELECTRIC ||
           (material->model == MATERIAL_PRINCIPLED &&
            (material->parameters[PARAMETER_TRANSMISSION] > 0.0f ||
             material->parameters[PARAMETER_DIFFUSE_TRANSMISSION] > 0.0f));
}

uint32_t material_shading_model(const struct material *material)
{
    // These parameters would add lobes to glTF's diffuse base, or weaken it.
    static const uint32_t others[] = {PARAMETER_METALLIC,        PARAMETER_SPECULAR_WEIGHT,
                                      PARAMETER_TRANSMISSION,    PARAMETER_CLEARCOAT,
                                      PARAMETER_SHEEN_COLOR,     PARAMETER_SHEEN_COLOR + 1,
                                      PARAMETER_SHEEN_COLOR + 2, PARAMETER_SHEEN,
                                      PARAMETER_SUBSURFACE,      PARAMETER_DIFFUSE_TRANSMISSION};
    if (material->model != MATERIAL_PRINCIPLED || !(material->flags & MATERIAL_GLTF_LAYERS))
        return material->model;
    for (size_t i = 0; i < sizeof others / sizeof *others; i++)
        if (material->parameters[others[i]] > 0.0f)
            return MATERIAL_PRINCIPLED;
    return MATERIAL_LAMBERT;
}

uint32_t material_class(const struct material *material)
{
    switch (material_shading_model(material)) {
    case MATERIAL_LAMBERT:
    case MATERIAL_MIRROR:
        return CLASS_DIFFUSE;
    case MATERIAL_PRINCIPLED:
    case MATERIAL_DIELECTRIC:
        return transmits(material) ? CLASS_TRANSMISSIVE : CLASS_PRINCIPLED;
    default:
        return CLASS_CLASSICAL;
    }
}

double material_phong_exponent(double roughness)
{
    double alpha = roughness * roughness;
    return 2.0 / (alpha * alpha) - 2.0;
}

double material_phong_roughness(double exponent)
{
    return pow(2.0 / (exponent + 2.0), 0.25);
}

bool material_has_inside(const struct material *material)
{
    bool through = material->model == MATERIAL_DIELECTRIC ||
                   (material->model == MATERIAL_PRINCIPLED &&
                    material->parameters[PARAMETER_TRANSMISSION] > 0.0f);
    return through && !(material->flags & MATERIAL_THIN);
}

bool material_emits(const struct material *material)
{
    const float *emission = &material->parameters[PARAMETER_EMISSION];
    return emission[0] > 0.0f || emission[1] > 0.0f || emission[2] > 0.0f;
}
