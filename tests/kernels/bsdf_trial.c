#include "bsdf_trial.h"

#include "base/parallel.h"
#include "bsdf_means.h"
#include "bsdf_reference.h"
#include "bsdf_statistics.h"

// Categories of samples besides the cells.
enum {
    CATEGORY_DELTA = CELLS,
    CATEGORY_HIDDEN = CELLS + REFERENCE_MAX_DELTAS, // transmission that counts as specular
    CATEGORY_ABSORBED,
    CATEGORIES,
};

struct work {
    const struct configuration *configuration;
    struct reference reference;
    struct reference exact;       // for wo before it was rounded, with its true sampling
    struct cell_integrals hidden; // normals through which transmission counts as specular
    struct chart charts[SIDES];
    struct cell_integrals cells;
    struct reference_delta deltas[REFERENCE_MAX_DELTAS];
    int delta_count;
    bool hides;
    union bsdf_item *items;
    uint32_t material;
};

static double density(const void *context, const double wi[3])
{
    double f[3];
    return reference_eval(context, wi, f);
}

static double hidden_density(const void *context, const double h[3])
{
    return reference_hidden_normal(context, h);
}

static bool is_finite3(const float v[3])
{
    return isfinite(v[0]) && isfinite(v[1]) && isfinite(v[2]);
}

static void fill_item(const struct work *w, union bsdf_item *item)
{
    *item = (union bsdf_item){.in = {.material = w->material, .eta = w->configuration->eta}};
    memcpy(item->in.wo, w->configuration->wo, sizeof item->in.wo);
}

// --- against the reference -----------------------------------------------------------------------

// Reflectances below this count as black in comparisons.
#define BLACK 2e-4

struct value {
    double f[3], pdf;
};

static void reference_value(const struct reference *r, const double wi[3], struct value *out)
{
    out->pdf = reference_eval(r, wi, out->f);
}

// Returns the greatest relative difference of a component. Reflectances of less than `black` count
// as black; 1e-3 of it is the rounding error of 1, from which they are computed.
static double difference(const struct value *a, const struct value *b, double black)
{
    double worst = fabs(a->pdf - b->pdf) / (fabs(b->pdf) + 1e-7);
    for (int c = 0; c < 3; c++)
        worst = fmax(worst, fabs(a->f[c] - b->f[c]) / (fabs(b->f[c]) + black));
    return isnan(worst) ? INFINITY : worst;
}

// Returns by how much the reference itself changes if one of its inputs changes by 8 rounding
// errors. Four times that, about as many rounding errors as a kernel makes in sequence, cannot be
// required of single precision.
static double conditioning(const struct reference *r, const double wi[3], const struct value *at)
{
    double worst = 0;
    for (int i = 0; i < 14; i++) {
        struct reference moved = *r;
        double direction[3] = {wi[0], wi[1], wi[2]};
        double step = i & 1 ? 0x1p-21 : -0x1p-21;
        if (i < 6)
            direction[i / 2] += step * fmax(fabs(direction[i / 2]), 0x1p-12);
        else if (i < 12)
            moved.wo[i / 2 - 3] += step * fmax(fabs(moved.wo[i / 2 - 3]), 0x1p-12);
        else
            moved.eta += step * moved.eta;
        struct value value;
        reference_value(&moved, direction, &value);
        worst = fmax(worst, difference(&value, at, BLACK * at->pdf + 1e-7));
    }
    return worst;
}

static double tolerance(const struct configuration *c)
{
    return c->angle >= 89.9 ? 1e-2 : 1e-3;
}

struct comparison {
    double worst;
    uint32_t ill_conditioned;
    char text[256];
};

static void compare(const struct work *w, const char *what, const float wi_float[3],
                    const struct value *got, bool ratio, struct comparison *out)
{
    double wi[3] = {(double)wi_float[0], (double)wi_float[1], (double)wi_float[2]};
    struct value expected, compared = *got;
    reference_value(&w->reference, wi, &expected);
    struct value judged = expected;
    for (int c = 0; c < 3 && ratio; c++)
        judged.f[c] = expected.pdf > 0 ? expected.f[c] / expected.pdf : 0;
    double error = difference(&compared, &judged, BLACK * (ratio ? 1 : expected.pdf) + 1e-7);
    if (error <= out->worst)
        return;
    if (error > tolerance(w->configuration)) {
        double moves = conditioning(&w->reference, wi, &expected);
        if (error <= tolerance(w->configuration) + 4 * moves) {
            out->ill_conditioned++;
            return;
        }
    }
    out->worst = error;
    snprintf(
        out->text, sizeof out->text,
        "%s at wi %.9g %.9g %.9g: got %.7g %.7g %.7g pdf %.7g, expected %.7g %.7g %.7g pdf %.7g",
        what, wi[0], wi[1], wi[2], got->f[0], got->f[1], got->f[2], got->pdf, judged.f[0],
        judged.f[1], judged.f[2], judged.pdf);
}

struct compare_task {
    const struct work *w;
    uint32_t stride;
    bool samples;
    struct comparison threads[PARALLEL_MAX_THREADS];
};

static void compare_range(void *context, size_t begin, size_t end, unsigned thread)
{
    struct compare_task *t = context;
    const struct work *w = t->w;
    for (size_t k = begin; k < end; k++) {
        size_t i = k * t->stride;
        const union bsdf_item *item = &w->items[i];
        struct value got;
        if (!t->samples) {
            got = (struct value){
                {(double)item->eval.f[0], (double)item->eval.f[1], (double)item->eval.f[2]},
                (double)item->eval.pdf};
            compare(w, "eval", w->cells.nodes[i].wi, &got, false, &t->threads[thread]);
        } else if ((item->sample.flags & (BSDF_VALID | BSDF_SPECULAR)) == BSDF_VALID) {
            got = (struct value){{(double)item->sample.weight[0], (double)item->sample.weight[1],
                                  (double)item->sample.weight[2]},
                                 (double)item->sample.pdf};
            compare(w, "weight", item->sample.wi, &got, true, &t->threads[thread]);
        }
    }
}

static void compare_items(const struct work *w, bool samples, uint32_t count, uint32_t compared,
                          struct trial *out)
{
    static struct compare_task task;
    task = (struct compare_task){.w = w, .samples = samples};
    task.stride = compared < count ? count / compared : 1;
    parallel_for(count / task.stride, 256, 0, compare_range, &task);
    for (int i = 0; i < PARALLEL_MAX_THREADS; i++) {
        out->ill_conditioned += task.threads[i].ill_conditioned;
        if (task.threads[i].worst > out->reference_error) {
            out->reference_error = task.threads[i].worst;
            memcpy(out->worst, task.threads[i].text, sizeof out->worst);
        }
    }
}

// --- densities -----------------------------------------------------------------------------------

// Returns by how much the integral of the stated density exceeds that of the sampled one: the
// probability of survival is known only as accurately as the tables.
static double find_excess(const struct work *w)
{
    double sum = 0;
    for (size_t i = 0; i < w->cells.node_count; i++) {
        double wi[3] = {(double)w->cells.nodes[i].wi[0], (double)w->cells.nodes[i].wi[1],
                        (double)w->cells.nodes[i].wi[2]};
        sum += (double)w->cells.nodes[i].weight *
               (density(&w->reference, wi) - density(&w->exact, wi));
    }
    return sum;
}

// Integrates the renderer's density with the nodes of the reference's cubature.
static bool integrate_shipped(struct bsdf_device *device, struct work *w,
                              const struct trial_params *params, struct trial *out)
{
    struct cell_integrals *cells = &w->cells;
    out->nodes = (uint32_t)cells->node_count;
    out->unresolved = (uint32_t)cells->unresolved;
    uint32_t count = out->nodes;
    for (uint32_t i = 0; i < count; i++) {
        fill_item(w, &w->items[i]);
        memcpy(w->items[i].in.wi, cells->nodes[i].wi, sizeof w->items[i].in.wi);
    }
    if (!bsdf_run(device, BSDF_ROUTINE_EVAL, BSDF_LOBES_CLASS, &w->configuration->material,
                  w->items, count))
        return false;
    for (uint32_t i = 0; i < count; i++) {
        const union bsdf_item *item = &w->items[i];
        bool good = isfinite(item->eval.pdf) && item->eval.pdf >= 0 && is_finite3(item->eval.f) &&
                    item->eval.f[0] >= 0 && item->eval.f[1] >= 0 && item->eval.f[2] >= 0;
        out->bad += !good;
        out->integral += (double)cells->nodes[i].weight * (double)item->eval.pdf;
    }
    if (w->exact.survival > 0)
        out->excess = find_excess(w);
    compare_items(w, false, count, params->compared, out);
    return true;
}

// --- samples -------------------------------------------------------------------------------------

// Finds a delta by direction and, because two lobes may have the same one, by weight.
static uint32_t nearest_delta(const struct work *w, const union bsdf_item *item, bool transmitted)
{
    double least = INFINITY;
    uint32_t nearest = CATEGORY_ABSORBED;
    for (int i = 0; i < w->delta_count; i++) {
        double square = 0;
        for (int c = 0; c < 3; c++) {
            double d = (double)item->sample.wi[c] - w->deltas[i].wi[c];
            double e = (double)item->sample.weight[c] - w->deltas[i].weight[c];
            square += d * d + e * e;
        }
        if (w->deltas[i].transmitted == transmitted && square < least) {
            least = square;
            nearest = CATEGORY_DELTA + (uint32_t)i;
        }
    }
    return nearest;
}

static uint32_t category_of(const struct work *w, const union bsdf_item *item)
{
    const float *wi = item->sample.wi;
    if (!(item->sample.flags & BSDF_VALID))
        return CATEGORY_ABSORBED;
    bool transmitted = item->sample.flags & BSDF_TRANSMITTED;
    if (item->sample.flags & BSDF_SPECULAR)
        return w->hides && transmitted ? CATEGORY_HIDDEN : nearest_delta(w, item, transmitted);
    double direction[3];
    chart_unit(wi, direction);
    uint32_t side = wi[2] < 0;
    return side * CHART_CELLS + chart_cell(&w->charts[side], direction);
}

// Returns the error relative to the greatest channel, so that black channels count, too.
static double delta_error(const struct work *w, uint32_t category, const union bsdf_item *item)
{
    if (category == CATEGORY_ABSORBED)
        return INFINITY; // a delta where there should be none
    const struct reference_delta *delta = &w->deltas[category - CATEGORY_DELTA];
    double worst = 0, greatest = 0;
    for (int c = 0; c < 3; c++) {
        worst = fmax(worst, fabs((double)item->sample.wi[c] - delta->wi[c]));
        greatest = fmax(greatest, delta->weight[c]);
    }
    for (int c = 0; c < 3 && greatest > 0; c++)
        worst = fmax(worst, fabs((double)item->sample.weight[c] - delta->weight[c]) / greatest);
    return worst;
}

// Compares weight and density with those that eval_bsdf() gives for the same direction.
static double weight_error(const union bsdf_item *item)
{
    double pdf = (double)item->sample.eval_pdf;
    double worst = fabs((double)item->sample.pdf - pdf) / pdf;
    for (int c = 0; c < 3; c++) {
        double expected = (double)item->sample.eval[c] / pdf;
        worst = fmax(worst, fabs((double)item->sample.weight[c] - expected) / (expected + 1e-6));
    }
    return worst;
}

static bool is_bad(const union bsdf_item *item)
{
    uint32_t flags = item->sample.flags;
    bool transmitted = flags & BSDF_TRANSMITTED;
    if (!is_finite3(item->sample.wi) || !is_finite3(item->sample.weight) ||
        !isfinite(item->sample.pdf) || item->sample.pdf < 0)
        return true;
    for (int c = 0; c < 3; c++)
        if (item->sample.weight[c] < 0)
            return true;
    if (!(flags & BSDF_VALID))
        return false;
    if (transmitted != (item->sample.wi[2] < 0))
        return true;
    return !(flags & BSDF_SPECULAR) && (!(item->sample.pdf > 0) || !(item->sample.eval_pdf > 0));
}

struct count_task {
    const struct work *w;
    uint32_t *category;
    double weight_error[PARALLEL_MAX_THREADS], delta_error[PARALLEL_MAX_THREADS];
    uint32_t bad[PARALLEL_MAX_THREADS];
};

static void count_range(void *context, size_t begin, size_t end, unsigned thread)
{
    struct count_task *t = context;
    const struct work *w = t->w;
    for (size_t i = begin; i < end; i++) {
        const union bsdf_item *item = &w->items[i];
        t->category[i] = CATEGORY_ABSORBED;
        if (is_bad(item)) {
            t->bad[thread]++;
            continue;
        }
        uint32_t flags = item->sample.flags, category = category_of(w, item);
        t->category[i] = category;
        if (flags & BSDF_SPECULAR) {
            if (category != CATEGORY_HIDDEN)
                t->delta_error[thread] =
                    fmax(t->delta_error[thread], delta_error(w, category, item));
        } else if (flags & BSDF_VALID) {
            t->weight_error[thread] = fmax(t->weight_error[thread], weight_error(item));
        }
    }
}

static void fill_uniforms(struct work *w, uint32_t count, uint64_t seed)
{
    struct random random = {seed};
    for (uint32_t i = 0; i < count; i++) {
        fill_item(w, &w->items[i]);
        for (int c = 0; c < 4; c++)
            w->items[i].in.u[c] = (float)(random_u32(&random) >> 8) * 0x1p-24f;
    }
}

static double *expected_counts(const struct work *w, uint32_t samples)
{
    double *expected = calloc(CATEGORIES, sizeof *expected), rest = 1;
    for (uint32_t i = 0; i < CELLS && expected; i++) {
        expected[i] = w->cells.expected[i] * samples;
        rest -= w->cells.expected[i];
    }
    if (expected)
        expected[CATEGORY_HIDDEN] = w->hidden.total * samples;
    rest -= w->hidden.total;
    for (int i = 0; i < w->delta_count && expected; i++) {
        expected[CATEGORY_DELTA + i] = w->deltas[i].probability * samples;
        rest -= w->deltas[i].probability;
    }
    // Errors of the cubature must neither make absorbed samples impossible, nor make absorption
    // possible if there is none.
    if (expected)
        expected[CATEGORY_ABSORBED] = fmax(rest, 1e-9) * samples;
    return expected;
}

// Returns the fraction of samples at which the reference has no density. Only cells that are empty
// in the cubature are examined.
static double count_impossible(const struct work *w, const double *expected,
                               const uint32_t *category, uint32_t samples)
{
    uint32_t impossible = 0;
    for (uint32_t i = 0; i < samples; i++) {
        const float *wi = w->items[i].sample.wi;
        double direction[3] = {(double)wi[0], (double)wi[1], (double)wi[2]};
        if (!(expected[category[i]] > 0))
            impossible += category[i] >= CELLS || !(density(&w->reference, direction) > 0);
    }
    return (double)impossible / samples;
}

// Tests in cells of 5 x 10, because small errors over large regions are more significant in few
// cells.
static double coarse_p(const double *expected, const uint32_t *count)
{
    enum { ROWS = 5, COLUMNS = 10, A_ROW = CHART_COLUMNS / COLUMNS };
    enum { COARSE = CELLS / ROWS / COLUMNS, ALL = COARSE + CATEGORIES - CELLS };
    double coarse[ALL] = {0};
    uint32_t counts[ALL] = {0};
    for (uint32_t i = 0; i < CATEGORIES; i++) {
        uint32_t row = i / CHART_COLUMNS, column = i % CHART_COLUMNS;
        uint32_t at = i < CELLS ? row / ROWS * A_ROW + column / COLUMNS : COARSE + i - CELLS;
        coarse[at] += expected[i];
        counts[at] += count[i];
    }
    return pearson_test(coarse, counts, ALL).p;
}

static bool count_samples(struct bsdf_device *device, struct work *w,
                          const struct trial_params *params, struct trial *out)
{
    fill_uniforms(w, params->samples, w->material);
    if (!bsdf_run(device, BSDF_ROUTINE_SAMPLE, BSDF_LOBES_CLASS, &w->configuration->material,
                  w->items, params->samples))
        return false;
    static struct count_task task;
    task = (struct count_task){.w = w};
    task.category = malloc(params->samples * sizeof *task.category);
    uint32_t *count = calloc(CATEGORIES, sizeof *count);
    double *expected = expected_counts(w, params->samples);
    if (task.category && count && expected) {
        parallel_for(params->samples, 4096, 0, count_range, &task);
        for (uint32_t i = 0; i < params->samples; i++)
            count[task.category[i]]++;
        struct pearson pearson = pearson_test(expected, count, CATEGORIES);
        out->chi_p = fmin(pearson.p, coarse_p(expected, count));
        out->chi_degrees = pearson.degrees;
        out->impossible = count_impossible(w, expected, task.category, params->samples);
    }
    for (int i = 0; i < PARALLEL_MAX_THREADS; i++) {
        out->weight_error = fmax(out->weight_error, task.weight_error[i]);
        out->delta_error = fmax(out->delta_error, task.delta_error[i]);
        out->bad += task.bad[i];
    }
    compare_items(w, true, params->samples, params->compared, out);
    bool ok = task.category && count && expected;
    free(task.category);
    free(count);
    free(expected);
    return ok;
}

static bool measure_means(struct bsdf_device *device, const struct work *w,
                          const struct trial_params *params, struct trial *out)
{
    struct bsdf_means means;
    if (!bsdf_measure(device, w->configuration, w->material - 1, params->replicates,
                      params->replicate_samples, &means))
        return false;
    out->absorbed = means.absorbed;
    out->closure_error = means.absorbed_error;
    memcpy(out->albedo, means.albedo, sizeof out->albedo);
    memcpy(out->albedo_error, means.albedo_error, sizeof out->albedo_error);
    return true;
}

// --- a trial -------------------------------------------------------------------------------------

static bool integrate_hidden(struct work *w)
{
    struct chart charts[SIDES] = {w->charts[0], w->charts[1]};
    if (!w->hides)
        return true;
    charts[0].kind = CHART_NORMALS;
    charts[1].kind = CHART_SPHERE; // below the surface there are no normals
    return cells_integrate(charts, hidden_density, &w->exact, &w->hidden);
}

// Returns by how much rounding changes the slope of a half-vector, in units of the narrowest lobe's
// width: directions have errors of 2^-24, which half-vectors magnify by at most 1 / c for a cosine
// c.
static double find_resolution(const struct work *w)
{
    double narrowest = 1;
    const struct chart *chart = &w->charts[0];
    for (int i = 0; i < chart->lobes; i++)
        for (int k = 0; k < 2; k++)
            if (chart->alpha[i][k] > SMALLEST_SCALE * 0.99)
                narrowest = fmin(narrowest, chart->alpha[i][k]);
    bool has_half_vector = chart->kind != CHART_SPHERE || narrowest < 1;
    return has_half_vector ? 0x1p-24 / (narrowest * chart->wo[2]) : 0;
}

static bool prepare(struct work *w, struct trial *out)
{
    const struct configuration *c = w->configuration;
    if (!reference_init(&w->reference, &c->material, c->choices, c->wo, c->eta))
        return false;
    w->exact = w->reference;
    chart_unit(c->wo, w->exact.wo);
    w->hides = reference_hides_refraction(&w->reference);
    w->delta_count = reference_deltas(&w->reference, w->deltas);
    grid_charts(c, w->charts);
    // Nothing narrow remains below the surface.
    if (w->hides)
        w->charts[1].kind = CHART_SPHERE;
    if (w->reference.survival > 0)
        w->exact.survival = reference_true_survival(&w->exact);
    if (!cells_integrate(w->charts, density, &w->exact, &w->cells) || !integrate_hidden(w))
        return false;
    out->resolution = find_resolution(w);
    out->reference_integral = w->cells.total;
    out->delta_probability = w->hidden.total;
    for (int i = 0; i < w->delta_count; i++)
        out->delta_probability += w->deltas[i].probability;
    return true;
}

bool trial_run(struct bsdf_device *device, const struct configuration *configuration,
               uint32_t number, const struct trial_params *params, struct trial *out)
{
    struct work *w = calloc(1, sizeof *w);
    *out = (struct trial){0};
    if (!w)
        return false;
    w->configuration = configuration;
    w->material = number + 1;
    bool ok = prepare(w, out);
    size_t count = w->cells.node_count;
    count = count > params->samples ? count : params->samples;
    count = count > params->replicate_samples ? count : params->replicate_samples;
    w->items = ok ? malloc(count * sizeof *w->items) : NULL;
    ok = w->items && integrate_shipped(device, w, params, out) &&
         count_samples(device, w, params, out) && measure_means(device, w, params, out);
    out->closure = fabs(out->integral - out->excess + out->delta_probability + out->absorbed - 1);
    free(w->items);
    cells_finish(&w->cells);
    cells_finish(&w->hidden);
    reference_finish(&w->reference);
    free(w);
    return ok;
}

void trial_check(const struct configuration *configuration, const struct trial_params *params,
                 const struct trial *t)
{
    const char *name = configuration->name;
    CHECK(t->bad == 0, "%s: %u values not finite, negative or without density", name, t->bad);
    CHECK(t->chi_p >= params->significance, "%s: chi-square with %u degrees: p = %.3g", name,
          t->chi_degrees, t->chi_p);
    CHECK(t->impossible <= 1e-5, "%s: %.3g of the samples where there is no density", name,
          t->impossible);
    // Such errors of the slopes change the integral of a density by its curvature times their
    // variance.
    double blur = t->resolution * t->resolution / 4;
    // If masked samples are drawn again, the density decreases to 0 within about wo.z of the
    // horizon, which the cubature cannot resolve at grazing angles.
    double unseen = t->excess != 0 && configuration->angle >= 89.9 ? 3e-4 : 0;
    CHECK(t->closure <= 1e-4 + 4 * t->closure_error + blur + unseen || t->resolution > 0.5,
          "%s: density %.6f + deltas %.6f + absorbed %.6f (+- %.1g) = 1 + %.2g (reference %.6f)",
          name, t->integral, t->delta_probability, t->absorbed, t->closure_error,
          t->integral + t->delta_probability + t->absorbed - 1, t->reference_integral);
    CHECK(t->weight_error <= 1e-4, "%s: weight and f / pdf differ by %.3g", name, t->weight_error);
    CHECK(t->reference_error <= tolerance(configuration) || t->resolution > 0.5,
          "%s: %.3g from the reference: %s", name, t->reference_error, t->worst);
    CHECK(t->delta_error <= 1e-4, "%s: a delta differs by %.3g", name, t->delta_error);
    for (int c = 0; c < 3 && !grid_gains(configuration); c++)
        CHECK(t->albedo[c] <= 1.001 + 3 * t->albedo_error[c], "%s: albedo %.5f +- %.5f", name,
              t->albedo[c], t->albedo_error[c]);
}
