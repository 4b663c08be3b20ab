#include "specialize.h"

#include "shared/types.h"

// lavapipe's loops silently end after 65,535 rounds of all loops of one subgroup together. Rounds
// are counted a lane; a subgroup of n lanes does at most n times as many as its busiest lane
// counts, so each lane may have 1/n of them, with an eighth kept for the loops around the
// traversal.
#define CPU_SUBGROUP_ROUNDS 57344u
// On GPUs nothing ends silently, but a watchdog may: about 100 ms of one ray's work.
#define GPU_LANE_ROUNDS 500000u

static bool emits(const struct material *material)
{
    return material->emission[0] > 0.0f || material->emission[1] > 0.0f ||
           material->emission[2] > 0.0f;
}

struct emitter_counts emitters_count(const struct scene *scene, const struct flat_scene *flat)
{
    struct emitter_counts counts = {0};
    for (uint32_t i = 0; i < flat->triangle_count; i++)
        counts.triangles += emits(&scene->materials[flat->triangles[i].material]);
    for (uint32_t i = 0; i < flat->shape_count; i++) {
        if (!emits(&scene->materials[flat->shapes[i].material]))
            continue;
        if (flat->shapes[i].kind == SHAPE_SPHERE)
            counts.spheres++;
        else
            counts.discs++;
    }
    return counts;
}

static uint32_t geometry_features(const struct scene *scene, const struct flat_scene *flat)
{
    uint32_t features = flat->triangle_count ? FEATURE_TRIANGLES : 0u;
    features |= flat->normals ? FEATURE_NORMALS : 0u;
    for (uint32_t i = 0; i < flat->shape_count; i++)
        features |= flat->shapes[i].kind == SHAPE_SPHERE ? FEATURE_SPHERES : FEATURE_DISCS;
    // Materials that no primitive uses are not needed.
    for (uint32_t i = 0; i < flat->triangle_count + flat->shape_count; i++) {
        uint32_t material = i < flat->triangle_count
                                ? flat->triangles[i].material
                                : flat->shapes[i - flat->triangle_count].material;
        features |=
            scene->materials[material].type == MATERIAL_MIRROR ? FEATURE_MIRROR : FEATURE_DIFFUSE;
    }
    return features;
}

static uint32_t light_features(const struct scene *scene, const struct flat_scene *flat,
                               uint32_t geometry)
{
    const struct settings *settings = &scene->settings;
    struct emitter_counts emitters = emitters_count(scene, flat);
    uint32_t features = 0;
    features |= emitters.triangles ? FEATURE_EMISSIVE_TRIANGLES : 0u;
    features |= emitters.spheres ? FEATURE_EMISSIVE_SPHERES : 0u;
    features |= emitters.discs ? FEATURE_EMISSIVE_DISCS : 0u;
    if (features)
        features |= FEATURE_EMISSION;
    bool can_connect = features && (geometry & FEATURE_DIFFUSE) && settings->max_bounces > 0;
    if (can_connect && settings->estimator != ESTIMATOR_BSDF)
        features |= FEATURE_NEE;
    if (settings->estimator != ESTIMATOR_NEE)
        features |= FEATURE_BSDF_HITS_EMITTERS;
    if (scene->environment.present) {
        features |= FEATURE_ENVIRONMENT;
        features |= scene->environment.width ? FEATURE_ENVIRONMENT_IMAGE : 0u;
    }
    return features;
}

// What compiling in changes nothing but the time: what it would add is zero, or never met.
static uint32_t harmless_features(const struct settings *settings)
{
    uint32_t features =
        FEATURE_TRIANGLES | FEATURE_SPHERES | FEATURE_DISCS | FEATURE_NORMALS | FEATURE_DIFFUSE |
        FEATURE_MIRROR | FEATURE_EMISSION | FEATURE_EMISSIVE_TRIANGLES | FEATURE_EMISSIVE_SPHERES |
        FEATURE_EMISSIVE_DISCS | FEATURE_ENVIRONMENT | FEATURE_ENVIRONMENT_IMAGE | FEATURE_ROULETTE;
    if (settings->estimator != ESTIMATOR_BSDF)
        features |= FEATURE_NEE;
    return features;
}

static uint32_t device_features(const struct gpu *gpu, const struct flat_scene *flat,
                                const struct bvh *bvh, const struct environment *environment)
{
    uint32_t features = gpu->has_ballot ? FEATURE_BALLOT : 0u;
    // Measured on lavapipe: texel fetches are three times as fast as storage-buffer reads.
    // Elsewhere storage buffers are the reference path.
    if (!gpu->info.is_cpu)
        return features;
    uint64_t environment_bytes = (uint64_t)environment->width * environment->height * 16;
    if (gpu_texel_fits(gpu, (uint64_t)bvh->node_count * sizeof(struct bvh_node)) &&
        gpu_texel_fits(gpu, (uint64_t)flat->triangle_count * sizeof(struct gpu_triangle)) &&
        gpu_texel_fits(gpu, environment_bytes))
        features |= FEATURE_TEXEL_SCENE;
    // The least that Vulkan guarantees still gives a wave of 16,384 paths; below, the wave matters
    // more than the way it is read.
    if (gpu->max_texel_elements >= 65536)
        features |= FEATURE_TEXEL_STATE;
    return features;
}

struct specialization specialize(const struct scene *scene, const struct flat_scene *flat,
                                 const struct bvh *bvh, const struct gpu *gpu, bool everything)
{
    const struct settings *settings = &scene->settings;
    struct specialization s = {
        .workgroup = gpu->info.is_cpu ? 128 : 64,
        .stack_entries = bvh->stats.stack_entries,
        .iteration_budget =
            gpu->info.is_cpu ? CPU_SUBGROUP_ROUNDS / gpu->subgroup_size : GPU_LANE_ROUNDS,
        .interleave = gpu->info.is_cpu ? 16 : 1,
    };
    s.features = geometry_features(scene, flat);
    s.features |= light_features(scene, flat, s.features);
    if (settings->roulette_min_bounces < settings->max_bounces)
        s.features |= FEATURE_ROULETTE;
    if (everything)
        s.features |= harmless_features(settings);
    if (settings->pixel_jitter)
        s.features |= FEATURE_JITTER;
    s.features |= device_features(gpu, flat, bvh, &scene->environment);
    return s;
}

bool specialization_needs_kernel(const struct specialization *s, enum kernel_id id)
{
    switch (id) {
    case KERNEL_shade_miss:
        return s->features & FEATURE_ENVIRONMENT;
    case KERNEL_shade_surface:
        return s->features & (FEATURE_TRIANGLES | FEATURE_SPHERES | FEATURE_DISCS);
    case KERNEL_intersect_closest:
        // Without surfaces every ray is a miss, found by the same kernel in an empty tree; without
        // an environment either, nothing can be seen.
        return s->features &
               (FEATURE_TRIANGLES | FEATURE_SPHERES | FEATURE_DISCS | FEATURE_ENVIRONMENT);
    case KERNEL_intersect_shadow:
        return s->features & FEATURE_NEE;
    default:
        return true;
    }
}

bool specialization_needs_binding(const struct specialization *s, uint32_t binding)
{
    uint32_t shapes = FEATURE_SPHERES | FEATURE_DISCS;
    switch (binding) {
    case BINDING_TRIANGLES:
        return s->features & FEATURE_TRIANGLES;
    case BINDING_NORMALS:
        return s->features & FEATURE_NORMALS;
    case BINDING_SHAPES:
        return s->features & shapes;
    case BINDING_MATERIALS:
        return s->features & (FEATURE_TRIANGLES | shapes);
    case BINDING_EMITTERS:
    case BINDING_SHADOW_RAYS:
        return s->features & FEATURE_NEE;
    case BINDING_ENVIRONMENT:
        return s->features & FEATURE_ENVIRONMENT_IMAGE;
    case BINDING_SUSPENDED:
        return s->features & FEATURE_SUSPEND;
    default:
        return binding < BINDING_COUNT;
    }
}

const char *feature_name(uint32_t bit)
{
    switch (bit) {
    case FEATURE_TRIANGLES:
        return "triangles";
    case FEATURE_SPHERES:
        return "spheres";
    case FEATURE_DISCS:
        return "discs";
    case FEATURE_NORMALS:
        return "shading normals";
    case FEATURE_DIFFUSE:
        return "diffuse surfaces";
    case FEATURE_MIRROR:
        return "mirrors";
    case FEATURE_EMISSION:
        return "emission";
    case FEATURE_EMISSIVE_TRIANGLES:
        return "emissive triangles";
    case FEATURE_EMISSIVE_SPHERES:
        return "emissive spheres";
    case FEATURE_EMISSIVE_DISCS:
        return "emissive discs";
    case FEATURE_NEE:
        return "next-event estimation";
    case FEATURE_BSDF_HITS_EMITTERS:
        return "emitters hit by BSDF sampling";
    case FEATURE_ENVIRONMENT:
        return "environment";
    case FEATURE_ENVIRONMENT_IMAGE:
        return "environment image";
    case FEATURE_ROULETTE:
        return "Russian roulette";
    case FEATURE_JITTER:
        return "pixel jitter";
    default:
        return NULL;
    }
}
