// Kernels compiled anew while the viewer runs.
#ifndef LAMPYRIS_VIEWER_CORE_RELOAD_H
#define LAMPYRIS_VIEWER_CORE_RELOAD_H

#include "base/err.h"

struct options;
struct reload;
struct viewer;

bool reload_create(const struct options *options, struct reload **out, struct err *err);
// Before worker_destroy: what is being compiled ends at once. Accepts NULL.
void reload_stop(struct reload *reload);
// When no renderer is left, but before gpu_close. Accepts NULL.
void reload_destroy(struct reload *reload, struct viewer *viewer);
// Compiles on the worker's thread; then sets viewer->stage.kernels and shaders_changed. Whoever
// finds that the device refuses the new ones sets viewer->stage.kernels back to what it was.
void reload_shaders(struct viewer *viewer);
bool reload_can_compile(const struct reload *reload, const char **why_not);
const char *reload_errors(const struct reload *reload); // "file:line: …" a line; "" without any
const char *reload_folder(const struct reload *reload);

#endif
