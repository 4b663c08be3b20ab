// Checking scenes whose radiance is known in closed form (docs/verification.md, B): by 64
// replicates and statistics, or pixel by pixel where there is no variance.
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

// Which estimators besides MIS reach the half-width with CLOSED_FORM_LONG_SAMPLES. Light sampling
// does not where lights touch what they light: 1 / distance^2 has no variance there.
enum { NEE_ALONE = 1, BSDF_ALONE = 2, EACH_ALONE = 3 };

#define CLOSED_FORM_LONG_SAMPLES 1024

struct closed_form {
    const char *scene; // embedded
    // Radiance of a channel from its reflectance, what the light emits, and a parameter.
    double (*radiance)(double rho, double le, double parameter);
    double parameter;
    enum closed_form_kind kind;
    unsigned alone;
    struct scene_override overrides[6]; // to the first without a key
    double scale;                       // of all lengths, see scaled_scene.h; 0: 1
    // What the scene's text cannot say, such as meshes; NULL: nothing.
    bool (*prepare)(struct scene *scene, double parameter, struct err *err);
    enum instancing instancing; // of its meshes
};

// A case of the table: the words that stand for a function's formula are called FUNCTION_is.
// clang-format off
#define FORM(title, file, function, ...)                                                           \
    {.name = title, .expected = function##_is, .run = closed_form_run,                             \
     .data = &(const struct closed_form){file, function, __VA_ARGS__}}
#define LONG_FORM(title, file, function, ...)                                                      \
    {.name = title, .expected = function##_is, .run = closed_form_run, .is_long = true,            \
     .data = &(const struct closed_form){file, function, __VA_ARGS__}}
// clang-format on

// The text of its argument, for values of the scene file.
#define JSON(...) #__VA_ARGS__

// Of red, green and blue, in all scenes.
extern const double closed_form_albedo[3], closed_form_emission[3];

// One form by one estimator.
struct closed_form_trial {
    const struct closed_form *form;
    enum light_estimator estimator;
    uint32_t light_choice; // LIGHT_CHOICE_*
    uint32_t first_seed;   // of its replicates: other forms have others, or share random numbers
    uint64_t samples;      // a replicate; 0: as many as give the half-width
    double half_width_max; // of the 95 % confidence interval, relative to the value
};

// Relative to what is expected, of each channel; of a form without variance, of the worst pixel.
struct closed_form_seen {
    double expected[3], mean[3], bias[3], t[3], half_width[3];
    uint64_t samples;
    bool passed;
    char why[CHECK_TEXT_MAX];
};

// CLOSED_FORM_HALF_WIDTH of the tests, twice that of a short check: a quarter of the samples.
#define CLOSED_FORM_HALF_WIDTH 1e-3

// check->arena may be NULL, and `result` where no picture is wanted.
bool closed_form_try(const struct check *check, const struct closed_form_trial *trial,
                     struct closed_form_seen *seen, struct check_result *result, struct err *err);

// `run` of a case: by default, with seeds of its own.
bool closed_form_run(const struct check *check, const struct check_case *this_case,
                     struct check_result *result, struct err *err);

#endif
