// The document: a scene, the parameters with which it was loaded, and its edits.
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
    uint32_t object, material; // indices; VIEWER_NO_OBJECT: the environment
    uint32_t primitive;
    double position[3], distance;
};

struct history;

struct document {
    char scene_path[SURROUNDINGS_PATH_MAX];
    struct scene_options scene_options;      // the options of the command line that apply to this
                                             // scene
    struct scene_load_params load_params;    // the parameters that loaded it, for scene_write
    char wanted_path[SURROUNDINGS_PATH_MAX]; // to be opened after the current frame; or ""
    bool wanted_keeps_view;
    bool has_scene;
    bool waits_to_save; // a scene is to be saved at save_path when the requested pose is loaded
    char save_path[SURROUNDINGS_PATH_MAX]; // "": a free name is chosen
    double load_seconds;
    struct scene scene;    // as edited
    struct scene pristine; // as loaded: copies of the editable arrays, for scene_write
    struct arena pristine_arena;
    struct surroundings_original original;
    struct surroundings surroundings;
    struct arena surroundings_arena;
    struct geometry geometry;
    struct rebuild rebuild;
    struct pose pose;                    // the animation's pose
    double bounds_min[3], bounds_max[3]; // bounds of the scene; min > max: it is empty
    struct history *history;

    struct picked picked;
    uint32_t chosen_material, chosen_light, chosen_object; // selected in the panel's lists
};

#endif
