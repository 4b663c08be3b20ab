// Makes the identity of a render: everything that determines its samples. A render can only be
// resumed if this is unchanged.
#include "job/job_internal.h"

#include "render/aov_names.h"
#include "render/kernels.h"
#include "render/sampling_plan.h"
#include "shared/aov.h"
#include <inttypes.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

struct text {
    struct arena *arena;
    const char *so_far; // NULL: memory ran out
};

static void add(struct text *text, const char *format, ...) __attribute__((format(printf, 2, 3)));

static void add(struct text *text, const char *format, ...)
{
    char line[1024];
    va_list arguments;
    va_start(arguments, format);
    int length = vsnprintf(line, sizeof line, format, arguments);
    va_end(arguments);
    for (int i = 0; i < length && line[i] != '\0'; i++)
        if (line[i] == '\n')
            line[i] = ' ';
    if (text->so_far)
        text->so_far = arena_printf(text->arena, "%s%s\n", text->so_far, line);
}

// Adds all settings that change bits of the film, except the number of samples, which
// make_identity() adds. Different values must have different texts.
static void add_settings(struct text *text, const struct settings *settings)
{
    add(text, JOB_SIZE_LINE "%ux%u", settings->width, settings->height);
    for (int i = SETTINGS_FILM_LAST + 1; i < SETTING_TOTAL; i++) {
        const struct setting *setting = &settings_table[i];
        char value[FIELD_TEXT_MAX], name[48];
        if (!setting->changes_samples)
            continue;
        field_text(&setting->field, settings, value);
        snprintf(name, sizeof name, setting->option ? "--%s" : "%s",
                 setting->option ? setting->option : setting->field.key);
        for (char *c = name; *c; c++)
            *c = *c == '_' ? ' ' : *c;
        add(text, "%s=%s", name, value);
    }
}

static void add_camera(struct text *text, const struct job *job)
{
    const struct camera *c = &job->scene->cameras[job->params.renderer.camera];
    add(text,
        "camera=number %u at %.17g %.17g %.17g towards %.17g %.17g %.17g, up %.17g %.17g %.17g, "
        "kind %u, field of view %.17g, height %.17g",
        job->params.renderer.camera, c->position[0], c->position[1], c->position[2],
        c->direction[0], c->direction[1], c->direction[2], c->up[0], c->up[1], c->up[2], c->kind,
        c->fov_y, c->height);
    add(text, "lens=radius %.17g, focus at %.17g, %u blades turned by %.17g", c->lens_radius,
        c->focus_distance, c->lens_blades, c->lens_rotation);
}

// Returns the names of all different devices of a crew.
static const char *crew_names(const struct crew *crew, struct arena *arena)
{
    const char *names = JOB_SEVERAL_DEVICES;
    for (uint32_t i = 0; names && i <= crew->count; i++) {
        const struct crew_member *members = crew->members;
        bool is_new = true;
        for (uint32_t k = 0; k < i; k++)
            is_new &= strcmp(members[k].device, members[i].device) != 0 ||
                      strcmp(members[k].driver, members[i].driver) != 0;
        if (is_new)
            names = arena_printf(arena, "%s%s%s (%s)", names, i > 0 ? JOB_DEVICE_SEPARATOR : "",
                                 members[i].device, members[i].driver);
    }
    return names;
}

struct job_device job_device(const struct job *job, struct arena *arena)
{
    const struct crew *crew = job->params.crew;
    const struct job_merged *merged = job->params.merged;
    const char *names = merged ? merged->devices : NULL;
    if (!names && (!crew || crew_is_uniform(crew)))
        return (struct job_device){job->gpu->info.name, job->gpu->info.driver};
    return (struct job_device){names ? names : crew_names(crew, arena), "several"};
}

static void add_device(struct text *text, const struct job *job)
{
    const struct job_device device = job_device(job, text->arena);
    if (!device.name)
        text->so_far = NULL;
    if (text->so_far) // add() would cut a long list of devices
        text->so_far = arena_printf(text->arena, "%s" JOB_DEVICE_LINE "%s\n" JOB_DRIVER_LINE "%s\n",
                                    text->so_far, device.name, device.driver);
}

static void add_environment(struct text *text, const struct environment *e)
{
    add(text,
        "environment=radiance %.9g %.9g %.9g turned by %.17g, sun of %.9g %.9g %.9g and radius "
        "%.17g from %.17g %.17g %.17g",
        (double)e->radiance[0], (double)e->radiance[1], (double)e->radiance[2], e->rotation,
        (double)e->sun.irradiance[0], (double)e->sun.irradiance[1], (double)e->sun.irradiance[2],
        e->sun.angular_radius, e->sun.direction[0], e->sun.direction[1], e->sun.direction[2]);
}

static void add_aovs(struct text *text, uint32_t aovs)
{
    char names[AOV_NAMES_TEXT_MAX];
    aov_names_text(aovs, aov_names, names);
    add(text, "--aov=%s", names);
    if (!(aovs & AOVS_BY))
        return;
    aov_names_text(aovs, error_by_names, names);
    add(text, "--error-by=%s", names);
}

// Parts by tiles have all samples of the render, which therefore must be equally many in all parts.
static void add_shard(struct text *text, const struct job *job)
{
    const bool by_tiles = job->params.shard.by_tiles;
    struct sample_range range = {job->samples_first, job->samples_most};
    if (by_tiles)
        range = job->rows;
    if (by_tiles)
        add(text, JOB_SHARD_BY_LINE JOB_BY_TILES " of %" PRIu64 " samples a pixel",
            job->scene->settings.spp);
    else if (job_is_shard(job) || job->params.merged)
        add(text, JOB_SHARD_BY_LINE "samples");
    if (job_is_shard(job))
        add(text, JOB_SHARD_LINE "%" PRIu64 ":%" PRIu64, range.first, range.end);
    else
        add(text, JOB_SHARD_LINE "none");
}

static const char *make_identity(struct job *job)
{
    const struct job_goal *goal = &job->params.goal;
    struct text text = {.arena = &job->arena, .so_far = ""};
    add(&text, "version=%s", LAMPYRIS_VERSION);
    add(&text, "kernels=%016" PRIx64, kernels_hash());
    add_device(&text, job);
    add(&text, "scene of hash=%016" PRIx64, job->scene->hash);
    const struct render_window *window = &job->params.renderer.window;
    if (window->width > 0)
        add(&text, "--crop=%u,%u,%u,%u", window->x, window->y, window->x + window->width,
            window->y + window->height);
    add_camera(&text, job);
    add_environment(&text, &job->scene->environment);
    add_settings(&text, &job->scene->settings);
    if (sample_planning(&job->scene->settings, NULL) != PLANNING_NONE)
        add(&text, "samples planned=%" PRIu64,
            job_is_open_ended(job) ? 0 : job->scene->settings.spp);
    static const char *const instancing_names[] = {
        [INSTANCING_AUTO] = "auto", [INSTANCING_ON] = "on", [INSTANCING_OFF] = "off"};
    add(&text, "--instances=%s", instancing_names[job->params.renderer.instancing]);
    add_aovs(&text, job->params.renderer.aovs);
    add(&text, "--adaptive=%s", goal->adaptive ? "on" : "off");
    if (goal->adaptive)
        add(&text, JOB_ROUND_LINE "%u", job->round_samples);
    add(&text, "--frames=%s", goal->frames ? "some" : "none");
    if (goal->frames) {
        add(&text, "--spp-per-frame=%u", goal->samples_per_frame);
        add(&text, "--accumulate=%s", goal->accumulate ? "on" : "off");
    }
    add_shard(&text, job);
    return text.so_far;
}

bool job_identity_is_part(const char *identity)
{
    return !strstr(identity, "\n" JOB_SHARD_LINE "none");
}

const char *job_identity_without(const char *identity, const char *const *names, uint32_t count,
                                 struct arena *arena)
{
    char *out = ARENA_NEW(arena, char, strlen(identity) + 1), *end = out;
    while (out && *identity) {
        size_t length = strcspn(identity, "\n");
        length += identity[length] == '\n';
        bool is_kept = true;
        for (uint32_t i = 0; i < count; i++)
            is_kept &= strncmp(identity, names[i], strlen(names[i])) != 0;
        if (is_kept) {
            memcpy(end, identity, length);
            end += length;
        }
        identity += length;
    }
    return out;
}

const char *job_identity(struct job *job)
{
    if (!job->identity)
        job->identity = make_identity(job);
    return job->identity;
}
