// What the samples of `lampyris converge` say.
#include "converge.h"

#include <math.h>

const char *const converge_metric_names[CONVERGE_METRICS] = {
    [CONVERGE_RELMSE] = "relmse", [CONVERGE_MSE] = "mse",   [CONVERGE_SMAPE] = "smape",
    [CONVERGE_PSNR] = "psnr",     [CONVERGE_SSIM] = "ssim", [CONVERGE_FLIP] = "flip",
};

const double converge_targets[CONVERGE_TARGETS] = {1e-2, 1e-3, 1e-4};

struct columns {
    double *values, *errors, *x; // scratch: one a replicate; all of relMSE; points
    double *efficiency;          // of the scene's first curve
};

static void fill(const struct converge *c, const struct converge_curve *curve, uint32_t point,
                 int metric, double *out)
{
    for (uint32_t r = 0; r < c->replicates_done; r++) {
        const struct converge_sample *s = converge_at(c, curve, r, point);
        out[r] = metric < 0 ? s->seconds : s->metric[metric];
    }
}

static void fill_efficiency(const struct converge *c, const struct converge_curve *curve,
                            double *out)
{
    for (uint32_t r = 0; r < c->replicates_done; r++) {
        const struct converge_sample *s = converge_at(c, curve, r, c->point_count - 1);
        out[r] = 1.0 / (s->metric[CONVERGE_RELMSE] * s->seconds);
    }
}

// T(eps) = T0 + t relMSE / eps from the last point, as if the error fell with 1 / t from there.
static void find_times(const struct converge *c, struct converge_curve *curve)
{
    uint32_t last = c->point_count - 1;
    for (int i = 0; i < CONVERGE_TARGETS; i++) {
        double error = curve->error[last].value;
        curve->time_to[i] =
            curve->start_seconds + curve->seconds[last].value * error / converge_targets[i];
        curve->extrapolated[i] = error > converge_targets[i];
    }
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
    const struct curve_bias_params params = {
        .pictures = pictures,
        .count = c->replicates_done,
        .length = length,
        .reference = image->pixels[0],
        .reference_relmse = reference->picture.relmse,
    };
    return curve_bias(&params, &curve->bias) || err_memory(err, "bias", length);
}

static bool conclude_curve(struct converge *c, struct converge_curve *curve,
                           struct columns *columns, struct err *err)
{
    uint32_t points = c->point_count, replicates = c->replicates_done;
    for (uint32_t p = 0; p < points; p++) {
        fill(c, curve, p, CONVERGE_RELMSE, columns->values);
        curve->error[p] = curve_geometric_mean(columns->values, replicates);
        for (uint32_t r = 0; r < replicates; r++)
            columns->errors[(size_t)r * points + p] = columns->values[r];
        fill(c, curve, p, -1, columns->values);
        curve->seconds[p] = curve_geometric_mean(columns->values, replicates);
    }
    curve->slope = curve_slope(columns->x, columns->errors, points, replicates);
    fill_efficiency(c, curve, columns->values);
    curve->efficiency = curve_geometric_mean(columns->values, replicates);
    const struct converge_curve *first = curve;
    while (first > c->curves && first[-1].variant.scene == curve->variant.scene)
        first--;
    fill_efficiency(c, first, columns->efficiency);
    curve->ratio = curve_paired_ratio(columns->values, columns->efficiency, replicates);
    find_times(c, curve);
    return find_bias(c, curve, err);
}

bool converge_conclude(struct converge *c, struct err *err)
{
    size_t replicates = c->replicates_done, points = c->point_count;
    struct columns columns = {
        .values = ARENA_NEW(&c->arena, double, replicates),
        .errors = ARENA_NEW(&c->arena, double, replicates *points),
        .x = ARENA_NEW(&c->arena, double, replicates *points),
        .efficiency = ARENA_NEW(&c->arena, double, replicates),
    };
    if (!columns.values || !columns.errors || !columns.x || !columns.efficiency)
        return err_memory(err, "curves", replicates * points * sizeof(double));
    for (size_t i = 0; i < replicates * points; i++)
        columns.x[i] = (double)c->spp[i % points];
    for (uint32_t i = 0; i < c->curve_count; i++)
        if (!conclude_curve(c, &c->curves[i], &columns, err))
            return false;
    return true;
}
