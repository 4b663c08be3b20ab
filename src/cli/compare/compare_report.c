// Prints the results of `lampyris compare`.
#include "cli/compare/compare.h"

#include "cli/exit_code.h"
#include "metrics/metrics.h"
#include "report/json_out.h"
#include "report/text_out.h"
#include <math.h>
#include <string.h>

static bool is_correctable(enum compare_metric metric)
{
    return metric == METRIC_MSE || metric == METRIC_RMSE || metric == METRIC_RELMSE ||
           metric == METRIC_LOCAL_RELMSE;
}

// --- text ----------------------------------------------------------------------------------------

static void print_correction(const struct comparison *c, const struct compared *p,
                             enum compare_metric metric)
{
    if (!c->is_corrected || !is_correctable(metric))
        return;
    printf("  of %.6g measured", p->measured[metric]);
    if (p->value[metric] < 0)
        printf(": below the reference's noise");
}

const struct interval *compare_interval(const struct compared *p, enum compare_metric metric)
{
    return metric == METRIC_MSE            ? &p->error.mse
           : metric == METRIC_RELMSE       ? &p->error.relmse
           : metric == METRIC_LOCAL_RELMSE ? &p->error.local_relmse
                                           : NULL;
}

static void print_details(const struct comparison *c, const struct compared *p,
                          enum compare_metric metric)
{
    const struct interval *interval = compare_interval(p, metric);
    if (interval && isfinite(interval->low))
        printf("  [%.4g, %.4g]", interval->low, interval->high);
    print_correction(c, p, metric);
    if (metric == METRIC_PSNR)
        printf(" dB");
    if (metric == METRIC_HDR_FLIP)
        printf("  %u exposures of %.2f to %.2f stops", c->exposures.count, c->exposures.start,
               c->exposures.stop);
    if (metric == METRIC_MAX)
        printf("  at pixel %u,%u", p->max_pixel[0], p->max_pixel[1]);
    if (metric == METRIC_NONFINITE || metric == METRIC_DIFFERING)
        printf(" pixels");
}

static void print_one(const struct comparison *c)
{
    const struct compared *p = &c->pictures[0];
    print_words(p->path);
    printf(" against ");
    print_words(c->reference_path);
    printf(", %u x %u pixels\n", c->reference.image.width, c->reference.image.height);
    for (int metric = 0; metric < METRIC_TOTAL; metric++) {
        printf("  %-12s  %.6g", compare_metric_names[metric], p->value[metric]);
        print_details(c, p, (enum compare_metric)metric);
        putchar('\n');
    }
}

// Returns whether an image may be the best. Pixels that are not finite are omitted from some
// metrics and count as black in both images in others, so an image with such pixels could seem
// best.
static bool may_be_best(const struct compared *p)
{
    return p->value[METRIC_NONFINITE] == 0;
}

// Returns the best value of a metric; NAN if no image has the metric.
static double best_value(const struct comparison *c, enum compare_metric metric)
{
    double best = NAN;
    for (uint32_t i = 0; i < c->count; i++) {
        double value = may_be_best(&c->pictures[i]) ? c->pictures[i].value[metric] : NAN;
        best = compare_greater_is_better(metric) ? fmax(best, value) : fmin(best, value);
    }
    return best;
}

bool compare_is_best(const struct comparison *c, uint32_t picture, enum compare_metric metric)
{
    return c->count > 1 && may_be_best(&c->pictures[picture]) &&
           c->pictures[picture].value[metric] == best_value(c, metric);
}

struct cell {
    char text[32];
};

static struct cell cell_of(const struct comparison *c, uint32_t picture, enum compare_metric metric)
{
    struct cell cell;
    double value = c->pictures[picture].value[metric];
    bool is_best = compare_is_best(c, picture, metric);
    bool is_count = metric == METRIC_NONFINITE || metric == METRIC_DIFFERING;
    snprintf(cell.text, sizeof cell.text, is_count ? "%.0f%s" : "%.4g%s", value,
             is_best ? "*" : " ");
    return cell;
}

static int column_width(const struct comparison *c, enum compare_metric metric)
{
    size_t width = strlen(compare_metric_names[metric]) + 1;
    for (uint32_t i = 0; i < c->count; i++) {
        struct cell cell = cell_of(c, i, metric);
        width = strlen(cell.text) > width ? strlen(cell.text) : width;
    }
    return (int)width + 1;
}

static int name_width(const struct comparison *c)
{
    size_t width = 0;
    for (uint32_t i = 0; i < c->count; i++) {
        size_t length = strlen(c->pictures[i].path);
        width = length > width ? length : width;
    }
    return (int)width;
}

static void print_many(const struct comparison *c)
{
    printf("Against ");
    print_words(c->reference_path);
    printf(", %u x %u pixels; the best of each column has a *\n", c->reference.image.width,
           c->reference.image.height);
    int names = name_width(c), widths[METRIC_TOTAL];
    printf("%*s", names, "");
    for (int metric = 0; metric < METRIC_TOTAL; metric++) {
        widths[metric] = column_width(c, (enum compare_metric)metric);
        printf("%*s ", widths[metric] - 1, compare_metric_names[metric]);
    }
    putchar('\n');
    for (uint32_t i = 0; i < c->count; i++) {
        print_words(c->pictures[i].path);
        printf("%*s", names - (int)strlen(c->pictures[i].path), "");
        for (int metric = 0; metric < METRIC_TOTAL; metric++)
            printf("%*s", widths[metric], cell_of(c, i, (enum compare_metric)metric).text);
        putchar('\n');
    }
    printf("hdr-flip: %u exposures of %.2f to %.2f stops\n", c->exposures.count, c->exposures.start,
           c->exposures.stop);
}

static void print_remark(const char *name, const char *words)
{
    print_words(name);
    print_line("", words);
}

static void print_remarks(const struct comparison *c)
{
    const struct reference *r = &c->reference;
    if (c->options->scene.settings.exposure != 0)
        printf("psnr, ssim and flip: exposed by %g stops\n",
               (double)c->options->scene.settings.exposure);
    if (c->is_corrected)
        printf("The reference's own noise is subtracted: %.6g of mse, %.6g of relmse, %.6g of "
               "local-relmse.\n",
               r->mse, r->relmse, r->local_relmse);
    for (uint32_t i = 0; i < c->count; i++) {
        const struct compared *p = &c->pictures[i];
        if (p->is_equal)
            print_remark(p->path, " is equal to the reference, bit for bit.");
        if (c->count > 1 && (p->value[METRIC_MSE] < 0 || p->value[METRIC_RELMSE] < 0))
            print_remark(p->path, " is below the reference's noise.");
        if (!p->map)
            continue;
        print_words(p->map);
        print_line(": ", compare_map_words(c->options->compare.map));
    }
}

void compare_print_text(const struct comparison *c)
{
    if (c->count == 1)
        print_one(c);
    else
        print_many(c);
    print_remarks(c);
    if (c->options->study.report)
        print_line("wrote   ", c->options->study.report);
}

// --- JSON ----------------------------------------------------------------------------------------

static json_t *checks_json(const struct comparison *c, const struct compared *p)
{
    json_t *checks = json_array();
    for (uint32_t i = 0; i < c->options->compare.limit_count; i++) {
        const struct compare_limit *limit = &c->options->compare.limits[i];
        json_array_append_new(
            checks, json_pack("{s:s, s:o, s:b}", "metric", compare_metric_names[limit->metric],
                              limit->is_minimum ? "min" : "max", json_number(limit->value),
                              "passed", compare_limit_holds(p->value[limit->metric], limit)));
    }
    return checks;
}

// Sets a member for a metric. The name "hdr-flip" of the command line becomes "hdr_flip" in JSON.
static void set_metric(json_t *object, enum compare_metric metric, double value)
{
    char key[32];
    snprintf(key, sizeof key, "%s", compare_metric_names[metric]);
    for (char *letter = key; *letter; letter++)
        *letter = *letter == '-' ? '_' : *letter;
    bool is_count = metric == METRIC_NONFINITE || metric == METRIC_DIFFERING;
    json_object_set_new(object, key,
                        is_count ? json_integer((json_int_t)value) : json_number(value));
}

static json_t *interval_json(const struct interval *interval)
{
    if (!isfinite(interval->low))
        return json_null();
    return json_pack("[f, f]", interval->low, interval->high);
}

static json_t *picture_json(const struct comparison *c, const struct compared *p)
{
    json_t *object = json_pack("{s:o, s:[i, i], s:o, s:o, s:o, s:b, s:o, s:b, s:o}", "image",
                               json_words(p->path), "max_pixel", (int)p->max_pixel[0],
                               (int)p->max_pixel[1], "mse_interval", interval_json(&p->error.mse),
                               "relmse_interval", interval_json(&p->error.relmse),
                               "local_relmse_interval", interval_json(&p->error.local_relmse),
                               "equal", p->is_equal, "checks", checks_json(c, p), "passed",
                               p->passed, "difference", p->map ? json_words(p->map) : json_null());
    json_t *measured = c->is_corrected ? json_object() : json_null();
    for (int metric = 0; metric < METRIC_TOTAL; metric++) {
        set_metric(object, (enum compare_metric)metric, p->value[metric]);
        if (c->is_corrected && is_correctable((enum compare_metric)metric))
            set_metric(measured, (enum compare_metric)metric, p->measured[metric]);
    }
    json_object_set_new(object, "measured", measured);
    return object;
}

static json_t *noise_json(const struct comparison *c)
{
    if (!c->is_corrected)
        return json_null();
    return json_pack("{s:o, s:o, s:o}", "mse", json_number(c->reference.mse), "relmse",
                     json_number(c->reference.relmse), "local_relmse",
                     json_number(c->reference.local_relmse));
}

int compare_print_json(const struct comparison *c)
{
    json_t *images = json_array();
    for (uint32_t i = 0; i < c->count; i++)
        json_array_append_new(images, picture_json(c, &c->pictures[i]));
    json_t *object = json_pack(
        "{s:o, s:i, s:i, s:f, s:f, s:f, s:f, s:[f, f, i], s:o, s:o, s:b}", "reference",
        json_words(c->reference_path), "width", (int)c->reference.image.width, "height",
        (int)c->reference.image.height, "exposure", (double)c->options->scene.settings.exposure,
        "pixels_per_degree", FLIP_PIXELS_PER_DEGREE, "relmse_epsilon", METRICS_RELMSE_EPSILON,
        "smape_epsilon", METRICS_SMAPE_EPSILON, "hdr_flip_exposures", c->exposures.start,
        c->exposures.stop, (int)c->exposures.count, "reference_noise", noise_json(c), "images",
        images, "passed", c->passed);
    const char *report = c->options->study.report;
    json_object_set_new(object, "report", report ? json_words(report) : json_null());
    // The results of a single image are also members of the top-level object.
    if (object && c->count == 1)
        json_object_update_missing(object, json_array_get(images, 0));
    return command_print(object);
}
