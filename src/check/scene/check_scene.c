#include "check/check_scene.h"

#include "base/log.h"
#include "check/scene/survey.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

// The number of pixels of the small image: enough that 1 % of the image is 40 pixels.
#define PICTURE_PIXELS 4096.0

static void shrink_picture(struct settings *settings, double pixels)
{
    double width = settings->width, height = settings->height;
    double scale = sqrt(pixels / (width * height));
    if (scale >= 1.0)
        return;
    settings->width = (uint32_t)fmax(round(width * scale), 1.0);
    settings->height = (uint32_t)fmax(round(height * scale), 1.0);
}

// All renders of the small image together take about this many samples per pixel: 64 for the
// outlook, 64 for the tail, and 16 at each of several depths.
#define RENDERED_SAMPLES 200.0
// The limit, in seconds, of the estimated time of these renders. An image that would take longer
// gets fewer pixels, but at least LEAST_PIXELS.
#define RENDER_SECONDS 30.0
#define LEAST_PIXELS 256.0

// The longest time, in seconds, that one sample per pixel may take.
#define SAMPLE_SECONDS (RENDER_SECONDS / RENDERED_SAMPLES)

// The fastest of several samples is used: the first one includes start-up work, and other programs
// may slow down some of them.
#define TIMED_SAMPLES 5u
#define TIMED_SECONDS 3.0 // seconds after which no further sample is timed

static bool time_sample(struct job *job, uint32_t seed, double *seconds, struct err *err)
{
    *seconds = INFINITY;
    if (!job_begin(job, seed, 0, err))
        return false;
    for (uint32_t k = 1; k <= TIMED_SAMPLES && *seconds > SAMPLE_SECONDS; k++) {
        const struct job_step step = {
            .samples = k, .from = (k - 1.0) / TIMED_SAMPLES, .to = (double)k / TIMED_SAMPLES};
        double before = job_elapsed(job);
        if (k > 2 && before > TIMED_SECONDS)
            break;
        if (!job_advance(job, &step, err))
            return false;
        if (k > 1)
            *seconds = fmin(*seconds, job_elapsed(job) - before);
    }
    return true;
}

static bool tell_bound(struct survey *survey, double seconds, double pixels, struct err *err)
{
    const struct settings *s = &survey->scene->settings;
    return survey_add(
        survey,
        &(struct scene_finding){
            .name = "few-pixels",
            .level = FINDING_REMARK,
            .place = "the whole scene",
            .figure = arena_printf(survey->arena, "one sample of %.0f pixels takes %.2g s", pixels,
                                   seconds),
            .consequence = arena_printf(survey->arena,
                                        "This check renders only %u x %u pixels, so that its "
                                        "renders take about %.0f s; it may miss small objects.",
                                        s->width, s->height, RENDER_SECONDS),
            .remedy = "The scene needs no change; a faster or less busy device makes the check "
                      "more detailed.",
            .share = NAN,
        },
        err);
}

static bool start_job(struct survey *survey, struct err *err)
{
    const struct job_params *params = &survey->small;
    struct settings *settings = &survey->scene->settings;
    double pixels = (double)settings->width * settings->height, seconds;
    if (!job_start(params, &survey->job, err) ||
        !time_sample(&survey->job, survey->settings.seed, &seconds, err))
        return false;
    double affordable = pixels * SAMPLE_SECONDS / seconds;
    if (affordable >= pixels || pixels <= LEAST_PIXELS)
        return true;
    job_finish(&survey->job);
    shrink_picture(settings, fmax(affordable, LEAST_PIXELS));
    return job_start(params, &survey->job, err) && tell_bound(survey, seconds, pixels, err);
}

// Plans the memory of a render at the scene's own size. If it does not suffice, find_memory()
// reports it.
static bool plan_memory(struct survey *survey, const struct renderer_params *params,
                        struct err *err)
{
    struct renderer renderer;
    struct err failure = {0};
    if (renderer_prepare(params, &renderer, &failure)) {
        renderer_finish(&renderer);
        return true;
    }
    bool is_refused =
        failure.code == ERR_GPU || failure.code == ERR_SYSTEM || failure.code == ERR_BUDGET;
    survey->refusal = is_refused ? arena_strdup(survey->arena, failure.msg) : NULL;
    return survey->refusal || err_set(err, failure.code, "%s", failure.msg);
}

// Returns the bytes of the scene, of a film at the scene's own size, and of waves as large as the
// device's memory permits. Sets survey->least_bytes to the bytes without waves, and
// survey->small_bytes to those of the small image's render.
static uint64_t count_bytes(struct survey *survey)
{
    const struct renderer *renderer = &survey->job.renderer;
    const struct memory_plan_params picture = {
        .scene = survey->scene,
        .specialization = &renderer->specialization,
        .gpu = renderer->gpu,
        .pixels = (uint64_t)survey->settings.width * survey->settings.height,
    };
    uint64_t picture_bytes = memory_plan_picture_bytes(&picture), scene_bytes = 0, wave_bytes = 0;
    for (uint32_t b = 0; b < BINDING_COUNT; b++) {
        const struct planned_buffer *buffer = &renderer->plan.buffers[b];
        uint64_t bytes = buffer->bytes * buffer->copies;
        if (memory_plan_is_of_wave(&renderer->specialization, b))
            wave_bytes += bytes;
        else if (b != BINDING_FILM && b != BINDING_RESOLVED)
            scene_bytes += bytes;
    }
    survey->least_bytes = scene_bytes + picture_bytes;
    survey->small_bytes = renderer->plan.total_bytes;
    return survey->least_bytes + wave_bytes;
}

static bool prepare(struct survey *survey, struct err *err)
{
    struct renderer_params params = survey->params->renderer;
    struct scene *scene = survey->scene;
    survey->camera = &scene->cameras[params.camera];
    const struct geometry_params geometry = {
        .scene = scene,
        .bvh = params.bvh,
        .instancing = params.instancing,
        .bvh_cache = params.bvh_cache,
        .progress = params.progress,
        .camera = survey->camera,
    };
    if (!geometry_create(&geometry, &survey->geometry, err))
        return false;
    survey->flat = &survey->geometry.flat;
    params.geometry = &survey->geometry;
    if (!plan_memory(survey, &params, err))
        return false;
    shrink_picture(&scene->settings, PICTURE_PIXELS);
    survey->small = (struct job_params){
        .renderer = params,
        .scene = scene,
        // Never reached: the caller decides how many steps are rendered.
        .goal = {.samples = 1u << 16},
        .progress = params.progress,
    };
    if (!start_job(survey, err))
        return false;
    survey->out->outlook.device_bytes = count_bytes(survey);
    return sightlines_take_view(survey, err);
}

// Ends the job of the small image and keeps a copy of its pixels, so that later renders can use all
// of the device's memory.
static bool end_job(struct survey *survey, struct err *err)
{
    const struct film_image *film = &survey->job.film;
    size_t count = survey->line_count;
    struct image picture = {film->width, film->height,
                            arena_copy(survey->arena, film->mean, count, sizeof *film->mean)};
    job_finish(&survey->job);
    survey->out->picture = picture;
    return picture.pixels || err_memory(err, "a picture", count * sizeof *picture.pixels);
}

static bool search(struct survey *survey, struct err *err)
{
    // The searches, in order. find_media uses counts from the renders of measure_noise(); the
    // searches for lights and biases use the film of these renders. Searches after end_job() start
    // renders of their own.
    static bool (*const searches[])(struct survey * survey, struct err * err) = {
        find_thin,         find_twice,           find_coincident,    find_normals,
        find_texels,       measure_noise,        find_hidden_lights, find_mirrored_lights,
        find_narrow_spots, find_lights_on_faces, find_media,         find_biases,
        end_job,           name_twice,           find_memory,        find_idle_lights,
        find_coarse,       find_unscaled,        find_albedos,       measure_depth,
    };
    for (size_t i = 0; i < sizeof searches / sizeof *searches; i++) {
        if (!searches[i](survey, err))
            return false;
        if (progress_should_stop(survey->params->renderer.progress))
            return err_set(err, ERR_STOPPED, "stopped while checking the scene");
    }
    return true;
}

// Orders findings by descending share, then by descending level, then by name. Unknown shares are
// last.
static int compare(const void *a, const void *b)
{
    const struct scene_finding *x = a, *y = b;
    double of_x = isnan(x->share) ? -1.0 : x->share, of_y = isnan(y->share) ? -1.0 : y->share;
    if (of_x != of_y)
        return of_x < of_y ? 1 : -1;
    return x->level != y->level ? (int)y->level - (int)x->level : strcmp(x->name, y->name);
}

bool check_scene(const struct check_scene_params *params, struct arena *arena,
                 struct scene_findings *out, struct err *err)
{
    struct survey survey = {
        .params = params,
        .scene = params->scene,
        .arena = arena,
        .settings = params->scene->settings,
        .out = out,
    };
    *out = (struct scene_findings){.outlook = {.error = params->error}};
    // The loader's warnings are not logged, because the findings report the same in full.
    enum log_level level = log_set_level(LOG_ERROR);
    bool ok = prepare(&survey, err) && search(&survey, err) &&
              (!survey.lacks_memory || err_memory(err, "flags of pixels", survey.line_count));
    log_set_level(level);
    params->scene->settings = survey.settings;
    job_finish(&survey.job);
    geometry_finish(&survey.geometry);
    arena_finish(&survey.scratch);
    if (ok && out->count > 0)
        qsort(out->items, out->count, sizeof *out->items, compare);
    return ok;
}
