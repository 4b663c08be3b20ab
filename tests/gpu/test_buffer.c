// Buffers: creation, limits, and copies between them and the host.
#include "gpu_fixture.h"

static bool is_zero(const uint8_t *data, size_t bytes)
{
    return bytes == 0 || (data[0] == 0 && memcmp(data, data + 1, bytes - 1) == 0);
}

static void check_zero_filled(struct gpu *gpu, enum gpu_memory memory, uint64_t bytes)
{
    struct gpu_buffer buffer;
    struct err err = {0};
    REQUIRE(gpu_buffer_create(gpu, "zero", bytes, memory, false, &buffer, &err), "%s", err.msg);
    uint64_t expected = bytes ? bytes : 16;
    CHECK(buffer.bytes == expected, "%llu", (unsigned long long)buffer.bytes);
    CHECK(memory == GPU_DEVICE || buffer.mapped, "readback memory is not mapped");
    CHECK(memory == GPU_READBACK || !gpu->params.limits.no_mapped_device || !buffer.mapped);
    uint8_t data[1000];
    memset(data, 0xa5, sizeof data);
    REQUIRE(expected <= sizeof data);
    CHECK(gpu_download(gpu, &buffer, 0, data, expected, &err), "%s", err.msg);
    CHECK(is_zero(data, expected), "%llu bytes", (unsigned long long)bytes);
    gpu_buffer_finish(gpu, &buffer);
    CHECK(!buffer.handle && !buffer.memory && !buffer.mapped);
}

TEST(buffers_are_zero_filled)
{
    const uint64_t sizes[] = {0, 1, 3, 16, 17, 999};
    for (int staged = 0; staged < 2; staged++) {
        struct gpu gpu;
        OPEN_GPU(&gpu, .validation = true, .limits.no_mapped_device = staged);
        // Memory that was used before, so that it is not zero by chance.
        struct gpu_buffer used;
        struct err err = {0};
        uint8_t rubbish[1000];
        memset(rubbish, 0x5a, sizeof rubbish);
        CHECK(gpu_buffer_create(&gpu, "used", sizeof rubbish, GPU_DEVICE, false, &used, &err) &&
                  gpu_upload(&gpu, &used, 0, rubbish, sizeof rubbish, &err),
              "%s", err.msg);
        gpu_buffer_finish(&gpu, &used);
        for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; i++) {
            check_zero_filled(&gpu, GPU_DEVICE, sizes[i]);
            check_zero_filled(&gpu, GPU_READBACK, sizes[i]);
        }
        CHECK(gpu.allocated_bytes == 0, "%llu", (unsigned long long)gpu.allocated_bytes);
        CHECK(gpu.peak_bytes >= 999 && gpu.peak_bytes < 4096, "%llu",
              (unsigned long long)gpu.peak_bytes);
        gpu_close(&gpu);
        CHECK(gpu.validation_messages == 0, "%u", gpu.validation_messages);
    }
}

// The copy starts at an odd offset and takes more than one staging piece of 64 MiB, but not a
// multiple of it.
static void check_round_trip(bool staged)
{
    const uint32_t count = (64u << 20) / 4 + 12345;
    const uint64_t bytes = (uint64_t)count * 4 - 3, offset = 5;
    struct gpu gpu;
    OPEN_GPU(&gpu, .limits.no_mapped_device = staged);
    uint32_t *in = elements_new(count), *out = calloc(count, sizeof *out);
    struct gpu_buffer buffer = {0};
    struct err err = {0};
    if (in && out &&
        gpu_buffer_create(&gpu, "large", bytes + 8, GPU_DEVICE, false, &buffer, &err) &&
        gpu_upload(&gpu, &buffer, offset, in, bytes, &err) &&
        gpu_download(&gpu, &buffer, offset, out, bytes, &err)) {
        CHECK(!staged || !buffer.mapped);
        CHECK(memcmp(in, out, bytes) == 0);
        // Bytes that were not written are still zero.
        uint8_t before[5] = {1}, after[3] = {1};
        CHECK(gpu_download(&gpu, &buffer, 0, before, 5, &err) && is_zero(before, 5));
        CHECK(gpu_download(&gpu, &buffer, offset + bytes, after, 3, &err) && is_zero(after, 3));
    } else {
        CHECK(false, "%s", err.msg);
    }
    gpu_buffer_finish(&gpu, &buffer);
    free(in);
    free(out);
    gpu_close(&gpu);
}

TEST(round_trip_directly)
{
    check_round_trip(false);
}

TEST(round_trip_through_staging)
{
    check_round_trip(true);
}

TEST(copies_outside_a_buffer_are_refused)
{
    struct gpu gpu;
    OPEN_GPU(&gpu, .device = NULL);
    struct gpu_buffer buffer;
    struct err err = {0};
    uint8_t data[64] = {0};
    REQUIRE(gpu_buffer_create(&gpu, "small", 48, GPU_DEVICE, false, &buffer, &err), "%s", err.msg);
    const uint64_t ranges[][2] = {{0, 49}, {48, 1}, {49, 0}, {UINT64_MAX, 2}, {2, UINT64_MAX}};
    for (size_t i = 0; i < sizeof ranges / sizeof ranges[0]; i++) {
        err = (struct err){0};
        CHECK(!gpu_upload(&gpu, &buffer, ranges[i][0], data, ranges[i][1], &err), "range %zu", i);
        CHECK(err.code == ERR_BUG && strstr(err.msg, "small"), "%s", err.msg);
        CHECK(!gpu_download(&gpu, &buffer, ranges[i][0], data, ranges[i][1], &err), "range %zu", i);
    }
    CHECK(gpu_upload(&gpu, &buffer, 48, data, 0, &err), "%s", err.msg);
    gpu_buffer_finish(&gpu, &buffer);
    gpu_close(&gpu);
}

TEST(buffers_above_the_limits_are_refused)
{
    struct gpu gpu;
    OPEN_GPU(&gpu, .limits = {.allocation = 1 << 20, .texel_elements = 64});
    struct gpu_buffer buffer;
    const uint64_t sizes[] = {(1 << 20) + 1, UINT64_C(1) << 40, UINT64_MAX - 15, UINT64_MAX};
    for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; i++) {
        struct err err = {0};
        CHECK(!gpu_buffer_create(&gpu, "monster", sizes[i], GPU_DEVICE, false, &buffer, &err));
        CHECK(err.code == ERR_GPU && strstr(err.msg, "monster") &&
                  strstr(err.msg, "largest allocation: 1.0 MiB"),
              "%s", err.msg);
        CHECK(!buffer.handle && !buffer.memory);
    }
    struct err err = {0};
    CHECK(!gpu_buffer_create(&gpu, "texels", 64 * 16 + 1, GPU_DEVICE, true, &buffer, &err));
    CHECK(err.code == ERR_GPU && strstr(err.msg, "texels") && strstr(err.msg, "64"), "%s", err.msg);
    CHECK(gpu_buffer_create(&gpu, "texels", 64 * 16, GPU_DEVICE, true, &buffer, &err), "%s",
          err.msg);
    CHECK(buffer.texel_view != VK_NULL_HANDLE);
    gpu_buffer_finish(&gpu, &buffer);
    gpu_close(&gpu);
}

TEST(bindings_outside_the_limits_are_refused)
{
    struct gpu gpu;
    OPEN_GPU(&gpu, .limits.storage_range = 1024);
    struct gpu_buffer buffer;
    struct gpu_bindings bindings;
    struct err err = {0};
    REQUIRE(gpu_buffer_create(&gpu, "wide", 4096, GPU_DEVICE, false, &buffer, &err), "%s", err.msg);
    const struct {
        uint64_t offset, bytes;
        enum err_code code;
    } cases[] = {
        {0, 1024, ERR_NONE}, {3072, 0, ERR_NONE},   {0, 0, ERR_GPU},          {0, 1028, ERR_GPU},
        {4096, 0, ERR_BUG},  {3072, 1028, ERR_BUG}, {0, UINT64_MAX, ERR_BUG},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        const struct gpu_binding storage[GPU_MAX_STORAGE] = {
            [3] = {&buffer, cases[i].offset, cases[i].bytes},
        };
        err = (struct err){0};
        CHECK(gpu_bindings_create(&gpu, storage, NULL, NULL, &bindings, &err) ==
                  (cases[i].code == ERR_NONE),
              "case %zu", i);
        CHECK(err.code == cases[i].code, "case %zu: code %d: %s", i, err.code, err.msg);
        gpu_bindings_finish(&gpu, &bindings);
    }
    const struct gpu_buffer *const texel[GPU_MAX_TEXEL] = {&buffer};
    CHECK(!gpu_bindings_create(&gpu, NULL, texel, NULL, &bindings, &err) && err.code == ERR_BUG);
    gpu_buffer_finish(&gpu, &buffer);
    gpu_close(&gpu);
}

TEST_MAIN(TEST_CASE(buffers_are_zero_filled), TEST_CASE(round_trip_directly),
          TEST_CASE(round_trip_through_staging), TEST_CASE(copies_outside_a_buffer_are_refused),
          TEST_CASE(buffers_above_the_limits_are_refused),
          TEST_CASE(bindings_outside_the_limits_are_refused))
