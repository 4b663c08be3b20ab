#include "texture_fixture.h"

#include "texture_test.spv.h"

_Static_assert(sizeof(union texture_item) == sizeof(struct gpu_path), "they share a buffer");

// --- running -------------------------------------------------------------------------------------

static bool create_kernel(struct renderer *r, uint32_t routine, struct gpu_kernel *kernel,
                          struct err *err)
{
    uint32_t constants[CONSTANT_ROUTINE + 1];
    memcpy(constants, &r->specialization, 4 * CONSTANT_COUNT);
    constants[CONSTANT_FEATURES] &= ~FEATURE_TEXEL_STATE; // the test writes to buffers that the
                                                          // kernel reads
    constants[CONSTANT_LOBES] |= LOBE_ANISOTROPIC;
    constants[CONSTANT_ROUTINE] = routine;
    const struct gpu_kernel_params params = {
        .name = "texture",
        .spirv = texture_spirv,
        .spirv_bytes = sizeof texture_spirv,
        .constants = constants,
        .constant_count = CONSTANT_ROUTINE + 1,
    };
    return gpu_kernel_create(r->gpu, &params, kernel, err);
}

static bool run_part(struct renderer *r, const struct gpu_kernel *kernel, union texture_item *items,
                     uint32_t count, struct err *err)
{
    struct gpu_buffer *buffer = &r->buffers[BINDING_PATHS];
    r->push.first_item = 0;
    r->push.part_items = count;
    return gpu_upload(r->gpu, buffer, 0, items, count * sizeof *items, err) &&
           run_kernel(r, kernel, count, err) &&
           gpu_download(r->gpu, buffer, 0, items, count * sizeof *items, err);
}

bool texture_run(struct setup *setup, uint32_t routine, union texture_item *items, uint32_t count)
{
    struct renderer *r = &setup->r;
    struct gpu_kernel kernel = {0};
    struct err err = {0};
    bool ok = create_kernel(r, routine, &kernel, &err);
    for (uint32_t first = 0; first < count && ok; first += r->plan.wave_slots) {
        uint32_t left = count - first;
        uint32_t part = left < r->plan.wave_slots ? left : r->plan.wave_slots;
        ok = run_part(r, &kernel, items + first, part, &err);
    }
    CHECK(ok, "%s", err.msg);
    gpu_kernel_finish(r->gpu, &kernel);
    return ok;
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

static uint32_t add_texels(struct scene *scene, uint32_t width, uint32_t height, bool is_float,
                           const float *values)
{
    uint32_t index;
    size_t count = (size_t)width * height * 4;
    float *floats = present(arena_alloc(&scene->arena, count, sizeof *floats));
    uint16_t *halves = present(arena_alloc(&scene->arena, count, sizeof *halves));
    struct texture_image *image = present(scene_add_image(scene, &index));
    for (size_t i = 0; i < count; i++) {
        floats[i] = values[i];
        halves[i] = half_from_float(values[i]);
    }
    *image = (struct texture_image){
        .name = "image",
        .width = width,
        .height = height,
        .is_float = is_float,
        .texels = is_float ? (void *)floats : (void *)halves,
        .hash = index + 1,
    };
    return index;
}

uint32_t add_image(struct scene *scene, uint32_t width, uint32_t height, bool is_float,
                   uint32_t seed)
{
    struct random random = {seed};
    size_t count = (size_t)width * height * 4;
    float *values = present(calloc(count, sizeof *values));
    for (size_t i = 0; i < count; i++)
        values[i] = (float)random_unit(&random);
    uint32_t index = add_texels(scene, width, height, is_float, values);
    scene->images[index].hash = seed;
    free(values);
    return index;
}

uint32_t add_plain_image(struct scene *scene, const float color[4], bool is_float)
{
    return add_texels(scene, 1, 1, is_float, color);
}

double image_texel(const struct texture_image *image, uint32_t x, uint32_t y, int c)
{
    size_t i = ((size_t)y * image->width + x) * 4 + (size_t)c;
    return image->is_float ? (double)((const float *)image->texels)[i]
                           : (double)float_from_half(((const uint16_t *)image->texels)[i]);
}

struct texture *add_texture(struct scene *scene, uint32_t image, uint32_t flags)
{
    const struct texture texture = {
        .image = image, .flags = flags, .transform = {{1, 0, 0}, {0, 1, 0}}};
    struct err err = {0};
    if (!material_add_texture(scene, &scene->materials[scene->material_count - 1], &texture, &err))
        present(NULL);
    return &scene->textures[scene->texture_count - 1];
}

void corner_color(uint32_t vertex, float out[4])
{
    for (uint32_t c = 0; c < 4; c++)
        out[c] = (float)(1 + vertex + 4 * c) / 32;
}

struct mesh *add_square(struct scene *scene, uint32_t material)
{
    static const float triangles[2][3][3] = {{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}},
                                             {{0, 0, 0}, {1, 1, 0}, {0, 1, 0}}};
    static const float normals[2][3][3] = {{{0, 0, 1}, {0, 0, 1}, {0, 0, 1}},
                                           {{0, 0, 1}, {0, 0, 1}, {0, 0, 1}}};
    add_smooth_triangles(scene, triangles, normals, 2, material);
    struct mesh *mesh = &scene->meshes[scene->mesh_count - 1];
    mesh->tangents = present(arena_alloc(&scene->arena, 6, sizeof *mesh->tangents));
    mesh->colors = present(arena_alloc(&scene->arena, 6, sizeof *mesh->colors));
    for (int set = 0; set < 2; set++)
        mesh->uvs[set] = present(arena_alloc(&scene->arena, 6, sizeof *mesh->uvs[set]));
    for (uint32_t v = 0; v < 6; v++) {
        const float tangent[4] = {1, 0, 0, 1};
        memcpy(mesh->tangents[v], tangent, sizeof tangent);
        corner_color(v, mesh->colors[v]);
        for (int set = 0; set < 2; set++)
            for (int c = 0; c < 2; c++)
                mesh->uvs[set][v][c] = (float)(1 + set) * mesh->positions[v][c];
    }
    return mesh;
}
