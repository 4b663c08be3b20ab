// Loads a complete scene from a path: calls the loader for the extension, then adds what the file
// lacks.
#include "scene/core/scene.h"

#include "base/ascii.h"
#include "base/file.h"
#include "base/hash.h"
#include "base/log.h"
#include "scene/core/emission.h"
#include "scene/core/environment.h"
#include "scene/core/framing.h"
#include "scene/core/texture_load.h"
#include "scene/json/load_json.h"
#include "scene/mesh/mesh_loader.h"
#include "scene/mesh/tangents.h"
#include "scene/sky/sky.h"
#include "scene/sky/studio.h"
#include <string.h>

// --- defaults for missing parts of a file --------------------------------------------------------

static bool provide_material(struct scene *scene, struct err *err)
{
    uint32_t grey;
    return scene->material_count > 0 || mesh_default_material(scene, SCENE_NONE, false, &grey, err);
}

// --- dispatch ------------------------------------------------------------------------------------

static bool load_mesh_alone(struct scene *scene, const struct scene_load_params *params,
                            struct err *err)
{
    uint32_t mesh;
    return load_mesh_by_extension(scene, params->path, SCENE_NONE, params->allow_outside_paths,
                                  &mesh, err) &&
           scene_place_meshes(scene, mesh, 1, err);
}

static bool has_area(const struct scene *scene, const struct instance *instance)
{
    const struct mesh *mesh = &scene->meshes[instance->mesh];
    uint32_t t = 0;
    while (t < mesh->triangle_count && !progress_stops_at(scene->progress, t + 1) &&
           !(triangle_world_area(mesh, instance->transform, t) > 0))
        t++;
    return t < mesh->triangle_count;
}

static void look_for_surfaces(struct scene *scene)
{
    bool has_any = scene->environment.present, has_visible = has_any;
    for (uint32_t i = 0; i < scene->shape_count && !has_visible; i++) {
        has_any = true;
        has_visible = !scene->shapes[i].hidden;
    }
    for (uint32_t i = 0; i < scene->instance_count && !has_visible; i++)
        if (has_area(scene, &scene->instances[i])) {
            has_any = true;
            has_visible = !scene->instances[i].hidden;
        }
    scene->is_empty = !has_any;
    scene->is_hidden = has_any && !has_visible;
}

// Makes the materials with missing images pink. A surface becomes pink all over, whatever the image
// was for, so that nobody overlooks it and no other map or lobe hides it.
static bool mark_missing_textures(struct scene *scene, struct err *err)
{
    uint32_t images = 0, materials = 0;
    for (uint32_t i = 0; i < scene->image_count; i++) {
        if (!scene->images[i].is_missing)
            continue;
        log_warn("%s; its surfaces are shown in pink", scene->images[i].name);
        images++;
    }
    for (uint32_t m = 0; m < scene->material_count && images > 0; m++)
        materials += material_mark_missing(scene, &scene->materials[m]);
    scene->missing_image_count = images;
    if (images == 0)
        return true;
    if (!scene_note(scene,
                    "%u images are missing: %u of %u materials are pink (--strict makes this an "
                    "error)",
                    images, materials, scene->material_count))
        return err_memory(err, "a note", 0);
    log_warn("%s", scene->notes[scene->note_count - 1]);
    return true;
}

// Checks that options for glTF are only used with glTF files. Scene files (.json) have "define" and
// one scene, and show models in them without animation.
static bool check_gltf_only(const struct scene_load_params *params, struct err *err)
{
    const struct {
        const void *value;
        const char *option;
    } wishes[] = {{params->scene_name, "--scene"},
                  {params->animation, "--animation"},
                  {params->at_seconds, "--at"},
                  {params->variant, "--variant"}};
    for (size_t i = 0; i < sizeof wishes / sizeof wishes[0]; i++)
        if (wishes[i].value)
            return err_set(err, ERR_USAGE, "%s: %s is only for .gltf and .glb files", params->path,
                           wishes[i].option);
    return true;
}

bool scene_unknown_extension(const char *path, struct err *err)
{
    return err_set(err, ERR_INPUT,
                   "%s: extension \"%s\" is unknown; expected json, gltf, glb, obj, ply or stl%s",
                   path, path_extension(path), mesh_file_hint(path));
}

static bool load_by_extension(struct scene *scene, const struct scene_load_params *params,
                              struct err *err)
{
    const char *extension = path_extension(params->path);
    bool is_gltf = ascii_equal(extension, "gltf") || ascii_equal(extension, "glb");
    if (!is_gltf && !check_gltf_only(params, err))
        return false;
    if (ascii_equal(extension, "json"))
        return load_json(scene, params, scene_load_into, err);
    if (params->override_count > 0)
        return err_set(err, ERR_USAGE, "%s: -D %s: only .json scenes have values to override",
                       params->path, params->overrides[0].key);
    scene->is_model = true;
    if (is_gltf)
        return load_gltf(scene, params, err);
    if (is_mesh_file(params->path))
        return load_mesh_alone(scene, params, err);
    return scene_unknown_extension(params->path, err);
}

static bool override_environment(struct scene *scene, const struct scene_load_params *params,
                                 struct err *err)
{
    const struct environment former = scene->environment;
    bool is_constant = params->environment_file || params->environment_radiance;
    if (params->studio == SCENE_STUDIO_ON && (params->environment_sky || is_constant))
        return err_set(err, ERR_USAGE,
                       "--studio on: the studio replaces the environment; expected "
                       "no --env");
    if (params->environment_sky && !scene_set_sky(scene, params->environment_sky, err))
        return false;
    if (is_constant &&
        !scene_set_environment(scene, params->environment_file, params->environment_radiance, err))
        return false;
    if (params->environment_sky || is_constant)
        scene_remove_sun(scene, &former);
    return true;
}

static bool finish_environment(struct scene *scene, const struct scene_load_params *params,
                               struct err *err)
{
    double strength = params->environment_strength ? *params->environment_strength : 1;
    return scene_adjust_environment(scene, params->environment_rotation, strength, err) &&
           scene_add_sky_sun(scene, err);
}

// Chooses exposure and tone curve for a scene that does not set them. A model was not composed as
// an image, so its exposure is computed from the luminance of the image, and its tone curve has a
// shoulder for highlights. The same holds under a sky from the command line, whose radiance does
// not fit the exposure that the file chose for its own light.
static bool provide_exposure(struct scene *scene, const struct scene_load_params *params)
{
    struct settings *settings = &scene->settings;
    bool is_ours = scene->has_studio || (scene->camera_is_framed && params->studio);
    if (!is_ours && !params->environment_sky)
        return true;
    scene->exposure_is_replaced =
        params->environment_sky && scene->has_own_exposure && !settings->exposure_is_auto;
    if (!scene->has_own_exposure || scene->exposure_is_replaced)
        settings->exposure_is_auto = true;
    if (!scene->has_own_tone)
        settings->tone_curve = TONE_ACES;
    return true;
}

// Adds what the scene lacks, but not to a file with a "base", which changes a scene that is
// complete already.
static bool provide_missing(struct scene *scene, const struct scene_load_params *params,
                            struct err *err)
{
    if (scene->base)
        return finish_environment(scene, params, err) && provide_exposure(scene, params);
    look_for_surfaces(scene);
    return provide_material(scene, err) && scene_provide_light(scene, params, err) &&
           finish_environment(scene, params, err) && scene_provide_camera(scene, err) &&
           scene_goes_on(scene, 0, err) && provide_exposure(scene, params) &&
           scene_note_additions(scene, err) && mark_missing_textures(scene, err) &&
           scene_generate_tangents(scene, err);
}

bool scene_load_into(struct scene *scene, const struct scene_load_params *params, struct err *err)
{
    scene->path = arena_strdup(&scene->arena, params->path);
    if (!scene->path)
        return err_memory(err, "a path", strlen(params->path) + 1);
    return load_by_extension(scene, params, err) && override_environment(scene, params, err) &&
           provide_missing(scene, params, err);
}

bool scene_load(const struct scene_load_params *params, struct scene *out, struct err *err)
{
    *out = (struct scene){
        .settings = settings_default(),
        .hash = HASH_INIT,
        .progress = params->progress,
        .up = params->up,
        .is_strict = params->is_strict,
    };
    progress_report(params->progress, "Loading", 0);
    bool ok = scene_load_into(out, params, err);
    progress_report(params->progress, "Loading", 1);
    out->progress = NULL;
    if (!ok)
        scene_finish(out);
    return ok;
}
