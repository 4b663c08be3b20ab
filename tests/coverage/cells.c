#include "cells.h"

#include "metrics/metrics.h"
#include "shares.h"
#include <math.h>
#include <stdlib.h>

static const double asked = 0.95;
static const double unknown_most = 0.05;

// Prints a share in per cent, or a dash if there are no cases. Returns whether it is large enough.
static bool print_share(uint32_t part, uint32_t all, double least)
{
    bool fails = share_is_too_small(part, all, least);
    const char *mark = fails ? "**" : "";
    if (all == 0)
        printf(" - |");
    else
        printf(" %s%.1f%s |", mark, 100.0 * part / all, mark);
    return !fails;
}

static int compare(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static double find_median(double *values, uint32_t count)
{
    qsort(values, count, sizeof *values, compare);
    return (values[(count - 1) / 2] + values[count / 2]) / 2;
}

static bool print_shares(const struct cell *cell)
{
    print_share(cell->intervals, cell->seeds, 0);
    bool ok = print_share(cell->intervals_held, cell->intervals, asked);
    print_share(cell->alone, cell->seeds, 0);
    ok = print_share(cell->alone_held, cell->alone, asked) && ok;
    return print_share(cell->bounds_held, cell->bounds, asked) && ok;
}

static bool print_last_shares(const struct cell *cell)
{
    uint32_t unknown = cell->seeds - cell->intervals - cell->alone;
    bool unknown_ok = !share_is_too_small(cell->seeds - unknown, cell->seeds, 1 - unknown_most);
    const char *mark = unknown_ok ? "" : "**";
    printf(" %s%.1f%s |", mark, 100.0 * unknown / cell->seeds, mark);
    bool ok = print_share(cell->relmse_held, cell->bounds, asked) && unknown_ok;
    printf("\n");
    fflush(stdout);
    return ok;
}

void cells_print_head(void)
{
    printf("| scene | side | seeds | samples | local relMSE | told / true | interval told, %% "
           "| holds, %% | bound alone, %% | holds, %% | any bound holds, %% | bound / true "
           "| not known, %% | relMSE's bound holds, %% |\n"
           "|---|---|---|---|---|---|---|---|---|---|---|---|---|---|\n");
}

bool cells_print(const struct subject *subject, const struct plan *plan, uint32_t level,
                 struct cell *cell)
{
    printf("| %s | %u | %u | %u | %.3g |", subject->name, plan->side, plan->seeds,
           plan->samples[level], cell->truth / cell->seeds);
    if (cell->intervals)
        printf(" %.2f |", cell->told_of_intervals / cell->truth_of_intervals);
    else
        printf(" - |");
    bool ok = print_shares(cell);
    if (cell->bounds)
        printf(" %.3g |", find_median(cell->bound_ratios, cell->bounds));
    else
        printf(" - |");
    return print_last_shares(cell) && ok;
}

void cells_add(struct cell *total, const struct cell *cell)
{
    total->seeds += cell->seeds;
    total->intervals += cell->intervals;
    total->intervals_held += cell->intervals_held;
    total->bounds += cell->bounds;
    total->bounds_held += cell->bounds_held;
    total->alone += cell->alone;
    total->alone_held += cell->alone_held;
    total->relmse_held += cell->relmse_held;
    total->control_held += cell->control_held;
}

bool cells_print_total(const struct cell *total)
{
    printf("| all | | %u | | | |", total->seeds);
    bool ok = print_shares(total);
    printf(" |");
    return print_last_shares(total) && ok;
}

bool cells_control_fails(const struct cell *total)
{
    return share_is_too_small(total->control_held, total->intervals, asked);
}

void cells_finish(struct cell *cells, uint32_t count)
{
    for (uint32_t i = 0; i < count; i++)
        free(cells[i].bound_ratios);
}
