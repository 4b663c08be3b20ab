// Checks a scene before a long render (`lampyris check SCENE`): finds what makes rendering it
// difficult or wrong, and reports where it is, its consequence and the remedy. Implemented in
// src/check/scene/.
#ifndef LAMPYRIS_CHECK_CHECK_SCENE_H
#define LAMPYRIS_CHECK_CHECK_SCENE_H

#include "base/arena.h"
#include "base/err.h"
#include "image/image.h"
#include "render/render.h"
#include <stdbool.h>
#include <stdint.h>

enum finding_level {
    FINDING_REMARK, // the image is right
    FINDING_SLOW,   // the image converges to the right one, but slowly
    FINDING_WRONG,  // the image does not converge to what the scene describes
};
extern const char *const finding_level_names[]; // "remark" …

struct scene_finding {
    const char *name; // a word for scripts, such as "zero-area"
    enum finding_level level;
    const char *place;       // where the fault is: "instance 3 of mesh \"leaf\""
    const char *figure;      // how much is at fault: "12 of 400 triangles"
    const char *consequence; // effect of the fault on the image, as a sentence
    const char *remedy;      // what to do, as a sentence
    double share;            // fraction, in [0, 1], of the image that is affected; NAN: not known
    // A flag for each pixel of `picture` that is affected; NULL: not known, or all pixels.
    const uint8_t *pixels;
    const char *change; // what "check SCENE --fix" changes; NULL if it changes nothing
};

// The expected cost of a render of the scene to a given error.
struct scene_outlook {
    double error;          // the error as local relMSE
    double samples;        // samples per pixel; NAN: not known
    double seconds;        // rendering time on this device, with its present load; NAN: not known
    uint64_t device_bytes; // device memory that the render needs at the size of the settings
    const char *reason;    // why the cost is not known, or only an upper bound; NULL if it is known
};

struct scene_findings {
    struct scene_finding *items; // in descending order of `share`, unknown shares last
    uint32_t count, capacity;
    struct scene_outlook outlook;
    struct image picture; // the small image that was rendered for the check, linear
};

struct check_scene_params {
    struct renderer_params renderer; // its member `scene` must be set
    struct scene *scene; // the scene of `renderer`; its settings are the same afterwards
    double error;        // the local relMSE to which `outlook` refers
    // Applies to `scene` the changes of all findings that have a `change`. A change removes an
    // error, or an object without effect. It does not affect the image otherwise.
    bool fixes;
};

// Checks a scene with its settings and one of its cameras, on a device. Short renders of a small
// image measure what cannot be computed otherwise. `arena` owns all lists and strings. Fails with
// ERR_STOPPED if the progress listener of the renderer's parameters requests a stop.
bool check_scene(const struct check_scene_params *params, struct arena *arena,
                 struct scene_findings *out, struct err *err);

#endif
