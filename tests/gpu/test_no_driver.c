// Tests machines without a Vulkan driver or without the loader.
#include "gpu/gpu.h"
#include "test.h"

static void check_no_vulkan(const char *expected)
{
    struct gpu_device_info devices[GPU_MAX_DEVICES];
    uint32_t count = 1;
    struct err err = {0};
    CHECK(!gpu_list_devices(devices, &count, &err));
    CHECK(count == 0, "%u devices", count);
    CHECK(err.code == ERR_NO_VULKAN && strstr(err.msg, expected), "code %d: %s", err.code, err.msg);

    struct gpu gpu;
    err = (struct err){0};
    CHECK(!gpu_open(NULL, &gpu, &err));
    CHECK(err.code == ERR_NO_VULKAN && strstr(err.msg, expected), "code %d: %s", err.code, err.msg);
    CHECK(!gpu.instance && !gpu.device);
    gpu_close(&gpu);
}

TEST(no_driver)
{
    setenv("VK_DRIVER_FILES", "/nonexistent", 1);
    setenv("VK_ICD_FILENAMES", "/nonexistent", 1); // the variable's name in loaders before 1.3.207
    struct err err = {0};
    struct gpu_device_info devices[GPU_MAX_DEVICES];
    uint32_t count;
    if (!gpu_list_devices(devices, &count, &err) && strstr(err.msg, "no Vulkan loader"))
        SKIP("%s", err.msg);
    check_no_vulkan("no Vulkan driver");
}

// This test is run with the loader hidden.
TEST(no_loader)
{
    check_no_vulkan("no Vulkan loader");
}

int main(int argc, char **argv)
{
    static const struct test_case hidden[] = {TEST_CASE(no_loader)};
    static const struct test_case usual[] = {TEST_CASE(no_driver)};
    bool loader_hidden = argc > 1 && strcmp(argv[1], "no_loader") == 0;
    return test_run(loader_hidden ? hidden : usual, 1, argc, argv);
}
