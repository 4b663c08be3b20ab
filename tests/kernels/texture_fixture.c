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

static uint32_t add_texels(struct scene *scene, const struct texture_image *image)
{
    uint32_t index;
    struct texture_image *added = present(scene_add_image(scene, &index));
    *added = *image;
    added->name = "image";
    added->green[1] = 1;
    added->hash = added->hash ? added->hash : index + 1;
    return index;
}

uint32_t add_codes(struct scene *scene, uint32_t width, uint32_t height, const uint8_t (*codes)[4],
                   bool is_srgb, uint32_t seed)
{
    size_t bytes = (size_t)width * height * sizeof *codes;
    struct texture_image image = {
        .width = width, .height = height, .is_srgb = is_srgb, .hash = seed};
    void *texels = present(arena_alloc(&scene->arena, bytes, 1));
    float(*values)[4];
    struct err err = {0};
    memcpy(texels, codes, bytes);
    image.texels = texels;
    if (!image_code_values(is_srgb, &scene->arena, &values, &err))
        present(NULL);
    image.values = (const float(*)[4])values;
    return add_texels(scene, &image);
}

static uint32_t add_floats(struct scene *scene, uint32_t width, uint32_t height,
                           const float *values, uint32_t seed)
{
    size_t bytes = (size_t)width * height * 4 * sizeof *values;
    struct texture_image image = {.width = width, .height = height, .hash = seed};
    void *texels = present(arena_alloc(&scene->arena, bytes, 1));
    memcpy(texels, values, bytes);
    image.texels = texels;
    return add_texels(scene, &image);
}

uint32_t add_image(struct scene *scene, uint32_t width, uint32_t height, bool is_float,
                   uint32_t seed)
{
    struct random random = {seed};
    size_t count = (size_t)width * height * 4;
    float *values = present(calloc(count, sizeof *values));
    uint8_t(*codes)[4] = present(calloc(count, 1));
    for (size_t i = 0; i < count; i++) {
        values[i] = (float)random_unit(&random);
        codes[i / 4][i % 4] = (uint8_t)(256 * values[i]);
    }
    uint32_t index =
        is_float ? add_floats(scene, width, height, values, seed)
                 : add_codes(scene, width, height, (const uint8_t(*)[4])codes, seed % 2, seed);
    free(values);
    free(codes);
    return index;
}

uint32_t add_plain_image(struct scene *scene, const float color[4])
{
    return add_floats(scene, 1, 1, color, 0);
}

double image_texel(const struct texture_image *image, uint32_t x, uint32_t y, int c)
{
    float texel[4];
    texture_texel(image, (uint64_t)y * image->width + x, texel);
    return (double)texel[c];
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
