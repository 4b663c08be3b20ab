#include "bsdf_cells.h"

#include "base/parallel.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

// The two rules must agree within this fraction of the integral, or within this fraction of the
// whole sphere's 1.
#define RELATIVE_TOLERANCE 2e-3
#define ABSOLUTE_TOLERANCE 1e-8
#define MAX_DEPTH 9
// Down to this depth, parts that may contain narrow details are divided in any case.
#define DETAIL_DEPTH 6
#define CUT_DEPTH 4

// Nodes and weights of the Gauss-Legendre rules on [0, 1] (DLMF 3.5, table 3.5.1).
static const double node2[2] = {0.21132486540518712, 0.78867513459481288};
static const double node3[3] = {0.11270166537925831, 0.5, 0.88729833462074169};
static const double weight3[3] = {5.0 / 18, 8.0 / 18, 5.0 / 18};

// The results of one thread.
struct gathered {
    struct cell_node *nodes;
    size_t count, capacity, unresolved;
    bool out_of_memory;
};

struct task {
    const struct chart *charts;
    density_fn density;
    const void *context;
    double *expected;
    struct gathered *threads;
};

struct part {
    double x0, x1, phi0, phi1;
    int depth;
};

static void keep_node(struct gathered *g, const double wi[3], double weight)
{
    if (g->count == g->capacity) {
        size_t capacity = g->capacity ? 2 * g->capacity : 1 << 14;
        struct cell_node *nodes = realloc(g->nodes, capacity * sizeof *nodes);
        if (!nodes) {
            g->out_of_memory = true;
            return;
        }
        g->nodes = nodes;
        g->capacity = capacity;
    }
    g->nodes[g->count++] =
        (struct cell_node){{(float)wi[0], (float)wi[1], (float)wi[2]}, (float)weight};
}

// Evaluates the density at fractions of the part, whose rows end at the horizon. `wi` and
// `solid_angle` may be NULL.
static double look(const struct task *t, const struct chart *chart, const struct part *p,
                   double row, double column, double wi[3], double *solid_angle)
{
    double phi = p->phi0 + column * (p->phi1 - p->phi0);
    double end = fmin(p->x1, chart_end(chart, phi));
    *solid_angle = 0;
    if (!(end > p->x0))
        return 0;
    double jacobian, x = p->x0 + row * (end - p->x0);
    if (!chart_direction(chart, x, phi, wi, &jacobian))
        return 0;
    *solid_angle = jacobian * (end - p->x0) * (p->phi1 - p->phi0);
    return t->density(t->context, wi) * *solid_angle;
}

// Returns whether refraction is possible at some corners of the part but not at others.
static bool is_cut(const struct chart *chart, const struct part *p)
{
    int inside = 0;
    if (chart->kind != CHART_REFRACT || p->depth >= CUT_DEPTH)
        return false;
    for (int i = 0; i < 9; i++) {
        double wi[3], jacobian;
        double x = fmin(p->x0 + 0.5 * (i % 3) * (p->x1 - p->x0), 1 - 1e-9);
        double phi = p->phi0 + 0.5 * (i / 3) * (p->phi1 - p->phi0);
        inside += chart_direction(chart, fmax(x, 1e-9), phi, wi, &jacobian);
    }
    return inside > 0 && inside < 9;
}

// Returns whether the part is too large for the rules: if the horizon crosses it steeply, or if
// Fresnel's reflectance decreases within it from 1 to almost 0.
static bool hides_detail(const struct chart *chart, const struct part *p)
{
    if (p->depth >= DETAIL_DEPTH)
        return false;
    if (is_cut(chart, p))
        return true;
    double end[3], least_end = 1, most_end = 0, least = 1, most = 0;
    for (int i = 0; i < 3; i++) {
        double phi = p->phi0 + 0.5 * i * (p->phi1 - p->phi0);
        end[i] = fmin(fmax(chart_end(chart, phi), p->x0), p->x1);
        least_end = fmin(least_end, end[i]);
        most_end = fmax(most_end, end[i]);
    }
    if (most_end - least_end > 0.25 * (p->x1 - p->x0) || (least_end <= p->x0 && most_end > p->x0))
        return true;
    double scale = chart_fresnel_scale(chart);
    if (scale >= 0.5 || most_end <= p->x0)
        return false;
    for (int i = 0; i < 4; i++) {
        double c = chart_cosine(chart, i & 1 ? most_end : p->x0, i & 2 ? p->phi1 : p->phi0);
        least = fmin(least, c);
        most = fmax(most, c);
    }
    return most > 0 && least < 3 * scale && most - fmax(least, 0) > 0.5 * scale;
}

static double integrate(const struct task *t, const struct chart *chart, const struct part *p,
                        struct gathered *g)
{
    double wi[9][3], angle[9], unused[3], unused_angle, fine = 0, coarse = 0;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            int k = 3 * i + j;
            fine +=
                weight3[i] * weight3[j] * look(t, chart, p, node3[i], node3[j], wi[k], &angle[k]);
        }
    for (int i = 0; i < 2; i++)
        for (int j = 0; j < 2; j++)
            coarse += look(t, chart, p, node2[i], node2[j], unused, &unused_angle) / 4;
    double tolerance = fmax(RELATIVE_TOLERANCE * fine, ABSOLUTE_TOLERANCE);
    bool agree = fabs(fine - coarse) <= tolerance;
    agree = agree && !hides_detail(chart, p);
    if (agree || p->depth == MAX_DEPTH) {
        g->unresolved += !agree;
        // A single node suffices to notice a density where there should be none.
        if (fine == 0 && angle[4] > 0)
            keep_node(g, wi[4], angle[4]);
        for (int k = 0; k < 9 && fine > 0; k++)
            if (angle[k] > 0)
                keep_node(g, wi[k], weight3[k / 3] * weight3[k % 3] * angle[k]);
        return fine;
    }
    double x = 0.5 * (p->x0 + p->x1), phi = 0.5 * (p->phi0 + p->phi1), sum = 0;
    for (int i = 0; i < 4; i++) {
        struct part quarter = {i & 1 ? x : p->x0, i & 1 ? p->x1 : x, i & 2 ? phi : p->phi0,
                               i & 2 ? p->phi1 : phi, p->depth + 1};
        sum += integrate(t, chart, &quarter, g);
    }
    return sum;
}

static void integrate_cells(void *context, size_t begin, size_t end, unsigned thread)
{
    const struct task *t = context;
    for (size_t cell = begin; cell < end; cell++) {
        const struct chart *chart = &t->charts[cell / CHART_CELLS];
        double row = (double)(cell % CHART_CELLS / CHART_COLUMNS);
        double column = (double)(cell % CHART_COLUMNS);
        struct part part = {row / CHART_ROWS, (row + 1) / CHART_ROWS,
                            column / CHART_COLUMNS * 2 * M_PI,
                            (column + 1) / CHART_COLUMNS * 2 * M_PI, 0};
        t->expected[cell] = integrate(t, chart, &part, &t->threads[thread]);
    }
}

bool cells_integrate(const struct chart charts[SIDES], density_fn density, const void *context,
                     struct cell_integrals *out)
{
    struct gathered *threads = calloc(PARALLEL_MAX_THREADS, sizeof *threads);
    *out = (struct cell_integrals){0};
    if (!threads)
        return false;
    struct task task = {charts, density, context, out->expected, threads};
    parallel_for(CELLS, 32, 0, integrate_cells, &task);
    bool ok = true;
    for (int i = 0; i < PARALLEL_MAX_THREADS; i++) {
        out->node_count += threads[i].count;
        out->unresolved += threads[i].unresolved;
        ok = ok && !threads[i].out_of_memory;
    }
    out->nodes = malloc(out->node_count * sizeof *out->nodes + 1);
    ok = ok && out->nodes;
    size_t at = 0;
    for (int i = 0; i < PARALLEL_MAX_THREADS; i++) {
        if (ok && threads[i].count > 0)
            memcpy(out->nodes + at, threads[i].nodes, threads[i].count * sizeof *out->nodes);
        at += threads[i].count;
        free(threads[i].nodes);
    }
    free(threads);
    for (int i = 0; i < CELLS; i++)
        out->total += out->expected[i];
    return ok;
}

void cells_finish(struct cell_integrals *integrals)
{
    free(integrals->nodes);
    integrals->nodes = NULL;
}
