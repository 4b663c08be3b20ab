#include "cli/scene_options.h"

#include "base/hash.h"
#include "base/maths.h"
#include "cli/options.h"
#include "render/render.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

static bool choose_camera(const struct scene_options *options, const struct scene *scene,
                          uint32_t *camera, struct err *err)
{
    *camera = 0;
    if (!options->camera)
        return true;
    for (uint32_t i = 0; i < scene->camera_count; i++) {
        const char *name = scene->cameras[i].name;
        if (name && strcmp(name, options->camera) == 0) {
            *camera = i;
            return true;
        }
    }
    char *end;
    unsigned long index = strtoul(options->camera, &end, 10);
    if (*end == '\0' && end != options->camera && index < scene->camera_count) {
        *camera = (uint32_t)index;
        return true;
    }
    return err_set(err, ERR_USAGE,
                   "--camera %s: no such camera in %s; expected a name or an index below %u",
                   options->camera, scene->path, scene->camera_count);
}

// Applies the lens of the command line, which changes the scene's hash.
static bool set_lens(const struct scene_options *options, struct scene *scene,
                     struct camera *camera, struct err *err)
{
    bool aperture = !isnan(options->aperture_mm);
    bool focus = !isnan(options->focus_distance);
    if (!aperture && !focus)
        return true;
    if (camera->kind != CAMERA_PERSPECTIVE)
        return err_set(err, ERR_USAGE,
                       "--%s: only perspective cameras have a lens; this camera is %s",
                       aperture ? "aperture" : "focus-distance", camera_names[camera->kind]);
    if (aperture)
        camera->lens_radius = options->aperture_mm * 1e-3;
    if (focus)
        camera->focus_distance = options->focus_distance;
    if (camera->lens_radius > 0 && !(camera->focus_distance > 0))
        return err_set(
            err, ERR_USAGE,
            "--aperture: the camera has no focus distance; expected --focus-distance, too");
    const double lens[] = {camera->lens_radius, camera->focus_distance};
    scene->hash = hash_bytes(scene->hash, lens, sizeof lens);
    return true;
}

struct scene_load_params options_scene_params(const struct scene_options *options,
                                              const struct progress *progress)
{
    const struct environment_option *environment = &options->environment;
    bool has_strength = !isnan(options->environment_strength);
    return (struct scene_load_params){
        .path = options->path,
        .overrides = options->overrides,
        .override_count = options->override_count,
        .allow_outside_paths = options->allow_outside_paths,
        .environment_file = environment->file,
        .environment_radiance = environment->is_constant ? environment->radiance : NULL,
        .environment_sky = environment->is_sky ? &environment->sky : NULL,
        .environment_rotation = options->environment_rotate_degrees * DEGREE,
        .environment_strength = has_strength ? &options->environment_strength : NULL,
        .at_seconds = !isnan(options->at_seconds) ? &options->at_seconds : NULL,
        .animation = options->animation,
        .scene_name = options->gltf_scene,
        .variant = options->variant,
        .studio = options->studio,
        .ground = options->ground,
        .up = options->up,
        .is_strict = options->strict,
        .progress = progress,
    };
}

// Makes all materials isotropic, and changes the hash, because the scene is now another one.
static void make_isotropic(struct scene *scene)
{
    static const char what[] = "isotropic";
    for (uint32_t i = 0; i < scene->material_count; i++)
        scene->materials[i].anisotropic = 0.0f;
    scene->hash = hash_bytes(scene->hash, what, sizeof what);
}

bool options_adapt_scene(const struct scene_options *options, const struct progress *progress,
                         struct scene *scene, uint32_t *camera, struct err *err)
{
    if (scene->is_empty)
        return err_set(err, ERR_INPUT,
                       "%s: the scene is empty: it has no triangle with an area, no shape and no "
                       "environment; expected something to see",
                       scene->path);
    options_apply_settings(options, &scene->settings);
    if (!options->anisotropy)
        make_isotropic(scene);
    scene->progress = progress; // framing visits all vertices
    scene_frame_camera(scene);
    scene->progress = NULL;
    if (progress_should_stop(progress))
        return err_set(err, ERR_STOPPED, "%s: loading was stopped", scene->path);
    return choose_camera(options, scene, camera, err) &&
           set_lens(options, scene, &scene->cameras[*camera], err);
}

bool options_load_scene(const struct scene_options *options, const struct progress *progress,
                        struct scene *scene, uint32_t *camera, struct err *err)
{
    struct scene_load_params params = options_scene_params(options, progress);
    if (!scene_load(&params, scene, err))
        return false;
    return options_adapt_scene(options, progress, scene, camera, err);
}

struct renderer_params options_renderer_params(const struct device_options *options,
                                               struct gpu *gpu, const struct scene *scene,
                                               uint32_t camera)
{
    return (struct renderer_params){
        .gpu = gpu,
        .scene = scene,
        .wave = options->wave,
        .tunes_wave = true,
        .workgroup = options->workgroup,
        .bvh = options->bvh,
        .instancing = options->instances,
        .bvh_cache = options->bvh_cache,
        .camera = camera,
        .compile_all = options->features == FEATURES_ALL,
        .merge_classes = options->classes == CLASSES_MERGED,
    };
}
