// Checks a scene before a long render: finds what is stiff or extreme in it, and says where, what
// follows from it and what can be done (`lampyris check SCENE`). Implemented in src/check/scene/.
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
    const char *name; // a word for scripts: "zero-area"
    enum finding_level level;
    const char *place;       // "instance 3 of mesh \"leaf\""
    const char *figure;      // "12 of 400 triangles"
    const char *consequence; // a sentence
    const char *remedy;      // a sentence
    double share;            // fraction of the image that it affects, 0 to 1; NAN: not known
    const uint8_t *pixels;   // flags of affected pixels of `picture`; NULL: not known, or all
    const char *change;      // what "check SCENE --fix" changes; NULL: nothing
};

// The cost of a render of the scene to a given error.
struct scene_outlook {
    double error;          // local relMSE
    double samples;        // per pixel; NAN: not known
    double seconds;        // rendering time on this device under its present load; NAN: not known
    uint64_t device_bytes; // device memory at the size of the settings
    const char *reason;    // why it is not known, or NULL
};

struct scene_findings {
    struct scene_finding *items; // in descending order of `share`, unknown shares last
    uint32_t count, capacity;
    struct scene_outlook outlook;
    struct image picture; // the small image that was rendered, linear
};

struct check_scene_params {
    struct renderer_params renderer; // with its `scene`
    struct scene *scene;             // the same scene; its settings are unchanged afterwards
    double error;                    // local relMSE for which the outlook is computed
    // Applies harmless remedies to `scene`, those of findings with a `change`: they remove an
    // error, or something without effect, and change nothing else in the image.
    bool fixes;
};

// Checks a scene on a device, with its settings and one of its cameras. Short renders of a small
// image measure what cannot be known otherwise. Lists and strings are in `arena`. ERR_STOPPED when
// the listener of the renderer's params asks to stop.
bool check_scene(const struct check_scene_params *params, struct arena *arena,
                 struct scene_findings *out, struct err *err);

#endif
