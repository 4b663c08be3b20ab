// Replaces and rotates the environment of a loaded scene while a program runs.
#ifndef LAMPYRIS_SCENE_SKY_SURROUNDINGS_H
#define LAMPYRIS_SCENE_SKY_SURROUNDINGS_H

#include "scene/core/environment.h"
#include "scene/sky/sky.h"

enum surroundings_kind {
    SURROUNDINGS_ORIGINAL, // as loaded from the file
    SURROUNDINGS_NONE,     // black
    SURROUNDINGS_CONSTANT,
    SURROUNDINGS_SKY,
    SURROUNDINGS_IMAGE,
    SURROUNDINGS_COUNT
};
extern const char *const surroundings_names[SURROUNDINGS_COUNT + 1]; // "original" …, NULL

#define SURROUNDINGS_PATH_MAX 1024

// Plain data that is copied and compared byte by byte; unused bytes are 0.
struct surroundings {
    uint32_t kind;
    float radiance[3];                                    // CONSTANT: W/(sr m^2)
    double turbidity, elevation_degrees, azimuth_degrees; // SKY: see sky.h
    uint32_t has_sun;                                     // SKY: 0 or 1
    uint32_t unused;
    double rotation_degrees;           // about +Y, added to that of the original
    double strength;                   // factor
    char image[SURROUNDINGS_PATH_MAX]; // IMAGE: a trusted path
};

struct surroundings surroundings_default(void);

// For editors, after scene_load: replaces the environment by one of these, and the sky's sun among
// the lights, which is the last light, by the new sky's, if any. The new environment is neither
// rotated nor scaled. The old texels stay in the arena. On failure the scene is unchanged.
struct environment_source {
    const char *file;      // trusted; or
    const struct sky *sky; // or
    const struct environment_gradient *gradient;
    float radiance[3]; // constant environment if none of the above is set; factor of a file
};
bool scene_replace_environment(struct scene *scene, const struct environment_source *source,
                               struct err *err);

// The environment as loaded, so that it can be restored: taken once, right after scene_load.
struct surroundings_original {
    struct environment environment;
    uint32_t light_count; // without the sky's sun
    uint32_t sky_sun;     // index of the light that is the sky's sun, or SCENE_NONE
    uint64_t hash;        // the scene's
};
struct surroundings_original surroundings_keep(const struct scene *scene);

// Replaces the environment and the sky's sun among the lights; other lights keep their indices. New
// texels live in `arena`, which the scene needs until the next call that succeeds. On ERR_INPUT the
// scene is unchanged.
bool scene_set_surroundings(struct scene *scene, const struct surroundings_original *original,
                            const struct surroundings *to, struct arena *arena, struct err *err);

#endif
