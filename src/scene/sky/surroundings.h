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
extern const char *const surroundings_names[SURROUNDINGS_COUNT + 1]; // "original" …, ended by NULL

#define SURROUNDINGS_PATH_MAX 1024

// Plain data, copied and compared byte by byte; unused bytes are 0.
struct surroundings {
    uint32_t kind;
    float radiance[3];                                    // for CONSTANT: W/(sr m^2)
    double turbidity, elevation_degrees, azimuth_degrees; // for SKY: see sky.h
    uint32_t has_sun;                                     // for SKY: 0 or 1
    uint32_t unused;
    double rotation_degrees;           // about +Y, added to the original's rotation
    double strength;                   // factor on the radiance
    char image[SURROUNDINGS_PATH_MAX]; // for IMAGE: a trusted path
};

struct surroundings surroundings_default(void);

// A new environment for an editor to set after scene_load(). It replaces the environment, and the
// sky's sun, which is the last light, becomes the sun of the new sky or is removed. The new
// environment is neither rotated nor scaled. The old texels stay in the arena. On failure the scene
// is unchanged.
struct environment_source {
    const char *file;      // a trusted path, or NULL
    const struct sky *sky; // a sky, or NULL
    const struct environment_gradient *gradient;
    float radiance[3]; // of a constant environment if the above are NULL; else a factor on a file
};
bool scene_replace_environment(struct scene *scene, const struct environment_source *source,
                               struct err *err);

// The environment as loaded, stored once, right after scene_load(), so that it can be restored.
struct surroundings_original {
    struct environment environment;
    uint32_t light_count; // number of lights without the sky's sun
    uint32_t sky_sun;     // index of the sky's sun among the lights; SCENE_NONE: none
    uint64_t hash;        // the scene's hash
};
struct surroundings_original surroundings_keep(const struct scene *scene);

// Replaces the environment, and the sky's sun among the lights; other lights keep their indices.
// New texels live in `arena`, which the scene needs until the next successful call. On ERR_INPUT
// the scene is unchanged.
bool scene_set_surroundings(struct scene *scene, const struct surroundings_original *original,
                            const struct surroundings *to, struct arena *arena, struct err *err);

#endif
