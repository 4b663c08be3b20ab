#include "render/specialize.h"

#include "flatten/large_spheres.h"
#include "render/attributes.h"
#include "render/far_camera.h"
#include "render/film_aovs.h"
#include "render/tables/emitters.h"
#include "render/tables/environment_table.h"
#include "render/tables/light_choice.h"
#include "shared/sdf.h"
#include "shared/types.h"
#include <string.h>

// lavapipe silently ends the loops of a subgroup after 65,535 iterations of all its loops together.
// The kernels count iterations by lane: n lanes together do at most n times as many as the busiest
// lane. So each lane may have 1/n of the total, of which an eighth is reserved for the loops around
// the traversal.
#define CPU_SUBGROUP_ROUNDS 57344u
// On GPUs no loop ends silently, but a watchdog may end the work. This number of iterations takes
// one ray about 100 ms.
#define GPU_LANE_ROUNDS 500000u

static uint32_t lobe_if(const struct material *material, uint32_t parameter, uint32_t lobe)
{
    return material->parameters[parameter] > 0.0f ? lobe : 0u;
}

static uint32_t roughness_lobes(const struct scene *scene, const struct material *material,
                                uint32_t parameter)
{
    float roughness = material->parameters[parameter];
    bool is_rough = roughness * roughness >= MATERIAL_SMALLEST_ALPHA;
    if (scene_parameter_is_textured(scene, material, parameter))
        return LOBE_ROUGH | LOBE_DELTA;
    return is_rough ? LOBE_ROUGH : LOBE_DELTA;
}

static uint32_t principled_lobes(const struct scene *scene, const struct material *m)
{
    uint32_t lobes = LOBE_PRINCIPLED | roughness_lobes(scene, m, PARAMETER_ROUGHNESS);
    lobes |= m->flags & MATERIAL_GLTF_LAYERS ? LOBE_GLTF : LOBE_BURLEY;
    lobes |= m->flags & MATERIAL_MIXED_FRESNEL ? LOBE_MIXED_FRESNEL : 0u;
    lobes |= lobe_if(m, PARAMETER_METALLIC, LOBE_METAL);
    lobes |= lobe_if(m, PARAMETER_SUBSURFACE, LOBE_SUBSURFACE);
    lobes |= lobe_if(m, PARAMETER_SHEEN, LOBE_SHEEN);
    for (uint32_t c = 0; c < 3; c++)
        lobes |= lobe_if(m, PARAMETER_SHEEN_COLOR + c, LOBE_CHARLIE);
    if (m->clearcoat > 0.0f) {
        lobes |= LOBE_CLEARCOAT;
        lobes |= m->flags & MATERIAL_EXACT_COAT ? LOBE_EXACT_COAT : 0u;
        lobes |= m->flags & MATERIAL_COAT_GGX
                     ? roughness_lobes(scene, m, PARAMETER_CLEARCOAT_ROUGHNESS)
                     : LOBE_ROUGH;
    }
    lobes |= lobe_if(m, PARAMETER_TRANSMISSION, LOBE_TRANSMISSION);
    lobes |= lobe_if(m, PARAMETER_ANISOTROPIC, LOBE_ANISOTROPIC);
    lobes |= lobe_if(m, PARAMETER_IRIDESCENCE, LOBE_IRIDESCENCE);
    lobes |= lobe_if(m, PARAMETER_DISPERSION, LOBE_DISPERSION);
    lobes |= lobe_if(m, PARAMETER_DIFFUSE_TRANSMISSION, LOBE_DIFFUSE_TRANSMISSION);
    return lobes;
}

static uint32_t microfacet_lobes(const struct material *m)
{
    bool is_further = (m->flags >> MATERIAL_MASKING_SHIFT & 7u) >= MASKING_SCHLICK;
    return LOBE_MICROFACET | (is_further ? LOBE_MASKINGS : 0u) |
           (m->flags & MATERIAL_UNCOUPLED ? LOBE_UNCOUPLED : 0u);
}

// Returns the lobes of lib/bsdf.glsl that shading a material needs.
static uint32_t material_lobes(const struct scene *scene, const struct material *m)
{
    uint32_t lobes = m->flags & MATERIAL_THIN ? LOBE_THIN : 0u;
    lobes |= m->flags & MATERIAL_SEPARABLE ? LOBE_SEPARABLE : 0u;
    switch (material_shading_model(m)) {
    case MATERIAL_LAMBERT:
        return LOBE_LAMBERT;
    case MATERIAL_MIRROR:
        return LOBE_MIRROR;
    case MATERIAL_PRINCIPLED:
        lobes |= m->flags & MATERIAL_COMPENSATE ? LOBE_COMPENSATE : 0u;
        return lobes | principled_lobes(scene, m);
    case MATERIAL_DIELECTRIC:
        lobes |= lobe_if(m, PARAMETER_DISPERSION, LOBE_DISPERSION);
        lobes |= LOBE_DIELECTRIC | roughness_lobes(scene, m, PARAMETER_ROUGHNESS);
        return lobes |
               (lobes & LOBE_ROUGH && m->flags & MATERIAL_COMPENSATE ? LOBE_COMPENSATE : 0u);
    case MATERIAL_CONDUCTOR:
        lobes |= m->flags & MATERIAL_COMPENSATE ? LOBE_COMPENSATE : 0u;
        return lobes | LOBE_CONDUCTOR | roughness_lobes(scene, m, PARAMETER_ROUGHNESS);
    case MATERIAL_PHONG:
        return LOBE_PHONG;
    case MATERIAL_BLINN_PHONG:
        return LOBE_BLINN_PHONG;
    default:
        return (lobes & LOBE_SEPARABLE) | microfacet_lobes(m) |
               roughness_lobes(scene, m, PARAMETER_ROUGHNESS);
    }
}

// Lobes that can be evaluated for the direction to an emitter: all but delta lobes.
#define LOBES_CONNECTING                                                                           \
    (LOBE_LAMBERT | LOBE_PRINCIPLED | LOBE_PHONG | LOBE_BLINN_PHONG | LOBE_MICROFACET | LOBE_ROUGH)

static uint32_t geometry_features(const struct flat_scene *flat)
{
    uint32_t features = flat->triangle_count ? FEATURE_TRIANGLES : 0u;
    features |= flat->normals ? FEATURE_NORMALS : 0u;
    features |= flat->tangents ? FEATURE_TANGENTS : 0u;
    features |= flat->uvs[0] ? FEATURE_UV0 : 0u;
    features |= flat->uvs[1] ? FEATURE_UV1 : 0u;
    features |= flat->colors ? FEATURE_COLORS : 0u;
    return features;
}

_Static_assert(SHAPE_KIND_COUNT == 8 && 1u << SHAPE_SDF == GEOMETRY_SDFS, "bit n is kind n");

// Returns GEOMETRY_*: the kinds of primitives in the scene other than triangles.
static uint32_t geometry_of(const struct flat_scene *flat, const struct bvh *bvh)
{
    uint32_t geometry = flat->placed_count ? GEOMETRY_INSTANCES : 0u;
    geometry |= bvh->reference_count > bvh->triangle_count ? GEOMETRY_DUPLICATES : 0u;
    geometry |= flat->small_count ? GEOMETRY_SMALL_TRIANGLES : 0u;
    for (uint32_t i = 0; i < flat->shape_count; i++)
        geometry |= 1u << flat->shapes[i].kind;
    return geometry;
}

static uint32_t field_operations(const struct sdf *sdf)
{
    uint32_t operations = 0;
    for (uint32_t k = 0; k < sdf->count; k++) {
        uint32_t op = sdf->code[k].op;
        operations |= SDF_BIT(op & 0xffu);
        k += (op & 0xffu) == SDF_METABALLS ? ((op >> 8) + 3) / 4 : 0;
    }
    return operations;
}

// Returns SDF_*: the operations in the programs of the distance fields in use.
static uint32_t sdf_operations(const struct scene *scene, const struct flat_scene *flat)
{
    uint32_t operations = 0;
    for (uint32_t i = 0; i < flat->shape_count; i++)
        if (flat->shapes[i].kind == SHAPE_SDF)
            operations |= field_operations(&scene->sdfs[flat->shapes[i].sdf]);
    return operations;
}

static uint32_t texture_features(const struct scene *scene, const struct material *material)
{
    uint32_t features = 0;
    for (uint32_t i = 0; i < material->texture_count; i++) {
        const struct texture *texture = &scene->textures[material->first_texture + i];
        features |= FEATURE_TEXTURES;
        features |=
            scene->images[texture->image].values ? FEATURE_TEXELS_CODES : FEATURE_TEXELS_FLOAT;
        if ((texture->flags >> TEXTURE_USE_SHIFT & 3u) == TEXTURE_USE_NORMAL)
            features |= FEATURE_NORMAL_MAPS;
    }
    return features;
}

// Returns the features and lobes that the materials in use need.
static uint32_t material_features(const struct scene *scene, const struct flat_scene *flat,
                                  uint32_t class_lobes[CLASS_COUNT])
{
    uint32_t features = 0;
    for (uint32_t i = 0; i < scene->material_count; i++) {
        const struct material *material = &scene->materials[i];
        if (!flat->material_used[i])
            continue;
        class_lobes[material_class(material)] |= material_lobes(scene, material);
        features |= texture_features(scene, material);
        if (material->flags & (MATERIAL_ALPHA_MASK | MATERIAL_ALPHA_BLEND))
            features |= FEATURE_ALPHA;
        if (material_has_inside(material))
            features |= FEATURE_MEDIA;
        if (material_emits(material))
            features |= FEATURE_EMISSION;
    }
    return features;
}

// Returns the kinds of emitters that shadow rays can be aimed at.
static uint32_t emitters_of(const struct emitter_counts *counts)
{
    uint32_t emitters = 0;
    emitters |= counts->triangles ? EMITTER_TRIANGLES : 0u;
    static const uint32_t shapes[SHAPE_KIND_COUNT] = {
        [SHAPE_SPHERE] = EMITTER_SPHERES,     [SHAPE_DISC] = EMITTER_DISCS,
        [SHAPE_QUAD] = EMITTER_QUADS,         [SHAPE_BOX] = EMITTER_BOXES,
        [SHAPE_CYLINDER] = EMITTER_CYLINDERS, [SHAPE_TUBE] = EMITTER_TUBES,
    };
    for (uint32_t kind = 0; kind < SHAPE_KIND_COUNT; kind++)
        emitters |= counts->shapes[kind] ? shapes[kind] : 0u;
    emitters |= counts->lights ? EMITTER_LIGHTS : 0u;
    emitters |= counts->suns ? EMITTER_SUNS : 0u;
    emitters |= counts->environment ? EMITTER_ENVIRONMENT : 0u;
    return emitters;
}

// Chooses the light sampling strategy. INTEGRATOR_WHITTED sends a shadow ray to each emitter, and
// uses the list of LIGHT_CHOICE_UNIFORM.
static void choose_lights(const struct specialize_params *p, const struct emitter_counts *counts,
                          struct specialization *s)
{
    const struct settings *settings = &p->scene->settings;
    uint64_t emitters = emitters_total(counts);
    // Light paths begin on emitters, so the selection probability of an emitter must be the same
    // for all points.
    bool is_bidir = settings->integrator == INTEGRATOR_BIDIR;
    uint32_t wanted = is_bidir ? LIGHT_CHOICE_POWER : settings->light_choice;
    static const struct emitter_lamps none = {0};
    struct light_choice choice = light_choice_of(wanted, emitters, p->lamps ? p->lamps : &none);
    s->light_choice = choice.way;
    s->light_rays = choice.rays;
    s->light_vertices = choice.vertices;
    if (settings->integrator != INTEGRATOR_WHITTED)
        return;
    s->light_choice = LIGHT_CHOICE_UNIFORM;
    s->light_vertices = 0;
    s->light_rays = emitters < UINT32_MAX ? (uint32_t)emitters : UINT32_MAX;
    s->light_rays = s->light_rays > 0 ? s->light_rays : 1;
}

static bool wants_nee(const struct settings *settings)
{
    return settings->nee && settings->nee_depth > 0;
}

// Returns the variant of MIS weights: the balance heuristic, and the power heuristic with exponent
// 2, have specialized code.
static uint32_t find_weights(const struct settings *settings)
{
    if (settings->mis != MIS_POWER || settings->mis_exponent == 2.0f)
        return settings->mis;
    return settings->mis_exponent == 1.0f ? MIS_BALANCE : MIS_POWER_ANY;
}

static uint32_t light_features(const struct scene *scene, uint32_t emitters, uint32_t lobes)
{
    const struct settings *settings = &scene->settings;
    uint32_t features = 0;
    bool can_connect = emitters && (lobes & LOBES_CONNECTING) && settings->max_bounces > 0;
    if (can_connect && wants_nee(settings)) {
        features |= FEATURE_NEE;
        features |= settings->nee_depth < settings->max_bounces ? FEATURE_NEE_DEPTH : 0u;
    }
    if (!wants_nee(settings) || settings->mis != MIS_NONE)
        features |= FEATURE_BSDF_HITS_EMITTERS;
    if (scene->environment.present || (emitters & EMITTER_SUNS)) {
        features |= FEATURE_ENVIRONMENT;
        features |= scene->environment.width ? FEATURE_ENVIRONMENT_IMAGE : 0u;
    }
    return features;
}

// Returns features that, if compiled in without need, change only the time: their contribution is
// zero, or their code is never reached.
static uint32_t neutral_features(const struct settings *settings)
{
    uint32_t features = FEATURE_TRIANGLES | FEATURE_NORMALS | FEATURE_EMISSION |
                        FEATURE_ENVIRONMENT | FEATURE_ENVIRONMENT_IMAGE | FEATURE_ROULETTE |
                        FEATURE_LENS | FEATURE_FAR_CAMERA | FEATURE_MEDIA | FEATURE_CLAMP |
                        FEATURE_MIN_DENSITY;
    if (wants_nee(settings))
        features |= FEATURE_NEE | FEATURE_NEE_DEPTH;
    return features;
}

// Returns the number of vertices, from the beginning of a path, at which paths split.
static uint32_t split_vertices(const struct settings *settings, uint32_t lobes)
{
    uint32_t integrator = settings_integrator(settings);
    uint32_t most = integrator == INTEGRATOR_DIRECT ? 1u : settings->max_bounces;
    bool samples_lobes = integrator == INTEGRATOR_PATH || integrator == INTEGRATOR_DIRECT;
    if (!samples_lobes || !(lobes & LOBES_OF_TWO_PARTS))
        return 0;
    return settings->split_lobes < most ? settings->split_lobes : most;
}

static bool has_surfaces(const struct specialization *s)
{
    return (s->features & FEATURE_TRIANGLES) || s->geometry;
}

// Ambient occlusion depends only on positions of surfaces, not on materials or emitters, and has a
// white environment.
static void specialize_ao(struct specialization *s)
{
    uint32_t kept = FEATURE_TRIANGLES | FEATURE_NORMALS | FEATURE_CLAMP;
    if ((s->features & FEATURE_ALPHA) || (s->aovs & AOV_ALBEDO))
        kept |= FEATURE_ALPHA | FEATURE_TEXTURES | FEATURE_TEXELS_FLOAT | FEATURE_TEXELS_CODES |
                FEATURE_UV0 | FEATURE_UV1 | FEATURE_COLORS;
    s->features = (s->features & kept) | FEATURE_ENVIRONMENT;
    s->features |= has_surfaces(s) ? FEATURE_NEE : 0u;
    s->emitters = s->lobes = 0;
    memset(s->class_lobes, 0, sizeof s->class_lobes);
}

// Lobes that INTEGRATOR_WHITTED supports: see lib/whitted.glsl.
#define LOBES_WHITTED                                                                              \
    (LOBE_LAMBERT | LOBE_MIRROR | LOBE_PRINCIPLED | LOBE_METAL | LOBE_TRANSMISSION |               \
     LOBE_DIELECTRIC | LOBE_CONDUCTOR | LOBE_PHONG | LOBE_BLINN_PHONG | LOBE_MICROFACET |          \
     LOBE_ROUGH | LOBE_DELTA | LOBE_THIN)

// Whitted's integrator uses no densities of directions and no roulette, and one kernel shades all
// materials. If a surface both reflects and refracts, one of the two rays is postponed; after a
// miss, the path continues with a postponed ray.
static void specialize_whitted(struct specialization *s, const struct settings *settings)
{
    s->features &= ~(FEATURE_CLASSES | FEATURE_ROULETTE | FEATURE_BSDF_HITS_EMITTERS |
                     FEATURE_NEE_DEPTH | FEATURE_MIN_DENSITY | FEATURE_SPLIT_LOBES);
    s->lobes &= LOBES_WHITTED;
    memset(s->class_lobes, 0, sizeof s->class_lobes);
    // This integrator treats suns as delta lights.
    s->emitters |= s->emitters & EMITTER_SUNS ? EMITTER_LIGHTS : 0u;
    s->emitters &= ~(EMITTER_ENVIRONMENT | EMITTER_SUNS);
    if (!s->emitters)
        s->features &= ~FEATURE_NEE;
    if (s->lobes & LOBES_THROUGH) {
        s->pending_rays = settings->max_bounces;
        s->features |= FEATURE_ENVIRONMENT;
    }
}

static bool texels_fit(const struct gpu *gpu, const struct bvh *bvh, const struct scene *scene,
                       const struct specialization *s)
{
    uint64_t environment_bytes = 16 * environment_table_words(&(struct environment_table){
                                          .environment = &scene->environment,
                                          .filter = s->environment_filter,
                                          .is_sampled = s->emitters & EMITTER_ENVIRONMENT,
                                      });
    uint64_t texel_bytes = 0; // upper bound: equal images are uploaded only once
    for (uint32_t i = 0; i < scene->image_count; i++)
        texel_bytes += texture_image_bytes(&scene->images[i]);
    return gpu_texel_fits(gpu, bvh_nodes_bytes(bvh)) &&
           gpu_texel_fits(gpu, (uint64_t)bvh->reference_count * sizeof(struct gpu_triangle)) &&
           gpu_texel_fits(gpu, environment_bytes) && gpu_texel_fits(gpu, texel_bytes);
}

// Returns the features that depend on the device. On lavapipe texel fetches are three times as fast
// as reads of storage buffers (measured). On other devices storage buffers are used, unless a
// kernel cannot bind as many as it needs.
static uint32_t device_features(const struct gpu *gpu, const struct bvh *bvh,
                                const struct scene *scene, const struct specialization *s)
{
    uint32_t features = gpu->has_ballot ? FEATURE_BALLOT : 0u;
    bool is_short = gpu->storage_count < SHADING_STORAGE;
    if ((gpu->info.is_cpu || is_short) && texels_fit(gpu, bvh, scene, s))
        features |= FEATURE_TEXEL_SCENE;
    // The limit that Vulkan guarantees, 65,536 texels, suffices for a wave of 16,384 paths. With
    // less, small waves would cost more than texels save.
    if (gpu->info.is_cpu && gpu->max_texel_elements >= 65536)
        features |= FEATURE_TEXEL_STATE;
    return features;
}

// All lobes that shading may need.
#define LOBES_ALL (LOBE_END - 1u)

static uint32_t queues_needed(uint32_t features, const uint32_t class_lobes[CLASS_COUNT])
{
    uint32_t queues = 1u << QUEUE_RAYS | 1u << (QUEUE_RAYS + 1);
    queues |= features & FEATURE_CLASSES ? 0u : 1u << QUEUE_SURFACE;
    for (uint32_t c = 0; c < CLASS_COUNT && (features & FEATURE_CLASSES); c++)
        queues |= class_lobes[c] ? 1u << (QUEUE_SURFACE + c) : 0u;
    queues |= features & FEATURE_ENVIRONMENT ? 1u << QUEUE_MISS : 0u;
    queues |= features & FEATURE_NEE ? 1u << QUEUE_SHADOW : 0u;
    return queues;
}

// The usual number of entries of a thread's traversal stack in shared memory. RADV's compiler keeps
// a private stack in registers, and compares an index with each entry: "Registers on GPUs" in
// docs/performance.md. For 64 threads this many entries take 3 KiB, which permits as many subgroups
// at a time as their registers do (RDNA2).
#define STACK_SHARED_USUAL 12u
// Bytes of shared memory in lib/queue.glsl, which reserves places in queues if there are no
// ballots.
#define QUEUE_SHARED_BYTES 8u

// Returns the number of a thread's stack entries in shared memory. CPU drivers use none: with
// shared memory lavapipe takes a tenth to a quarter more processor time.
static uint32_t stack_shared(const struct specialization *s, const struct gpu *gpu)
{
    if (gpu->info.is_cpu && !gpu->params.limits.shared_stack)
        return 0;
    uint64_t room = gpu->max_shared_bytes > QUEUE_SHARED_BYTES
                        ? (gpu->max_shared_bytes - QUEUE_SHARED_BYTES) / (4u * s->workgroup)
                        : 0;
    uint32_t entries = s->stack_entries + 2; // must equal STACK_LENGTH of lib/stack.glsl
    if (entries > STACK_SHARED_USUAL)
        entries = STACK_SHARED_USUAL;
    return room < entries ? (uint32_t)room : entries;
}

void specialization_set_workgroup(struct specialization *s, const struct gpu *gpu,
                                  uint32_t workgroup)
{
    s->workgroup = workgroup;
    s->stack_shared = stack_shared(s, gpu);
}

void specialization_suspend(struct specialization *s)
{
    s->features |= FEATURE_SUSPEND;
    s->queues |= 3u << QUEUE_SUSPENDED;
}

void specialization_count_steps(struct specialization *s, bool on)
{
    s->features = on ? s->features | FEATURE_STEPS : s->features & ~FEATURE_STEPS;
}

// Operations of fractals. Rays that graze them take thousands of steps: on lavapipe one ray in a
// thousand exceeds its budget, so every wave would be traced twice.
#define SDF_FRACTALS                                                                               \
    (SDF_BIT(SDF_MANDELBULB) | SDF_BIT(SDF_MENGER) | SDF_BIT(SDF_APOLLONIAN) | SDF_BIT(SDF_PYRAMID))

// Returns whether rays are sorted. On GPUs sorting should take a tenth of the tracing time; on
// processors it takes a large part of it: "Rays sorted by octant and cell" in docs/performance.md.
static bool sorts_rays(const struct specialization *s, const struct gpu *gpu,
                       const struct settings *settings)
{
    bool is_wanted = !gpu->info.is_cpu || gpu->params.limits.sort_rays;
    bool is_long = s->integrator != INTEGRATOR_DIRECT && s->integrator != INTEGRATOR_AO;
    return is_wanted && is_long && settings->max_bounces >= SORT_FIRST_BOUNCE && has_surfaces(s);
}

struct specialization specialize(const struct specialize_params *p)
{
    const struct scene *scene = p->scene;
    const struct flat_scene *flat = p->flat;
    const struct bvh *bvh = p->bvh;
    const struct gpu *gpu = p->gpu;
    const struct settings *settings = &scene->settings;
    struct specialization s = {
        .stack_entries = bvh->stats.stack_entries,
        .iteration_budget =
            gpu->info.is_cpu ? CPU_SUBGROUP_ROUNDS / gpu->subgroup_size : GPU_LANE_ROUNDS,
        .interleave = gpu->info.is_cpu ? 16 : 1,
        .aovs = film_aovs_of_device(p->aovs),
        .integrator = settings_integrator(settings),
        .sampler = settings->sampler,
        .halves = settings->halves,
        .filter = settings->filter,
        .accumulation = settings->accumulation,
        .rounding = gpu->rounds_to_nearest ? ROUNDING_NEAREST : ROUNDING_ANY,
        .camera = p->camera->kind,
        .mis = find_weights(settings),
        .directions = settings->directions,
        .roulette = settings->roulette,
        .nodes = bvh->format == BVH_FLOAT ? NODES_FLOAT : NODES_QUANTISED,
        .geometry = geometry_of(flat, bvh),
        .sdf = sdf_operations(scene, flat),
        .environment_filter =
            scene->environment.width ? settings->environment_filter : ENVIRONMENT_FILTER_NEAREST,
        .leaf_index_bits = bvh_leaf_index_bits(bvh->max_leaf),
        .normals = settings->normals,
        .radiance_scaling = settings->radiance_scaling,
        .window = p->has_window,
    };
    uint32_t usual_workgroup = gpu->info.is_cpu ? 128 : 64;
    specialization_set_workgroup(&s, gpu, p->workgroup ? p->workgroup : usual_workgroup);
    s.geometry |= has_large_spheres(flat, p->camera) ? GEOMETRY_LARGE_SPHERES : 0u;
    uint32_t classes = 0;
    s.features = geometry_features(flat) | material_features(scene, flat, s.class_lobes);
    for (uint32_t c = 0; c < CLASS_COUNT; c++) {
        classes += s.class_lobes[c] != 0;
        s.lobes |= s.class_lobes[c];
    }
    struct emitter_counts counts = emitters_count(scene, flat);
    s.emitters = emitters_of(&counts);
    for (uint32_t i = 0; i < scene->light_count; i++)
        s.emitters |= scene->lights[i].profile && !scene->lights[i].hidden ? EMITTER_PROFILES : 0u;
    choose_lights(p, &counts, &s);
    s.features |= light_features(scene, s.emitters, s.lobes);
    if (!(s.features & FEATURE_NEE))
        s.emitters &= ~EMITTER_ENVIRONMENT;
    if (classes > 1 && !p->merge_classes)
        s.features |= FEATURE_CLASSES;
    if (settings->roulette != ROULETTE_OFF &&
        settings->roulette_min_bounces < settings->max_bounces)
        s.features |= FEATURE_ROULETTE;
    if (settings->clamp_limit > 0.0f)
        s.features |= FEATURE_CLAMP;
    if (settings->min_density > 0.0f && settings->max_bounces > 0)
        s.features |= FEATURE_MIN_DENSITY;
    s.split_lobes = split_vertices(settings, s.lobes);
    s.features |= s.split_lobes > 0 ? FEATURE_SPLIT_LOBES : 0u;
    if (p->compile_all) {
        s.features |= neutral_features(settings);
        // Excludes distance fields, which would need operations, and large spheres, which change
        // the result.
        s.geometry |= GEOMETRY_SHAPES & ~GEOMETRY_SDFS;
        s.emitters |= EMITTERS_ALL;
        s.lobes = LOBES_ALL;
        for (uint32_t c = 0; c < CLASS_COUNT; c++)
            s.class_lobes[c] = s.class_lobes[c] ? LOBES_ALL : 0u;
    }
    if (settings->integrator == INTEGRATOR_AO)
        specialize_ao(&s);
    // Where camera paths are connected to emitters, light paths are connected to the camera.
    // Without next-event estimation there are no such connections, and the path integrator gives
    // the same image.
    if (settings->integrator == INTEGRATOR_BIDIR && !(s.features & FEATURE_NEE))
        s.integrator = INTEGRATOR_PATH;
    if (settings->integrator == INTEGRATOR_WHITTED)
        specialize_whitted(&s, settings);
    if (settings_spread_over_pixel(settings)) {
        s.features |= FEATURE_JITTER;
        s.pixel_sampling = settings->pixel_sampling;
    }
    if (p->camera->lens_radius > 0.0)
        s.features |= FEATURE_LENS;
    if (camera_is_far(flat, p->camera))
        s.features |= FEATURE_FAR_CAMERA;
    if (p->tiles)
        s.features |= FEATURE_TILES;
    s.features |= device_features(gpu, bvh, scene, &s);
    s.queues = queues_needed(s.features, s.class_lobes);
    s.sort_rays = sorts_rays(&s, gpu, settings);
    // The contribution of a light path to the film cannot be undone, so no wave may become void.
    if ((s.sdf & SDF_FRACTALS) || s.integrator == INTEGRATOR_BIDIR)
        specialization_suspend(&s);
    return s;
}

struct specialization specialization_with(const struct specialization *s, uint32_t constant,
                                          uint32_t bit)
{
    struct specialization with = *s;
    ((uint32_t *)&with)[constant] |= bit;
    if (constant == CONSTANT_LOBES)
        for (uint32_t c = 0; c < CLASS_COUNT; c++)
            with.class_lobes[c] |= with.class_lobes[c] ? bit : 0u;
    if (constant == CONSTANT_FEATURES)
        with.queues |= queues_needed(with.features, with.class_lobes);
    return with;
}

static bool uses_bsdfs(const struct specialization *s)
{
    return s->integrator == INTEGRATOR_PATH || s->integrator == INTEGRATOR_DIRECT ||
           s->integrator == INTEGRATOR_BIDIR;
}

bool specialization_needs_kernel(const struct specialization *s, enum kernel_id id)
{
    switch (id) {
    case KERNEL_shade_miss:
        return s->integrator != INTEGRATOR_WHITTED && (s->features & FEATURE_ENVIRONMENT);
    case KERNEL_shade_whitted:
        return s->integrator == INTEGRATOR_WHITTED &&
               (has_surfaces(s) || (s->features & FEATURE_ENVIRONMENT));
    case KERNEL_shade_surface:
        return uses_bsdfs(s) && !(s->features & FEATURE_CLASSES) && has_surfaces(s);
    case KERNEL_shade_ao:
        return s->integrator == INTEGRATOR_AO && has_surfaces(s);
    case KERNEL_shade_diffuse:
    case KERNEL_shade_principled:
    case KERNEL_shade_transmissive:
    case KERNEL_shade_classical:
        return (s->features & FEATURE_CLASSES) && s->class_lobes[id - KERNEL_shade_diffuse];
    case KERNEL_intersect_closest:
        // Without surfaces the tree is empty, and this kernel finds that all rays miss. If there is
        // no environment either, nothing is visible.
        return has_surfaces(s) || (s->features & FEATURE_ENVIRONMENT);
    case KERNEL_intersect_shadow:
        return s->features & FEATURE_NEE;
    case KERNEL_generate_light_rays:
    case KERNEL_shade_light:
    case KERNEL_intersect_camera:
    case KERNEL_add_splats:
        return s->integrator == INTEGRATOR_BIDIR;
    case KERNEL_sort_count:
    case KERNEL_sort_scan:
    case KERNEL_sort_scatter:
        return s->sort_rays;
    default:
        return true;
    }
}

bool specialization_needs_binding(const struct specialization *s, uint32_t binding)
{
    switch (binding) {
    case BINDING_TRIANGLES:
        return s->features & FEATURE_TRIANGLES;
    case BINDING_ATTRIBUTES:
        return attribute_words(s->features) > 0;
    case BINDING_TEXELS:
        return s->features & FEATURE_TEXTURES;
    case BINDING_SHAPES:
        return s->geometry & (GEOMETRY_SHAPES | GEOMETRY_INSTANCES | GEOMETRY_SMALL_TRIANGLES);
    case BINDING_MATERIALS:
        return (has_surfaces(s) && (s->integrator != INTEGRATOR_AO ||
                                    (s->features & FEATURE_ALPHA) || (s->aovs & AOV_ALBEDO))) ||
               (s->emitters & EMITTER_SUNS);
    case BINDING_EMITTERS:
        return (s->features & FEATURE_NEE) && s->emitters;
    case BINDING_SHADOW_RAYS:
        return (s->features & FEATURE_NEE) || s->pending_rays > 0;
    case BINDING_ENVIRONMENT:
        return s->features & FEATURE_ENVIRONMENT_IMAGE;
    case BINDING_SORT:
        return s->sort_rays;
    case BINDING_SUSPENDED:
        return s->features & FEATURE_SUSPEND;
    default:
        return binding < BINDING_COUNT;
    }
}

// Returns the name at the index of the bit; NULL if the value is not a single bit, or has no name.
static const char *name_of_bit(const char *const *names, size_t count, uint32_t bit)
{
    for (size_t i = 0; i < count; i++)
        if (bit == 1u << i)
            return names[i];
    return NULL;
}

const char *lobe_name(uint32_t bit)
{
    static const char *const names[] = {
        "Lambert",           "mirror",
        "principled",        "metal",
        "subsurface",        "sheen",
        "Charlie sheen",     "clearcoat",
        "transmission",      "dielectric",
        "conductor",         "Phong",
        "Blinn-Phong",       "microfacet",
        "rough specular",    "perfectly specular",
        "anisotropy",        "energy compensation",
        "thin walls",        "iridescence",
        "dispersion",        "diffuse transmission",
        "separable masking", "Burley's layers",
        "glTF's layers",     "further maskings",
        "uncoupled base",    "mixed Fresnel",
        "exact coat",
    };
    return name_of_bit(names, sizeof names / sizeof *names, bit);
}

const char *geometry_name(uint32_t bit)
{
    static const char *const names[] = {
        "spheres",
        "discs",
        "planes",
        "quads",
        "boxes",
        "cylinders",
        "open cylinders",
        "distance fields",
        "large spheres",
        "instances",
        "triangles in several leaves",
        "small triangles",
    };
    return name_of_bit(names, sizeof names / sizeof *names, bit);
}

const char *emitter_name(uint32_t bit)
{
    static const char *const names[] = {
        "emissive triangles",
        "emissive spheres",
        "emissive discs",
        "delta lights",
        "suns",
        "photometric profiles",
        "environment sampled by shadow rays",
        "emissive quads",
        "emissive boxes",
        "emissive cylinders",
        "emissive open cylinders",
    };
    return name_of_bit(names, sizeof names / sizeof *names, bit);
}

const char *feature_name(uint32_t bit)
{
    // clang-format off
    static const char *const names[] = {
        [__builtin_ctz(FEATURE_TRIANGLES)] = "triangles",
        [__builtin_ctz(FEATURE_NORMALS)] = "shading normals",
        [__builtin_ctz(FEATURE_CLASSES)] = "surface classes",
        [__builtin_ctz(FEATURE_TEXTURES)] = "textures",
        [__builtin_ctz(FEATURE_TEXELS_FLOAT)] = "float textures",
        [__builtin_ctz(FEATURE_TEXELS_CODES)] = "8-bit textures",
        [__builtin_ctz(FEATURE_UV0)] = "texture coordinates",
        [__builtin_ctz(FEATURE_UV1)] = "second texture coordinates",
        [__builtin_ctz(FEATURE_TANGENTS)] = "tangents",
        [__builtin_ctz(FEATURE_COLORS)] = "vertex colors",
        [__builtin_ctz(FEATURE_ALPHA)] = "alpha",
        [__builtin_ctz(FEATURE_MEDIA)] = "media",
        [__builtin_ctz(FEATURE_NORMAL_MAPS)] = "normal maps",
        [__builtin_ctz(FEATURE_EMISSION)] = "emission",
        [__builtin_ctz(FEATURE_CLAMP)] = "clamped contributions",
        [__builtin_ctz(FEATURE_MIN_DENSITY)] = "minimum density of directions",
        [__builtin_ctz(FEATURE_SPLIT_LOBES)] = "paths that split into diffuse and specular",
        [__builtin_ctz(FEATURE_NEE_DEPTH)] = "shadow rays from the first vertices only",
        [__builtin_ctz(FEATURE_NEE)] = "next-event estimation",
        [__builtin_ctz(FEATURE_BSDF_HITS_EMITTERS)] = "emitters hit by BSDF sampling",
        [__builtin_ctz(FEATURE_ENVIRONMENT)] = "environment",
        [__builtin_ctz(FEATURE_ENVIRONMENT_IMAGE)] = "environment image",
        [__builtin_ctz(FEATURE_ROULETTE)] = "Russian roulette",
        [__builtin_ctz(FEATURE_JITTER)] = "pixel jitter",
        [__builtin_ctz(FEATURE_LENS)] = "lens",
        [__builtin_ctz(FEATURE_FAR_CAMERA)] = "far camera",
        [__builtin_ctz(FEATURE_TILES)] = "sample counts by tile",
    };
    // clang-format on
    return name_of_bit(names, sizeof names / sizeof *names, bit);
}
