// Finds media with the same priority whose bodies overlap or are inside of each other. Internal to
// src/check/scene/.
#ifndef LAMPYRIS_CHECK_SCENE_MEDIA_OVERLAPS_H
#define LAMPYRIS_CHECK_SCENE_MEDIA_OVERLAPS_H

#include "check/scene/survey.h"

// Two media of the same priority, identified by materials. The upper one has the higher number, so
// it applies where they overlap (lib/media.glsl).
struct overlap {
    uint32_t upper, lower, object; // `object` has the material `lower`
    // The number of lines for each case:
    uint32_t crossed;   // the line left one medium inside the other, and left the other later
    uint32_t swallowed; // the lower medium was inside the upper one
    uint32_t held;      // the upper medium was inside the lower one
};
#define OVERLAPS_MAX 16
struct overlaps {
    struct overlap items[OVERLAPS_MAX];
    uint32_t count;
};

// Returns the entry for these materials and adds it if necessary; NULL if there are too many.
struct overlap *overlaps_of(struct overlaps *overlaps, uint32_t upper, uint32_t lower,
                            uint32_t object);
// Adds the findings. If fixes are requested, also changes priorities where that is possible.
bool overlaps_add(struct survey *survey, const struct overlaps *overlaps, struct err *err);

#endif
