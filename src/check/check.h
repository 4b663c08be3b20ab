// Checks whether a device and its driver fulfil the renderer's requirements. All cases, whose
// results are known, are in one table (case_list.h), which `lampyris check` and the tests run.
#ifndef LAMPYRIS_CHECK_CHECK_H
#define LAMPYRIS_CHECK_CHECK_H

#include "gpu/gpu.h"
#include "render/render.h"
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

// The device on which cases run, and how to run them.
struct check {
    struct gpu *gpu;
    bool longer;         // renders as many samples as the long test suite
    struct arena *arena; // owns the images of the results; NULL: images are not kept
    const struct progress *progress;
};

enum check_outcome { CHECK_NOT_RUN, CHECK_PASSED, CHECK_FAILED };
extern const char *const check_outcome_names[]; // "not run", "pass", "FAIL"

#define CHECK_TEXT_MAX 240

// An image with linear values; rows from the top.
struct check_picture {
    uint32_t width, height;
    float (*pixels)[3]; // owned by the check's arena; NULL: there is no image
};

struct check_result {
    enum check_outcome outcome;
    char expected[CHECK_TEXT_MAX]; // "" if the text of the case is enough
    char seen[CHECK_TEXT_MAX];
    char why[512]; // why the case failed or was not run
    bool is_lost;  // the case was not run, because the device was lost
    struct check_picture picture;
    double seconds;
};

struct check_case {
    // A short title after the number in docs/verification.md: "B3 glowing sphere, 9 bounces".
    const char *name;
    const char *expected; // the expected result, in words or as a formula
    // Runs the case, and sets the outcome and the texts of *result. Returns false if the device
    // failed, or with ERR_STOPPED.
    bool (*run)(const struct check *check, const struct check_case *this_case,
                struct check_result *result, struct err *err);
    const void *data; // parameter of `run`
    bool is_long;     // runs only on request
};

struct check_group {
    const char *name;
    const char *about; // describes what the cases have in common
    const struct check_case *cases;
    size_t count;
};

// Runs a case and measures its time. If the device reports an error, the case fails and `why` is
// the message; if the device is lost, the outcome is CHECK_NOT_RUN. Returns false only with
// ERR_STOPPED.
bool check_run(const struct check *check, const struct check_case *this_case,
               struct check_result *result, struct err *err);

// These functions set the outcome of a case and return true.
bool check_seen(struct check_result *result, bool passed, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
bool check_not_run(struct check_result *result, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

// Copies the renderer's image into the result, if check->arena is set.
bool check_keep_picture(const struct check *check, struct renderer *renderer,
                        struct check_result *result, struct err *err);

#endif
