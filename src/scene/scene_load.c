// From a path to a complete scene: the loader for the extension, then what a file may leave out.
#include "scene.h"

#include "affine.h"
#include "bounds.h"
#include "environment.h"
#include "file.h"
#include "hash.h"
#include "load_json.h"
#include "mesh_loader.h"
#include "sky.h"
#include "tangents.h"
#include <math.h>
#include <string.h>
#include <strings.h>

// --- camera --------------------------------------------------------------------------------------

// A little from above, so that what lies flat is seen as well; a normal lens.
#define FRAMED_ELEVATION (15 * (M_PI / 180))
#define FRAMED_FOV_Y (40 * (M_PI / 180))

void scene_frame_camera(struct scene *scene)
{
    if (!scene->camera_is_framed || scene->camera_count == 0)
        return;
    const struct scene_part whole = scene_whole(scene);
    const struct bounds bounds = bounds_of_part(scene, &whole);
    double center[3] = {0, 0, 0}, radius = 0;
    if (!bounds_is_empty(&bounds)) {
        for (int i = 0; i < 3; i++)
            center[i] = (bounds.min[i] + bounds.max[i]) / 2;
        radius = bounds_radius(scene, &whole, center);
    }
    if (!(radius > 0) || !isfinite(radius))
        radius = 1;

    // The sphere touches the narrower pair of the frustum's sides.
    double aspect = (double)scene->settings.width / scene->settings.height;
    double half_height = FRAMED_FOV_Y / 2;
    double half_width = atan(aspect * tan(half_height));
    double distance = radius / sin(fmin(half_width, half_height));
    const double towards_camera[3] = {0, sin(FRAMED_ELEVATION), cos(FRAMED_ELEVATION)};
    struct camera *camera = &scene->cameras[0];
    for (int i = 0; i < 3; i++) {
        camera->position[i] = center[i] + distance * towards_camera[i];
        camera->direction[i] = -towards_camera[i];
        camera->up[i] = i == 1;
    }
    camera->fov_y = FRAMED_FOV_Y;
}

static bool provide_camera(struct scene *scene, struct err *err)
{
    if (scene->camera_count > 0)
        return true;
    struct camera *camera = scene_add_camera(scene, NULL);
    if (!camera || !scene_note(scene, "no camera in the file: framed from the front"))
        return err_memory(err, "a camera", sizeof *camera);
    camera->name = "framed";
    scene->camera_is_framed = true;
    scene_frame_camera(scene);
    return true;
}

// --- light and materials -------------------------------------------------------------------------

// What is unlit is to be seen, not to light a scene.
static bool is_emissive(const struct scene *scene, uint32_t index)
{
    const struct material *material = &scene->materials[index];
    return material_emits(material) && !(material->flags & MATERIAL_UNLIT);
}

static bool instance_is_emissive(const struct scene *scene, const struct instance *instance)
{
    const struct mesh *mesh = &scene->meshes[instance->mesh];
    if (instance->material != SCENE_NONE)
        return is_emissive(scene, instance->material);
    if (!mesh->triangle_material)
        return is_emissive(scene, mesh->material);
    for (uint32_t t = 0; t < mesh->triangle_count; t++)
        if (is_emissive(scene, mesh->triangle_material[t]))
            return true;
    return false;
}

static bool has_light(const struct scene *scene)
{
    if (scene->environment.present || scene->light_count > 0)
        return true;
    for (uint32_t i = 0; i < scene->instance_count; i++)
        if (instance_is_emissive(scene, &scene->instances[i]))
            return true;
    for (uint32_t i = 0; i < scene->shape_count; i++)
        if (is_emissive(scene, scene->shapes[i].material))
            return true;
    return false;
}

static bool provide_light(struct scene *scene, struct err *err)
{
    if (has_light(scene))
        return true;
    scene->environment = (struct environment){.present = true, .radiance = {1, 1, 1}};
    return scene_note(scene, "no light in the file: even environment of radiance 1") ||
           err_memory(err, "a note", 0);
}

static bool provide_material(struct scene *scene, struct err *err)
{
    uint32_t grey;
    return scene->material_count > 0 || mesh_default_material(scene, SCENE_NONE, false, &grey, err);
}

// --- dispatch ------------------------------------------------------------------------------------

static bool load_mesh_alone(struct scene *scene, const struct scene_load_params *params,
                            bool is_obj, struct err *err)
{
    uint32_t mesh;
    bool ok =
        is_obj ? load_obj(scene, params->path, SCENE_NONE, params->allow_outside_paths, &mesh, err)
               : load_ply(scene, params->path, SCENE_NONE, &mesh, err);
    return ok && scene_place_meshes(scene, mesh, 1, err);
}

// Our own format has defines and one scene; models in it stand as they are without animation.
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
            return err_set(err, ERR_USAGE, "%s: %s is for .gltf and .glb files alone", params->path,
                           wishes[i].option);
    return true;
}

static bool load_by_extension(struct scene *scene, const struct scene_load_params *params,
                              struct err *err)
{
    const char *extension = path_extension(params->path);
    bool is_gltf = strcasecmp(extension, "gltf") == 0 || strcasecmp(extension, "glb") == 0;
    if (!is_gltf && !check_gltf_only(params, err))
        return false;
    if (strcasecmp(extension, "json") == 0)
        return load_json(scene, params, err);
    if (params->override_count > 0)
        return err_set(err, ERR_USAGE, "%s: -D %s: only .json scenes have values to override",
                       params->path, params->overrides[0].key);
    if (is_gltf)
        return load_gltf(scene, params, err);
    if (strcasecmp(extension, "obj") == 0)
        return load_mesh_alone(scene, params, true, err);
    if (strcasecmp(extension, "ply") == 0)
        return load_mesh_alone(scene, params, false, err);
    return err_set(err, ERR_INPUT,
                   "%s: extension \"%s\" is unknown; expected json, gltf, glb, obj or ply",
                   params->path, extension);
}

static bool override_environment(struct scene *scene, const struct scene_load_params *params,
                                 struct err *err)
{
    const struct environment former = scene->environment;
    bool is_constant = params->environment_file || params->environment_radiance;
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

bool scene_loading(const struct scene *scene, double fraction, struct err *err)
{
    progress_report(scene->progress, "Loading", fraction);
    return scene_goes_on(scene, 0, err);
}

bool scene_goes_on(const struct scene *scene, uint64_t i, struct err *err)
{
    return !progress_stops_at(scene->progress, i) ||
           err_set(err, ERR_STOPPED, "stopped while loading the scene");
}

// A file with a "base" changes what is complete already.
static bool provide_missing(struct scene *scene, const struct scene_load_params *params,
                            struct err *err)
{
    if (scene->base)
        return finish_environment(scene, params, err);
    return provide_material(scene, err) && provide_light(scene, err) &&
           finish_environment(scene, params, err) && provide_camera(scene, err) &&
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
    };
    progress_report(params->progress, "Loading", 0);
    bool ok = scene_load_into(out, params, err);
    progress_report(params->progress, "Loading", 1);
    out->progress = NULL;
    if (!ok)
        scene_finish(out);
    return ok;
}
