// Reported intervals compared with true errors: counts over the seeds of one scene at one size and
// sample count, and the table that they make.
#ifndef LAMPYRIS_TESTS_COVERAGE_CELLS_H
#define LAMPYRIS_TESTS_COVERAGE_CELLS_H

#include "pictures.h"

struct cell {
    uint32_t seeds;
    uint32_t intervals, intervals_held;
    uint32_t bounds, bounds_held; // results with a bound
    uint32_t alone, alone_held;   // results with a bound but without an interval
    uint32_t relmse_held;         // valid bounds of relMSE, among `bounds`
    uint32_t control_held;        // valid intervals of the control, among `intervals`
    double truth, truth_of_intervals, told_of_intervals; // sums
    double *bound_ratios;                                // bound / true, of `bounds`
};

// Judges each number of samples. The truth is the mean of all other seeds' pictures with the most
// samples; the contribution of its own noise is subtracted. `misses`: prints on stderr the results
// that were not valid.
bool cells_judge(const struct subject *subject, const struct pictures *pictures, bool misses,
                 struct cell *cells, struct err *err);
void cells_finish(struct cell *cells, uint32_t count);

void cells_print_head(void);
// Prints a row in Markdown. Returns false if a share is smaller than required; such shares are
// bold.
bool cells_print(const struct subject *subject, const struct plan *plan, uint32_t level,
                 struct cell *cell);
void cells_add(struct cell *total, const struct cell *cell);
bool cells_print_total(const struct cell *total);
// Returns whether the control has so few valid intervals as correct intervals have in one case of a
// thousand.
bool cells_control_fails(const struct cell *total);

#endif
