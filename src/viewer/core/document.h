// The document that is edited: a scene, with what it was loaded from and what was done to it since.
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
    uint32_t object, material; // indices; VIEWER_NO_OBJECT: the surroundings
    uint32_t primitive;
    double position[3], distance;
};

struct history;

struct document {
    char scene_path[SURROUNDINGS_PATH_MAX];
    struct scene_options scene_options;      // those of the command line that concern this scene
    struct scene_load_params load_params;    // by which it was loaded: for scene_write
    char wanted_path[SURROUNDINGS_PATH_MAX]; // to be opened when no frame is being drawn; or ""
    bool wanted_keeps_view;
    bool has_scene;
    bool waits_to_save; // as scene, at save_path, when the pose that is wanted is there
    char save_path[SURROUNDINGS_PATH_MAX]; // "": one that is free
    double load_seconds;
    struct scene scene;    // as edited
    struct scene pristine; // as loaded: copies of the arrays that are edited, for scene_write
    struct arena pristine_arena;
    struct surroundings_original original;
    struct surroundings surroundings;
    struct arena surroundings_arena;
    struct geometry geometry;
    struct rebuild rebuild;
    struct pose pose;                    // of an animation
    double bounds_min[3], bounds_max[3]; // of the scene; min > max: it is empty
    struct history *history;

    struct picked picked;
    uint32_t chosen_material, chosen_light, chosen_object; // in the panel's lists
};

#endif
