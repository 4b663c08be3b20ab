// Measures at how many samples renders with an error limit end, and whether their forecasts are
// correct. docs/convergence.md ("When a bound on the error ends a render") has the totals,
// docs/measurements/2026-11-23-error-estimates.md the table.
//
//   test_endings [OPTIONS] [SCENE...]
//
// SCENE is as for test_coverage. Each seed is rendered once, two samples at a time, and its error
// is estimated after each step. Bits do not depend on steps, so this shows where the program would
// test and end for any error limit. The limits are the medians of the errors of all seeds after 6,
// 12, 24 ... samples. Exit status: 0 as required, 1 significantly worse, 2 usage, 77 no Vulkan.
#include "metrics/forecast.h"
#include "metrics/metrics.h"
#include "render/probe/in_view.h"
#include "shares.h"
#include "subjects.h"

#include <getopt.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
    SKIPPED = 77,
    STEP = 2,
    REFERENCE_SEED = 999983,
    REFERENCE_FACTOR = 16, // samples of the reference, relative to the most samples of a seed
    FIRST_FORECAST = 16,
    FORECASTS = 4,
};

static const double promised = 0.05, ratio_most = 1.3, forecasts_least = 0.9;
// in samples; the last one is relative to the most samples
static const double first_limit = 6, limits_apart = 2, last_limit = 0.36;

struct options {
    uint32_t side, seeds, samples;
};

static const char usage[] = "usage: test_endings [OPTIONS] [SCENE...]\n"
                            "  --side A      pictures of A x A pixels (48)\n"
                            "  --seeds N     (24)\n"
                            "  --samples N   as many as a render may have, a multiple of 8 (256)\n";

// The picture of a seed after a step.
struct step {
    double truth;
    struct half_error told;
};

// The forecasts for twice and four times the samples, with and without earlier estimates.
static const struct {
    double times;
    bool by_looks;
} forecasts[FORECASTS] = {{2, true}, {2, false}, {4, true}, {4, false}};

struct cell {
    uint32_t runs, ended, wrong, looks;
    double *ratios; // samples relative to find_hindsight(); INFINITY if the render did not end
    uint32_t told[FORECASTS], held[FORECASTS];
};

struct run {
    const struct options *options;
    struct cell total;
};

// --- rendering -----------------------------------------------------------------------------------

struct reference {
    const float (*mean)[3];
    float (*local)[3];
    uint64_t pixels;
    double own; // error due to the reference's own noise
};

static bool judge(const struct film_image *film, const struct unseen_light *unseen,
                  struct half_error *out, struct err *err)
{
    const struct half_error_params params = {
        .half_a = (const float(*)[3])film->half_a,
        .half_b = (const float(*)[3])film->half_b,
        .width = film->width,
        .height = film->height,
        .samples = film->least_samples,
        .unseen = *unseen,
        .confidence = LOOKS_CONFIDENCE,
    };
    return metrics_half_error(&params, out) || err_memory(err, "an error estimate", 0);
}

static bool find_reference(struct renderer *r, const struct options *options, struct arena *arena,
                           struct reference *out, struct err *err)
{
    const struct render_call call = {.samples = (uint64_t)options->samples * REFERENCE_FACTOR};
    struct film_image film;
    if (!renderer_restart(r, REFERENCE_SEED, err) || !renderer_render(r, &call, err) ||
        !renderer_read(r, arena, &film, err))
        return false;
    uint64_t pixels = (uint64_t)film.width * film.height;
    *out = (struct reference){(const float(*)[3])film.mean,
                              arena_alloc(arena, pixels, sizeof(float[3])), pixels, 0};
    if (!out->local || !metrics_local_means(out->mean, film.width, film.height, NULL, out->local))
        return err_memory(err, "a reference", pixels * sizeof(float[3]));
    // The mean of (A - B)^2 / 4 is the error of (A + B) / 2.
    for (uint64_t i = 0; i < pixels; i++)
        for (int c = 0; c < 3; c++) {
            double half = ((double)film.half_a[i][c] - film.half_b[i][c]) / 2;
            double mean = (double)out->local[i][c];
            out->own += half * half / (mean * mean + METRICS_RELMSE_EPSILON) / 3 / (double)pixels;
        }
    return true;
}

static bool render_seed(struct renderer *r, uint32_t seed, uint32_t steps,
                        const struct reference *reference, struct step *out, struct err *err)
{
    const struct render_call call = {.samples = STEP};
    struct arena arena = {0}, scratch = {0};
    struct unseen_light unseen;
    bool ok = renderer_restart(r, seed, err) && renderer_find_unseen(r, &scratch, &unseen, err);
    for (uint32_t i = 0; ok && i < steps; i++) {
        struct film_image film;
        ok = renderer_render(r, &call, err) && renderer_read(r, &arena, &film, err) &&
             judge(&film, &unseen, &out[i].told, err);
        if (ok)
            out[i].truth =
                metrics_local_relmse((const float(*)[3])film.mean, reference->mean,
                                     (const float(*)[3])reference->local, reference->pixels) -
                reference->own;
        arena_finish(&arena);
    }
    arena_finish(&scratch);
    return ok;
}

// Renders all steps of all seeds.
static bool render(const struct options *options, const struct subject *subject, uint32_t steps,
                   struct step *out, struct err *err)
{
    struct studio studio;
    struct arena arena = {0};
    struct reference reference;
    bool ok = studio_open(subject, options->side, &studio, err) &&
              find_reference(&studio.renderer, options, &arena, &reference, err);
    for (uint32_t seed = 0; ok && seed < options->seeds; seed++)
        ok = render_seed(&studio.renderer, 3000 + seed, steps, &reference,
                         &out[(size_t)seed * steps], err);
    arena_finish(&arena);
    studio_close(&studio);
    return ok;
}

// --- ending --------------------------------------------------------------------------------------

static int by_value(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static double find_median(double *values, uint32_t count)
{
    qsort(values, count, sizeof *values, by_value);
    return values[count / 2];
}

static const struct step *step_at(const struct step *steps, uint64_t samples)
{
    return &steps[samples / STEP - 1];
}

// Returns the median error of all seeds after this number of samples.
static double median_error(const struct options *options, const struct step *steps, double *scratch,
                           uint32_t samples)
{
    for (uint32_t seed = 0; seed < options->seeds; seed++)
        scratch[seed] = step_at(&steps[(size_t)seed * (options->samples / STEP)], samples)->truth;
    return find_median(scratch, options->seeds);
}

// Returns the least number of samples from which on the error is below the limit.
static uint32_t find_hindsight(const struct step *steps, uint32_t most, double limit)
{
    uint32_t samples = most;
    while (samples >= STEP && step_at(steps, samples)->truth < limit)
        samples -= STEP;
    return samples + STEP;
}

// Ends a run as src/job/run.c does.
static void end_run(struct cell *cell, const struct step *steps, uint32_t most, double limit)
{
    uint64_t samples = looks_first(0, STEP);
    double ratio = INFINITY, bound;
    for (; samples <= most; samples = looks_next(samples, bound / limit, STEP)) {
        cell->looks++;
        bound = step_at(steps, samples)->told.at_most;
        if (bound < limit) {
            cell->ended++;
            cell->wrong += step_at(steps, samples)->truth > limit;
            ratio = (double)samples / find_hindsight(steps, most, limit);
            break;
        }
    }
    cell->ratios[cell->runs++] = ratio;
}

// Tests the forecasts after `samples` for two and four times as many.
static void check_forecasts(struct cell *cell, const struct step *steps, uint32_t samples)
{
    struct forecast_look looks[32];
    size_t count = 0;
    for (uint32_t at = STEP; at <= samples; at *= 2) {
        const struct half_error *e = &step_at(steps, at)->told;
        looks[count++] = (struct forecast_look){at, e->known ? e->local_relmse : NAN, e->ci_low,
                                                e->ci_high, LOOKS_CONFIDENCE};
    }
    const struct half_error *now = &step_at(steps, samples)->told;
    for (int i = 0; now->known && i < FORECASTS; i++) {
        const struct forecast_params params = {
            .looks = looks,
            .count = forecasts[i].by_looks ? count : 0,
            .error = {now->local_relmse, now->ci_low, now->ci_high},
            .times = forecasts[i].times,
            .spread = now->spread,
            .spread_terms = now->spread_terms,
        };
        struct forecast forecast;
        forecast_find_error(&params, &forecast);
        double truth = step_at(steps, (uint64_t)(samples * forecasts[i].times))->truth;
        cell->told[i]++;
        cell->held[i] += forecast.error.low <= truth && truth <= forecast.error.high;
    }
}

// --- the table -----------------------------------------------------------------------------------

static void print_head(void)
{
    printf(
        "| scene | renders | end above the error, %% | samples / hindsight | looks | not ended, %% "
        "| forecast to 2 N holds, %% | without looks | to 4 N | without looks |\n"
        "|---|---|---|---|---|---|---|---|---|---|\n");
}

static double share(uint32_t part, uint32_t all)
{
    return all ? 100.0 * part / all : NAN;
}

static void print_cell(const char *name, struct cell *cell)
{
    printf("| %s | %u | %.1f | %.2f | %.1f | %.1f |", name, cell->runs,
           share(cell->wrong, cell->runs), find_median(cell->ratios, cell->runs),
           (double)cell->looks / cell->runs, share(cell->runs - cell->ended, cell->runs));
    for (int i = 0; i < FORECASTS; i++)
        if (cell->told[i])
            printf(" %.1f |", share(cell->held[i], cell->told[i]));
        else
            printf(" - |");
    printf("\n");
    fflush(stdout);
}

static bool add_cell(struct cell *total, const struct cell *cell, struct err *err)
{
    uint32_t runs = total->runs + cell->runs;
    double *ratios = realloc(total->ratios, runs * sizeof *ratios);
    if (!ratios)
        return err_memory(err, "a table", runs * sizeof *ratios);
    memcpy(&ratios[total->runs], cell->ratios, cell->runs * sizeof *ratios);
    total->ratios = ratios;
    total->runs = runs;
    total->ended += cell->ended;
    total->wrong += cell->wrong;
    total->looks += cell->looks;
    for (int i = 0; i < FORECASTS; i++) {
        total->told[i] += cell->told[i];
        total->held[i] += cell->held[i];
    }
    return true;
}

static void fill_cell(struct cell *cell, const struct options *options, const struct step *steps,
                      double *scratch)
{
    uint32_t count = options->samples / STEP;
    for (double at = first_limit; at <= last_limit * options->samples; at *= limits_apart) {
        double limit = median_error(options, steps, scratch, (uint32_t)at / STEP * STEP);
        for (uint32_t seed = 0; seed < options->seeds; seed++)
            end_run(cell, &steps[(size_t)seed * count], options->samples, limit);
    }
    for (uint32_t seed = 0; seed < options->seeds; seed++)
        for (uint32_t at = FIRST_FORECAST; at <= options->samples / 4; at *= 2)
            check_forecasts(cell, &steps[(size_t)seed * count], at);
}

static bool run_subject(void *context, const struct subject *subject, struct err *err)
{
    struct run *run = context;
    const struct options *options = run->options;
    uint32_t count = options->samples / STEP;
    struct step *steps = calloc((size_t)options->seeds * count, sizeof *steps);
    double *scratch = calloc(options->seeds, sizeof *scratch);
    struct cell cell = {.ratios = calloc((size_t)options->seeds * 32, sizeof(double))};
    bool ok = (steps && scratch && cell.ratios) || err_memory(err, "a table", 0);
    ok = ok && render(options, subject, count, steps, err);
    if (ok) {
        fill_cell(&cell, options, steps, scratch);
        ok = add_cell(&run->total, &cell, err);
        print_cell(subject->name, &cell);
    }
    free(cell.ratios);
    free(scratch);
    free(steps);
    return ok;
}

// --- the program ---------------------------------------------------------------------------------

static bool parse_number(const char *text, uint32_t *out)
{
    char *end;
    unsigned long value = strtoul(text, &end, 10);
    *out = (uint32_t)value;
    return end != text && *end == '\0' && value <= 65536;
}

static bool parse_options(int argc, char **argv, struct options *out)
{
    static const struct option names[] = {{"side", required_argument, NULL, 's'},
                                          {"seeds", required_argument, NULL, 'n'},
                                          {"samples", required_argument, NULL, 'p'},
                                          {0}};
    *out = (struct options){48, 24, 256};
    bool ok = true;
    for (int c; ok && (c = getopt_long(argc, argv, "", names, NULL)) != -1;)
        ok = (c == 's' && parse_number(optarg, &out->side)) ||
             (c == 'n' && parse_number(optarg, &out->seeds)) ||
             (c == 'p' && parse_number(optarg, &out->samples));
    return ok && out->side > 0 && out->seeds > 0 && out->samples >= 64 && out->samples % 8 == 0;
}

static bool is_as_asked(const struct cell *total)
{
    bool ok = !share_is_too_small(total->runs - total->wrong, total->runs, 1 - promised) &&
              total->ratios[total->runs / 2] <= ratio_most; // print_cell() has sorted them
    for (int i = 0; i < FORECASTS; i++)
        ok = ok && !share_is_too_small(total->held[i], total->told[i], forecasts_least);
    return ok;
}

int main(int argc, char **argv)
{
    struct options options;
    if (!parse_options(argc, argv, &options)) {
        fputs(usage, stderr);
        return 2;
    }
    struct run run = {.options = &options};
    struct err err = {0};
    print_head();
    if (!subjects_visit(argv + optind, run_subject, &run, &err)) {
        fprintf(stderr, "endings: %s\n", err.msg);
        if (err.code == ERR_NO_VULKAN && !getenv("LAMPYRIS_NO_SKIP"))
            return SKIPPED;
        return err.code == ERR_USAGE || err.code == ERR_INPUT ? 2 : 1;
    }
    print_cell("all", &run.total);
    bool ok = is_as_asked(&run.total);
    free(run.total.ratios);
    return ok ? 0 : 1;
}
