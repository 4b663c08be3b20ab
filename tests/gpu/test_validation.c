// Tests the option for validation: correct code causes no messages, and errors cause some.
#include "gpu_fixture.h"

#define COUNT 4096u
#define LINKS 8u

struct heard {
    uint32_t hazards, messages;
};

static void hear(void *context, enum log_level level, const char *message)
{
    struct heard *heard = context;
    (void)level;
    heard->messages++;
    heard->hazards += strstr(message, "HAZARD") != NULL;
}

// Copies A to B, B to A, and so on; each copy adds one. Barriers in between are optional.
static bool run_chain(struct gpu *gpu, bool barriers, uint32_t *result, struct err *err)
{
    struct gpu_buffer buffers[2] = {0};
    struct gpu_bindings forth = {0}, back = {0};
    struct gpu_kernel kernel = {0};
    struct gpu_commands commands = {0};
    uint32_t *data = elements_new(COUNT);
    bool ok = data &&
              gpu_buffer_create(gpu, "chain A", COUNT * 4, GPU_DEVICE, false, &buffers[0], err) &&
              gpu_buffer_create(gpu, "chain B", COUNT * 4, GPU_DEVICE, false, &buffers[1], err) &&
              gpu_upload(gpu, &buffers[0], 0, data, COUNT * 4, err) &&
              pair_bindings_create(gpu, &buffers[0], &buffers[1], &forth, err) &&
              pair_bindings_create(gpu, &buffers[1], &buffers[0], &back, err) &&
              copy_kernel_create(gpu, 1, false, &kernel, err) &&
              gpu_commands_create(gpu, &commands, err) && gpu_begin(gpu, &commands, err);
    if (ok) {
        const struct copy_push push = {.count = COUNT, .addend = 1};
        gpu_push(gpu, &commands, &push, sizeof push);
        for (uint32_t i = 0; i < LINKS; i++) {
            gpu_bind(gpu, &commands, i % 2 ? &back : &forth);
            gpu_dispatch(gpu, &commands, &kernel, groups_for(COUNT));
            if (barriers)
                gpu_barrier(gpu, &commands);
        }
        // There are transfers after kernels and kernels after transfers.
        if (barriers) {
            gpu_copy(gpu, &commands, &buffers[0], 0, &buffers[1], 0, COUNT * 4);
            gpu_barrier(gpu, &commands);
            gpu_fill(gpu, &commands, &buffers[0], 0, COUNT * 4, 0);
            gpu_barrier(gpu, &commands);
            gpu_bind(gpu, &commands, &back);
            gpu_dispatch(gpu, &commands, &kernel, groups_for(COUNT));
        }
        ok = gpu_submit(gpu, &commands, err) && gpu_wait(gpu, &commands, err) &&
             gpu_download(gpu, &buffers[0], 0, result, COUNT * 4, err);
    }
    gpu_commands_finish(gpu, &commands);
    gpu_kernel_finish(gpu, &kernel);
    gpu_bindings_finish(gpu, &back);
    gpu_bindings_finish(gpu, &forth);
    gpu_buffer_finish(gpu, &buffers[1]);
    gpu_buffer_finish(gpu, &buffers[0]);
    free(data);
    return ok;
}

TEST(chain_with_barriers_is_silent)
{
    static uint32_t result[COUNT];
    for (int staged = 0; staged < 2; staged++) {
        struct gpu gpu;
        struct err err = {0};
        OPEN_GPU(&gpu, .validation = true, .limits.no_mapped_device = staged);
        CHECK(run_chain(&gpu, true, result, &err), "%s", err.msg);
        for (uint32_t i = 0; i < COUNT; i++)
            if (result[i] != element(i) + LINKS + 1) {
                CHECK(false, "element %u is %u, expected %u", i, result[i], element(i) + LINKS + 1);
                break;
            }
        gpu_close(&gpu);
        CHECK(gpu.validation_messages == 0, "%u", gpu.validation_messages);
    }
}

TEST(missing_barrier_is_heard)
{
    static uint32_t result[COUNT];
    struct gpu gpu;
    struct err err = {0};
    OPEN_GPU(&gpu, .validation = true);
    struct heard heard = {0};
    log_configure(LOG_WARN, hear, &heard);
    CHECK(run_chain(&gpu, false, result, &err), "%s", err.msg);
    log_configure(LOG_WARN, NULL, NULL);
    CHECK(heard.hazards > 0, "%u messages", heard.messages);
    CHECK(gpu.validation_messages == heard.messages, "%u counted, %u logged",
          gpu.validation_messages, heard.messages);
    gpu_close(&gpu);
}

// Objects that outlive the device are counted, too. Other tests rely on this to find leaks.
TEST(leaked_buffer_is_heard)
{
    struct gpu gpu;
    struct err err = {0};
    struct heard heard = {0};
    struct gpu_buffer buffer;
    OPEN_GPU(&gpu, .validation = true);
    log_configure(LOG_WARN, hear, &heard);
    CHECK(gpu_buffer_create(&gpu, "leak", 64, GPU_DEVICE, false, &buffer, &err), "%s", err.msg);
    CHECK(gpu.validation_messages == 0, "%u", gpu.validation_messages);
    gpu_close(&gpu);
    log_configure(LOG_WARN, NULL, NULL);
    CHECK(heard.messages > 0);
    CHECK(gpu.validation_messages == heard.messages, "%u counted, %u logged",
          gpu.validation_messages, heard.messages);
}

TEST_MAIN(TEST_CASE(chain_with_barriers_is_silent), TEST_CASE(missing_barrier_is_heard),
          TEST_CASE(leaked_buffer_is_heard))
