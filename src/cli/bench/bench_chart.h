// Charts for a scene's variants.
#ifndef LAMPYRIS_CLI_BENCH_BENCH_CHART_H
#define LAMPYRIS_CLI_BENCH_BENCH_CHART_H

#include "cli/bench/bench.h"
#include "report/html.h"

// Adds the charts: kernels' times, one bar per variant; the wave's occupancy by bounce; and, if one
// number was swept, the frame's time against it.
bool bench_put_charts(struct html_page *page, const struct bench *b,
                      const struct bench_variant *first, uint32_t count, struct err *err);

#endif
