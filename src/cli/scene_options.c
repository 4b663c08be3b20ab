#include "cli/scene_options.h"

#include "base/hash.h"
#include "base/maths.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

static bool choose_camera(const struct options *options, const struct scene *scene,
                          uint32_t *camera, struct err *err)
{
    *camera = 0;
    if (!options->scene.camera)
        return true;
    for (uint32_t i = 0; i < scene->camera_count; i++) {
        const char *name = scene->cameras[i].name;
        if (name && strcmp(name, options->scene.camera) == 0) {
            *camera = i;
            return true;
        }
    }
    char *end;
    unsigned long index = strtoul(options->scene.camera, &end, 10);
    if (*end == '\0' && end != options->scene.camera && index < scene->camera_count) {
        *camera = (uint32_t)index;
        return true;
    }
    return err_set(err, ERR_USAGE,
                   "--camera %s: no such camera in %s: expected a name or an index below %u",
                   options->scene.camera, scene->path, scene->camera_count);
}

// The lens of the command line. It makes another scene.
static bool set_lens(const struct options *options, struct scene *scene, struct camera *camera,
                     struct err *err)
{
    bool aperture = options_given(options, OPTION_APERTURE);
    bool focus = options_given(options, OPTION_FOCUS_DISTANCE);
    if (!aperture && !focus)
        return true;
    if (camera->kind != CAMERA_PERSPECTIVE)
        return err_set(err, ERR_USAGE, "--%s: lenses go with perspective cameras; this one is %s",
                       aperture ? "aperture" : "focus-distance", camera_names[camera->kind]);
    if (aperture)
        camera->lens_radius = options->scene.aperture_mm * 1e-3;
    if (focus)
        camera->focus_distance = options->scene.focus_distance;
    if (camera->lens_radius > 0 && !(camera->focus_distance > 0))
        return err_set(err, ERR_USAGE,
                       "--aperture: the camera has no lens so far: expected --focus-distance, too");
    const double lens[] = {camera->lens_radius, camera->focus_distance};
    scene->hash = hash_bytes(scene->hash, lens, sizeof lens);
    return true;
}

struct scene_load_params options_scene_params(const struct options *options)
{
    const struct environment_option *environment = &options->scene.environment;
    bool has_radiance =
        options_given(options, OPTION_ENV) && !environment->file && !environment->is_sky;
    bool has_strength = options_given(options, OPTION_ENV_STRENGTH);
    return (struct scene_load_params){
        .path = options->arguments[0],
        .overrides = options->scene.overrides,
        .override_count = options->scene.override_count,
        .allow_outside_paths = options->scene.allow_outside_paths,
        .environment_file = environment->file,
        .environment_radiance = has_radiance ? environment->radiance : NULL,
        .environment_sky = environment->is_sky ? &environment->sky : NULL,
        .environment_rotation = options->scene.environment_rotate_degrees * DEGREE,
        .environment_strength = has_strength ? &options->scene.environment_strength : NULL,
        .at_seconds = options_given(options, OPTION_AT) ? &options->scene.at_seconds : NULL,
        .animation = options->scene.animation,
        .scene_name = options->scene.gltf_scene,
        .variant = options->scene.variant,
        .studio = options->scene.studio,
        .ground = options->scene.ground,
        .up = options->scene.up,
        .is_strict = options->scene.strict,
        .progress = options->progress,
    };
}

bool options_adapt_scene(const struct options *options, struct scene *scene, uint32_t *camera,
                         struct err *err)
{
    if (scene->is_empty)
        return err_set(err, ERR_INPUT,
                       "%s: the scene is empty: it has no triangle with an area, no shape and no "
                       "environment; expected something to see",
                       scene->path);
    options_apply_settings(options, &scene->settings);
    scene->progress = options->progress; // framing looks at all vertices
    scene_frame_camera(scene);
    scene->progress = NULL;
    if (progress_should_stop(options->progress))
        return err_set(err, ERR_STOPPED, "%s: loading was stopped", scene->path);
    return choose_camera(options, scene, camera, err) &&
           set_lens(options, scene, &scene->cameras[*camera], err);
}

bool options_load_scene(const struct options *options, struct scene *scene, uint32_t *camera,
                        struct err *err)
{
    struct scene_load_params params = options_scene_params(options);
    if (!scene_load(&params, scene, err))
        return false;
    return options_adapt_scene(options, scene, camera, err);
}

struct renderer_params options_renderer_params(const struct options *options, struct gpu *gpu,
                                               const struct scene *scene, uint32_t camera)
{
    return (struct renderer_params){
        .gpu = gpu,
        .scene = scene,
        .wave = options->device.wave,
        .workgroup = options->device.workgroup,
        .bvh = {options->device.bvh, options->device.node, options->device.bvh_optimize},
        .instancing = options->device.instances,
        .bvh_cache = options->device.bvh_cache,
        .camera = camera,
        .compile_all = options->device.features == FEATURES_ALL,
        .merge_classes = options->device.classes == CLASSES_MERGED,
        .progress = options->progress,
    };
}
