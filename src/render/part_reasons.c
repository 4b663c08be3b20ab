// Explains why parts of a renderer are left out. specialize() makes the decisions.
#include "render/parts.h"

struct reason {
    uint32_t bit;
    const char *words;
};

static const char *find(const struct reason *reasons, uint32_t count, uint32_t bit)
{
    for (uint32_t i = 0; i < count; i++)
        if (reasons[i].bit == bit)
            return reasons[i].words;
    return "the scene has none";
}

#define FIND(reasons, bit) find(reasons, sizeof(reasons) / sizeof *(reasons), bit)

// Returns why an integrator other than path and direct does not use a part, or NULL.
static const char *integrator_reason(const struct renderer *r)
{
    switch (r->specialization.integrator) {
    case INTEGRATOR_AO:
        return "--integrator ao uses no materials and no lights";
    case INTEGRATOR_WHITTED:
        return "the scene has none, or --integrator whitted does not use it";
    default:
        return NULL;
    }
}

// --- features ------------------------------------------------------------------------------------

static const char *nee_reason(const struct renderer *r)
{
    const struct settings *settings = &r->scene->settings;
    if (!settings->nee || settings->nee_depth == 0)
        return settings->nee ? "--nee-depth 0" : "--nee off";
    if (settings->max_bounces == 0)
        return "--max-bounces 0";
    return r->specialization.emitters ? "all surfaces are perfectly specular"
                                      : "no emitter can be sampled by shadow rays";
}

static const char *nee_depth_reason(const struct renderer *r)
{
    return r->specialization.features & FEATURE_NEE ? "shadow rays are sent at every depth"
                                                    : "no shadow rays are sent";
}

static const char *class_reason(const struct renderer *r)
{
    uint32_t classes = 0;
    for (uint32_t c = 0; c < CLASS_COUNT; c++)
        classes += r->specialization.class_lobes[c] != 0;
    return classes > 1 ? "--classes merged" : "all surfaces are of one class";
}

static const char *roulette_reason(const struct renderer *r)
{
    return r->scene->settings.roulette == ROULETTE_OFF
               ? "--roulette off"
               : "--roulette-min-bounces is not below --max-bounces";
}

static const char *feature_reason(const struct renderer *r, uint32_t bit)
{
    static const struct reason reasons[] = {
        {FEATURE_TRIANGLES, "the scene has no mesh"},
        {FEATURE_NORMALS, "no mesh has normals at its vertices"},
        {FEATURE_FAR_CAMERA, "the camera is near the scene"},
        {FEATURE_LENS, "the camera is a pinhole (--aperture)"},
        {FEATURE_EMISSION, "no surface emits"},
        {FEATURE_CLAMP, "nothing is clamped (--clamp)"},
        {FEATURE_MIN_DENSITY, "no path ends at a low density (--min-density)"},
        {FEATURE_SPLIT_LOBES, "paths do not split (--split-lobes)"},
        {FEATURE_BSDF_HITS_EMITTERS, "--mis none"},
        {FEATURE_ENVIRONMENT, "the scene has no environment"},
        {FEATURE_ENVIRONMENT_IMAGE, "the environment is not an image"},
        {FEATURE_JITTER, "all samples are at the pixels' centres"},
        {FEATURE_TEXTURES, "no material has a texture"},
        {FEATURE_TEXELS_FLOAT, "no texture has 32-bit floats"},
        {FEATURE_TEXELS_CODES, "no texture has 8 bits per channel"},
        {FEATURE_UV0, "no material reads texture coordinates"},
        {FEATURE_UV1, "no material reads a second set of texture coordinates"},
        {FEATURE_TANGENTS, "no material reads tangents"},
        {FEATURE_COLORS, "no mesh has colors at its vertices"},
        {FEATURE_ALPHA, "no material has an opacity below 1"},
        {FEATURE_MEDIA, "no surface bounds a medium"},
        {FEATURE_NORMAL_MAPS, "no material has a normal map"},
        {FEATURE_TILES, "--adaptive off"},
    };
    const char *integrator = integrator_reason(r);
    const uint32_t of_materials = FEATURE_TEXTURES | FEATURE_TEXELS_FLOAT | FEATURE_TEXELS_CODES |
                                  FEATURE_UV0 | FEATURE_UV1 | FEATURE_TANGENTS | FEATURE_COLORS |
                                  FEATURE_ALPHA | FEATURE_MEDIA | FEATURE_NORMAL_MAPS |
                                  FEATURE_EMISSION | FEATURE_CLASSES | FEATURE_ROULETTE |
                                  FEATURE_NEE_DEPTH | FEATURE_MIN_DENSITY | FEATURE_SPLIT_LOBES |
                                  FEATURE_BSDF_HITS_EMITTERS | FEATURE_ENVIRONMENT_IMAGE;
    if (integrator && (bit & of_materials))
        return integrator;
    switch (bit) {
    case FEATURE_NEE:
        return nee_reason(r);
    case FEATURE_NEE_DEPTH:
        return nee_depth_reason(r);
    case FEATURE_CLASSES:
        return class_reason(r);
    case FEATURE_ROULETTE:
        return roulette_reason(r);
    default:
        return FIND(reasons, bit);
    }
}

static const char *geometry_reason(uint32_t bit)
{
    static const struct reason reasons[] = {
        {GEOMETRY_LARGE_SPHERES, "no sphere is much larger than its visible part"},
        {GEOMETRY_INSTANCES, "no mesh is shared by instances (--instances)"},
        {GEOMETRY_SMALL_TRIANGLES, "no emissive triangle is too small for single precision"},
        {GEOMETRY_DUPLICATES, "no triangle was split (--bvh spatial)"},
    };
    return FIND(reasons, bit);
}

static const char *emitter_reason(const struct renderer *r, uint32_t bit)
{
    static const struct reason reasons[] = {
        {EMITTER_PROFILES, "no light has a profile"},
        {EMITTER_ENVIRONMENT,
         "the environment is not an image with light, or no shadow rays are sent"},
    };
    const char *integrator = integrator_reason(r);
    return integrator ? integrator : FIND(reasons, bit);
}

// --- kernels and buffers -------------------------------------------------------------------------

static const char *surface_kernel_reason(const struct renderer *r, uint32_t kernel)
{
    const struct specialization *s = &r->specialization;
    if (s->integrator == INTEGRATOR_AO || s->integrator == INTEGRATOR_WHITTED)
        return "the --integrator has its own shading kernel";
    if (!(s->features & FEATURE_TRIANGLES) && !s->geometry)
        return "the scene has no surface";
    if (kernel == KERNEL_shade_surface)
        return "each class of surfaces has its own kernel";
    return s->features & FEATURE_CLASSES ? "no surface is of this class"
                                         : "shade_surface shades all surfaces";
}

static const char *kernel_reason(const struct renderer *r, uint32_t kernel)
{
    bool is_whitted = r->specialization.integrator == INTEGRATOR_WHITTED;
    switch (kernel) {
    case KERNEL_shade_miss:
        return is_whitted ? "shade_whitted also shades misses" : "the scene has no environment";
    case KERNEL_intersect_closest:
        return "the scene has neither a surface nor an environment";
    case KERNEL_intersect_shadow:
        return "no shadow rays are sent";
    case KERNEL_generate_light_rays:
    case KERNEL_shade_light:
    case KERNEL_intersect_camera:
    case KERNEL_add_splats:
        return r->scene->settings.integrator == INTEGRATOR_BIDIR
                   ? "no shadow rays are sent, so that light paths have nothing to add"
               : r->why_path ? r->why_path
                             : "--integrator is not bidir";
    case KERNEL_shade_ao:
        return "--integrator is not ao, or the scene is empty";
    case KERNEL_shade_whitted:
        return "--integrator is not whitted, or the scene is empty";
    default:
        return surface_kernel_reason(r, kernel);
    }
}

static const char *buffer_reason(uint32_t binding)
{
    static const struct reason reasons[] = {
        {BINDING_TRIANGLES, "the scene has no mesh"},
        {BINDING_ATTRIBUTES, "no triangle has vertex attributes"},
        {BINDING_SHAPES, "the scene has no shapes, no instances and no small lamps"},
        {BINDING_MATERIALS, "no kernel reads materials"},
        {BINDING_EMITTERS, "no shadow ray selects an emitter"},
        {BINDING_TEXELS, "no material has a texture"},
        {BINDING_SHADOW_RAYS, "no shadow rays are sent"},
        {BINDING_ENVIRONMENT, "the environment is not an image"},
        {BINDING_SORT, "rays are not sorted"},
        {BINDING_SUSPENDED, "no ray has exceeded its iteration budget"},
    };
    return FIND(reasons, binding);
}

const char *part_reason(const struct renderer *r, const struct part *part)
{
    const char *integrator = integrator_reason(r);
    switch (part->kind) {
    case PART_FEATURE:
        return feature_reason(r, part->id);
    case PART_GEOMETRY:
        return geometry_reason(part->id);
    case PART_SPLIT_BUFFERS:
        return "no buffer exceeds the device's limit";
    case PART_LOBE:
        return integrator ? integrator : "no material in use has it";
    case PART_EMITTER:
        return emitter_reason(r, part->id);
    case PART_KERNEL:
        return kernel_reason(r, part->id);
    default:
        return buffer_reason(part->id);
    }
}
