// Copies the film from the device from time to time, so that the render is not lost if the device
// is lost or memory runs out.
#include "base/clock.h"
#include "base/log.h"
#include "base/memory.h"
#include "job/job_internal.h"
#include <inttypes.h>
#include <math.h>

// The greatest fraction of the rendering time that copies may take.
#define COST_MAX 0.01
// The time of the first copy is estimated as this time per pixel. On lavapipe, resolving and
// reading a pixel takes 0.1 to 0.2 us.
#define PIXEL_SECONDS 2e-7
// The first copy is always made if it is expected to take less than this.
#define SHORT_SECONDS 2e-3
// The least rendering time between copies, because on a busy machine a single copy may happen to
// take long.
#define PAUSE_SECONDS 1.0
// A copy waits at most this long for the end of a pass, when all pixels have the same number of
// samples. The first copy does not wait.
#define PATIENCE_SECONDS 10.0
// Copies may use 1 / MEMORY_PART of the memory budget. While a copy is made, two copies exist.
#define MEMORY_PART 8

static uint64_t film_pixels(const struct job *job)
{
    return (uint64_t)job->renderer.frame.width * job->renderer.frame.height;
}

// Returns whether copies fit into their share of the memory budget. If they do not, warns once,
// because losing the device then loses the image.
static bool fits_memory(struct job *job)
{
    // The mean, the halves, the counts, the layers of --aov, and the records from which they are
    // computed.
    uint64_t bytes = 2 * film_pixels(job) * (3 * 12 + 4 + film_aovs_bytes(job->renderer.aovs));
    if (job->params.reopens > 0)
        bytes += 2 * film_copy_bytes(&job->renderer);
    uint64_t most = memory_budget() / MEMORY_PART;
    if (most == 0 || bytes <= most)
        return true;
    if (!job->rescue.is_too_large)
        log_warn(
            "no copies of the film are kept, so the render is lost if the device fails: copies "
            "need %s; expected at most %s, an eighth of the memory budget (--memory); "
            "use --checkpoint to save the render",
            memory_print(bytes).text, memory_print(most).text);
    job->rescue.is_too_large = true;
    return false;
}

// Returns whether to copy now. The first copy is made as soon as its time permits, because without
// it everything can be lost. A copy made in the middle of a pass is replaced at the end of the next
// pass.
static bool is_due(struct job *job)
{
    const struct job_rescue *rescue = &job->rescue;
    bool is_first = !rescue->film.mean;
    double now = job->renderer.stats.render_seconds - job->seconds.render_before;
    double since = now - rescue->copied_at;
    double next = rescue->worst_seconds > 0.0 ? rescue->worst_seconds
                                              : PIXEL_SECONDS * (double)film_pixels(job);
    bool is_cheap = rescue->seconds + next <= COST_MAX * now || (is_first && next < SHORT_SECONDS);
    if (!is_cheap || !fits_memory(job))
        return false;
    if (job->renderer.pass.length == 0)
        return is_first || rescue->copied.pass.length > 0 || since >= PAUSE_SECONDS;
    return (is_first || since > PATIENCE_SECONDS) && renderer_has_all_pixels(&job->renderer);
}

bool job_rescue_copy_when_due(struct job *job, struct err *err)
{
    struct job_rescue *rescue = &job->rescue;
    if (!is_due(job))
        return true;
    uint64_t start = clock_ns();
    struct arena arena = {0};
    struct film_image film;
    struct film_copy records = {0};
    if (!renderer_read(&job->renderer, &arena, &film, err) ||
        (job->params.reopens > 0 &&
         !film_copy_take(&job->renderer, false, &arena, &records, err))) {
        arena_finish(&arena);
        return false;
    }
    arena_finish(&rescue->arena);
    rescue->arena = arena;
    rescue->film = film;
    rescue->records = records;
    rescue->has_records = job->params.reopens > 0;
    rescue->copied = job_film_state(&job->renderer);
    rescue->copied_at = job->renderer.stats.render_seconds - job->seconds.render_before;
    double seconds = clock_seconds_since(start);
    rescue->worst_seconds = fmax(rescue->worst_seconds, seconds);
    rescue->seconds += seconds;
    job->seconds.judge += seconds;
    return true;
}

// --- going on -----------------------------------------------------------------------------------

bool job_rescue_begin(struct job *job, struct err *err)
{
    struct job_rescue *rescue = &job->rescue;
    const struct renderer *r = &job->renderer;
    bool is_empty = r->next_sample == r->emptied_at && r->pass.position == 0;
    rescue->has_records = job->params.reopens > 0 && (is_empty || fits_memory(job));
    return !rescue->has_records ||
           film_copy_take(&job->renderer, is_empty, &rescue->arena, &rescue->records, err);
}

// Uses smaller waves if the device has too little memory for the present ones.
bool job_recover(struct job *job, struct err *err)
{
    struct job_rescue *rescue = &job->rescue;
    struct renderer *r = &job->renderer;
    bool is_lost = r->gpu->lost, is_full = r->gpu->out_of_memory;
    if (!job->is_rendering || !rescue->has_records || err->code != ERR_GPU ||
        !(is_lost || is_full) || rescue->reopened == job->params.reopens)
        return false;
    rescue->reopened++;
    log_warn("%s: opening the device again and continuing from %" PRIu64 " samples per pixel%s",
             err->msg, job_is_pilot(job) ? 0 : rescue->records.next_sample * job_step_samples(job),
             is_lost ? "" : " with smaller waves");
    struct err failure = {0};
    uint32_t wave = is_lost ? r->plan.wave_slots : r->plan.wave_slots / 2;
    if (renderer_reopen(r, wave, &failure) && film_copy_put(&rescue->records, r, &failure))
        return true;
    err_set(err, ERR_GPU, "%s; it could not be opened again: %s", err->msg, failure.msg);
    return false;
}

// --- the film of a device that stays lost -------------------------------------------------------

// Reads the current film if the host's memory ran out, because the device then still works.
static void read_again(struct job *job)
{
    // With a crew, the device has only a part of the film.
    if (job->is_rendering && !job->params.crew && !job_is_pilot(job) &&
        renderer_has_all_pixels(&job->renderer))
        job_read_now(job, NULL);
}

static bool choose_newest(struct job *job)
{
    struct job_rescue *rescue = &job->rescue;
    bool has_copy = rescue->film.mean != NULL;
    bool is_newer = rescue->read.stats.render_seconds >= rescue->copied.stats.render_seconds;
    if (rescue->is_read && (is_newer || !has_copy)) {
        rescue->copied = rescue->read;
        return true;
    }
    if (!has_copy)
        return false;
    arena_finish(&job->film_arena);
    job->film_arena = rescue->arena;
    rescue->arena = (struct arena){0};
    job->film = rescue->film;
    rescue->film = (struct film_image){0};
    return true;
}

static void say_what_is_left(const struct job *job, double lost_seconds)
{
    const struct film_image *film = &job->film;
    const char *what = job->ended_by == ENDED_BY_DEVICE ? "the device failed" : "memory ran out";
    if (film->most_samples == film->least_samples)
        log_warn("%s; the picture has %" PRIu64
                 " samples per pixel, which were copied %.1f s of rendering time earlier",
                 what, film->least_samples, lost_seconds);
    else
        log_warn("%s; the picture has %" PRIu64 " samples per pixel, and up to %" PRIu64
                 " in some pixels, so no --spp renders it again; it was copied %.1f s of rendering "
                 "time earlier",
                 what, film->least_samples, film->most_samples, lost_seconds);
}

bool job_rescue(struct job *job, enum err_code failure)
{
    struct renderer *r = &job->renderer;
    bool is_of_memory = failure == ERR_SYSTEM || failure == ERR_BUDGET;
    if (!is_of_memory && failure != ERR_GPU)
        return false;
    if (is_of_memory)
        read_again(job);
    if (!choose_newest(job))
        return false;
    const struct film_state *state = &job->rescue.copied;
    double lost = r->stats.render_seconds - state->stats.render_seconds;
    r->stats = state->stats;
    r->next_sample = state->next_sample;
    r->pass = state->pass;
    job->seconds.render = r->stats.render_seconds;
    job->ended_by = is_of_memory ? ENDED_BY_MEMORY : ENDED_BY_DEVICE;
    say_what_is_left(job, lost);
    return true;
}
