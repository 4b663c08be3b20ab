// The scene's growing arrays and its destruction.
#include "scene/core/scene.h"

#include "scene/core/affine.h"
#include "scene/core/placement.h"
#include <stdarg.h>
#include <string.h>

const char *const scene_up_names[] = {"y", "x", "z", NULL};
const char *const scene_studio_names[] = {"off", "auto", "on", NULL};
const char *const scene_ground_names[] = {"auto", "on", "off", NULL};

// Appends to scene->ITEMS, which has ITEM_count elements. Stores the new index unless `index` is
// NULL.
#define APPEND(scene, items, item, index)                                                          \
    arena_append(&(scene)->arena, &(scene)->items, &(scene)->item##_count,                         \
                 &(scene)->item##_capacity, sizeof *(scene)->items, index)

struct material *scene_add_material(struct scene *scene, uint32_t *index)
{
    struct material *added = APPEND(scene, materials, material, index);
    if (added)
        material_init(added);
    return added;
}

struct mesh *scene_add_mesh(struct scene *scene, uint32_t *index)
{
    struct mesh *added = APPEND(scene, meshes, mesh, index);
    if (added)
        added->name = "";
    return added;
}

bool scene_append_mesh(struct scene *scene, const struct mesh *mesh, uint32_t *index,
                       struct err *err)
{
    struct mesh *added = scene_add_mesh(scene, index);
    if (!added)
        return err_memory(err, "a mesh", sizeof *added);
    *added = *mesh;
    return true;
}

struct instance *scene_add_instance(struct scene *scene, uint32_t *index)
{
    return APPEND(scene, instances, instance, index);
}

bool scene_reserve_instances(struct scene *scene, uint64_t more)
{
    struct instance *items = arena_reserve(&scene->arena, scene->instances, scene->instance_count,
                                           more, &scene->instance_capacity, sizeof *items);
    if (items)
        scene->instances = items;
    return items || more == 0;
}

bool scene_reserve_shapes(struct scene *scene, uint64_t more)
{
    struct shape *items = arena_reserve(&scene->arena, scene->shapes, scene->shape_count, more,
                                        &scene->shape_capacity, sizeof *items);
    if (items)
        scene->shapes = items;
    return items || more == 0;
}

struct shape *scene_add_shape(struct scene *scene, uint32_t *index)
{
    return APPEND(scene, shapes, shape, index);
}

struct sdf *scene_add_sdf(struct scene *scene, uint32_t *index)
{
    return APPEND(scene, sdfs, sdf, index);
}

struct camera *scene_add_camera(struct scene *scene, uint32_t *index)
{
    struct camera *added = APPEND(scene, cameras, camera, index);
    if (added)
        added->name = "";
    return added;
}

struct texture_image *scene_add_image(struct scene *scene, uint32_t *index)
{
    struct texture_image *added = APPEND(scene, images, image, index);
    if (added)
        added->name = "";
    return added;
}

struct texture *scene_add_texture(struct scene *scene, uint32_t *index)
{
    struct texture *added = APPEND(scene, textures, texture, index);
    if (added)
        added->transform[0][0] = added->transform[1][1] = 1.0f;
    return added;
}

struct light *scene_add_light(struct scene *scene, uint32_t *index)
{
    struct light *added = APPEND(scene, lights, light, index);
    if (added)
        added->name = "";
    return added;
}

struct scene_path *scene_add_override_path(struct scene *scene)
{
    return APPEND(scene, override_paths, override_path, NULL);
}

bool scene_parameter_is_textured(const struct scene *scene, const struct material *material,
                                 uint32_t parameter)
{
    for (uint32_t i = 0; i < material->texture_count; i++)
        if (texture_scales_parameter(&scene->textures[material->first_texture + i], parameter))
            return true;
    return false;
}

struct placed_object *scene_add_placed(struct scene *scene)
{
    return APPEND(scene, placed, placed, NULL);
}

bool scene_place_meshes(struct scene *scene, uint32_t first_mesh, uint32_t count, struct err *err)
{
    for (uint32_t i = 0; i < count; i++) {
        struct instance *instance = scene_add_instance(scene, NULL);
        if (!instance)
            return err_memory(err, "an instance", sizeof *instance);
        instance->mesh = first_mesh + i;
        instance->material = SCENE_NONE;
        memcpy(instance->transform, AFFINE_IDENTITY, sizeof instance->transform);
    }
    return true;
}

bool scene_note(struct scene *scene, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    const char *text = arena_vprintf(&scene->arena, format, arguments);
    va_end(arguments);
    const char **note = text ? APPEND(scene, notes, note, NULL) : NULL;
    if (note)
        *note = text;
    return note != NULL;
}

void scene_finish(struct scene *scene)
{
    if (!scene)
        return;
    arena_finish(&scene->arena);
    *scene = (struct scene){0};
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
