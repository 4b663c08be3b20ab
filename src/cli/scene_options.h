// What the command line says of scene and renderer: shared by all commands that load one, and the
// viewer.
#ifndef LAMPYRIS_CLI_SCENE_OPTIONS_H
#define LAMPYRIS_CLI_SCENE_OPTIONS_H

#include "cli/options.h"
#include "render/render.h"

// What the options say of loading; as long as they live.
struct scene_load_params options_scene_params(const struct scene_options *options,
                                              const struct progress *progress);
// Applies the rest of the command line to a scene as it was loaded: settings, camera, lens.
bool options_adapt_scene(const struct scene_options *options, const struct progress *progress,
                         struct scene *scene, uint32_t *camera, struct err *err);
// Loads the scene and applies the command line to it.
bool options_load_scene(const struct scene_options *options, const struct progress *progress,
                        struct scene *scene, uint32_t *camera, struct err *err);
// What of a renderer the options decide, for any command; without AOVs.
struct renderer_params options_renderer_params(const struct device_options *options,
                                               struct gpu *gpu, const struct scene *scene,
                                               uint32_t camera);

#endif
