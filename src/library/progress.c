// Reports progress to the caller.
#include "library/library.h"

static uint64_t samples_of(const struct job *job)
{
    return job->renderer.next_sample * (job->params.goal.adaptive ? job->round_samples : 1);
}

static void report(void *context, const char *phase, double fraction)
{
    struct library_progress *progress = context;
    if (!progress->user.report || atomic_load(&progress->is_stopped))
        return;
    struct lampyris_moment moment = {.size = sizeof moment, .phase = phase, .fraction = fraction};
    if (progress->job) {
        const struct render_stats *stats = &progress->job->renderer.stats;
        moment.samples = samples_of(progress->job);
        moment.seconds = stats->render_seconds;
        moment.rays = stats->closest_rays + stats->shadow_rays;
    }
    if (!progress->user.report(progress->user.user, &moment))
        atomic_store(&progress->is_stopped, true);
}

static bool should_stop(void *context)
{
    struct library_progress *progress = context;
    return atomic_load(&progress->is_stopped);
}

bool library_progress_init(struct library_progress *out, const struct lampyris_progress *user,
                           const struct job *job, struct err *err)
{
    *out = (struct library_progress){.job = job};
    out->progress = (struct progress){.report = report, .should_stop = should_stop, .context = out};
    return library_take(&out->user, sizeof out->user, user, "lampyris_progress", err);
}
