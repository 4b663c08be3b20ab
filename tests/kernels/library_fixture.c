#include "library_fixture.h"

#include "library_test.spv.h"

_Static_assert(sizeof(union words) == sizeof(struct gpu_path), "they share a buffer");

static bool create_kernel(struct renderer *r, const struct routine *routine,
                          struct gpu_kernel *kernel, struct err *err)
{
    uint32_t constants[CONSTANT_ROUTINE + 1];
    memcpy(constants, &r->specialization, 4 * CONSTANT_COUNT);
    constants[CONSTANT_FEATURES] &= ~FEATURE_TEXEL_STATE; // the test writes to buffers that the
                                                          // kernel reads
    constants[CONSTANT_ROUTINE] = routine->number;
    const struct gpu_kernel_params params = {
        .name = "library",
        .spirv = routine->spirv,
        .spirv_bytes = routine->spirv_bytes,
        .constants = constants,
        .constant_count = CONSTANT_ROUTINE + 1,
    };
    return gpu_kernel_create(r->gpu, &params, kernel, err);
}

static bool run_part(struct renderer *r, const struct gpu_kernel *kernel, union words *items,
                     uint32_t count, struct err *err)
{
    const struct gpu_buffer *buffer = &r->buffers[BINDING_PATHS];
    r->push.first_item = 0;
    r->push.part_items = count;
    return gpu_upload(r->gpu, &r->buffers[BINDING_PATHS], 0, items, count * sizeof *items, err) &&
           run_kernel(r, kernel, count, err) &&
           gpu_download(r->gpu, buffer, 0, items, count * sizeof *items, err);
}

bool routine_run(struct setup *setup, const struct routine *routine, union words *items,
                 uint32_t count)
{
    struct renderer *r = &setup->r;
    struct gpu_kernel kernel = {0};
    struct err err = {0};
    bool ok = create_kernel(r, routine, &kernel, &err);
    for (uint32_t first = 0; first < count && ok; first += r->plan.wave_slots) {
        uint32_t left = count - first;
        uint32_t part = left < r->plan.wave_slots ? left : r->plan.wave_slots;
        ok = run_part(r, &kernel, items + first, part, &err);
    }
    CHECK(ok, "%s", err.msg);
    gpu_kernel_finish(r->gpu, &kernel);
    return ok;
}

bool library_run(struct setup *setup, uint32_t routine, union words *items, uint32_t count)
{
    const struct routine of_library = {library_spirv, sizeof library_spirv, routine};
    return routine_run(setup, &of_library, items, count);
}
