#include "viewer/core/view.h"

#include "job/film_error.h"
#include "viewer/core/messages.h"
#include "viewer/core/viewer.h"
#include <stdlib.h>

// The time between two error estimates, in seconds, after those at doubling numbers of samples. An
// estimate reads the film back, which delays the image a little.
#define LOOK_SECONDS 3.0
#define FIRST_LOOK 2 // samples at the first estimate: one in each half

uint64_t view_samples(const struct view *view)
{
    return view->is_ready ? view->job.renderer.next_sample - view->first_sample : 0;
}

void view_begin(struct view *view)
{
    view->epoch++;
    view->seconds = 0.0;
    view->first_sample = view->denoised_samples = 0;
    view->look_count = 0;
    view->sources = (struct error_sources){0};
    view->next_look = FIRST_LOOK;
}

bool view_is_denoised(const struct viewer *viewer, const struct view *view)
{
    bool is_to_be = viewer->stage.shown.denoise && viewer->stage.shown.what == SHOWN_RADIANCE &&
                    view->denoiser.gpu && view_samples(view) > 0;
    if (!is_to_be)
        return true;
    return view->denoised_samples == view_samples(view) &&
           view->denoised_by[0] == viewer->stage.shown.denoise_iterations &&
           view->denoised_by[1] == viewer->stage.shown.denoise_temporal;
}

struct denoise_call view_denoise_call(const struct viewer *viewer, const struct view *view)
{
    return (struct denoise_call){
        .renderer = &view->job.renderer,
        .camera = &view->job.renderer.camera,
        .iterations = viewer->stage.shown.denoise_iterations,
        .temporal = viewer->stage.shown.denoise_temporal,
        .has_changed = view->motion.has_changed,
        .motions = view->motion.list,
        .motion_count = view->motion.count,
    };
}

// --- the error -----------------------------------------------------------------------------------

struct look_job {
    uint32_t side;
    uint64_t epoch;
    double seconds, samples;
    struct job_estimate estimate;
};

static bool run_look(void *context, struct err *err)
{
    struct look_job *job = context;
    return job_estimate_end(&job->estimate, err);
}

// When the list is full, removes every other estimate of its older half, so that the curve keeps
// its beginning.
static void thin(struct view *view)
{
    uint32_t kept = 0;
    for (uint32_t i = 0; i < view->look_count; i++)
        if (i >= VIEW_LOOKS_MAX / 2 || i % 2 == 0)
            view->looks[kept++] = view->looks[i];
    view->look_count = kept;
}

static void add_look(struct view *view, const struct look_job *job)
{
    if (view->look_count == VIEW_LOOKS_MAX)
        thin(view);
    view->looks[view->look_count++] = (struct job_look){
        .seconds = job->seconds,
        .samples = job->samples,
        .error = job->estimate.error,
    };
    view->sources = job->estimate.sources;
}

struct job_look view_newest_look(const struct view *view)
{
    if (view->look_count > 0)
        return view->looks[view->look_count - 1];
    return (struct job_look){.error = film_error_none("fewer than two samples per pixel")};
}

static void free_job(struct look_job *job)
{
    if (job)
        arena_finish(&job->estimate.arena);
    free(job);
}

static void look_done(void *context, void *viewer, bool ok, const struct err *err)
{
    struct look_job *job = context;
    struct view *view = &((struct viewer *)viewer)->stage.sides[job->side];
    view->is_looking = false;
    if (!ok)
        viewer_message(viewer, MESSAGE_WARNING, "%s", err->msg);
    else if (job->epoch == view->epoch && view->is_ready)
        add_look(view, job);
    free_job(job);
}

// Returns whether the error can be estimated now. Both halves have equal numbers of samples if the
// number is even, and all pixels have the same number at the end of a pass.
bool view_wants_look(const struct viewer *viewer, const struct view *view)
{
    uint64_t samples = view_samples(view);
    // During a background build the scene's shared arrays may belong to another scene.
    if (!view->is_ready || view->is_preview || view->is_looking || view->method.fresh_frames ||
        rebuild_is_pending(viewer) || view->job.renderer.pass.length > 0 || samples % 2 != 0)
        return false;
    bool is_last = samples > 0 && samples == viewer->stage.shown.spp_limit;
    if (is_last &&
        (view->look_count == 0 || view->looks[view->look_count - 1].samples != (double)samples))
        return samples >= FIRST_LOOK;
    return (double)samples >= view->next_look &&
           viewer_seconds(viewer) - view->looked_seconds >= (samples > 256 ? LOOK_SECONDS : 0.0);
}

static bool start_look(struct viewer *viewer, uint32_t side, struct look_job *job, struct err *err)
{
    struct view *view = &viewer->stage.sides[side];
    *job = (struct look_job){
        .side = side,
        .epoch = view->epoch,
        .seconds = view->seconds,
        .samples = (double)view_samples(view),
    };
    return job_estimate_begin(&view->job, &job->estimate, err);
}

bool view_look_now(struct viewer *viewer, uint32_t side, struct err *err)
{
    struct view *view = &viewer->stage.sides[side];
    uint64_t samples = view_samples(view);
    bool is_known =
        view->look_count > 0 && view->looks[view->look_count - 1].samples == (double)samples;
    if (!view->is_ready || view->is_preview || samples < FIRST_LOOK || is_known)
        return true;
    struct look_job job;
    bool ok = start_look(viewer, side, &job, err) && run_look(&job, err);
    if (ok)
        add_look(view, &job);
    arena_finish(&job.estimate.arena);
    return ok;
}

bool view_look_at_error(struct viewer *viewer, uint32_t side, struct err *err)
{
    struct view *view = &viewer->stage.sides[side];
    if (!view_wants_look(viewer, view))
        return true;
    struct look_job *job = malloc(sizeof *job);
    if (!job)
        return err_memory(err, "error estimate", sizeof *job);
    if (!start_look(viewer, side, job, err)) {
        free_job(job);
        return false;
    }
    view->looked_seconds = viewer_seconds(viewer);
    // The first estimates are at doubling numbers of samples; later the time decides.
    view->next_look = job->samples >= 256 ? job->samples + 2 : 2 * job->samples;
    view->is_looking = worker_add(viewer->shell.worker, &(struct worker_task){
                                                            .name = "error",
                                                            .run = run_look,
                                                            .done = look_done,
                                                            .context = job,
                                                        });
    if (!view->is_looking)
        free_job(job); // the list of tasks is full, so this is tried again later
    return true;
}
