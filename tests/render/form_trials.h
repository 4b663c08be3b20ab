// Tests the closed forms of a group of the table of cases, each with several estimators.
#ifndef LAMPYRIS_TESTS_FORM_TRIALS_H
#define LAMPYRIS_TESTS_FORM_TRIALS_H

#include "check/case_list.h"

// Tests each form in the default configuration, with the fewest samples that give the half-width.
void forms_by_default(const struct check_group *group, uint32_t first_seed);
// The same without forms that take long.
void forms_that_are_short(const struct check_group *group, uint32_t first_seed);
// Tests each form with CLOSED_FORM_LONG_SAMPLES and every estimator that reaches the half-width.
void forms_by_every_estimator(const struct check_group *group, uint32_t first_seed);
// Tests each form with every strategy of light sampling, with the fewest samples that give the
// half-width.
void forms_by_every_light_choice(const struct check_group *group, uint32_t first_seed);
// By light paths weighted against paths from the camera (--integrator bidir), with the fewest
// samples that give four times the half-width. Forms that this integrator refuses are left out;
// fails if fewer than `least` are tried.
void forms_by_light_paths(const struct check_group *group, uint32_t first_seed, size_t least);
// Renders one sample per pixel under the validation layers.
void forms_validated(const struct check_group *group);

#endif
