// Media of the same priority whose bodies overlap or lie within each other. Internal to
// src/check/scene/.
#ifndef LAMPYRIS_CHECK_SCENE_MEDIA_OVERLAPS_H
#define LAMPYRIS_CHECK_SCENE_MEDIA_OVERLAPS_H

#include "check/scene/survey.h"

// Two media of the same priority, by materials. The upper one has the higher number and applies
// where both overlap (lib/media.glsl).
struct overlap {
    uint32_t upper, lower, object; // an object of the lower one
    // How often lines found each case:
    uint32_t crossed;   // the line left one medium inside the other, and the other later
    uint32_t swallowed; // the lower one was inside the upper one
    uint32_t held;      // the upper one was inside the lower one
};
#define OVERLAPS_MAX 16
struct overlaps {
    struct overlap items[OVERLAPS_MAX];
    uint32_t count;
};

// Returns the entry for these materials, which is added if there is none; NULL when there are too
// many.
struct overlap *overlaps_of(struct overlaps *overlaps, uint32_t upper, uint32_t lower,
                            uint32_t object);
// Adds the findings, and changes priorities where they can be fixed.
bool overlaps_add(struct survey *survey, const struct overlaps *overlaps, struct err *err);

#endif
