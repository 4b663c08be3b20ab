#include "render/sampling_plan.h"

#include "base/log.h"

enum sample_planning sample_planning(const struct settings *settings, const char **option)
{
    const char *ignored;
    if (!option)
        option = &ignored;
    *option = NULL;
    if (settings->halves == HALVES_CONTIGUOUS)
        *option = "--halves contiguous";
    else if (settings->sampler == SAMPLER_STRATIFIED)
        *option = "--sampler stratified";
    else if (settings->sampler == SAMPLER_GRID)
        *option = "--sampler grid";
    if (*option)
        return PLANNING_NEEDED;
    if (settings->sampler != SAMPLER_BLUE_NOISE)
        return PLANNING_NONE;
    *option = "--sampler blue-noise";
    return PLANNING_OPTIONAL;
}

// The number of states of a 32-bit linear congruential generator.
#define LCG_STATES (UINT64_C(1) << 32)

void sampling_plan(struct renderer *r, bool open_ended)
{
    const struct settings *settings = &r->scene->settings;
    if (open_ended) {
        const char *option;
        r->frame.samples = 0;
        if (sample_planning(settings, &option) == PLANNING_NEEDED)
            log_warn(
                "%s needs to know the number of samples in advance, but this render ends by time "
                "or error: its samples and half-buffers are independent instead",
                option);
        r->specialization.halves = HALVES_INDEPENDENT;
    }
    uint64_t samples = (uint64_t)settings->width * settings->height * settings->spp;
    if (settings->sampler == SAMPLER_LCG && samples > LCG_STATES)
        log_warn("the sampler 'lcg' has only %llu states: many of the %llu samples use the same "
                 "random numbers",
                 (unsigned long long)LCG_STATES, (unsigned long long)samples);
}

bool halves_are_contiguous(const struct renderer *r)
{
    return r->specialization.halves == HALVES_CONTIGUOUS;
}

void renderer_plan_samples(struct renderer *r, uint64_t samples)
{
    r->frame.samples = (uint32_t)samples;
}

void sampling_plan_check(struct renderer *r, uint64_t samples)
{
    uint64_t planned = r->frame.samples;
    if (r->warned_beyond_plan || planned == 0 || r->next_sample + samples <= planned)
        return;
    if (sample_planning(&r->scene->settings, NULL) != PLANNING_NEEDED)
        return;
    r->warned_beyond_plan = true;
    log_warn("more samples are taken than the %llu planned: %s", (unsigned long long)planned,
             halves_are_contiguous(r)
                 ? "the half-buffers are unequal, and their difference no longer bounds the error"
                 : "the additional samples have their own strata");
}
