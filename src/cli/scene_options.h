// The options of the scene and of the renderer. The viewer and all commands that load a scene share
// them.
#ifndef LAMPYRIS_CLI_SCENE_OPTIONS_H
#define LAMPYRIS_CLI_SCENE_OPTIONS_H

#include "scene/core/scene.h"
#include "scene/sky/sky.h"

struct device_options;
struct gpu;
struct renderer_params;

// The environment of --env: a file, a sky or a constant radiance.
struct environment_option {
    const char *file;
    bool is_sky, is_constant;
    struct sky sky;
    float radiance[3]; // W/(sr m^2)
};

// The options of a scene. A number that was not given is NAN.
struct scene_options {
    const char *path;                   // the scene to load
    struct settings settings;           // valid only for the settings that were given
    bool is_set[SETTING_TOTAL];         // flags of the settings that were given
    const char *camera;                 // name or index; NULL: the first camera
    double aperture_mm;                 // radius of the lens, in millimetres
    double focus_distance;              // in metres
    const char *gltf_scene, *animation; // names or indices; NULL: the defaults in option_table
    double at_seconds;
    const char *variant; // material variant of a glTF file; NULL: none
    struct environment_option environment;
    double environment_rotate_degrees; // about +Y, added to the rotation of the scene's environment
    double environment_strength;       // factor by which the environment's radiance is multiplied
    enum scene_studio studio;
    enum scene_ground ground;
    enum scene_up up;
    bool strict; // missing files are errors, not warnings
    bool anisotropy;
    struct scene_override *overrides;
    uint32_t override_count;
    bool allow_outside_paths;
};

// Makes the parameters for loading the scene. They refer to the options, which must outlive them.
struct scene_load_params options_scene_params(const struct scene_options *options,
                                              const struct progress *progress);
// Applies the options that loading does not use to a loaded scene: settings, camera and lens.
bool options_adapt_scene(const struct scene_options *options, const struct progress *progress,
                         struct scene *scene, uint32_t *camera, struct err *err);
// Loads the scene and applies the command line to it.
bool options_load_scene(const struct scene_options *options, const struct progress *progress,
                        struct scene *scene, uint32_t *camera, struct err *err);
// Replaces the settings for which an option was given.
void options_apply_settings(const struct scene_options *options, struct settings *settings);

// Makes a renderer's parameters from the options that all commands share; AOVs are not set.
struct renderer_params options_renderer_params(const struct device_options *options,
                                               struct gpu *gpu, const struct scene *scene,
                                               uint32_t camera);

#endif
