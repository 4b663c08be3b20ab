// Plots by gnuplot, where it is installed.
#ifndef LAMPYRIS_APP_GNUPLOT_H
#define LAMPYRIS_APP_GNUPLOT_H

#include "err.h"

// Writes `script` to PATH.gp and what gnuplot prints of it to PATH.svg, so that the plot can be
// made again. ERR_SYSTEM where gnuplot is not there or fails.
bool gnuplot_run(const char *script, const char *path, struct err *err);

#endif
