// Charts of the variants of a scene.
#ifndef LAMPYRIS_CLI_BENCH_BENCH_CHART_H
#define LAMPYRIS_CLI_BENCH_BENCH_CHART_H

#include "cli/bench/bench.h"
#include "report/html.h"

// Adds the charts: the time of kernels with one bar per variant; the occupancy of waves by bounce;
// if a single number varies, the time of a frame as a function of it; and, with --kernel, the items
// per second as a function of the depth.
bool bench_put_charts(struct html_page *page, const struct bench *b,
                      const struct bench_variant *first, uint32_t count, struct err *err);

#endif
