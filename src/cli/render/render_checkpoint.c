// --checkpoint and --resume: what must be the same for a render to go on, and when it is saved.
#include "cli/render/render_job.h"

#include "base/clock.h"
#include "base/file_inputs.h"
#include "base/log.h"
#include "render/sampling_plan.h"
#include <errno.h>
#include <inttypes.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

// --- the identity
// ---------------------------------------------------------------------------------

struct text {
    struct arena *arena;
    const char *so_far; // NULL: there was no memory
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

// All settings that change bits of the film; for the number of samples, see below. Numbers stand as
// such where scene files have a word.
static void add_settings(struct text *text, const struct settings *settings)
{
    add(text, "--size=%ux%u", settings->width, settings->height);
    for (int i = SETTINGS_FILM_LAST + 1; i < SETTING_TOTAL; i++) {
        const struct setting *setting = &settings_table[i];
        char value[FIELD_TEXT_MAX], name[48];
        if (!setting->changes_film || i == SETTING_SPP)
            continue;
        field_text(&setting->field, settings, value);
        if (setting->field.type == FIELD_REAL)
            snprintf(value, sizeof value, "%.9g", field_get(&setting->field, settings));
        snprintf(name, sizeof name, setting->option ? "--%s" : "%s",
                 setting->option ? setting->option : setting->field.key);
        for (char *c = name; *c; c++)
            *c = *c == '_' ? ' ' : *c;
        add(text, "%s=%s", name, value);
    }
}

// As the command line has changed it.
static void add_camera(struct text *text, const struct render_job *job)
{
    const struct camera *c = &job->scene.cameras[job->camera];
    add(text,
        "camera=number %u at %.17g %.17g %.17g towards %.17g %.17g %.17g, up %.17g %.17g %.17g, "
        "kind %u, field of view %.17g, height %.17g",
        job->camera, c->position[0], c->position[1], c->position[2], c->direction[0],
        c->direction[1], c->direction[2], c->up[0], c->up[1], c->up[2], c->kind, c->fov_y,
        c->height);
    add(text, "lens=radius %.17g, focus at %.17g, %u blades turned by %.17g", c->lens_radius,
        c->focus_distance, c->lens_blades, c->lens_rotation);
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

static const char *make_identity(struct render_job *job)
{
    const struct options *options = job->options;
    struct text text = {.arena = &job->arena, .so_far = ""};
    add(&text, "version=%s", LAMPYRIS_VERSION);
    add(&text, "device=%s", job->gpu.info.name);
    add(&text, "driver=%s", job->gpu.info.driver);
    add(&text, "scene of hash=%016" PRIx64, job->scene.hash);
    add_camera(&text, job);
    add_environment(&text, &job->scene.environment);
    add_settings(&text, &job->scene.settings);
    if (sample_planning(&job->scene.settings, NULL) != PLANNING_NONE)
        add(&text, "samples planned=%" PRIu64,
            job_is_open_ended(options) ? 0 : job->scene.settings.spp);
    add(&text, "--aov=0x%x", options->aovs);
    add(&text, "--adaptive=%s", options->adaptive ? "on" : "off");
    if (options->adaptive)
        add(&text, "samples a round=%u", job->round_samples);
    add(&text, "--frames=%s", options->frames ? "some" : "none");
    if (options->frames) {
        add(&text, "--spp-per-frame=%u", options->spp_per_frame);
        add(&text, "--accumulate=%s", options->accumulate ? "on" : "off");
    }
    return text.so_far;
}

const char *job_identity(struct render_job *job)
{
    if (!job->identity)
        job->identity = make_identity(job);
    return job->identity;
}

// --- going on
// -------------------------------------------------------------------------------------

static bool is_there(const char *path)
{
    return access(path, F_OK) == 0;
}

bool job_checkpoint_open(struct render_job *job, struct err *err)
{
    const struct options *options = job->options;
    const char *path = options->checkpoint;
    if (!path)
        return true;
    if (!job_identity(job))
        return err_memory(err, "a checkpoint", CHECKPOINT_IDENTITY_MAX);
    if (!options->resume)
        return !is_there(path) ||
               err_set(err, ERR_INPUT,
                       "%s: exists already: expected --resume, to go on from it, or another name",
                       path);
    if (!is_there(path)) {
        log_warn("%s: does not exist: rendering begins anew", path);
        return true;
    }
    return file_inputs_add_own(path, err) &&
           checkpoint_open(path, &job->arena, &job->resumed, err) &&
           checkpoint_check(&job->resumed, job->identity, err);
}

// Samples of each pixel that there are already, or have been begun.
static uint64_t samples_begun(const struct render_job *job)
{
    const struct renderer *r = &job->renderer;
    if (job->options->adaptive)
        return (r->round_target > r->next_sample ? r->round_target : r->next_sample) *
               job->round_samples;
    return r->next_sample + (r->pass.length > 0 ? UINT64_C(1) << r->pass.shift : 0);
}

bool job_checkpoint_restore(struct render_job *job, struct err *err)
{
    const struct options *options = job->options;
    job->checkpoint_ns = clock_ns();
    if (!job->resumed.file)
        return true;
    if (!checkpoint_restore(&job->resumed, &job->renderer, err))
        return false;
    memcpy(&job->goal.error, &job->resumed.note[0], sizeof job->goal.error);
    job->goal.next_look = job->resumed.note[1];
    checkpoint_close(&job->resumed);
    job->has_checkpoint = true;
    if (job->options->adaptive)
        job->plan = tile_plan_of(job->renderer.frame.width, job->renderer.frame.height,
                                 job->renderer.tiles.counts);
    uint64_t begun = samples_begun(job);
    uint64_t wanted =
        options->frames ? (uint64_t)options->frames * options->spp_per_frame : job->samples_most;
    if (begun > wanted)
        return err_set(err, ERR_INPUT,
                       "%s: has %" PRIu64 " samples a pixel; expected no more than the %" PRIu64
                       " that this run is to have",
                       options->checkpoint, begun, wanted);
    log_info("%s: going on after %" PRIu64 " samples a pixel", options->checkpoint, begun);
    return true;
}

// --- saving
// ---------------------------------------------------------------------------------------

bool job_checkpoint_save(struct render_job *job, struct err *err)
{
    const char *path = job->options->checkpoint;
    // Before there is a plan, there is nothing to go on from.
    bool is_pilot = job->options->adaptive && job->plan.counts == NULL;
    if (!path || is_pilot)
        return true;
    uint64_t start = clock_ns(), note[CHECKPOINT_NOTE_WORDS] = {0, job->goal.next_look};
    memcpy(&note[0], &job->goal.error, sizeof job->goal.error);
    bool ok = checkpoint_write(&job->renderer, path, job->identity, note, err);
    job->has_checkpoint |= ok;
    job->seconds.write += clock_seconds_since(start);
    job->checkpoint_ns = clock_ns();
    return ok;
}

// A disk that is full now may have room later, and the picture itself may go elsewhere.
bool job_checkpoint_when_due(void *context, struct err *err)
{
    (void)err;
    struct render_job *job = context;
    if (!job->options->checkpoint ||
        clock_seconds_since(job->checkpoint_ns) < job->options->checkpoint_seconds)
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

void job_checkpoint_mention(const struct render_job *job, struct err *err)
{
    if (job->has_checkpoint && err->code == ERR_GPU)
        err_set(err, err->code, "%s; the last checkpoint is kept: --checkpoint %s --resume goes on",
                err->msg, job->options->checkpoint);
}
