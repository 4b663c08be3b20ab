// Saves images and scenes.
#ifndef LAMPYRIS_VIEWER_CORE_SAVE_H
#define LAMPYRIS_VIEWER_CORE_SAVE_H

#include <stdbool.h>
#include <stdint.h>

struct viewer;

// Both copy the current image and write it on the worker's thread; a message reports the end. path
// NULL: "NAME-0001.png" in the working directory, with the first free number.
bool save_png(struct viewer *viewer, const char *path, bool with_panel); // as displayed
// Saves the film of a side, linear, with metadata and its AOVs; denoised only on request.
bool save_exr(struct viewer *viewer, uint32_t side, const char *path, bool denoised);
// "Save as scene JSON". While another pose of an animation is being loaded, the scene is written
// when that is shown (save_waiting_scene).
bool save_scene(struct viewer *viewer, const char *path);
// Writes a scene that waits for its pose, when that is loaded; at_once: in the displayed pose.
void save_waiting_scene(struct viewer *viewer, bool at_once);

#endif
