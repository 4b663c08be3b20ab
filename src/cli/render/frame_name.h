// Names of numbered pictures.
#ifndef LAMPYRIS_CLI_RENDER_FRAME_NAME_H
#define LAMPYRIS_CLI_RENDER_FRAME_NAME_H

#include "base/arena.h"
#include "base/err.h"
#include <stdint.h>

// The place of the number in the name of a file: "turn_####.png" (as in Blender) and
// "turn_%04d.png" (as for ffmpeg) are the same; in "turn.png" it stands before the extension:
// "turn.0001.png", as path_numbered() has it. Greater numbers take more digits.
struct frame_name {
    const char *path;
    int before;     // bytes of `path` before the number; a folder's are never the number's
    int taken;      // bytes of `path` that it replaces
    int digits;     // at least
    bool needs_dot; // a dot stands before it
};

// Fails with ERR_USAGE if the name has two places for the number, or a '%' that is none.
bool frame_name_parse(const char *path, struct frame_name *out, struct err *err);
// These return NULL when out of memory.
char *frame_name_make(const struct frame_name *name, uint32_t number, struct arena *arena);
// The same as a pattern of printf, with '%' of the folders doubled: what ffmpeg takes.
char *frame_name_pattern(const struct frame_name *name, struct arena *arena);

#endif
