// Checks scenes whose radiance is known in closed form (docs/verification.md, B): by 64 replicates
// and statistics, or pixel by pixel if there is no variance.
#ifndef LAMPYRIS_CHECK_CLOSED_FORM_H
#define LAMPYRIS_CHECK_CLOSED_FORM_H

#include "check/check.h"
#include "check/estimators.h"
#include "scene/core/scene.h"

enum closed_form_kind {
    BY_STATISTICS,
    WITHOUT_VARIANCE, // every pixel, at 1 spp
    EXACT,            // every pixel, bit for bit
};

// The estimators besides MIS that reach the half-width with CLOSED_FORM_LONG_SAMPLES. Light
// sampling does not if lights touch the surface that they light: 1 / distance^2 has infinite
// variance there.
enum { NEE_ALONE = 1, BSDF_ALONE = 2, EACH_ALONE = 3 };

#define CLOSED_FORM_LONG_SAMPLES 1024

struct closed_form {
    const char *scene; // embedded
    // Computes the radiance of a channel from reflectance, emitted radiance and a parameter.
    double (*radiance)(double rho, double le, double parameter);
    double parameter;
    enum closed_form_kind kind;
    unsigned alone;
    struct scene_override overrides[6]; // up to the first without a key
    double scale;                       // factor on all lengths, see scaled_scene.h; 0: 1
    // Adds what scene files cannot express, such as meshes; NULL: nothing.
    bool (*prepare)(struct scene *scene, double parameter, struct err *err);
    enum instancing instancing; // instancing of the scene's meshes
};

// A row of the table: FUNCTION_is is the text of the formula that FUNCTION computes.
// clang-format off
#define FORM(title, file, function, ...)                                                           \
    {.name = title, .expected = function##_is, .run = closed_form_run,                             \
     .data = &(const struct closed_form){file, function, __VA_ARGS__}}
#define LONG_FORM(title, file, function, ...)                                                      \
    {.name = title, .expected = function##_is, .run = closed_form_run, .is_long = true,            \
     .data = &(const struct closed_form){file, function, __VA_ARGS__}}
// clang-format on

// Turns its argument into text, for values of the scene file.
#define JSON(...) #__VA_ARGS__

// Red, green and blue, the same in all scenes.
extern const double closed_form_albedo[3], closed_form_emission[3];

// One closed form, rendered with one estimator.
struct closed_form_trial {
    const struct closed_form *form;
    enum light_estimator estimator;
    uint32_t light_choice; // LIGHT_CHOICE_*
    uint32_t first_seed;   // seed of its first replicate; other forms use others, to be independent
    uint64_t samples;      // per replicate; 0: as many as reach the half-width
    double half_width_max; // half the width of the 95 % confidence interval, relative to the value
};

// All values are relative to the expected ones, by channel. For a form without variance they are
// those of the worst pixel.
struct closed_form_seen {
    double expected[3], mean[3], bias[3], t[3], half_width[3];
    uint64_t samples;
    bool passed;
    char why[CHECK_TEXT_MAX];
};

// CLOSED_FORM_HALF_WIDTH of the tests, twice that of a short check: a quarter of the samples.
#define CLOSED_FORM_HALF_WIDTH 1e-3

// check->arena may be NULL, and so may `result` if no picture is wanted.
bool closed_form_try(const struct check *check, const struct closed_form_trial *trial,
                     struct closed_form_seen *seen, struct check_result *result, struct err *err);

// The `run` of a case: uses the default trial, with seeds of its own.
bool closed_form_run(const struct check *check, const struct check_case *this_case,
                     struct check_result *result, struct err *err);

#endif
