// lampyris compare: computes error metrics between images and a reference.
#include "cli/commands.h"

#include "base/file.h"
#include "base/file_inputs.h"
#include "base/file_system.h"
#include "base/log.h"
#include "base/memory.h"
#include "cli/compare/compare.h"
#include "metrics/metrics.h"
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// --- reading images ------------------------------------------------------------------------------

// Splits "FILE:LAYER" into file and layer, unless a file with the complete name exists.
static bool split_layer(const struct comparison *c, const char *name, struct arena *arena,
                        struct image_read_params *out, struct err *err)
{
    const char *colon = strrchr(name, ':');
    *out = (struct image_read_params){.path = name, .progress = c->options->progress};
    if (!colon || colon == name || !colon[1] || file_exists(name))
        return true;
    char *path = arena_strdup(arena, name);
    if (!path)
        return err_memory(err, "a file name", strlen(name) + 1);
    path[colon - name] = '\0';
    if (file_exists(path)) {
        out->path = path;
        out->layer = colon + 1;
    }
    return true;
}

static bool read_picture(const struct comparison *c, const char *name, struct arena *arena,
                         struct image *out, struct err *err)
{
    struct image_read_params params;
    return split_layer(c, name, arena, &params, err) && image_read(&params, arena, out, err) &&
           (!c->reference.image.pixels || reference_check_size(&c->reference, c->reference_path,
                                                               name, out->width, out->height, err));
}

static bool is_number(const char *text, double *value)
{
    char *end;
    *value = strtod(text, &end);
    return end != text && !*end;
}

static bool read_variance(struct comparison *c, const char *name, struct err *err)
{
    struct arena arena = {0};
    struct image variance;
    bool ok = read_picture(c, name, &arena, &variance, err) &&
              reference_set_variance(&c->reference, name, (const float(*)[3])variance.pixels, err);
    arena_finish(&arena);
    return ok;
}

// Reads the reference, and estimates its noise as --reference-variance requires.
static bool read_reference(struct comparison *c, struct err *err)
{
    const char *variance = c->options->compare.reference_variance, *name = c->reference_path;
    double value;
    if (variance && strcmp(variance, "auto") == 0) {
        if (!reference_read(name, c->options->progress, &c->arena, &c->reference, err))
            return false;
        if (!c->reference.noise_known)
            return err_set(err, ERR_INPUT, "%s: --reference-variance auto: %s", name,
                           c->reference.reason);
    } else if (!read_picture(c, name, &c->arena, &c->reference.image, err) ||
               !reference_find_means(&c->reference, c->options->progress, &c->arena, err)) {
        return false;
    } else if (variance && is_number(variance, &value)) {
        if (!(value >= 0 && isfinite(value)))
            return err_set(err, ERR_USAGE,
                           "--reference-variance: %s is not a variance; expected a number >= 0",
                           variance);
        reference_set_even_variance(&c->reference, value);
    } else if (variance && !read_variance(c, variance, err)) {
        return err_prepend(err, "--reference-variance");
    }
    c->is_corrected = variance != NULL;
    return true;
}

// --- measuring -----------------------------------------------------------------------------------

static void correct(const struct comparison *c, struct compared *picture)
{
    const double noise[] = {c->reference.mse, c->reference.relmse, c->reference.local_relmse};
    struct interval *intervals[] = {&picture->error.mse, &picture->error.relmse,
                                    &picture->error.local_relmse};
    memcpy(picture->measured, picture->value, sizeof picture->measured);
    for (int k = 0; k < 3; k++) {
        intervals[k]->value -= noise[k];
        intervals[k]->low -= noise[k];
        intervals[k]->high -= noise[k];
        // An error is at least 0, except if the noise of the reference was subtracted.
        if (!c->is_corrected && intervals[k]->low < 0)
            intervals[k]->low = 0;
    }
    if (!c->is_corrected)
        return;
    double mse = picture->error.mse.value;
    picture->value[METRIC_MSE] = mse;
    picture->value[METRIC_RELMSE] = picture->error.relmse.value;
    picture->value[METRIC_LOCAL_RELMSE] = picture->error.local_relmse.value;
    picture->value[METRIC_RMSE] = copysign(sqrt(fabs(mse)), mse);
}

static bool stopped(struct err *err)
{
    return err_set(err, ERR_STOPPED, "stopped before all pictures were compared");
}

static bool measure(const struct comparison *c, const struct picture_pair *pair,
                    struct compared *picture, struct err *err)
{
    struct metrics m;
    const struct progress *progress = c->options->progress;
    uint64_t count = (uint64_t)pair->width * pair->height;
    if (!metrics_compare(pair->image, pair->reference, count, progress, &m) ||
        !metrics_intervals(pair->image, pair->reference, c->reference.means, pair->width,
                           pair->height, progress, &picture->error))
        return stopped(err);
    picture->value[METRIC_MSE] = m.mse;
    picture->value[METRIC_RMSE] = m.rmse;
    picture->value[METRIC_RELMSE] = m.relmse;
    picture->value[METRIC_LOCAL_RELMSE] = picture->error.local_relmse.value;
    picture->value[METRIC_SMAPE] = m.smape;
    picture->value[METRIC_PSNR] = metrics_psnr(
        pair->image, pair->reference, count, (double)c->options->scene.settings.exposure, progress);
    picture->value[METRIC_MAX] = m.max;
    picture->value[METRIC_NONFINITE] = (double)m.nonfinite;
    picture->value[METRIC_DIFFERING] = (double)m.differing;
    picture->max_pixel[0] = (uint32_t)(m.max_pixel % pair->width);
    picture->max_pixel[1] = (uint32_t)(m.max_pixel / pair->width);
    picture->is_equal = m.differing == 0;
    correct(c, picture);
    return !progress_should_stop(progress) || stopped(err);
}

// Multiplies the image by the exposure. The result is allocated in `arena` unless the exposure is
// 0.
static bool expose(const struct comparison *c, const float (*pixels)[3], uint64_t count,
                   struct arena *arena, const float (**out)[3], struct err *err)
{
    double factor = exp2((double)c->options->scene.settings.exposure);
    *out = pixels;
    if (factor == 1)
        return true;
    float(*exposed)[3] = arena_alloc(arena, count, sizeof *exposed);
    if (!exposed)
        return err_memory(err, "an exposed picture", count * sizeof *exposed);
    // Pixels that are not finite are omitted.
    for (uint64_t i = 0; i < count; i++)
        for (int k = 0; k < 3; k++)
            exposed[i][k] = isfinite(pixels[i][k])
                                ? (float)fmin(factor * (double)pixels[i][k], (double)FLT_MAX)
                                : pixels[i][k];
    *out = (const float(*)[3])exposed;
    return true;
}

// The range of the total progress that one image takes.
struct share {
    const struct progress *whole;
    uint32_t index, count;
};

static void report_share(void *context, const char *phase, double fraction)
{
    const struct share *share = context;
    progress_report(share->whole, phase, (share->index + fraction) / share->count);
}

static bool should_stop(void *context)
{
    const struct share *share = context;
    return progress_should_stop(share->whole);
}

// Computes the perceptual metrics of an image. `maps` has memory for the values of FLIP and
// HDR-FLIP, or is NULL.
static bool look(const struct comparison *c, uint32_t index, const struct picture_pair *pair,
                 struct arena *arena, float *const maps[2], struct compared *picture,
                 struct err *err)
{
    struct share share = {c->options->progress, index, c->count};
    const struct progress progress = {report_share, should_stop, &share};
    uint64_t count = (uint64_t)pair->width * pair->height;
    struct picture_pair shown = *pair;
    if (!expose(c, pair->image, count, arena, &shown.image, err) ||
        !expose(c, pair->reference, count, arena, &shown.reference, err))
        return false;
    report_share(&share, "Comparing", 0);
    bool ok = metrics_ssim(&shown, &progress, &picture->value[METRIC_SSIM]) &&
              metrics_flip(&shown, FLIP_PIXELS_PER_DEGREE, &progress, maps[0],
                           &picture->value[METRIC_FLIP]) &&
              metrics_flip_hdr(pair, FLIP_PIXELS_PER_DEGREE, &c->exposures, &progress, maps[1],
                               &picture->value[METRIC_HDR_FLIP]);
    if (ok)
        return true;
    return should_stop(&share) ? stopped(err)
                               : err_memory(err, "SSIM and FLIP", count * sizeof(float));
}

// Allocates memory for the maps of FLIP that are needed: one for --map, both for --report.
static bool make_room(const struct comparison *c, const struct compared *picture, uint64_t count,
                      struct arena *arena, float *maps[2], struct err *err)
{
    static const enum error_map kinds[2] = {ERROR_MAP_FLIP, ERROR_MAP_HDR_FLIP};
    for (int i = 0; i < 2; i++) {
        bool is_wanted =
            c->options->study.report || (picture->map && c->options->compare.map == kinds[i]);
        maps[i] = is_wanted ? arena_alloc(arena, count, sizeof *maps[i]) : NULL;
        if (is_wanted && !maps[i])
            return err_memory(err, "a map of errors", count * sizeof *maps[i]);
    }
    return true;
}

static bool compare_picture(struct comparison *c, uint32_t index, struct arena *arena,
                            struct err *err)
{
    struct compared *picture = &c->pictures[index];
    struct image image;
    if (!read_picture(c, picture->path, arena, &image, err))
        return false;
    const struct picture_pair pair = {
        .image = (const float(*)[3])image.pixels,
        .reference = (const float(*)[3])c->reference.image.pixels,
        .width = image.width,
        .height = image.height,
    };
    uint64_t count = (uint64_t)pair.width * pair.height;
    float *maps[2];
    if (!make_room(c, picture, count, arena, maps, err) ||
        !look(c, index, &pair, arena, maps, picture, err) || !measure(c, &pair, picture, err))
        return false;
    if (c->options->study.report && !compare_html_add(c, picture, &image, maps, err))
        return false;
    const float *flip = maps[c->options->compare.map == ERROR_MAP_HDR_FLIP];
    return !picture->map || compare_write_map(c, picture, &pair, flip, arena, err);
}

// --- limits and checks ---------------------------------------------------------------------------

static bool check_limits(const struct comparison *c, const struct compared *picture)
{
    const struct options *options = c->options;
    bool nonfinite_limited = false, passed = true;
    for (uint32_t i = 0; i < options->compare.limit_count; i++) {
        const struct compare_limit *limit = &options->compare.limits[i];
        nonfinite_limited = nonfinite_limited || limit->metric == METRIC_NONFINITE;
        if (compare_limit_holds(picture->value[limit->metric], limit))
            continue;
        passed = false;
        log_message(LOG_ERROR, "%s: %s is %.6g; expected at %s %.6g", picture->path,
                    compare_metric_names[limit->metric], picture->value[limit->metric],
                    limit->is_minimum ? "least" : "most", limit->value);
    }
    double nonfinite = picture->value[METRIC_NONFINITE];
    if (nonfinite == 0 || nonfinite_limited)
        return passed;
    // The metrics omit pixels that are not finite, so their limits do not detect such pixels. If
    // there are limits, but none on the number of these pixels, an image with such pixels fails.
    bool fails = options->compare.limit_count > 0;
    log_message(fails ? LOG_ERROR : LOG_WARN, "%s: %.0f pixels are not finite and were omitted",
                picture->path, nonfinite);
    return passed && !fails;
}

// Registers all input files at first, because the first difference image is written before the
// second image is read.
static bool name_inputs(const struct comparison *c, struct err *err)
{
    const char *variance = c->options->compare.reference_variance;
    struct arena arena = {0};
    bool ok = true;
    for (uint32_t i = 0; ok && i <= c->count + (variance != NULL); i++) {
        struct image_read_params params;
        const char *name = i <= c->count ? c->options->arguments[i] : variance;
        ok = split_layer(c, name, &arena, &params, err) && file_inputs_add(params.path, err);
    }
    arena_finish(&arena);
    return ok;
}

// Chooses the names of the difference images, and checks beforehand that they can be written.
static bool prepare_maps(struct comparison *c, struct err *err)
{
    const char *path = c->options->compare.difference;
    if (!path)
        return true;
    if (!path_has_extension(path, "png") && !path_has_extension(path, "exr"))
        return err_set(err, ERR_USAGE, "--difference %s: expected a name that ends in .png or .exr",
                       path);
    for (uint32_t i = 0; i < c->count; i++) {
        c->pictures[i].map = c->count > 1 ? path_numbered(&c->arena, path, i + 1) : path;
        if (!c->pictures[i].map)
            return err_memory(err, "file names", strlen(path));
        if (!file_check_writable(c->pictures[i].map, err))
            return false;
    }
    return true;
}

// Takes the exposures from "START,STOP", or computes them from the reference.
static bool choose_exposures(struct comparison *c, struct err *err)
{
    const double most = 128; // the range of floats, in stops in either direction
    const char *text = c->options->compare.exposures;
    const struct image *reference = &c->reference.image;
    const float(*pixels)[3] = (const float(*)[3])reference->pixels;
    const struct picture_pair alone = {pixels, pixels, reference->width, reference->height};
    if (!text)
        return metrics_flip_exposures(&alone, c->options->progress, &c->exposures) || stopped(err);
    char *rest;
    double start = strtod(text, &rest), stop = NAN;
    if (rest != text && *rest == ',' && rest[1])
        stop = strtod(rest + 1, &rest);
    if (!(start >= -most && start <= stop && stop <= most) || *rest)
        return err_set(err, ERR_USAGE,
                       "--exposures: \"%s\" is not of the form START,STOP with %g <= START <= STOP "
                       "<= %g stops",
                       text, -most, most);
    c->exposures = metrics_flip_exposures_between(start, stop);
    return true;
}

// Checks the memory budget once the size of the reference is known. Comparing an image takes at
// most the image itself, its exposed copies, the error map, and the memory of one metric at a time.
static bool check_memory(const struct comparison *c, struct err *err)
{
    uint32_t width = c->reference.image.width, height = c->reference.image.height;
    uint64_t count = (uint64_t)width * height, most = metrics_ssim_bytes(width, height);
    const uint64_t others[] = {metrics_flip_bytes(width, height),
                               metrics_flip_hdr_bytes(width, height)};
    for (int i = 0; i < 2; i++)
        most = others[i] > most ? others[i] : most;
    most += count * sizeof(float[3]);
    if (c->options->scene.settings.exposure != 0)
        most += 2 * count * sizeof(float[3]);
    if (c->options->compare.difference)
        most += count * sizeof(float);
    if (c->options->study.report) {
        const struct html_viewer_params params = {width, height, c->count + 1, 0, TONE_NONE};
        most += 2 * count * sizeof(float) + html_viewer_bytes(&params);
    }
    char what[64];
    snprintf(what, sizeof what, "comparing pictures of %u x %u", width, height);
    return memory_check(most, what, err);
}

// Checks beforehand that the report can be written and is not the file of a difference image.
static bool check_report(const struct comparison *c, struct err *err)
{
    const char *report = c->options->study.report;
    if (!html_check_file(report, err))
        return false;
    for (uint32_t i = 0; i < c->count; i++)
        if (!file_check_distinct(report, c->pictures[i].map, err))
            return false;
    return true;
}

static bool compare_pictures(struct comparison *c, struct err *err)
{
    for (uint32_t i = 0; i < c->count; i++) {
        struct arena arena = {0};
        bool ok = compare_picture(c, i, &arena, err);
        arena_finish(&arena);
        if (!ok)
            return false;
    }
    return true;
}

static bool compare_all(struct comparison *c, struct err *err)
{
    if (!name_inputs(c, err) || !prepare_maps(c, err) || !check_report(c, err) ||
        !read_reference(c, err) || !check_memory(c, err) || !choose_exposures(c, err))
        return false;
    if (c->options->study.report) {
        bool ok = compare_html_begin(c, err) && compare_pictures(c, err);
        if (!compare_html_end(c, ok, err))
            return false;
    } else if (!compare_pictures(c, err)) {
        return false;
    }
    c->passed = true;
    for (uint32_t i = 0; i < c->count; i++) {
        c->pictures[i].passed = check_limits(c, &c->pictures[i]);
        c->passed = c->passed && c->pictures[i].passed;
    }
    return true;
}

int cmd_compare(const struct options *options)
{
    struct err err = {0};
    struct comparison c = {.options = options, .count = options->argument_count - 1};
    c.reference_path = options->arguments[c.count];
    for (uint32_t i = 0; i < c.count; i++)
        c.pictures[i].path = options->arguments[i];
    int code = EXIT_CODE_OK;
    bool ok = compare_all(&c, &err);
    progress_end(options->progress);
    if (!ok)
        code = command_fail(&err);
    else if (options->json)
        code = compare_print_json(&c);
    else if (!options->quiet)
        compare_print_text(&c);
    bool failed = code == EXIT_CODE_OK && !c.passed;
    arena_finish(&c.arena);
    return failed ? EXIT_CODE_CHECK_FAILED : code;
}
