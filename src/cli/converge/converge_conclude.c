// Computes the statistics of `lampyris converge`.
#include "cli/converge/converge.h"

#include "base/hash.h"
#include "metrics/bias.h"
#include <math.h>
#include <stdio.h>

const char *const converge_metric_names[CONVERGE_METRICS] = {
    [CONVERGE_LOCAL_RELMSE] = "local_relmse",
    [CONVERGE_RELMSE] = "relmse",
    [CONVERGE_MSE] = "mse",
    [CONVERGE_SMAPE] = "smape",
    [CONVERGE_PSNR] = "psnr",
    [CONVERGE_SSIM] = "ssim",
    [CONVERGE_FLIP] = "flip",
};

const double converge_targets[CONVERGE_TARGETS] = {1e-2, 1e-3, 1e-4};

const char *converge_label(const struct converge_curve *curve)
{
    return *curve->variant.label ? curve->variant.label : "as given";
}

const char *converge_verdict(struct interval ratio)
{
    static const char *const words[] = {
        [CURVE_NOT_TOLD_APART] = "not told apart",
        [CURVE_BETTER] = "faster",
        [CURVE_WORSE] = "slower",
    };
    return words[curve_judge(ratio)];
}

bool converge_is_biased(const struct converge_curve *curve)
{
    return curve->bias.low > 0;
}

uint32_t converge_siblings(const struct converge *c, const struct converge_curve *curve,
                           uint32_t *first)
{
    uint32_t begin = (uint32_t)(curve - c->curves), end = begin, scene = curve->variant.scene;
    while (begin > 0 && c->curves[begin - 1].variant.scene == scene)
        begin--;
    while (end < c->curve_count && c->curves[end].variant.scene == scene)
        end++;
    *first = begin;
    return end - begin;
}

#define REPLICATES_ENOUGH 16

uint32_t converge_notes(const struct converge *c, char notes[][CONVERGE_NOTE_SIZE])
{
    uint32_t count = 0, curves = 0, bounded = 0, pictures = 0;
    bool all_small = true, all_known = true;
    for (uint32_t i = 0; i < c->curve_count; i++) {
        uint32_t first, siblings = converge_siblings(c, &c->curves[i], &first);
        curves = siblings > curves ? siblings : curves;
        all_small &= converge_is_small(&c->curves[i]);
        const struct converge_reference *reference = &c->references[c->curves[i].variant.scene];
        all_known &= !reference->name || reference->picture.noise_known;
        for (uint32_t p = 0; p < c->point_count && !reference->name; p++)
            bounded += c->curves[i].points[p].unknown;
        pictures += c->point_count * c->replicates_done;
    }
    if (c->stopped)
        snprintf(notes[count++], CONVERGE_NOTE_SIZE,
                 "stopped by a %s: %u of %u replicates were complete and are reported",
                 c->failure.code ? "failure of the device" : "signal", c->replicates_done,
                 c->replicate_count);
    if (c->replicates_done < REPLICATES_ENOUGH)
        snprintf(notes[count++], CONVERGE_NOTE_SIZE,
                 "there are fewer than %d replicates: intervals are wide, and assume that rare "
                 "large errors do not dominate",
                 REPLICATES_ENOUGH);
    if (bounded > 0)
        snprintf(notes[count++], CONVERGE_NOTE_SIZE,
                 "for %u of %u pictures the half-buffers give only a bound of the error; results "
                 "that depend on these errors are not known",
                 bounded, pictures);
    if (!all_known)
        snprintf(notes[count++], CONVERGE_NOTE_SIZE,
                 "the reference's own noise is not known, so it counts as error and as bias");
    if (curves > 2)
        snprintf(notes[count++], CONVERGE_NOTE_SIZE,
                 "each of the %u pairs has an interval of its own: of 40 pairs that are equally "
                 "fast, one is reported as faster and one as slower on average",
                 curves * (curves - 1) / 2);
    if (!all_small && c->references[0].name)
        snprintf(notes[count++], CONVERGE_NOTE_SIZE,
                 "SSIM and FLIP are those of the first replicate only, because pictures are large");
    return count;
}

struct columns {
    double *values, *others; // temporary memory: one value per replicate
    double *errors, *x;      // for each replicate, the values at all points
};

// --- points --------------------------------------------------------------------------------------

static struct interval summarize(int metric, const double *values, uint32_t count)
{
    bool is_error =
        metric == CONVERGE_LOCAL_RELMSE || metric == CONVERGE_RELMSE || metric == CONVERGE_MSE;
    return is_error ? curve_geometric_mean(values, count) : curve_mean(values, count);
}

static void conclude_point(const struct converge *c, struct converge_curve *curve, uint32_t point,
                           double *values)
{
    uint32_t replicates = c->replicates_done;
    struct converge_point *out = &curve->points[point];
    for (int m = 0; m < CONVERGE_METRICS; m++) {
        for (uint32_t r = 0; r < replicates; r++)
            values[r] = converge_at(c, curve, r, point)->metric[m];
        bool is_of_one = isnan(values[replicates - 1]) && !isnan(values[0]) &&
                         (m == CONVERGE_SSIM || m == CONVERGE_FLIP);
        out->metric[m] = summarize(m, values, is_of_one ? 1 : replicates);
    }
    out->unknown = 0;
    for (uint32_t r = 0; r < replicates; r++) {
        values[r] = converge_at(c, curve, r, point)->at_most;
        out->unknown += isnan(converge_at(c, curve, r, point)->metric[CONVERGE_LOCAL_RELMSE]);
    }
    out->at_most = curve_geometric_mean(values, replicates).value;
    for (uint32_t r = 0; r < replicates; r++)
        values[r] = converge_at(c, curve, r, point)->seconds;
    out->seconds = curve_geometric_mean(values, replicates);
    for (uint32_t r = 0; r < replicates; r++)
        values[r] = (double)converge_at(c, curve, r, point)->spp;
    out->spp = curve_geometric_mean(values, replicates);
}

static void find_slope(const struct converge *c, struct converge_curve *curve,
                       struct columns *columns)
{
    uint32_t points = c->point_count;
    for (uint32_t r = 0; r < c->replicates_done; r++)
        for (uint32_t p = 0; p < points; p++) {
            const struct converge_sample *s = converge_at(c, curve, r, p);
            columns->errors[(size_t)r * points + p] = s->metric[CONVERGE_LOCAL_RELMSE];
            columns->x[(size_t)r * points + p] = c->spp ? (double)s->spp : s->seconds;
        }
    curve->slope = curve_slope(columns->x, columns->errors, points, c->replicates_done);
}

// --- efficiency ----------------------------------------------------------------------------------

static void fill_efficiency(const struct converge *c, const struct converge_curve *curve,
                            enum converge_metric metric, double *out)
{
    for (uint32_t r = 0; r < c->replicates_done; r++) {
        const struct converge_sample *s = converge_at(c, curve, r, c->point_count - 1);
        out[r] = 1.0 / (s->metric[metric] * s->seconds);
    }
}

static void find_efficiency(const struct converge *c, struct converge_curve *curve,
                            struct columns *columns)
{
    uint32_t first, count = converge_siblings(c, curve, &first), replicates = c->replicates_done;
    fill_efficiency(c, curve, CONVERGE_MSE, columns->values);
    curve->efficiency_mse = curve_geometric_mean(columns->values, replicates);
    fill_efficiency(c, curve, CONVERGE_LOCAL_RELMSE, columns->values);
    curve->efficiency = curve_geometric_mean(columns->values, replicates);
    for (uint32_t i = 0; i < count; i++) {
        fill_efficiency(c, &c->curves[first + i], CONVERGE_LOCAL_RELMSE, columns->others);
        curve->ratios[i] = curve_paired_ratio(columns->values, columns->others, replicates);
    }
}

// --- time to an error ----------------------------------------------------------------------------

// Returns the slope with which a curve is continued outside of its points. It is -1, as for
// independent samples, because the slope of a few points is not the asymptotic one. The interval
// includes the measured slope.
static struct interval slope_outside(const struct converge_curve *curve)
{
    struct interval found = curve->slope;
    bool is_slow = found.low > -1;
    return (struct interval){-1, fmin(found.low, -1), is_slow ? found.high : -1};
}

// Computes where the curve, and the curves through the ends of its intervals, reach the target.
static struct interval reach(const struct converge *c, const struct converge_curve *curve,
                             bool in_samples, double target, double *x, double *errors)
{
    uint32_t points = c->point_count;
    struct interval slope = slope_outside(curve), out;
    for (int side = 0; side < 3; side++) {
        for (uint32_t p = 0; p < points; p++) {
            const struct converge_point *point = &curve->points[p];
            struct interval e = point->metric[CONVERGE_LOCAL_RELMSE];
            x[p] = in_samples ? point->spp.value : point->seconds.value;
            errors[p] = side == 0 ? e.value : side == 1 ? e.low : e.high;
        }
        double with = side == 0 ? slope.value : side == 1 ? slope.low : slope.high;
        double found = curve_reach(x, errors, points, with, target);
        *(side == 0 ? &out.value : side == 1 ? &out.low : &out.high) = found;
    }
    if (out.low > out.high) // this happens before the first point
        out = (struct interval){out.value, out.high, out.low};
    return out;
}

static void find_targets(const struct converge *c, struct converge_curve *curve,
                         struct columns *columns)
{
    const struct converge_point *first = curve->points, *last = first + c->point_count - 1;
    for (int i = 0; i < CONVERGE_TARGETS; i++) {
        struct converge_target *out = &curve->targets[i];
        double target = converge_targets[i];
        out->spp = reach(c, curve, true, target, columns->x, columns->errors);
        out->seconds = reach(c, curve, false, target, columns->x, columns->errors);
        out->seconds.value += curve->start_seconds;
        out->seconds.low += curve->start_seconds;
        out->seconds.high += curve->start_seconds;
        out->extrapolated =
            !(out->spp.value >= first->spp.value && out->spp.value <= last->spp.value);
        if (out->extrapolated && curve->bias.low > target) // the bias alone exceeds the target
            out->spp = out->seconds = (struct interval){NAN, NAN, NAN};
    }
}

// --- bias ----------------------------------------------------------------------------------------

static const float *reference_half(const struct reference *reference, int half)
{
    return reference->halves[half] ? reference->halves[half][0] : NULL;
}

static bool find_bias(struct converge *c, struct converge_curve *curve, struct err *err)
{
    const struct converge_reference *reference = &c->references[curve->variant.scene];
    curve->bias = (struct interval){NAN, NAN, NAN};
    if (!reference->name || c->replicates_done < 3)
        return true;
    const struct image *image = &reference->picture.image;
    size_t length = 3 * (size_t)image->width * image->height;
    const float **pictures = ARENA_NEW(&c->arena, const float *, c->replicates_done);
    if (!pictures)
        return err_memory(err, "pictures", c->replicates_done * sizeof *pictures);
    for (uint32_t r = 0; r < c->replicates_done; r++)
        pictures[r] = curve->pictures[r][0];
    const struct bias_params params = {
        .pictures = pictures,
        .count = c->replicates_done,
        .length = length,
        .reference = image->pixels[0],
        .reference_halves = {reference_half(&reference->picture, 0),
                             reference_half(&reference->picture, 1)},
    };
    return bias_find(&params, &curve->bias) || err_memory(err, "bias", length);
}

static bool conclude_curve(struct converge *c, struct converge_curve *curve,
                           struct columns *columns, struct err *err)
{
    const struct settings *settings = &curve->scene_data.settings;
    for (uint32_t p = 0; p < c->point_count; p++)
        conclude_point(c, curve, p, columns->values);
    find_slope(c, curve, columns);
    find_efficiency(c, curve, columns);
    if (!find_bias(c, curve, err) || !converge_pool_sources(c, curve, err))
        return false;
    find_targets(c, curve, columns);
    size_t pixels = (size_t)settings->width * settings->height;
    curve->image_hash = hash_bytes(HASH_INIT, curve->pictures[0], pixels * sizeof(float[3]));
    return converge_command(c, curve, &curve->command, err);
}

bool converge_conclude(struct converge *c, struct err *err)
{
    size_t replicates = c->replicates_done, points = c->point_count;
    struct columns columns = {
        .values = ARENA_NEW(&c->arena, double, replicates),
        .others = ARENA_NEW(&c->arena, double, replicates),
        .errors = ARENA_NEW(&c->arena, double, replicates *points),
        .x = ARENA_NEW(&c->arena, double, replicates *points),
    };
    if (!columns.values || !columns.others || !columns.errors || !columns.x)
        return err_memory(err, "curves", replicates * points * sizeof(double));
    for (uint32_t i = 0; i < c->curve_count; i++)
        if (!conclude_curve(c, &c->curves[i], &columns, err))
            return false;
    return true;
}
