// Media of one priority where bodies of them overlap or lie within each other. Internal to
// src/check/scene/.
#ifndef LAMPYRIS_CHECK_SCENE_MEDIA_OVERLAPS_H
#define LAMPYRIS_CHECK_SCENE_MEDIA_OVERLAPS_H

#include "check/scene/survey.h"

// Two media of one priority, by materials. The upper one's number is the higher: it is there where
// both are (lib/media.glsl).
struct overlap {
    uint32_t upper, lower, object; // an object of the lower one
    // How often a line met them:
    uint32_t crossed;   // it left one within the other and the other later
    uint32_t swallowed; // the lower one lay within the upper one
    uint32_t held;      // the upper one lay within the lower one
};
#define OVERLAPS_MAX 16
struct overlaps {
    struct overlap items[OVERLAPS_MAX];
    uint32_t count;
};

// Returns the one of these materials, which is new where there was none; or NULL where there are
// too many.
struct overlap *overlaps_of(struct overlaps *overlaps, uint32_t upper, uint32_t lower,
                            uint32_t object);
// Adds what is found, and changes priorities where it is to be fixed.
bool overlaps_add(struct survey *survey, const struct overlaps *overlaps, struct err *err);

#endif
