#include "scene/sky/sky.h"

#include "base/hash.h"
#include "base/maths.h"
#include "base/parallel.h"
#include "scene/core/environment.h"
#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

#define LUMENS_A_WATT 683.0

// Converts from CIE 1931 XYZ, by the inverse of the matrix of BT.709's primaries and white, D65.
static void rgb_from_xyz(const double xyz[3], double rgb[3])
{
    static const double matrix[3][3] = {
        {3.2409699419, -1.5373831776, -0.4986107603},
        {-0.9692436363, 1.8759675015, 0.0415550574},
        {0.0556300797, -0.2039769589, 1.0569715142},
    };
    for (int c = 0; c < 3; c++)
        rgb[c] = vec3_dot(matrix[c], xyz);
}

// --- the sky -------------------------------------------------------------------------------------

// The coefficients A to E of Y, x and y, which are linear in the turbidity (appendix A.2).
static const double perez_slope[3][5] = {
    {0.1787, -0.3554, -0.0227, 0.1206, -0.0670},
    {-0.0193, -0.0665, -0.0004, -0.0641, -0.0033},
    {-0.0167, -0.0950, -0.0079, -0.0441, -0.0109},
};
static const double perez_offset[3][5] = {
    {-1.4630, 0.4275, 5.3251, -2.5771, 0.3703},
    {-0.2592, 0.0008, 0.2125, -0.8989, 0.0452},
    {-0.2608, 0.0092, 0.2102, -1.6537, 0.0529},
};
// The zenith's x and y (appendix A.2): rows by powers 2, 1, 0 of the turbidity, columns by powers
// 3, 2, 1, 0 of the sun's angle from the zenith.
static const double zenith_xy[2][3][4] = {
    {{0.00166, -0.00375, 0.00209, 0.0},
     {-0.02903, 0.06377, -0.03202, 0.00394},
     {0.11693, -0.21196, 0.06052, 0.25886}},
    {{0.00275, -0.00610, 0.00317, 0.0},
     {-0.04214, 0.08970, -0.04153, 0.00516},
     {0.15346, -0.26756, 0.06670, 0.26688}},
};

static double zenith_chromaticity(const double rows[3][4], double turbidity, double angle)
{
    double value = 0;
    for (int i = 0; i < 3; i++) {
        double row = ((rows[i][0] * angle + rows[i][1]) * angle + rows[i][2]) * angle + rows[i][3];
        value = value * turbidity + row;
    }
    return value;
}

// The two factors of Perez's distribution (equation 3). This one depends on the cosine of the angle
// from the zenith, the other on gamma, the angle from the sun.
static double perez_height(const double k[5], double cosine)
{
    return 1 + k[0] * exp(k[1] / cosine);
}

static double perez_sun(const double k[5], double cos_gamma)
{
    return 1 + k[2] * exp(k[3] * acos(cos_gamma)) + k[4] * cos_gamma * cos_gamma;
}

static double sun_angle(const double sun_direction[3])
{
    return acos(fmin(fmax(sun_direction[1], 0), 1));
}

void sky_model_init(const struct sky *sky, struct sky_model *out)
{
    double t = sky->turbidity, angle = sun_angle(sky->sun_direction);
    memcpy(out->sun_direction, sky->sun_direction, sizeof out->sun_direction);
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 5; k++)
            out->perez[i][k] = perez_slope[i][k] * t + perez_offset[i][k];
    double chi = (4.0 / 9.0 - t / 120) * (M_PI - 2 * angle);
    double luminance = (4.0453 * t - 4.9710) * tan(chi) - 0.2155 * t + 2.4192; // kcd/m^2
    out->zenith[0] = 1000 / LUMENS_A_WATT * luminance;
    for (int i = 0; i < 2; i++)
        out->zenith[1 + i] = zenith_chromaticity(zenith_xy[i], t, angle);
    for (int i = 0; i < 3; i++)
        out->scale[i] = out->zenith[i] /
                        (perez_height(out->perez[i], 1) * perez_sun(out->perez[i], cos(angle)));
}

// Computes the radiance from Perez's factors for the height and for the angle from the sun.
static void radiance_at(const struct sky_model *model, const double height[3],
                        const double direction[3], double rgb[3])
{
    double cosine = fmax(fmin(vec3_dot(direction, model->sun_direction), 1), -1), value[3], xyz[3];
    for (int i = 0; i < 3; i++)
        value[i] = height[i] * perez_sun(model->perez[i], cosine);
    xyz[0] = value[0] * value[1] / value[2];
    xyz[1] = value[0];
    xyz[2] = value[0] * (1 - value[1] - value[2]) / value[2];
    rgb_from_xyz(xyz, rgb);
}

static void height_factors(const struct sky_model *model, double cosine, double factors[3])
{
    for (int i = 0; i < 3; i++)
        factors[i] = model->scale[i] * perez_height(model->perez[i], cosine);
}

void sky_radiance(const struct sky_model *model, const double direction[3], double rgb[3])
{
    double factors[3];
    height_factors(model, direction[1], factors);
    radiance_at(model, factors, direction, rgb);
}

// --- the sun -------------------------------------------------------------------------------------

// CIE 1931 colour-matching functions: Wyman, Sloan and Shirley 2013, "Simple Analytic
// Approximations to the CIE XYZ Color Matching Functions", equation 4 and listing 1.
static double lobe(double nm, double peak, double center, double below, double above)
{
    double d = (nm - center) / (nm < center ? below : above);
    return peak * exp(-0.5 * d * d);
}

static void color_matching(double nm, double xyz[3])
{
    xyz[0] = lobe(nm, 1.056, 599.8, 37.9, 31.0) + lobe(nm, 0.362, 442.0, 16.0, 26.7) +
             lobe(nm, -0.065, 501.1, 20.4, 26.2);
    xyz[1] = lobe(nm, 0.821, 568.8, 46.9, 40.5) + lobe(nm, 0.286, 530.9, 16.3, 31.1);
    xyz[2] = lobe(nm, 1.217, 437.0, 11.8, 36.0) + lobe(nm, 0.681, 459.0, 26.0, 13.8);
}

// Returns the spectral irradiance outside the atmosphere, W/(m^2 nm): that of a black body of the
// sun's effective temperature (IAU 2015 Resolution B3) in the sun's mean solid angle, a disc of
// 0.5331 degrees.
static double sun_spectrum(double nm)
{
    const double h = 6.62607015e-34, c = 2.99792458e8, k = 1.380649e-23, kelvin = 5772;
    double metres = nm * 1e-9, sine = sin(0.5331 / 2 * DEGREE);
    double radiance =
        2 * h * c * c / pow(metres, 5) / expm1(h * c / (metres * k * kelvin)); // per metre of
                                                                               // wavelength
    return radiance * 1e-9 * M_PI * sine * sine;
}

// Returns the transmittance of the atmosphere for scattering by air and haze (appendix A.1). In
// these equations the exponents apply to the wavelength alone, as in Iqbal 1983, and the air mass
// is a factor.
static double transmittance(double nm, double turbidity, double mass)
{
    double micrometres = nm * 1e-3, beta = 0.04608 * turbidity - 0.04586;
    return exp(-mass * (0.008735 * pow(micrometres, -4.08) + beta * pow(micrometres, -1.3)));
}

void sky_sun_irradiance(const struct sky *sky, double rgb[3])
{
    double angle = sun_angle(sky->sun_direction);
    double mass = 1 / (cos(angle) + 0.15 * pow(93.885 - angle / DEGREE, -1.253));
    double xyz[3] = {0, 0, 0};
    const double step = 1;
    for (double nm = 360; nm <= 830; nm += step) {
        double weights[3];
        color_matching(nm, weights);
        double spectral = sun_spectrum(nm) * transmittance(nm, sky->turbidity, mass);
        for (int c = 0; c < 3; c++)
            xyz[c] += weights[c] * spectral * step;
    }
    rgb_from_xyz(xyz, rgb);
    for (int c = 0; c < 3; c++)
        rgb[c] = fmax(rgb[c], 0);
}

// --- parameters ----------------------------------------------------------------------------------

void sky_place_sun(struct sky *sky, double elevation_degrees, double azimuth_degrees)
{
    double elevation = elevation_degrees * DEGREE, azimuth = azimuth_degrees * DEGREE;
    sky->sun_direction[0] = cos(elevation) * cos(azimuth);
    sky->sun_direction[1] = sin(elevation);
    sky->sun_direction[2] = cos(elevation) * sin(azimuth);
}

struct sky sky_default(void)
{
    struct sky sky = {.turbidity = 3,
                      .ground_albedo = {0.2, 0.2, 0.2},
                      .has_sun = true,
                      .sun_diameter = 0.53 * DEGREE};
    sky_place_sun(&sky, 45, 0);
    return sky;
}

bool sky_parse(const char *text, struct sky *out, struct err *err)
{
    enum { TURBIDITY, ELEVATION, AZIMUTH, ALBEDO, DIAMETER, SUN, COUNT };
    static const struct {
        const char *name;
        double min, max;
    } keys[COUNT] = {
        [TURBIDITY] = {"turbidity", SKY_TURBIDITY_MIN, SKY_TURBIDITY_MAX},
        [ELEVATION] = {"elevation", 0, 90},
        [AZIMUTH] = {"azimuth", -360, 360},
        [ALBEDO] = {"albedo", 0, 1},
        [DIAMETER] = {"diameter", ENVIRONMENT_SUN_DIAMETER_MIN, ENVIRONMENT_SUN_DIAMETER_MAX},
        [SUN] = {"sun", 0, 1},
    };
    double values[COUNT] = {3, 45, 0, 0.2, 0.53, 1};
    while (*text) {
        size_t length = strcspn(text, "=,"), key = 0;
        while (key < COUNT &&
               (strlen(keys[key].name) != length || strncmp(keys[key].name, text, length) != 0))
            key++;
        if (key == COUNT || text[length] != '=')
            return err_set(err, ERR_USAGE,
                           "\"%s\" does not begin with turbidity=, elevation=, azimuth=, albedo=, "
                           "diameter= or sun=",
                           text);
        char *end;
        values[key] = strtod(text + length + 1, &end);
        if (end == text + length + 1 || (*end && *end != ','))
            return err_set(err, ERR_USAGE, "\"%s\" is not %s=NUMBER", text, keys[key].name);
        if (!(values[key] >= keys[key].min && values[key] <= keys[key].max))
            return err_set(err, ERR_USAGE, "%s=%.9g is outside [%g, %g]", keys[key].name,
                           values[key], keys[key].min, keys[key].max);
        text = end + (*end == ',');
    }
    *out = sky_default();
    out->turbidity = values[TURBIDITY];
    sky_place_sun(out, values[ELEVATION], values[AZIMUTH]);
    for (int c = 0; c < 3; c++)
        out->ground_albedo[c] = values[ALBEDO];
    out->sun_diameter = values[DIAMETER] * DEGREE;
    out->has_sun = values[SUN] > 0;
    return true;
}

// --- baking --------------------------------------------------------------------------------------

struct bake {
    struct sky_model model;
    struct environment *environment;
    double around[SKY_WIDTH][2][2]; // cosine and sine of azimuths of quadrature points
    atomic_uint clipped;
};

// Returns one of the two Gauss-Legendre points on [0, 1]. A texel is the mean over two points each
// in height and azimuth.
static double gauss_point(int i)
{
    return 0.5 + (i ? 0.5 : -0.5) / sqrt(3);
}

static void bake_texel(struct bake *bake, const double heights[2], const double (*factors)[3],
                       const double (*around)[2], float texel[3])
{
    double sum[3] = {0, 0, 0};
    for (int i = 0; i < 4; i++) {
        double y = heights[i / 2], radius = sqrt(1 - y * y), rgb[3];
        const double direction[3] = {radius * around[i % 2][0], y, radius * around[i % 2][1]};
        radiance_at(&bake->model, factors[i / 2], direction, rgb);
        for (int c = 0; c < 3; c++)
            sum[c] += rgb[c] / 4;
    }
    if (sum[0] < 0 || sum[1] < 0 || sum[2] < 0)
        atomic_fetch_add(&bake->clipped, 1);
    for (int c = 0; c < 3; c++)
        texel[c] = (float)fmax(sum[c], 0);
}

static void bake_rows(void *context, size_t begin, size_t end, unsigned thread)
{
    (void)thread;
    struct bake *bake = context;
    for (size_t row = begin; row < end; row++) {
        double top = cos(M_PI * (double)row / SKY_HEIGHT);
        double bottom = cos(M_PI * (double)(row + 1) / SKY_HEIGHT);
        double heights[2], factors[2][3];
        for (int i = 0; i < 2; i++) {
            heights[i] = top + (bottom - top) * gauss_point(i);
            height_factors(&bake->model, heights[i], factors[i]);
        }
        for (size_t column = 0; column < SKY_WIDTH; column++)
            bake_texel(bake, heights, factors, bake->around[column],
                       bake->environment->texels[row * SKY_WIDTH + column]);
    }
}

static bool bake_sky(const struct sky *sky, struct environment *environment, unsigned *clipped)
{
    struct bake *bake = calloc(1, sizeof *bake);
    if (!bake)
        return false;
    bake->environment = environment;
    sky_model_init(sky, &bake->model);
    for (int column = 0; column < SKY_WIDTH; column++)
        for (int i = 0; i < 2; i++) {
            double angle = 2 * M_PI * ((column + gauss_point(i)) / SKY_WIDTH - 0.5);
            bake->around[column][i][0] = cos(angle);
            bake->around[column][i][1] = sin(angle);
        }
    parallel_for(SKY_HEIGHT / 2, 8, 0, bake_rows, bake);
    *clipped = bake->clipped;
    free(bake);
    return true;
}

// Sets the texels below the horizon, where diffuse ground reflects the irradiance of the sky and
// the sun.
static void bake_ground(const struct sky *sky, struct environment *environment)
{
    double irradiance[3] = {0, 0, 0}, sun[3];
    for (uint32_t row = 0; row < SKY_HEIGHT / 2; row++) {
        double height = 0.5 * (cos(M_PI * row / SKY_HEIGHT) + cos(M_PI * (row + 1) / SKY_HEIGHT));
        double weight = environment_texel_solid_angle(environment, row) * height;
        for (uint32_t i = 0; i < SKY_WIDTH; i++)
            for (int c = 0; c < 3; c++)
                irradiance[c] += weight * (double)environment->texels[row * SKY_WIDTH + i][c];
    }
    sky_sun_irradiance(sky, sun);
    for (int c = 0; c < 3; c++)
        irradiance[c] += sky->has_sun ? sun[c] * sky->sun_direction[1] : 0;
    for (uint32_t i = SKY_HEIGHT / 2 * SKY_WIDTH; i < SKY_HEIGHT * SKY_WIDTH; i++)
        for (int c = 0; c < 3; c++)
            environment->texels[i][c] = (float)(irradiance[c] * sky->ground_albedo[c] / M_PI);
}

static bool check_sky(const struct sky *sky, struct err *err)
{
    if (!(sky->turbidity >= SKY_TURBIDITY_MIN && sky->turbidity <= SKY_TURBIDITY_MAX))
        return err_set(err, ERR_INPUT, "turbidity %.9g is outside [%g, %g], the range of the model",
                       sky->turbidity, SKY_TURBIDITY_MIN, SKY_TURBIDITY_MAX);
    if (!(sky->sun_direction[1] >= 0))
        return err_set(err, ERR_INPUT,
                       "the sun is below the horizon (y of its direction is %.9g); the model is "
                       "for daylight",
                       sky->sun_direction[1]);
    return true;
}

bool scene_set_sky(struct scene *scene, const struct sky *sky, struct err *err)
{
    if (!check_sky(sky, err))
        return false;
    struct environment environment = {
        .present = true, .radiance = {1, 1, 1}, .width = SKY_WIDTH, .height = SKY_HEIGHT};
    struct sky *source = ARENA_NEW(&scene->arena, struct sky, 1);
    environment.texels =
        arena_alloc(&scene->arena, SKY_WIDTH * SKY_HEIGHT, sizeof *environment.texels);
    unsigned clipped;
    if (!environment.texels || !source || !bake_sky(sky, &environment, &clipped))
        return err_memory(err, "a sky", SKY_WIDTH * SKY_HEIGHT * sizeof *environment.texels);
    bake_ground(sky, &environment);
    *source = *sky;
    environment.sky = source;
    if (clipped > 0 &&
        !scene_note(scene, "sky: %u of %u texels have colours outside of Rec. 709 and were clipped",
                    clipped, SKY_WIDTH * SKY_HEIGHT / 2))
        return err_memory(err, "a note", 0);
    if (sky->has_sun) {
        struct environment_sun *sun = &environment.sun;
        double irradiance[3];
        sky_sun_irradiance(sky, irradiance);
        sun->angular_radius = sky->sun_diameter / 2;
        for (int c = 0; c < 3; c++) {
            sun->direction[c] = -sky->sun_direction[c];
            sun->irradiance[c] = (float)irradiance[c];
        }
    }
    const double hashed[] = {sky->turbidity,        sky->sun_direction[0], sky->sun_direction[1],
                             sky->sun_direction[2], sky->ground_albedo[0], sky->ground_albedo[1],
                             sky->ground_albedo[2], sky->sun_diameter,     sky->has_sun};
    scene->hash = hash_bytes(scene->hash, hashed, sizeof hashed);
    scene->environment = environment;
    return true;
}
