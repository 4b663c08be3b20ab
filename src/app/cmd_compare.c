// lampyris compare: error metrics between a picture and a reference.
#include "commands.h"

#include "file.h"
#include "image.h"
#include "json_out.h"
#include "log.h"
#include "metrics.h"
#include "perceptual.h"
#include <stdio.h>

struct comparison {
    const struct options *options;
    struct arena arena;
    struct image image, reference;
    struct metrics metrics;
    double ssim, flip, hdr_flip;
    struct flip_exposures exposures;
    bool passed;
};

static double metric_value(const struct comparison *c, enum compare_metric metric)
{
    const struct metrics *metrics = &c->metrics;
    switch (metric) {
    case METRIC_MSE:
        return metrics->mse;
    case METRIC_RMSE:
        return metrics->rmse;
    case METRIC_RELMSE:
        return metrics->relmse;
    case METRIC_SMAPE:
        return metrics->smape;
    case METRIC_PSNR:
        return metrics->psnr;
    case METRIC_SSIM:
        return c->ssim;
    case METRIC_FLIP:
        return c->flip;
    case METRIC_HDR_FLIP:
        return c->hdr_flip;
    case METRIC_MAX:
        return metrics->max;
    case METRIC_NONFINITE:
        return (double)metrics->nonfinite;
    case METRIC_DIFFERING:
    case METRIC_TOTAL:
        break;
    }
    return (double)metrics->differing;
}

// Written so that a metric that is no number fails.
static bool limit_holds(const struct comparison *c, const struct compare_limit *limit)
{
    double value = metric_value(c, limit->metric);
    return limit->is_minimum ? value >= limit->value : value <= limit->value;
}

static bool read_pictures(struct comparison *c, struct err *err)
{
    const char *const *paths = c->options->arguments;
    struct image_read_params first = {.path = paths[0]}, second = {.path = paths[1]};
    if (!image_read(&first, &c->arena, &c->image, err) ||
        !image_read(&second, &c->arena, &c->reference, err))
        return false;
    if (c->image.width == c->reference.width && c->image.height == c->reference.height)
        return true;
    return err_set(err, ERR_INPUT, "%s is %u x %u pixels, but %s is %u x %u", paths[0],
                   c->image.width, c->image.height, paths[1], c->reference.width,
                   c->reference.height);
}

static uint64_t pixel_count(const struct image *image)
{
    return (uint64_t)image->width * image->height;
}

// The false colours are meant for the display, pictures hold linear light.
static bool write_difference(struct comparison *c, struct err *err)
{
    struct image picture = {.width = c->image.width, .height = c->image.height};
    uint64_t count = pixel_count(&picture);
    picture.pixels = arena_alloc(&c->arena, count, sizeof *picture.pixels);
    if (!picture.pixels)
        return err_memory(err, "the difference picture", count * sizeof *picture.pixels);
    metrics_difference_picture((const float(*)[3])c->image.pixels,
                               (const float(*)[3])c->reference.pixels, count, picture.pixels);
    for (uint64_t i = 0; i < count; i++)
        for (int k = 0; k < 3; k++)
            picture.pixels[i][k] = image_srgb_to_linear(picture.pixels[i][k]);
    struct image_write_params params = {.path = c->options->difference, .image = &picture};
    return image_write(&params, err);
}

static void check_limits(struct comparison *c)
{
    const struct options *options = c->options;
    bool nonfinite_limited = false;
    c->passed = true;
    for (uint32_t i = 0; i < options->limit_count; i++) {
        const struct compare_limit *limit = &options->limits[i];
        nonfinite_limited = nonfinite_limited || limit->metric == METRIC_NONFINITE;
        if (limit_holds(c, limit))
            continue;
        c->passed = false;
        log_message(LOG_ERROR, "%s is %.6g; expected at %s %.6g",
                    compare_metric_names[limit->metric], metric_value(c, limit->metric),
                    limit->is_minimum ? "least" : "most", limit->value);
    }
    if (c->metrics.nonfinite == 0 || nonfinite_limited)
        return;
    // They are left out of the metrics: a picture full of NaN must not pass for that.
    bool fails = options->limit_count > 0;
    c->passed = c->passed && !fails;
    log_message(fails ? LOG_ERROR : LOG_WARN, "%llu pixels are not finite and were left out",
                (unsigned long long)c->metrics.nonfinite);
}

static void print_text(const struct comparison *c)
{
    const struct metrics *m = &c->metrics;
    uint32_t width = c->image.width;
    printf("%s against %s, %u x %u pixels\n", c->options->arguments[0], c->options->arguments[1],
           width, c->image.height);
    printf("  mse     %.6g\n  rmse    %.6g\n  relmse  %.6g\n  smape   %.6g\n  psnr    %.6g dB\n",
           m->mse, m->rmse, m->relmse, m->smape, m->psnr);
    printf("  ssim    %.6g\n  flip    %.6g\n  hdr-flip %.6g, %u exposures of %.2f to %.2f stops\n",
           c->ssim, c->flip, c->hdr_flip, c->exposures.count, c->exposures.start,
           c->exposures.stop);
    printf("  max     %.6g at pixel %llu,%llu\n", m->max,
           (unsigned long long)(m->max_pixel % width), (unsigned long long)(m->max_pixel / width));
    printf("  differing pixels   %llu\n  non-finite pixels  %llu\n",
           (unsigned long long)m->differing, (unsigned long long)m->nonfinite);
}

static json_t *checks_json(const struct comparison *c)
{
    json_t *checks = json_array();
    for (uint32_t i = 0; i < c->options->limit_count; i++) {
        const struct compare_limit *limit = &c->options->limits[i];
        json_array_append_new(
            checks, json_pack("{s:s, s:o, s:b}", "metric", compare_metric_names[limit->metric],
                              limit->is_minimum ? "min" : "max", json_number(limit->value),
                              "passed", limit_holds(c, limit)));
    }
    return checks;
}

static int print_json(const struct comparison *c)
{
    const struct metrics *m = &c->metrics;
    uint32_t width = c->image.width;
    return json_print(json_pack(
        "{s:o, s:o, s:i, s:i, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:[f, f, i], s:o, s:[I, I], "
        "s:I, s:I, s:o, s:b}",
        "image", json_words(c->options->arguments[0]), "reference",
        json_words(c->options->arguments[1]), "width", (int)width, "height", (int)c->image.height,
        "mse", json_number(m->mse), "rmse", json_number(m->rmse), "relmse", json_number(m->relmse),
        "smape", json_number(m->smape), "psnr", json_number(m->psnr), "ssim", json_number(c->ssim),
        "flip", json_number(c->flip), "hdr_flip", json_number(c->hdr_flip), "hdr_flip_exposures",
        c->exposures.start, c->exposures.stop, (int)c->exposures.count, "max", json_number(m->max),
        "max_pixel", (json_int_t)(m->max_pixel % width), (json_int_t)(m->max_pixel / width),
        "nonfinite", (json_int_t)m->nonfinite, "differing", (json_int_t)m->differing, "checks",
        checks_json(c), "passed", c->passed));
}

static bool look(struct comparison *c, struct err *err)
{
    const struct picture_pair pair = {
        .image = (const float(*)[3])c->image.pixels,
        .reference = (const float(*)[3])c->reference.pixels,
        .width = c->image.width,
        .height = c->image.height,
    };
    return (metrics_ssim(&pair, &c->ssim) && metrics_flip_exposures(&pair, &c->exposures) &&
            metrics_flip(&pair, FLIP_PIXELS_PER_DEGREE, NULL, &c->flip) &&
            metrics_flip_hdr(&pair, FLIP_PIXELS_PER_DEGREE, &c->exposures, NULL, NULL,
                             &c->hdr_flip)) ||
           err_memory(err, "SSIM and FLIP", pixel_count(&c->image) * sizeof(float));
}

static int compare(struct comparison *c)
{
    struct err err = {0};
    const char *difference = c->options->difference;
    if (difference &&
        !(image_check_format(difference, &err) && file_check_writable(difference, &err)))
        return command_fail(&err);
    if (!read_pictures(c, &err))
        return command_fail(&err);
    metrics_compare((const float(*)[3])c->image.pixels, (const float(*)[3])c->reference.pixels,
                    pixel_count(&c->image), &c->metrics);
    if (!look(c, &err))
        return command_fail(&err);
    if (difference && !write_difference(c, &err))
        return command_fail(&err);
    check_limits(c);
    int code = EXIT_CODE_OK;
    if (c->options->json)
        code = print_json(c);
    else if (!c->options->quiet)
        print_text(c);
    return code == EXIT_CODE_OK && !c->passed ? EXIT_CODE_CHECK_FAILED : code;
}

int cmd_compare(const struct options *options)
{
    struct comparison c = {.options = options};
    int code = compare(&c);
    arena_finish(&c.arena);
    return code;
}
