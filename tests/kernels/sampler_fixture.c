#include "sampler_fixture.h"

#include "render/frame.h"
#include "sampler_routines.h"
#include "sampler_test.spv.h"

static bool create_kernel(const struct sampler_setup *s, uint32_t routine,
                          struct gpu_kernel *kernel, struct err *err)
{
    uint32_t constants[CONSTANT_ROUTINE + 1];
    memcpy(constants, &s->setup.r.specialization, 4 * CONSTANT_COUNT);
    constants[CONSTANT_SAMPLER] = s->sampler;
    constants[CONSTANT_HALVES] = s->halves;
    constants[CONSTANT_FILTER] = s->filter;
    constants[CONSTANT_PIXEL_SAMPLING] = s->pixel_sampling;
    constants[CONSTANT_ROUTINE] = routine;
    const struct gpu_kernel_params params = {
        .name = "sampler",
        .spirv = sampler_spirv,
        .spirv_bytes = sizeof sampler_spirv,
        .constants = constants,
        .constant_count = CONSTANT_ROUTINE + 1,
    };
    return gpu_kernel_create(s->setup.r.gpu, &params, kernel, err);
}

// Draws that fit into the buffer of paths at once.
static bool run_part(struct renderer *r, const struct gpu_kernel *kernel, union draw *draws,
                     uint32_t count, struct err *err)
{
    struct gpu_buffer *buffer = &r->buffers[BINDING_PATHS];
    uint64_t bytes = (uint64_t)count * sizeof *draws;
    r->push.part_items = count;
    return gpu_upload(r->gpu, buffer, 0, draws, bytes, err) && run_kernel(r, kernel, count, err) &&
           gpu_download(r->gpu, buffer, 0, draws, bytes, err);
}

static bool run(struct sampler_setup *s, uint32_t routine, union draw *draws, uint32_t count)
{
    struct renderer *r = &s->setup.r;
    uint32_t most = (uint32_t)(r->buffers[BINDING_PATHS].bytes / sizeof *draws);
    struct gpu_kernel kernel = {0};
    struct err err = {0};
    r->frame.seed = s->seed;
    r->frame.samples = s->samples;
    r->frame.filter_radius = s->filter_radius;
    r->frame.pixel_strata = s->pixel_strata;
    r->push.first_item = 0;
    bool ok = create_kernel(s, routine, &kernel, &err) && frame_upload(r, &err);
    for (uint32_t first = 0, part; ok && first < count; first += part) {
        part = count - first < most ? count - first : most;
        ok = run_part(r, &kernel, draws + first, part, &err);
    }
    CHECK(ok, "%s", err.msg);
    gpu_kernel_finish(r->gpu, &kernel);
    return ok;
}

bool sampler_uniforms(struct sampler_setup *s, union draw *draws, uint32_t count)
{
    return run(s, ROUTINE_UNIFORMS, draws, count);
}

bool sampler_positions(struct sampler_setup *s, union draw *draws, uint32_t count)
{
    return run(s, ROUTINE_FILTER, draws, count);
}

bool sampler_pixel_places(struct sampler_setup *s, union draw *draws, uint32_t count)
{
    return run(s, ROUTINE_PIXEL, draws, count);
}

void sampler_close(struct sampler_setup *s)
{
    setup_close(&s->setup);
}

double chi_square_deviate(const uint32_t *counts, const double *expected, uint32_t cells)
{
    double statistic = 0;
    for (uint32_t i = 0; i < cells; i++) {
        double difference = counts[i] - expected[i];
        statistic += difference * difference / expected[i];
    }
    double freedom = cells - 1, spread = 2 / (9 * freedom);
    return (cbrt(statistic / freedom) - (1 - spread)) / sqrt(spread);
}
