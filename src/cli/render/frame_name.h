// Names of numbered pictures.
#ifndef LAMPYRIS_CLI_RENDER_FRAME_NAME_H
#define LAMPYRIS_CLI_RENDER_FRAME_NAME_H

#include "base/arena.h"
#include "base/err.h"
#include <stdint.h>

// A file name with a placeholder for a number. "turn_####.png" (as in Blender) and "turn_%04d.png"
// (as in ffmpeg) mean the same. Without a placeholder, the number is put before the extension, as
// path_numbered() does: "turn.png" gives "turn.0001.png". Large numbers may have more digits.
struct frame_name {
    const char *path;
    int before;     // bytes of `path` before the number, including the whole folder
    int taken;      // bytes of `path` that the number replaces
    int digits;     // minimum number of digits
    bool needs_dot; // a dot is put before the number
};

// Fails with ERR_USAGE if the name has two placeholders, or a '%' that is not part of one.
bool frame_name_parse(const char *path, struct frame_name *out, struct err *err);
// Both functions return NULL when out of memory.
char *frame_name_make(const struct frame_name *name, uint32_t number, struct arena *arena);
// Returns the pattern that ffmpeg accepts: "%04d" in place of the number, and each '%' of the
// folder doubled.
char *frame_name_pattern(const struct frame_name *name, struct arena *arena);

#endif
