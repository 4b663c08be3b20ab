#include "check/case_list.h"

#include <string.h>

const struct check_group *const check_groups[] = {
    // Cases about the driver.
    &check_arithmetic,
    &check_threads,
    // Variations that must not change a bit of an image.
    &check_bits,
    // Cases about BSDFs: docs/verification.md, A.
    &check_bsdf,
    // Scenes with known radiance: docs/verification.md, B, and the cases of C that have a closed
    // form.
    &check_light,
    &check_media,
    &check_rooms,
    &check_lamps,
    &check_grounds,
    &check_bodies,
    &check_fields,
    &check_integrators,
    &check_scales,
    &check_distances,
    &check_small_lamps,
    &check_samplers,
    &check_rays,
    &check_environments,
    &check_meshes,
    &check_textures,
    &check_stiff,
    &check_bounded,
};
const size_t check_group_count = sizeof check_groups / sizeof check_groups[0];

bool check_is_wanted(const struct check_group *group, const struct check_case *this_case,
                     const char *only)
{
    if (!only || strcmp(only, group->name) == 0 || strcmp(only, this_case->name) == 0)
        return true;
    size_t length = strlen(only);
    return !strchr(only, ' ') && strncmp(only, this_case->name, length) == 0 &&
           this_case->name[length] == ' ';
}
