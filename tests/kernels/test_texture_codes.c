// Tests that the device's values of 8-bit codes have the bits of the host's, for every code, and
// that every device gets these bits, by a bound of the rounding errors of lib/texture.glsl.
#include "texture_fixture.h"

// --- on the device -------------------------------------------------------------------------------

enum { CODES = 256, IMAGES = 5 };

// Texel i has the code i in red, and other codes in the other channels; each channel has all codes.
static void fill_codes(uint8_t codes[CODES][4])
{
    for (int i = 0; i < CODES; i++)
        for (int c = 0; c < 4; c++)
            codes[i][c] = (uint8_t)(i * (2 * c + 1) + 77 * c);
}

// Maps green to [first, last], as glTF's film thickness does.
static void map_green(struct texture_image *image, float first, float last)
{
    float(*values)[4] = (float(*)[4])(uintptr_t)image->values;
    image->green[0] = first;
    image->green[1] = last - first;
    for (int i = 0; i < CODES; i++)
        values[i][1] = float_from_half(half_from_float(first + image->green[1] * values[i][1]));
}

// Images of codes beside an image of floats: linear, sRGB, and with three maps of green, of which
// the second runs down, and the last one begins below the least normal half.
TEST(all_codes)
{
    static const float grey[4] = {0.5f, 0.5f, 0.5f, 1},
                       ends[3][2] = {{0.25f, 1}, {1, 0.2f}, {1e-5f, 3e-4f}};
    static union texture_item items[IMAGES * CODES];
    for (int has_floats = 0; has_floats < 2; has_floats++) {
        struct setup setup;
        uint8_t codes[CODES][4];
        uint32_t images[IMAGES];
        scene_start(&setup.scene, 8, 8);
        // Iridescence is what has maps of green.
        struct material m;
        material_init(&m);
        m.model = MATERIAL_PRINCIPLED;
        m.iridescence = 1;
        m.film_ior = 1.3f;
        add_material(&setup.scene, &m);
        fill_codes(codes);
        for (uint32_t i = 0; i < IMAGES; i++) {
            images[i] = add_codes(&setup.scene, CODES, 1, (const uint8_t(*)[4])codes, i == 1, 0);
            if (i > 1)
                map_green(&setup.scene.images[images[i]], ends[i - 2][0], ends[i - 2][1]);
            add_texture(&setup.scene, images[i], TEXTURE_NEAREST);
        }
        if (has_floats)
            add_texture(&setup.scene, add_plain_image(&setup.scene, grey), TEXTURE_NEAREST);
        add_square(&setup.scene, 1);
        OPEN_SETUP(&setup, TEXTURE_SLOTS);
        CHECK(setup.r.specialization.lobes & LOBE_IRIDESCENCE);
        CHECK(!(setup.r.specialization.features & FEATURE_TEXELS_FLOAT) == !has_floats);
        memset(items, 0, sizeof items);
        for (uint32_t i = 0; i < IMAGES * CODES; i++) {
            items[i].u[0][0] = i / CODES;
            items[i].f[1][0] = ((float)(i % CODES) + 0.5f) / CODES;
            items[i].f[1][1] = 0.5f;
        }
        REQUIRE(texture_run(&setup, ROUTINE_SAMPLE, items, IMAGES * CODES));
        for (uint32_t i = 0; i < IMAGES * CODES; i++)
            for (int c = 0; c < 4; c++) {
                double value = image_texel(&setup.scene.images[images[i / CODES]], i % CODES, 0, c);
                CHECK((double)items[i].f[0][c] == value,
                      "image %u, channel %d, code %d: %.9g, expected %.9g", i / CODES, c,
                      codes[i % CODES][c], (double)items[i].f[0][c], value);
            }
        setup_close(&setup);
    }
}

// --- on any device -------------------------------------------------------------------------------

// A value and a bound of its error, when each operation is off by at most one ulp (Vulkan's
// precision of sums and products). In double precision, whose own errors are 2^-29 of these.
struct bounded {
    double value, error;
};

static struct bounded rounded(double value, double error)
{
    const double ulp = 0x1p-23;
    return (struct bounded){value, error + (fabs(value) + error) * ulp};
}

static struct bounded times_code(struct bounded a, int code)
{
    return rounded(a.value * code, a.error * code);
}

static struct bounded plus(struct bounded a, float b)
{
    return rounded(a.value + (double)b, a.error);
}

static struct bounded srgb_curve(int code)
{
    static const float rest[] = {SRGB_CURVE_6, SRGB_CURVE_5, SRGB_CURVE_4, SRGB_CURVE_3,
                                 SRGB_CURVE_2, SRGB_CURVE_1, SRGB_CURVE_0};
    struct bounded sum = {(double)SRGB_CURVE_7, 0};
    for (size_t i = 0; i < sizeof rest / sizeof *rest; i++)
        sum = plus(times_code(sum, code), rest[i]);
    return sum;
}

// Returns the distance from the bounded value to the nearest value that rounds to another half, as
// a fraction of the half; negative if the bound reaches it.
static double slack(struct bounded b, float wanted)
{
    uint16_t half = half_from_float(wanted);
    double low = ((double)float_from_half((uint16_t)(half - 1)) + (double)wanted) / 2;
    double high = ((double)float_from_half((uint16_t)(half + 1)) + (double)wanted) / 2;
    return fmin(b.value - b.error - low, high - b.value - b.error) / (double)wanted;
}

TEST(no_rounding_reaches_another_half)
{
    struct arena arena = {0};
    struct err err = {0};
    float(*linear)[4], (*srgb)[4];
    double least_linear = 1, least_toe = 1, least_curve = 1;
    REQUIRE(image_code_values(false, &arena, &linear, &err) &&
                image_code_values(true, &arena, &srgb, &err),
            "%s", err.msg);
    for (int code = 1; code < CODES; code++) {
        // The constants may be off by one ulp, too: compilers divide.
        const double unit = (double)CODE_UNIT, toe = (double)SRGB_TOE;
        const struct bounded value = times_code(rounded(unit, 0), code);
        least_linear = fmin(least_linear, slack(value, linear[code][0]));
        if ((float)code < SRGB_CURVE_FROM)
            least_toe = fmin(least_toe, slack(times_code(rounded(toe, 0), code), srgb[code][0]));
        else
            least_curve = fmin(least_curve, slack(srgb_curve(code), srgb[code][0]));
    }
    printf("  least slack: linear %.2g, sRGB %.2g below code %g, %.2g above\n", least_linear,
           least_toe, (double)SRGB_CURVE_FROM, least_curve);
    CHECK(least_linear > 0 && least_toe > 0 && least_curve > 0);
    arena_finish(&arena);
}

TEST_MAIN(TEST_CASE(all_codes), TEST_CASE(no_rounding_reaches_another_half))
