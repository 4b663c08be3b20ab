// Checks of the pictures that a command is asked to write, before it renders.
#ifndef LAMPYRIS_CLI_OUTPUTS_H
#define LAMPYRIS_CLI_OUTPUTS_H

#include "base/err.h"
#include <stdbool.h>
#include <stdint.h>

// Checks whether the format of a picture is known (ERR_USAGE), and whether it can be written into
// its folder (ERR_OUTPUT).
bool outputs_check_one(const char *path, struct err *err);
// Fails with ERR_USAGE if layers are requested (`aovs` is not 0) and no picture is an EXR file,
// because other formats have no layers. Succeeds if there are no pictures.
bool outputs_check_layers(const char *const *paths, uint32_t count, uint32_t aovs, struct err *err);

#endif
