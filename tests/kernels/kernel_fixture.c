#include "kernel_fixture.h"

// --- random numbers ------------------------------------------------------------------------------

uint32_t random_u32(struct random *random)
{
    uint64_t old = random->state;
    random->state = old * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    uint32_t shifted = (uint32_t)(((old >> 18) ^ old) >> 27), rotation = (uint32_t)(old >> 59);
    return shifted >> rotation | shifted << (-rotation & 31);
}

double random_unit(struct random *random)
{
    return random_u32(random) * 0x1p-32;
}

double random_between(struct random *random, double min, double max)
{
    return min + (max - min) * random_unit(random);
}

void random_direction(struct random *random, float direction[3])
{
    double z = random_between(random, -1, 1), angle = random_between(random, 0, 2 * M_PI);
    double radius = sqrt(1 - z * z);
    direction[0] = (float)(radius * cos(angle));
    direction[1] = (float)(radius * sin(angle));
    direction[2] = (float)z;
}

void pcg4d(uint32_t v[4])
{
    for (int i = 0; i < 4; i++)
        v[i] = v[i] * 1664525u + 1013904223u;
    for (int round = 0; round < 2; round++) {
        for (int i = 0; i < 4 && round == 1; i++)
            v[i] ^= v[i] >> 16;
        v[0] += v[1] * v[3];
        v[1] += v[2] * v[0];
        v[2] += v[0] * v[1];
        v[3] += v[1] * v[2];
    }
}

// --- vectors -------------------------------------------------------------------------------------

void subtract(const float a[3], const float b[3], double out[3])
{
    for (int c = 0; c < 3; c++)
        out[c] = (double)a[c] - (double)b[c];
}

// --- scenes --------------------------------------------------------------------------------------

static void *present(void *memory)
{
    if (!memory) {
        fprintf(stderr, "out of memory\n");
        exit(1);
    }
    return memory;
}

void scene_start(struct scene *scene, uint32_t width, uint32_t height)
{
    *scene = (struct scene){.path = "test", .settings = settings_default()};
    scene->settings.sampler = SAMPLER_PCG;
    scene->settings.width = width;
    scene->settings.height = height;
    add_material(scene, &(struct material){.name = "grey", .base_color = {0.5f, 0.5f, 0.5f}});
    struct camera *camera = present(scene_add_camera(scene, NULL));
    *camera = (struct camera){
        .name = "", .position = {0, 0, 4}, .direction = {0, 0, -1}, .up = {0, 1, 0}, .fov_y = 1.0};
}

uint32_t add_material(struct scene *scene, const struct material *material)
{
    uint32_t index;
    struct material *added = present(scene_add_material(scene, &index));
    *added = *material;
    return index;
}

void add_smooth_triangles(struct scene *scene, const float (*vertices)[3][3],
                          const float (*normals)[3][3], uint32_t count, uint32_t material)
{
    uint32_t index;
    struct mesh *mesh = present(scene_add_mesh(scene, &index));
    mesh->vertex_count = 3 * count;
    mesh->triangle_count = count;
    mesh->material = material;
    mesh->positions = present(arena_alloc(&scene->arena, 3 * count, sizeof *mesh->positions));
    mesh->indices = present(arena_alloc(&scene->arena, count, sizeof *mesh->indices));
    memcpy(mesh->positions, vertices, count * sizeof *vertices);
    if (normals) {
        mesh->normals = present(arena_alloc(&scene->arena, 3 * count, sizeof *mesh->normals));
        memcpy(mesh->normals, normals, count * sizeof *normals);
    }
    for (uint32_t i = 0; i < 3 * count; i++)
        mesh->indices[i / 3][i % 3] = i;
    struct instance *instance = present(scene_add_instance(scene, NULL));
    *instance = (struct instance){.mesh = index, .material = SCENE_NONE};
    for (int i = 0; i < 3; i++)
        instance->transform[i][i] = 1;
}

void add_triangles(struct scene *scene, const float (*vertices)[3][3], uint32_t count,
                   uint32_t material)
{
    add_smooth_triangles(scene, vertices, NULL, count, material);
}

void add_sphere(struct scene *scene, const double center[3], double radius, uint32_t material)
{
    struct shape *shape = present(scene_add_shape(scene, NULL));
    *shape = (struct shape){.kind = SHAPE_SPHERE, .material = material, .radius = radius};
    memcpy(shape->center, center, sizeof shape->center);
}

void add_disc(struct scene *scene, const double center[3], const double normal[3], double radius,
              uint32_t material)
{
    add_sphere(scene, center, radius, material);
    struct shape *shape = &scene->shapes[scene->shape_count - 1];
    shape->kind = SHAPE_DISC;
    for (int c = 0; c < 3; c++)
        shape->normal[c] = normal[c] / vec3_norm(normal);
}

void add_environment_image(struct scene *scene, uint32_t width, uint32_t height)
{
    struct environment *environment = &scene->environment;
    *environment = (struct environment){
        .present = true, .radiance = {1, 1, 1}, .width = width, .height = height};
    uint32_t count = width * height;
    environment->texels = present(arena_alloc(&scene->arena, count, sizeof *environment->texels));
    for (uint32_t i = 0; i < count; i++)
        for (int c = 0; c < 3; c++)
            environment->texels[i][c] = (float)(3 * i + (uint32_t)c + 1);
}

// --- a renderer ----------------------------------------------------------------------------------

void setup_close(struct setup *setup)
{
    renderer_finish(&setup->r);
    gpu_close(&setup->gpu);
    scene_finish(&setup->scene);
}

// --- one kernel ----------------------------------------------------------------------------------

bool run_kernel(struct renderer *r, const struct gpu_kernel *kernel, uint32_t items,
                struct err *err)
{
    uint32_t workgroup = r->specialization.workgroup;
    if (!gpu_begin(r->gpu, &r->commands, err))
        return false;
    gpu_bind(r->gpu, &r->commands, &r->bindings[0]);
    gpu_push(r->gpu, &r->commands, &r->push, sizeof r->push);
    gpu_dispatch(r->gpu, &r->commands, kernel, (items + workgroup - 1) / workgroup);
    gpu_barrier(r->gpu, &r->commands);
    return gpu_submit(r->gpu, &r->commands, err) && gpu_wait(r->gpu, &r->commands, err);
}
