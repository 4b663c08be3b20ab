// Reads the reference image of --reference, and reads and writes the file of --trace.
#include "cli/render/render_run.h"

#include "base/clock.h"
#include "base/file_system.h"
#include "base/log.h"
#include "cli/render/trace_file.h"
#include "report/json_out.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

// --- the reference -------------------------------------------------------------------------------

// Warns if the reference was rendered from the same scene with the same seed. The reference and the
// image then have samples in common, which makes the error between them too small.
static void warn_of_shared_samples(struct render_run *run, const char *path)
{
    struct image_attribute *list;
    uint32_t count;
    struct err none = {0};
    bool same_seed = false, same_scene = false;
    if (!image_read_attributes(path, &run->arena, &list, &count, &none))
        return;
    for (uint32_t i = 0; i < count; i++) {
        if (strcmp(list[i].key, "lampyris:seed") == 0)
            same_seed = strtoull(list[i].value, NULL, 10) == run->scene.settings.seed;
        if (strcmp(list[i].key, "lampyris:scene_hash") == 0)
            same_scene = strtoull(list[i].value, NULL, 16) == run->scene.hash;
    }
    if (same_seed && same_scene)
        log_warn("%s was rendered with the same --seed: errors against it are too small, as the "
                 "two pictures share samples",
                 path);
}

bool render_open_reference(struct render_run *run, struct err *err)
{
    const char *path = run->options->reference;
    const struct settings *settings = &run->scene.settings;
    if (!path)
        return true;
    if (strcmp(path, "auto") == 0 || strcmp(path, "none") == 0)
        return err_set(err, ERR_USAGE,
                       "--reference %s: render does not make a reference; expected the file of "
                       "a picture",
                       path);
    uint64_t start = clock_ns();
    if (!reference_read(path, run->options->progress, &run->arena, &run->reference, err) ||
        !reference_check_size(&run->reference, path, run->scene.path, settings->width,
                              settings->height, err))
        return false;
    if (!run->reference.noise_known)
        log_info("%s: its own noise is not subtracted: %s", path, run->reference.reason);
    warn_of_shared_samples(run, path);
    job_add_time(&run->job, JOB_JUDGING, start);
    return true;
}

// --- the trace -----------------------------------------------------------------------------------

bool render_read_trace(struct render_run *run, struct err *err)
{
    const char *path = run->options->render.trace;
    if (!path || !run->job.resumed.file) // if no checkpoint is resumed, the trace is replaced
        return true;
    if (!file_exists(path)) {
        log_warn("%s: does not exist: the trace begins where the checkpoint ends", path);
        return true;
    }
    struct trace trace = run->job.trace; // trace_read() checks its hashes and replaces its rows
    if (!trace_read(path, &trace, &run->arena, err))
        return false;
    job_resume_trace(&run->job, trace.rows, trace.count);
    return true;
}

static json_t *head_json(const struct render_run *run)
{
    const struct settings *settings = &run->scene.settings;
    const struct reference *reference = &run->reference;
    json_t *known = json_null();
    if (run->options->reference)
        known = json_pack(
            "{s:o, s:o, s:o, s:o}", "name", json_words(run->options->reference), "own_local_relmse",
            json_number(reference->noise_known ? reference->local_relmse : NAN), "own_relmse",
            json_number(reference->noise_known ? reference->relmse : NAN), "own_mse",
            json_number(reference->noise_known ? reference->mse : NAN));
    return json_pack("{s:s, s:o, s:o, s:o, s:o, s:i, s:i, s:I, s:o}", "version", LAMPYRIS_VERSION,
                     "command", json_words(run->options->command_line), "scene",
                     json_words(run->scene.path), "device", json_words(run->gpu.info.name),
                     "driver", json_words(run->gpu.info.driver), "width", (int)settings->width,
                     "height", (int)settings->height, "seed", (json_int_t)settings->seed,
                     "reference", known);
}

static bool write_file(struct render_run *run, struct err *err)
{
    uint64_t start = clock_ns();
    json_t *head = head_json(run);
    bool ok = head ? trace_write(run->options->render.trace, &run->job.trace, head, err)
                   : err_memory(err, "a trace", 0);
    json_decref(head);
    job_add_time(&run->job, JOB_JUDGING, start);
    return ok;
}

bool render_update_trace(struct render_run *run, struct err *err)
{
    const char *path = run->options->render.trace;
    struct err failure = {0};
    // Only a regular file can be rewritten after each row. Other files get all rows at the end.
    if (file_is_special(path) || write_file(run, &failure))
        return true;
    if (failure.code != ERR_OUTPUT) {
        if (err)
            *err = failure;
        return false;
    }
    log_warn("the trace was not written: %s", failure.msg);
    return true;
}

bool render_end_trace(struct render_run *run, struct err *err)
{
    job_end_trace(&run->job);
    return !run->options->render.trace || write_file(run, err);
}
