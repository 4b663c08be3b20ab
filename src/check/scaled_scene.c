#include "check/scaled_scene.h"

static void scale_vector(double v[3], double factor)
{
    for (int c = 0; c < 3; c++)
        v[c] *= factor;
}

static void scale_mesh(struct mesh *mesh, double factor)
{
    for (uint32_t v = 0; v < mesh->vertex_count; v++)
        for (int c = 0; c < 3; c++)
            mesh->positions[v][c] *= (float)factor;
    for (uint32_t v = 0; mesh->exact_positions && v < mesh->vertex_count; v++)
        scale_vector(mesh->exact_positions[v], factor);
}

static void scale_shape(struct shape *shape, double factor)
{
    bool has_edges =
        shape->kind == SHAPE_QUAD || shape->kind == SHAPE_BOX || shape->kind == SHAPE_SDF;
    bool is_round = shape->kind == SHAPE_CYLINDER || shape->kind == SHAPE_TUBE;
    shape->radius *= factor;
    scale_vector(shape->center, factor);
    for (int axis = 0; axis < (has_edges ? 3 : is_round ? 1 : 0); axis++)
        scale_vector(shape->axes[axis], factor);
}

static void scale_light(struct light *light, double factor)
{
    scale_vector(light->position, factor);
    light->range *= (float)factor;
    for (int c = 0; c < 3 && light->kind != LIGHT_DIRECTIONAL; c++)
        light->radiant[c] = (float)((double)light->radiant[c] * factor * factor);
}

void scale_scene(struct scene *scene, double factor)
{
    for (uint32_t i = 0; i < scene->mesh_count; i++)
        scale_mesh(&scene->meshes[i], factor);
    for (uint32_t i = 0; i < scene->instance_count; i++)
        for (int row = 0; row < 3; row++)
            scene->instances[i].transform[row][3] *= factor;
    for (uint32_t i = 0; i < scene->shape_count; i++)
        scale_shape(&scene->shapes[i], factor);
    for (uint32_t i = 0; i < scene->light_count; i++)
        scale_light(&scene->lights[i], factor);
    for (uint32_t i = 0; i < scene->material_count; i++)
        for (int c = 0; c < 3; c++)
            scene->materials[i].extinction[c] =
                (float)((double)scene->materials[i].extinction[c] / factor);
    for (uint32_t i = 0; i < scene->camera_count; i++) {
        struct camera *camera = &scene->cameras[i];
        scale_vector(camera->position, factor);
        camera->height *= factor;
        camera->lens_radius *= factor;
        camera->focus_distance *= factor;
    }
    scene->settings.ao_distance *= (float)factor;
}
