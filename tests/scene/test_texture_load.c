// Tests images as textures: what is read, stored once, refused and noted.
#include "mesh_files.h"

#include "base/file.h"
#include "base/memory.h"
#include "image/image.h"
#include "scene/core/texture_load.h"

static struct scene scene;
static struct err error;

static void begin(void)
{
    scene = (struct scene){.path = "test"};
    error = (struct err){0};
}

static void end(void)
{
    scene_finish(&scene);
}

// Writes an image of width x height pixels with one colour; its name selects the format.
static void write_picture(const char *name, uint32_t width, uint32_t height, const float color[3])
{
    struct image image = {width, height, calloc((size_t)width * height, sizeof *image.pixels)};
    for (size_t i = 0; i < (size_t)width * height; i++)
        memcpy(image.pixels[i], color, sizeof image.pixels[i]);
    const struct image_write_params params = {.path = in_folder(name), .image = &image};
    CHECK(image_write(&params, &error), "%s", error.msg);
    free(image.pixels);
}

static bool load(const char *name, bool is_srgb, uint32_t *index)
{
    const struct texture_source source = {.path = in_folder(name), .is_srgb = is_srgb};
    return texture_image_load(&scene, &source, index, &error);
}

TEST(equal_images_are_kept_once)
{
    static const float grey[3] = {0.5f, 0.5f, 0.5f}, white[3] = {1, 1, 1};
    uint32_t a, same, linear, other, from_memory;
    begin();
    write_picture("a.png", 3, 2, grey);
    write_picture("b.png", 3, 2, grey);
    write_picture("c.png", 3, 2, white);
    REQUIRE(load("a.png", true, &a) && load("b.png", true, &same) &&
                load("a.png", false, &linear) && load("c.png", true, &other),
            "%s", error.msg);
    CHECK(a == same && linear != a && other != a && scene.image_count == 3, "%u images",
          scene.image_count);
    const struct texture_image *image = &scene.images[a];
    CHECK(image->width == 3 && image->height == 2 && image->values && !image->has_alpha);
    CHECK(fabsf(image->mean[0] - 0.5f) < 3e-3f && image->mean[3] == 1, "%g",
          (double)image->mean[0]);
    // The code of 0.5 is 188; without decoding it is 188 / 255.
    CHECK(fabsf(scene.images[linear].mean[1] - 188.0f / 255) < 3e-4f, "%g",
          (double)scene.images[linear].mean[1]);

    struct arena arena = {0};
    struct file_bytes bytes;
    REQUIRE(file_read(&arena, in_folder("a.png"), 0, &bytes, &error), "%s", error.msg);
    const struct texture_source source = {
        .data = bytes.data, .size = bytes.size, .name = "inside", .is_srgb = true};
    uint64_t hash = scene.hash;
    CHECK(texture_image_load(&scene, &source, &from_memory, &error) && from_memory == a, "%s",
          error.msg);
    CHECK(scene.hash != hash, "the scene's hash does not know of the file");
    arena_finish(&arena);
    end();
}

// Only emission may be scaled up; values that are clamped are reported.
TEST(texels_above_one_are_noted)
{
    static const float bright[3] = {0.5f, 1.5f, 0.25f}, plain[3] = {1, 1, 1};
    const uint32_t base = texture_scales(GROUP_BASE, (int[]){0, 1, 2, -1});
    const uint32_t emission = texture_scales(GROUP_EMISSION, (int[]){0, 1, 2, -1});
    struct texture texture = {.flags = emission};
    uint32_t second;
    begin();
    write_picture("bright.exr", 2, 2, bright);
    write_picture("plain.exr", 2, 2, plain);
    REQUIRE(load("bright.exr", true, &texture.image) && load("plain.exr", true, &second), "%s",
            error.msg);
    struct material *material = scene_add_material(&scene, NULL);
    material->name = "paint";
    CHECK(material_add_texture(&scene, material, &texture, &error) && scene.note_count == 0);
    texture.flags = base;
    CHECK(material_add_texture(&scene, material, &texture, &error) && scene.note_count == 1 &&
          strstr(scene.notes[0], "material \"paint\": texels of ") &&
          strstr(scene.notes[0], "bright.exr above 1 count as 1"));
    texture.image = second;
    CHECK(material_add_texture(&scene, material, &texture, &error) && scene.note_count == 1);
    end();
}

// Colour encodings do not apply to floats.
TEST(hdr_pictures_have_no_encoding)
{
    static const float bright[3] = {1e6f, 2, 0.25f};
    uint32_t a, b;
    begin();
    write_picture("a.exr", 2, 2, bright);
    REQUIRE(load("a.exr", true, &a) && load("a.exr", false, &b), "%s", error.msg);
    CHECK(a == b && scene.image_count == 1);
    // This exceeds the range of halves (docs/verification.md, C34).
    const float *texels = scene.images[a].texels;
    CHECK(!scene.images[a].values && texels[0] == 1e6f && texels[2] == 0.25f && texels[3] == 1,
          "%g", (double)texels[0]);
    CHECK(scene.images[a].mean[0] == 1e6f && scene.note_count == 0);
    end();
}

// See docs/verification.md, C31.
TEST(sides)
{
    static const float white[3] = {1, 1, 1};
    uint32_t index;
    begin();
    write_picture("one.png", 1, 1, white);
    write_picture("wide.png", 16384, 1, white);
    write_picture("widest.png", 65535, 1, white);
    write_picture("wider.png", 65536, 1, white);
    write_picture("higher.exr", 1, 65536, white);
    CHECK(load("one.png", true, &index) && scene.images[index].width == 1, "%s", error.msg);
    CHECK(load("wide.png", true, &index) && scene.images[index].width == 16384, "%s", error.msg);
    CHECK(load("widest.png", true, &index) && scene.images[index].width == 65535, "%s", error.msg);
    CHECK(!load("wider.png", true, &index) && error.code == ERR_INPUT &&
              strstr(error.msg, "wider.png") &&
              strstr(error.msg, "65536 x 1 pixels; expected at most 65535 on a side"),
          "%s", error.msg);
    CHECK(!load("higher.exr", true, &index) && error.code == ERR_INPUT, "%s", error.msg);
    CHECK(scene.image_count == 3);
    end();
}

TEST(texels_that_are_no_use_are_black_and_noted)
{
    static const float bad[] = {NAN, INFINITY, -INFINITY, -1};
    struct image image = {3, 2, calloc(6, sizeof *image.pixels)};
    uint32_t index;
    begin();
    for (int i = 0; i < 6; i++)
        image.pixels[i][0] = image.pixels[i][1] = image.pixels[i][2] = 0.5f;
    for (int i = 0; i < 4; i++)
        image.pixels[i][i % 3] = bad[i];
    const struct image_write_params params = {.path = in_folder("bad.exr"), .image = &image};
    CHECK(image_write(&params, &error), "%s", error.msg);
    free(image.pixels);
    REQUIRE(load("bad.exr", true, &index), "%s", error.msg);
    const float *texels = scene.images[index].texels;
    for (int i = 0; i < 6; i++)
        for (int c = 0; c < 3; c++)
            CHECK(texels[4 * i + c] == (i < 4 ? 0 : 0.5f) && texels[4 * i + 3] == 1, "texel %d: %g",
                  i, (double)texels[4 * i + c]);
    CHECK(scene.note_count == 1 && strstr(scene.notes[0], "bad.exr: 4 of 6 texels were"), "%s",
          scene.note_count ? scene.notes[0] : "");
    CHECK(fabsf(scene.images[index].mean[1] - 1.0f / 6) < 1e-7f && !scene.images[index].has_alpha);
    end();
}

TEST(what_cannot_be_read)
{
    static const float white[3] = {1, 1, 1};
    uint32_t index;
    begin();
    CHECK(!load("none.png", true, &index) && error.code == ERR_INPUT &&
              strstr(error.msg, "none.png"),
          "%s", error.msg);
    const struct texture_source text = {.data = "P6 1 1 255", .size = 10, .name = "images[3]"};
    CHECK(!texture_image_load(&scene, &text, &index, &error) && error.code == ERR_INPUT &&
              strstr(error.msg, "images[3]: is not an image"),
          "%s", error.msg);
    CHECK(scene.image_count == 0);
    // The budget is smaller than the texels.
    write_picture("large.png", 512, 512, white);
    memory_set_budget(1 << 20);
    CHECK(!load("large.png", true, &index) && error.code == ERR_BUDGET &&
              strstr(error.msg, "a picture of 512 x 512 pixels: 2.0 MiB are needed"),
          "%s", error.msg);
    memory_set_budget(8 << 20);
    CHECK(load("large.png", true, &index), "%s", error.msg);
    memory_set_budget(0);
    end();
}

TEST(textures_of_materials_are_adjacent)
{
    struct texture texture = {.flags = texture_scales(GROUP_METAL, (int[]){-1, 1, 2, -1})};
    begin();
    for (int i = 0; i < 8; i++)
        CHECK(scene_add_image(&scene, &texture.image));
    struct material *first = scene_add_material(&scene, NULL);
    CHECK(material_add_texture(&scene, first, &texture, &error) &&
              material_add_texture(&scene, first, &texture, &error),
          "%s", error.msg);
    struct material *second = scene_add_material(&scene, NULL);
    first = &scene.materials[0];
    CHECK(material_add_texture(&scene, second, &texture, &error), "%s", error.msg);
    CHECK(first->first_texture == 0 && first->texture_count == 2 && second->first_texture == 2 &&
          second->texture_count == 1 && scene.texture_count == 3);
    CHECK(scene.textures[2].image == 7);
    CHECK(!material_add_texture(&scene, first, &texture, &error) && error.code == ERR_BUG);
    CHECK(scene.texture_count == 3);
    end();
}

TEST(flags_of_scaling_textures)
{
    uint32_t flags = texture_scales(GROUP_METAL, (int[]){-1, 1, 2, -1});
    CHECK((flags >> TEXTURE_USE_SHIFT & 3) == TEXTURE_USE_SCALE);
    CHECK((flags >> TEXTURE_GROUP_SHIFT & 15) == GROUP_METAL);
    CHECK((flags >> TEXTURE_MASK_SHIFT & 15) == 6 && (flags >> TEXTURE_INVERT_SHIFT & 15) == 0);
    CHECK((flags >> (TEXTURE_CHANNELS_SHIFT + 2) & 3) == 1 &&
          (flags >> (TEXTURE_CHANNELS_SHIFT + 4) & 3) == 2);
    CHECK((texture_scales(GROUP_BASE, (int[]){0, 1, 2, 3}) >> TEXTURE_CHANNELS_SHIFT & 255) ==
          0xe4);
}

int main(int argc, char **argv)
{
    static const struct test_case cases[] = {
        TEST_CASE(equal_images_are_kept_once),
        TEST_CASE(texels_above_one_are_noted),
        TEST_CASE(hdr_pictures_have_no_encoding),
        TEST_CASE(sides),
        TEST_CASE(texels_that_are_no_use_are_black_and_noted),
        TEST_CASE(what_cannot_be_read),
        TEST_CASE(textures_of_materials_are_adjacent),
        TEST_CASE(flags_of_scaling_textures),
    };
    if (!begin_mesh_tests())
        return 1;
    return test_run(cases, sizeof cases / sizeof cases[0], argc, argv);
}
