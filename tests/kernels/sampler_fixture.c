#include "sampler_fixture.h"

static bool run(struct sampler_setup *s, uint32_t routine, union draw *draws, uint32_t count)
{
    const struct sampler_run run = {.routine = routine,
                                    .sampler = s->sampler,
                                    .halves = s->halves,
                                    .filter = s->filter,
                                    .seed = s->seed,
                                    .samples = s->samples,
                                    .filter_radius = s->filter_radius,
                                    .pixel_sampling = s->pixel_sampling,
                                    .pixel_strata = s->pixel_strata};
    struct err err = {0};
    bool ok = sampler_run(&s->setup.r, &run, draws, count, &err);
    CHECK(ok, "%s", err.msg);
    return ok;
}

bool sampler_uniforms(struct sampler_setup *s, union draw *draws, uint32_t count)
{
    return run(s, SAMPLER_ROUTINE_UNIFORMS, draws, count);
}

bool sampler_positions(struct sampler_setup *s, union draw *draws, uint32_t count)
{
    return run(s, SAMPLER_ROUTINE_FILTER, draws, count);
}

bool sampler_pixel_places(struct sampler_setup *s, union draw *draws, uint32_t count)
{
    return run(s, SAMPLER_ROUTINE_PIXEL, draws, count);
}

void sampler_close(struct sampler_setup *s)
{
    setup_close(&s->setup);
}
