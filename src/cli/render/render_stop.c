// After a signal, a render ends with the current wave, but not before every pixel has a sample or
// PATIENCE_SECONDS have passed.
#include "base/clock.h"
#include "base/log.h"
#include "base/signals.h"
#include "cli/render/render_run.h"

#include <math.h>

// The longest delay of a stop for the first sample of every pixel. Batch systems kill programs 30 s
// (Slurm) to 90 s (systemd) after their signal.
#define PATIENCE_SECONDS 20.0
// Shorter delays are not reported.
#define SHORT_SECONDS 1.0

static double patience_seconds(void)
{
    return signals_leave_time() ? PATIENCE_SECONDS : 0.0;
}

// Reports the delay of the stop if it is long enough, and returns whether it was reported. The
// delay is estimated from the speed of rendering or, before the end of the first wave, by the time
// that has passed since the signal.
static bool say_what_it_waits_for(const struct render_run *run)
{
    const struct pass *pass = &run->job.renderer.pass;
    double done = pass->length ? (double)pass->position / (double)pass->length : 0.0;
    double seconds = run->job.renderer.stats.render_seconds - run->job.seconds.render_before;
    double left = done > 0.0 ? seconds / done - seconds : clock_seconds_since(run->stop_ns);
    if (left < SHORT_SECONDS)
        return false;
    log_warn("stopping: %.0f %% of the pixels have a sample, and the others get one first, for at "
             "most %.0f s; a second SIGINT or SIGTERM ends the program at once",
             100.0 * done, PATIENCE_SECONDS);
    return true;
}

static bool should_stop(void *context)
{
    struct render_run *run = context;
    if (!progress_should_stop(run->options->progress))
        return false;
    if (!run->job.is_rendering || renderer_has_all_pixels(&run->job.renderer) ||
        patience_seconds() == 0.0)
        return true;
    if (run->stop_ns == 0)
        run->stop_ns = clock_ns();
    run->stop_is_told = run->stop_is_told || say_what_it_waits_for(run);
    return clock_seconds_since(run->stop_ns) >= patience_seconds();
}

static void report(void *context, const char *phase, double fraction)
{
    const struct render_run *run = context;
    progress_report(run->options->progress, phase, fraction);
}

const struct progress *render_progress(struct render_run *run)
{
    run->progress = (struct progress){report, should_stop, run};
    return &run->progress;
}

void render_warn_of_unsampled(const struct render_run *run)
{
    const struct film_image *film = &run->job.film;
    if (film->unsampled > 0)
        log_warn("%llu of %llu pixels have no sample and are black: the render ended before each "
                 "had one",
                 (unsigned long long)film->unsampled,
                 (unsigned long long)film->width * film->height);
}

void render_warn_of_blind_error(const struct render_run *run)
{
    if (run->job.params.goal.error > 0.0 && film_error_is_blind(&run->job.film))
        log_warn("the picture is too dark for --error: where it is below 0.1, local relMSE divides "
                 "the squared error by little more than the constant 0.01, and not by the "
                 "picture's square; `lampyris check` reports what a brighter picture would take");
}
