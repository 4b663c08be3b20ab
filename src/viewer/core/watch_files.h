// Lists the files of a scene, as far as its text names them, and detects changes.
#ifndef LAMPYRIS_VIEWER_CORE_WATCH_FILES_H
#define LAMPYRIS_VIEWER_CORE_WATCH_FILES_H

#include "base/arena.h"
#include <stdint.h>

#define WATCH_FILES_MAX 1024u

struct watch_files {
    struct arena arena;
    const char *paths[WATCH_FILES_MAX];
    uint32_t count;
};

void watch_files_add(struct watch_files *files, const char *path);
// Adds the file and, if it is text of a known kind (our JSON, glTF, OBJ, MTL), all existing files
// that it names, recursively.
void watch_files_add_scene(struct watch_files *files, const char *path);
// The sources of kernels in a folder.
void watch_files_add_shaders(struct watch_files *files, const char *folder);
void watch_files_finish(struct watch_files *files); // {0} afterwards

// Returns a hash of the times, sizes and inodes of all files: it changes when any was written or
// replaced.
uint64_t watch_files_stamp(const struct watch_files *files);

#endif
