#include "check/check_scene.h"

#include "base/log.h"
#include "check/scene/survey.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

// The small picture: enough pixels that a share of 1 % is 40 of them.
#define PICTURE_PIXELS 4096.0

static void shrink_picture(struct settings *settings)
{
    double width = settings->width, height = settings->height;
    double scale = sqrt(PICTURE_PIXELS / (width * height));
    if (scale >= 1.0)
        return;
    settings->width = (uint32_t)fmax(round(width * scale), 1.0);
    settings->height = (uint32_t)fmax(round(height * scale), 1.0);
}

static bool plan_memory(struct survey *survey, const struct renderer_params *params,
                        struct err *err)
{
    struct renderer renderer;
    if (!renderer_prepare(params, &renderer, err))
        return false;
    survey->plan = renderer.plan;
    survey->out->outlook.device_bytes = renderer.plan.total_bytes;
    renderer_finish(&renderer);
    return true;
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
    shrink_picture(&scene->settings);
    const struct job_params job = {
        .renderer = params,
        .scene = scene,
        .goal = {.samples = 1u << 16}, // steps decide
        .progress = params.progress,
    };
    return job_start(&job, &survey->job, err) && sightlines_take_view(survey, err);
}

static bool search(struct survey *survey, struct err *err)
{
    // The media's takes what the renders of measure_noise() have counted, the biases' their film.
    static bool (*const searches[])(struct survey * survey, struct err * err) = {
        find_coarse,  find_thin,     find_twice, find_normals, find_texels,   find_hidden_lights,
        find_albedos, measure_noise, find_media, find_biases,  measure_depth,
    };
    for (size_t i = 0; i < sizeof searches / sizeof *searches; i++) {
        if (!searches[i](survey, err))
            return false;
        if (progress_should_stop(survey->params->renderer.progress))
            return err_set(err, ERR_STOPPED, "stopped while checking the scene");
    }
    return true;
}

// More of the picture first, then what is worse.
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
    // What would be warned of is found here, and said in full.
    enum log_level level = log_set_level(LOG_ERROR);
    bool ok = prepare(&survey, err) && search(&survey, err);
    log_set_level(level);
    params->scene->settings = survey.settings;
    job_finish(&survey.job);
    geometry_finish(&survey.geometry);
    arena_finish(&survey.scratch);
    if (ok && out->count > 0)
        qsort(out->items, out->count, sizeof *out->items, compare);
    return ok;
}
