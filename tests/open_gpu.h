// A device, or a test that is left.
#ifndef LAMPYRIS_TESTS_OPEN_GPU_H
#define LAMPYRIS_TESTS_OPEN_GPU_H

#include "gpu/gpu.h"
#include "test.h"

// Opens a device or leaves the test: as skipped where there is no Vulkan (or no validation layer,
// if that was asked for), as failed for any other reason.
#define OPEN_GPU(gpu, ...)                                                                         \
    do {                                                                                           \
        const struct gpu_params open_params = {__VA_ARGS__};                                       \
        struct err open_err = {0};                                                                 \
        if (!gpu_open(&open_params, (gpu), &open_err)) {                                           \
            if (open_err.code == ERR_NO_VULKAN || strstr(open_err.msg, "is not installed"))        \
                SKIP("%s", open_err.msg);                                                          \
            REQUIRE(false, "%s", open_err.msg);                                                    \
        }                                                                                          \
    } while (0)

#endif
