// Checking scenes whose radiance is known in closed form (docs/verification.md, B): by 64
// replicates and statistics, or pixel by pixel where there is no variance.
#ifndef LAMPYRIS_TESTS_CLOSED_FORM_H
#define LAMPYRIS_TESTS_CLOSED_FORM_H

#include "estimators.h"
#include "render_fixture.h"

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
    const char *name, *scene;
    // Radiance of a channel from its reflectance, what the light emits, and a parameter.
    double (*radiance)(double rho, double le, double parameter);
    double parameter;
    enum closed_form_kind kind;
    unsigned alone;
    struct scene_override overrides[6]; // to the first without a key
    double scale;                       // of all lengths, see scaled_scene.h; 0: 1
};

// The text of its argument, for values of the scene file.
#define JSON(...) #__VA_ARGS__
#define OURS "tests/render/scenes/"

// Of red, green and blue, in all scenes.
extern const double closed_form_albedo[3], closed_form_emission[3];

// Each form in the default configuration, with the fewest samples that give the half-width.
void closed_forms_by_default(const struct closed_form *forms, size_t count, uint32_t first_seed);
// With CLOSED_FORM_LONG_SAMPLES, and by each estimator that can.
void closed_forms_by_every_estimator(const struct closed_form *forms, size_t count,
                                     uint32_t first_seed);
// By each way to choose an emitter, with the fewest samples that give the half-width.
void closed_forms_by_every_light_choice(const struct closed_form *forms, size_t count,
                                        uint32_t first_seed);
// One sample a pixel under the validation layers.
void closed_forms_validated(const struct closed_form *forms, size_t count);

#endif
