#include "check/bits.h"

#include "base/hash.h"
#include "check/case_list.h"
#include "check/embedded_scene.h"
#include <inttypes.h>
#include <stdio.h>
#include <string.h>

// The limits of the variants are far below those that Vulkan guarantees, because the images are
// small.
// clang-format off
const struct bits_variant bits_variants[] = {
    {"again", {0}},
    {"waves of 2^10", {0}, .wave = 1u << 10},
    {"waves of 2^14", {0}, .wave = 1u << 14},
    {"waves of 2^20", {0}, .wave = 1u << 20},
    {"waves of 352", {0}, .wave = 352, .representative = true},
    {"split 1 + 2 + 29", {0}, .first_calls = {1, 2}},
    {"split 13 + 10 + 9", {0}, .first_calls = {13, 10}, .representative = true},
    {"restarted", {0}, .restarted = true},
    {"with all features", {0}, .compile_all = true, .representative = true},
    {"without texel buffers", {.no_texel = true}, .from_storage = true},
    {"without ballot", {.no_ballot = true}},
    {"without mapped device memory", {.no_mapped_device = true}},
    {"storage buffers of 64 KiB", {.storage_range = 1u << 16}},
    {"allocations of 64 KiB", {.allocation = 1u << 16}},
    {"65536 texels", {.texel_elements = 65536}},
    {"1024 texels", {.texel_elements = 1024}, .representative = true},
    {"16 texels", {.texel_elements = 16}, .from_storage = true},
    {"stack in shared memory", {.shared_stack = true}},
    {"stack in 2 KiB of shared memory", {.shared_stack = true, .shared_memory = 2048},
     .representative = true},
    {"all at once",
     {.no_texel = true, .no_ballot = true, .no_mapped_device = true, .storage_range = 1u << 16,
      .shared_stack = true},
     .from_storage = true, .wave = 1u << 10, .compile_all = true, .first_calls = {3, 16},
     .representative = true},
    {"two waves in flight", {.waves = 2}, .wave = 352, .representative = true},
    {"rays sorted", {.sort_rays = true}, .representative = true},
    {"rays sorted in two waves, without ballot",
     {.sort_rays = true, .waves = 2, .no_ballot = true, .no_texel = true}, .from_storage = true,
     .wave = 352},
};
// clang-format on
const size_t bits_variant_count = sizeof bits_variants / sizeof bits_variants[0];

// --- pictures ------------------------------------------------------------------------------------

static bool render_samples(struct renderer *r, uint64_t samples, struct err *err)
{
    const struct render_call call = {.samples = samples};
    return renderer_render(r, &call, err);
}

static bool render_split(struct renderer *r, const struct bits_variant *variant, struct err *err)
{
    const uint32_t *first = variant->first_calls;
    uint32_t seed = r->scene->settings.seed;
    return (!variant->restarted ||
            (render_samples(r, 7, err) && renderer_restart(r, seed + 1, err) &&
             render_samples(r, 5, err) && renderer_restart(r, seed, err))) &&
           render_samples(r, first[0], err) && render_samples(r, first[1], err) &&
           render_samples(r, BITS_SAMPLES - first[0] - first[1], err);
}

// The film must need several buffers when the variant lowers the limits, whatever the device's own
// limits are.
static bool render_on(struct gpu *gpu, const struct scene *scene,
                      const struct bits_variant *variant, struct arena *arena,
                      struct film_image *film, struct err *err)
{
    struct renderer renderer;
    const struct renderer_params params = {
        .gpu = gpu, .scene = scene, .wave = variant->wave, .compile_all = variant->compile_all};
    if (!renderer_create(&params, &renderer, err))
        return false;
    bool lowered = variant->limits.storage_range || variant->limits.allocation, ok = true;
    if (lowered && renderer.plan.film_chunks <= 1)
        ok = err_set(err, ERR_BUG, "%s: the film has one buffer; expected several", variant->name);
    ok = ok && render_split(&renderer, variant, err) && renderer_read(&renderer, arena, film, err);
    renderer_finish(&renderer);
    return ok;
}

bool bits_render(struct gpu *gpu, const struct scene *scene, const struct bits_variant *variant,
                 struct arena *arena, struct film_image *film, struct err *err)
{
    static const struct gpu_limit_overrides none;
    struct gpu_params params = gpu->params;
    struct gpu limited;
    if (memcmp(&variant->limits, &none, sizeof none) == 0)
        return render_on(gpu, scene, variant, arena, film, err);
    params.limits = variant->limits;
    if (!gpu_open(&params, &limited, err))
        return false;
    bool ok = render_on(&limited, scene, variant, arena, film, err);
    gpu->lost |= limited.lost;
    gpu_close(&limited);
    gpu->validation_messages += limited.validation_messages;
    return ok;
}

bool bits_are_same(const struct film_image *a, const struct film_image *b)
{
    size_t pixels = (size_t)a->width * a->height;
    return a->width == b->width && a->height == b->height &&
           memcmp(a->mean, b->mean, pixels * sizeof *a->mean) == 0 &&
           memcmp(a->half_a, b->half_a, pixels * sizeof *a->half_a) == 0 &&
           memcmp(a->half_b, b->half_b, pixels * sizeof *a->half_b) == 0 &&
           memcmp(a->samples, b->samples, pixels * sizeof *a->samples) == 0;
}

// --- as cases ------------------------------------------------------------------------------------

static uint64_t film_hash(const struct film_image *film)
{
    size_t pixels = (size_t)film->width * film->height;
    uint64_t hash = hash_bytes(HASH_INIT, film->mean, pixels * sizeof *film->mean);
    hash = hash_bytes(hash, film->half_a, pixels * sizeof *film->half_a);
    return hash_bytes(hash, film->half_b, pixels * sizeof *film->half_b);
}

// Counts the pixels that are not black: if all were black, equal images would prove nothing.
static size_t lit_pixels(const struct film_image *film)
{
    size_t lit = 0;
    for (size_t i = 0; i < (size_t)film->width * film->height; i++)
        lit += film->mean[i][0] > 0.0f;
    return lit;
}

static bool compare(const struct check *check, const struct scene *scene,
                    const struct bits_variant *variant, struct arena *arena,
                    struct check_result *result, struct err *err)
{
    static const struct bits_variant plain = {"plain", {0}};
    struct film_image expected, film;
    if (!bits_render(check->gpu, scene, &plain, arena, &expected, err) ||
        !bits_render(check->gpu, scene, variant, arena, &film, err))
        return false;
    if (check->arena)
        result->picture = (struct check_picture){film.width, film.height, film.mean};
    bool lit = lit_pixels(&expected) > (size_t)film.width * film.height / 2;
    snprintf(result->expected, sizeof result->expected, "%016" PRIx64, film_hash(&expected));
    if (!lit)
        snprintf(result->why, sizeof result->why,
                 "the expected image is mostly black, so equal images prove nothing");
    return check_seen(result, lit && bits_are_same(&film, &expected), "%016" PRIx64,
                      film_hash(&film));
}

static bool run_variant(const struct check *check, const struct check_case *this_case,
                        struct check_result *result, struct err *err)
{
    static const struct scene_override small[] = {
        {"film.width", "48"}, {"film.height", "32"}, {"settings.max_bounces", "6"}, {0}};
    const struct bits_variant *variant = this_case->data;
    struct arena arena = {0};
    struct scene scene;
    // On GPUs, compilers may contract floating-point operations differently when kernels contain
    // additional code (docs/design.md).
    if (variant->compile_all && !check->gpu->info.is_cpu)
        return check_not_run(result,
                             "additional features in kernels may change the rounding on this "
                             "device; only CPUs are required to keep the bits");
    if (variant->from_storage && check->gpu->storage_count < SHADING_STORAGE)
        return check_not_run(
            result, "the device binds too few storage buffers to do without texel buffers");
    if (!embedded_scene_load("cornell.json", small, &scene, err))
        return false;
    bool ok = compare(check, &scene, variant, check->arena ? check->arena : &arena, result, err);
    scene_finish(&scene);
    arena_finish(&arena);
    return ok;
}

#define SAME(number, words, index)                                                                 \
    {                                                                                              \
        .name = number " " words, .expected = "the same bits", .run = run_variant,                 \
        .data = &bits_variants[index]                                                              \
    }
#define LONG_SAME(number, words, index)                                                            \
    {                                                                                              \
        .name = number " " words, .expected = "the same bits", .run = run_variant,                 \
        .data = &bits_variants[index], .is_long = true                                             \
    }

static const struct check_case cases[] = {
    SAME("G1", "the Cornell box again", 0),
    SAME("G1", "waves of 2^10 paths", 1),
    SAME("G1", "waves of 2^14 paths", 2),
    SAME("G1", "waves of 2^20 paths", 3),
    SAME("G1", "waves of 352 paths", 4),
    SAME("G1", "samples split 1 + 2 + 29", 5),
    SAME("G1", "samples split 13 + 10 + 9", 6),
    SAME("G1", "after a restart", 7),
    LONG_SAME("G2", "all features compiled in", 8),
    SAME("G3", "without texel buffers", 9),
    SAME("G3", "without ballot", 10),
    SAME("G3", "without mapped device memory", 11),
    SAME("G3", "storage buffers of 64 KiB", 12),
    SAME("G3", "allocations of 64 KiB", 13),
    SAME("G3", "65536 texels", 14),
    SAME("G3", "1024 texels", 15),
    SAME("G3", "16 texels", 16),
    SAME("G3", "traversal stack in shared memory", 17),
    SAME("G3", "traversal stack in 2 KiB of shared memory", 18),
    LONG_SAME("G3", "all of these at once", 19),
    SAME("G1", "two waves in flight", 20),
    SAME("G1", "rays sorted by octant and cell", 21),
    SAME("G1", "rays sorted in two waves in flight", 22),
};

CHECK_GROUP(check_bits, "bits", "variations that must not change one bit of an image", cases);
