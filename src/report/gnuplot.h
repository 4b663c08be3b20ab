// Makes plots with gnuplot, if it is installed.
#ifndef LAMPYRIS_REPORT_GNUPLOT_H
#define LAMPYRIS_REPORT_GNUPLOT_H

#include "base/arena.h"
#include "base/err.h"

// Runs a gnuplot script, which must set a terminal without a file name, and returns the output as
// zero-terminated text in `arena`. Fails with ERR_SYSTEM if gnuplot is not installed or reports an
// error.
bool gnuplot_run(const char *script, struct arena *arena, char **out, struct err *err);

#endif
