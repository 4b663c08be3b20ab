// Defines cases of environment images that cause a known irradiance on a plane
// (docs/verification.md, B24, B25, C33 and C35).
#include "check/case_list.h"
#include "check/closed_form.h"
#include <math.h>

#define SUN_WIDTH 1024
#define SUN_HEIGHT 512
#define SUN_ROW 140
#define SUN_COLUMN 700
#define SUN_RADIANCE 1e6

// --- the forms ----------------------------------------------------------------------------------

#define POWER_ROWS 4096

// Returns the value of a row in an image of cos^k about +Y: the mean over the row, weighted by
// solid angle.
static float power_texel(double k, uint32_t row)
{
    if (row >= POWER_ROWS / 2)
        return 0.0f;
    double top = cos(M_PI * row / POWER_ROWS), bottom = fmax(cos(M_PI * (row + 1) / POWER_ROWS), 0);
    return (float)((pow(top, k + 1.0) - pow(bottom, k + 1.0)) / ((k + 1.0) * (top - bottom)));
}

// Returns the integral from t[0] to t[1] of sin t cos t times a function that is linear between
// ends[0] and ends[1].
static double slope_irradiance(const double t[2], const double ends[2])
{
    double slope = (ends[1] - ends[0]) / (t[1] - t[0]);
    double even = 0.5 * sin(t[1] - t[0]) * sin(t[1] + t[0]);
    double rising = 0.125 * (sin(2.0 * t[1]) - sin(2.0 * t[0])) -
                    0.25 * (t[1] * cos(2.0 * t[1]) - t[0] * cos(2.0 * t[0]));
    return ends[0] * even + slope * (rising - t[0] * even);
}

// Returns the radiance that a plane reflects under the image. For cos^k itself it is 2 rho Le / (k
// + 2). But the image's radiance is linear between the centres of rows, which widens a peak: the
// irradiance is greater than that of cos^k by a factor of 1 + 2.44e-5 for k = 1000, and differs by
// at most 1.3e-7 for k up to 10. Above the centre of the first row the radiance is that of the row.
// If the image has a step at the horizon, only its upper half counts.
static double power(double rho, double le, double k)
{
    double h = M_PI / POWER_ROWS, first = (double)power_texel(k, 0);
    double sum = slope_irradiance((double[]){0.0, 0.5 * h}, (double[]){first, first});
    for (uint32_t row = 0; row < POWER_ROWS / 2; row++) {
        double upper = (double)power_texel(k, row), lower = (double)power_texel(k, row + 1);
        bool is_last = row + 1 == POWER_ROWS / 2;
        double t[2] = {(row + 0.5) * h, (row + (is_last ? 1.0 : 1.5)) * h};
        double ends[2] = {upper, is_last ? 0.5 * (upper + lower) : lower};
        sum += slope_irradiance(t, ends);
    }
    return 2.0 * rho * le * sum;
}
static const char power_is[] = "2 rho Le / (k + 2), corrected for the interpolation of rows";

// Returns the irradiance that a patch of radiance 1 causes.
static double patch_of_sun(void)
{
    double theta[2] = {M_PI * SUN_ROW / SUN_HEIGHT, M_PI * (SUN_ROW + 1) / SUN_HEIGHT};
    double middle = cos(0.5 * (theta[0] + theta[1])) * cos(0.5 * (theta[1] - theta[0]));
    return middle * (2.0 * M_PI / SUN_WIDTH) * (cos(theta[0]) - cos(theta[1]));
}

// Returns the irradiance for radiance that decreases linearly to 0 at the centres of the
// neighbouring texels, which are at the angle h on all sides: the integral of (1 - |t - a| / h) sin
// t cos t is sin 2a sin^2 h / (2 h).
static double tent_of_sun(void)
{
    double h = M_PI / SUN_HEIGHT, a = (SUN_ROW + 0.5) * h;
    return 2.0 * M_PI / SUN_WIDTH * sin(2.0 * a) * sin(h) * sin(h) / (2.0 * h);
}

// Returns the radiance that the plane reflects under an image with one bright texel; all other
// texels have radiance `dim`.
static double patch(double rho, double le, double dim)
{
    return rho / M_PI * le * (dim * M_PI + (SUN_RADIANCE - dim) * patch_of_sun());
}
static const char patch_is[] =
    "(rho / pi) Le cos (2 pi / W) (cos t0 - cos t1), plus the other texels";

static double tent(double rho, double le, double dim)
{
    return rho / M_PI * le * (dim * M_PI + (SUN_RADIANCE - dim) * tent_of_sun());
}
static const char tent_is[] =
    "(rho / pi) Le (2 pi / W) sin 2a sin^2 h / (2 h), plus the other texels";

static double nothing(double rho, double le, double unused)
{
    (void)rho, (void)le, (void)unused;
    return 0.0;
}
static const char nothing_is[] = "0";

// --- the images ---------------------------------------------------------------------------------

static bool set_image(struct scene *scene, uint32_t width, uint32_t height, double value,
                      struct err *err)
{
    struct environment *e = &scene->environment;
    *e = (struct environment){
        .present = true, .radiance = {1, 2, 4}, .width = width, .height = height};
    e->texels = arena_alloc(&scene->arena, (uint64_t)width * height, sizeof *e->texels);
    if (!e->texels)
        return err_memory(err, "texels", (uint64_t)width * height * sizeof *e->texels);
    for (uint32_t i = 0; i < 3 * width * height; i++)
        e->texels[i / 3][i % 3] = (float)value;
    return true;
}

static bool set_power(struct scene *scene, double k, struct err *err)
{
    if (!set_image(scene, 1, POWER_ROWS, 0, err))
        return false;
    for (uint32_t row = 0; row < POWER_ROWS / 2; row++)
        for (int c = 0; c < 3; c++)
            scene->environment.texels[row][c] = power_texel(k, row);
    return true;
}

static bool set_sun(struct scene *scene, double dim, struct err *err)
{
    if (!set_image(scene, SUN_WIDTH, SUN_HEIGHT, dim, err))
        return false;
    for (int c = 0; c < 3; c++)
        scene->environment.texels[SUN_ROW * SUN_WIDTH + SUN_COLUMN][c] = (float)SUN_RADIANCE;
    return true;
}

// Makes the sky above the plane black: by its texels (which = 0), by its factor (1), or by only the
// texels above the plane (2).
static bool set_black(struct scene *scene, double which, struct err *err)
{
    if (!set_image(scene, 5, 3, which == 1.0 ? SUN_RADIANCE : 0.0, err))
        return false;
    struct environment *e = &scene->environment;
    for (int c = 0; c < 3; c++) {
        e->radiance[c] = which == 1.0 ? 0.0f : e->radiance[c];
        e->texels[12][c] = which == 2.0 ? (float)SUN_RADIANCE : e->texels[12][c];
    }
    return true;
}

// With Sobol points, a pilot predicts the required number of samples less accurately.
// clang-format off
#define RANDOM {{"settings", JSON({"sampler": "pcg"})}}
#define PATCHES {{"settings", JSON({"environment_filter": "nearest"})}}

static const struct check_case forms[] = {
    FORM("B24 sky of cos^0", "plane.json", power, 0, BY_STATISTICS, EACH_ALONE, RANDOM, 0,
     set_power),
    FORM("B24 sky of cos^1", "plane.json", power, 1, BY_STATISTICS, EACH_ALONE, RANDOM, 0,
     set_power),
    FORM("B24 sky of cos^10", "plane.json", power, 10, BY_STATISTICS, EACH_ALONE, {{0}}, 0,
     set_power),
    FORM("B24 sky of cos^1000", "plane.json", power, 1000, BY_STATISTICS, NEE_ALONE, {{0}}, 0,
     set_power),
    FORM("B25 texel alone", "plane.json", tent, 0, BY_STATISTICS, NEE_ALONE, {{0}}, 0, set_sun),
    FORM("B25 patch alone", "plane.json", patch, 0, BY_STATISTICS, NEE_ALONE, PATCHES, 0, set_sun),
    FORM("C33 sun of one texel in a dim sky", "plane.json", tent, 0.5, BY_STATISTICS, NEE_ALONE,
     {{0}}, 0, set_sun),
    FORM("C33 sun of one patch in a dim sky", "plane.json", patch, 0.5, BY_STATISTICS, NEE_ALONE,
     PATCHES, 0, set_sun),
    FORM("C35 image that is black", "plane.json", nothing, 0, EXACT, BSDF_ALONE, {{0}}, 0,
     set_black),
    FORM("C35 image times 0", "plane.json", nothing, 1, EXACT, BSDF_ALONE, {{0}}, 0, set_black),
    FORM("C35 image that is black above the plane", "plane.json", nothing, 2, EXACT, BSDF_ALONE,
     {{0}}, 0, set_black),
};
// clang-format on

CHECK_GROUP(check_environments, "environments", "environments by images on a plane", forms);
