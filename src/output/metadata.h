// The metadata of an image file. They describe how the image was made, in enough detail to evaluate
// it and to render it again.
#ifndef LAMPYRIS_OUTPUT_METADATA_H
#define LAMPYRIS_OUTPUT_METADATA_H

#include "image/image.h"
#include "scene/core/settings.h"

#define METADATA_MAX (58 + SETTING_TOTAL)

struct metadata {
    struct image_attribute list[METADATA_MAX];
    uint32_t count;
};

struct film_image;
struct half_error;
struct job;
struct job_seconds;
struct scene_load_params;

struct metadata_params {
    const struct job *job; // the job that rendered the image, with device, scene, renderer and goal
    const struct scene_load_params *load; // parameters with which the scene was loaded
    // The settings, except for the number of samples and the exposure.
    const struct settings *settings;
    const struct film_image *film;
    const struct half_error *error;
    const struct job_seconds *seconds;
    const char *ended_by; // see job_ended_by()
    const char *command;  // the command that rendered the image
    const char *repeat;   // a command that renders the image again; NULL if there is none
    uint64_t samples;     // samples per pixel, as for --spp
    uint64_t image_hash;
    float exposure;  // stops
    uint32_t camera; // index of the camera in the scene
    uint32_t frame;  // number of the frame; 0: the image has the samples of all frames
};

// Makes the metadata. Values are copied into `arena`, except the two commands.
bool metadata_make(const struct metadata_params *params, struct arena *arena, struct metadata *out,
                   struct err *err);
// Adds a value or replaces the value with the same key. A value of NULL means that there was no
// memory for it, and fails.
bool metadata_set(struct metadata *metadata, const char *key, const char *value, struct err *err);

#endif
