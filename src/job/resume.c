// Checkpoints: when they are written, and how a render resumes from one.
#include "job/job_internal.h"

#include "base/clock.h"
#include "base/file_inputs.h"
#include "base/file_system.h"
#include "base/log.h"
#include <inttypes.h>
#include <math.h>
#include <string.h>

// --- resuming ------------------------------------------------------------------------------------

static bool is_there(const char *path)
{
    return file_exists(path);
}

// A shard continues from a part, and a whole render from the checkpoint of a whole render.
static bool check_kind(const struct job *job, const struct checkpoint *c, struct err *err)
{
    bool is_part = job_identity_is_part(c->identity);
    if (is_part == job_is_shard(job))
        return true;
    return is_part
               ? err_set(err, ERR_INPUT,
                         "%s: is a part of a render; expected the --shard that wrote it, or "
                         "lampyris merge",
                         c->path)
               : err_set(err, ERR_INPUT,
                         "%s: is the checkpoint of a whole render; expected no --shard", c->path);
}

bool job_checkpoint_open(struct job *job, struct err *err)
{
    const char *path = job->params.checkpoint.path;
    if (!path)
        return true;
    if (!job_identity(job))
        return err_memory(err, "a checkpoint", CHECKPOINT_TEXT_MAX);
    if (!job->params.checkpoint.resume)
        return is_there(path)
                   ? err_set(err, ERR_INPUT,
                             "%s: exists already; expected --resume, to continue from it, or "
                             "another name",
                             path)
                   : job_check_no_blocks(path, err);
    if (!is_there(path)) {
        log_warn("%s: does not exist: rendering begins anew", path);
        return true;
    }
    return file_inputs_add_own(path, err) &&
           checkpoint_open(path, &job->arena, &job->resumed, err) &&
           check_kind(job, &job->resumed, err) &&
           checkpoint_check(&job->resumed, job->identity, err);
}

// Returns the number of samples per pixel that are finished or have been begun.
static uint64_t samples_begun(const struct job *job)
{
    const struct renderer *r = &job->renderer;
    if (job->params.goal.adaptive)
        return (r->round_target > r->next_sample ? r->round_target : r->next_sample) *
               job->round_samples;
    return r->next_sample + (r->pass.length > 0 ? UINT64_C(1) << r->pass.shift : 0);
}

bool job_checkpoint_restore(struct job *job, struct err *err)
{
    const struct job_goal *goal = &job->params.goal;
    const char *path = job->params.checkpoint.path;
    job->checkpoint_ns = clock_ns();
    if (!job->resumed.file)
        return true;
    if (!checkpoint_restore(&job->resumed, &job->renderer, err))
        return false;
    memcpy(&job->looks_error, &job->resumed.note[JOB_NOTE_ERROR], sizeof job->looks_error);
    job->next_look = job->resumed.note[JOB_NOTE_NEXT_LOOK];
    checkpoint_close(&job->resumed);
    job->has_checkpoint = true;
    if (goal->adaptive)
        job->plan = tile_plan_of(job->renderer.frame.width, job->renderer.frame.height,
                                 job->renderer.tiles.counts);
    uint64_t begun = samples_begun(job);
    uint64_t wanted =
        goal->frames ? (uint64_t)goal->frames * goal->samples_per_frame : job->samples_most;
    if (begun > wanted)
        return err_set(err, ERR_INPUT,
                       "%s: has %" PRIu64 " samples per pixel; expected at most %" PRIu64
                       ", the number of this run",
                       path, begun, wanted);
    log_info("%s: continuing after %" PRIu64 " samples per pixel", path, begun);
    return true;
}

// --- saving --------------------------------------------------------------------------------------

void job_checkpoint_note(const struct job *job, uint64_t out[CHECKPOINT_NOTE_WORDS])
{
    memcpy(&out[JOB_NOTE_ERROR], &job->looks_error, sizeof job->looks_error);
    out[JOB_NOTE_NEXT_LOOK] = job->next_look;
    out[JOB_NOTE_SAMPLES] = job->scene->settings.spp;
    out[JOB_NOTE_AOVS] = job->renderer.specialization.aovs;
}

static bool write_checkpoint(struct job *job, const char *path, struct err *err)
{
    const struct checkpoint_text text = {job->identity, job->params.command};
    uint64_t start = clock_ns(), note[CHECKPOINT_NOTE_WORDS];
    job_checkpoint_note(job, note);
    bool ok = checkpoint_write(&job->renderer, path, &text, note, err);
    job->seconds.write += clock_seconds_since(start);
    return ok;
}

// With is_paced, the interval between checkpoints is this many times the time that one takes, so
// that checkpoints take about 2 % of the time; but it is never longer than params->seconds. A
// process that is killed loses what it rendered since its last checkpoint.
#define CHECKPOINT_PACE 50.0

double job_checkpoint_wait(const struct job *job)
{
    const struct job_checkpoint_params *params = &job->params.checkpoint;
    if (!params->path || job->saved.end > 0) // a checkpoint has all samples below a number
        return INFINITY;
    double every = params->seconds;
    if (params->is_paced)
        every = fmin(every, CHECKPOINT_PACE * job->checkpoint_cost);
    return fmax(every - clock_seconds_since(job->checkpoint_ns), 0.0);
}

bool job_checkpoint_save(struct job *job, struct err *err)
{
    const char *path = job->params.checkpoint.path;
    const uint64_t from = job->checkpoint_from ? job->checkpoint_from : clock_ns();
    job->checkpoint_from = 0;
    // Before the pilot has made a plan, or has chosen the integrator, there is nothing to resume.
    if (!path || job_is_pilot(job) || job->choice.is_unfinished)
        return true;
    // Until the samples between saved blocks are rendered, these and the checkpoint remain.
    if (job->saved.end > 0)
        return crew_save(job, path, err);
    bool ok = write_checkpoint(job, path, err);
    if (ok) {
        job_remove_blocks(job);
        job->held_saved = job->renderer.next_sample - job->samples_first;
    }
    job->has_checkpoint |= ok;
    job->checkpoint_cost = clock_seconds_since(from);
    job->checkpoint_ns = clock_ns();
    return ok;
}

bool job_checkpoint_write(struct job *job, const char *path, struct err *err)
{
    if (job_is_pilot(job))
        return err_set(err, ERR_USAGE,
                       "%s: no checkpoint can be written before the pilot of an adaptive render "
                       "has ended",
                       path);
    if (!job_identity(job))
        return err_memory(err, "a checkpoint", CHECKPOINT_TEXT_MAX);
    return write_checkpoint(job, path, err);
}

// If a checkpoint cannot be written, rendering continues: a full disk may have room later, and the
// image may be written elsewhere.
bool job_checkpoint_when_due(struct job *job, struct err *err)
{
    if (job_checkpoint_wait(job) > 0.0)
        return true;
    struct err failure = {0};
    if (job_checkpoint_save(job, &failure))
        return true;
    if (failure.code != ERR_OUTPUT) {
        if (err)
            *err = failure;
        return false;
    }
    log_warn("no checkpoint was written: %s", failure.msg);
    return true;
}

void job_checkpoint_mention(const struct job *job, struct err *err)
{
    if (job->has_checkpoint && err->code == ERR_GPU)
        err_set(err, err->code,
                "%s; the last checkpoint is kept: --checkpoint %s --resume continues from it",
                err->msg, job->params.checkpoint.path);
}
