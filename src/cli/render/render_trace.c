#include "cli/render/render_trace.h"

#include "base/clock.h"
#include "base/hash.h"
#include "base/log.h"
#include "report/json_out.h"
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

// --- the reference -------------------------------------------------------------------------------

// Samples that picture and reference share are in both, so that the error between them is too
// small.
static void warn_of_shared_samples(struct render_job *job, const char *path)
{
    struct image_attribute *list;
    uint32_t count;
    struct err none = {0};
    bool same_seed = false, same_scene = false;
    if (!image_read_attributes(path, &job->arena, &list, &count, &none))
        return;
    for (uint32_t i = 0; i < count; i++) {
        if (strcmp(list[i].key, "lampyris:seed") == 0)
            same_seed = strtoull(list[i].value, NULL, 10) == job->scene.settings.seed;
        if (strcmp(list[i].key, "lampyris:scene_hash") == 0)
            same_scene = strtoull(list[i].value, NULL, 16) == job->scene.hash;
    }
    if (same_seed && same_scene)
        log_warn("%s was rendered with the same --seed: errors against it are too small, as the "
                 "two pictures share samples",
                 path);
}

bool job_open_reference(struct render_job *job, struct err *err)
{
    const char *path = job->options->reference;
    const struct settings *settings = &job->scene.settings;
    if (!path)
        return true;
    if (strcmp(path, "auto") == 0 || strcmp(path, "none") == 0)
        return err_set(err, ERR_USAGE,
                       "--reference %s: render makes none; expected the file of a picture", path);
    uint64_t start = clock_ns();
    if (!reference_read(path, &job->arena, &job->reference, err) ||
        !reference_check_size(&job->reference, path, job->scene.path, settings->width,
                              settings->height, err))
        return false;
    if (!job->reference.noise_known)
        log_info("%s: its own noise is not subtracted: %s", path, job->reference.reason);
    warn_of_shared_samples(job, path);
    job->seconds.judge += clock_seconds_since(start);
    return true;
}

// --- the trace -----------------------------------------------------------------------------------

static const char *hex(struct arena *arena, uint64_t hash)
{
    return arena_printf(arena, "%016" PRIx64, hash);
}

static bool name_trace(struct render_job *job, struct err *err)
{
    const struct image *image = &job->reference.image;
    const char *identity = job_identity(job);
    uint64_t bytes = (uint64_t)image->width * image->height * sizeof *image->pixels;
    if (!identity)
        return err_memory(err, "a trace", CHECKPOINT_IDENTITY_MAX);
    job->trace.render = hex(&job->arena, hash_bytes(HASH_INIT, identity, strlen(identity)));
    job->trace.reference =
        image->pixels ? hex(&job->arena, hash_bytes(HASH_INIT, image->pixels, bytes)) : "";
    job->trace.rows = ARENA_NEW(&job->arena, struct trace_row, TRACE_ROWS_MAX);
    return (job->trace.render && job->trace.reference && job->trace.rows) ||
           err_memory(err, "a trace", TRACE_ROWS_MAX * sizeof *job->trace.rows);
}

bool job_trace_open(struct render_job *job, struct err *err)
{
    const char *path = job->options->trace;
    struct stat status;
    if (!path)
        return true;
    if (!name_trace(job, err))
        return false;
    if (!job->resumed.file) // without one to go on from, the file is replaced
        return true;
    if (stat(path, &status) != 0) {
        log_warn("%s: does not exist: the trace begins where the checkpoint ends", path);
        return true;
    }
    return trace_read(path, &job->trace, &job->arena, err);
}

uint64_t job_trace_next(const struct render_job *job, uint64_t done)
{
    if (!job->options->trace || done >= UINT64_C(1) << 62)
        return UINT64_MAX;
    uint64_t next = 1;
    while (next <= done)
        next *= 2;
    return next;
}

static json_t *head_json(const struct render_job *job)
{
    const struct settings *settings = &job->scene.settings;
    const struct reference *reference = &job->reference;
    json_t *known = json_null();
    if (job->options->reference)
        known = json_pack(
            "{s:o, s:o, s:o, s:o}", "name", json_words(job->options->reference), "own_local_relmse",
            json_number(reference->noise_known ? reference->local_relmse : NAN), "own_relmse",
            json_number(reference->noise_known ? reference->relmse : NAN), "own_mse",
            json_number(reference->noise_known ? reference->mse : NAN));
    return json_pack("{s:s, s:o, s:o, s:o, s:o, s:i, s:i, s:I, s:o}", "version", LAMPYRIS_VERSION,
                     "command", json_words(job->options->command_line), "scene",
                     json_words(job->scene.path), "device", json_words(job->gpu.info.name),
                     "driver", json_words(job->gpu.info.driver), "width", (int)settings->width,
                     "height", (int)settings->height, "seed", (json_int_t)settings->seed,
                     "reference", known);
}

// What is no regular file cannot be written anew after every row: it gets all of them at the end.
static bool is_stream(const char *path)
{
    struct stat status;
    return stat(path, &status) == 0 && !S_ISREG(status.st_mode);
}

static bool write_file(struct render_job *job, struct err *err)
{
    uint64_t start = clock_ns();
    json_t *head = head_json(job);
    bool ok = head ? trace_write(job->options->trace, &job->trace, head, err)
                   : err_memory(err, "a trace", 0);
    json_decref(head);
    job->seconds.judge += clock_seconds_since(start);
    return ok;
}

// A row takes the place of those that a run before this one saw later than its last checkpoint.
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

static void fill_row(struct render_job *job)
{
    const struct options *options = job->options;
    const struct renderer *r = &job->renderer;
    const struct half_error *e = &job->error;
    uint64_t frames = options->frames ? r->next_sample / options->spp_per_frame : 0;
    double seconds = r->stats.render_seconds;
    struct trace_row *row = new_row(&job->trace, (double)frames, (double)job_film_samples(job));
    *row = (struct trace_row){
        .spp = (double)job_film_samples(job),
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

bool job_trace_add(struct render_job *job, struct err *err)
{
    const char *path = job->options->trace;
    if (!path)
        return true;
    struct err failure = {0};
    fill_row(job);
    if (is_stream(path) || write_file(job, &failure))
        return true;
    if (failure.code != ERR_OUTPUT) {
        if (err)
            *err = failure;
        return false;
    }
    log_warn("the trace was not written: %s", failure.msg);
    return true;
}

bool job_trace_look(struct render_job *job, struct err *err)
{
    return job_read_film(job, err) && job_trace_add(job, err);
}

bool job_trace_end(struct render_job *job, struct err *err)
{
    bool is_pilot = job->options->adaptive && !job->plan.counts;
    if (!job->options->trace)
        return true;
    if (job->film.most_samples > 0 && !is_pilot)
        fill_row(job);
    return write_file(job, err);
}
