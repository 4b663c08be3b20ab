// Checks whether a device and its driver fulfil the renderer's requirements: cases whose results
// are known, in one table (case_list.h), which `lampyris check` and the tests run.
#ifndef LAMPYRIS_CHECK_CHECK_H
#define LAMPYRIS_CHECK_CHECK_H

#include "gpu/gpu.h"
#include "render/render.h"
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

// The device on which cases are run, and options.
struct check {
    struct gpu *gpu;
    bool longer;         // with the samples of the long suite
    struct arena *arena; // holds images; NULL: none are kept
    const struct progress *progress;
};

enum check_outcome { CHECK_NOT_RUN, CHECK_PASSED, CHECK_FAILED };
extern const char *const check_outcome_names[]; // "not run", "pass", "FAIL"

#define CHECK_TEXT_MAX 240

// Rows from the top, linear values.
struct check_picture {
    uint32_t width, height;
    float (*pixels)[3]; // in the check's arena; NULL: there is no image
};

struct check_result {
    enum check_outcome outcome;
    char expected[CHECK_TEXT_MAX]; // expected value; "": the case's own text states it
    char seen[CHECK_TEXT_MAX];
    char why[512]; // why it failed, or was not run
    bool is_lost;  // the device was lost: the case was not run
    struct check_picture picture;
    double seconds;
};

struct check_case {
    // A short title after the number of docs/verification.md: "B3 glowing sphere, 9 bounces".
    const char *name;
    const char *expected; // in words or as a formula
    // Sets the outcome and the texts. Returns false for an error of the device, or ERR_STOPPED.
    bool (*run)(const struct check *check, const struct check_case *this_case,
                struct check_result *result, struct err *err);
    const void *data; // parameter of `run`
    bool is_long;     // is run only on request
};

struct check_group {
    const char *name;
    const char *about; // what its cases have in common
    const struct check_case *cases;
    size_t count;
};

// Runs the case and measures its time. An error of the device makes the case fail, with the message
// as the reason; if the device is lost, the case was not run. Returns false only when stopped: err
// is ERR_STOPPED.
bool check_run(const struct check *check, const struct check_case *this_case,
               struct check_result *result, struct err *err);

// Set the outcome of a case. Each returns true.
bool check_seen(struct check_result *result, bool passed, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
bool check_not_run(struct check_result *result, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

// Keeps the renderer's image as the result's picture, if pictures are wanted.
bool check_keep_picture(const struct check *check, struct renderer *renderer,
                        struct check_result *result, struct err *err);

#endif
