// Several devices that render one picture: assigns blocks of samples to them, and adds their films.
#include "job/crew.h"

#include "base/clock.h"
#include "base/log.h"
#include "job/job_internal.h"
#include <assert.h>
#include <math.h>
#include <string.h>

// Longest duration of a block, unless a single pass takes longer. A stop, a checkpoint or an error
// estimate waits at most this long for the last block, and so do devices that finish early.
#define BLOCK_SECONDS 1.0

// --- workers -------------------------------------------------------------------------------------

bool crew_render(struct job *job, const struct sample_range *block, double *seconds,
                 struct err *err)
{
    const struct job_step step = {.to = 1.0};
    const uint64_t start = clock_ns();
    if (!job->has_samples || block->first < job->first_held)
        job->first_held = block->first;
    job->has_samples = true;
    job->renderer.next_sample = block->first;
    bool ok = job_render_to(job, &step, block->end, 0.0, 1.0, err) && job_hold(job, block, err);
    *seconds = clock_seconds_since(start);
    return ok;
}

bool crew_take(struct job *job, struct arena *arena, struct crew_film *out, struct err *err)
{
    struct renderer *r = &job->renderer;
    *out = (struct crew_film){.has_samples = job->has_samples};
    if (!film_copy_take(r, !job->has_samples, arena, &out->copy, err))
        return false;
    out->copy.emptied_at = job->first_held;
    r->stats = (struct render_stats){0};
    r->next_sample = 0;
    job->has_samples = false;
    job_hold_only(job, &(struct sample_range){0}, NULL); // an empty one needs no memory
    return !out->has_samples || renderer_clear(r, err);
}

// --- dealing -------------------------------------------------------------------------------------

bool job_begin_crew(struct job *job, struct err *err)
{
    const struct crew *crew = job->params.crew;
    if (!crew)
        return true;
    job->deal.blocks = arena_alloc(&job->arena, crew->count, sizeof *job->deal.blocks);
    job->has_samples = job->renderer.next_sample > job->samples_first;
    job->first_held = job->samples_first;
    if (job->saved.end == 0 &&
        !job_hold_only(job, &(struct sample_range){job->samples_first, job->renderer.next_sample},
                       err))
        return false;
    return job->deal.blocks || err_memory(err, "a crew", crew->count * sizeof *job->deal.blocks);
}

bool job_check_crew(const struct job *job, struct err *err)
{
    return !job->params.crew || job_check_divisible(job, JOB_BY_CREW, err);
}

// Returns the samples of a member's next block. Blocks become shorter towards the end (guided
// self-scheduling, Polychronopoulos and Kuck 1987). A block is half of an equal share of the
// remaining samples, or as much of it as takes BLOCK_SECONDS. But it has at least the samples of a
// full wave, or an equal share if that is less.
static uint64_t block_samples(const struct job *job, const struct crew_member *member)
{
    const struct crew_deal *deal = &job->deal;
    const uint64_t left = deal->end - deal->next, count = job->params.crew->count + UINT64_C(1);
    const uint64_t at_once = renderer_samples_at_once(&job->renderer), share = left / count;
    const uint64_t least = at_once < share ? at_once : share;
    uint64_t samples = member->busy_seconds > 0.0 ? share / 2 : least;
    double fits = member->busy_seconds > 0.0
                      ? BLOCK_SECONDS * (double)member->samples / member->busy_seconds
                      : INFINITY;
    // Blocks also become shorter before the time limit and before a checkpoint.
    double time_left = job_checkpoint_wait(job);
    if (deal->seconds > 0.0)
        time_left = fmin(time_left, fmax(deal->seconds - clock_seconds_since(deal->start_ns), 0.0));
    fits *= fmin(time_left / (CREW_BLOCKS * BLOCK_SECONDS), 1.0);
    if ((double)samples > fits)
        samples = (uint64_t)fits;
    samples = (samples > least ? samples : least) & ~UINT64_C(1);
    samples = samples < 2 ? 2 : samples;
    // Blocks have at least two samples, so a single one at the end is added to the last block.
    return samples + 1 >= left ? left : samples;
}

static struct sample_range take_block(struct job *job, struct crew_member *member)
{
    struct crew_deal *deal = &job->deal;
    const uint64_t samples = block_samples(job, member);
    const struct sample_range block = {deal->next, deal->next + samples};
    deal->next = block.end;
    deal->given++;
    return block;
}

static bool is_late(const struct job *job)
{
    const double limit = job->deal.seconds, elapsed = clock_seconds_since(job->deal.start_ns);
    return (limit > 0.0 && elapsed >= limit) || job_checkpoint_wait(job) <= 0.0;
}

// Returns whether another block may be assigned. No more blocks are assigned if the job is to stop,
// the time is over or a checkpoint is due. But the first block is always assigned, and unless the
// job is to stop, at least as many blocks as there are members.
static bool may_deal(struct job *job)
{
    struct crew_deal *deal = &job->deal;
    if (deal->given > 0 && !deal->is_closed)
        deal->is_closed =
            job_is_stopped(job) || (deal->given > job->params.crew->count && is_late(job));
    return !deal->is_closed && deal->next < deal->end;
}

// Gives one block to each worker that has fewer than `most` blocks.
static bool give_blocks(struct job *job, uint32_t most, struct err *err)
{
    struct crew *crew = job->params.crew;
    for (uint32_t i = 0; i < crew->count; i++) {
        struct crew_member *member = &crew->members[i + 1];
        if (member->blocks >= most || !may_deal(job))
            continue;
        const struct sample_range block = take_block(job, member);
        job->deal.blocks[i][member->blocks++] = block.end - block.first;
        if (!crew->give(crew->context, i, &block, err))
            return false;
    }
    return true;
}

static void note_block(struct job *job, struct crew_member *member, uint64_t samples,
                       double seconds)
{
    member->samples += samples;
    member->busy_seconds += seconds;
    job->deal.done += samples;
}

// Records the blocks that workers have finished. With `waits`, waits for at least one such block.
static bool collect(struct job *job, bool waits, struct err *err)
{
    struct crew *crew = job->params.crew;
    bool is_there;
    do {
        struct crew_done done;
        if (!crew->poll(crew->context, waits, &done, &is_there, err))
            return false;
        if (!is_there)
            break;
        struct crew_member *member = &crew->members[done.worker + 1];
        uint64_t *blocks = job->deal.blocks[done.worker];
        assert(member->blocks > 0);
        job->deal.took_part = true;
        note_block(job, member, blocks[0], done.seconds);
        for (uint32_t i = 1; i < member->blocks; i++)
            blocks[i - 1] = blocks[i];
        member->blocks--;
        waits = false;
    } while (is_there);
    return true;
}

bool job_attend_crew(struct job *job, struct err *err)
{
    return collect(job, false, err) && give_blocks(job, CREW_BLOCKS, err);
}

static bool has_blocks_out(const struct job *job)
{
    uint32_t blocks = 0;
    for (uint32_t i = 0; i < job->params.crew->count; i++)
        blocks += job->params.crew->members[i + 1].blocks;
    return blocks > 0;
}

// Returns the progress of the step, from its finished blocks.
static double progress_of(const struct job *job, const struct job_step *step)
{
    const struct crew_deal *deal = &job->deal;
    return step->from + (step->to - step->from) * fmin((double)deal->done / deal->all, 1.0);
}

// Returns the progress after this block, without blocks that other members finish meanwhile.
static double progress_after(const struct job *job, const struct job_step *step,
                             const struct sample_range *block)
{
    const double part = (double)(block->end - block->first) / job->deal.all;
    return fmin(progress_of(job, step) + (step->to - step->from) * part, step->to);
}

// Saves the job's own film if each block is to be saved. A failure is a warning, as with
// checkpoints.
static void save_own_block(struct job *job)
{
    const struct job_checkpoint_params *params = &job->params.checkpoint;
    struct err failure = {0};
    if (params->keeps_blocks && !crew_save(job, params->path, &failure))
        log_warn("no block was saved: %s", failure.msg);
}

// Renders a block in the job's own film. A stop waits until it is finished, because a render cannot
// be resumed from a film in which a pass of a block is incomplete.
static bool render_own_block(struct job *job, const struct job_step *step, struct err *err)
{
    struct crew_member *own = &job->params.crew->members[0];
    struct renderer *r = &job->renderer;
    const struct sample_range block = take_block(job, own);
    const double from = progress_of(job, step), to = progress_after(job, step, &block);
    const uint64_t start = clock_ns();
    if (!job->has_samples || block.first < job->first_held)
        job->first_held = block.first;
    job->has_samples = true;
    r->next_sample = block.first;
    job->deal.is_in_block = true;
    bool ok = job_render_to(job, step, block.end, from, to, err);
    job->deal.is_in_block = false;
    note_block(job, own, block.end - block.first, clock_seconds_since(start));
    ok = ok && job_hold(job, &block, err);
    if (ok)
        save_own_block(job);
    return ok;
}

static bool deal_all(struct job *job, const struct job_step *step, struct err *err)
{
    while (true) {
        // Workers get their blocks first, so that none waits while the job renders its own block.
        if (!collect(job, false, err) || !give_blocks(job, 1, err))
            return false;
        if (may_deal(job)) {
            if (!render_own_block(job, step, err))
                return false;
        } else if (has_blocks_out(job)) {
            progress_report(&job->progress, "Rendering", progress_of(job, step));
            if (!collect(job, true, err))
                return false;
        } else {
            return true;
        }
    }
}

// Adds the films of all workers to the job's own, which then has all samples so far.
static bool gather(struct job *job, struct err *err)
{
    const struct crew *crew = job->params.crew;
    struct renderer *r = &job->renderer;
    const uint64_t bytes = film_copy_bytes(r), next = job->deal.next;
    struct arena arena = {0};
    struct crew_film film = {.has_samples = job->has_samples};
    r->next_sample = next;
    bool ok = true;
    if (job->deal.took_part) {
        ok = film_copy_take(r, false, &arena, &film.copy, err);
        film.copy.emptied_at = job->first_held;
        ok = ok && crew->gather(crew->context, r->specialization.aovs, bytes, &film, err);
        film.copy.emptied_at = job->samples_first;
        film.copy.next_sample = next;
        ok = ok && film_copy_put(&film.copy, r, err);
    }
    job->has_samples = true;
    job->first_held = job->samples_first;
    arena_finish(&arena);
    // While saved blocks are completed, blocks.c records the samples of the film.
    return ok && (job->saved.end > 0 ||
                  job_hold_only(job, &(struct sample_range){job->samples_first, next}, err));
}

// Renders samples that are not divided among members: the rest of a pass, an odd sample, or fewer
// than four samples.
static bool advance_alone(struct job *job, const struct job_step *step, struct err *err)
{
    struct renderer *r = &job->renderer;
    const uint64_t first = r->next_sample, start = clock_ns();
    const uint64_t pass = r->pass.length > 0 ? UINT64_C(1) << r->pass.shift : first % 2;
    const uint64_t end = pass > 0 ? first + pass : step->samples;
    const struct sample_range block = {first, end};
    job->deal.is_closed = job->deal.is_in_block = true;
    bool ok = job_render_to(job, step, end, progress_of(job, step),
                            progress_after(job, step, &block), err);
    job->deal.is_in_block = false;
    job->has_samples = true;
    job->first_held = job->samples_first;
    note_block(job, &job->params.crew->members[0], end - first, clock_seconds_since(start));
    return ok && job_hold(job, &block, err);
}

// Renders until the step is complete or a checkpoint is due, and adds the films.
static bool advance_once(struct job *job, const struct job_step *step, struct err *err)
{
    struct renderer *r = &job->renderer;
    struct crew_deal *deal = &job->deal;
    const uint64_t first = r->next_sample;
    deal->next = first;
    deal->given = 0;
    deal->end = step->samples;
    deal->is_closed = deal->took_part = false;
    if (r->pass.length > 0 || first % 2 == 1 || deal->end - first < 4)
        return advance_alone(job, step, err);
    const uint64_t start = clock_ns();
    const double before = r->stats.render_seconds;
    bool ok = deal_all(job, step, err);
    job->checkpoint_from = clock_ns(); // the cost of a checkpoint includes adding the films
    ok = ok && gather(job, err);
    r->stats.render_seconds = before + clock_seconds_since(start);
    return ok;
}

static void begin_deal(struct job *job, const struct job_step *step)
{
    const uint64_t first = job->renderer.next_sample;
    job->deal.start_ns = clock_ns();
    job->deal.seconds = 0.0;
    job->deal.done = 0;
    job->deal.all = (double)(step->samples - first);
}

bool job_advance_crew_once(struct job *job, const struct job_step *step, struct err *err)
{
    begin_deal(job, step);
    while (job->renderer.next_sample < step->samples && !job_is_stopped(job))
        if (!advance_once(job, step, err))
            return false;
    return true;
}

bool job_advance_crew(struct job *job, const struct job_step *step, struct err *err)
{
    struct renderer *r = &job->renderer;
    const struct job_listener *listener = &job->params.listener;
    const double left = step->seconds - job_elapsed(job);
    begin_deal(job, step);
    job->deal.seconds = step->seconds > 0.0 ? fmax(left, 1e-9) : 0.0;
    while (r->next_sample < step->samples && !job_is_stopped(job)) {
        if (step->seconds > 0.0 && r->next_sample > job->samples_first &&
            job_elapsed(job) >= step->seconds) {
            job->ended_by = ENDED_BY_TIME;
            break;
        }
        if (!advance_once(job, step, err) || !job_checkpoint_when_due(job, err) ||
            (listener->after_wave && !listener->after_wave(listener->context, err)))
            return false;
    }
    return true;
}
