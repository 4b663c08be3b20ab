// Computes the errors of pictures, and whether the estimates of these errors are correct.
//
// The reference of a seed is the mean m of the other n - 1 seeds, so that the two are independent.
// The mean of (x - m)^2 is the error of x plus the variance of m, which the other seeds give.
#include "cells.h"

#include "metrics/metrics.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

struct judge {
    const struct subject *subject;
    const struct pictures *pictures;
    bool misses;
    uint64_t values;
    double *sum, *square;    // sums over the pictures with the most samples
    float (*local_means)[3]; // metrics_local_means() of `reference`
    float (*half_a)[3], (*half_b)[3];
    float (*picture)[3];
    float (*reference)[3];  // without the current seed
    double own, own_relmse; // local relMSE and relMSE due to the reference's own noise
};

static void find_picture(struct judge *judge)
{
    for (uint64_t i = 0; i < judge->values; i++)
        judge->picture[0][i] = (float)(((double)judge->half_a[0][i] + judge->half_b[0][i]) / 2);
}

static bool read_picture(struct judge *judge, uint32_t seed, uint32_t level, struct err *err)
{
    if (!pictures_read(judge->pictures, seed, level, judge->half_a, judge->half_b, err))
        return false;
    find_picture(judge);
    return true;
}

static bool find_sums(struct judge *judge, struct err *err)
{
    const struct plan *plan = judge->pictures->plan;
    for (uint32_t seed = 0; seed < plan->seeds; seed++) {
        if (!read_picture(judge, seed, plan->levels - 1, err))
            return false;
        for (uint64_t i = 0; i < judge->values; i++) {
            double value = (double)judge->picture[0][i];
            judge->sum[i] += value;
            judge->square[i] += value * value;
        }
    }
    return true;
}

// Adds the contribution of the reference's own noise. `mean` is the mean of the other seeds.
static void add_own(struct judge *judge, double mean, double variance, uint64_t i)
{
    double local = (double)judge->local_means[0][i];
    judge->own += variance / (local * local + METRICS_RELMSE_EPSILON) / (double)judge->values;
    judge->own_relmse += variance / (mean * mean + METRICS_RELMSE_EPSILON) / (double)judge->values;
}

// Removes a seed from the reference and from its local means, because a bright sample of this seed
// would reduce the errors around it.
static bool leave_out(struct judge *judge, uint32_t seed, struct err *err)
{
    const struct plan *plan = judge->pictures->plan;
    double others = plan->seeds - 1.0;
    if (!read_picture(judge, seed, plan->levels - 1, err))
        return false;
    for (uint64_t i = 0; i < judge->values; i++)
        judge->reference[0][i] = (float)((judge->sum[i] - (double)judge->picture[0][i]) / others);
    if (!metrics_local_means((const float(*)[3])judge->reference, plan->side, plan->side, NULL,
                             judge->local_means))
        return err_memory(err, "the local means", judge->values * sizeof(float));
    judge->own = judge->own_relmse = 0;
    for (uint64_t i = 0; i < judge->values; i++) {
        double value = (double)judge->picture[0][i], mean = (judge->sum[i] - value) / others;
        double spread = (judge->square[i] - value * value) / others - mean * mean;
        add_own(judge, mean, fmax(spread, 0) / (others - 1), i);
    }
    return true;
}

struct truth {
    double error, relmse;
};

static struct truth find_truth(const struct judge *judge)
{
    const float(*picture)[3] = (const float(*)[3])judge->picture;
    const float(*reference)[3] = (const float(*)[3])judge->reference;
    struct metrics metrics;
    metrics_compare(picture, reference, judge->pictures->pixels, NULL, &metrics);
    double error = metrics_local_relmse(picture, reference, (const float(*)[3])judge->local_means,
                                        judge->pictures->pixels);
    return (struct truth){error - judge->own, metrics.relmse - judge->own_relmse};
}

// Computes the control: relMSE with the picture's own noisy values in the denominators, an estimate
// that is known to be too small.
static double find_control(const struct judge *judge)
{
    double sum = 0;
    for (uint64_t i = 0; i < judge->values; i++) {
        double half = ((double)judge->half_a[0][i] - judge->half_b[0][i]) / 2;
        double mean = (double)judge->picture[0][i];
        sum += half * half / (mean * mean + METRICS_RELMSE_EPSILON);
    }
    return sum / (double)judge->values;
}

static void say_miss(const struct judge *judge, uint32_t seed, uint32_t level, double truth,
                     const struct half_error *told)
{
    const struct plan *plan = judge->pictures->plan;
    fprintf(
        stderr,
        "%s, %u x %u, %u samples, seed %u: true %.4g, told %.4g [%.4g, %.4g], at most %.4g%s%s\n",
        judge->subject->name, plan->side, plan->side, plan->samples[level], plan->first_seed + seed,
        truth, told->local_relmse, told->ci_low, told->ci_high, told->at_most,
        told->reason ? "; " : "", told->reason ? told->reason : "");
}

// Returns whether the result is correct: the interval if there is one, otherwise the bound.
static bool count(struct cell *cell, const struct truth *truth, const struct half_error *told,
                  double control)
{
    bool held = told->ci_low <= truth->error && truth->error <= told->ci_high;
    bool bound_held = truth->error <= told->at_most;
    cell->seeds++;
    cell->truth += truth->error;
    if (told->known) {
        double scale = control / told->local_relmse;
        cell->intervals++;
        cell->intervals_held += held;
        cell->control_held +=
            told->ci_low * scale <= truth->relmse && truth->relmse <= told->ci_high * scale;
        cell->truth_of_intervals += truth->error;
        cell->told_of_intervals += told->local_relmse;
    }
    if (!told->bounded)
        return true;
    cell->alone += !told->known;
    cell->alone_held += !told->known && bound_held;
    cell->bound_ratios[cell->bounds++] = told->at_most / truth->error;
    cell->bounds_held += bound_held;
    cell->relmse_held += truth->relmse <= told->relmse_at_most;
    return told->known ? held : bound_held;
}

static bool judge_picture(struct judge *judge, uint32_t seed, uint32_t level, struct cell *cell,
                          struct err *err)
{
    const struct plan *plan = judge->pictures->plan;
    if (!read_picture(judge, seed, level, err))
        return false;
    const struct half_error_params params = {
        .half_a = (const float(*)[3])judge->half_a,
        .half_b = (const float(*)[3])judge->half_b,
        .width = plan->side,
        .height = plan->side,
        .samples = plan->samples[level],
        .unseen = judge->pictures->unseen,
    };
    struct half_error told;
    if (!metrics_half_error(&params, &told))
        return err_memory(err, "the judge", judge->values * sizeof(float));
    struct truth truth = find_truth(judge);
    if (!count(cell, &truth, &told, find_control(judge)) && judge->misses)
        say_miss(judge, seed, level, truth.error, &told);
    return true;
}

static bool judge_seeds(struct judge *judge, struct cell *cells, struct err *err)
{
    const struct plan *plan = judge->pictures->plan;
    for (uint32_t seed = 0; seed < plan->seeds; seed++) {
        if (!leave_out(judge, seed, err))
            return false;
        for (uint32_t level = 0; level < plan->levels; level++)
            if (!judge_picture(judge, seed, level, &cells[level], err))
                return false;
    }
    return true;
}

static bool judge_init(struct judge *judge, const struct plan *plan, struct cell *cells)
{
    uint64_t pixels = judge->pictures->pixels;
    judge->values = pixels * 3;
    judge->sum = calloc(judge->values, sizeof *judge->sum);
    judge->square = calloc(judge->values, sizeof *judge->square);
    judge->local_means = calloc(pixels, sizeof *judge->local_means);
    judge->half_a = calloc(pixels, sizeof *judge->half_a);
    judge->half_b = calloc(pixels, sizeof *judge->half_b);
    judge->picture = calloc(pixels, sizeof *judge->picture);
    judge->reference = calloc(pixels, sizeof *judge->reference);
    bool ok = judge->sum && judge->square && judge->local_means && judge->half_a && judge->half_b &&
              judge->picture && judge->reference;
    for (uint32_t i = 0; i < plan->levels; i++) {
        cells[i] = (struct cell){.bound_ratios = calloc(plan->seeds, sizeof(double))};
        ok = ok && cells[i].bound_ratios;
    }
    return ok;
}

static void judge_finish(struct judge *judge)
{
    free(judge->sum);
    free(judge->square);
    free(judge->local_means);
    free(judge->half_a);
    free(judge->half_b);
    free(judge->picture);
    free(judge->reference);
}

bool cells_judge(const struct subject *subject, const struct pictures *pictures, bool misses,
                 struct cell *cells, struct err *err)
{
    struct judge judge = {.subject = subject, .pictures = pictures, .misses = misses};
    bool ok = judge_init(&judge, pictures->plan, cells)
                  ? find_sums(&judge, err) && judge_seeds(&judge, cells, err)
                  : err_memory(err, "the judge", judge.values * sizeof(double));
    judge_finish(&judge);
    return ok;
}
