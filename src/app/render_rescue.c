// The film is copied out of the device at times, so that a device that is lost does not take the
// whole render with it.
#include "clock.h"
#include "log.h"
#include "memory.h"
#include "render_job.h"
#include <inttypes.h>
#include <math.h>

// What copying may cost of the time of rendering. Until a first copy was measured it is taken for
// so much a pixel: on lavapipe resolving and reading one takes .1 to .2 us.
#define COST_MAX 0.01
#define PIXEL_SECONDS 2e-7
// No more often: on a busy machine any copy may take long by chance.
#define PAUSE_SECONDS 1.0
// After so long without a copy it is made in the middle of a pass, too, when some pixels have more
// samples than others.
#define PATIENCE_SECONDS 60.0
// The part of the memory budget that copies may have. They are two at a time while one is made.
#define MEMORY_PART 8

static uint64_t film_pixels(const struct render_job *job)
{
    return (uint64_t)job->renderer.frame.width * job->renderer.frame.height;
}

// Says once where it does not, since a lost device then loses the picture.
static bool fits_memory(struct render_job *job)
{
    // Mean, halves and count, and what --aov asks for besides.
    uint64_t bytes = 2 * film_pixels(job) * (3 * 12 + 4 + job_layer_bytes(job));
    uint64_t most = memory_budget() / MEMORY_PART;
    if (most == 0 || bytes <= most)
        return true;
    if (!job->rescue.is_too_large)
        log_warn("the film is not copied for the case that the device fails: copies take %s, "
                 "expected at most %s, an eighth of the memory budget (--memory); --checkpoint "
                 "keeps the render instead",
                 memory_print(bytes).text, memory_print(most).text);
    job->rescue.is_too_large = true;
    return false;
}

static bool is_due(struct render_job *job)
{
    const struct job_rescue *rescue = &job->rescue;
    double now = job->renderer.stats.render_seconds - job->seconds.render_before;
    double since = now - rescue->copied_at;
    double next = rescue->worst_seconds > 0.0 ? rescue->worst_seconds
                                              : PIXEL_SECONDS * (double)film_pixels(job);
    if (since < PAUSE_SECONDS || rescue->seconds + next > COST_MAX * now || !fits_memory(job))
        return false;
    bool is_late = since > PATIENCE_SECONDS;
    bool is_between_passes = job->renderer.pass.length == 0;
    return is_between_passes || (is_late && renderer_has_all_pixels(&job->renderer));
}

bool job_rescue_copy_when_due(struct render_job *job, struct err *err)
{
    struct job_rescue *rescue = &job->rescue;
    if (!is_due(job))
        return true;
    uint64_t start = clock_ns();
    struct arena arena = {0};
    struct film_image film;
    if (!renderer_read(&job->renderer, &arena, &film, err)) {
        arena_finish(&arena);
        return false;
    }
    arena_finish(&rescue->arena);
    rescue->arena = arena;
    rescue->film = film;
    rescue->stats = job->renderer.stats;
    rescue->next_sample = job->renderer.next_sample;
    rescue->pass = job->renderer.pass;
    rescue->is_even = renderer_is_even(&job->renderer);
    rescue->copied_at = job->renderer.stats.render_seconds - job->seconds.render_before;
    double seconds = clock_seconds_since(start);
    rescue->worst_seconds = fmax(rescue->worst_seconds, seconds);
    rescue->seconds += seconds;
    job->seconds.judge += seconds;
    return true;
}

bool job_rescue(struct render_job *job)
{
    struct job_rescue *rescue = &job->rescue;
    struct renderer *r = &job->renderer;
    if (!rescue->film.mean)
        return false;
    arena_finish(&job->film_arena);
    job->film_arena = rescue->arena;
    rescue->arena = (struct arena){0};
    job->film = rescue->film;
    rescue->film = (struct film_image){0};
    double lost = r->stats.render_seconds - rescue->stats.render_seconds;
    r->stats = rescue->stats;
    r->next_sample = rescue->next_sample;
    r->pass = rescue->pass;
    job->seconds.render = r->stats.render_seconds;
    job->ended_by = ENDED_BY_DEVICE;
    log_warn("the device failed; the picture is that of %" PRIu64
             " samples a pixel, copied %.1f s of rendering before",
             job->film.least_samples, lost);
    return true;
}
