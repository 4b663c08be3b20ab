#include "check/driver.h"

#include "base/clock.h"
#include <math.h>

#include "check_arithmetic.spv.h"
#include "check_threads.spv.h"
#include "check_threads_plain.spv.h"

uint32_t driver_random(uint64_t *state)
{
    uint64_t z = *state += UINT64_C(0x9e3779b97f4a7c15);
    z = (z ^ z >> 30) * UINT64_C(0xbf58476d1ce4e5b9);
    z = (z ^ z >> 27) * UINT64_C(0x94d049bb133111eb);
    return (uint32_t)((z ^ z >> 31) >> 32);
}

float driver_random_float(uint64_t *state, int exponent)
{
    uint32_t bits = driver_random(state);
    int power = (int)(driver_random(state) % (2u * (uint32_t)exponent)) - exponent;
    float value = ldexpf(1.0f + (float)(bits >> 9) * 0x1p-23f, power);
    return bits & 1u ? -value : value;
}

struct driver {
    struct gpu_buffer input, output, counter;
    struct gpu_bindings bindings;
    struct gpu_kernel kernel;
    struct gpu_commands commands;
};

static bool create_kernel(struct gpu *gpu, const struct driver_run *run, struct gpu_kernel *out,
                          struct err *err)
{
    uint32_t constants[CONSTANT_CHECK_COUNT + 1] = {[CONSTANT_WORKGROUP] = DRIVER_WORKGROUP,
                                                    [CONSTANT_CHECK_ROUTINE] = run->routine,
                                                    [CONSTANT_CHECK_COUNT] = run->constant};
    struct gpu_kernel_params params = {.name = "check",
                                       .spirv = check_arithmetic_spirv,
                                       .spirv_bytes = sizeof check_arithmetic_spirv,
                                       .constants = constants,
                                       .constant_count = CONSTANT_CHECK_COUNT + 1};
    if (run->program == DRIVER_THREADS) {
        params.spirv = gpu->has_ballot ? check_threads_spirv : check_threads_plain_spirv;
        params.spirv_bytes =
            gpu->has_ballot ? sizeof check_threads_spirv : sizeof check_threads_plain_spirv;
    }
    return gpu_kernel_create(gpu, &params, out, err);
}

static bool create(struct gpu *gpu, const struct driver_run *run, struct driver *d, struct err *err)
{
    uint64_t bytes = run->items * sizeof(driver_item);
    if (!gpu_buffer_create(gpu, "check input", bytes, GPU_DEVICE, run->texels, &d->input, err) ||
        !gpu_buffer_create(gpu, "check output", bytes, GPU_DEVICE, false, &d->output, err) ||
        !gpu_buffer_create(gpu, "check counter", 16, GPU_DEVICE, false, &d->counter, err))
        return false;
    const struct gpu_binding storage[GPU_MAX_STORAGE] = {
        {.buffer = &d->input}, {.buffer = &d->output}, {.buffer = &d->counter}};
    const struct gpu_buffer *const texel[GPU_MAX_TEXEL] = {run->texels ? &d->input : NULL};
    return gpu_bindings_create(gpu, storage, texel, NULL, &d->bindings, err) &&
           create_kernel(gpu, run, &d->kernel, err) && gpu_commands_create(gpu, &d->commands, err);
}

static void finish(struct gpu *gpu, struct driver *d)
{
    gpu_commands_finish(gpu, &d->commands);
    gpu_kernel_finish(gpu, &d->kernel);
    gpu_bindings_finish(gpu, &d->bindings);
    gpu_buffer_finish(gpu, &d->counter);
    gpu_buffer_finish(gpu, &d->output);
    gpu_buffer_finish(gpu, &d->input);
}

static void record(struct gpu *gpu, const struct driver_run *run, struct driver *d)
{
    uint32_t count = run->dispatches ? run->dispatches : 1;
    gpu_bind(gpu, &d->commands, &d->bindings);
    gpu_timestamp(gpu, &d->commands);
    for (uint32_t i = 0; i < count; i++) {
        const uint32_t push[] = {run->items, i};
        gpu_push(gpu, &d->commands, push, sizeof push);
        gpu_dispatch(gpu, &d->commands, &d->kernel, run->items / DRIVER_WORKGROUP);
        gpu_barrier(gpu, &d->commands);
    }
    gpu_timestamp(gpu, &d->commands);
}

static bool run_and_time(struct gpu *gpu, struct driver_run *run, struct driver *d, struct err *err)
{
    double times[GPU_MAX_TIMESTAMPS] = {0};
    uint64_t start = clock_ns();
    if (!gpu_begin(gpu, &d->commands, err))
        return false;
    record(gpu, run, d);
    if (!gpu_submit(gpu, &d->commands, err) || !gpu_wait(gpu, &d->commands, err))
        return false;
    run->host_ns = (double)(clock_ns() - start);
    if (d->commands.timestamp_count == 2 && !gpu_timestamps_ns(gpu, &d->commands, times, err))
        return false;
    run->device_ns = times[1];
    return true;
}

bool driver_run(const struct check *check, struct driver_run *run, driver_item *items,
                struct err *err)
{
    struct gpu *gpu = check->gpu;
    struct driver d = {0};
    uint64_t bytes = run->items * sizeof *items;
    bool ok = create(gpu, run, &d, err) && gpu_upload(gpu, &d.input, 0, items, bytes, err) &&
              gpu_upload(gpu, &d.output, 0, items, bytes, err) && run_and_time(gpu, run, &d, err) &&
              gpu_download(gpu, &d.output, 0, items, bytes, err);
    finish(gpu, &d);
    return ok;
}
