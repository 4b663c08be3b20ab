// Functions that the text report and the JSON report share.
#ifndef LAMPYRIS_CLI_RENDER_RENDER_REPORT_H
#define LAMPYRIS_CLI_RENDER_RENDER_REPORT_H

#include "cli/render/render_run.h"
#include "render/parts.h"
#include <jansson.h>

// Prints a line with the times of all kernels. The summary has only the slowest kernels.
void report_print_kernels(const struct render_stats *stats);
// Prints a line with the times of all steps. The summary has only the longest steps.
void report_print_steps(const struct render_run *run);

extern const char *const report_class_names[CLASS_COUNT];

// --- render_json.c ---
json_t *render_frame_json(const struct render_frame *frame);

// --- render_explain.c ---
// Prints "left out 41 of 63 features, 7 of 14 kernels, 5.5 MiB; --explain lists them".
void explain_print_line(const struct renderer *r);
// Prints, for --explain, which parts are left out, why, and what that saves. Also prints details
// that the summary omits.
void explain_print(struct render_run *run);
// Returns why a part is left out, and what that saves.
json_t *explain_json(const struct renderer *r, const struct part *part);

#endif
