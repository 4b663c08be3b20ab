// Reported intervals compared with true errors: counts over the seeds of one scene at one size and
// sample count, and the table that they make.
#ifndef LAMPYRIS_TESTS_COVERAGE_CELLS_H
#define LAMPYRIS_TESTS_COVERAGE_CELLS_H

#include "pictures.h"

struct cell {
    uint32_t seeds;
    uint32_t intervals, intervals_held;
    uint32_t bounds, bounds_held; // wherever there is one
    uint32_t alone, alone_held;   // where there is a bound and no interval
    uint32_t relmse_held;         // bounds of the classic relMSE that hold, among `bounds`
    uint32_t control_held;        // those among `intervals`
    double truth, truth_of_intervals, told_of_intervals; // sums
    double *bound_ratios;                                // bound / true, of `bounds`
};

// One for each sample count. The truth is the mean of all other seeds' pictures with the most
// samples; what its own noise adds is subtracted. `misses`: says on stderr what did not hold.
bool cells_judge(const struct subject *subject, const struct pictures *pictures, bool misses,
                 struct cell *cells, struct err *err);
void cells_finish(struct cell *cells, uint32_t count);

void cells_print_head(void);
// A row of Markdown. False where less holds than is asked for; what does not is printed bold.
bool cells_print(const struct subject *subject, const struct plan *plan, uint32_t level,
                 struct cell *cell);
void cells_add(struct cell *total, const struct cell *cell);
bool cells_print_total(const struct cell *total);
// Returns whether so few intervals of the control hold as happens to correct ones in one case of a
// thousand.
bool cells_control_fails(const struct cell *total);

#endif
