#include "cli/render/render_job.h"

#include "base/clock.h"
#include "base/file.h"
#include "base/log.h"
#include "cli/signals.h"
#include "image/image.h"
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/resource.h>
#include <unistd.h>

static char *without_extension(struct arena *arena, const char *path)
{
    char *stem = arena_strdup(arena, path);
    const char *extension = path_extension(path);
    if (stem && *extension)
        stem[strlen(path) - strlen(extension) - 1] = '\0';
    return stem;
}

// Whether somebody reads the summary, and may want to look at the picture.
static bool is_watched(const struct options *options)
{
    return isatty(STDOUT_FILENO) && !options->quiet && !options->json;
}

// The scene's name with .exr, in the working directory; for people a picture to look at besides.
static bool default_outputs(struct render_job *job, struct err *err)
{
    static const char *const formats[] = {"%s.exr", "%s.png"};
    uint32_t count = is_watched(job->options) ? 2 : 1;
    char *stem = without_extension(&job->arena, path_name(job->options->arguments[0]));
    job->outputs = ARENA_NEW(&job->arena, const char *, count);
    for (uint32_t i = 0; i < count; i++) {
        const char *output = stem ? arena_printf(&job->arena, formats[i], stem) : NULL;
        if (!output || !job->outputs)
            return err_memory(err, "output names", 64);
        job->outputs[i] = output;
    }
    job->output_count = count;
    return true;
}

// What a signal's handler is to remove when it ends the program.
static bool list_locks(struct render_job *job, struct err *err)
{
    const char **paths = ARENA_NEW(&job->arena, const char *, job->lock_count);
    if (!paths)
        return err_memory(err, "names of locks", job->lock_count * sizeof *paths);
    uint32_t count = 0;
    for (uint32_t i = 0; i < job->lock_count; i++)
        if (job->locks[i].path)
            paths[count++] = job->locks[i].path;
    signals_set_leftovers(paths, count);
    return true;
}

// Other formats have no layers.
static bool check_layers(const struct render_job *job, struct err *err)
{
    bool has_exr = false;
    for (uint32_t i = 0; i < job->output_count; i++)
        has_exr |= strcasecmp(path_extension(job->outputs[i]), "exr") == 0;
    return has_exr || job->options->aovs == 0 ||
           err_set(err, ERR_USAGE, "--aov: layers go into EXR files; expected -o NAME.exr");
}

bool job_check_outputs(struct render_job *job, struct err *err)
{
    job->outputs = job->options->outputs;
    job->output_count = job->options->output_count;
    if (job->output_count == 0 && !default_outputs(job, err))
        return false;
    if (!check_layers(job, err) || !job_check_distinct(job, err))
        return false;
    const char *others[] = {job->options->checkpoint, job->options->trace};
    if (others[1] && !trace_check_format(others[1], err))
        return false;
    job->lock_count = job->output_count + 2;
    job->locks = ARENA_NEW(&job->arena, struct file_lock, job->lock_count);
    if (!job->locks)
        return err_memory(err, "locks", job->lock_count * sizeof *job->locks);
    for (uint32_t i = 0; i < job->output_count; i++) {
        const char *output = job->outputs[i];
        if (!image_check_format(output, err) || !file_check_writable(output, err) ||
            !file_lock_take(&job->locks[i], output, err))
            return false;
    }
    for (uint32_t i = 0; i < 2; i++)
        if (others[i] && (!file_check_writable(others[i], err) ||
                          !file_lock_take(&job->locks[job->output_count + i], others[i], err)))
            return false;
    return list_locks(job, err);
}

void job_release_outputs(struct render_job *job)
{
    signals_set_leftovers(NULL, 0);
    for (uint32_t i = 0; job->locks && i < job->lock_count; i++)
        file_lock_release(&job->locks[i]);
}

// Uncompressed: what compression saves is not known before, and noise leaves it little.
static uint64_t picture_bytes(const struct render_job *job, bool is_png)
{
    const struct settings *settings = &job->scene.settings;
    uint64_t pixels = (uint64_t)settings->width * settings->height;
    uint64_t values = is_png ? 1 : job->options->half_float ? 2 : 4;
    return pixels * (3 * values + (is_png ? 0 : job_layer_bytes(job)));
}

bool job_check_space(const struct render_job *job, struct err *err)
{
    const struct options *options = job->options;
    // Of a run that a clock may end, only the last picture is certain.
    bool is_certain = options->every && options->time_seconds == 0.0;
    uint64_t pictures = is_certain ? options->frames / options->every + 1u : 1u;
    for (uint32_t i = 0; i < job->output_count; i++) {
        bool is_png = strcasecmp(path_extension(job->outputs[i]), "png") == 0;
        uint64_t bytes = picture_bytes(job, is_png);
        if (!file_check_space(job->outputs[i], pictures * bytes, err))
            return false;
    }
    return true;
}

// --- writing
// --------------------------------------------------------------------------------------

enum image_tone job_image_tone(enum tone_curve curve)
{
    static const enum image_tone tones[] = {
        [TONE_NONE] = IMAGE_TONE_NONE,
        [TONE_REINHARD] = IMAGE_TONE_REINHARD,
        [TONE_ACES] = IMAGE_TONE_ACES,
        [TONE_AGX] = IMAGE_TONE_AGX,
    };
    return tones[curve];
}

// How a picture is stored.
struct storage {
    bool half_float, uncompressed;
};

static bool write_picture(const struct render_job *job, const char *path, struct storage storage,
                          const struct job_attributes *attributes, struct err *err)
{
    const struct image image = {job->film.width, job->film.height, job->film.mean};
    struct job_layers layers;
    job_list_layers(job, &layers);
    struct image_write_params params = {
        .path = path,
        .image = &image,
        .layers = layers.list,
        .layer_count = layers.count,
        .attributes = attributes->list,
        .attribute_count = attributes->count,
        .half_float = storage.half_float,
        .uncompressed = storage.uncompressed,
        .exposure_stops = job->exposure,
        .tone = job_image_tone(job->scene.settings.tone_curve),
    };
    return image_write(&params, err);
}

// To what the system allows, as the limit may be what kept the picture from its place. Returns it.
static rlim_t raise_file_size_limit(void)
{
    struct rlimit size;
    if (getrlimit(RLIMIT_FSIZE, &size) != 0)
        return RLIM_INFINITY;
    size.rlim_cur = size.rlim_max;
    setrlimit(RLIMIT_FSIZE, &size);
    return size.rlim_max;
}

// First in the simplest way, as a compressor may have failed; where the size of files is limited,
// in smaller ones then. Says how.
static bool save(const struct render_job *job, const char *path, rlim_t limit,
                 const struct job_attributes *attributes, struct err *err)
{
    const bool half = job->options->half_float;
    const struct storage ways[] = {{half, true}, {half, false}, {true, false}};
    bool is_limited = limit != RLIM_INFINITY;
    for (int i = 0; i < (is_limited ? 3 : 1); i++) {
        if (!write_picture(job, path, ways[i], attributes, err))
            continue;
        log_warn("the picture was saved as %s%s", path,
                 ways[i].half_float && !half ? ", with 16 bits a value, since a file's size is "
                                               "limited (ulimit -f)"
                                             : "");
        return true;
    }
    if (is_limited)
        log_warn("files may have at most %llu bytes here (RLIMIT_FSIZE, ulimit -f); the picture "
                 "has %llu before compression",
                 (unsigned long long)limit, (unsigned long long)picture_bytes(job, false));
    return false;
}

// Hours of rendering shall not be lost because a disk is full or gone, or a compressor fails.
static void save_elsewhere(struct render_job *job, const struct job_attributes *attributes)
{
    const char *parent = getenv("TMPDIR");
    char *folder = arena_printf(&job->film_arena, "%s/lampyris-XXXXXX", parent ? parent : "/tmp");
    if (!folder || !mkdtemp(folder))
        return;
    const char *path = arena_printf(&job->film_arena, "%s/picture.exr", folder);
    struct err err = {0};
    rlim_t limit = raise_file_size_limit();
    if (path && save(job, path, limit, attributes, &err))
        return;
    rmdir(folder);
    log_warn("the picture could not be saved in %s either: %s", folder, err.msg);
}

bool job_write_outputs(struct render_job *job, uint32_t frame, struct err *err)
{
    uint64_t start = clock_ns();
    struct job_attributes attributes;
    const struct image image = {job->film.width, job->film.height, job->film.mean};
    const struct settings *settings = &job->scene.settings;
    job->exposure =
        settings->exposure_is_auto ? image_measure_exposure(&image) : settings->exposure;
    job->is_written |= frame == 0;
    if (!job_describe(job, frame, &job->film_arena, &attributes, err))
        return false;
    bool ok = true, has_exr = false;
    for (uint32_t i = 0; i < job->output_count; i++) {
        struct err failure = {0};
        const char *output = job->outputs[i];
        const char *path = frame > 0 ? path_numbered(&job->film_arena, output, frame) : output;
        if (!path)
            return err_memory(err, "output names", job->output_count * sizeof path);
        if (write_picture(job, path, (struct storage){job->options->half_float, false}, &attributes,
                          &failure)) {
            has_exr |= strcasecmp(path_extension(path), "exr") == 0;
            continue;
        }
        if (!ok) // it is the caller's to report the first
            log_message(LOG_ERROR, "%s", failure.msg);
        else if (err)
            *err = failure;
        ok = false;
    }
    if (!ok && !has_exr)
        save_elsewhere(job, &attributes);
    job->seconds.write += clock_seconds_since(start);
    return ok;
}
