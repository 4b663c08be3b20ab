// Only the textures and vertex attributes that a scene uses are uploaded, and equal images once.
#include "render/attributes.h"
#include "texture_fixture.h"

// Opens a renderer for the scene, to get the sizes of its buffers.
static void open_setup(struct setup *setup)
{
    OPEN_SETUP(setup, 128);
}

static uint64_t texel_bytes(const struct setup *setup)
{
    return setup->r.plan.buffers[BINDING_TEXELS].bytes;
}

#define SCALES_BASE texture_scales(GROUP_BASE, (int[]){0, 1, 2, -1})

TEST(unused_images_stay_away_and_equal_ones_are_there_once)
{
    struct setup setup;
    struct scene *scene = &setup.scene;
    scene_start(scene, 8, 8);
    struct material m;
    material_init(&m);
    uint32_t used = add_material(scene, &m);
    uint32_t codes = add_image(scene, 5, 3, false, 1); // 15 texels: 60 bytes, padded to words 64
    uint32_t equal = add_image(scene, 5, 3, false, 1);
    uint32_t floats = add_image(scene, 4, 4, true, 2); // 256 bytes
    uint32_t other = add_image(scene, 5, 3, false, 3); // 64 bytes
    add_image(scene, 64, 64, true, 4);                 // no texture uses it
    uint32_t unused = add_image(scene, 32, 32, true, 5);
    add_texture(scene, codes, SCALES_BASE);
    add_texture(scene, equal, SCALES_BASE | TEXTURE_UV1);
    add_texture(scene, floats, SCALES_BASE | TEXTURE_NEAREST);
    add_texture(scene, floats, TEXTURE_USE_NORMAL << TEXTURE_USE_SHIFT);
    add_texture(scene, other, SCALES_BASE);
    add_material(scene, &m); // no triangle uses it
    add_texture(scene, unused, SCALES_BASE);
    add_square(scene, used);
    open_setup(&setup);
    REQUIRE(setup.r.gpu);
    CHECK(texel_bytes(&setup) == 64 + 256 + 64, "%llu", (unsigned long long)texel_bytes(&setup));
    CHECK(setup.r.tables.textures.image_count == 3 &&
              setup.r.tables.textures.saved_bytes == 64 + 65536 + 16384,
          "%llu", (unsigned long long)setup.r.tables.textures.saved_bytes);

    // Each texture's record must refer to the texels of its image.
    static uint8_t bytes[384];
    struct err err = {0};
    REQUIRE(
        gpu_download(setup.r.gpu, &setup.r.buffers[BINDING_TEXELS], 0, bytes, sizeof bytes, &err),
        "%s", err.msg);
    for (uint32_t t = 0; t < 5; t++) {
        const struct texture_image *image = &scene->images[scene->textures[t].image];
        const struct gpu_texture *record = &setup.r.tables.textures.records[t];
        CHECK(memcmp(bytes + (size_t)record->texels * 16, image->texels,
                     (size_t)texture_image_bytes(image)) == 0,
              "texture %u", t);
        CHECK(record->size == (image->width | image->height << 16) &&
                  !(record->flags & TEXTURE_FLOAT) == (image->values != NULL),
              "texture %u", t);
    }
    CHECK(setup.r.tables.textures.records[0].texels == setup.r.tables.textures.records[1].texels);
    setup_close(&setup);
}

// Checks the bytes per triangle and their contents for each feature.
TEST(only_attributes_that_are_read)
{
    for (uint32_t mask = 0; mask < 16; mask++) {
        struct setup setup;
        struct scene *scene = &setup.scene;
        struct material m;
        material_init(&m);
        m.model = MATERIAL_PRINCIPLED;
        scene_start(scene, 8, 8);
        bool uv0 = mask & 1, uv1 = mask & 2, tangents = mask & 4, colors = mask & 8;
        m.anisotropic = tangents ? 0.5f : 0;
        uint32_t material = add_material(scene, &m);
        uint32_t image = add_image(scene, 2, 2, false, 1);
        if (uv0)
            add_texture(scene, image, SCALES_BASE);
        if (uv1)
            add_texture(scene, image, SCALES_BASE | TEXTURE_UV1);
        struct mesh *mesh = add_square(scene, material);
        if (!colors)
            mesh->colors = NULL;
        open_setup(&setup);
        REQUIRE(setup.r.gpu);
        uint32_t features = setup.r.specialization.features;
        uint64_t words = 1u + tangents + 2u * uv0 + 2u * uv1 + 2u * colors;
        CHECK(setup.r.plan.buffers[BINDING_ATTRIBUTES].bytes == 2 * 16 * words, "mask %u: %llu",
              mask, (unsigned long long)setup.r.plan.buffers[BINDING_ATTRIBUTES].bytes);
        CHECK(attribute_words(features) == words);
        CHECK(texel_bytes(&setup) == (uv0 || uv1 ? 16 : 0) &&
              !(features & FEATURE_TEXTURES) == !(uv0 || uv1));
        setup_close(&setup);
    }
}

// With shapes only, there are textures but no buffer of attributes.
TEST(shapes_need_no_attributes)
{
    struct setup setup;
    struct material m;
    material_init(&m);
    scene_start(&setup.scene, 8, 8);
    uint32_t material = add_material(&setup.scene, &m);
    add_texture(&setup.scene, add_image(&setup.scene, 2, 2, false, 1), SCALES_BASE);
    add_sphere(&setup.scene, (double[]){0, 0, 0}, 1, material);
    open_setup(&setup);
    REQUIRE(setup.r.gpu);
    CHECK(texel_bytes(&setup) == 16 && setup.r.plan.buffers[BINDING_ATTRIBUTES].bytes == 0);
    setup_close(&setup);
}

TEST_MAIN(TEST_CASE(unused_images_stay_away_and_equal_ones_are_there_once),
          TEST_CASE(only_attributes_that_are_read), TEST_CASE(shapes_need_no_attributes))
