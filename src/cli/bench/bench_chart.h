// Charts of a scene's variants.
#ifndef LAMPYRIS_CLI_BENCH_BENCH_CHART_H
#define LAMPYRIS_CLI_BENCH_BENCH_CHART_H

#include "cli/bench/bench.h"
#include "report/html.h"

// Kernels' times, one bar a variant; how full the wave is by bounce; and where one number was
// swept, the frame's time against it.
bool bench_put_charts(struct html_page *page, const struct bench *b,
                      const struct bench_variant *first, uint32_t count, struct err *err);

#endif
