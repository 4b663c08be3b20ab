#include "render_job.h"

#include "clock.h"
#include "file.h"
#include "image.h"
#include <inttypes.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

static char *without_extension(struct arena *arena, const char *path)
{
    char *stem = arena_strdup(arena, path);
    const char *extension = path_extension(path);
    if (stem && *extension)
        stem[strlen(path) - strlen(extension) - 1] = '\0';
    return stem;
}

bool job_check_outputs(struct render_job *job, struct err *err)
{
    const struct options *options = job->options;
    job->outputs = options->outputs;
    job->output_count = options->output_count;
    if (job->output_count == 0) {
        char *stem = without_extension(&job->arena, path_name(options->arguments[0]));
        job->outputs = ARENA_NEW(&job->arena, const char *, 1);
        if (!stem || !job->outputs)
            return err_memory(err, "output names", 64);
        job->outputs[0] = arena_printf(&job->arena, "%s.exr", stem);
        if (!job->outputs[0])
            return err_memory(err, "output names", 64);
        job->output_count = 1;
    }
    for (uint32_t i = 0; i < job->output_count; i++)
        if (!image_check_format(job->outputs[i], err) || !file_check_writable(job->outputs[i], err))
            return false;
    return true;
}

// --- metadata
// -------------------------------------------------------------------------------------

#define MAX_ATTRIBUTES 64

struct attributes {
    struct arena *arena;
    struct image_attribute list[MAX_ATTRIBUTES];
    uint32_t count;
    bool failed;
};

static void add(struct attributes *a, const char *key, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

// Takes a value that lives in the arena, or NULL when there was no memory for it.
static void add_text(struct attributes *a, const char *key, const char *value)
{
    if (!value || a->count == MAX_ATTRIBUTES)
        a->failed = true;
    else
        a->list[a->count++] = (struct image_attribute){key, value};
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

static const char *estimator_name(enum light_estimator estimator)
{
    return estimator == ESTIMATOR_MIS ? "mis" : estimator == ESTIMATOR_NEE ? "nee" : "bsdf";
}

static const char *tone_name(enum tone_curve curve)
{
    static const char *const names[] = {
        [TONE_NONE] = "none",
        [TONE_REINHARD] = "reinhard",
        [TONE_ACES] = "aces",
        [TONE_AGX] = "agx",
    };
    return names[curve];
}

static void add_settings(struct attributes *a, const struct render_job *job)
{
    const struct settings *s = &job->scene.settings;
    add(a, "lampyris:spp", "%" PRIu64, job->film.most_samples);
    add(a, "lampyris:seed", "%u", s->seed);
    add(a, "lampyris:max_bounces", "%u", s->max_bounces);
    if (s->roulette_min_bounces == UINT32_MAX)
        add(a, "lampyris:roulette_min_bounces", "off");
    else
        add(a, "lampyris:roulette_min_bounces", "%u", s->roulette_min_bounces);
    add(a, "lampyris:estimator", "%s", estimator_name(s->estimator));
    add(a, "lampyris:filter", "box");
    add(a, "lampyris:pixel_jitter", "%s", s->pixel_jitter ? "on" : "off");
    add(a, "lampyris:exposure", "%.9g", s->exposure);
    add(a, "lampyris:tone", "%s", tone_name(s->tone_curve));
    add(a, "lampyris:camera", "%u", job->camera);
    add(a, "lampyris:wave", "%u", job->renderer.plan.wave_slots);
    add(a, "lampyris:features", "%s", job->options->features == FEATURES_ALL ? "all" : "needed");
    if (job->options->frames) {
        add(a, "lampyris:frames", "%u", job->options->frames);
        add(a, "lampyris:spp_per_frame", "%u", job->options->spp_per_frame);
        add(a, "lampyris:accumulate", "%s", job->options->accumulate ? "on" : "off");
    }
    if (job->options->time_seconds > 0.0)
        add(a, "lampyris:time_limit", "%.9g", job->options->time_seconds);
}

static void add_result(struct attributes *a, const struct render_job *job)
{
    if (job->film.least_samples != job->film.most_samples)
        add(a, "lampyris:spp_least", "%" PRIu64, job->film.least_samples);
    if (job->error.known) {
        add(a, "lampyris:relmse", "%.9g", job->error.relmse);
        add(a, "lampyris:relmse_ci_low", "%.9g", job->error.ci_low);
        add(a, "lampyris:relmse_ci_high", "%.9g", job->error.ci_high);
    }
    add(a, "lampyris:dropped_samples", "%" PRIu64, job->film.dropped);
    add(a, "lampyris:rays_closest", "%" PRIu64, job->renderer.stats.closest_rays);
    add(a, "lampyris:rays_shadow", "%" PRIu64, job->renderer.stats.shadow_rays);
    add(a, "lampyris:seconds_load", "%.6f", job->seconds.load);
    add(a, "lampyris:seconds_bvh", "%.6f", job->seconds.bvh);
    add(a, "lampyris:seconds_upload", "%.6f", job->seconds.upload);
    add(a, "lampyris:seconds_compile", "%.6f", job->seconds.compile);
    add(a, "lampyris:seconds_render", "%.6f", job->seconds.render);
    add(a, "lampyris:image_hash", "%016" PRIx64, job->image_hash);
}

static void add_attributes(struct attributes *a, const struct render_job *job)
{
    const struct options *options = job->options;
    add(a, "lampyris:version", "%s", LAMPYRIS_VERSION);
    add_text(a, "lampyris:command", job_command_line(options, a->arena, ""));
    add_text(a, "lampyris:scene", arena_strdup(a->arena, job->scene.path));
    add(a, "lampyris:scene_hash", "%016" PRIx64, job->scene.hash);
    add(a, "lampyris:device", "%s", job->gpu.info.name);
    add(a, "lampyris:driver", "%s", job->gpu.info.driver);
    add_settings(a, job);
    add_result(a, job);
}

// --- writing
// --------------------------------------------------------------------------------------

static enum image_tone image_tone(enum tone_curve curve)
{
    static const enum image_tone tones[] = {
        [TONE_NONE] = IMAGE_TONE_NONE,
        [TONE_REINHARD] = IMAGE_TONE_REINHARD,
        [TONE_ACES] = IMAGE_TONE_ACES,
        [TONE_AGX] = IMAGE_TONE_AGX,
    };
    return tones[curve];
}

static const char *numbered(struct arena *arena, const char *path, uint32_t frame)
{
    if (frame == 0)
        return path;
    char *stem = without_extension(arena, path);
    return stem ? arena_printf(arena, "%s.%04u.%s", stem, frame, path_extension(path)) : NULL;
}

bool job_write_outputs(struct render_job *job, uint32_t frame, struct err *err)
{
    uint64_t start = clock_ns();
    const struct settings *settings = &job->scene.settings;
    struct attributes attributes = {.arena = &job->arena};
    add_attributes(&attributes, job);
    if (attributes.failed)
        return err_memory(err, "metadata", sizeof attributes);

    const struct image image = {job->film.width, job->film.height, job->film.mean};
    for (uint32_t i = 0; i < job->output_count; i++) {
        const char *path = numbered(&job->arena, job->outputs[i], frame);
        if (!path)
            return err_memory(err, "output name", strlen(job->outputs[i]) + 16);
        struct image_write_params params = {
            .path = path,
            .image = &image,
            .attributes = attributes.list,
            .attribute_count = attributes.count,
            .half_float = job->options->half_float,
            .exposure_stops = settings->exposure,
            .tone = image_tone(settings->tone_curve),
        };
        if (!image_write(&params, err))
            return false;
    }
    job->seconds.write += clock_seconds_since(start);
    return true;
}
