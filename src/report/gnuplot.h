// Plots by gnuplot, where it is installed.
#ifndef LAMPYRIS_REPORT_GNUPLOT_H
#define LAMPYRIS_REPORT_GNUPLOT_H

#include "base/arena.h"
#include "base/err.h"

// What gnuplot prints for `script`, which is to set a terminal without a file name: zero-terminated
// text in `arena`. ERR_SYSTEM where gnuplot is not there or fails.
bool gnuplot_run(const char *script, struct arena *arena, char **out, struct err *err);

#endif
