#include "job/error_sources.h"

#include "shared/aov.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

const char *const error_kind_names[ERROR_KIND_COUNT] = {"part", "bounce", "emitter"};

_Static_assert(BY_BOUNCE_COUNT <= ERROR_BY_CLASSES_MAX && BY_EMITTER_COUNT <= ERROR_BY_CLASSES_MAX,
               "each kind's classes have room");

const char *error_class_name(enum error_kind kind, uint32_t class)
{
    static const char *const names[ERROR_KIND_COUNT][ERROR_BY_CLASSES_MAX] = {
        [ERROR_BY_PART] = {"emission", "direct", "indirect"},
        [ERROR_BY_BOUNCE] = {"0", "1", "2", "3", "4", "5", "6", "7 and more"},
        [ERROR_BY_EMITTER] =
            {
                [BY_EMITTER_TRIANGLES] = "triangles",
                [BY_EMITTER_SHAPES] = "shapes",
                [BY_EMITTER_LIGHTS] = "delta lights",
                [BY_EMITTER_SUNS] = "suns",
                [BY_EMITTER_ENVIRONMENT] = "environment",
            },
    };
    return names[kind][class];
}

uint32_t error_kind_aov(enum error_kind kind)
{
    return (uint32_t)AOV_BY_PART << kind;
}

// --- shares --------------------------------------------------------------------------------------

static const char *why_unknown(const struct film_image *film,
                               const struct film_error_params *params)
{
    if (params->lacks_light)
        return "light paths of the other parts bring light to these rows, too";
    if (film->least_samples < 2)
        return "fewer than two samples per pixel";
    if (params->is_contiguous && film->least_samples != params->planned)
        return "with contiguous halves the error is only known after all planned samples";
    return NULL;
}

static struct error_by_params params_of(const struct film_image *film, uint32_t rendered,
                                        enum error_kind kind,
                                        const struct half_error_params *halves,
                                        const double (*weights)[3])
{
    static const uint32_t counts[ERROR_KIND_COUNT] = {BY_PART_COUNT, BY_BOUNCE_COUNT,
                                                      BY_EMITTER_COUNT};
    const uint32_t first[ERROR_KIND_COUNT] = {0, AOV_BOUNCES_AT(rendered),
                                              AOV_EMITTERS_AT(rendered)};
    const struct film_aovs *aovs = &film->aovs;
    return (struct error_by_params){
        .halves = halves,
        .weights = weights,
        .class_a = (const float(*)[3])aovs->class_a + first[kind],
        .class_b = (const float(*)[3])aovs->class_b + first[kind],
        .count = counts[kind],
        .stride = aovs->class_count,
    };
}

// --- the brightest contributions -----------------------------------------------------------------

static double find_excess(const float radiance[3], const float mean[3], const double weights[3])
{
    double sum = 0;
    for (int c = 0; c < 3; c++) {
        double above = fmax((double)radiance[c] - (double)mean[c], 0);
        sum += weights[c] * above * above;
    }
    return sqrt(sum);
}

static struct bright_path path_of(const struct film_image *film, uint64_t pixel,
                                  const double weights[3])
{
    const struct film_brightest *found = &film->aovs.brightest[pixel];
    struct bright_path path = {
        .x = (uint32_t)(pixel % film->width),
        .y = (uint32_t)(pixel / film->width),
        .sample = found->sample,
        .scattering_events = found->origin & BRIGHTEST_BOUNCE_MASK,
        .emitter = found->origin >> BRIGHTEST_EMITTER_SHIFT & BRIGHTEST_FIELD_MASK,
        .is_connection =
            (found->origin >> BRIGHTEST_SITE_SHIFT & BRIGHTEST_FIELD_MASK) == SITE_SHADOW,
        .excess = find_excess(found->radiance, film->mean[pixel], weights),
        .share = NAN,
    };
    memcpy(path.radiance, found->radiance, sizeof path.radiance);
    return path;
}

// Inserts a path into the sorted list of outliers, unless it follows the last one of a full list.
static void insert(struct error_sources *out, const struct bright_path *path)
{
    uint32_t place = out->brightest_count;
    while (place > 0 && out->brightest[place - 1].excess < path->excess)
        place--;
    if (place == BRIGHT_PATHS_MAX)
        return;
    if (out->brightest_count < BRIGHT_PATHS_MAX)
        out->brightest_count++;
    memmove(&out->brightest[place + 1], &out->brightest[place],
            (out->brightest_count - 1 - place) * sizeof *path);
    out->brightest[place] = *path;
}

static void find_brightest(const struct film_image *film, const double (*weights)[3],
                           struct error_sources *out)
{
    uint64_t pixels = (uint64_t)film->width * film->height;
    for (uint64_t i = 0; i < pixels; i++) {
        struct bright_path path = path_of(film, i, weights[i]);
        if (path.excess > 0)
            insert(out, &path);
    }
}

// -------------------------------------------------------------------------------------------------

static void find_shares(const struct film_image *film, uint32_t rendered,
                        const struct half_error_params *halves, const double (*weights)[3],
                        struct error_sources *out)
{
    struct error_by_params params = {.halves = halves, .weights = weights};
    double whole = metrics_error_sum(&params);
    for (int kind = 0; kind < ERROR_KIND_COUNT; kind++) {
        if (!(out->kinds & error_kind_aov((enum error_kind)kind)))
            continue;
        params = params_of(film, rendered, (enum error_kind)kind, halves, weights);
        metrics_error_by(&params, &out->by[kind]);
    }
    for (uint32_t i = 0; i < out->brightest_count && whole > 0; i++) {
        struct bright_path *path = &out->brightest[i];
        uint64_t pixel = (uint64_t)path->y * film->width + path->x;
        path->share = metrics_error_of_pixel(&params, pixel) / whole;
    }
}

bool error_sources_find(const struct film_image *film, uint32_t aovs,
                        const struct film_error_params *params, struct error_sources *out,
                        struct err *err)
{
    const struct film_image rows = film_rows_alone(film);
    uint64_t pixels = (uint64_t)rows.width * rows.height;
    *out = (struct error_sources){
        .kinds = aovs & AOVS_BY,
        .has_intervals = !params->shares_depths,
    };
    if (!out->kinds)
        return true;
    out->reason = why_unknown(film, params);
    if (out->reason)
        return true;
    const struct half_error_params halves = {
        .half_a = (const float(*)[3])rows.half_a,
        .half_b = (const float(*)[3])rows.half_b,
        .width = rows.width,
        .height = rows.height,
        .samples = rows.least_samples,
    };
    double(*weights)[3] = malloc(pixels * sizeof *weights);
    bool ok = weights && metrics_half_error_weights(&halves, weights);
    if (ok) {
        find_brightest(&rows, (const double(*)[3])weights, out);
        find_shares(&rows, aovs, &halves, (const double(*)[3])weights, out);
    }
    for (uint32_t i = 0; i < out->brightest_count; i++)
        out->brightest[i].y += rows.rows.first;
    free(weights);
    return ok || err_memory(err, "where the error comes from", pixels * sizeof *weights);
}
