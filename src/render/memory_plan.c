#include "render/memory_plan.h"

#include "base/log.h"
#include "base/memory.h"
#include "render/attributes.h"
#include "render/film_aovs.h"
#include "render/shape_sections.h"
#include "render/tables/environment_table.h"
#include "shared/aov.h"
#include "shared/types.h"
#include <inttypes.h>
#include <stdio.h>

// According to measurements (docs/performance.md), a dispatch on lavapipe takes about 65 us to wake
// its threads, so larger waves are faster as long as the path state fits into the caches. GPUs need
// enough paths to fill every lane many times over.
#define CPU_WAVE 65536u
#define GPU_WAVE (1u << 20)
// On wide devices the last bounces of a wave, which have few paths, run at the same time as the
// first bounces of the next wave. If memory limits the two waves to fewer paths than this, one
// larger wave is faster.
#define LEAST_OF_TWO_WAVES (1u << 17)
// The maximum number of items of one dispatch. 64k rays take lavapipe about 20 ms; 1M rays take a
// GPU a few ms.
#define CPU_PART 65536u
#define GPU_PART (1u << 20)
#define RESOLVE_PIXELS (1u << 20)

const char *binding_name(uint32_t binding)
{
    static const char *const names[BINDING_COUNT] = {
        [BINDING_NODES] = "nodes",
        [BINDING_TRIANGLES] = "triangles",
        [BINDING_ATTRIBUTES] = "attributes",
        [BINDING_SHAPES] = "shapes",
        [BINDING_MATERIALS] = "materials",
        [BINDING_EMITTERS] = "emitters",
        [BINDING_ENVIRONMENT] = "environment",
        [BINDING_TEXELS] = "texels",
        [BINDING_PATHS] = "paths",
        [BINDING_SHADOW_RAYS] = "shadow_rays",
        [BINDING_RADIANCE] = "radiance",
        [BINDING_QUEUES] = "queues",
        [BINDING_SORT] = "sort",
        [BINDING_FILM] = "film",
        [BINDING_RESOLVED] = "resolved",
        [BINDING_SUSPENDED] = "suspended",
    };
    return binding < BINDING_COUNT ? names[binding] : NULL;
}

static uint32_t queue_rows(const struct specialization *s)
{
    return (uint32_t)__builtin_popcount(s->queues);
}

// Returns the bytes that one slot of a wave takes in a buffer; 0 for buffers whose size does not
// depend on the wave.
static uint64_t bytes_a_slot(const struct specialization *s, uint32_t binding)
{
    switch (binding) {
    case BINDING_PATHS:
        return 16u * PATH_WORDS_OF(s->geometry, s->integrator);
    case BINDING_SHADOW_RAYS:
        return ((s->features & FEATURE_NEE ? (uint64_t)s->light_rays : 0) + s->pending_rays) * 16 *
               SHADOW_WORDS_OF(s->geometry);
    case BINDING_RADIANCE:
        return 16 * AOV_SLOT_WORDS(s->aovs);
    case BINDING_QUEUES:
        // Sample counts by tile need two more lists: pixels, and the first sample number of each
        // pixel.
        return (uint64_t)(queue_rows(s) + (s->features & FEATURE_TILES ? 2u : 0u)) * 4;
    case BINDING_SUSPENDED:
        // Besides its entries the stack has a sentinel, and a place that a branch-free push may
        // overwrite.
        return ((uint64_t)s->stack_entries + 2 + SUSPENDED_WORDS_OF(s->geometry)) * 4;
    default:
        return 0;
    }
}

bool memory_plan_is_of_wave(const struct specialization *s, uint32_t binding)
{
    return binding == BINDING_SORT || bytes_a_slot(s, binding) > 0;
}

const char *memory_plan_in_flight(const struct memory_plan *plan)
{
    return plan->waves > 1 ? ", two in flight" : "";
}

// Returns the size in bytes of a buffer that does not depend on the wave, such as those of the
// scene.
static uint64_t fixed_bytes(const struct memory_plan_params *p, uint32_t binding)
{
    switch (binding) {
    case BINDING_NODES:
        return bvh_nodes_bytes(p->bvh);
    case BINDING_TRIANGLES:
        return (uint64_t)p->bvh->reference_count * sizeof(struct gpu_triangle);
    case BINDING_ATTRIBUTES:
        return (uint64_t)p->bvh->reference_count * attribute_words(p->specialization->features) *
               16;
    case BINDING_SHAPES:
        return shape_sections(p->scene, p->flat).words * 16;
    case BINDING_MATERIALS:
        return p->tables->material_bytes;
    case BINDING_EMITTERS:
        return p->tables->emitters.bytes;
    case BINDING_TEXELS:
        return p->tables->textures.texel_bytes;
    case BINDING_ENVIRONMENT:
        return 16 * environment_table_words(&(struct environment_table){
                        .environment = &p->scene->environment,
                        .filter = p->specialization->environment_filter,
                        .is_sampled = p->specialization->emitters & EMITTER_ENVIRONMENT,
                    });
    case BINDING_QUEUES:
        return QUEUES_OFFSET;
    case BINDING_SORT:
        return sizeof(struct gpu_sort);
    default:
        return 0;
    }
}

static uint64_t bytes_of(const struct memory_plan_params *p, uint32_t binding, uint32_t slots)
{
    return fixed_bytes(p, binding) + bytes_a_slot(p->specialization, binding) * slots;
}

uint64_t memory_plan_bytes(const struct memory_plan_params *p, uint32_t slots)
{
    uint64_t bytes = 0;
    for (uint32_t b = 0; b < BINDING_COUNT; b++)
        if (specialization_needs_binding(p->specialization, b))
            bytes += bytes_of(p, b, slots);
    return bytes;
}

static bool fits_texels(const struct memory_plan_params *p)
{
    for (uint32_t b = 0; b <= BINDING_TEXELS; b++)
        if (specialization_needs_binding(p->specialization, b) &&
            !gpu_texel_fits(p->gpu, fixed_bytes(p, b)))
            return false;
    return true;
}

static uint64_t least(uint64_t a, uint64_t b)
{
    return a < b ? a : b;
}

// Returns the largest number of slots whose buffers are within the device's limits: a multiple of
// the slots of one sample and, if possible, of the workgroup size.
static uint32_t fit_wave(const struct memory_plan_params *p)
{
    const struct specialization *s = p->specialization;
    const struct gpu *gpu = p->gpu;
    uint64_t wanted = p->wave ? p->wave : gpu->info.is_cpu ? CPU_WAVE : GPU_WAVE;
    uint64_t range = least(gpu->max_storage_range, gpu->max_allocation);
    uint64_t slots = wanted;
    for (uint32_t b = 0; b < BINDING_COUNT; b++) {
        if (!bytes_a_slot(s, b))
            continue;
        uint64_t fixed = least(fixed_bytes(p, b), range);
        slots = least(slots, (range - fixed) / bytes_a_slot(s, b));
        bool as_texels = b == BINDING_PATHS || b == BINDING_SHADOW_RAYS || b == BINDING_RADIANCE;
        if (as_texels && (s->features & FEATURE_TEXEL_STATE))
            slots = least(slots, gpu->max_texel_elements * 16 / bytes_a_slot(s, b));
    }
    // The slots of a sample and the workgroup size are powers of two.
    uint64_t sample = UINT64_C(1) << s->split_lobes;
    uint64_t unit = sample > s->workgroup ? sample : s->workgroup;
    // If the limits permit fewer slots than a workgroup has threads, some threads are idle.
    if (slots < unit)
        unit = sample;
    slots = slots / unit * unit;
    if (slots < unit)
        slots = unit;
    if (p->wave && !p->wave_is_wish && slots < wanted / unit * unit)
        log_warn("a wave of %" PRIu64 " paths is lowered to %" PRIu64
                 ": the device's buffers hold %s, its texel buffers %" PRIu64 " elements",
                 wanted, slots, memory_print(range).text, gpu->max_texel_elements);
    return (uint32_t)slots;
}

// Returns the largest power of two that fits into a storage buffer's range; 0 if ranges cannot
// begin at its multiples because of the device's offset alignment.
static uint64_t part_bytes(const struct gpu *gpu)
{
    uint64_t range = gpu->max_storage_range;
    uint64_t bytes = range ? UINT64_C(1) << (63 - __builtin_clzll(range)) : 0;
    return bytes >= 16 && bytes % gpu->storage_alignment == 0 ? bytes : 0;
}

// Returns the number of bindings that one buffer may use for its parts if `parts` bindings are
// taken already.
static uint32_t parts_left(const struct gpu *gpu, uint32_t parts)
{
    uint32_t left =
        gpu->storage_count > GPU_FIRST_STORAGE ? gpu->storage_count - GPU_FIRST_STORAGE : 0;
    for (uint32_t b = 0; b <= BINDING_TEXELS; b++)
        left -= PARTS_OF(parts, b);
    return left < (1u << PARTS_BITS) - 1u ? left : (1u << PARTS_BITS) - 1u;
}

static bool is_texels(const struct memory_plan_params *p, uint32_t b)
{
    return b <= BINDING_TEXELS && (p->specialization->features & FEATURE_TEXEL_SCENE);
}

// Scene buffers that are read as texels may be longer than a storage buffer's range; the others are
// composed of parts.
static uint64_t limit_of(const struct memory_plan_params *p, const struct memory_plan *plan,
                         uint32_t b)
{
    const struct gpu *gpu = p->gpu;
    uint64_t limit = gpu->max_storage_range;
    if (is_texels(p, b)) {
        limit = gpu->max_texel_elements * 16;
    } else if (b <= BINDING_TEXELS) {
        uint64_t split = part_bytes(gpu) * (1 + parts_left(gpu, plan->parts));
        limit = split > limit ? split : limit;
    }
    return least(limit, gpu->max_allocation);
}

// Assigns bindings to the parts of a scene buffer beyond its first range.
static void take_parts(const struct memory_plan_params *p, struct memory_plan *plan, uint32_t b)
{
    uint64_t bytes = plan->buffers[b].bytes;
    if (b > BINDING_TEXELS || is_texels(p, b) || bytes <= p->gpu->max_storage_range)
        return;
    uint32_t further = (uint32_t)((bytes - 1) / plan->part_bytes);
    plan->parts |= further << (PARTS_BITS * b);
    plan->buffers[b].parts += further;
}

// The maximum number of shadow rays of a vertex. One thread loops over their lamps. Some drivers
// silently end the loops of an invocation after 65,535 iterations (see specialize.c), and each lamp
// takes further loops.
#define LIGHT_RAYS_MAX 512u

static bool check_light_rays(const struct specialization *s, struct err *err)
{
    bool is_whitted = s->integrator == INTEGRATOR_WHITTED;
    if (!(s->features & FEATURE_NEE) || s->light_rays <= LIGHT_RAYS_MAX)
        return true;
    return err_set(
        err, ERR_INPUT, "%u %s are too many for a shadow ray to each; expected at most %u%s",
        s->light_rays, is_whitted ? "emitters" : "lamps", LIGHT_RAYS_MAX,
        is_whitted ? ", or another --integrator" : ", or another --light-choice, such as tree");
}

// The maximum number of rays that a slot postpones with INTEGRATOR_WHITTED: the stack has one
// record for each depth.
#define PENDING_RAYS_MAX 64u

static bool check_pending_rays(const struct specialization *s, struct err *err)
{
    return s->pending_rays <= PENDING_RAYS_MAX ||
           err_set(
               err, ERR_INPUT,
               "max_bounces is %u, but in scenes with transmission --integrator whitted follows "
               "at most %u bounces; expected a lower --max-bounces",
               s->pending_rays, PENDING_RAYS_MAX);
}

// Returns whether --instances on would save memory: some mesh has several instances, but no mesh is
// shared, so each instance is a copy in world space.
static bool could_share(const struct memory_plan_params *p)
{
    return p->scene->instance_count > p->scene->mesh_count && p->flat->placed_count == 0;
}

// Returns advice on how to make a buffer smaller.
static const char *advice(const struct memory_plan_params *p, uint32_t b)
{
    bool is_mesh = b == BINDING_NODES || b == BINDING_TRIANGLES || b == BINDING_ATTRIBUTES;
    if (bytes_a_slot(p->specialization, b) > 0)
        return "a smaller --wave";
    if (is_mesh && could_share(p))
        return "--instances on, a smaller scene, or a device with a higher limit";
    if (b == BINDING_NODES && p->bvh->format == BVH_FLOAT)
        return "--node quantised, a smaller scene, or a device with a higher limit";
    if (b == BINDING_ATTRIBUTES)
        return "meshes with fewer triangles, or without normals, texture coordinates or colours "
               "that the picture can do without, or a device with a higher limit";
    if (b == BINDING_TEXELS)
        return "smaller textures, or a device with a higher limit";
    return "a smaller scene, or a device with a higher limit";
}

static bool check(const struct memory_plan_params *p, const struct memory_plan *plan, uint32_t b,
                  struct err *err)
{
    uint64_t limit = limit_of(p, plan, b);
    uint64_t bytes = plan->buffers[b].bytes;
    if (bytes <= limit)
        return true;
    char parts[80] = "";
    if (b <= BINDING_TEXELS && limit > p->gpu->max_storage_range && !is_texels(p, b))
        snprintf(parts, sizeof parts, " (%s in each of %u bindings that are left)",
                 memory_print(part_bytes(p->gpu)).text, 1 + parts_left(p->gpu, plan->parts));
    return err_set(err, ERR_GPU,
                   "buffer %s needs %s, but %s allows at most %s per buffer%s; expected %s",
                   binding_name(b), memory_print(bytes).text, p->gpu->info.name,
                   memory_print(limit).text, parts, advice(p, b));
}

static uint64_t picture_pixels(const struct memory_plan_params *p)
{
    const struct settings *settings = &p->scene->settings;
    return p->pixels ? p->pixels : (uint64_t)settings->width * settings->height;
}

// Bytes of host memory for each pixel, for reading it back, estimating its error and writing it.
#define HOST_BYTES_A_PIXEL 64

// Returns the device memory that all buffers of the plan may take.
static uint64_t device_room(const struct memory_plan_params *p)
{
    uint64_t left = gpu_memory_free(p->gpu);
    return left < UINT64_MAX - p->replaced_bytes ? left + p->replaced_bytes : UINT64_MAX;
}

// Says of whom the memory is a share, and what frees it. {"", ""} if it is not shared.
struct sharing_words {
    char whose[64];
    const char *remedy;
};

static struct sharing_words sharing_words(const struct gpu *gpu)
{
    struct sharing_words words = {.remedy = ""};
    if (gpu->sharers < 2)
        return words;
    snprintf(words.whose, sizeof words.whose, " for each of the %u that share it", gpu->sharers);
    words.remedy = ", or fewer devices or ranks";
    return words;
}

static bool check_total(const struct memory_plan_params *p, const struct memory_plan *plan,
                        struct err *err)
{
    uint64_t pixels = picture_pixels(p), device = device_room(p);
    bool is_shared = p->gpu->info.shares_memory;
    const struct sharing_words sharing = sharing_words(p->gpu);
    uint64_t host = gpu_host_memory_free(p->gpu);
    uint64_t host_bytes = HOST_BYTES_A_PIXEL + film_aovs_bytes(p->specialization->aovs);
    uint64_t further = plan->total_bytes - least(plan->total_bytes, p->replaced_bytes);
    uint64_t host_needed = pixels * host_bytes + (is_shared ? further : 0);
    if (plan->total_bytes > device)
        return err_set(err, ERR_GPU,
                       "the plan needs %s of device memory, but %s has %s left%s; expected a "
                       "smaller scene, picture (--size) or --wave%s",
                       memory_print(plan->total_bytes).text, p->gpu->info.name,
                       memory_print(device).text, sharing.whose, sharing.remedy);
    if (!memory_check(pixels * host_bytes, "the picture on the host", err))
        return false;
    if (host_needed > host)
        return err_set(err, ERR_SYSTEM,
                       "the plan needs %s of memory, but %s are free%s; expected a smaller picture "
                       "(--size)%s",
                       memory_print(host_needed).text, memory_print(host).text,
                       is_shared ? sharing.whose : "", is_shared ? sharing.remedy : "");
    return true;
}

// Chooses the number of waves in flight. It is one with tiles, because their lists belong to a
// single wave, and one if rays may be suspended, because the host then waits for each dispatch.
static uint32_t choose_waves(const struct memory_plan_params *p, uint32_t slots)
{
    uint64_t forced = p->gpu->params.limits.waves;
    if (p->specialization->features & (FEATURE_TILES | FEATURE_SUSPEND))
        return 1;
    if (forced)
        return forced > 1 ? 2 : 1;
    return !p->gpu->info.is_cpu && slots >= LEAST_OF_TWO_WAVES ? 2 : 1;
}

// Returns the maximum number of threads of one dispatch.
static uint64_t max_threads(const struct memory_plan_params *p)
{
    return (uint64_t)p->gpu->max_groups * p->specialization->workgroup;
}

static bool plan_picture(const struct memory_plan_params *p, struct memory_plan *out,
                         struct err *err)
{
    const struct gpu *gpu = p->gpu;
    const uint32_t aovs = p->specialization->aovs;
    uint64_t pixels = picture_pixels(p);
    uint64_t range = least(gpu->max_storage_range, gpu->max_allocation);
    out->film_chunk_pixels = least(pixels, range / (16 * AOV_FILM_WORDS(aovs)));
    if (out->film_chunk_pixels == 0)
        return err_set(err, ERR_GPU,
                       "a storage range of %" PRIu64 " bytes holds no pixel; expected at least %d",
                       range, 16 * AOV_FILM_WORDS(aovs));
    out->film_chunks = (uint32_t)((pixels + out->film_chunk_pixels - 1) / out->film_chunk_pixels);
    out->resolve_pixels = least(least(out->film_chunk_pixels, RESOLVE_PIXELS),
                                least(max_threads(p), range / (16 * AOV_RESOLVED_WORDS(aovs))));
    return true;
}

static uint64_t film_bytes(const struct memory_plan_params *p, const struct memory_plan *plan)
{
    return plan->film_chunk_pixels * 16 * AOV_FILM_WORDS(p->specialization->aovs);
}

static uint64_t resolved_bytes(const struct memory_plan_params *p, const struct memory_plan *plan)
{
    return plan->resolve_pixels * 16 * AOV_RESOLVED_WORDS(p->specialization->aovs);
}

uint64_t memory_plan_picture_bytes(const struct memory_plan_params *p)
{
    struct memory_plan plan = {0};
    return plan_picture(p, &plan, NULL)
               ? plan.film_chunks * film_bytes(p, &plan) + resolved_bytes(p, &plan)
               : 0;
}

static bool make(const struct memory_plan_params *p, struct memory_plan *out, struct err *err)
{
    const struct gpu *gpu = p->gpu;
    *out = (struct memory_plan){0};
    if (!check_light_rays(p->specialization, err) || !check_pending_rays(p->specialization, err))
        return false;
    out->wave_slots = fit_wave(p);
    out->wave_samples = out->wave_slots >> p->specialization->split_lobes;
    out->waves = p->waves ? p->waves : choose_waves(p, out->wave_slots);
    out->part_bytes = part_bytes(gpu);
    out->part_shift = out->part_bytes ? 59u - (uint32_t)__builtin_clzll(out->part_bytes) : 31u;

    if (!plan_picture(p, out, err))
        return false;

    uint64_t threads = max_threads(p);
    uint64_t part = least(gpu->info.is_cpu ? CPU_PART : GPU_PART, threads);
    uint64_t smallest_part = (out->wave_slots + DISPATCH_PARTS - 1) / DISPATCH_PARTS;
    out->part_items = (uint32_t)(part > smallest_part ? part : smallest_part);
    if (out->part_items > threads)
        return err_set(err, ERR_GPU,
                       "a wave of %u paths takes more than %d dispatches of a kernel; expected a "
                       "smaller --wave",
                       out->wave_slots, DISPATCH_PARTS);

    for (uint32_t b = 0; b < BINDING_COUNT; b++) {
        uint64_t bytes = bytes_of(p, b, out->wave_slots);
        uint32_t copies = 1;
        if (b == BINDING_FILM) {
            bytes = film_bytes(p, out);
            copies = out->film_chunks;
        } else if (memory_plan_is_of_wave(p->specialization, b)) {
            copies = out->waves;
        } else if (b == BINDING_RESOLVED) {
            bytes = resolved_bytes(p, out);
        }
        bool needed = specialization_needs_binding(p->specialization, b);
        out->buffers[b] = (struct planned_buffer){
            .name = needed ? binding_name(b) : NULL,
            .bytes = needed ? bytes : 0,
            .unneeded_bytes = needed ? 0 : bytes,
            .copies = needed ? copies : 0,
            .parts = needed,
        };
        if (!check(p, out, b, err))
            return false;
        take_parts(p, out, b);
        out->total_bytes += out->buffers[b].bytes * copies;
    }
    return true;
}

// Makes a plan that fits into memory. If necessary, it has only one wave in flight, whose size is
// halved until the plan fits or the wave gets no smaller. The image does not depend on it.
static bool make_fitting(const struct memory_plan_params *p, struct memory_plan *out,
                         struct err *err)
{
    struct memory_plan_params smaller = *p;
    uint64_t room = device_room(p);
    if (!make(p, out, err))
        return false;
    uint32_t wanted = out->wave_slots;
    while (out->total_bytes > room) {
        uint32_t slots = out->wave_slots;
        if (smaller.waves == 0)
            smaller.waves = 1;
        else
            smaller.wave = slots / 2;
        smaller.wave_is_wish = true; // this function warns of the smaller wave below
        if (!make(&smaller, out, err))
            return false;
        if (smaller.wave == slots / 2 && out->wave_slots >= slots)
            break;
    }
    if (!check_total(p, out, err))
        return false;
    if (out->wave_slots < wanted)
        log_warn("waves have %u paths in place of %u, because only %s of device memory are left; "
                 "rendering is slower, the picture is the same",
                 out->wave_slots, wanted, memory_print(room).text);
    return true;
}

static bool make_wanted(const struct memory_plan_params *p, struct memory_plan *out,
                        struct err *err)
{
    struct err none = {0};
    struct memory_plan_params usual = *p;
    if (!p->wave_is_wish || p->wave == 0)
        return make_fitting(p, out, err);
    if (make(p, out, &none) && check_total(p, out, &none))
        return true;
    usual.wave = 0;
    return make_fitting(&usual, out, err);
}

bool memory_plan_make(const struct memory_plan_params *p, struct specialization *s,
                      struct memory_plan *out, struct err *err)
{
    // The sizes of materials, emitters and corner attributes are known only now.
    if (!fits_texels(p))
        s->features &= ~FEATURE_TEXEL_SCENE;
    if (!make_wanted(p, out, err))
        return false;
    s->parts = out->parts;
    s->part_shift = out->parts ? out->part_shift : 0;
    return true;
}

bool memory_plan_refused(const struct memory_plan *plan, const struct gpu *gpu, struct err *err)
{
    bool is_short = gpu->storage_count < SHADING_STORAGE && gpu->max_texel_elements > 0;
    if (!is_short || gpu->lost || gpu->out_of_memory)
        return false;
    for (uint32_t b = 0; b <= BINDING_TEXELS; b++)
        if (!gpu_texel_fits(gpu, plan->buffers[b].bytes))
            return err_prepend(err,
                               "the scene is read from storage buffers, since its %s would be "
                               "%" PRIu64 " texels, and a texel buffer of the device has at most "
                               "%" PRIu64 " (maxTexelBufferElements)",
                               binding_name(b), (plan->buffers[b].bytes + 15) / 16,
                               gpu->max_texel_elements);
    return false;
}
