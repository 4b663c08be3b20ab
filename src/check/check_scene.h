// Checking a scene before hours are spent on it: what in it is stiff or extreme, where, what
// follows from that and what can be done (`lampyris check SCENE`). Implemented in src/check/scene/.
#ifndef LAMPYRIS_CHECK_CHECK_SCENE_H
#define LAMPYRIS_CHECK_CHECK_SCENE_H

#include "base/arena.h"
#include "base/err.h"
#include <stdbool.h>
#include <stdint.h>

struct progress;
struct renderer_params;

struct scene_finding {
    const char *name;        // one word for scripts: "zero-area"
    const char *place;       // "mesh 3 (\"leaf\")"
    const char *figure;      // "12 of 400 triangles"
    const char *consequence; // a sentence
    const char *remedy;      // a sentence
    double share;            // of the picture that it touches, 0 to 1; NAN: not known
};

// The most of the picture first.
struct scene_findings {
    struct scene_finding *items; // of `arena`, as all strings
    uint32_t count;
};

// Says of the scene of `params` what is found on its device, with its settings and its camera.
// ERR_STOPPED where the listener of `params` asks to stop.
bool check_scene(const struct renderer_params *params, struct arena *arena,
                 struct scene_findings *out, struct err *err);

#endif
