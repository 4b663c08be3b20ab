// Renders: creation, steps and state.
#include "library/library.h"

#include "base/clock.h"
#include "base/file_system.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

// --- life ----------------------------------------------------------------------------------------

void lampyris_render_release(struct lampyris_render *render)
{
    if (!render)
        return;
    struct lampyris_context *context = render->context;
    const struct log_target *former = log_redirect(context->params.log ? &context->log : NULL);
    job_finish(&render->job);
    log_redirect(former);
    arena_finish(&render->adapted.arena);
    arena_finish(&render->texts);
    arena_finish(&render->arena);
    loaded_release(render->loaded);
    free(render);
    context->renders--;
    library_unref(context);
}

// Copies the scene for the render. The copy has its own cameras and settings and shares all other
// data. Memory that is later allocated for the copy belongs to the render.
static bool adapt_scene(struct lampyris_render *render, const char *settings, struct err *err)
{
    const struct scene *shared = &render->loaded->scene;
    struct scene *own = &render->adapted;
    *own = *shared;
    own->arena = (struct arena){0};
    own->cameras =
        arena_copy(&render->arena, shared->cameras, shared->camera_count, sizeof *own->cameras);
    if (!own->cameras)
        return err_memory(err, "cameras", shared->camera_count * sizeof *own->cameras);
    return render_read_settings(settings, own, &render->arena, &render->wishes, err);
}

static bool check_resume(const char *path, struct err *err)
{
    return !path || file_exists(path) ||
           err_set(err, ERR_INPUT, "%s: there is no such checkpoint", path);
}

static bool start_job(struct lampyris_render *render, uint64_t start_ns, struct err *err)
{
    const struct render_wishes *wishes = &render->wishes;
    const struct job_params params = {
        .renderer = {.gpu = &render->context->gpu,
                     .scene = &render->adapted,
                     .tunes_wave = true,
                     .camera = wishes->camera,
                     .aovs = wishes->aovs},
        .scene = &render->adapted,
        .goal = wishes->goal,
        .checkpoint = {wishes->resume, INFINITY, wishes->resume != NULL},
        .progress = &render->progress.progress,
    };
    if (!job_init(&params, &render->job, err))
        return false;
    job_add_time(&render->job, JOB_LOADING, start_ns);
    return library_open_device(render->context, err) && job_open(&render->job, err) &&
           job_create(&render->job, err);
}

static bool begin(struct lampyris_render *render, struct lampyris_scene *scene,
                  const char *settings, const struct lampyris_progress *progress, struct err *err)
{
    uint64_t start_ns = clock_ns();
    return library_progress_init(&render->progress, progress, &render->job, err) &&
           scene_need(scene, &render->progress, &render->loaded, err) &&
           adapt_scene(render, settings, err) && check_resume(render->wishes.resume, err) &&
           start_job(render, start_ns, err);
}

enum lampyris_status lampyris_render_begin(struct lampyris_scene *scene, const char *settings,
                                           const struct lampyris_progress *progress,
                                           struct lampyris_render **out)
{
    struct lampyris_context *context = scene->context;
    *out = NULL;
    if (!library_enter(context))
        return LAMPYRIS_INPUT;
    struct lampyris_render *render = calloc(1, sizeof *render);
    if (!render)
        return library_leave(context, err_memory(&context->err, "a render", sizeof *render));
    render->context = context;
    bool ok = begin(render, scene, settings, progress, &context->err);
    render->progress.user = (struct lampyris_progress){0};
    if (ok)
        render->command = repeat_begin(scene, &render->arena);
    context->refs++;
    context->renders++;
    enum lampyris_status status = library_leave(context, ok);
    *out = ok ? render : NULL;
    if (!ok)
        lampyris_render_release(render);
    return status;
}

// --- steps ---------------------------------------------------------------------------------------

static bool find_goal(const struct lampyris_render *render, const struct lampyris_goal *given,
                      struct job_goal *out, struct err *err)
{
    struct lampyris_goal goal;
    *out = render->wishes.goal;
    if (!given)
        return true;
    if (!library_take(&goal, sizeof goal, given, "lampyris_goal", err))
        return false;
    if (!(goal.seconds >= 0) || !(goal.error >= 0) || goal.samples > SETTINGS_SPP_MAX)
        return err_set(err, ERR_USAGE,
                       "the goal has %llu samples, %.9g seconds and the error %.9g; expected at "
                       "most %u samples, and no negative numbers",
                       (unsigned long long)goal.samples, goal.seconds, goal.error,
                       SETTINGS_SPP_MAX);
    *out = (struct job_goal){.samples = goal.samples,
                             .seconds = goal.seconds,
                             .error = goal.error,
                             .adaptive = out->adaptive};
    return true;
}

// If the device failed, keeps the film that was read before, if there is one.
static bool rescue(struct lampyris_render *render, enum err_code failure)
{
    bool is_device = failure == ERR_GPU || failure == ERR_SYSTEM || failure == ERR_BUDGET;
    render->is_over = is_device;
    return is_device && job_rescue(&render->job, failure);
}

static bool step(struct lampyris_render *render, const struct lampyris_goal *goal,
                 const struct lampyris_progress *progress, struct err *err)
{
    struct job_goal wanted;
    if (render->is_over)
        return err_set(err, ERR_GPU, "the device failed during this render; begin another render");
    if (!find_goal(render, goal, &wanted, err) ||
        !library_progress_init(&render->progress, progress, &render->job, err) ||
        !job_set_goal(&render->job, &wanted, err))
        return false;
    render->is_judged = false;
    render->has_step = true;
    arena_finish(&render->texts);
    if (!job_run(&render->job, err)) {
        rescue(render, err->code);
        return false;
    }
    return !render->job.stopped ||
           err_set(err, ERR_STOPPED, "rendering was stopped; the next step continues it");
}

enum lampyris_status lampyris_render_step(struct lampyris_render *render,
                                          const struct lampyris_goal *goal,
                                          const struct lampyris_progress *progress)
{
    struct lampyris_context *context = render->context;
    if (!library_enter(context))
        return LAMPYRIS_INPUT;
    bool ok = step(render, goal, progress, &context->err);
    render->progress.user = (struct lampyris_progress){0};
    return library_leave(context, ok);
}

// --- state ---------------------------------------------------------------------------------------

bool render_need_film(struct lampyris_render *render, struct err *err)
{
    if (render->is_over && !job_is_rescued(&render->job))
        return err_set(err, ERR_GPU, "the device failed before this render had a picture");
    if (!render->is_judged)
        render->is_judged = job_judge_end(&render->job, err);
    return render->is_judged;
}

static struct lampyris_state state_of(const struct lampyris_render *render)
{
    const struct job *job = &render->job;
    const struct job_seconds *seconds = &job->seconds;
    const struct render_stats *stats = &job->renderer.stats;
    const struct half_error *error = &job->error;
    return (struct lampyris_state){
        .size = sizeof(struct lampyris_state),
        .width = job->film.width,
        .height = job->film.height,
        .samples = job_film_samples(job),
        .samples_total = (uint64_t)job_total_samples(job),
        .pixels_without_samples = job->film.unsampled,
        .samples_dropped = job->film.dropped,
        .ended_by = render->has_step ? job_ended_by(job) : "",
        .seconds_load = seconds->load,
        .seconds_bvh = seconds->bvh,
        .seconds_upload = seconds->upload,
        .seconds_compile = seconds->compile,
        .seconds_render = stats->render_seconds,
        .seconds_judge = seconds->judge,
        .seconds_write = seconds->write,
        .rays_closest = stats->closest_rays,
        .rays_shadow = stats->shadow_rays,
        .error = error->known ? error->local_relmse : NAN,
        .error_low = error->known ? error->ci_low : NAN,
        .error_high = error->known ? error->ci_high : NAN,
        .error_at_most = error->bounded ? error->at_most : NAN,
        .error_why = error->known || !error->reason ? "" : error->reason,
        .hash = job->image_hash,
    };
}

enum lampyris_status lampyris_render_state(struct lampyris_render *render,
                                           struct lampyris_state *out)
{
    struct lampyris_context *context = render->context;
    if (!library_enter(context))
        return LAMPYRIS_INPUT;
    bool ok = render_need_film(render, &context->err);
    if (ok) {
        const struct lampyris_state state = state_of(render);
        ok = library_give(out, &state, sizeof state, &context->err);
    }
    return library_leave(context, ok);
}
