// Saves images and scenes.
#ifndef LAMPYRIS_VIEWER_CORE_SAVE_H
#define LAMPYRIS_VIEWER_CORE_SAVE_H

#include <stdbool.h>
#include <stdint.h>

struct viewer;

// These functions copy the current image and write it on the worker's thread; a message reports the
// end. With path NULL the file is "NAME-0001.png" in the working directory, with the first free
// number.
//
// Saves the image as it is displayed.
bool save_png(struct viewer *viewer, const char *path, bool with_panel);
// Saves the film of a side: linear values, metadata and AOVs. It is denoised only on request.
bool save_exr(struct viewer *viewer, uint32_t side, const char *path, bool denoised);
// Saves the scene as JSON. While another pose of an animation is being loaded, the scene is written
// when that pose is displayed (save_waiting_scene).
bool save_scene(struct viewer *viewer, const char *path);
// Writes the scene that waits for its pose, if the pose is loaded. With at_once, does not wait and
// writes it in the displayed pose.
void save_waiting_scene(struct viewer *viewer, bool at_once);

#endif
