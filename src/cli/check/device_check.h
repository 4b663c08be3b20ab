// `lampyris check` without a scene: the selected cases, their results and the reports.
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
    struct arena arena; // owns the rows and the images
    struct check_row *rows;
    size_t count;      // number of selected cases
    size_t done;       // number of finished cases; less than `count` if a signal ended the run
    uint32_t reopened; // number of times that the device was reopened to repeat a case
    double seconds;
};

size_t device_check_outcomes(const struct device_check *d, enum check_outcome outcome);

// check_device_print.c: prints the table of --list, the line of a finished case, and the lines at
// the end.
void device_check_print_list(const struct device_check *d);
void device_check_print_row(const struct device_check *d, size_t row);
void device_check_print_end(const struct device_check *d);
// Returns an object as docs/check.schema.json describes it; for --list without results.
json_t *device_check_json(const struct device_check *d);

// check_device_html.c: writes the page of --report.
bool device_check_report(struct device_check *d, struct err *err);

#endif
