// Kernels: bindings, constants, push constants, indirect dispatch, ballot, timestamps.
#include "gpu_fixture.h"

#include "compact_test.spv.h"
#include "write_arguments_test.spv.h"

// A prime number, so that the last workgroup and the last subgroup are not full.
#define COUNT 10007u

struct pair {
    struct gpu_buffer from, to;
    struct gpu_bindings bindings;
    struct gpu_commands commands;
    uint32_t *result;
};

// `from` contains element(0 .. count-1); `to` has room for count + 1 elements.
static bool pair_create(struct gpu *gpu, uint32_t count, bool texel, struct pair *out,
                        struct err *err)
{
    *out = (struct pair){0};
    uint32_t *data = elements_new(count);
    out->result = calloc(count + 1, sizeof *out->result);
    bool ok = data && out->result &&
              gpu_buffer_create(gpu, "from", count * 4, GPU_DEVICE, texel, &out->from, err) &&
              gpu_buffer_create(gpu, "to", (count + 1) * 4, GPU_DEVICE, false, &out->to, err) &&
              gpu_upload(gpu, &out->from, 0, data, count * 4, err) &&
              pair_bindings_create(gpu, &out->from, &out->to, &out->bindings, err) &&
              gpu_commands_create(gpu, &out->commands, err);
    free(data);
    return ok;
}

static void pair_finish(struct gpu *gpu, struct pair *pair)
{
    gpu_commands_finish(gpu, &pair->commands);
    gpu_bindings_finish(gpu, &pair->bindings);
    gpu_buffer_finish(gpu, &pair->to);
    gpu_buffer_finish(gpu, &pair->from);
    free(pair->result);
}

// Submits the recorded commands, and reads `to` into `result`.
static bool pair_run(struct gpu *gpu, struct pair *pair, struct err *err)
{
    return gpu_submit(gpu, &pair->commands, err) && gpu_wait(gpu, &pair->commands, err) &&
           gpu_download(gpu, &pair->to, 0, pair->result, pair->to.bytes, err);
}

static void check_copy(bool texel, bool staged)
{
    struct gpu gpu;
    OPEN_GPU(&gpu, .validation = true, .limits.no_mapped_device = staged);
    struct pair pair;
    struct gpu_kernel kernel = {0};
    struct err err = {0};
    if (pair_create(&gpu, COUNT, texel, &pair, &err) &&
        copy_kernel_create(&gpu, 3, texel, &kernel, &err) &&
        gpu_begin(&gpu, &pair.commands, &err)) {
        const struct copy_push push = {.count = COUNT, .addend = 7};
        gpu_bind(&gpu, &pair.commands, &pair.bindings);
        gpu_push(&gpu, &pair.commands, &push, sizeof push);
        gpu_dispatch(&gpu, &pair.commands, &kernel, groups_for(COUNT));
        CHECK(pair_run(&gpu, &pair, &err), "%s", err.msg);
        uint32_t wrong = 0;
        for (uint32_t i = 0; i < COUNT; i++)
            wrong += pair.result[i] != element(i) * 3 + 7;
        CHECK(wrong == 0, "%u of %u elements", wrong, COUNT);
        CHECK(pair.result[COUNT] == 0, "written past the count");
    } else {
        CHECK(false, "%s", err.msg);
    }
    gpu_kernel_finish(&gpu, &kernel);
    pair_finish(&gpu, &pair);
    gpu_close(&gpu);
    CHECK(gpu.validation_messages == 0, "%u", gpu.validation_messages);
}

TEST(copy_through_storage_buffers)
{
    check_copy(false, false);
    check_copy(false, true);
}

TEST(copy_through_a_texel_buffer)
{
    check_copy(true, false);
    check_copy(true, true);
}

static bool run_copy(struct gpu *gpu, struct pair *pair, const struct gpu_kernel *kernel,
                     uint32_t factor, struct err *err)
{
    const struct copy_push push = {.count = COUNT, .addend = 7};
    if (!gpu_begin(gpu, &pair->commands, err))
        return false;
    gpu_bind(gpu, &pair->commands, &pair->bindings);
    gpu_push(gpu, &pair->commands, &push, sizeof push);
    gpu_dispatch(gpu, &pair->commands, kernel, groups_for(COUNT));
    if (!pair_run(gpu, pair, err))
        return false;
    for (uint32_t i = 0; i < COUNT; i++)
        if (pair->result[i] != element(i) * factor + 7)
            return err_set(err, ERR_BUG, "element %u is %u", i, pair->result[i]);
    return true;
}

// The copy kernel uses two storage buffers, or one and a texel buffer. A device that supports only
// one storage buffer at once refuses only the first form, with the reason.
TEST(a_kernel_binds_what_it_names)
{
    struct gpu gpu;
    OPEN_GPU(&gpu, .validation = true, .limits = {.storage_count = 1, .texel_count = 1});
    struct pair pair;
    struct gpu_kernel storage = {0}, texel = {0};
    struct err err = {0};
    CHECK(gpu.storage_count == 1 && gpu.texel_count == 1);
    CHECK(pair_create(&gpu, COUNT, true, &pair, &err) &&
              copy_kernel_create(&gpu, 3, true, &texel, &err) &&
              run_copy(&gpu, &pair, &texel, 3, &err),
          "%s", err.msg);
    char expected[512];
    snprintf(expected, sizeof expected,
             "kernel copy: it binds 2 storage buffers at once; the limit of %s is 1 "
             "(maxPerStageDescriptorStorageBuffers)",
             gpu.info.name);
    CHECK(!copy_kernel_create(&gpu, 3, false, &storage, &err) && err.code == ERR_GPU &&
              strcmp(err.msg, expected) == 0,
          "%s", err.msg);
    gpu_kernel_finish(&gpu, &storage);
    gpu_kernel_finish(&gpu, &texel);
    pair_finish(&gpu, &pair);
    gpu_close(&gpu);
    CHECK(gpu.validation_messages == 0, "%u", gpu.validation_messages);
}

// Kernels of two layouts alternate with the same bindings, and both use other buffers after these
// are bound. A third kernel has the layout of the first.
TEST(layouts_share_bindings)
{
    struct gpu gpu;
    OPEN_GPU(&gpu, .validation = true);
    struct pair pair;
    struct gpu_kernel storage = {0}, texel = {0}, other = {0};
    struct gpu_buffer further = {0};
    struct err err = {0};
    bool ok = pair_create(&gpu, COUNT, true, &pair, &err) &&
              gpu_buffer_create(&gpu, "further", COUNT * 4, GPU_DEVICE, true, &further, &err) &&
              copy_kernel_create(&gpu, 3, false, &storage, &err) &&
              copy_kernel_create(&gpu, 5, true, &texel, &err) &&
              copy_kernel_create(&gpu, 9, false, &other, &err);
    CHECK(ok && storage.layout == other.layout && storage.layout != texel.layout);
    for (int turn = 0; turn < 2; turn++)
        CHECK(run_copy(&gpu, &pair, &storage, 3, &err) && run_copy(&gpu, &pair, &texel, 5, &err),
              "%s", err.msg);
    struct gpu_buffer from = pair.from;
    pair.from = further; // contains zeros
    const struct gpu_binding bound[GPU_MAX_STORAGE] = {{.buffer = &pair.from},
                                                       {.buffer = &pair.to}};
    const struct gpu_buffer *const texels[GPU_MAX_TEXEL] = {&pair.from};
    CHECK(gpu_bindings_write(&gpu, bound, texels, NULL, &pair.bindings, &err), "%s", err.msg);
    CHECK(!run_copy(&gpu, &pair, &storage, 3, &err) && pair.result[1] == 7);
    CHECK(!run_copy(&gpu, &pair, &texel, 5, &err) && pair.result[1] == 7);
    gpu_kernel_finish(&gpu, &other);
    gpu_kernel_finish(&gpu, &texel);
    gpu_kernel_finish(&gpu, &storage);
    gpu_buffer_finish(&gpu, &from);
    pair_finish(&gpu, &pair);
    gpu_close(&gpu);
    CHECK(gpu.validation_messages == 0, "%u", gpu.validation_messages);
}

// A binding of a range begins at the range's first element and ends with its last.
TEST(bindings_respect_offset_and_range)
{
    struct gpu gpu;
    OPEN_GPU(&gpu, .device = NULL);
    struct pair pair;
    struct gpu_kernel kernel = {0};
    struct gpu_bindings bindings = {0};
    struct err err = {0};
    uint32_t skip = 64; // 256 bytes, the largest storage_alignment that Vulkan allows
    bool ok = pair_create(&gpu, COUNT, false, &pair, &err) &&
              copy_kernel_create(&gpu, 1, false, &kernel, &err);
    const struct gpu_binding storage[GPU_MAX_STORAGE] = {
        {.buffer = &pair.from, .offset = skip * 4},
        {.buffer = &pair.to, .offset = skip * 8, .bytes = 512},
    };
    if (ok && gpu_bindings_create(&gpu, storage, NULL, NULL, &bindings, &err) &&
        gpu_begin(&gpu, &pair.commands, &err)) {
        const struct copy_push push = {.count = 128};
        gpu_bind(&gpu, &pair.commands, &bindings);
        gpu_push(&gpu, &pair.commands, &push, sizeof push);
        gpu_dispatch(&gpu, &pair.commands, &kernel, groups_for(128));
        CHECK(pair_run(&gpu, &pair, &err), "%s", err.msg);
        for (uint32_t i = 0; i < COUNT; i++) {
            bool inside = i >= 2 * skip && i < 2 * skip + 128;
            uint32_t expected = inside ? element(i - skip) : 0;
            if (pair.result[i] != expected) {
                CHECK(false, "element %u is %u, expected %u", i, pair.result[i], expected);
                break;
            }
        }
    } else {
        CHECK(false, "%s", err.msg);
    }
    gpu_bindings_finish(&gpu, &bindings);
    gpu_kernel_finish(&gpu, &kernel);
    pair_finish(&gpu, &pair);
    gpu_close(&gpu);
}

// A kernel writes the arguments of the next dispatch, and is run again after a fill has overwritten
// them. This covers all hazards of indirect dispatches.
TEST(indirect_dispatch_after_a_kernel)
{
    struct gpu gpu;
    OPEN_GPU(&gpu, .validation = true);
    const uint32_t constants[] = {1, GROUP}, count = 1000;
    const struct gpu_kernel_params params = {
        .name = "write_arguments",
        .spirv = write_arguments_spirv,
        .spirv_bytes = sizeof write_arguments_spirv,
        .constants = constants,
        .constant_count = 2,
    };
    struct pair pair;
    struct gpu_buffer counter = {0}, arguments = {0};
    struct gpu_bindings write_bindings = {0};
    struct gpu_kernel write = {0}, copy = {0};
    struct err err = {0};
    if (pair_create(&gpu, COUNT, false, &pair, &err) &&
        gpu_buffer_create(&gpu, "counter", 4, GPU_DEVICE, false, &counter, &err) &&
        gpu_buffer_create(&gpu, "arguments", 32, GPU_DEVICE, false, &arguments, &err) &&
        pair_bindings_create(&gpu, &counter, &arguments, &write_bindings, &err) &&
        gpu_kernel_create(&gpu, &params, &write, &err) &&
        copy_kernel_create(&gpu, 1, false, &copy, &err) && gpu_begin(&gpu, &pair.commands, &err)) {
        struct copy_push push = {.count = COUNT, .addend = 1};
        for (uint32_t round = 1; round <= 2; round++) {
            gpu_fill(&gpu, &pair.commands, &counter, 0, 4, count * round);
            gpu_fill(&gpu, &pair.commands, &arguments, 0, 32, 0);
            gpu_barrier(&gpu, &pair.commands);
            gpu_bind(&gpu, &pair.commands, &write_bindings);
            gpu_dispatch(&gpu, &pair.commands, &write, 1);
            gpu_barrier(&gpu, &pair.commands);
            push.addend = round;
            gpu_bind(&gpu, &pair.commands, &pair.bindings);
            gpu_push(&gpu, &pair.commands, &push, sizeof push);
            gpu_dispatch_indirect(&gpu, &pair.commands, &copy, &arguments, 0);
            gpu_barrier(&gpu, &pair.commands);
        }
        CHECK(pair_run(&gpu, &pair, &err), "%s", err.msg);
        // Whole workgroups run: in the second round 2000 threads, rounded up.
        uint32_t end = groups_for(2 * count) * GROUP, wrong = 0;
        for (uint32_t i = 0; i < COUNT; i++)
            wrong += pair.result[i] != (i < end ? element(i) + 2 : 0);
        CHECK(wrong == 0, "%u of %u elements", wrong, COUNT);
    } else {
        CHECK(false, "%s", err.msg);
    }
    gpu_kernel_finish(&gpu, &copy);
    gpu_kernel_finish(&gpu, &write);
    gpu_bindings_finish(&gpu, &write_bindings);
    gpu_buffer_finish(&gpu, &arguments);
    gpu_buffer_finish(&gpu, &counter);
    pair_finish(&gpu, &pair);
    gpu_close(&gpu);
    CHECK(gpu.validation_messages == 0, "%u", gpu.validation_messages);
}

static int compare_elements(const void *a, const void *b)
{
    uint32_t x = *(const uint32_t *)a, y = *(const uint32_t *)b;
    return (x > y) - (x < y);
}

// Each odd element must occur once: element(i) is odd exactly for odd i, and the hash is a
// bijection.
static void check_compacted(uint32_t *result, uint32_t count)
{
    uint32_t kept = 0;
    uint32_t *expected = malloc(count * sizeof *expected);
    REQUIRE(expected);
    for (uint32_t i = 0; i < count; i++)
        if (element(i) % 2 == 1)
            expected[kept++] = element(i);
    CHECK(result[0] == kept, "%u kept, expected %u", result[0], kept);
    if (result[0] == kept) {
        qsort(expected, kept, sizeof *expected, compare_elements);
        qsort(result + 1, kept, sizeof *result, compare_elements);
        CHECK(memcmp(expected, result + 1, kept * sizeof *expected) == 0);
    }
    free(expected);
}

TEST(ballot_compacts)
{
    struct gpu gpu;
    OPEN_GPU(&gpu, .validation = true);
    const uint32_t constants[] = {GROUP};
    const struct gpu_kernel_params params = {
        .name = "compact",
        .spirv = compact_spirv,
        .spirv_bytes = sizeof compact_spirv,
        .constants = constants,
        .constant_count = 1,
    };
    struct pair pair = {0};
    struct gpu_kernel kernel = {0};
    struct err err = {0};
    if (!gpu.has_ballot) {
        gpu_close(&gpu);
        SKIP("%s has no ballot in compute", gpu.info.name);
    }
    if (pair_create(&gpu, COUNT, false, &pair, &err) &&
        gpu_kernel_create(&gpu, &params, &kernel, &err) && gpu_begin(&gpu, &pair.commands, &err)) {
        const uint32_t count = COUNT;
        gpu_bind(&gpu, &pair.commands, &pair.bindings);
        gpu_push(&gpu, &pair.commands, &count, sizeof count);
        gpu_dispatch(&gpu, &pair.commands, &kernel, groups_for(COUNT));
        CHECK(pair_run(&gpu, &pair, &err), "%s", err.msg);
        check_compacted(pair.result, COUNT);
    } else {
        CHECK(false, "%s", err.msg);
    }
    gpu_kernel_finish(&gpu, &kernel);
    pair_finish(&gpu, &pair);
    gpu_close(&gpu);
    CHECK(gpu.validation_messages == 0, "%u", gpu.validation_messages);
}

static void record_timed_copies(struct gpu *gpu, struct pair *pair, const struct gpu_kernel *kernel,
                                uint32_t copies)
{
    const struct copy_push push = {.count = COUNT};
    gpu_bind(gpu, &pair->commands, &pair->bindings);
    gpu_push(gpu, &pair->commands, &push, sizeof push);
    gpu_timestamp(gpu, &pair->commands);
    for (uint32_t i = 0; i < copies; i++) {
        gpu_dispatch(gpu, &pair->commands, kernel, groups_for(COUNT));
        gpu_barrier(gpu, &pair->commands);
        gpu_timestamp(gpu, &pair->commands);
    }
}

TEST(timestamps_rise_and_stop_when_full)
{
    struct gpu gpu;
    OPEN_GPU(&gpu, .validation = true);
    struct pair pair;
    struct gpu_kernel kernel = {0};
    struct err err = {0};
    static double ns[GPU_MAX_TIMESTAMPS];
    bool ok = pair_create(&gpu, COUNT, false, &pair, &err) &&
              copy_kernel_create(&gpu, 1, false, &kernel, &err);
    // A second recording begins with timestamp 0 again.
    for (uint32_t copies = 5; ok && copies >= 4; copies--) {
        ok = gpu_begin(&gpu, &pair.commands, &err);
        if (!ok)
            break;
        record_timed_copies(&gpu, &pair, &kernel, copies);
        CHECK(!gpu.has_timestamps || pair.commands.timestamp_count == copies + 1);
        ok = gpu_submit(&gpu, &pair.commands, &err) &&
             gpu_timestamps_ns(&gpu, &pair.commands, ns, &err);
        CHECK(ns[0] == 0, "%g", ns[0]);
        for (uint32_t i = 1; i < pair.commands.timestamp_count; i++)
            CHECK(ns[i] >= ns[i - 1] && ns[i] < 1e11, "%u: %g after %g ns", i, ns[i], ns[i - 1]);
        CHECK(!gpu.has_timestamps || ns[copies] > 0, "no time has passed");
    }
    if (ok && gpu.has_timestamps && gpu_begin(&gpu, &pair.commands, &err)) {
        for (uint32_t i = 0; i < GPU_MAX_TIMESTAMPS; i++)
            CHECK(gpu_timestamp(&gpu, &pair.commands) == i, "%u", i);
        CHECK(gpu_timestamp(&gpu, &pair.commands) == UINT32_MAX);
        ok = gpu_submit(&gpu, &pair.commands, &err) &&
             gpu_timestamps_ns(&gpu, &pair.commands, ns, &err);
    }
    CHECK(ok, "%s", err.msg);
    gpu_kernel_finish(&gpu, &kernel);
    pair_finish(&gpu, &pair);
    gpu_close(&gpu);
    CHECK(gpu.validation_messages == 0, "%u", gpu.validation_messages);
}

TEST(too_many_constants_are_refused)
{
    struct gpu gpu;
    OPEN_GPU(&gpu, .device = NULL);
    static const uint32_t constants[GPU_MAX_CONSTANTS + 1] = {GROUP};
    const struct gpu_kernel_params params = {
        .name = "copy",
        .spirv = copy_spirv,
        .spirv_bytes = sizeof copy_spirv,
        .constants = constants,
        .constant_count = GPU_MAX_CONSTANTS + 1,
    };
    struct gpu_kernel kernel;
    struct err err = {0};
    CHECK(!gpu_kernel_create(&gpu, &params, &kernel, &err));
    CHECK(err.code == ERR_BUG && strstr(err.msg, "copy"), "%s", err.msg);
    gpu_kernel_finish(&gpu, &kernel);
    gpu_close(&gpu);
}

// Kernels with the same code and constants reuse a pipeline one after the other, but not at the
// same time. Other constants have pipelines of their own, and the oldest of the kept ones are
// destroyed first.
TEST(pipelines_are_kept)
{
    struct gpu gpu;
    OPEN_GPU(&gpu, .validation = true);
    struct gpu_kernel kernels[GPU_KEPT_KERNELS + 1] = {0}, again = {0}, other = {0};
    struct err err = {0};
    CHECK(copy_kernel_create(&gpu, 0, false, &kernels[0], &err), "%s", err.msg);
    VkPipeline first = kernels[0].pipeline;
    CHECK(copy_kernel_create(&gpu, 0, false, &again, &err) && again.pipeline != first);
    gpu_kernel_finish(&gpu, &kernels[0]);
    CHECK(copy_kernel_create(&gpu, 1, false, &other, &err) && other.pipeline != first);
    CHECK(copy_kernel_create(&gpu, 0, false, &kernels[0], &err) && kernels[0].pipeline == first);
    gpu_kernel_finish(&gpu, &again);
    gpu_kernel_finish(&gpu, &other);
    // One more kernel than are kept, so the first one is destroyed.
    for (uint32_t i = 1; i <= GPU_KEPT_KERNELS; i++)
        CHECK(copy_kernel_create(&gpu, i + 1, false, &kernels[i], &err), "%s", err.msg);
    VkPipeline last = kernels[GPU_KEPT_KERNELS].pipeline;
    for (uint32_t i = 0; i <= GPU_KEPT_KERNELS; i++)
        gpu_kernel_finish(&gpu, &kernels[i]);
    for (uint32_t i = 0; i < GPU_KEPT_KERNELS; i++)
        CHECK(gpu.kept[i].pipeline && gpu.kept[i].constants[1] != 0, "%u", i);
    CHECK(copy_kernel_create(&gpu, GPU_KEPT_KERNELS + 1, false, &again, &err) &&
          again.pipeline == last);
    gpu_kernel_finish(&gpu, &again);
    gpu_close(&gpu);
    CHECK(gpu.validation_messages == 0, "%u", gpu.validation_messages);
}

// The code is about to be freed, so none of its pipelines may be found again by its address.
TEST(forgotten_pipelines_are_gone)
{
    struct gpu gpu;
    OPEN_GPU(&gpu, .validation = true);
    struct gpu_kernel first = {0}, second = {0}, other = {0}, made = {0};
    struct err err = {0};
    uint32_t *code = malloc(sizeof copy_spirv);
    REQUIRE(code);
    memcpy(code, copy_spirv, sizeof copy_spirv);
    const uint32_t constants[] = {GROUP, 1, 0};
    struct gpu_kernel_params params = {
        .name = "copy",
        .spirv = code,
        .spirv_bytes = sizeof copy_spirv,
        .constants = constants,
        .constant_count = 3,
    };
    CHECK(gpu_kernel_create(&gpu, &params, &first, &err), "%s", err.msg);
    CHECK(gpu_kernel_create(&gpu, &params, &second, &err), "%s", err.msg);
    params.spirv = copy_spirv;
    params.made_from = code;
    params.variant = 1;
    CHECK(gpu_kernel_create(&gpu, &params, &made, &err), "%s", err.msg);
    CHECK(copy_kernel_create(&gpu, 1, false, &other, &err), "%s", err.msg);
    VkPipeline kept = other.pipeline;
    gpu_kernel_finish(&gpu, &first);
    gpu_kernel_finish(&gpu, &second);
    gpu_kernel_finish(&gpu, &made);
    gpu_kernel_finish(&gpu, &other);
    gpu_kernels_forget(&gpu, code);
    for (uint32_t i = 0; i < GPU_KEPT_KERNELS; i++)
        CHECK(gpu.kept[i].pipeline == (gpu.kept[i].spirv == copy_spirv ? kept : VK_NULL_HANDLE) &&
                  gpu.kept[i].spirv != code,
              "%u", i);
    CHECK(copy_kernel_create(&gpu, 1, false, &other, &err) && other.pipeline == kept, "%s",
          err.msg);
    gpu_kernel_finish(&gpu, &other);
    free(code);
    gpu_close(&gpu);
    CHECK(gpu.validation_messages == 0, "%u", gpu.validation_messages);
}

TEST_MAIN(TEST_CASE(copy_through_storage_buffers), TEST_CASE(copy_through_a_texel_buffer),
          TEST_CASE(a_kernel_binds_what_it_names), TEST_CASE(layouts_share_bindings),
          TEST_CASE(bindings_respect_offset_and_range), TEST_CASE(indirect_dispatch_after_a_kernel),
          TEST_CASE(ballot_compacts), TEST_CASE(timestamps_rise_and_stop_when_full),
          TEST_CASE(too_many_constants_are_refused), TEST_CASE(pipelines_are_kept),
          TEST_CASE(forgotten_pipelines_are_gone))
