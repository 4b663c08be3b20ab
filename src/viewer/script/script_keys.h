// The names of keys in scripts, such as "A", "F12" and "Ctrl+Shift+Z".
#ifndef LAMPYRIS_VIEWER_SCRIPT_SCRIPT_KEYS_H
#define LAMPYRIS_VIEWER_SCRIPT_SCRIPT_KEYS_H

#include "base/err.h"
#include <stdint.h>

// Parses a key into GLFW's code and the modifiers (EVENT_SHIFT …) before it. On failure, err says
// what was expected.
bool script_key(const char *name, int *code, uint32_t *modifiers, struct err *err);

#endif
