// Recompiles kernels while the viewer runs.
#ifndef LAMPYRIS_VIEWER_CORE_RELOAD_H
#define LAMPYRIS_VIEWER_CORE_RELOAD_H

#include "base/err.h"

struct options;
struct reload;
struct viewer;

bool reload_create(const struct options *options, struct reload **out, struct err *err);
// Cancels the compilation. Call it before worker_destroy(). Accepts NULL.
void reload_stop(struct reload *reload);
// Call this before gpu_close(), when no renderer exists any more. Accepts NULL.
void reload_destroy(struct reload *reload, struct viewer *viewer);
// Compiles the kernels on the worker's thread, then sets viewer->stage.kernels and shaders_changed.
// If the device rejects the new kernels, the caller restores viewer->stage.kernels.
void reload_shaders(struct viewer *viewer);
bool reload_can_compile(const struct reload *reload, const char **why_not);
// Returns one line "file:line: …" per error; "" if there are none.
const char *reload_errors(const struct reload *reload);
const char *reload_folder(const struct reload *reload);

#endif
