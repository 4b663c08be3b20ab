// Kernels that are recorded without a barrier between them may run in any order, or at the same
// time. Here they run in reverse order: commands between two barriers are withheld from the driver
// and then passed on in reverse. The picture must keep its bits. Also, every barrier must be
// necessary: without it, the reverse order changes the picture.
#include "base/hash.h"
#include "render/wave.h"
#include "render_fixture.h"
#include "shared/methods.h"

// --- a driver that reverses ----------------------------------------------------------------------

#define HELD_MOST 4096u

// A dispatch with everything that must be bound for it.
struct held {
    VkPipeline pipeline;
    VkPipelineLayout set_layout, push_layout;
    VkDescriptorSet set;
    uint8_t push[GPU_PUSH_BYTES];
    uint32_t push_bytes;
    uint32_t groups[3];
    VkBuffer arguments; // buffer of an indirect dispatch, or VK_NULL_HANDLE
    VkDeviceSize offset;
};

static struct driver {
    bool reverses;
    uint32_t omitted;  // number of the barrier to omit, counted from 1; 0: none
    uint32_t barriers; // number of barriers so far
    uint32_t together; // number of dispatches that had others beside them
    struct held now;   // what is bound at present
    struct held held[HELD_MOST];
    uint32_t held_count;
} driver;

static PFN_vkCmdBindPipeline real_vkCmdBindPipeline;
static PFN_vkCmdBindDescriptorSets real_vkCmdBindDescriptorSets;
static PFN_vkCmdPushConstants real_vkCmdPushConstants;
static PFN_vkCmdDispatch real_vkCmdDispatch;
static PFN_vkCmdDispatchIndirect real_vkCmdDispatchIndirect;
static PFN_vkCmdPipelineBarrier real_vkCmdPipelineBarrier;
static PFN_vkCmdCopyBuffer real_vkCmdCopyBuffer;
static PFN_vkCmdFillBuffer real_vkCmdFillBuffer;
static PFN_vkEndCommandBuffer real_vkEndCommandBuffer;

static void let_go(VkCommandBuffer commands)
{
    if (driver.held_count > 1)
        driver.together += driver.held_count;
    while (driver.held_count > 0) {
        const struct held *h = &driver.held[--driver.held_count];
        real_vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_COMPUTE, h->pipeline);
        real_vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_COMPUTE, h->set_layout, 0, 1,
                                     &h->set, 0, NULL);
        if (h->push_bytes)
            real_vkCmdPushConstants(commands, h->push_layout, VK_SHADER_STAGE_COMPUTE_BIT, 0,
                                    h->push_bytes, h->push);
        if (h->arguments)
            real_vkCmdDispatchIndirect(commands, h->arguments, h->offset);
        else
            real_vkCmdDispatch(commands, h->groups[0], h->groups[1], h->groups[2]);
    }
}

static void hold(VkCommandBuffer commands, const uint32_t groups[3], VkBuffer arguments,
                 VkDeviceSize offset)
{
    struct held *h = &driver.held[driver.held_count++];
    *h = driver.now;
    if (groups)
        memcpy(h->groups, groups, sizeof h->groups);
    h->arguments = arguments;
    h->offset = offset;
    if (!driver.reverses || driver.held_count == HELD_MOST)
        let_go(commands);
}

static VKAPI_ATTR void VKAPI_CALL my_vkCmdBindPipeline(VkCommandBuffer commands,
                                                       VkPipelineBindPoint point,
                                                       VkPipeline pipeline)
{
    (void)commands, (void)point;
    driver.now.pipeline = pipeline;
}

static VKAPI_ATTR void VKAPI_CALL my_vkCmdBindDescriptorSets(
    VkCommandBuffer commands, VkPipelineBindPoint point, VkPipelineLayout layout, uint32_t first,
    uint32_t count, const VkDescriptorSet *sets, uint32_t dynamic_count, const uint32_t *dynamic)
{
    (void)commands, (void)point, (void)dynamic;
    CHECK(first == 0 && count == 1 && dynamic_count == 0);
    driver.now.set_layout = layout;
    driver.now.set = sets[0];
}

static VKAPI_ATTR void VKAPI_CALL my_vkCmdPushConstants(VkCommandBuffer commands,
                                                        VkPipelineLayout layout,
                                                        VkShaderStageFlags stages, uint32_t offset,
                                                        uint32_t bytes, const void *values)
{
    (void)commands, (void)stages;
    CHECK(offset == 0 && bytes <= GPU_PUSH_BYTES);
    driver.now.push_layout = layout;
    driver.now.push_bytes = bytes;
    memcpy(driver.now.push, values, bytes);
}

static VKAPI_ATTR void VKAPI_CALL my_vkCmdDispatch(VkCommandBuffer commands, uint32_t x, uint32_t y,
                                                   uint32_t z)
{
    hold(commands, (uint32_t[]){x, y, z}, VK_NULL_HANDLE, 0);
}

static VKAPI_ATTR void VKAPI_CALL my_vkCmdDispatchIndirect(VkCommandBuffer commands,
                                                           VkBuffer arguments, VkDeviceSize offset)
{
    hold(commands, NULL, arguments, offset);
}

static VKAPI_ATTR void VKAPI_CALL my_vkCmdPipelineBarrier(
    VkCommandBuffer commands, VkPipelineStageFlags from, VkPipelineStageFlags to,
    VkDependencyFlags flags, uint32_t memory_count, const VkMemoryBarrier *memory,
    uint32_t buffer_count, const VkBufferMemoryBarrier *buffers, uint32_t image_count,
    const VkImageMemoryBarrier *images)
{
    if (++driver.barriers == driver.omitted)
        return;
    let_go(commands);
    real_vkCmdPipelineBarrier(commands, from, to, flags, memory_count, memory, buffer_count,
                              buffers, image_count, images);
}

static VKAPI_ATTR void VKAPI_CALL my_vkCmdCopyBuffer(VkCommandBuffer commands, VkBuffer from,
                                                     VkBuffer to, uint32_t count,
                                                     const VkBufferCopy *regions)
{
    let_go(commands);
    real_vkCmdCopyBuffer(commands, from, to, count, regions);
}

static VKAPI_ATTR void VKAPI_CALL my_vkCmdFillBuffer(VkCommandBuffer commands, VkBuffer buffer,
                                                     VkDeviceSize offset, VkDeviceSize bytes,
                                                     uint32_t value)
{
    let_go(commands);
    real_vkCmdFillBuffer(commands, buffer, offset, bytes, value);
}

static VKAPI_ATTR VkResult VKAPI_CALL my_vkEndCommandBuffer(VkCommandBuffer commands)
{
    let_go(commands);
    return real_vkEndCommandBuffer(commands);
}

// Opening the first device sets volk's pointers. Afterwards, the functions of this test are put in
// their place.
static void interpose(void)
{
#define INTERPOSE(name)                                                                            \
    if (name != my_##name)                                                                         \
    real_##name = name, name = my_##name
    INTERPOSE(vkCmdBindPipeline);
    INTERPOSE(vkCmdBindDescriptorSets);
    INTERPOSE(vkCmdPushConstants);
    INTERPOSE(vkCmdDispatch);
    INTERPOSE(vkCmdDispatchIndirect);
    INTERPOSE(vkCmdPipelineBarrier);
    INTERPOSE(vkCmdCopyBuffer);
    INTERPOSE(vkCmdFillBuffer);
    INTERPOSE(vkEndCommandBuffer);
    driver = (struct driver){0};
}

// --- pictures ------------------------------------------------------------------------------------

#define SIZE 16u
#define BOUNCES 3u
#define SAMPLES 4u // all in one wave
// Samples for which a wave has memory, so that kernels with wrong input write within it.
#define ROOM 16u

struct order_case {
    const char *name, *path;
    struct gpu_limit_overrides limits;
    uint32_t light_choice, integrator, split_lobes, aovs;
    uint32_t part_items; // 0: as planned
    // The greatest number of a wave's barriers whose omission has no effect; 0: not tested. Nothing
    // follows the last two barriers, of `accumulate` and of the submission. If hits are sorted,
    // each bounce has one between the kernels that count and that shade them: without it, shading
    // is dispatched for as many hits as there were rays, with the same picture. Shadow rays to
    // several lights may add up to the same in both orders: for two of them, such as the sky and
    // its sun at the first vertex, this is always so.
    uint32_t unseen_barriers;
};

// clang-format off
static const struct order_case order_cases[] = {
    {"one class", "scenes/cornell.json", {0}, .unseen_barriers = 2},
    {"classes and misses", "scenes/sky.json", {0}, .aovs = AOV_END - 1u,
     .unseen_barriers = 2 + BOUNCES + 1 + 1},
    {"rays sorted", "scenes/sky.json", {.sort_rays = true}, .unseen_barriers = 2 + BOUNCES + 1 + 1},
    {"media", "scenes/glass.json", {0}},
    {"shadow rays to all lights", "scenes/veach_mis.json", {0}, .light_choice = LIGHT_CHOICE_ALL,
     .unseen_barriers = 2 + 2 * BOUNCES},
    {"paths that split, in parts", "scenes/materials_clearcoat.json", {.no_ballot = true}, .split_lobes = 2,
     .part_items = 64},
    {"Whitted's rays", "scenes/whitted.json", {0}, .integrator = INTEGRATOR_WHITTED},
    {"occlusion, in parts", "scenes/cornell.json", {0}, .integrator = INTEGRATOR_AO,
     .part_items = 64},
};
// clang-format on

static void start(const struct order_case *c, struct gpu *gpu, struct scene *scene,
                  struct renderer *r)
{
    struct err err = {0};
    OPEN_GPU(gpu, .limits = c->limits);
    interpose();
    REQUIRE_OK(load_scene(c->path, NULL, scene, &err));
    scene->settings.width = scene->settings.height = SIZE;
    scene->settings.max_bounces = BOUNCES;
    scene->settings.light_choice = c->light_choice ? c->light_choice : scene->settings.light_choice;
    scene->settings.integrator = c->integrator;
    scene->settings.split_lobes = c->split_lobes;
    const struct renderer_params params = {
        .gpu = gpu, .scene = scene, .aovs = c->aovs, .wave = ROOM * SIZE * SIZE << c->split_lobes};
    REQUIRE_OK(renderer_create(&params, r, &err));
    if (c->part_items)
        r->plan.part_items = c->part_items;
}

static void end(struct gpu *gpu, struct scene *scene, struct renderer *r)
{
    renderer_finish(r);
    scene_finish(scene);
    gpu_close(gpu);
}

// Renders, and returns the hash of all layers of the film. Counts the barriers of its waves again.
static uint64_t picture(struct renderer *r)
{
    struct err err = {0};
    struct arena arena = {0};
    uint64_t hash = 0;
    const struct render_call call = {.samples = SAMPLES};
    bool ok = renderer_restart(r, 0, &err) && wave_clear_counters(r, &err);
    driver.barriers = 0;
    ok = ok && renderer_render(r, &call, &err);
    uint32_t barriers = driver.barriers;
    for (uint32_t i = 0; ok && i < r->plan.film_chunks; i++) {
        void *records = arena_alloc(&arena, r->film[i].bytes, 16);
        ok = records && gpu_download(r->gpu, &r->film[i], 0, records, r->film[i].bytes, &err);
        if (ok)
            hash = hash_bytes(hash, records, r->film[i].bytes);
    }
    CHECK(ok, "%s", err.msg);
    driver.barriers = barriers;
    arena_finish(&arena);
    return hash;
}

static void check_barriers(const struct order_case *c, struct renderer *r, uint64_t expected,
                           uint32_t count)
{
    uint32_t unseen = 0;
    for (driver.omitted = 1; driver.omitted <= count; driver.omitted++)
        unseen += picture(r) == expected;
    CHECK(unseen <= c->unseen_barriers,
          "%s: %u of %u barriers make no difference, expected at most %u", c->name, unseen, count,
          c->unseen_barriers);
}

TEST(the_opposite_order_shows_only_without_a_barrier)
{
    for (size_t i = 0; i < sizeof order_cases / sizeof order_cases[0]; i++) {
        const struct order_case *c = &order_cases[i];
        struct gpu gpu;
        struct scene scene;
        struct renderer r;
        start(c, &gpu, &scene, &r);
        uint64_t forwards = picture(&r);
        uint32_t barriers = driver.barriers;
        driver.reverses = true;
        driver.together = 0;
        CHECK(picture(&r) == forwards, "%s", c->name);
        CHECK(driver.together > 0, "%s: each dispatch was alone", c->name);
        // The known barriers are those of this way of tracing rays.
        if (c->unseen_barriers && gpu.info.is_cpu &&
            gpu.params.limits.sort_rays == c->limits.sort_rays)
            check_barriers(c, &r, forwards, barriers);
        end(&gpu, &scene, &r);
    }
}

TEST_MAIN(TEST_CASE(the_opposite_order_shows_only_without_a_barrier))
