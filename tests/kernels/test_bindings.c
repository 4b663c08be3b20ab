// Tests kernels on devices that bind few buffers at once: Vulkan guarantees 4 storage buffers and
// 16 texel buffers.
#include "gpu/spirv_bindings.h"
#include "gpu/spirv_trim.h"
#include "kernel_fixture.h"
#include "render/kernels.h"
#include "shared/sdf.h"
#include <stdlib.h>

#define TEXELS (FEATURE_TEXEL_SCENE | FEATURE_TEXEL_STATE)

struct counts {
    uint32_t storage, texels;
};

static uint32_t count_bits(uint64_t bits, uint32_t from, uint32_t end)
{
    return (uint32_t)__builtin_popcountll(bits >> from & ((UINT64_C(1) << (end - from)) - 1));
}

// Counts the buffers for everything that a scene may need, at once.
static struct counts count(struct kernel_code code, uint32_t integrator, uint32_t features)
{
    const struct specialization all = {
        .features = features,
        .workgroup = 64,
        .stack_entries = 32,
        .iteration_budget = 1000,
        .interleave = 1,
        .lobes = LOBE_END - 1,
        .queues = (1u << QUEUE_COUNT) - 1,
        .emitters = EMITTERS_ALL,
        .aovs = AOV_END - 1,
        .integrator = integrator,
        .light_rays = 1,
        .geometry = GEOMETRY_END - 1,
        .sdf = UINT32_MAX,
    };
    struct counts counts = {0};
    uint32_t *trimmed = malloc(code.bytes);
    size_t bytes = trimmed ? spirv_trim(code.spirv, code.bytes, (const uint32_t *)&all,
                                        CONSTANT_COUNT, trimmed)
                           : 0;
    bool is_trimmed = bytes > 0 && bytes != SPIRV_TRIM_NO_MEMORY;
    CHECK(is_trimmed, "%s cannot be trimmed", code.name);
    uint64_t bindings = is_trimmed ? spirv_bindings(trimmed, bytes) : 0;
    counts.storage = count_bits(bindings, 0, GPU_FIRST_STORAGE) +
                     count_bits(bindings, GPU_UNIFORM_BINDING + 1, GPU_MAX_BINDINGS);
    counts.texels = count_bits(bindings, TEXEL_BINDING_FIRST, GPU_UNIFORM_BINDING);
    free(trimmed);
    return counts;
}

// Returns the greatest numbers over all kernels.
static struct counts count_most(uint32_t features)
{
    static const uint32_t integrators[] = {INTEGRATOR_PATH, INTEGRATOR_AO, INTEGRATOR_WHITTED};
    struct counts most = {0};
    for (uint32_t i = 0; i < 3 * 2 * KERNEL_COUNT; i++) {
        struct kernel_code code = kernel_code((enum kernel_id)(i / 6), i & 1);
        struct counts counts = count(code, integrators[i / 2 % 3], features);
        most.storage = counts.storage > most.storage ? counts.storage : most.storage;
        most.texels = counts.texels > most.texels ? counts.texels : most.texels;
    }
    return most;
}

TEST(no_scene_needs_more_than_vulkan_guarantees)
{
    struct counts as_texels = count_most(UINT32_MAX);
    struct counts scene_as_texels = count_most(~FEATURE_TEXEL_STATE);
    struct counts no_texels = count_most(~TEXELS);
    printf("storage and texel buffers at most: %u and %u, of scenes alone %u and %u, without %u\n",
           as_texels.storage, as_texels.texels, scene_as_texels.storage, scene_as_texels.texels,
           no_texels.storage);
    CHECK(as_texels.storage == STATE_STORAGE && scene_as_texels.storage == STATE_STORAGE);
    CHECK(STATE_STORAGE <= 4 && as_texels.texels <= 16 && scene_as_texels.texels <= 16);
    CHECK(no_texels.storage == SHADING_STORAGE && no_texels.texels == 0);
}

static bool reads_texels(struct gpu *gpu, const struct scene *scene)
{
    struct renderer r;
    struct err err = {0};
    bool ok = renderer_prepare(&(struct renderer_params){.gpu = gpu, .scene = scene}, &r, &err);
    CHECK(ok, "%s", err.msg);
    bool reads = ok && (r.specialization.features & FEATURE_TEXEL_SCENE);
    renderer_finish(&r);
    return reads;
}

// Devices other than CPUs read scenes through texel buffers if shading may need more storage
// buffers than a kernel may bind, and if the scenes are short enough.
TEST(texels_replace_storage_buffers)
{
    struct gpu gpu;
    struct scene scene;
    OPEN_GPU(&gpu, .validation = false);
    scene_start(&scene, 8, 8);
    scene.environment = (struct environment){.present = true, .radiance = {1, 1, 1}};
    if (gpu.max_texel_elements >= 65536) {
        gpu.info.is_cpu = false;
        gpu.storage_count = SHADING_STORAGE;
        CHECK(!reads_texels(&gpu, &scene));
        gpu.storage_count = SHADING_STORAGE - 1;
        CHECK(reads_texels(&gpu, &scene));
        gpu.max_texel_elements = 1;
        CHECK(!reads_texels(&gpu, &scene));
    }
    scene_finish(&scene);
    gpu_close(&gpu);
}

TEST_MAIN(TEST_CASE(no_scene_needs_more_than_vulkan_guarantees),
          TEST_CASE(texels_replace_storage_buffers))
