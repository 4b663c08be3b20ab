// Measures how often the error that a render reports is correct: docs/convergence.md has the
// totals, docs/measurements/2026-11-23-error-estimates.md the table.
//
//   test_coverage [OPTIONS] [SCENE...]
//
// SCENE is a name in the table of subjects.c, or a file given relative to the source root; without
// it, all scenes of the table are used. Exit status: 0 as required, 1 a share is significantly
// smaller (printed bold), 2 usage, 77 no Vulkan.
#include "cells.h"

#include <getopt.h>
#include <stdlib.h>
#include <string.h>

enum { SIDES_MAX = 8, SKIPPED = 77 };

struct options {
    struct plan plan; // without side and seeds
    uint32_t sides[SIDES_MAX], side_count;
    uint32_t seeds[SIDES_MAX], seed_counts; // by sides; the last number applies to all further
                                            // sides
    bool misses, control;
};

struct run {
    const struct options *options;
    struct cell total;
    bool as_asked;
};

static const char usage[] =
    "usage: test_coverage [OPTIONS] [SCENE...]\n"
    "  --sides A,B,...     pictures of A x A, B x B, ... pixels (48,96,256)\n"
    "  --seeds A,B,...     how many for each side, at least 3 (200)\n"
    "  --first-seed N      (2000)\n"
    "  --samples A,B,...   even numbers, rising (2,4,16,64,256); the last make the reference\n"
    "  --keep FOLDER       keep pictures there, and go on with those of an earlier run of the\n"
    "                      same program; else they are in a temporary file, which has 24 bytes\n"
    "                      for each pixel, sample count and seed of one scene and size\n"
    "  --misses            say on stderr what did not hold\n"
    "  --control           fail, too, where intervals around relMSE with the pixel's own noisy\n"
    "                      value in the denominator hold as often as asked for\n";

// Parses numbers separated by commas. Returns how many there are; 0 if the text is not such a list,
// or has more than `most`.
static uint32_t parse_list(const char *text, uint32_t *out, uint32_t most)
{
    uint32_t count = 0;
    for (;;) {
        char *end;
        unsigned long value = strtoul(text, &end, 10);
        if (end == text || value > 65536 || count == most)
            return 0;
        out[count++] = (uint32_t)value;
        if (*end == '\0')
            return count;
        if (*end != ',')
            return 0;
        text = end + 1;
    }
}

static bool are_even_and_rising(const struct plan *plan)
{
    for (uint32_t i = 0; i < plan->levels; i++)
        if (plan->samples[i] % 2 || plan->samples[i] <= (i ? plan->samples[i - 1] : 0))
            return false;
    return plan->levels > 0;
}

static bool are_at_least(uint32_t least, const uint32_t *values, uint32_t count)
{
    for (uint32_t i = 0; i < count; i++)
        if (values[i] < least)
            return false;
    return count > 0;
}

static bool parse_options(int argc, char **argv, struct options *out)
{
    static const struct option names[] = {
        {"sides", required_argument, NULL, 's'},      {"seeds", required_argument, NULL, 'n'},
        {"first-seed", required_argument, NULL, 'f'}, {"samples", required_argument, NULL, 'p'},
        {"keep", required_argument, NULL, 'k'},       {"misses", no_argument, NULL, 'm'},
        {"control", no_argument, NULL, 'c'},          {0},
    };
    *out = (struct options){
        .plan = {.first_seed = 2000, .samples = {2, 4, 16, 64, 256}, .levels = 5},
        .sides = {48, 96, 256},
        .side_count = 3,
        .seeds = {200},
        .seed_counts = 1,
    };
    struct plan *plan = &out->plan;
    bool ok = true;
    for (int c; ok && (c = getopt_long(argc, argv, "", names, NULL)) != -1;)
        switch (c) {
        case 's':
            out->side_count = parse_list(optarg, out->sides, SIDES_MAX);
            break;
        case 'n':
            out->seed_counts = parse_list(optarg, out->seeds, SIDES_MAX);
            break;
        case 'f':
            ok = parse_list(optarg, &plan->first_seed, 1) == 1;
            break;
        case 'p':
            plan->levels = parse_list(optarg, plan->samples, LEVELS_MAX);
            break;
        case 'k':
            plan->folder = optarg;
            break;
        case 'm':
            out->misses = true;
            break;
        case 'c':
            out->control = true;
            break;
        default:
            ok = false;
        }
    return ok && are_even_and_rising(plan) && are_at_least(3, out->seeds, out->seed_counts) &&
           are_at_least(1, out->sides, out->side_count);
}

static bool cover_side(struct run *run, const struct subject *subject, uint32_t side,
                       struct err *err)
{
    const struct options *options = run->options;
    uint32_t last = options->seed_counts - 1;
    struct plan plan = options->plan;
    plan.side = options->sides[side];
    plan.seeds = options->seeds[side < last ? side : last];
    struct pictures pictures = {0};
    struct cell cells[LEVELS_MAX] = {0};
    bool ok = pictures_render(subject, &plan, &pictures, err) &&
              cells_judge(subject, &pictures, options->misses, cells, err);
    for (uint32_t i = 0; ok && i < plan.levels; i++) {
        run->as_asked = cells_print(subject, &plan, i, &cells[i]) && run->as_asked;
        cells_add(&run->total, &cells[i]);
    }
    cells_finish(cells, plan.levels);
    pictures_finish(&pictures);
    return ok;
}

static bool cover(void *context, const struct subject *subject, struct err *err)
{
    struct run *run = context;
    for (uint32_t side = 0; side < run->options->side_count; side++)
        if (!cover_side(run, subject, side, err))
            return false;
    return true;
}

static int tell_failure(const struct err *err)
{
    fprintf(stderr, "coverage: %s\n", err->msg);
    if (err->code == ERR_NO_VULKAN && !getenv("LAMPYRIS_NO_SKIP"))
        return SKIPPED;
    return err->code == ERR_USAGE || err->code == ERR_INPUT ? 2 : 1;
}

int main(int argc, char **argv)
{
    struct options options;
    if (!parse_options(argc, argv, &options)) {
        fputs(usage, stderr);
        return 2;
    }
    struct run run = {.options = &options, .as_asked = true};
    struct err err = {0};
    cells_print_head();
    if (!subjects_visit(argv + optind, cover, &run, &err))
        return tell_failure(&err);
    run.as_asked = cells_print_total(&run.total) && run.as_asked;
    if (options.control) {
        bool found = cells_control_fails(&run.total);
        printf("control: %u of %u hold: %s\n", run.total.control_held, run.total.intervals,
               found ? "found to be wrong" : "NOT found to be wrong");
        run.as_asked = run.as_asked && found;
    }
    return run.as_asked ? 0 : 1;
}
