// The document: a scene, the parameters with which it was loaded, and the edits made to it.
#ifndef LAMPYRIS_VIEWER_CORE_DOCUMENT_H
#define LAMPYRIS_VIEWER_CORE_DOCUMENT_H

#include "cli/scene_options.h"
#include "flatten/geometry.h"
#include "scene/sky/surroundings.h"
#include "viewer/core/pose.h"
#include "viewer/core/rebuild.h"

#define VIEWER_NO_OBJECT UINT32_MAX

struct picked {
    bool is_some;
    uint32_t object, material; // indices; the object is VIEWER_NO_OBJECT for the environment
    uint32_t primitive;
    double position[3], distance;
};

struct history;

struct document {
    char scene_path[SURROUNDINGS_PATH_MAX];
    struct scene_options scene_options; // the command-line options that apply to this scene
    // Parameters with which the scene was loaded; scene_write() needs them.
    struct scene_load_params load_params;
    char wanted_path[SURROUNDINGS_PATH_MAX]; // path of a scene to open after the current frame; "":
                                             // none
    bool wanted_keeps_view;
    bool has_scene;
    bool waits_to_save; // the scene will be saved at save_path when the requested pose is loaded
    char save_path[SURROUNDINGS_PATH_MAX]; // "": the first free name is used
    double load_seconds;
    struct scene scene; // the scene with all edits
    // The scene as loaded; has copies of the editable arrays, for scene_write().
    struct scene pristine;
    struct arena pristine_arena;
    struct surroundings_original original;
    struct surroundings surroundings;
    struct arena surroundings_arena;
    struct geometry geometry;
    struct rebuild rebuild;
    struct pose pose; // the current pose of the animation
    // Bounds of the scene in world space; min > max if it is empty.
    double bounds_min[3], bounds_max[3];
    struct history *history;

    struct picked picked;
    uint32_t chosen_material, chosen_light, chosen_object; // selected in the panel's lists
    bool has_choice; // the user has selected the object, which is then outlined
};

#endif
