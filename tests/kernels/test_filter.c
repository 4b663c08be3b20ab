// Tests the renderer's pixel filters (lib/filter.glsl) on the device: the distribution function of
// the filter at each position must be the uniform from which the position was made.
#include "sampler_fixture.h"

static union draw draws[SAMPLER_ITEMS];

// Distribution functions in [-1, 1], in double precision.
static double box_below(double x)
{
    return (1 + x) / 2;
}

static double tent_below(double x)
{
    return x < 0 ? (1 + x) * (1 + x) / 2 : 1 - (1 - x) * (1 - x) / 2;
}

// Harris 1978, table 1.
static double blackman_harris_below(double x)
{
    static const double a[4] = {0.35875, 0.48829, 0.14128, 0.01168};
    double sum = a[0] * x;
    for (int k = 1; k < 4; k++)
        sum += a[k] * sin(k * M_PI * x) / (k * M_PI);
    return 0.5 + sum / (2 * a[0]);
}

static double (*const below[])(double) = {
    [FILTER_BOX] = box_below,
    [FILTER_TENT] = tent_below,
    [FILTER_BLACKMAN_HARRIS] = blackman_harris_below,
};

// Fills the uniforms with all corners of the square and random values.
static void fill_uniforms(void)
{
    static const float extremes[] = {0, 0x1p-24f, 0x1p-12f, 0.5f, 1 - 0x1p-12f, 1 - 0x1p-24f};
    struct random random = {43};
    for (uint32_t i = 0; i < SAMPLER_ITEMS; i++) {
        for (int c = 0; c < 2; c++)
            draws[i].u[c] = (float)(random_u32(&random) >> 8) * 0x1p-24f;
        if (i < 36) {
            draws[i].u[0] = extremes[i / 6];
            draws[i].u[1] = extremes[i % 6];
        }
    }
}

static void check_separable(const struct sampler_setup *s, const union draw *given, double *worst)
{
    double radius = (double)s->filter_radius;
    for (uint32_t i = 0; i < SAMPLER_ITEMS; i++) {
        for (int c = 0; c < 2; c++) {
            double x = ((double)draws[i].u[c] - 0.5) / radius;
            bool inside = fabs(x) <= 1 + 1e-6;
            CHECK(inside, "%s: %g from %g", filter_names[s->filter], x, (double)given[i].u[c]);
            if (inside)
                *worst = fmax(*worst, fabs(below[s->filter](x) - (double)given[i].u[c]));
        }
    }
}

// Radially, the filter has the fraction 1 - exp(-9/2 r^2) of its total within the radius; the angle
// is uniform.
static void check_gaussian(const struct sampler_setup *s, const union draw *given, double *worst)
{
    double radius = (double)s->filter_radius;
    for (uint32_t i = 0; i < SAMPLER_ITEMS; i++) {
        double x = ((double)draws[i].u[0] - 0.5) / radius,
               y = ((double)draws[i].u[1] - 0.5) / radius;
        double share = -expm1(-4.5 * (x * x + y * y)) / -expm1(-4.5);
        *worst = fmax(*worst, fabs(share - (double)given[i].u[0]));
        double turn = atan2(y, x) / (2 * M_PI) - (double)given[i].u[1];
        // Near the centre the error is the rounding of the position.
        if (given[i].u[0] > 1e-3f)
            *worst = fmax(*worst, fabs(turn - rint(turn)) * sqrt((double)given[i].u[0]));
    }
}

// The error is at most 1e-6 for the smallest to the largest radius. Positions are rounded to 24
// bits of a pixel plus the radius.
TEST(inverse_distribution)
{
    static const float radii[] = {0.25f, 0.5f, 1.5f, 16};
    static union draw given[SAMPLER_ITEMS];
    static struct sampler_setup s;
    OPEN_SAMPLER(&s, 8, 8);
    for (s.filter = 0; filter_names[s.filter]; s.filter++) {
        for (int r = 0; r < 4; r++) {
            double worst = 0;
            s.filter_radius = radii[r];
            fill_uniforms();
            memcpy(given, draws, sizeof given);
            if (!sampler_positions(&s, draws, SAMPLER_ITEMS))
                break;
            if (s.filter == FILTER_GAUSSIAN)
                check_gaussian(&s, given, &worst);
            else
                check_separable(&s, given, &worst);
            printf("  %-16s radius %-5g off by %.2g at most\n", filter_names[s.filter],
                   (double)radii[r], worst);
            CHECK(worst <= 1e-6, "%s, radius %g: %g", filter_names[s.filter], (double)radii[r],
                  worst);
        }
    }
    sampler_close(&s);
}

// The box filter of one pixel returns the uniforms unchanged, bit for bit.
TEST(box_is_the_pixel)
{
    static union draw given[SAMPLER_ITEMS];
    static struct sampler_setup s;
    OPEN_SAMPLER(&s, 8, 8);
    s.filter = FILTER_BOX;
    s.filter_radius = 0.5f;
    fill_uniforms();
    memcpy(given, draws, sizeof given);
    if (sampler_positions(&s, draws, SAMPLER_ITEMS))
        for (uint32_t i = 0; i < SAMPLER_ITEMS; i++)
            CHECK(draws[i].u[0] == given[i].u[0] && draws[i].u[1] == given[i].u[1], "%g, %g",
                  (double)draws[i].u[0], (double)draws[i].u[1]);
    sampler_close(&s);
}

TEST_MAIN(TEST_CASE(inverse_distribution), TEST_CASE(box_is_the_pixel))
