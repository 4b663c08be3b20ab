// Reads the film from the device.
#include "base/clock.h"
#include "job/job_internal.h"

struct film_state job_film_state(const struct renderer *r)
{
    return (struct film_state){r->stats, r->next_sample, r->pass, renderer_is_even(r)};
}

bool job_read_now(struct job *job, struct err *err)
{
    struct renderer *r = &job->renderer;
    arena_finish(&job->film_arena);
    job->rescue.is_read = false;
    if (!renderer_read(r, &job->film_arena, &job->film, err))
        return false;
    job->rescue.is_read = !job_is_pilot(job);
    job->rescue.read = job_film_state(r);
    return true;
}
