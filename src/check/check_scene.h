// Checking a scene before hours are spent on it: what in it is stiff or extreme, where, what
// follows from that and what can be done (`lampyris check SCENE`). Implemented in src/check/scene/.
#ifndef LAMPYRIS_CHECK_CHECK_SCENE_H
#define LAMPYRIS_CHECK_CHECK_SCENE_H

#include "base/arena.h"
#include "base/err.h"
#include "image/image.h"
#include "render/render.h"
#include <stdbool.h>
#include <stdint.h>

enum finding_level {
    FINDING_REMARK, // worth knowing: the picture is right
    FINDING_SLOW,   // the picture is right in the limit, but its noise falls slowly
    FINDING_WRONG,  // the picture is not what the scene says, however many samples it has
};
extern const char *const finding_level_names[]; // "remark" …

struct scene_finding {
    const char *name; // a word for scripts: "zero-area"
    enum finding_level level;
    const char *place;       // "instance 3 of mesh \"leaf\""
    const char *figure;      // "12 of 400 triangles"
    const char *consequence; // a sentence
    const char *remedy;      // a sentence
    double share;            // of the picture that it touches, 0 to 1; NAN: not known
    const uint8_t *pixels; // of `picture`: flags of those that it touches; NULL: not known, or all
    const char *change;    // what scene_check_fix() does about it; NULL: nothing
};

// What a render of the scene would take to a given error.
struct scene_outlook {
    double error;          // local relMSE
    double samples;        // a pixel; NAN: not known
    double seconds;        // of rendering, on this device as busy as it is now; NAN: not known
    uint64_t device_bytes; // of memory, at the size of the settings
    const char *reason;    // why it is not known; or NULL
};

struct scene_findings {
    struct scene_finding *items; // in descending order of their shares, unknown ones last
    uint32_t count, capacity;
    struct scene_outlook outlook;
    struct image picture; // the small one that was looked at, linear
};

struct check_scene_params {
    struct renderer_params renderer; // with its `scene`
    struct scene *scene;             // the same. Its settings are as they were afterwards
    double error;                    // local relMSE to look ahead to
    // Harmless remedies are applied to `scene`, those whose finding has a `change`: they remove an
    // error, or something that has no effect, and change nothing else of the picture.
    bool fixes;
};

// Says of a scene what is found in it, on a device, with its settings and one of its cameras. Short
// renders of a small picture measure what cannot be known otherwise. Lists and strings are in
// `arena`. ERR_STOPPED where the listener of the renderer's params asks to stop.
bool check_scene(const struct check_scene_params *params, struct arena *arena,
                 struct scene_findings *out, struct err *err);

#endif
