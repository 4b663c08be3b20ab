// Declares the table of all cases, in groups.
#ifndef LAMPYRIS_CHECK_CASE_LIST_H
#define LAMPYRIS_CHECK_CASE_LIST_H

#include "check/check.h"

// Defines a group from an array of cases.
#define CHECK_GROUP(symbol, word, words, array)                                                    \
    const struct check_group symbol = {word, words, array, sizeof(array) / sizeof(array)[0]}

extern const struct check_group check_arithmetic, check_threads, check_bits, check_bsdf,
    check_light, check_media, check_rooms, check_lamps, check_grounds, check_bodies, check_fields,
    check_integrators, check_scales, check_distances, check_small_lamps, check_samplers, check_rays,
    check_environments, check_meshes, check_textures, check_stiff, check_bounded;

extern const struct check_group *const check_groups[];
extern const size_t check_group_count;

// Returns whether `only` is the name of the group or of the case, or the case's number ("C14");
// NULL selects all.
bool check_is_wanted(const struct check_group *group, const struct check_case *this_case,
                     const char *only);

#endif
