// The trace: the state of a render at doubling numbers of samples.
#include "job/job_internal.h"

#include "base/hash.h"
#include <inttypes.h>
#include <string.h>

static const char *hex(struct arena *arena, uint64_t hash)
{
    return arena_printf(arena, "%016" PRIx64, hash);
}

bool job_open_trace(struct job *job, struct err *err)
{
    if (!job->params.keeps_trace)
        return true;
    const char *identity = job_identity(job);
    if (!identity)
        return err_memory(err, "a trace", CHECKPOINT_TEXT_MAX);
    struct trace *trace = &job->trace;
    trace->render = hex(&job->arena, hash_bytes(HASH_INIT, identity, strlen(identity)));
    trace->reference = "";
    if (job->params.reference) {
        const struct image *image = &job->params.reference->image;
        uint64_t bytes = (uint64_t)image->width * image->height * sizeof *image->pixels;
        trace->reference = hex(&job->arena, hash_bytes(HASH_INIT, image->pixels, bytes));
    }
    trace->rows = ARENA_NEW(&job->arena, struct trace_row, TRACE_ROWS_MAX);
    return (trace->render && trace->reference && trace->rows) ||
           err_memory(err, "a trace", TRACE_ROWS_MAX * sizeof *trace->rows);
}

uint64_t job_next_row(const struct job *job, uint64_t done)
{
    if (!job->params.keeps_trace || done >= UINT64_C(1) << 62)
        return UINT64_MAX;
    uint64_t next = 1;
    while (next <= done)
        next *= 2;
    return next;
}

// Returns a new row. It replaces rows that an earlier run has added after its last checkpoint.
static struct trace_row *new_row(struct trace *trace, double frames, double spp)
{
    while (trace->count > 0) {
        const struct trace_row *last = &trace->rows[trace->count - 1];
        if (last->frames < frames || (last->frames == frames && last->spp < spp))
            break;
        trace->count--;
    }
    if (trace->count == TRACE_ROWS_MAX)
        trace->count--;
    return &trace->rows[trace->count++];
}

static void add_row(struct job *job)
{
    const struct job_goal *goal = &job->params.goal;
    const struct renderer *r = &job->renderer;
    const struct half_error *e = &job->error;
    uint64_t frames = goal->frames ? r->next_sample / goal->samples_per_frame : 0;
    double seconds = r->stats.render_seconds, spp = (double)job_film_samples(job);
    *new_row(&job->trace, (double)frames, spp) = (struct trace_row){
        .spp = spp,
        .frames = (double)frames,
        .seconds = seconds,
        .judging_seconds = job->seconds.judge,
        .msamples_per_s = job_total_samples(job) * 1e-6 / seconds,
        .closest_rays = (double)r->stats.closest_rays,
        .shadow_rays = (double)r->stats.shadow_rays,
        .local_relmse = e->local_relmse,
        .ci_low = e->ci_low,
        .ci_high = e->ci_high,
        .at_most = e->at_most,
        .true_local_relmse = job->against.local_relmse,
        .true_relmse = job->against.relmse,
        .true_mse = job->against.mse,
        .true_smape = job->against.smape,
        .true_psnr = job->against.psnr,
        .reason = e->reason,
    };
}

bool job_look_for_trace(struct job *job, struct err *err)
{
    const struct job_listener *listener = &job->params.listener;
    if (!job_read_film(job, err))
        return false;
    add_row(job);
    return !listener->after_row || listener->after_row(listener->context, err);
}

void job_end_trace(struct job *job)
{
    if (job->params.keeps_trace && job->film.most_samples > 0 && !job_is_pilot(job))
        add_row(job);
}
