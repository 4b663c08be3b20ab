// Metadata of an image file that describe how the image was made: enough to judge it, and to make
// it again.
#ifndef LAMPYRIS_OUTPUT_METADATA_H
#define LAMPYRIS_OUTPUT_METADATA_H

#include "image/image.h"
#include "scene/core/settings.h"

#define METADATA_MAX (56 + SETTING_TOTAL)

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
    const struct job *job;                // the job that rendered it: device, scene, renderer and
                                          // goal
    const struct scene_load_params *load; // the parameters with which the scene was loaded
    const struct settings *settings;      // but for the number of samples and the exposure
    const struct film_image *film;
    const struct half_error *error;
    const struct job_seconds *seconds;
    const char *ended_by; // see job_ended_by()
    const char *command;  // the command that made it
    const char *repeat;   // the command that makes it again; NULL: there is none
    uint64_t samples;     // per pixel, as --spp
    uint64_t image_hash;
    float exposure;  // stops
    uint32_t camera; // index into the scene's
    uint32_t frame;  // 0: the image of all
};

// Values are copied into `arena`, except the two commands and the error's reason.
bool metadata_make(const struct metadata_params *params, struct arena *arena, struct metadata *out,
                   struct err *err);
// Adds one, or takes the place of the one with this key. NULL for `value`: no memory for it.
bool metadata_set(struct metadata *metadata, const char *key, const char *value, struct err *err);

#endif
