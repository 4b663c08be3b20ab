// Finds programs that are installed together with this one.
#ifndef LAMPYRIS_CLI_SIBLING_H
#define LAMPYRIS_CLI_SIBLING_H

#include <stddef.h>

// Finds a program: first in the folder of this program; then at a path relative to that folder, as
// in the build folder; then in the folders of PATH.
void sibling_find(const char *program, const char *in_build_folder, char *out, size_t size);

#endif
