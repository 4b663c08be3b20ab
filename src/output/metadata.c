// Describes in an image file how the image was made.
#include "output/metadata.h"

#include "job/job.h"
#include "output/layers.h"
#include "render/sampling_plan.h"
#include <inttypes.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

bool metadata_set(struct metadata *m, const char *key, const char *value, struct err *err)
{
    uint32_t at = 0;
    while (at < m->count && strcmp(m->list[at].key, key) != 0)
        at++;
    if (!value || at == METADATA_MAX)
        return err_memory(err, "metadata", sizeof *m);
    m->list[at] = (struct image_attribute){key, value};
    m->count += at == m->count;
    return true;
}

struct attributes {
    struct arena *arena;
    struct metadata *out;
    bool failed;
};

static void add(struct attributes *a, const char *key, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

static void add(struct attributes *a, const char *key, const char *format, ...)
{
    char text[600]; // long enough for the driver's name, which is the longest value
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    a->failed |= !metadata_set(a->out, key, arena_strdup(a->arena, text), NULL);
}

// Adds a value that is valid as long as the arena. NULL means that memory for the value ran out.
static void add_text(struct attributes *a, const char *key, const char *value)
{
    a->failed |= !metadata_set(a->out, key, value, NULL);
}

static void add_if_given(struct attributes *a, const char *key, const char *value)
{
    if (value)
        add(a, key, "%s", value);
}

static void add_setting(struct attributes *a, const struct setting *setting,
                        const struct settings *settings)
{
    char text[FIELD_TEXT_MAX];
    const char *key = arena_printf(a->arena, "lampyris:%s", setting->field.key);
    field_text(&setting->field, settings, text);
    a->failed |= !key;
    if (key)
        add(a, key, "%s", text);
}

static void add_goal(struct attributes *a, const struct job_goal *goal)
{
    if (goal->frames) {
        add(a, "lampyris:frames", "%u", goal->frames);
        add(a, "lampyris:spp_per_frame", "%u", goal->samples_per_frame);
        add(a, "lampyris:accumulate", "%s", goal->accumulate ? "on" : "off");
    }
    if (goal->seconds > 0.0 && isfinite(goal->seconds))
        add(a, "lampyris:time_limit", "%.9g", goal->seconds);
    if (goal->error > 0.0)
        add(a, "lampyris:error_limit", "%.9g", goal->error);
    add(a, "lampyris:adaptive", "%s", goal->adaptive ? "on" : "off");
}

static void add_settings(struct attributes *a, const struct metadata_params *params)
{
    const struct scene_load_params *load = params->load;
    const struct job_params *asked = &params->job->params;
    const struct renderer *r = &params->job->renderer;
    struct settings made = *params->settings;
    // The samples and the exposure of the image may differ from those in the settings.
    made.spp = params->samples;
    made.exposure = params->exposure;
    made.exposure_is_auto = false;
    for (int i = 0; i < SETTING_TOTAL; i++)
        add_setting(a, &settings_table[i], &made);
    if (sample_planning(params->settings, NULL) != PLANNING_NONE)
        add(a, "lampyris:samples_planned", "%u", r->frame.samples);
    add(a, "lampyris:camera", "%u", params->camera);
    const struct render_window *window = &asked->renderer.window;
    if (window->width > 0)
        add(a, "lampyris:crop", "%u,%u,%u,%u", window->x, window->y, window->x + window->width,
            window->y + window->height);
    add_if_given(a, "lampyris:gltf_scene", load->scene_name);
    add_if_given(a, "lampyris:animation", load->animation);
    add_if_given(a, "lampyris:variant", load->variant);
    if (load->at_seconds)
        add(a, "lampyris:at_seconds", "%.17g", *load->at_seconds);
    add(a, "lampyris:wave", "%u", r->plan.wave_slots);
    add(a, "lampyris:workgroup", "%u", r->specialization.workgroup);
    add(a, "lampyris:features", "%s", asked->renderer.compile_all ? "all" : "needed");
    add_goal(a, &asked->goal);
}

static void add_layers(struct attributes *a, const struct metadata_params *params)
{
    struct layers layers;
    const char *names = "";
    layers_list(params->film, params->job->renderer.aovs, &layers);
    for (uint32_t i = 0; i < layers.count && names; i++)
        names = arena_printf(a->arena, "%s%s%s", names, i ? "," : "", layers.list[i].name);
    if (layers.count > 0)
        add_text(a, "lampyris:layers", names);
}

// Adds the estimated error. An estimate without an interval is left out.
static void add_error(struct attributes *a, const struct half_error *error)
{
    if (error->known) {
        add(a, "lampyris:local_relmse", "%.9g", error->local_relmse);
        add(a, "lampyris:local_relmse_ci_low", "%.9g", error->ci_low);
        add(a, "lampyris:local_relmse_ci_high", "%.9g", error->ci_high);
    }
    if (error->bounded) {
        add(a, "lampyris:local_relmse_at_most", "%.9g", error->at_most);
        add(a, "lampyris:relmse_at_most", "%.9g", error->relmse_at_most);
    }
}

static void add_result(struct attributes *a, const struct metadata_params *params)
{
    const struct film_image *film = params->film;
    const struct render_stats *stats = &params->job->renderer.stats;
    const struct job_seconds *seconds = params->seconds;
    if (film->least_samples != film->most_samples) {
        add(a, "lampyris:spp_least", "%" PRIu64, film->least_samples);
        add(a, "lampyris:spp_most", "%" PRIu64, film->most_samples);
    }
    if (film->rows.end - film->rows.first < film->height)
        add(a, "lampyris:rows", "%u:%u", film->rows.first, film->rows.end);
    add(a, "lampyris:pixels_without_samples", "%" PRIu64, film->unsampled);
    add(a, "lampyris:ended_by", "%s", params->ended_by);
    add_error(a, params->error);
    add(a, "lampyris:dropped_samples", "%" PRIu64, film->dropped);
    add(a, "lampyris:rays_closest", "%" PRIu64, stats->closest_rays);
    add(a, "lampyris:rays_shadow", "%" PRIu64, stats->shadow_rays);
    add(a, "lampyris:seconds_load", "%.6f", seconds->load);
    add(a, "lampyris:seconds_bvh", "%.6f", seconds->bvh);
    add(a, "lampyris:seconds_upload", "%.6f", seconds->upload);
    add(a, "lampyris:seconds_compile", "%.6f", seconds->compile);
    add(a, "lampyris:seconds_render", "%.6f", seconds->render);
    add(a, "lampyris:image_hash", "%016" PRIx64, params->image_hash);
}

bool metadata_make(const struct metadata_params *params, struct arena *arena, struct metadata *out,
                   struct err *err)
{
    struct attributes a = {.arena = arena, .out = out};
    const struct job *job = params->job;
    *out = (struct metadata){0};
    add(&a, "lampyris:version", "%s", LAMPYRIS_VERSION);
    add_text(&a, "lampyris:command", params->command);
    if (params->repeat)
        add_text(&a, "lampyris:repeat", params->repeat);
    // The path is copied, because the viewer may open another scene before the image is written.
    add_text(&a, "lampyris:scene", arena_strdup(arena, job->scene->path));
    add(&a, "lampyris:scene_hash", "%016" PRIx64, job->scene->hash);
    const struct job_device device = job_device(job, arena);
    a.failed |= device.name == NULL;
    add_if_given(&a, "lampyris:device", device.name);
    add(&a, "lampyris:driver", "%s", device.driver);
    if (params->frame > 0)
        add(&a, "lampyris:frame", "%u", params->frame);
    add_settings(&a, params);
    add_layers(&a, params);
    add_result(&a, params);
    return !a.failed || err_memory(err, "metadata", sizeof *out);
}
