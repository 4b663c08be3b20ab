// Writing pictures and scenes.
#ifndef LAMPYRIS_VIEWER_CORE_SAVE_H
#define LAMPYRIS_VIEWER_CORE_SAVE_H

#include <stdbool.h>
#include <stdint.h>

struct viewer;

// Both take the picture as it is now and write it on the worker's thread; a message tells when it
// is there. path NULL: "NAME-0001.png" in the working directory, the first number that is free.
bool save_png(struct viewer *viewer, const char *path, bool with_panel); // as it is shown
// Side `side`'s film, linear, with metadata and the AOVs it has; denoised only where asked for.
bool save_exr(struct viewer *viewer, uint32_t side, const char *path, bool denoised);
// "Save as scene JSON". Where another pose of an animation is on its way, it is written when that
// is shown (save_waiting_scene).
bool save_scene(struct viewer *viewer, const char *path);
// Writes the scene that waits, if any, once its pose is there; at_once: as it is shown now.
void save_waiting_scene(struct viewer *viewer, bool at_once);

#endif
