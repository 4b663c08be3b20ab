// Tests the sky's formulas with values computed by hand, its image against the formulas, its sun,
// and gradients.
#include "base/maths.h"
#include "scene/core/environment.h"
#include "scene/core/scene.h"
#include "scene/sky/sky.h"
#include "test.h"

static double exact_luminance(const double rgb[3])
{
    return 0.2126390059 * rgb[0] + 0.7151686788 * rgb[1] + 0.0721923154 * rgb[2];
}

static struct sky make_sky(double turbidity, double elevation)
{
    struct sky sky = sky_default();
    sky.turbidity = turbidity;
    sky_place_sun(&sky, elevation, 30);
    return sky;
}

static double luminance_towards(const struct sky_model *model, double elevation, double azimuth)
{
    struct sky to = sky_default();
    double rgb[3];
    sky_place_sun(&to, elevation, azimuth);
    sky_radiance(model, to.sun_direction, rgb);
    return exact_luminance(rgb);
}

// Preetham, Shirley and Smits 1999, appendix A.2: the luminance of the zenith in kcd/m^2 is (4.0453
// T - 4.9710) tan((4/9 - T/120)(pi - 2 theta)) - 0.2155 T + 2.4192. By hand: for T = 3 and 45
// degrees it is 7.1649 tan(0.658862) + 1.7727 = 7.1649 * 0.774282 + 1.7727; for T = 2 and 90
// degrees (the sun at the horizon) the tangent is 0.
TEST(zenith)
{
    static const struct {
        double turbidity, elevation, luminance;
    } values[] = {{3, 45, 7.320358}, {2, 0, 1.988200}, {10, 0, 0.264200}, {6, 30, 9.585270}};
    for (size_t i = 0; i < sizeof values / sizeof values[0]; i++) {
        const struct sky sky = make_sky(values[i].turbidity, values[i].elevation);
        struct sky_model model;
        sky_model_init(&sky, &model);
        double found = luminance_towards(&model, 90, 0) * 683 / 1000;
        CHECK(fabs(found / values[i].luminance - 1) <= 1e-5, "T %g, %g degrees: %.7g, not %.7g",
              values[i].turbidity, values[i].elevation, found, values[i].luminance);
    }
}

// Perez's formula: for a sun in the zenith, the ratio of the horizon, at gamma = 90 degrees, to the
// zenith is (1 + C e^(D pi/2)) / ((1 + A e^B) (1 + C + E)), because e^(B / 0) is 0.
TEST(horizon)
{
    const struct sky sky = make_sky(3, 90);
    struct sky_model model;
    sky_model_init(&sky, &model);
    double t = 3, a = 0.1787 * t - 1.4630, b = -0.3554 * t + 0.4275, c = -0.0227 * t + 5.3251;
    double d = 0.1206 * t - 2.5771, e = -0.0670 * t + 0.3703;
    double expected = (1 + c * exp(d * M_PI / 2)) / ((1 + a * exp(b)) * (1 + c + e));
    double found = luminance_towards(&model, 1e-4, 77) / luminance_towards(&model, 90, 0);
    CHECK(fabs(found / expected - 1) <= 1e-4, "%.9g, not %.9g", found, expected);
}

// Under a clear sky the horizon is brighter than the zenith, and the sky opposite the sun is bluer
// than that around the sun. The sun is redder when it is low, and dimmer in haze.
TEST(looks_like_a_sky)
{
    const struct sky high = make_sky(2.5, 50), low = make_sky(2.5, 5), hazy = make_sky(8, 50);
    struct sky_model model;
    double rgb[3], suns[3][3];
    sky_model_init(&high, &model);
    CHECK(luminance_towards(&model, 2, 210) > luminance_towards(&model, 90, 0),
          "dark horizon: %g against %g", luminance_towards(&model, 2, 210),
          luminance_towards(&model, 90, 0));
    sky_radiance(&model, (const double[3]){0, 1, 0}, rgb);
    CHECK(rgb[2] > 1.5 * rgb[0], "zenith %g %g %g", rgb[0], rgb[1], rgb[2]);
    sky_sun_irradiance(&high, suns[0]);
    sky_sun_irradiance(&low, suns[1]);
    sky_sun_irradiance(&hazy, suns[2]);
    CHECK(suns[1][2] / suns[1][0] < 0.3 * suns[0][2] / suns[0][0], "low sun %g %g %g", suns[1][0],
          suns[1][1], suns[1][2]);
    CHECK(exact_luminance(suns[2]) < 0.7 * exact_luminance(suns[0]), "hazy sun %g, clear %g",
          exact_luminance(suns[2]), exact_luminance(suns[0]));
    // Outside the atmosphere there are 127 to 134 klx, and on the ground at most about 100.
    double klx = exact_luminance(suns[0]) * 683 / 1000;
    printf("  a sun 50 degrees high: %.1f klx, %.3g %.3g %.3g W/m^2\n", klx, suns[0][0], suns[0][1],
           suns[0][2]);
    CHECK(klx > 70 && klx < 115, "%g klx", klx);
}

// Texels are means of the formula, so irradiance is accurate except for rounding. The formula
// differs from the texel in a direction by at most the number in docs/lighting.md.
TEST(baked)
{
    static const struct {
        double turbidity, elevation;
    } skies[] = {{2, 3}, {3, 45}, {10, 20}, {2, 90}};
    for (size_t i = 0; i < sizeof skies / sizeof skies[0]; i++) {
        struct scene scene = {0};
        struct err err = {0};
        struct sky_model model;
        const struct sky sky = make_sky(skies[i].turbidity, skies[i].elevation);
        sky_model_init(&sky, &model);
        REQUIRE(scene_set_sky(&scene, &sky, &err), "%s", err.msg);
        const struct environment *e = &scene.environment;
        double baked = 0, exact = 0, worst = 0, squares = 0, texels = 0;
        for (uint32_t row = 0; row < SKY_HEIGHT / 2; row++)
            for (uint32_t column = 0; column < SKY_WIDTH; column += 7) {
                const float *t = e->texels[row * SKY_WIDTH + column];
                const double texel[3] = {(double)t[0], (double)t[1], (double)t[2]};
                double solid_angle = environment_texel_solid_angle(e, row), mean = 0;
                for (int p = 0; p < 16; p++) {
                    double top = cos(M_PI * row / SKY_HEIGHT);
                    double bottom = cos(M_PI * (row + 1) / SKY_HEIGHT);
                    double y = top + (bottom - top) * (p / 4 + 0.5) / 4, radius = sqrt(1 - y * y);
                    double turn = (column + (p % 4 + 0.5) / 4) / SKY_WIDTH - 0.5, rgb[3];
                    const double direction[3] = {radius * cos(2 * M_PI * turn), y,
                                                 radius * sin(2 * M_PI * turn)};
                    sky_radiance(&model, direction, rgb);
                    mean += exact_luminance(rgb) / 16;
                    double error = fabs(exact_luminance(texel) / exact_luminance(rgb) - 1);
                    worst = fmax(worst, error);
                    squares += error * error;
                    texels++;
                }
                double cosine =
                    0.5 * (cos(M_PI * row / SKY_HEIGHT) + cos(M_PI * (row + 1) / SKY_HEIGHT));
                baked += exact_luminance(texel) * solid_angle * cosine;
                exact += mean * solid_angle * cosine;
            }
        printf("  turbidity %g, sun at %g: irradiance off by %.1e, radiance by %.2g %% at most, "
               "%.2g %% rms, %u notes\n",
               skies[i].turbidity, skies[i].elevation, baked / exact - 1, 100 * worst,
               100 * sqrt(squares / texels), scene.note_count);
        CHECK(fabs(baked / exact - 1) <= 1e-3, "irradiance %.9g, not %.9g", baked, exact);
        CHECK(worst <= 0.013, "off by %g", worst);
        scene_finish(&scene);
    }
}

// The ground reflects the fraction `albedo` of the irradiance from the whole sky and the sun.
TEST(ground_and_sun)
{
    struct scene scene = {0};
    struct err err = {0};
    struct sky sky = make_sky(4, 35);
    double sun[3];
    sky.ground_albedo[1] = 0.5;
    REQUIRE(scene_set_sky(&scene, &sky, &err), "%s", err.msg);
    const struct environment *e = &scene.environment;
    double irradiance = 0;
    for (uint32_t i = 0; i < SKY_WIDTH * SKY_HEIGHT / 2; i++) {
        uint32_t row = i / SKY_WIDTH;
        irradiance += (double)e->texels[i][1] * environment_texel_solid_angle(e, row) *
                      cos(M_PI * (row + 0.5) / SKY_HEIGHT);
    }
    sky_sun_irradiance(&sky, sun);
    irradiance += sun[1] * sin(35 * DEGREE);
    double ground = (double)e->texels[SKY_WIDTH * SKY_HEIGHT - 1][1];
    CHECK(fabs(ground * M_PI / 0.5 / irradiance - 1) <= 1e-4, "%g", ground);

    // After a rotation by 90 degrees, the part that was at +Z is at +X, and so is the sun.
    REQUIRE(scene_adjust_environment(&scene, M_PI / 2, 2, &err) && scene_add_sky_sun(&scene, &err),
            "%s", err.msg);
    const struct light *light = &scene.lights[0];
    CHECK(scene.light_count == 1 && fabs(light->angular_radius - 0.265 * DEGREE) < 1e-12);
    CHECK(fabs(light->direction[0] + sky.sun_direction[2]) < 1e-12 &&
              fabs(light->direction[1] + sky.sun_direction[1]) < 1e-12 &&
              fabs(light->direction[2] - sky.sun_direction[0]) < 1e-12,
          "%g %g %g", light->direction[0], light->direction[1], light->direction[2]);
    CHECK(fabs((double)light->radiant[0] / (2 * sun[0]) - 1) < 1e-6 && e->radiance[0] == 2.0f);
    scene_finish(&scene);
}

TEST(texts)
{
    static const char *const bad[] = {
        "turbidity",    "turbidity=", "turbidity=1.9",  "turbidity=nan",      "elevation=-1",
        "elevation=91", "tubidity=3", "turbidity=3;",   "turbidity=3,,sun=1", "diameter=1e-5",
        "albedo=1.1",   "=3",         "turbidity=3,sun"};
    struct err err = {0};
    struct sky sky;
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++)
        CHECK(!sky_parse(bad[i], &sky, &err) && err.code == ERR_USAGE, "%s", bad[i]);
    CHECK(sky_parse("", &sky, &err) && sky.turbidity == 3 && sky.has_sun);
    CHECK(sky_parse("turbidity=10,elevation=90,azimuth=-360,albedo=0,diameter=180,sun=0", &sky,
                    &err) &&
              sky.turbidity == 10 && !sky.has_sun && fabs(sky.sun_direction[1] - 1) < 1e-15,
          "%s", err.msg);
}

TEST(gradient)
{
    const struct environment_gradient gradient = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    struct scene scene = {0};
    struct err err = {0};
    REQUIRE(scene_set_gradient(&scene, &gradient, &err), "%s", err.msg);
    const struct environment *e = &scene.environment;
    double worst = 0, irradiance[3] = {0};
    for (uint32_t row = 0; row < e->height; row++) {
        for (int edge = 0; edge < 2; edge++) {
            double y = cos(M_PI * (row + (uint32_t)edge) / e->height);
            const double exact[3] = {fmax(y, 0), 1 - fabs(y), fmax(-y, 0)};
            for (int c = 0; c < 3; c++)
                worst = fmax(worst, fabs((double)e->texels[row][c] - exact[c]));
        }
        double cosine = cos(M_PI * (row + 0.5) / e->height);
        for (int c = 0; c < 3; c++)
            irradiance[c] +=
                (double)e->texels[row][c] * fmax(cosine, 0) * environment_texel_solid_angle(e, row);
    }
    CHECK(worst <= 0.0016, "off by %g", worst);
    // The integral of y over the upper hemisphere, weighted by the cosine, is 2 pi / 3; that of 1 -
    // y is pi / 3.
    CHECK(fabs(irradiance[0] - 2 * M_PI / 3) <= 1e-5 && fabs(irradiance[1] - M_PI / 3) <= 1e-5 &&
              irradiance[2] == 0,
          "%.9g %.9g", irradiance[0], irradiance[1]);
    scene_finish(&scene);
}

TEST_MAIN(TEST_CASE(zenith), TEST_CASE(horizon), TEST_CASE(looks_like_a_sky), TEST_CASE(baked),
          TEST_CASE(ground_and_sun), TEST_CASE(texts), TEST_CASE(gradient))
