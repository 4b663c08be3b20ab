// Checks scenes whose radiance has a closed form (docs/verification.md, B): by statistics of 64
// replicates, or in every pixel if the estimator has no variance.
#ifndef LAMPYRIS_CHECK_CLOSED_FORM_H
#define LAMPYRIS_CHECK_CLOSED_FORM_H

#include "check/check.h"
#include "check/estimators.h"
#include "scene/core/scene.h"

enum closed_form_kind {
    BY_STATISTICS,
    WITHOUT_VARIANCE, // compares every pixel at 1 spp
    EXACT,            // compares every pixel bit for bit
};

// The estimators, besides MIS, that reach the required half-width with CLOSED_FORM_LONG_SAMPLES
// samples. Light sampling alone does not if a light touches the surface that it illuminates,
// because the variance of 1 / distance^2 is infinite there.
enum { NEE_ALONE = 1, BSDF_ALONE = 2, EACH_ALONE = 3 };

#define CLOSED_FORM_LONG_SAMPLES 1024

struct closed_form {
    const char *scene; // name of an embedded scene
    // Returns the expected radiance in a channel with the reflectance `rho` and the emitted
    // radiance `le`.
    double (*radiance)(double rho, double le, double parameter);
    double parameter;
    enum closed_form_kind kind;
    unsigned alone;
    struct scene_override overrides[6]; // ends with the first override without a key
    double scale;                       // factor for all lengths, see scaled_scene.h; 0 means 1
    // Adds to the scene what a scene file cannot express, such as meshes; may be NULL.
    bool (*prepare)(struct scene *scene, double parameter, struct err *err);
    enum instancing instancing; // instancing of the scene's meshes
};

// Defines a row of the table of cases. FUNCTION_is is the text of the formula that FUNCTION
// computes.
// clang-format off
#define FORM(title, file, function, ...)                                                           \
    {.name = title, .expected = function##_is, .run = closed_form_run,                             \
     .data = &(const struct closed_form){file, function, __VA_ARGS__}}
#define LONG_FORM(title, file, function, ...)                                                      \
    {.name = title, .expected = function##_is, .run = closed_form_run, .is_long = true,            \
     .data = &(const struct closed_form){file, function, __VA_ARGS__}}
// clang-format on

// Turns its argument into a string with a value for the scene file.
#define JSON(...) #__VA_ARGS__

// Albedo and emitted radiance that all scenes use; red, green and blue.
extern const double closed_form_albedo[3], closed_form_emission[3];

// A closed form and how to render it.
struct closed_form_trial {
    const struct closed_form *form;
    enum light_estimator estimator;
    uint32_t light_choice; // LIGHT_CHOICE_*
    uint32_t first_seed; // seed of the first replicate; forms use different seeds to be independent
    uint64_t samples;    // samples per replicate; 0: as many as the half-width requires
    // Greatest half-width of the 95 % confidence interval, relative to the value.
    double half_width_max;
};

// The results for each channel. `bias` and `half_width` are relative to the expected value. For a
// form without variance, `mean` and `bias` are those of the worst pixel.
struct closed_form_seen {
    double expected[3], mean[3], bias[3], t[3], half_width[3];
    uint64_t samples;
    bool passed;
    char why[CHECK_TEXT_MAX];
};

// The half-width of the test suite. `lampyris check` permits twice as much, which takes a quarter
// of the samples.
#define CLOSED_FORM_HALF_WIDTH 1e-3

// Tries a closed form with one estimator. check->arena may be NULL; `result` may be NULL if no
// image is wanted.
bool closed_form_try(const struct check *check, const struct closed_form_trial *trial,
                     struct closed_form_seen *seen, struct check_result *result, struct err *err);

// The `run` function of a case: tries the form with MIS and with seeds of its own.
bool closed_form_run(const struct check *check, const struct check_case *this_case,
                     struct check_result *result, struct err *err);

#endif
