// Programs that come with this one.
#ifndef LAMPYRIS_CLI_SIBLING_H
#define LAMPYRIS_CLI_SIBLING_H

#include <stddef.h>

// Finds a program: next to this one, as installed; else at a path from there, in the build folder;
// else by the system's search path.
void sibling_find(const char *program, const char *in_build_folder, char *out, size_t size);

#endif
