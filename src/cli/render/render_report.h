// Functions that the reports for people and for machines share.
#ifndef LAMPYRIS_CLI_RENDER_RENDER_REPORT_H
#define LAMPYRIS_CLI_RENDER_RENDER_REPORT_H

#include "cli/render/render_run.h"
#include "render/parts.h"
#include <jansson.h>

// A line of the times of all kernels, and one of those of all steps: the summary names the largest.
void report_print_kernels(const struct render_stats *stats);
void report_print_steps(const struct render_run *run);

extern const char *const report_class_names[CLASS_COUNT];

// --- render_explain.c ---
// "left out  41 of 63 features, 7 of 14 kernels, 5.5 MiB; --explain lists them".
void explain_print_line(const struct renderer *r);
// --explain: which parts are left out, why, and what that saves; and what the summary has no room
// for.
void explain_print(struct render_run *run);
// Says of one part that is left out why that is so, and what it saves.
json_t *explain_json(const struct renderer *r, const struct part *part);

#endif
