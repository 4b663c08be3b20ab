#include "cli/outputs.h"
#include "cli/render/render_run.h"
#include "cli/render/trace_file.h"
#include "cli/scene_options.h"

#include "base/clock.h"
#include "base/file.h"
#include "base/file_system.h"
#include "base/log.h"
#include "base/memory.h"
#include "base/signals.h"
#include "base/terminal.h"
#include "image/image.h"
#include "output/layers.h"
#include "output/metadata.h"
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

static char *without_extension(struct arena *arena, const char *path)
{
    char *stem = arena_strdup(arena, path);
    const char *extension = path_extension(path);
    if (stem && *extension)
        stem[strlen(path) - strlen(extension) - 1] = '\0';
    return stem;
}

// Returns whether a person reads the summary, and may want to look at the image.
static bool is_watched(const struct options *options)
{
    return terminal_is(stdout) && !options->quiet && !options->json;
}

// Names the default outputs, which are in the working directory and have the scene's name: an EXR
// file and, if a person reads the summary, a PNG file.
bool render_default_outputs(struct render_run *run, struct err *err)
{
    static const char *const formats[] = {"%s.exr", "%s.png"};
    uint32_t count = is_watched(run->options) ? 2 : 1;
    char *stem = without_extension(&run->arena, path_name(run->options->arguments[0]));
    run->outputs = ARENA_NEW(&run->arena, const char *, count);
    for (uint32_t i = 0; i < count; i++) {
        const char *output = stem ? arena_printf(&run->arena, formats[i], stem) : NULL;
        if (!output || !run->outputs)
            return err_memory(err, "output names", 64);
        run->outputs[i] = output;
    }
    run->output_count = count;
    return true;
}

// Lists the lock files that the signal handler removes when it ends the program.
static bool list_locks(struct render_run *run, struct err *err)
{
    const char **paths = ARENA_NEW(&run->arena, const char *, run->lock_count);
    if (!paths)
        return err_memory(err, "names of locks", run->lock_count * sizeof *paths);
    uint32_t count = 0;
    for (uint32_t i = 0; i < run->lock_count; i++)
        if (run->locks[i].path)
            paths[count++] = run->locks[i].path;
    signals_set_leftovers(paths, count);
    return true;
}

// A run with --resume waits this long for the end of the run that it continues: ranks live for a
// moment after mpirun has ended.
#define RESUME_WAIT_SECONDS 5.0

static bool take_lock(struct render_run *run, uint32_t i, const char *output, struct err *err)
{
    const double seconds = run->options->render.resume ? RESUME_WAIT_SECONDS : 0.0;
    return file_lock_take_within(&run->locks[i], output, seconds, err);
}

bool render_check_outputs(struct render_run *run, struct err *err)
{
    run->outputs = run->options->render.outputs;
    run->output_count = run->options->render.output_count;
    bool is_shard = run->options->render.shard_text != NULL;
    if (run->output_count == 0 && !is_shard && !render_default_outputs(run, err))
        return false;
    if (!outputs_check_layers(run->outputs, run->output_count, run->options->render.aovs, err) ||
        !render_check_distinct(run, err))
        return false;
    const char *others[] = {run->options->render.checkpoint, run->options->render.trace};
    if (others[1] && !trace_check_format(others[1], err))
        return false;
    run->lock_count = run->output_count + 2;
    run->locks = ARENA_NEW(&run->arena, struct file_lock, run->lock_count);
    if (!run->locks)
        return err_memory(err, "locks", run->lock_count * sizeof *run->locks);
    for (uint32_t i = 0; i < run->output_count; i++) {
        const char *output = run->outputs[i];
        if (!outputs_check_one(output, err) || !take_lock(run, i, output, err))
            return false;
    }
    for (uint32_t i = 0; i < 2; i++)
        if (others[i] && (!file_check_writable(others[i], err) ||
                          !take_lock(run, run->output_count + i, others[i], err)))
            return false;
    return list_locks(run, err);
}

void render_release_outputs(struct render_run *run)
{
    signals_set_leftovers(NULL, 0);
    for (uint32_t i = 0; run->locks && i < run->lock_count; i++)
        file_lock_release(&run->locks[i]);
}

// Returns the uncompressed size, because compression is not predictable, and noise compresses
// little.
uint64_t render_picture_bytes(const struct render_run *run, const char *path)
{
    const struct settings *settings = &run->scene.settings;
    const bool half = run->options->render.half_float;
    const struct image_write_params params = {
        .path = path, .half_float = half, .png_bits = run->options->render.png16 ? 16 : 8};
    const struct render_window *window = &run->window;
    uint64_t pixels = window->width > 0 ? (uint64_t)window->width * window->height
                                        : (uint64_t)settings->width * settings->height;
    bool has_layers = path_has_extension(path, "exr");
    return pixels * (image_pixel_bytes(&params) +
                     (has_layers ? layers_bytes(run->options->render.aovs, half) : 0));
}

bool render_check_space(const struct render_run *run, struct err *err)
{
    const struct options *options = run->options;
    // If --time may end the run, only the last image is certain.
    bool is_certain = options->render.every && options->render.time_seconds == 0.0;
    uint64_t pictures = is_certain ? options->render.frames / options->render.every + 1u : 1u;
    for (uint32_t i = 0; i < run->output_count; i++) {
        uint64_t bytes = render_picture_bytes(run, run->outputs[i]);
        if (!file_check_space(run->outputs[i], pictures * bytes, err))
            return false;
    }
    return true;
}

// --- writing -------------------------------------------------------------------------------------

// The format in which the pixels of an image are stored.
struct storage {
    bool half_float, uncompressed;
};

static struct image_display picture_of(const struct render_run *run)
{
    const struct render_window *window = &run->window;
    const struct settings *settings = &run->scene.settings;
    if (window->width == 0)
        return (struct image_display){0};
    return (struct image_display){settings->width, settings->height, window->x, window->y};
}

static bool write_picture(const struct render_run *run, const char *path, struct storage storage,
                          const struct metadata *metadata, struct err *err)
{
    const struct image image = {run->job.film.width, run->job.film.height, run->job.film.mean};
    struct layers layers;
    layers_list(&run->job.film, run->options->render.aovs, &layers);
    struct image_write_params params = {
        .path = path,
        .image = &image,
        .layers = layers.list,
        .layer_count = layers.count,
        .attributes = metadata->list,
        .attribute_count = metadata->count,
        .display = picture_of(run),
        .half_float = storage.half_float,
        .uncompressed = storage.uncompressed,
        .png_bits = run->options->render.png16 ? 16 : 8,
        .exposure_stops = run->exposure,
        .tone = run->scene.settings.tone_curve,
    };
    return image_write(&params, err);
}

// Saves the image. It is first written without compression, because a compressor may have failed.
// If file sizes are limited, smaller formats are tried next. Reports the path and the format.
static bool save(const struct render_run *run, const char *path, uint64_t limit,
                 const struct metadata *metadata, struct err *err)
{
    const bool half = run->options->render.half_float;
    const struct storage ways[] = {{half, true}, {half, false}, {true, false}};
    bool is_limited = limit != UINT64_MAX;
    for (int i = 0; i < (is_limited ? 3 : 1); i++) {
        if (!write_picture(run, path, ways[i], metadata, err))
            continue;
        log_warn("the picture was saved as %s%s", path,
                 ways[i].half_float && !half ? ", with 16 bits a value, since a file's size is "
                                               "limited (ulimit -f)"
                                             : "");
        return true;
    }
    if (is_limited)
        log_warn("files may have at most %s here (RLIMIT_FSIZE, ulimit -f); the picture has %s "
                 "before compression",
                 memory_print(limit).text, memory_print(render_picture_bytes(run, path)).text);
    return false;
}

// Saves the image in the system's folder for temporary files, so that hours of rendering are not
// lost if a disk is full or missing, or a compressor fails.
static void save_elsewhere(const struct render_run *run, const struct metadata *metadata,
                           struct arena *arena)
{
    char *folder = folder_create_temporary();
    if (!folder)
        return;
    const char *path = arena_printf(arena, "%s/picture.exr", folder);
    struct err err = {0};
    // The limit of file sizes is raised as far as possible, because it may have caused the failure.
    const uint64_t limit = file_size_limit_raise();
    if (!path || !save(run, path, limit, metadata, &err)) {
        folder_remove(folder);
        log_warn("the picture could not be saved in %s either: %s", folder, err.msg);
    }
    free(folder);
}

// --- metadata ------------------------------------------------------------------------------------

// Makes the command that renders this image again, even if --time, --error or the number of frames
// ended the render. Requires is_repeatable().
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

// Returns whether a command can render the same image again. None can if a signal stopped the
// render, if a merge is partial, or if pixels of a rescued film have different numbers of samples.
static bool is_repeatable(const struct render_run *run)
{
    // The command of a sequence has one number of samples for all of its pictures.
    if (run->frame.number > 0 && run->job.ended_by != ENDED_BY_SAMPLES)
        return false;
    bool is_even = run->job.rescue.copied.is_even && !run->options->render.frames;
    const struct job_merged *merged = run->options->render.merged;
    return !run->job.stopped && !(merged && merged->is_partial) &&
           (!job_is_rescued(&run->job) || is_even);
}

static bool describe(const struct render_run *run, uint32_t frame, struct arena *arena,
                     struct metadata *out, struct err *err)
{
    const struct job *job = &run->job;
    const struct scene_load_params load = options_scene_params(&run->options->scene, NULL);
    const struct metadata_params params = {
        .job = job,
        .load = &load,
        .settings = &run->scene.settings,
        .film = &job->film,
        .error = &job->error,
        .seconds = &job->seconds,
        .ended_by = job_ended_by(job),
        .command = run->options->command_line,
        .repeat = is_repeatable(run) ? repeating_command(run, frame, arena) : NULL,
        .samples = job_samples(job),
        .image_hash = job->image_hash,
        .exposure = run->exposure,
        .camera = run->camera,
        .frame = run->frame.number > 0 ? run->frame.number : frame,
    };
    return metadata_make(&params, arena, out, err) &&
           (run->frame.number == 0 ||
            metadata_set(out, SEQUENCE_ATTRIBUTE, run->frame.identity, err));
}

// --- all pictures --------------------------------------------------------------------------------

static bool write_outputs(struct render_run *run, uint32_t frame, struct arena *arena,
                          struct err *err)
{
    struct metadata metadata;
    const struct image image = {run->job.film.width, run->job.film.height, run->job.film.mean};
    const struct settings *settings = &run->scene.settings;
    if (!run->exposure_is_kept)
        run->exposure =
            settings->exposure_is_auto ? image_measure_exposure(&image) : settings->exposure;
    run->is_written |= frame == 0;
    if (!describe(run, frame, arena, &metadata, err))
        return false;
    bool ok = true, has_exr = false;
    for (uint32_t i = 0; i < run->output_count; i++) {
        struct err failure = {0};
        const char *output = run->outputs[i];
        const char *path = frame > 0 ? path_numbered(arena, output, frame) : output;
        if (!path)
            return err_memory(err, "output names", run->output_count * sizeof path);
        if (write_picture(run, path, (struct storage){run->options->render.half_float, false},
                          &metadata, &failure)) {
            has_exr |= path_has_extension(path, "exr");
            continue;
        }
        if (!ok) // the caller reports the first failure
            log_message(LOG_ERROR, "%s", failure.msg);
        else if (err)
            *err = failure;
        ok = false;
    }
    if (!ok && !has_exr)
        save_elsewhere(run, &metadata, arena);
    return ok;
}

bool render_write_outputs(struct render_run *run, uint32_t frame, struct err *err)
{
    uint64_t start = clock_ns();
    struct arena arena = {0}; // for names and metadata
    bool ok = write_outputs(run, frame, &arena, err);
    arena_finish(&arena);
    job_add_time(&run->job, JOB_WRITING, start);
    return ok;
}
