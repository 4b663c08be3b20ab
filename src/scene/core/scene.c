// The scene's growing arrays and its end of life.
#include "scene/core/scene.h"

#include "scene/core/affine.h"
#include <stdarg.h>
#include <string.h>

// The first capacity of a growing array; most scenes have a handful of each thing.
#define FIRST_CAPACITY 8

const char *const scene_up_names[] = {"y", "x", "z", NULL};
const char *const scene_studio_names[] = {"off", "auto", "on", NULL};
const char *const scene_ground_names[] = {"auto", "on", "off", NULL};

// Returns an array that begins with the `count` elements of `items` and has room for `more`:
// `items` itself while the capacity lasts, else a copy of twice the capacity or of what is asked
// for. The old one stays in the arena; doubling keeps the sum of all outgrown arrays below the size
// of the live one.
static void *reserve(struct arena *arena, void *items, uint32_t count, uint64_t more,
                     uint32_t *capacity, size_t size)
{
    if (more <= *capacity - count)
        return items;
    uint64_t needed = count + more, doubled = 2 * (uint64_t)*capacity;
    uint64_t grown_capacity = needed > doubled ? needed : doubled;
    void *grown = arena_alloc(arena, grown_capacity, size); // the budget is asked in any case
    if (!grown || grown_capacity > UINT32_MAX)
        return NULL;
    if (count > 0)
        memcpy(grown, items, count * size);
    *capacity = (uint32_t)grown_capacity;
    return grown;
}

static void *reserve_one(struct arena *arena, void *items, uint32_t count, uint32_t *capacity,
                         size_t size)
{
    return reserve(arena, items, count, *capacity == 0 ? FIRST_CAPACITY : 1, capacity, size);
}

struct material *scene_add_material(struct scene *scene, uint32_t *index)
{
    struct material *items = reserve_one(&scene->arena, scene->materials, scene->material_count,
                                         &scene->material_capacity, sizeof *items);
    if (!items)
        return NULL;
    scene->materials = items;
    if (index)
        *index = scene->material_count;
    struct material *added = &items[scene->material_count++];
    material_init(added);
    return added;
}

struct mesh *scene_add_mesh(struct scene *scene, uint32_t *index)
{
    struct mesh *items = reserve_one(&scene->arena, scene->meshes, scene->mesh_count,
                                     &scene->mesh_capacity, sizeof *items);
    if (!items)
        return NULL;
    scene->meshes = items;
    if (index)
        *index = scene->mesh_count;
    struct mesh *added = &items[scene->mesh_count++];
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
    struct instance *items = reserve_one(&scene->arena, scene->instances, scene->instance_count,
                                         &scene->instance_capacity, sizeof *items);
    if (!items)
        return NULL;
    scene->instances = items;
    if (index)
        *index = scene->instance_count;
    return &items[scene->instance_count++];
}

bool scene_reserve_instances(struct scene *scene, uint64_t more)
{
    struct instance *items = reserve(&scene->arena, scene->instances, scene->instance_count, more,
                                     &scene->instance_capacity, sizeof *items);
    if (items)
        scene->instances = items;
    return items || more == 0;
}

bool scene_reserve_shapes(struct scene *scene, uint64_t more)
{
    struct shape *items = reserve(&scene->arena, scene->shapes, scene->shape_count, more,
                                  &scene->shape_capacity, sizeof *items);
    if (items)
        scene->shapes = items;
    return items || more == 0;
}

struct shape *scene_add_shape(struct scene *scene, uint32_t *index)
{
    struct shape *items = reserve_one(&scene->arena, scene->shapes, scene->shape_count,
                                      &scene->shape_capacity, sizeof *items);
    if (!items)
        return NULL;
    scene->shapes = items;
    if (index)
        *index = scene->shape_count;
    return &items[scene->shape_count++];
}

struct sdf *scene_add_sdf(struct scene *scene, uint32_t *index)
{
    struct sdf *items = reserve_one(&scene->arena, scene->sdfs, scene->sdf_count,
                                    &scene->sdf_capacity, sizeof *items);
    if (!items)
        return NULL;
    scene->sdfs = items;
    if (index)
        *index = scene->sdf_count;
    return &items[scene->sdf_count++];
}

struct camera *scene_add_camera(struct scene *scene, uint32_t *index)
{
    struct camera *items = reserve_one(&scene->arena, scene->cameras, scene->camera_count,
                                       &scene->camera_capacity, sizeof *items);
    if (!items)
        return NULL;
    scene->cameras = items;
    if (index)
        *index = scene->camera_count;
    struct camera *added = &items[scene->camera_count++];
    added->name = "";
    return added;
}

struct texture_image *scene_add_image(struct scene *scene, uint32_t *index)
{
    struct texture_image *items = reserve_one(&scene->arena, scene->images, scene->image_count,
                                              &scene->image_capacity, sizeof *items);
    if (!items)
        return NULL;
    scene->images = items;
    if (index)
        *index = scene->image_count;
    struct texture_image *added = &items[scene->image_count++];
    added->name = "";
    return added;
}

struct texture *scene_add_texture(struct scene *scene, uint32_t *index)
{
    struct texture *items = reserve_one(&scene->arena, scene->textures, scene->texture_count,
                                        &scene->texture_capacity, sizeof *items);
    if (!items)
        return NULL;
    scene->textures = items;
    if (index)
        *index = scene->texture_count;
    struct texture *added = &items[scene->texture_count++];
    added->transform[0][0] = added->transform[1][1] = 1.0f;
    return added;
}

struct light *scene_add_light(struct scene *scene, uint32_t *index)
{
    struct light *items = reserve_one(&scene->arena, scene->lights, scene->light_count,
                                      &scene->light_capacity, sizeof *items);
    if (!items)
        return NULL;
    scene->lights = items;
    if (index)
        *index = scene->light_count;
    struct light *added = &items[scene->light_count++];
    added->name = "";
    return added;
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
    const char **notes = reserve_one(&scene->arena, scene->notes, scene->note_count,
                                     &scene->note_capacity, sizeof *notes);
    if (!text || !notes)
        return false;
    scene->notes = notes;
    notes[scene->note_count++] = text;
    return true;
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
