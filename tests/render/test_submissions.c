// Tests the host's work for a wave in Vulkan calls, which are counted on their way to the driver:
// the number of submissions and barriers, and that nothing is allocated or created. On a slow
// device, the rays of probes are submitted in portions.
#include "render/probe/ray_probe.h"
#include "render_fixture.h"
#include <math.h>

// --- counting ------------------------------------------------------------------------------------

static struct calls {
    uint32_t objects; // number of objects created, including memory
    uint32_t submissions, barriers, dispatches, copies;
} calls;

// Name of the function, and type of the object that it creates.
#define CREATORS(X)                                                                                \
    X(vkCreateBuffer, VkBufferCreateInfo, VkBuffer)                                                \
    X(vkCreateCommandPool, VkCommandPoolCreateInfo, VkCommandPool)                                 \
    X(vkCreateFence, VkFenceCreateInfo, VkFence)                                                   \
    X(vkCreateQueryPool, VkQueryPoolCreateInfo, VkQueryPool)                                       \
    X(vkCreateDescriptorPool, VkDescriptorPoolCreateInfo, VkDescriptorPool)                        \
    X(vkAllocateMemory, VkMemoryAllocateInfo, VkDeviceMemory)

#define X(name, info_type, type)                                                                   \
    static PFN_##name real_##name;                                                                 \
    static VKAPI_ATTR VkResult VKAPI_CALL count_##name(                                            \
        VkDevice device, const info_type *info, const VkAllocationCallbacks *allocator, type *out) \
    {                                                                                              \
        calls.objects++;                                                                           \
        return real_##name(device, info, allocator, out);                                          \
    }
CREATORS(X)
#undef X

static PFN_vkAllocateCommandBuffers real_vkAllocateCommandBuffers;
static VKAPI_ATTR VkResult VKAPI_CALL count_vkAllocateCommandBuffers(
    VkDevice device, const VkCommandBufferAllocateInfo *info, VkCommandBuffer *out)
{
    calls.objects++;
    return real_vkAllocateCommandBuffers(device, info, out);
}

static PFN_vkAllocateDescriptorSets real_vkAllocateDescriptorSets;
static VKAPI_ATTR VkResult VKAPI_CALL count_vkAllocateDescriptorSets(
    VkDevice device, const VkDescriptorSetAllocateInfo *info, VkDescriptorSet *out)
{
    calls.objects++;
    return real_vkAllocateDescriptorSets(device, info, out);
}

static PFN_vkCreateComputePipelines real_vkCreateComputePipelines;
static VKAPI_ATTR VkResult VKAPI_CALL
count_vkCreateComputePipelines(VkDevice device, VkPipelineCache cache, uint32_t count,
                               const VkComputePipelineCreateInfo *infos,
                               const VkAllocationCallbacks *allocator, VkPipeline *out)
{
    calls.objects += count;
    return real_vkCreateComputePipelines(device, cache, count, infos, allocator, out);
}

static PFN_vkQueueSubmit real_vkQueueSubmit;
static VKAPI_ATTR VkResult VKAPI_CALL count_vkQueueSubmit(VkQueue queue, uint32_t count,
                                                          const VkSubmitInfo *infos, VkFence fence)
{
    calls.submissions += count;
    return real_vkQueueSubmit(queue, count, infos, fence);
}

static PFN_vkCmdPipelineBarrier real_vkCmdPipelineBarrier;
static VKAPI_ATTR void VKAPI_CALL count_vkCmdPipelineBarrier(
    VkCommandBuffer commands, VkPipelineStageFlags from, VkPipelineStageFlags to,
    VkDependencyFlags flags, uint32_t memory_count, const VkMemoryBarrier *memory,
    uint32_t buffer_count, const VkBufferMemoryBarrier *buffers, uint32_t image_count,
    const VkImageMemoryBarrier *images)
{
    calls.barriers++;
    real_vkCmdPipelineBarrier(commands, from, to, flags, memory_count, memory, buffer_count,
                              buffers, image_count, images);
}

static PFN_vkCmdDispatch real_vkCmdDispatch;
static VKAPI_ATTR void VKAPI_CALL count_vkCmdDispatch(VkCommandBuffer commands, uint32_t x,
                                                      uint32_t y, uint32_t z)
{
    calls.dispatches++;
    real_vkCmdDispatch(commands, x, y, z);
}

static PFN_vkCmdDispatchIndirect real_vkCmdDispatchIndirect;
static VKAPI_ATTR void VKAPI_CALL count_vkCmdDispatchIndirect(VkCommandBuffer commands,
                                                              VkBuffer arguments,
                                                              VkDeviceSize offset)
{
    calls.dispatches++;
    real_vkCmdDispatchIndirect(commands, arguments, offset);
}

static PFN_vkCmdCopyBuffer real_vkCmdCopyBuffer;
static VKAPI_ATTR void VKAPI_CALL count_vkCmdCopyBuffer(VkCommandBuffer commands, VkBuffer from,
                                                        VkBuffer to, uint32_t count,
                                                        const VkBufferCopy *regions)
{
    calls.copies += count;
    real_vkCmdCopyBuffer(commands, from, to, count, regions);
}

// Opening the first device sets volk's pointers. Afterwards, the functions of this test are put in
// their place.
static void count_calls(void)
{
#define INTERPOSE(name)                                                                            \
    if (name != count_##name)                                                                      \
        real_##name = name, name = count_##name;
#define X(name, info_type, type) INTERPOSE(name)
    CREATORS(X)
#undef X
    INTERPOSE(vkAllocateCommandBuffers)
    INTERPOSE(vkAllocateDescriptorSets)
    INTERPOSE(vkCreateComputePipelines)
    INTERPOSE(vkQueueSubmit)
    INTERPOSE(vkCmdPipelineBarrier)
    INTERPOSE(vkCmdDispatch)
    INTERPOSE(vkCmdDispatchIndirect)
    INTERPOSE(vkCmdCopyBuffer)
}

// --- waves ---------------------------------------------------------------------------------------

#define SAMPLES 16u // after the first samples, for which kernels are compiled
#define BOUNCES 4u  // few enough for a single submission

// The expected calls for a wave. With pacing, submissions are divided by time.
struct expected {
    const char *path;
    struct gpu_limit_overrides limits;
    uint32_t submissions, barriers, dispatches, copies;
};

static bool render(struct renderer *r, uint64_t samples, struct err *err)
{
    const struct render_call call = {.samples = samples};
    return renderer_render(r, &call, err);
}

static void check_count(const char *path, const char *what, uint32_t count, uint32_t expected,
                        uint64_t waves)
{
    printf("%s: %s a wave: %.4g\n", path, what, (double)count / (double)waves);
    CHECK(count == expected * waves, "%s: %u %s in %llu waves, expected %u a wave", path, count,
          what, (unsigned long long)waves, expected);
}

static void check_waves(const struct expected *expected)
{
    struct gpu gpu;
    struct scene scene;
    struct renderer r;
    struct err err = {0};
    OPEN_GPU(&gpu, .limits = expected->limits);
    count_calls();
    REQUIRE_OK(load_scene(expected->path, NULL, &scene, &err));
    scene.settings.width = scene.settings.height = 32;
    scene.settings.max_bounces = BOUNCES;
    const struct renderer_params params = {.gpu = &gpu, .scene = &scene, .wave = 1024};
    REQUIRE_OK(renderer_create(&params, &r, &err));
    CHECK(render(&r, 1, &err), "%s", err.msg);
    uint64_t waves = r.stats.waves;
    calls = (struct calls){0};
    CHECK(render(&r, SAMPLES, &err), "%s", err.msg);
    waves = r.stats.waves - waves;
    CHECK(waves > 1, "%llu waves", (unsigned long long)waves);
    check_count(expected->path, "objects", calls.objects, 0, waves);
    if (!r.pace.is_on) {
        check_count(expected->path, "submissions", calls.submissions, expected->submissions, waves);
        check_count(expected->path, "barriers", calls.barriers, expected->barriers, waves);
        check_count(expected->path, "dispatches", calls.dispatches, expected->dispatches, waves);
        check_count(expected->path, "copies", calls.copies, expected->copies, waves);
    }
    renderer_finish(&r);
    scene_finish(&scene);
    gpu_close(&gpu);
}

TEST(a_wave_creates_nothing)
{
    // clang-format off
    static const struct expected rows[] = {
        {"scenes/cornell.json", {0}, 1, 18, 21, 0},
        {"scenes/classical.json", {0}, 1, 23, 36, 0},
        // As on a device whose memory the host cannot access.
        {"scenes/cornell.json", {.no_mapped_device = true}, 1, 18, 21, 1},
        {"scenes/classical.json", {.no_mapped_device = true}, 1, 23, 36, 1},
    };
    // clang-format on
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++)
        check_waves(&rows[i]);
}

// The device's workgroups take 2 ms, and it is lost after 250 ms, which all rays at once would
// exceed.
TEST(probes_are_paced)
{
    enum { RAYS = 16000 };
    static struct probe_ray rays[RAYS];
    static struct probe_hit hits[RAYS];
    struct gpu gpu;
    struct scene scene;
    struct renderer r;
    struct err err = {0};
    double ms;
    bool complete;
    OPEN_GPU(&gpu, .limits = {.group_ns = 2000000, .watchdog_ms = 250});
    count_calls();
    REQUIRE_OK(load_scene("scenes/cornell.json", NULL, &scene, &err));
    const struct renderer_params params = {.gpu = &gpu, .scene = &scene, .wave = 1u << 16};
    REQUIRE_OK(renderer_create(&params, &r, &err));
    for (int i = 0; i < RAYS; i++)
        rays[i] = (struct probe_ray){.origin = {0, 1, 0}, .direction = {0, i % 2 ? 1 : -1, 0}};
    calls = (struct calls){0};
    CHECK(ray_probe_trace(&r, KERNEL_intersect_closest, rays, RAYS, hits, &ms, &complete, &err),
          "%s", err.msg);
    CHECK(calls.submissions > 2, "%u submissions", calls.submissions);
    double expected_ms = 2.0 * RAYS / r.specialization.workgroup;
    CHECK(!gpu.has_timestamps || fabs(ms - expected_ms) < 0.1 * expected_ms, "%g ms", ms);
    for (int i = 2; i < RAYS; i++)
        if (memcmp(&hits[i], &hits[i - 2], sizeof hits[i]) != 0) {
            CHECK(false, "ray %d", i);
            break;
        }
    CHECK(hits[0].primitive != hits[1].primitive);
    renderer_finish(&r);
    scene_finish(&scene);
    gpu_close(&gpu);
}

TEST_MAIN(TEST_CASE(a_wave_creates_nothing), TEST_CASE(probes_are_paced))
