// What a signal does to a render: it ends after the wave in flight, but not before every pixel has
// a sample.
#include "base/clock.h"
#include "base/log.h"
#include "cli/render/render_job.h"
#include "cli/signals.h"

#include <math.h>

// So long may the first sample of every pixel take once a signal has asked to stop. Batch systems
// kill what has not ended 30 s (Slurm) to 90 s (systemd) after their signal.
#define PATIENCE_SECONDS 20.0
// Nobody wants to read about less.
#define SHORT_SECONDS 1.0

static double patience_seconds(void)
{
    return signals_leave_time() ? PATIENCE_SECONDS : 0.0;
}

// False as long as it is not known whether that takes long enough to be told: before the first wave
// has ended there is no rate, only the time that was waited.
static bool say_what_it_waits_for(const struct render_job *job)
{
    const struct pass *pass = &job->renderer.pass;
    double done = pass->length ? (double)pass->position / (double)pass->length : 0.0;
    double seconds = job->renderer.stats.render_seconds - job->seconds.render_before;
    double left = done > 0.0 ? seconds / done - seconds : clock_seconds_since(job->stop_ns);
    if (left < SHORT_SECONDS)
        return false;
    log_warn("stopping: %.0f %% of the pixels have a sample, and the others get one first, for at "
             "most %.0f s; a second SIGINT or SIGTERM ends the program at once",
             100.0 * done, PATIENCE_SECONDS);
    return true;
}

bool job_should_stop(void *context)
{
    struct render_job *job = context;
    if (!progress_should_stop(job->options->progress))
        return false;
    if (!job->is_rendering || renderer_has_all_pixels(&job->renderer) || patience_seconds() == 0.0)
        return true;
    if (job->stop_ns == 0)
        job->stop_ns = clock_ns();
    job->stop_is_told = job->stop_is_told || say_what_it_waits_for(job);
    return clock_seconds_since(job->stop_ns) >= patience_seconds();
}

bool job_is_stopped(struct render_job *job)
{
    job->stopped |= progress_should_stop(&job->progress);
    return job->stopped;
}

void job_warn_of_unsampled(const struct render_job *job)
{
    const struct film_image *film = &job->film;
    if (film->unsampled > 0)
        log_warn("%llu of %llu pixels have no sample and are black: the render ended before each "
                 "had one",
                 (unsigned long long)film->unsampled,
                 (unsigned long long)film->width * film->height);
}
