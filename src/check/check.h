// Whether a device and its driver do what the renderer needs of them: cases whose results are
// known, in one table (case_list.h), which `lampyris check` runs and the tests, too.
#ifndef LAMPYRIS_CHECK_CHECK_H
#define LAMPYRIS_CHECK_CHECK_H

#include "gpu/gpu.h"
#include "render/render.h"
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

// What cases are run on, and how.
struct check {
    struct gpu *gpu;
    bool longer;         // with the samples of the long suite
    struct arena *arena; // of pictures; NULL: none are kept
    const struct progress *progress;
};

enum check_outcome { CHECK_NOT_RUN, CHECK_PASSED, CHECK_FAILED };
extern const char *const check_outcome_names[]; // "not run", "pass", "FAIL"

#define CHECK_TEXT_MAX 240

// Rows from the top, linear.
struct check_picture {
    uint32_t width, height;
    float (*pixels)[3]; // of the check's arena; NULL: there is none
};

struct check_result {
    enum check_outcome outcome;
    char expected[CHECK_TEXT_MAX]; // the value; "": the case's own words say it
    char seen[CHECK_TEXT_MAX];
    char why[512]; // it failed, or was not run
    bool is_lost;  // the device was lost meanwhile: the case was not run
    struct check_picture picture;
    double seconds;
};

struct check_case {
    // What is done: "B3 glowing sphere, 9 bounces", after the number of docs/verification.md.
    const char *name;
    const char *expected; // in words or as a formula
    // Fills in the outcome and what goes with it. False: an error of the device, or ERR_STOPPED.
    bool (*run)(const struct check *check, const struct check_case *this_case,
                struct check_result *result, struct err *err);
    const void *data; // of `run`
    bool is_long;     // left out unless asked for
};

struct check_group {
    const char *name;
    const char *about; // what its cases have in common
    const struct check_case *cases;
    size_t count;
};

// Runs the case and takes its time. An error of the device is a failure of the case, which says so;
// where the device is lost, the case was not run.
// False: err is ERR_STOPPED.
bool check_run(const struct check *check, const struct check_case *this_case,
               struct check_result *result, struct err *err);

// What a case says of itself. Each returns true.
bool check_seen(struct check_result *result, bool passed, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
bool check_not_run(struct check_result *result, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

// Keeps what the renderer has as the result's picture, where pictures are wanted.
bool check_keep_picture(const struct check *check, struct renderer *renderer,
                        struct check_result *result, struct err *err);

#endif
