// Writes down a scene as it was edited: a file of our format that names the one it was loaded from
// ("base") and says what differs ("edits", see scene_edits.h), so that loading it again gives the
// very same scene, bit for bit.
#ifndef LAMPYRIS_SCENE_JSON_SCENE_WRITE_H
#define LAMPYRIS_SCENE_JSON_SCENE_WRITE_H

#include "scene/core/scene.h"

// After scene_load these may be edited:
// - materials: everything but their names and textures; lights: everything but their names, and
//   their profiles, which may be taken away only;
// - instances and shapes: `hidden` and `material`;
// - the environment: radiance and rotation; or all of it, by scene_replace_environment;
// - the camera and the settings.
// The time of a glTF base's pose.
struct scene_pose {
    double seconds;
    uint32_t is_posed; // 0: the nodes as they are without an animation
    uint32_t unused;   // 0: poses are compared byte by byte
};

struct scene_write_params {
    const char *path;                     // of the new file; an older one is replaced at one stroke
    const struct scene_load_params *load; // what gave `before`
    const struct scene *before;           // as scene_load left it: see scene_snapshot
    const struct scene *scene;            // the same, edited
    const struct camera *camera;          // becomes the file's first; NULL: scene->cameras[0]
    const struct settings *settings;      // NULL: the scene's
    // Set to whether the file names others that lie outside its folder, so that it loads with
    // allow_outside_paths only; or NULL. The file says so itself, in a comment.
    const struct scene_pose *pose; // that `before` and `scene` have now; NULL: as was loaded
    bool *is_outside;
};

// ERR_USAGE for a path that is the base's own, or that does not end in ".json"; ERR_INPUT for
// values which the format has no words for (not finite, out of range, names of files that are no
// UTF-8); ERR_OUTPUT. No file is written then.
bool scene_write(const struct scene_write_params *params, struct err *err);
// Finds out beforehand, from the path and what gave `before`, whether a file could be written
// there: ERR_USAGE as above; ERR_OUTPUT.
bool scene_write_check(const struct scene_write_params *params, struct err *err);

// A shallow copy that has arrays of its own of what may be edited (materials, lights, instances,
// shapes, cameras); all else is the original's and must outlive it. The copy's own arena is empty:
// it is never to be finished.
bool scene_snapshot(struct arena *arena, const struct scene *scene, struct scene *out,
                    struct err *err);

// Returns the text that follows "camera": in a scene file for a valid camera: one line for each
// key, with a line's indentation before each but the first. Reads back to the same bits. NULL when
// out of memory, and where a number is not finite.
char *camera_to_json(struct arena *arena, const struct camera *camera);

#endif
