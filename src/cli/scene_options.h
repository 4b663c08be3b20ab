// The options of the scene and of the renderer, which all commands that load a scene and the viewer
// share.
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

// The options of a scene. Numbers that were not given are NAN.
struct scene_options {
    const char *path;                   // the scene to load
    struct settings settings;           // only those that were given are valid
    bool is_set[SETTING_TOTAL];         // which settings were given
    const char *camera;                 // name or index; NULL: the first
    double aperture_mm;                 // radius of the lens
    double focus_distance;              // metres
    const char *gltf_scene, *animation; // names or indices; NULL: see option_table
    double at_seconds;
    const char *variant; // material variant of a glTF file; NULL: none
    struct environment_option environment;
    double environment_rotate_degrees; // about +Y, added to the scene's
    double environment_strength;       // factor on its radiance
    enum scene_studio studio;
    enum scene_ground ground;
    enum scene_up up;
    bool strict; // missing files are errors
    bool anisotropy;
    struct scene_override *overrides;
    uint32_t override_count;
    bool allow_outside_paths;
};

// Makes the parameters of loading from the options, to which they point.
struct scene_load_params options_scene_params(const struct scene_options *options,
                                              const struct progress *progress);
// Applies the rest of the command line to a loaded scene: settings, camera, lens.
bool options_adapt_scene(const struct scene_options *options, const struct progress *progress,
                         struct scene *scene, uint32_t *camera, struct err *err);
// Loads the scene and applies the command line to it.
bool options_load_scene(const struct scene_options *options, const struct progress *progress,
                        struct scene *scene, uint32_t *camera, struct err *err);
// Replaces the settings for which an option was given.
void options_apply_settings(const struct scene_options *options, struct settings *settings);

// Makes the parameters of a renderer from the options that all commands share, without AOVs.
struct renderer_params options_renderer_params(const struct device_options *options,
                                               struct gpu *gpu, const struct scene *scene,
                                               uint32_t camera);

#endif
