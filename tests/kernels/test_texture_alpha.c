// Tests opacity: values against references, masks, and random decisions at blended surfaces, which
// must have the correct probability, be independent, and depend only on the place and the index of
// the query.
#include "texture_fixture.h"

enum { COUNT = 60000 };

static union texture_item items[COUNT], inputs[COUNT];

// Checks the number of successes in `count` trials with probability p: it must be within 5 standard
// deviations, which one of 1.7 million such tests exceeds.
static void check_binomial(uint32_t successes, uint32_t count, double p, const char *what)
{
    double deviation = sqrt(count * p * (1 - p));
    CHECK(fabs(successes - count * p) <= 5 * deviation, "%s: %u of %u, expected %g +- %g", what,
          successes, count, count * p, deviation);
}

static uint32_t add_alpha_material(struct scene *scene, uint32_t flags, float opacity, float cutoff)
{
    struct material m;
    material_init(&m);
    m.flags |= flags;
    m.opacity = opacity;
    m.alpha_cutoff = cutoff;
    return add_material(scene, &m);
}

// Makes a query for a primitive at barycentric coordinates, random but the same in all runs.
static void ask(union texture_item *item, uint32_t primitive, uint32_t material,
                struct random *random)
{
    memset(item, 0, sizeof *item);
    float u = (float)random_unit(random), v = (float)random_unit(random);
    item->u[0][0] = primitive;
    item->f[0][1] = u + v > 1 ? 1 - u : u;
    item->f[0][2] = u + v > 1 ? 1 - v : v;
    item->u[0][3] = primitive;
    item->u[1][3] = material | MATERIAL_WORD_ALPHA;
    for (int i = 0; i < 4; i++)
        item->u[2][i] = random_u32(random);
    item->u[2][2] &= 255;
}

// The opacity is the product of the material's opacity, the vertex alpha and the alphas of two
// textures. Textures that scale other parameters do not count.
TEST(opacities)
{
    struct setup setup;
    struct random random = {21};
    scene_start(&setup.scene, 8, 8);
    uint32_t material = add_alpha_material(&setup.scene, MATERIAL_ALPHA_BLEND, 0.75f, 0.5f);
    struct scene *scene = &setup.scene;
    uint32_t image = add_image(scene, 8, 8, true, 1);
    add_texture(scene, image, texture_scales(GROUP_BASE, (int[]){0, 1, 2, 3}));
    add_texture(scene, add_plain_image(scene, (float[]){0.5f, 0, 0, 0}),
                texture_scales(GROUP_BASE, (int[]){-1, -1, -1, 0}) | TEXTURE_UV1);
    add_texture(scene, add_plain_image(scene, (float[]){0, 0, 0, 0}),
                texture_scales(GROUP_BASE, (int[]){0, 1, 2, -1}));
    add_texture(scene, add_plain_image(scene, (float[]){0, 0, 0, 0}),
                texture_scales(GROUP_METAL, (int[]){0, 1, 2, 3}));
    add_texture(scene, add_plain_image(scene, (float[]){0, 0, 0, 0}),
                TEXTURE_USE_NORMAL << TEXTURE_USE_SHIFT);
    add_square(scene, material);
    OPEN_SETUP(&setup, TEXTURE_SLOTS);
    for (uint32_t k = 0; k < COUNT; k++)
        ask(&items[k], k & 1, material, &random);
    memcpy(inputs, items, sizeof items);
    REQUIRE(texture_run(&setup, ROUTINE_ALPHA, items, COUNT));
    // Texture lookup has its own test, so here another routine samples the texture.
    static union texture_item samples[COUNT];
    const struct mesh *mesh = &scene->meshes[0];
    double alphas[COUNT];
    for (uint32_t k = 0; k < COUNT; k++) {
        uint32_t first = 3 * setup.r.bvh.triangle_order[k & 1];
        const float *b = &inputs[k].f[0][1];
        float color[3][4], weights[3] = {1 - b[0] - b[1], b[0], b[1]};
        memset(&samples[k], 0, sizeof samples[k]);
        alphas[k] = 0;
        for (uint32_t c = 0; c < 3; c++) {
            corner_color(first + c, color[c]);
            alphas[k] += (double)(weights[c] * color[c][3]);
            for (int i = 0; i < 2; i++)
                samples[k].f[1][i] += weights[c] * mesh->uvs[0][first + c][i];
        }
    }
    REQUIRE(texture_run(&setup, ROUTINE_SAMPLE, samples, COUNT));
    for (uint32_t k = 0; k < COUNT; k++) {
        double expected = 0.75 * 0.5 * alphas[k] * (double)samples[k].f[0][3];
        CHECK(fabs((double)items[k].f[0][0] - expected) < 2e-6 &&
                  items[k].f[0][2] == items[k].f[0][0],
              "%g, expected %g", (double)items[k].f[0][0], expected);
    }
    setup_close(&setup);
}

TEST(masks)
{
    static const float cutoffs[] = {0, 0.25f, 0.5f, 0.75f, 1, 1.5f};
    for (size_t i = 0; i < sizeof cutoffs / sizeof *cutoffs; i++) {
        struct setup setup;
        struct random random = {22};
        uint32_t there = 0;
        scene_start(&setup.scene, 8, 8);
        uint32_t material = add_alpha_material(&setup.scene, MATERIAL_ALPHA_MASK, 1, cutoffs[i]);
        uint32_t image = add_image(&setup.scene, 8, 8, false, 1);
        add_texture(&setup.scene, image, texture_scales(GROUP_BASE, (int[]){0, 1, 2, 3}));
        add_square(&setup.scene, material)->colors = NULL;
        OPEN_SETUP(&setup, TEXTURE_SLOTS);
        for (uint32_t k = 0; k < COUNT; k++)
            ask(&items[k], k & 1, material, &random);
        REQUIRE(texture_run(&setup, ROUTINE_ALPHA, items, COUNT));
        for (uint32_t k = 0; k < COUNT; k++) {
            bool expected = items[k].f[0][0] >= cutoffs[i];
            there += expected;
            CHECK(items[k].f[0][1] == expected && items[k].f[0][2] == expected,
                  "cutoff %g, opacity %g: %g", (double)cutoffs[i], (double)items[k].f[0][0],
                  (double)items[k].f[0][1]);
        }
        CHECK(cutoffs[i] == 0   ? there == COUNT
              : cutoffs[i] >= 1 ? there == 0
                                : there > COUNT / 20 && there < COUNT * 0.99,
              "cutoff %g: %u", (double)cutoffs[i], there);
        setup_close(&setup);
    }
}

// Materials 1 … N have these opacities, without textures.
static const float opacities[] = {0, 1e-3f, 0.25f, 0.5f, 0.9f, 1};
enum { OPACITIES = sizeof opacities / sizeof *opacities };

static void open_blend(struct setup *setup)
{
    scene_start(&setup->scene, 8, 8);
    for (int i = 0; i < OPACITIES; i++) {
        uint32_t material =
            add_alpha_material(&setup->scene, MATERIAL_ALPHA_BLEND, opacities[i], 0.5f);
        add_square(&setup->scene, material)->colors = NULL;
    }
    OPEN_SETUP(setup, TEXTURE_SLOTS);
}

// The probability must be correct over pixels, samples, bounces, primitives and seeds, each alone.
TEST(blending_has_the_right_probability)
{
    struct setup setup;
    static const char *const names[] = {"pixels",    "samples",        "bounces",
                                        "crossings", "adjacent seeds", "all at random"};
    struct random random = {23};
    open_blend(&setup);
    REQUIRE(setup.r.gpu);
    for (int vary = 0; vary < 6; vary++)
        for (uint32_t i = 0; i < OPACITIES; i++) {
            for (uint32_t k = 0; k < COUNT; k++) {
                ask(&items[k], 0, i + 1, &random);
                if (vary == 5) {
                    items[k].u[0][3] = random_u32(&random);
                    continue;
                }
                for (int c = 0; c < 4; c++)
                    items[k].u[2][c] = 0;
                if (vary == 3)
                    items[k].u[0][3] = k;
                else
                    items[k].u[2][vary == 4 ? 3 : vary] = k << (vary == 2);
            }
            REQUIRE(texture_run(&setup, ROUTINE_ALPHA, items, COUNT));
            uint32_t there = 0;
            for (uint32_t k = 0; k < COUNT; k++)
                there += items[k].f[0][1] == 1;
            check_binomial(there, COUNT, (double)opacities[i], names[vary]);
        }
    setup_close(&setup);
}

// Decisions for two queries that differ in one respect must be independent: both occur together
// with the product of their probabilities.
TEST(decisions_are_independent)
{
    struct setup setup;
    static const char *const names[] = {"next pixel",          "next sample", "shadow and onwards",
                                        "next seed",           "next bounce", "next primitive",
                                        "far side of a sphere"};
    const double p = 0.5;
    struct random random = {24};
    open_blend(&setup);
    REQUIRE(setup.r.gpu);
    for (int pair = 0; pair < 7; pair++) {
        for (uint32_t k = 0; k < COUNT; k += 2) {
            ask(&items[k], 0, 4, &random);
            items[k].u[0][3] = random_u32(&random) % 1000000;
            items[k].u[2][2] &= ~1u;
            items[k + 1] = items[k];
            if (pair < 4)
                items[k + 1].u[2][pair]++;
            if (pair == 4)
                items[k + 1].u[2][2] += 2;
            if (pair == 5)
                items[k + 1].u[0][3]++;
            if (pair == 6)
                items[k + 1].u[0][3] |= 0x80000000u;
        }
        REQUIRE(texture_run(&setup, ROUTINE_ALPHA, items, COUNT));
        uint32_t both = 0, equal = 0;
        for (uint32_t k = 0; k < COUNT; k += 2) {
            both += items[k].f[0][1] == 1 && items[k + 1].f[0][1] == 1;
            equal += items[k].f[0][1] == items[k + 1].f[0][1];
        }
        check_binomial(both, COUNT / 2, p * p, names[pair]);
        check_binomial(equal, COUNT / 2, p, names[pair]);
    }
    setup_close(&setup);
}

// Queries have the same results in any order.
TEST(decisions_do_not_depend_on_order)
{
    struct setup setup;
    struct random random = {25};
    static union texture_item turned[COUNT];
    open_blend(&setup);
    REQUIRE(setup.r.gpu);
    for (uint32_t k = 0; k < COUNT; k++)
        ask(&items[k], k & 1, 1 + k % OPACITIES, &random);
    for (uint32_t k = 0; k < COUNT; k++)
        turned[k] = items[COUNT - 1 - k];
    REQUIRE(texture_run(&setup, ROUTINE_ALPHA, items, COUNT) &&
            texture_run(&setup, ROUTINE_ALPHA, turned, COUNT));
    uint32_t different = 0;
    for (uint32_t k = 0; k < COUNT; k++)
        different += memcmp(items[k].f[0], turned[COUNT - 1 - k].f[0], 16) != 0;
    CHECK(different == 0, "%u answers changed", different);
    setup_close(&setup);
}

// On shapes, texture coordinates follow from the point that is hit.
TEST(shapes)
{
    struct setup setup;
    struct random random = {26};
    const double center[3] = {0, 1, 0}, at[3] = {5, 0, 0}, up[3] = {0, 0, 1};
    scene_start(&setup.scene, 8, 8);
    uint32_t material = add_alpha_material(&setup.scene, MATERIAL_ALPHA_MASK, 1, 0.5f);
    // The left half is transparent, the right half opaque.
    uint32_t image = add_image(&setup.scene, 2, 1, true, 1);
    float *texels = (float *)(uintptr_t)setup.scene.images[image].texels;
    texels[3] = 0;
    texels[7] = 1;
    add_texture(&setup.scene, image,
                texture_scales(GROUP_BASE, (int[]){-1, -1, -1, 3}) | TEXTURE_NEAREST);
    add_sphere(&setup.scene, center, 2, material);
    add_disc(&setup.scene, at, up, 1, material);
    OPEN_SETUP(&setup, TEXTURE_SLOTS);
    for (uint32_t k = 0; k < COUNT; k++) {
        float d[3];
        ask(&items[k], PRIMITIVE_SHAPE | (k & 1), material, &random);
        random_direction(&random, d);
        for (int c = 0; c < 3; c++)
            items[k].f[1][c] =
                k & 1 ? (float)at[c] + (c < 2 ? d[c] : 0) : (float)center[c] + 2 * d[c];
    }
    memcpy(inputs, items, sizeof items);
    REQUIRE(texture_run(&setup, ROUTINE_ALPHA, items, COUNT));
    // The right half of the image is at +x, on a sphere and on this disc.
    for (uint32_t k = 0; k < COUNT; k++) {
        float x = inputs[k].f[1][0] - (k & 1 ? 5.0f : 0.0f);
        CHECK(fabsf(x) < 1e-5f || (items[k].f[0][1] == 1) == (x > 0), "shape %u, x %g: %g", k & 1,
              (double)x, (double)items[k].f[0][1]);
    }
    setup_close(&setup);
}

TEST_MAIN(TEST_CASE(opacities), TEST_CASE(masks), TEST_CASE(blending_has_the_right_probability),
          TEST_CASE(decisions_are_independent), TEST_CASE(decisions_do_not_depend_on_order),
          TEST_CASE(shapes))
