#include "metrics/small_lights.h"

#include <math.h>

// If this many samples were expected to hit an emitter and none has, it is assumed to be occluded
// or smaller than it seems. Otherwise the probability of no hit would be exp(-7) = .1 %.
static const double expected_max = 7;

// A blurred emitter may be visible in many pixels. All of them are tested if they are within this
// radius, in pixels. For a larger radius, a lattice of about as many pixels is tested: testing all
// pixels took 4 s for an image with 16,384 blurred lamps.
enum { LOOK_REACH = 16 };

// A sample that hits an emitter contributes at least this fraction of its radiance: the pixel
// filter and the emitter's edge may reduce it.
static const double met_part = 0.5;

double half_error_samples(const struct half_error_params *params, uint64_t pixel)
{
    return params->counts ? params->counts[pixel] : (double)params->samples;
}

const struct small_light *small_lights_from(const struct unseen_light *unseen, uint32_t x,
                                            uint32_t y)
{
    size_t first = 0, end = unseen->small_count;
    while (first < end) {
        size_t middle = first + (end - first) / 2;
        const struct small_light *light = &unseen->small[middle];
        if (light->y < y || (light->y == y && light->x < x))
            first = middle + 1;
        else
            end = middle;
    }
    return unseen->small + first;
}

static double mean_at(const struct half_error_params *params, uint64_t pixel, int c)
{
    return ((double)params->half_a[pixel][c] + (double)params->half_b[pixel][c]) / 2;
}

// Estimates the background of an emitter: the median of the surrounding pixels, the lesser of the
// two central ones. A mean would include the emitter's own light in neighbours that it is blurred
// into.
static double find_background(const struct half_error_params *params, uint32_t x, uint32_t y, int c)
{
    double values[8];
    int count = 0;
    for (uint32_t v = y > 0 ? y - 1 : 0; v <= y + 1 && v < params->height; v++)
        for (uint32_t u = x > 0 ? x - 1 : 0; u <= x + 1 && u < params->width; u++) {
            double value = mean_at(params, (uint64_t)v * params->width + u, c);
            int at = count;
            if (u == x && v == y)
                continue;
            for (; at > 0 && values[at - 1] > value; at--)
                values[at] = values[at - 1];
            values[at] = value;
            count++;
        }
    return count > 0 ? values[(count - 1) / 2] : 0;
}

// Returns whether a sample has hit the emitter: whether some pixel in which it may be visible
// exceeds its background by at least one sample. Hits in pixels between the lattice's points are
// not detected.
static bool is_met(const struct half_error_params *params, const struct small_light *light)
{
    int c = light->radiance[0] >= light->radiance[1] ? 0 : 1;
    c = light->radiance[c] >= light->radiance[2] ? c : 2;
    double enough = met_part * (double)light->radiance[c];
    uint32_t reach = (uint32_t)fmin(ceil((double)light->radius), 1u << 16);
    uint32_t left = light->x > reach ? light->x - reach : 0;
    uint32_t top = light->y > reach ? light->y - reach : 0;
    uint32_t stride = 1 + reach / LOOK_REACH;
    for (uint32_t y = top; y <= light->y + reach && y < params->height; y += stride)
        for (uint32_t x = left; x <= light->x + reach && x < params->width; x += stride) {
            uint64_t at = (uint64_t)y * params->width + x;
            double mean = mean_at(params, at, c), samples = half_error_samples(params, at);
            if (mean * samples >= enough &&
                (mean - find_background(params, x, y, c)) * samples >= enough)
                return true;
        }
    return false;
}

// Returns the number of pixels over which an emitter's light is assumed to be distributed evenly.
static double pixels_of(const struct small_light *light)
{
    return fmax(M_PI * (double)light->radius * (double)light->radius, 1);
}

// Adds the light of the other small emitters in row y of the window around `light`, with the
// window's weights.
static void add_lights_of_row(const struct unseen_light *unseen, const struct small_light *light,
                              uint32_t y, double sums[3])
{
    uint32_t left = light->x > LOCAL_REACH ? light->x - LOCAL_REACH : 0;
    const struct small_light *end = unseen->small + unseen->small_count;
    const struct small_light *other = small_lights_from(unseen, left, y);
    for (; other < end && other->y == y && other->x <= light->x + LOCAL_REACH; other++) {
        double weight = local_window_weight((int)(other->x - light->x), (int)(y - light->y));
        for (int c = 0; c < 3 && other != light; c++)
            sums[c] += weight * (double)other->part * (double)other->radiance[c] / pixels_of(other);
    }
}

// Returns the mean around a pixel. The known light of small emitters replaces the samples that
// happened to hit them if that lowers the mean, because a mean that is too high makes errors seem
// small.
static struct local_mean find_known_mean(const struct half_error_params *params,
                                         const struct small_light *light,
                                         const struct local_mean *around)
{
    struct local_mean mean = *around;
    if (!(around->own < 1))
        return mean;
    // Total weight of the neighbours, if that of the pixel is 1.
    double sums[3] = {0}, weights = (1 - around->own) / around->own;
    uint32_t top = light->y > LOCAL_REACH ? light->y - LOCAL_REACH : 0;
    for (uint32_t y = top; y <= light->y + LOCAL_REACH && y < params->height; y++)
        add_lights_of_row(&params->unseen, light, y, sums);
    for (int c = 0; c < 3; c++) {
        double background = find_background(params, light->x, light->y, c);
        mean.mean[c] = fmin(mean.mean[c], background + sums[c] / weights);
    }
    return mean;
}

static void add_unmet(struct small_lights *sums, const struct half_error_params *params,
                      const struct small_light *light, const struct local_mean *around)
{
    uint64_t at = (uint64_t)light->y * params->width + light->x;
    double pixels = pixels_of(light);
    for (int c = 0; c < 3; c++) {
        double missing = (double)light->part * (double)light->radiance[c] / pixels;
        double local = around->own * missing + (1 - around->own) * around->mean[c];
        double value = missing + fmax(mean_at(params, at, c), 0);
        double square = pixels * missing * missing / 3;
        sums->error.unmet += square / (local * local + METRICS_RELMSE_EPSILON);
        sums->relmse.unmet += square / (value * value + METRICS_RELMSE_EPSILON);
    }
}

static void add_pixel(struct light_errors *sums, const struct light_errors *pixel)
{
    sums->expected += pixel->expected;
    sums->squares += pixel->expected * pixel->expected; // all channels share the same hits
    sums->told += pixel->told;
    sums->open += pixel->open;
}

static void add_met(struct small_lights *sums, const struct half_error_params *params,
                    const struct small_light *light, const struct local_mean *around)
{
    uint64_t at = (uint64_t)light->y * params->width + light->x;
    double samples = half_error_samples(params, at), part = fmin((double)light->part, 1);
    struct light_errors error = {0}, relmse = {0};
    for (int c = 0; c < 3; c++) {
        double radiance = (double)light->radiance[c], value = part * radiance;
        double half = ((double)params->half_a[at][c] - (double)params->half_b[at][c]) / 2;
        double expected = part * (1 - part) * radiance * radiance / samples;
        double open = 0.25 * radiance * radiance / (samples * samples);
        double weight = local_weigh(value, around, c).value;
        double relative = 1 / (value * value + METRICS_RELMSE_EPSILON) / 3;
        error.expected += expected * weight;
        error.told += half * half * weight;
        error.open += open * weight;
        relmse.expected += expected * relative;
        relmse.told += half * half * relative;
        relmse.open += open * relative;
    }
    add_pixel(&sums->error, &error);
    add_pixel(&sums->relmse, &relmse);
}

double small_lights_add(struct small_lights *sums, const struct half_error_params *params,
                        const struct small_light *light, const struct local_mean *around)
{
    uint64_t at = (uint64_t)light->y * params->width + light->x;
    double told = sums->error.told, expected = (double)light->part * half_error_samples(params, at);
    if (light->radius > 0 && expected >= expected_max)
        return NAN;
    struct local_mean mean = find_known_mean(params, light, around);
    bool met = is_met(params, light);
    if (!met && expected < expected_max)
        add_unmet(sums, params, light, &mean);
    if (!met || light->radius > 0)
        return NAN;
    add_met(sums, params, light, &mean);
    return sums->error.told - told;
}

static void join(struct light_errors *sums, const struct light_errors *other)
{
    sums->unmet += other->unmet;
    sums->expected += other->expected;
    sums->squares += other->squares;
    sums->told += other->told;
    sums->open += other->open;
}

void small_lights_join(struct small_lights *sums, const struct small_lights *other)
{
    join(&sums->error, &other->error);
    join(&sums->relmse, &other->relmse);
}

// Returns the number of equal terms whose sum would have the same relative deviation as the sum of
// the expected errors.
static double find_terms(const struct light_errors *errors)
{
    return fmax(errors->expected * errors->expected / errors->squares, 1);
}

// Returns the quantile of a mean of `terms` squared normal variables, relative to its expectation
// (Wilson and Hilferty 1931, "The distribution of chi-square").
static double find_mean_quantile(double quantile, double terms)
{
    double part = 2 / (9 * terms);
    return pow(1 - part + stats_t_quantile(quantile, 1e9) * sqrt(part), 3);
}

// Returns the quantile of the ratio of two means, each of `terms` squared normal variables
// (Cacoullos 1965, "A relation between t and F-distributions").
static double find_ratio_quantile(double quantile, double terms)
{
    double t = stats_t_quantile(quantile, terms) / sqrt(terms), root = t + hypot(t, 1);
    return root * root;
}

double light_errors_most(const struct light_errors *errors, double quantile)
{
    if (!(errors->squares > 0))
        return errors->unmet + errors->told;
    double terms = find_terms(errors);
    double most = fmin(errors->expected * find_mean_quantile(quantile, terms),
                       (errors->told + errors->open) * find_ratio_quantile(quantile, terms));
    return errors->unmet + fmax(most, errors->told);
}

double light_errors_least(const struct light_errors *errors, double quantile)
{
    if (!(errors->squares > 0))
        return errors->told;
    return errors->told / find_ratio_quantile(quantile, find_terms(errors));
}
