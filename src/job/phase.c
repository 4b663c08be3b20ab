// Names the phase that a job is in.
#include "job/job_internal.h"

bool job_is_open_ended(const struct job *job)
{
    return job->is_open_ended;
}

bool job_is_pilot(const struct job *job)
{
    return job->params.goal.adaptive && !job->plan.counts;
}

bool job_is_rescued(const struct job *job)
{
    return job->ended_by == ENDED_BY_DEVICE || job->ended_by == ENDED_BY_MEMORY;
}

uint64_t job_step_samples(const struct job *job)
{
    return job->params.goal.adaptive ? job->round_samples : 1;
}
