// What a picture says about how it was made: enough to judge it, and to make it again.
#include "cli/render/render_run.h"

#include <inttypes.h>
#include <stdarg.h>
#include <stdio.h>

struct attributes {
    struct arena *arena;
    struct render_attributes *out;
    bool failed;
};

static void add(struct attributes *a, const char *key, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

// Takes a value that lives as long as the arena, or NULL when there was no memory for it.
static void add_text(struct attributes *a, const char *key, const char *value)
{
    if (!value || a->out->count == RENDER_MAX_ATTRIBUTES)
        a->failed = true;
    else
        a->out->list[a->out->count++] = (struct image_attribute){key, value};
}

static void add(struct attributes *a, const char *key, const char *format, ...)
{
    char text[600]; // the longest is the driver's name
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    add_text(a, key, arena_strdup(a->arena, text));
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

static void add_settings(struct attributes *a, const struct render_run *run)
{
    for (int i = 0; i < SETTING_TOTAL; i++)
        if (i != SETTING_SPP && i != SETTING_EXPOSURE)
            add_setting(a, &settings_table[i], &run->scene.settings);
    // What the picture has, not what was asked for.
    add(a, "lampyris:spp", "%" PRIu64, job_samples(&run->job));
    add(a, "lampyris:exposure", "%.9g", (double)run->exposure);
    add(a, "lampyris:camera", "%u", run->camera);
    if (run->options->scene.gltf_scene)
        add(a, "lampyris:scene", "%s", run->options->scene.gltf_scene);
    if (run->options->scene.animation)
        add(a, "lampyris:animation", "%s", run->options->scene.animation);
    if (run->options->scene.variant)
        add(a, "lampyris:variant", "%s", run->options->scene.variant);
    if (options_given(run->options, OPTION_AT))
        add(a, "lampyris:at_seconds", "%.17g", run->options->scene.at_seconds);
    add(a, "lampyris:wave", "%u", run->job.renderer.plan.wave_slots);
    add(a, "lampyris:workgroup", "%u", run->job.renderer.specialization.workgroup);
    add(a, "lampyris:features", "%s",
        run->options->device.features == FEATURES_ALL ? "all" : "needed");
    if (run->options->render.frames) {
        add(a, "lampyris:frames", "%u", run->options->render.frames);
        add(a, "lampyris:spp_per_frame", "%u", run->options->render.spp_per_frame);
        add(a, "lampyris:accumulate", "%s", run->options->render.accumulate ? "on" : "off");
    }
    if (run->options->render.time_seconds > 0.0)
        add(a, "lampyris:time_limit", "%.9g", run->options->render.time_seconds);
    if (run->options->render.error > 0.0)
        add(a, "lampyris:error_limit", "%.9g", run->options->render.error);
    add(a, "lampyris:adaptive", "%s", run->options->render.adaptive ? "on" : "off");
}

static void add_layers(struct attributes *a, const struct render_run *run)
{
    struct render_layers layers;
    const char *names = "";
    render_list_layers(&run->job.film, run->options->render.aovs, &layers);
    for (uint32_t i = 0; i < layers.count && names; i++)
        names = arena_printf(a->arena, "%s%s%s", names, i ? "," : "", layers.list[i].name);
    if (layers.count > 0)
        add_text(a, "lampyris:layers", names);
}

// Where the estimate has no interval, it does not stand here.
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

static void add_result(struct attributes *a, const struct render_run *run)
{
    if (run->job.film.least_samples != run->job.film.most_samples) {
        add(a, "lampyris:spp_least", "%" PRIu64, run->job.film.least_samples);
        add(a, "lampyris:spp_most", "%" PRIu64, run->job.film.most_samples);
    }
    add(a, "lampyris:pixels_without_samples", "%" PRIu64, run->job.film.unsampled);
    add(a, "lampyris:ended_by", "%s", job_ended_by(&run->job));
    add_error(a, &run->job.error);
    add(a, "lampyris:dropped_samples", "%" PRIu64, run->job.film.dropped);
    add(a, "lampyris:rays_closest", "%" PRIu64, run->job.renderer.stats.closest_rays);
    add(a, "lampyris:rays_shadow", "%" PRIu64, run->job.renderer.stats.shadow_rays);
    add(a, "lampyris:seconds_load", "%.6f", run->job.seconds.load);
    add(a, "lampyris:seconds_bvh", "%.6f", run->job.seconds.bvh);
    add(a, "lampyris:seconds_upload", "%.6f", run->job.seconds.upload);
    add(a, "lampyris:seconds_compile", "%.6f", run->job.seconds.compile);
    add(a, "lampyris:seconds_render", "%.6f", run->job.seconds.render);
    add(a, "lampyris:image_hash", "%016" PRIx64, run->job.image_hash);
}

// The command that makes this picture again, wherever a clock, the error or the number of the frame
// decided what is in it. There is none for one that a signal cut short.
static const char *repeating_command(const struct render_run *run, uint32_t frame,
                                     struct arena *arena)
{
    const struct options *options = run->options;
    const char *line = options->render.repeatable_line;
    if (frame > 0)
        line = arena_printf(arena, "%s --frames %u", line, frame);
    else if (run->job.ended_by == ENDED_BY_TIME && options->render.frames)
        line = arena_printf(arena, "%s --frames %u", line, run->job.frame_count);
    else if (run->job.ended_by == ENDED_BY_TIME || job_is_rescued(&run->job) ||
             options->render.error > 0.0)
        line = arena_printf(arena, "%s --spp %" PRIu64, line, job_samples(&run->job));
    bool is_timed = options->render.time_seconds > 0.0;
    return line && is_timed ? arena_printf(arena, "%s --time %.9g", line, OPTION_TIME_MAX) : line;
}

// Without a number of samples that all pixels have, no command makes the same picture.
static bool is_repeatable(const struct render_run *run)
{
    bool is_even = run->job.rescue.copied.is_even && !run->options->render.frames;
    return !run->job.stopped && (!job_is_rescued(&run->job) || is_even);
}

bool render_describe(const struct render_run *run, uint32_t frame, struct arena *arena,
                     struct render_attributes *out, struct err *err)
{
    struct attributes a = {.arena = arena, .out = out};
    *out = (struct render_attributes){0};
    add(&a, "lampyris:version", "%s", LAMPYRIS_VERSION);
    add_text(&a, "lampyris:command", run->options->command_line);
    if (is_repeatable(run))
        add_text(&a, "lampyris:repeat", repeating_command(run, frame, arena));
    // The viewer may have another scene before the picture is written.
    add_text(&a, "lampyris:scene", arena_strdup(arena, run->scene.path));
    add(&a, "lampyris:scene_hash", "%016" PRIx64, run->scene.hash);
    add(&a, "lampyris:device", "%s", run->gpu.info.name);
    add(&a, "lampyris:driver", "%s", run->gpu.info.driver);
    if (frame > 0)
        add(&a, "lampyris:frame", "%u", frame);
    add_settings(&a, run);
    add_layers(&a, run);
    add_result(&a, run);
    return a.failed ? err_memory(err, "metadata", sizeof *out) : true;
}
