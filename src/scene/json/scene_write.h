// Writes an edited scene: a .json file that names the file from which the scene was loaded ("base")
// and lists the differences ("edits", see scene_edits.h), so that loading it gives the same scene,
// bit for bit.
#ifndef LAMPYRIS_SCENE_JSON_SCENE_WRITE_H
#define LAMPYRIS_SCENE_JSON_SCENE_WRITE_H

#include "scene/core/scene.h"

// After scene_load() the following may be edited:
// - materials: all members but names and textures;
// - lights: all members but names and profiles; a profile may only be removed;
// - instances and shapes: `hidden`, `material`, and the placement, by scene_place();
// - the lists of materials, lights and shapes: materials, lights and quads may be added;
// - the environment: radiance and rotation; or all of it, by scene_replace_environment();
// - the camera and the settings.

// The time of the pose of a glTF base.
struct scene_pose {
    double seconds;
    uint32_t is_posed; // 0: the nodes are not animated
    uint32_t unused;   // 0, because poses are compared byte by byte
};

struct scene_write_params {
    const char *path;                     // the new file; an existing one is replaced atomically
    const struct scene_load_params *load; // the parameters with which `before` was loaded
    const struct scene *before;           // the scene as scene_load() left it: see scene_snapshot()
    const struct scene *scene;            // the edited scene
    const struct camera *camera;          // the file's first camera; NULL: scene->cameras[0]
    const struct settings *settings;      // NULL: the scene's settings
    const struct scene_pose *pose;        // pose of `before` and `scene`; NULL: as loaded
    // If not NULL, receives whether the file refers to files outside its folder. Loading such a
    // file needs allow_outside_paths; a comment in the file says so.
    bool *is_outside;
};

// Writes the file. Fails with ERR_USAGE if the path is the base's own or does not end in ".json";
// with ERR_INPUT for values that the format cannot represent (not finite, out of range, file names
// that are not UTF-8); and with ERR_OUTPUT if the file cannot be written. On failure no file is
// written.
bool scene_write(const struct scene_write_params *params, struct err *err);
// Checks in advance, from the path and the parameters that loaded `before`, whether a file can be
// written there. Fails with ERR_USAGE as scene_write() does, or with ERR_OUTPUT.
bool scene_write_check(const struct scene_write_params *params, struct err *err);

// Makes a shallow copy with its own arrays of materials, lights, instances, shapes, cameras and
// placed objects, which may be edited. All other data belongs to the original, which must outlive
// the copy. The copy's own arena is empty. Never call scene_finish() for the copy.
bool scene_snapshot(struct arena *arena, const struct scene *scene, struct scene *out,
                    struct err *err);

// Returns the value of "camera" in a scene file for a valid camera. Each key has a line, indented
// except for the first line. Reading the text gives the same bits. Returns NULL when out of memory,
// or if a number is not finite.
char *camera_to_json(struct arena *arena, const struct camera *camera);

#endif
