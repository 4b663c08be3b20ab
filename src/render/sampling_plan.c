#include "sampling_plan.h"

#include "log.h"

// Of strata that there are as many of as samples.
static bool has_strata(const struct settings *settings)
{
    return settings->sampler == SAMPLER_STRATIFIED || settings->sampler == SAMPLER_GRID;
}

// Different states of a linear congruential generator of 32 bits.
#define LCG_STATES (UINT64_C(1) << 32)

void sampling_plan(struct renderer *r, bool open_ended)
{
    const struct settings *settings = &r->scene->settings;
    if (open_ended) {
        r->frame.samples = 0;
        if (has_strata(settings))
            log_warn("the sampler '%s' needs to know the number of samples, which here depends on "
                     "the clock or the error: samples are independent",
                     sampler_names[settings->sampler]);
        if (settings->halves == HALVES_CONTIGUOUS)
            log_warn("contiguous halves need to know the number of samples, which here depends on "
                     "the clock or the error: the halves are independent");
        r->specialization.halves = HALVES_INDEPENDENT;
    }
    uint64_t samples = (uint64_t)settings->width * settings->height * settings->spp;
    if (settings->sampler == SAMPLER_LCG && samples > LCG_STATES)
        log_warn("the sampler 'lcg' has %llu states: of %llu samples many use the same numbers",
                 (unsigned long long)LCG_STATES, (unsigned long long)samples);
}

void sampling_plan_check(struct renderer *r, uint64_t samples)
{
    uint64_t planned = r->frame.samples;
    if (r->warned_beyond_plan || planned == 0 || r->next_sample + samples <= planned)
        return;
    bool contiguous = r->specialization.halves == HALVES_CONTIGUOUS;
    if (!contiguous && !has_strata(&r->scene->settings))
        return;
    r->warned_beyond_plan = true;
    log_warn("more samples than the %llu planned: %s", (unsigned long long)planned,
             contiguous ? "the halves are unequal, and the error that they tell is no bound"
                        : "further ones have strata of their own");
}
