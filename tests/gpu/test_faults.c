// Injects faults: each allocation fails once, and the device is lost at each submission. All
// objects created by then must be destroyed afterwards, which the validation layers check when the
// device is destroyed, and AddressSanitizer for host memory.
#include "gpu_fixture.h"

#define COUNT 1000u

struct session {
    struct gpu gpu;
    struct gpu_buffer from, to, readback;
    struct gpu_kernel kernel;
    struct gpu_bindings bindings;
    struct gpu_commands commands;
    uint32_t result[COUNT];
};

static bool session_set_up(struct session *session, struct err *err)
{
    struct gpu *gpu = &session->gpu;
    return gpu_buffer_create(gpu, "from", COUNT * 4, GPU_DEVICE, true, &session->from, err) &&
           gpu_buffer_create(gpu, "to", COUNT * 4, GPU_DEVICE, false, &session->to, err) &&
           gpu_buffer_create(gpu, "readback", COUNT * 4, GPU_READBACK, false, &session->readback,
                             err) &&
           copy_kernel_create(gpu, 1, true, &session->kernel, err) &&
           pair_bindings_create(gpu, &session->from, &session->to, &session->bindings, err) &&
           gpu_commands_create(gpu, &session->commands, err);
}

static bool session_work(struct session *session, struct err *err)
{
    struct gpu *gpu = &session->gpu;
    uint32_t data[COUNT];
    for (uint32_t i = 0; i < COUNT; i++)
        data[i] = element(i);
    if (!gpu_upload(gpu, &session->from, 0, data, sizeof data, err) ||
        !gpu_begin(gpu, &session->commands, err))
        return false;
    const struct copy_push push = {.count = COUNT, .addend = 5};
    gpu_bind(gpu, &session->commands, &session->bindings);
    gpu_push(gpu, &session->commands, &push, sizeof push);
    gpu_timestamp(gpu, &session->commands);
    gpu_dispatch(gpu, &session->commands, &session->kernel, groups_for(COUNT));
    gpu_barrier(gpu, &session->commands);
    gpu_copy(gpu, &session->commands, &session->to, 0, &session->readback, 0, COUNT * 4);
    return gpu_submit(gpu, &session->commands, err) && gpu_wait(gpu, &session->commands, err) &&
           gpu_download(gpu, &session->to, 0, session->result, COUNT * 4, err) &&
           memcmp(session->result, session->readback.mapped, COUNT * 4) == 0;
}

static void session_finish(struct session *session)
{
    struct gpu *gpu = &session->gpu;
    gpu_commands_finish(gpu, &session->commands);
    gpu_bindings_finish(gpu, &session->bindings);
    gpu_kernel_finish(gpu, &session->kernel);
    gpu_buffer_finish(gpu, &session->readback);
    gpu_buffer_finish(gpu, &session->to);
    gpu_buffer_finish(gpu, &session->from);
    CHECK(gpu->allocated_bytes == 0, "%llu", (unsigned long long)gpu->allocated_bytes);
    gpu_close(gpu);
    CHECK(gpu->validation_messages == 0, "%u", gpu->validation_messages);
}

// Counts the allocations and submissions of a session without faults.
static void check_session(bool staged, uint32_t *allocations, uint32_t *submissions)
{
    static struct session session;
    session = (struct session){0};
    struct err err = {0};
    OPEN_GPU(&session.gpu, .validation = true, .limits.no_mapped_device = staged);
    CHECK(session_set_up(&session, &err) && session_work(&session, &err), "%s", err.msg);
    for (uint32_t i = 0; i < COUNT; i++)
        if (session.result[i] != element(i) + 5) {
            CHECK(false, "element %u is %u", i, session.result[i]);
            break;
        }
    *allocations = session.gpu.allocation_count;
    *submissions = session.gpu.submit_count;
    session_finish(&session);
}

static void check_failing_allocation(bool staged, uint32_t n)
{
    static struct session session;
    session = (struct session){0};
    struct err err = {0};
    OPEN_GPU(&session.gpu, .validation = true, .limits.no_mapped_device = staged,
             .fail_allocation = n);
    CHECK(!session_set_up(&session, &err) || !session_work(&session, &err), "allocation %u", n);
    CHECK(err.code == ERR_GPU && strstr(err.msg, "out of device memory") &&
              strstr(err.msg, "buffer"),
          "allocation %u: code %d: %s", n, err.code, err.msg);
    CHECK(!session.gpu.lost);
    session_finish(&session);
}

static void check_lost_device(bool staged, uint32_t n)
{
    static struct session session;
    session = (struct session){0};
    struct err err = {0};
    OPEN_GPU(&session.gpu, .validation = true, .limits.no_mapped_device = staged,
             .lose_device_at_submit = n);
    CHECK(!session_set_up(&session, &err) || !session_work(&session, &err), "submission %u", n);
    CHECK(err.code == ERR_GPU && strstr(err.msg, "device lost"), "submission %u: code %d: %s", n,
          err.code, err.msg);
    CHECK(session.gpu.lost);
    // A lost device remains lost.
    err = (struct err){0};
    if (session.commands.handle && gpu_begin(&session.gpu, &session.commands, &err)) {
        CHECK(!gpu_submit(&session.gpu, &session.commands, &err));
        CHECK(strstr(err.msg, "device lost"), "%s", err.msg);
    }
    session_finish(&session);
}

static void check_faults(bool staged)
{
    uint32_t allocations = 0, submissions = 0;
    check_session(staged, &allocations, &submissions);
    for (uint32_t n = 1; n <= allocations; n++)
        check_failing_allocation(staged, n);
    for (uint32_t n = 1; n <= submissions; n++)
        check_lost_device(staged, n);
}

TEST(faults_with_mapped_memory)
{
    check_faults(false);
}

TEST(faults_with_staging)
{
    check_faults(true);
}

TEST_MAIN(TEST_CASE(faults_with_mapped_memory), TEST_CASE(faults_with_staging))
