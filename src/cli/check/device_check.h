// `lampyris check` without a scene: the cases, their results, and the reports.
#ifndef LAMPYRIS_CLI_CHECK_DEVICE_CHECK_H
#define LAMPYRIS_CLI_CHECK_DEVICE_CHECK_H

#include "base/arena.h"
#include "check/case_list.h"
#include "gpu/gpu.h"
#include <jansson.h>

struct options;

struct check_row {
    const struct check_group *group;
    const struct check_case *this_case;
    struct check_result result;
};

struct device_check {
    const struct options *options;
    struct gpu gpu;
    struct arena arena; // holds the rows and the images
    struct check_row *rows;
    size_t count;      // number of selected cases
    size_t done;       // number of finished cases: fewer if a signal has ended the run
    uint32_t reopened; // how often a case was repeated on a reopened device
    double seconds;
};

size_t device_check_outcomes(const struct device_check *d, enum check_outcome outcome);

// check_device_print.c: the table of --list; the line of a finished case; the lines at the end.
void device_check_print_list(const struct device_check *d);
void device_check_print_row(const struct device_check *d, size_t row);
void device_check_print_end(const struct device_check *d);
// docs/check.schema.json; for --list without results.
json_t *device_check_json(const struct device_check *d);

// check_device_html.c: --report
bool device_check_report(struct device_check *d, struct err *err);

#endif
