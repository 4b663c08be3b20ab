// Tests listing, selecting, opening and closing devices.
#include "base/thread.h"
#include "gpu/gpu_internal.h"
#include "gpu_fixture.h"
#include <ctype.h>
#include <stdio.h>

static bool list_or_fail(struct gpu_device_info devices[GPU_MAX_DEVICES], uint32_t *count,
                         struct err *err)
{
    *err = (struct err){0};
    return gpu_list_devices(devices, count, err);
}

#define LIST(devices, count)                                                                       \
    do {                                                                                           \
        struct err list_err;                                                                       \
        if (!list_or_fail((devices), (count), &list_err)) {                                        \
            if (list_err.code == ERR_NO_VULKAN)                                                    \
                SKIP("%s", list_err.msg);                                                          \
            REQUIRE(false, "%s", list_err.msg);                                                    \
        }                                                                                          \
    } while (0)

TEST(list_names_every_device)
{
    struct gpu_device_info devices[GPU_MAX_DEVICES];
    uint32_t count;
    LIST(devices, &count);
    CHECK(count >= 1 && count <= GPU_MAX_DEVICES, "%u devices", count);
    for (uint32_t i = 0; i < count; i++) {
        const struct gpu_device_info *device = &devices[i];
        CHECK(device->index == i, "index %u of device %u", device->index, i);
        CHECK(device->name[0] && device->driver[0], "device %u", i);
        CHECK(device->memory_bytes > 0, "device %u", i);
        CHECK(device->is_cpu == (strcmp(device->kind, "CPU") == 0), "%s", device->kind);
        if (strstr(device->name, "llvmpipe"))
            CHECK(device->is_cpu && !device->unusable[0], "%s", device->unusable);
    }
}

TEST(device_is_chosen_by_index_and_by_name)
{
    struct gpu_device_info devices[GPU_MAX_DEVICES];
    uint32_t count;
    LIST(devices, &count);
    for (uint32_t i = 0; i < count; i++) {
        if (devices[i].unusable[0])
            continue;
        char index[16], name[256];
        snprintf(index, sizeof index, "%u", i);
        struct gpu gpu;
        OPEN_GPU(&gpu, .device = index);
        CHECK(gpu.info.index == i, "device %u for '%s'", gpu.info.index, index);
        gpu_close(&gpu);

        // The name without its first letter, in capital letters.
        snprintf(name, sizeof name, "%s", devices[i].name + 1);
        for (char *c = name; *c; c++)
            *c = (char)toupper((unsigned char)*c);
        OPEN_GPU(&gpu, .device = name);
        CHECK(strcmp(gpu.info.name, devices[i].name) == 0, "%s for '%s'", gpu.info.name, name);
        gpu_close(&gpu);
    }
}

TEST(unknown_device_is_refused_with_a_list)
{
    struct gpu_device_info devices[GPU_MAX_DEVICES];
    uint32_t count;
    LIST(devices, &count);
    const char *const unknown[] = {"no such device", "99", "-1", "0x0", "0 "};
    for (size_t i = 0; i < sizeof unknown / sizeof unknown[0]; i++) {
        struct gpu gpu;
        struct err err = {0};
        CHECK(!gpu_open(&(struct gpu_params){.device = unknown[i]}, &gpu, &err), "%s", unknown[i]);
        CHECK(err.code == ERR_USAGE, "code %d", err.code);
        CHECK(strstr(err.msg, unknown[i]) && strstr(err.msg, devices[0].name), "%s", err.msg);
    }
}

TEST(default_is_the_fastest_kind)
{
    struct gpu_device_info devices[GPU_MAX_DEVICES];
    uint32_t count;
    LIST(devices, &count);
    struct gpu gpu;
    OPEN_GPU(&gpu, .device = NULL);
    bool has_gpu = false;
    for (uint32_t i = 0; i < count; i++)
        has_gpu |= strstr(devices[i].kind, "GPU") && !devices[i].unusable[0];
    CHECK(!has_gpu || strstr(gpu.info.kind, "GPU"), "%s", gpu.info.kind);
    gpu_close(&gpu);
}

// The minima of the Vulkan specification ("Required Limits") and of device_find_lacks().
TEST(limits_are_read)
{
    struct gpu gpu;
    OPEN_GPU(&gpu, .device = NULL);
    CHECK(gpu.max_storage_range >= 1u << 27, "%llu", (unsigned long long)gpu.max_storage_range);
    CHECK(gpu.max_texel_elements >= 65536, "%llu", (unsigned long long)gpu.max_texel_elements);
    CHECK(gpu.max_allocation >= 1u << 30, "%llu", (unsigned long long)gpu.max_allocation);
    CHECK(gpu.storage_alignment >= 1 && gpu.storage_alignment <= 256);
    CHECK(gpu.max_groups >= 65535, "%u", gpu.max_groups);
    CHECK(gpu.max_invocations >= GPU_MIN_INVOCATIONS, "%u", gpu.max_invocations);
    CHECK(gpu.subgroup_size >= 1, "%u", gpu.subgroup_size);
    CHECK(!gpu.has_timestamps || (gpu.timestamp_ns > 0 && gpu.timestamp_mask >= UINT32_MAX));
    CHECK(gpu_texel_fits(&gpu, gpu.max_texel_elements * 16));
    CHECK(!gpu_texel_fits(&gpu, gpu.max_texel_elements * 16 + 1));
    CHECK(!gpu_texel_fits(&gpu, UINT64_MAX));
    gpu_close(&gpu);
}

static VkPhysicalDeviceProperties sufficient_device(void)
{
    return (VkPhysicalDeviceProperties){
        .apiVersion = VK_API_VERSION_1_1,
        .limits =
            {
                // This is the least that Vulkan permits; kernels that bind more are refused
                // individually.
                .maxPerStageDescriptorStorageBuffers = 4,
                .maxDescriptorSetStorageBuffers = 24,
                .maxPerStageDescriptorSampledImages = 16,
                .maxDescriptorSetSampledImages = 96,
                .maxPerStageResources = GPU_MAX_BINDINGS,
                .maxPushConstantsSize = GPU_PUSH_BYTES,
                .maxComputeWorkGroupInvocations = GPU_MIN_INVOCATIONS,
                .maxComputeWorkGroupSize = {GPU_MIN_INVOCATIONS, 1, 1},
            },
    };
}

TEST(lacking_devices_say_what_they_lack)
{
    char lacks[256];
    VkPhysicalDeviceProperties device = sufficient_device();
    device_find_lacks(&device, 0, lacks, sizeof lacks);
    CHECK(!lacks[0], "%s", lacks);
    device_find_lacks(&device, UINT32_MAX, lacks, sizeof lacks);
    CHECK(strstr(lacks, "no queue"), "%s", lacks);

    device.limits.maxPerStageResources = 28;
    device.limits.maxPushConstantsSize = 64;
    device_find_lacks(&device, 0, lacks, sizeof lacks);
    CHECK(strcmp(lacks, "maxPerStageResources is 28, expected at least 45; "
                        "maxPushConstantsSize is 64, expected at least 128") == 0,
          "%s", lacks);

    device.apiVersion = VK_API_VERSION_1_0;
    device_find_lacks(&device, 0, lacks, sizeof lacks);
    CHECK(strcmp(lacks, "it supports Vulkan 1.0, expected at least 1.1") == 0, "%s", lacks);

    // The text is longer than the array, so it is truncated.
    device = (VkPhysicalDeviceProperties){.apiVersion = VK_API_VERSION_1_1};
    device_find_lacks(&device, 0, lacks, 100);
    CHECK(strlen(lacks) == 99, "%zu", strlen(lacks));
}

TEST(overrides_lower_limits_and_never_raise_them)
{
    struct gpu gpu, own;
    OPEN_GPU(&own, .device = NULL);
    OPEN_GPU(&gpu, .limits = {.storage_range = 4096,
                              .texel_elements = 7,
                              .allocation = 1 << 20,
                              .no_ballot = true});
    CHECK(gpu.max_storage_range == 4096 && gpu.max_texel_elements == 7);
    CHECK(gpu.max_allocation == 1 << 20 && !gpu.has_ballot);
    CHECK(gpu_texel_fits(&gpu, 7 * 16) && !gpu_texel_fits(&gpu, 7 * 16 + 1));
    gpu_close(&gpu);

    OPEN_GPU(&gpu,
             .limits = {.storage_range = UINT64_MAX, .allocation = UINT64_MAX, .no_texel = true});
    CHECK(gpu.max_storage_range == own.max_storage_range);
    CHECK(gpu.max_allocation == own.max_allocation && gpu.has_ballot == own.has_ballot);
    CHECK(gpu.max_texel_elements == 0 && !gpu_texel_fits(&gpu, 16));
    gpu_close(&gpu);
    gpu_close(&own);
}

// The program uses only Vulkan 1.1. A device of that version provides the same information, except
// the driver's name.
TEST(vulkan_1_1_suffices)
{
    struct gpu gpu, own;
    OPEN_GPU(&own, .device = NULL);
    OPEN_GPU(&gpu, .limits = {.api_1_1 = true});
    CHECK(gpu.info.api_version == VK_API_VERSION_1_1, "%x", gpu.info.api_version);
    CHECK(strstr(gpu.info.driver, "version 0x") == gpu.info.driver, "%s", gpu.info.driver);
    CHECK(strlen(own.info.driver) > 0, "no driver");
    CHECK(gpu.subgroup_size == own.subgroup_size && gpu.has_ballot == own.has_ballot);
    CHECK(gpu.max_allocation == own.max_allocation && gpu.max_allocation > 0);
    gpu_close(&gpu);
    gpu_close(&own);
}

// Opening a second instance must not affect the first one, although volk's pointers are global.
TEST(two_devices_are_open_at_once)
{
    struct gpu first, second;
    OPEN_GPU(&first, .validation = true);
    OPEN_GPU(&second, .validation = false);
    struct gpu_buffer buffer;
    struct err err = {0};
    CHECK(gpu_buffer_create(&first, "first", 64, GPU_DEVICE, false, &buffer, &err), "%s", err.msg);
    gpu_buffer_finish(&first, &buffer);
    gpu_close(&second);
    gpu_close(&first);
    CHECK(first.validation_messages == 0, "%u", first.validation_messages);
}

// The variable is restored, because suites may run all tests with it.
TEST(environment_lowers_limits)
{
    char *kept = getenv("LAMPYRIS_LIMITS") ? strdup(getenv("LAMPYRIS_LIMITS")) : NULL;
    struct gpu_limit_overrides limits = {.texel_elements = 70000};
    struct err err = {0};
    setenv("LAMPYRIS_LIMITS", "api-1.1,no-ballot,texel-elements=65536,storage-range=1048576", 1);
    CHECK(limits_from_environment(&limits, &err), "%s", err.msg);
    CHECK(limits.api_1_1 && limits.no_ballot && !limits.no_texel && !limits.no_mapped_device,
          "flags");
    CHECK(limits.texel_elements == 70000, "what the caller set counts");
    CHECK(limits.storage_range == 1048576, "%llu", (unsigned long long)limits.storage_range);
    static const char *const bad[] = {"no-bullet",
                                      "no-texels",
                                      "allocation=",
                                      "allocation=0",
                                      "allocation=-1",
                                      "allocation=+1",
                                      "allocation= 1",
                                      "storage-range=12k",
                                      "texel-elements=99999999999999999999",
                                      "waves=3",
                                      ","};
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        setenv("LAMPYRIS_LIMITS", bad[i], 1);
        CHECK(!limits_from_environment(&limits, &err) && err.code == ERR_USAGE, "%s", bad[i]);
    }
    unsetenv("LAMPYRIS_LIMITS");
    CHECK(limits_from_environment(&limits, &err), "%s", err.msg);
    if (kept)
        setenv("LAMPYRIS_LIMITS", kept, 1);
    free(kept);
}

TEST(finish_and_close_accept_nothing)
{
    struct gpu gpu = {0};
    gpu_close(NULL);
    gpu_close(&gpu);
    gpu_buffer_finish(&gpu, NULL);
    gpu_buffer_finish(&gpu, &(struct gpu_buffer){0});
    gpu_kernel_finish(&gpu, NULL);
    gpu_kernel_finish(&gpu, &(struct gpu_kernel){0});
    gpu_bindings_finish(&gpu, NULL);
    gpu_bindings_finish(&gpu, &(struct gpu_bindings){0});
    gpu_commands_finish(&gpu, NULL);
    gpu_commands_finish(&gpu, &(struct gpu_commands){0});
}

static bool presents(void *context, VkInstance instance, VkPhysicalDevice device,
                     uint32_t queue_family)
{
    uint32_t *asked = context;
    (*asked)++;
    return instance && device && queue_family < 32;
}

static bool never_presents(void *context, VkInstance instance, VkPhysicalDevice device,
                           uint32_t queue_family)
{
    (void)context, (void)instance, (void)device, (void)queue_family;
    return false;
}

// If a window needs extensions that the device or the loader lacks, opening fails and the message
// names them.
TEST(windows_need_more)
{
    static const char *const nonsense[] = {"VK_KHR_nonsense"};
    static const struct {
        struct gpu_params params;
        const char *words;
    } cases[] = {
        {{.can_present = never_presents},
         "no queue family supports compute and presentation to a window"},
        {{.can_present = never_presents, .graphics = true},
         "no queue family supports compute, graphics and presentation to a window"},
        {{.instance_extensions = nonsense, .instance_extension_count = 1}, "VK_KHR_nonsense"},
        {{.instance_extensions = nonsense, .instance_extension_count = 1000}, "1000 instance"},
    };
    struct gpu gpu;
    OPEN_GPU(&gpu, .device = NULL);
    gpu_close(&gpu);
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct err err = {0};
        CHECK(!gpu_open(&cases[i].params, &gpu, &err) && strstr(err.msg, cases[i].words), "%s",
              err.msg);
    }
}

// Only devices opened for a window enable what a window needs, and opening others does not change
// that.
TEST(windows_get_what_they_need)
{
    static const char *const surface[] = {VK_KHR_SURFACE_EXTENSION_NAME};
    uint32_t asked = 0;
    const struct gpu_params params = {
        .graphics = true,
        .validation = true,
        .instance_extensions = surface,
        .instance_extension_count = 1,
        .can_present = presents,
        .present_context = &asked,
    };
    struct gpu with, without;
    struct err err = {0};
    OPEN_GPU(&without, .validation = true);
    CHECK(!gpu_function(&without, "vkDestroySurfaceKHR"));
    CHECK(!vkGetDeviceProcAddr(without.device, "vkCreateSwapchainKHR"));
    if (!gpu_open(&params, &with, &err)) {
        gpu_close(&without);
        SKIP("%s", err.msg);
    }
    CHECK(asked > 0);
    struct gpu third;
    CHECK(gpu_open(NULL, &third, &err), "%s", err.msg);
    CHECK(gpu_function(&with, "vkDestroySurfaceKHR") != NULL);
    CHECK(vkGetDeviceProcAddr(with.device, "vkCreateSwapchainKHR") != NULL);
    gpu_close(&third);
    gpu_close(&with);
    gpu_close(&without);
    CHECK(with.validation_messages == 0, "%u", with.validation_messages);
    CHECK(without.validation_messages == 0, "%u", without.validation_messages);
}

// The results of a thread in the test below.
struct opened {
    struct thread thread;
    bool validation, ok;
    uint32_t messages;
    struct err err;
};

static bool copies(struct gpu *gpu, struct err *err)
{
    struct gpu_buffer buffer = {0};
    uint32_t sent[256], got[256] = {0};
    for (uint32_t i = 0; i < 256; i++)
        sent[i] = i * i;
    bool ok = gpu_buffer_create(gpu, "thread", sizeof sent, GPU_DEVICE, false, &buffer, err) &&
              gpu_upload(gpu, &buffer, 0, sent, sizeof sent, err) &&
              gpu_download(gpu, &buffer, 0, got, sizeof got, err);
    if (ok && memcmp(sent, got, sizeof sent) != 0)
        ok = err_set(err, ERR_BUG, "other data came back");
    gpu_buffer_finish(gpu, &buffer);
    return ok;
}

static void open_often(void *context)
{
    struct opened *opened = context;
    const struct gpu_params params = {.validation = opened->validation};
    opened->ok = true;
    for (int i = 0; i < 20 && opened->ok; i++) {
        struct gpu gpu = {0};
        struct gpu_device_info devices[GPU_MAX_DEVICES];
        uint32_t count;
        opened->ok = gpu_list_devices(devices, &count, &opened->err) &&
                     gpu_open(&params, &gpu, &opened->err) && copies(&gpu, &opened->err);
        gpu_close(&gpu);
        opened->messages += gpu.validation_messages;
    }
}

TEST(threads_have_devices_of_their_own)
{
    struct opened opened[4] = {{.validation = true}, {.validation = false}, {.validation = true}};
    struct gpu gpu;
    OPEN_GPU(&gpu, .validation = true);
    gpu_close(&gpu);
    for (int i = 0; i < 4; i++)
        REQUIRE(thread_start(&opened[i].thread, open_often, &opened[i]) == 0);
    for (int i = 0; i < 4; i++)
        thread_join(&opened[i].thread);
    for (int i = 0; i < 4; i++)
        CHECK(opened[i].ok && opened[i].messages == 0, "thread %d: %u messages; %s", i,
              opened[i].messages, opened[i].err.msg);
}

TEST_MAIN(TEST_CASE(threads_have_devices_of_their_own), TEST_CASE(list_names_every_device),
          TEST_CASE(device_is_chosen_by_index_and_by_name),
          TEST_CASE(unknown_device_is_refused_with_a_list), TEST_CASE(default_is_the_fastest_kind),
          TEST_CASE(limits_are_read), TEST_CASE(lacking_devices_say_what_they_lack),
          TEST_CASE(overrides_lower_limits_and_never_raise_them), TEST_CASE(vulkan_1_1_suffices),
          TEST_CASE(environment_lowers_limits), TEST_CASE(two_devices_are_open_at_once),
          TEST_CASE(finish_and_close_accept_nothing), TEST_CASE(windows_need_more),
          TEST_CASE(windows_get_what_they_need))
