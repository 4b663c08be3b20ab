// Makes plots with gnuplot, if it is installed.
#ifndef LAMPYRIS_REPORT_GNUPLOT_H
#define LAMPYRIS_REPORT_GNUPLOT_H

#include "base/arena.h"
#include "base/err.h"

// Returns the output of gnuplot for `script`, which must set a terminal without a file name:
// zero-terminated text in `arena`. ERR_SYSTEM if gnuplot is not installed or fails.
bool gnuplot_run(const char *script, struct arena *arena, char **out, struct err *err);

#endif
