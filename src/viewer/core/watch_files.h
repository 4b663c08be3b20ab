// Lists the files of a scene, as far as their text shows them, and detects changes of them.
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
// Adds a file and, if it is text of a known kind (our JSON, glTF, OBJ, MTL), recursively all
// existing files that it names.
void watch_files_add_scene(struct watch_files *files, const char *path);
// Adds the sources of kernels in a folder.
void watch_files_add_shaders(struct watch_files *files, const char *folder);
void watch_files_finish(struct watch_files *files); // *files is {0} afterwards

// Returns a hash of the times, sizes and inode numbers of all files. It changes when a file is
// written or replaced.
uint64_t watch_files_stamp(const struct watch_files *files);

#endif
