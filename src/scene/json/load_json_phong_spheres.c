// Spheres with Phong's model, from one sequence of random numbers, each with a material of its own.
#include "scene/generate/phong_spheres.h"
#include "scene/json/load_json.h"

#include <string.h>

static bool add_material(struct scene *scene, const struct phong_sphere *sphere, uint32_t number,
                         uint32_t *index)
{
    struct material *material = scene_add_material(scene, index);
    if (!material)
        return false;
    material->name = arena_printf(&scene->arena, "sphere %u", number);
    material->model = MATERIAL_PHONG;
    material->exponent = (float)phong_exponent((double)sphere->smoothness);
    memcpy(material->base_color, sphere->base_color, sizeof sphere->base_color);
    memcpy(material->specular_color, sphere->specular_color, sizeof sphere->specular_color);
    memcpy(material->emission, sphere->emission, sizeof sphere->emission);
    return material->name != NULL;
}

static bool add_sphere(struct scene *scene, const struct phong_sphere *sphere, uint32_t number)
{
    uint32_t material;
    if (!add_material(scene, sphere, number, &material))
        return false;
    struct shape *shape = scene_add_shape(scene, NULL);
    if (!shape)
        return false;
    *shape = (struct shape){
        .kind = SHAPE_SPHERE, .material = material, .radius = (double)sphere->radius};
    for (int c = 0; c < 3; c++)
        shape->center[c] = (double)sphere->center[c];
    return true;
}

static bool read_params(struct scene *scene, const struct json_node *node,
                        struct phong_spheres *params, struct err *err)
{
    uint64_t count = 0, seed = 0;
    double radii[2];
    if (!node_read_integer(node, "count", 1, PHONG_SPHERES_COUNT_MAX, &count, err) ||
        !node_read_integer(node, "seed", 0, UINT32_MAX, &seed, err) ||
        !node_read_pair(node, "radius", RANGE_RADIUS, radii, err) ||
        !node_read_number(node, "disc_radius", RANGE_RADIUS, &params->disc_radius, err))
        return false;
    params->count = (uint32_t)count;
    params->seed = (uint32_t)seed;
    params->min_radius = radii[0];
    params->max_radius = radii[1];
    params->progress = scene->progress;
    return true;
}

bool load_json_phong_spheres(struct scene *scene, const struct json_node *node, uint32_t material,
                             struct err *err)
{
    (void)material; // this type has no "material" key
    struct phong_spheres params;
    struct arena scratch = {0};
    uint32_t placed;
    if (!read_params(scene, node, &params, err))
        return false;
    struct phong_sphere *spheres = ARENA_NEW(&scratch, struct phong_sphere, params.count);
    bool ok = spheres || err_memory(err, "spheres", params.count * sizeof *spheres);
    ok = ok && (phong_spheres_place(&params, spheres, &placed, err) || node_prepend(node, err));
    for (uint32_t i = 0; ok && i < placed; i++)
        ok = add_sphere(scene, &spheres[i], i) || err_memory(err, "a sphere", sizeof *spheres);
    if (ok)
        ok = scene_note(scene, "phong_spheres: %u of %u tried spheres found a place", placed,
                        params.count) ||
             err_memory(err, "a note", 64);
    arena_finish(&scratch);
    return ok;
}
