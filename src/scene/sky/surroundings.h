// Replaces and turns what is around a loaded scene while a program runs.
#ifndef LAMPYRIS_SCENE_SKY_SURROUNDINGS_H
#define LAMPYRIS_SCENE_SKY_SURROUNDINGS_H

#include "scene/core/environment.h"
#include "scene/sky/sky.h"

enum surroundings_kind {
    SURROUNDINGS_ORIGINAL, // as it was loaded
    SURROUNDINGS_NONE,     // black
    SURROUNDINGS_CONSTANT,
    SURROUNDINGS_SKY,
    SURROUNDINGS_IMAGE,
    SURROUNDINGS_COUNT
};
extern const char *const surroundings_names[SURROUNDINGS_COUNT + 1]; // "original" …, NULL

#define SURROUNDINGS_PATH_MAX 1024

// Plain data: copied and compared byte by byte (unused bytes are 0).
struct surroundings {
    uint32_t kind;
    float radiance[3];                                    // CONSTANT: W/(sr m^2)
    double turbidity, elevation_degrees, azimuth_degrees; // SKY, as sky.h has it
    uint32_t has_sun;                                     // SKY: 0 or 1
    uint32_t unused;
    double rotation_degrees;           // about +Y, in addition to the original's
    double strength;                   // factor
    char image[SURROUNDINGS_PATH_MAX]; // IMAGE: a trusted path
};

struct surroundings surroundings_default(void);

// For editors, after scene_load: replaces the environment by one of these and the sun among the
// lights, which is the last of them, by the new sky's, if any. Neither turned nor scaled. What the
// old one held stays in the arena. On failure the scene is as it was.
struct environment_source {
    const char *file;      // trusted; or
    const struct sky *sky; // or
    const struct environment_gradient *gradient;
    float radiance[3]; // without any of them: constant; with a file: its factor
};
bool scene_replace_environment(struct scene *scene, const struct environment_source *source,
                               struct err *err);

// What a scene was loaded with, so that it can be had again: taken once, right after scene_load.
struct surroundings_original {
    struct environment environment;
    uint32_t light_count; // without the sky's sun
    uint32_t sky_sun;     // the light that is it, or SCENE_NONE
    uint64_t hash;        // the scene's
};
struct surroundings_original surroundings_keep(const struct scene *scene);

// Replaces the environment and the sky's sun among the lights (other lights keep their places). New
// texels live in `arena`, which the scene needs until the next call that succeeds. ERR_INPUT, and
// the scene is as before.
bool scene_set_surroundings(struct scene *scene, const struct surroundings_original *original,
                            const struct surroundings *to, struct arena *arena, struct err *err);

#endif
