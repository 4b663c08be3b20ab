// Tests texture lookups on the device against a reference in double precision.
#include "texture_fixture.h"

enum { ITEMS_A_TEXTURE = 400, TEXTURES_MAX = 512 };

static const struct {
    uint32_t width, height;
} sizes[] = {{1, 1}, {2, 1}, {3, 5}, {16, 16}, {7, 64}, {1, 33}};

// Transforms that are exact in single precision for coordinates that are multiples of 2^-12, or
// not.
static const struct {
    float rows[2][3];
    bool is_exact;
} transforms[] = {
    {{{1, 0, 0}, {0, 1, 0}}, true},
    {{{0, 2, 0.25f}, {-4, 0, -0.5f}}, true},
    {{{0.8f, 0.6f, 0.1f}, {-0.6f, 0.8f, 7.3f}}, false},
};

static union texture_item items[TEXTURES_MAX * ITEMS_A_TEXTURE];

// --- the reference -------------------------------------------------------------------------------

// Returns the texel of an unbounded place.
static uint32_t wrap(double i, uint32_t size, uint32_t mode)
{
    double period = mode == TEXTURE_WRAP_MIRROR ? 2.0 * size : size;
    if (mode == TEXTURE_WRAP_CLAMP)
        return i < 0 ? 0 : i >= size ? size - 1 : (uint32_t)i;
    double within = i - period * floor(i / period);
    return (uint32_t)(within < size ? within : period - 1 - within);
}

static void coordinates(const struct texture *texture, const union texture_item *in, double st[2])
{
    const float *uv = &in->f[1][texture->flags & TEXTURE_UV1 ? 2 : 0];
    for (int row = 0; row < 2; row++)
        st[row] = (double)texture->transform[row][0] * (double)uv[0] +
                  (double)texture->transform[row][1] * (double)uv[1] +
                  (double)texture->transform[row][2];
}

static double reference(const struct texture *texture, const struct texture_image *image,
                        const double st[2], int c)
{
    uint32_t mode[2] = {texture->flags >> TEXTURE_WRAP_S_SHIFT & 3u,
                        texture->flags >> TEXTURE_WRAP_T_SHIFT & 3u};
    double x = st[0] * image->width, y = st[1] * image->height;
    if (texture->flags & TEXTURE_NEAREST)
        return image_texel(image, wrap(floor(x), image->width, mode[0]),
                           wrap(floor(y), image->height, mode[1]), c);
    double x0 = floor(x - 0.5), y0 = floor(y - 0.5), sum = 0;
    for (int i = 0; i < 4; i++) {
        double column = x0 + i % 2, row = y0 + i / 2;
        double weight = (1 - fabs(x - 0.5 - column)) * (1 - fabs(y - 0.5 - row));
        sum += weight * image_texel(image, wrap(column, image->width, mode[0]),
                                    wrap(row, image->height, mode[1]), c);
    }
    return sum;
}

// --- inputs --------------------------------------------------------------------------------------

static float coordinate(struct random *random, uint32_t size, int kind)
{
    static const float specials[] = {0,    1,     -1,           0.5f,  -0.0f,
                                     1e6f, -1e6f, 999999.9375f, 1e-8f, -1e-8f};
    switch (kind) {
    case 0:
        return (float)random_unit(random);
    case 1:
        return (float)random_between(random, -10, 10);
    case 2: // steps of 2^-4
        return (float)random_between(random, -1e6, 1e6);
    case 3: // edges and centres of texels
        return (float)(int32_t)(random_u32(random) % (8 * size + 1) - 4 * size) / (float)(2 * size);
    default:
        return specials[random_u32(random) % (sizeof specials / sizeof specials[0])];
    }
}

static void fill_items(const struct scene *scene)
{
    struct random random = {7};
    for (uint32_t t = 0; t < scene->texture_count; t++) {
        const struct texture_image *image = &scene->images[scene->textures[t].image];
        for (uint32_t i = 0; i < ITEMS_A_TEXTURE; i++) {
            union texture_item *item = &items[t * ITEMS_A_TEXTURE + i];
            item->u[0][0] = t;
            for (int c = 0; c < 4; c++) {
                uint32_t size = c % 2 ? image->height : image->width;
                item->f[1][c] = coordinate(&random, size, (int)(i % 5));
                if (i % 2)
                    item->f[1][c] = roundf(item->f[1][c] * 4096) / 4096;
            }
        }
    }
}

// Returns the possible error of the device's place, in texels: the rounding errors of the
// transform, of wrapping and of the multiplication.
static double place_error(const struct texture *texture, const struct texture_image *image,
                          const union texture_item *in, int axis, bool is_exact)
{
    const float *uv = &in->f[1][texture->flags & TEXTURE_UV1 ? 2 : 0];
    const float *row = texture->transform[axis];
    double size = axis ? image->height : image->width;
    double terms =
        fabs((double)(row[0] * uv[0])) + fabs((double)(row[1] * uv[1])) + fabs((double)row[2]);
    return size * 0x1p-24 * (2 + (is_exact ? 0 : 4 * terms));
}

struct worst {
    double error;
    uint32_t wrong, skipped, checked;
};

static void check_item(const struct scene *scene, const union texture_item *in,
                       const union texture_item *out, bool is_exact, struct worst *worst)
{
    const struct texture *texture = &scene->textures[in->u[0][0]];
    const struct texture_image *image = &scene->images[texture->image];
    double st[2], slack = 0;
    coordinates(texture, in, st);
    double place[2] = {st[0] * image->width, st[1] * image->height};
    for (int axis = 0; axis < 2; axis++) {
        double error = place_error(texture, image, in, axis, is_exact);
        slack += error;
        // Rounding decides which texel contains an edge, unless nothing was rounded; for mirrored
        // textures it decides in any case.
        uint32_t shift = axis ? TEXTURE_WRAP_T_SHIFT : TEXTURE_WRAP_S_SHIFT;
        bool is_mirrored = (texture->flags >> shift & 3u) == TEXTURE_WRAP_MIRROR;
        bool is_rounded =
            !is_exact || place[axis] < 0 || place[axis] != round(place[axis]) || is_mirrored;
        if (texture->flags & TEXTURE_NEAREST && is_rounded &&
            fabs(place[axis] - round(place[axis])) <= error) {
            worst->skipped++;
            return;
        }
    }
    worst->checked++;
    for (int c = 0; c < 4; c++) {
        double error = fabs((double)out->f[0][c] - reference(texture, image, st, c));
        // Neighbours differ by at most 1, and the interpolation has four rounding errors.
        bool ok = error <= slack + 4 * 0x1p-24;
        worst->error = fmax(worst->error, is_exact ? error : 0);
        worst->wrong += !ok;
        CHECK(ok || worst->wrong > 10,
              "image %u x %u, flags %x, coordinates (%.9g, %.9g) -> (%.9g, %.9g), component %d: "
              "%.9g, expected %.9g",
              image->width, image->height, texture->flags, (double)in->f[1][0], (double)in->f[1][1],
              st[0], st[1], c, (double)out->f[0][c], reference(texture, image, st, c));
    }
}

// --- tests ---------------------------------------------------------------------------------------

// Tests every wrap mode, filter, transform and UV set, with images of `formats`: 1 codes, 2
// floats, 3 both in alternation.
static void check_formats(int formats)
{
    struct setup setup;
    static union texture_item inputs[TEXTURES_MAX * ITEMS_A_TEXTURE];
    static bool exact[TEXTURES_MAX];
    uint32_t images[6];
    scene_start(&setup.scene, 8, 8);
    add_material(&setup.scene, &(struct material){.name = "textured"});
    for (uint32_t i = 0; i < 6; i++)
        images[i] = add_image(&setup.scene, sizes[i].width, sizes[i].height,
                              formats == 2 || (formats == 3 && i % 2), i + 1);
    uint32_t number = 0;
    for (uint32_t modes = 0; modes < 9; modes++)
        for (uint32_t nearest = 0; nearest < 2; nearest++)
            for (uint32_t k = 0; k < 3; k++)
                for (uint32_t i = 0; i < 6; i++, number++) {
                    uint32_t flags =
                        modes % 3 << TEXTURE_WRAP_S_SHIFT | modes / 3 << TEXTURE_WRAP_T_SHIFT |
                        (nearest ? TEXTURE_NEAREST : 0) | (number % 2 ? TEXTURE_UV1 : 0);
                    struct texture *texture = add_texture(&setup.scene, images[i], flags);
                    memcpy(texture->transform, transforms[k].rows, sizeof texture->transform);
                    exact[number] = transforms[k].is_exact;
                }
    REQUIRE(number <= TEXTURES_MAX && number == setup.scene.texture_count);
    add_square(&setup.scene, 1);
    OPEN_SETUP(&setup, TEXTURE_SLOTS);
    uint32_t has = setup.r.specialization.features;
    CHECK(!(has & FEATURE_TEXELS_CODES) == !(formats & 1) &&
          !(has & FEATURE_TEXELS_FLOAT) == !(formats & 2));

    uint32_t count = number * ITEMS_A_TEXTURE;
    struct worst worst = {0};
    fill_items(&setup.scene);
    memcpy(inputs, items, sizeof inputs);
    REQUIRE(texture_run(&setup, ROUTINE_SAMPLE, items, count));
    for (uint32_t i = 0; i < count; i++) {
        // Without a transform everything but the wrap is exact; with an exact transform, also for
        // coordinates on a sufficiently coarse grid.
        bool is_exact = exact[i / ITEMS_A_TEXTURE];
        if (i / ITEMS_A_TEXTURE / 6 % 3 == 1)
            is_exact = i % 2 && i % 5 != 2 && i % 5 != 4;
        check_item(&setup.scene, &inputs[i], &items[i], is_exact, &worst);
    }
    printf("  %u samples, %u at edges left out, worst error %.2g\n", worst.checked, worst.skipped,
           worst.error);
    CHECK(worst.error < (formats == 1 ? 1e-3 : 1e-5) && worst.skipped < worst.checked / 5);
    setup_close(&setup);
}

TEST(codes)
{
    check_formats(1);
}

TEST(floats)
{
    check_formats(2);
}

TEST(both)
{
    check_formats(3);
}

// For any coordinates the result is a texel of the image (docs/verification.md, C32).
TEST(coordinates_without_bounds)
{
    static const float bad[] = {1e30f, -1e30f,   3.4e38f,   -3.4e38f, 1e-38f,       -1e-45f,
                                NAN,   INFINITY, -INFINITY, 16777216, 2147483648.0f};
    enum { BAD = sizeof bad / sizeof bad[0], COUNT = 18 * BAD * BAD };
    struct setup setup;
    scene_start(&setup.scene, 8, 8);
    add_material(&setup.scene, &(struct material){.name = "textured"});
    uint32_t image = add_image(&setup.scene, 3, 5, false, 1);
    for (uint32_t modes = 0; modes < 9; modes++)
        for (uint32_t nearest = 0; nearest < 2; nearest++)
            add_texture(&setup.scene, image,
                        modes % 3 << TEXTURE_WRAP_S_SHIFT | modes / 3 << TEXTURE_WRAP_T_SHIFT |
                            (nearest ? TEXTURE_NEAREST : 0));
    setup.scene.textures[3].transform[0][0] = 3e38f; // this overflows
    add_square(&setup.scene, 1);
    OPEN_SETUP(&setup, TEXTURE_SLOTS);
    for (uint32_t i = 0; i < COUNT; i++) {
        items[i].u[0][0] = i / (BAD * BAD);
        items[i].f[1][0] = bad[i % BAD];
        items[i].f[1][1] = bad[i / BAD % BAD];
    }
    REQUIRE(texture_run(&setup, ROUTINE_SAMPLE, items, COUNT));
    double low[4], high[4];
    for (int c = 0; c < 4; c++) {
        low[c] = 1;
        high[c] = 0;
        for (uint32_t k = 0; k < 15; k++) {
            low[c] = fmin(low[c], image_texel(&setup.scene.images[image], k % 3, k / 3, c));
            high[c] = fmax(high[c], image_texel(&setup.scene.images[image], k % 3, k / 3, c));
        }
    }
    for (uint32_t i = 0; i < COUNT; i++)
        for (int c = 0; c < 4; c++)
            CHECK((double)items[i].f[0][c] >= low[c] - 1e-6 &&
                      (double)items[i].f[0][c] <= high[c] + 1e-6,
                  "texture %u, (%g, %g): %g", i / (BAD * BAD), (double)bad[i % BAD],
                  (double)bad[i / BAD % BAD], (double)items[i].f[0][c]);
    setup_close(&setup);
}

// Tests the longest row, and values beyond the range of halves (docs/verification.md, C31 and C34).
TEST(long_rows_and_bright_texels)
{
    enum { COUNT = 1000 };
    static const float bright[4] = {1e6f, 3e30f, 65504 * 2, 1};
    struct setup setup;
    struct random random = {3};
    scene_start(&setup.scene, 8, 8);
    add_material(&setup.scene, &(struct material){.name = "textured"});
    uint32_t lengths[4] = {16384, 16384, 65535, 1};
    uint32_t images[4] = {
        add_image(&setup.scene, 16384, 1, false, 1), add_image(&setup.scene, 1, 16384, true, 2),
        add_image(&setup.scene, 65535, 1, false, 3), add_plain_image(&setup.scene, bright)};
    for (int i = 0; i < 4; i++)
        add_texture(&setup.scene, images[i], TEXTURE_NEAREST);
    add_square(&setup.scene, 1);
    OPEN_SETUP(&setup, TEXTURE_SLOTS);
    uint32_t wanted[COUNT];
    for (uint32_t i = 0; i < COUNT; i++) {
        uint32_t texel = wanted[i] = random_u32(&random) % lengths[i % 4];
        float at = ((float)texel + 0.5f) / (float)lengths[i % 4];
        items[i].u[0][0] = i % 4;
        items[i].f[1][0] = i % 4 == 1 ? 0.5f : at;
        items[i].f[1][1] = i % 4 == 1 ? at : 0.5f;
    }
    REQUIRE(texture_run(&setup, ROUTINE_SAMPLE, items, COUNT));
    for (uint32_t i = 0; i < COUNT; i++)
        for (int c = 0; c < 4; c++) {
            const struct texture_image *image = &setup.scene.images[images[i % 4]];
            double expected = i % 4 == 1 ? image_texel(image, 0, wanted[i], c)
                                         : image_texel(image, wanted[i], 0, c);
            CHECK((double)items[i].f[0][c] == expected, "image %u, texel %u: %g, expected %g",
                  i % 4, wanted[i], (double)items[i].f[0][c], expected);
        }
    setup_close(&setup);
}

TEST_MAIN(TEST_CASE(codes), TEST_CASE(floats), TEST_CASE(both),
          TEST_CASE(coordinates_without_bounds), TEST_CASE(long_rows_and_bright_texels))
