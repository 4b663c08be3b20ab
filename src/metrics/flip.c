// The metrics FLIP and HDR-FLIP. The constants are those of the two papers (see perceptual.h);
// equation numbers refer to the first one.
#include "metrics/perceptual.h"

#include "base/memory.h"
#include "metrics/convolve.h"
#include "metrics/flip_color.h"
#include "metrics/pixel.h"
#include "metrics/stoppable.h"
#include <math.h>
#include <string.h>

// --- filters -------------------------------------------------------------------------------------

static int bounded_radius(double radius)
{
    double whole = ceil(radius);
    return whole > KERNEL_RADIUS_MAX ? KERNEL_RADIUS_MAX : (int)whole;
}

// The contrast sensitivity of each opponent channel, as a sum of two Gaussians (Johnson and
// Fairchild 2003): a sqrt(pi / b) exp(-pi^2 d^2 / b), where d is the distance in degrees.
static const struct {
    double a, b;
} sensitivity[3][2] = {
    {{1, 0.0047}, {0, 1e-5}},
    {{1, 0.0053}, {0, 1e-5}},
    {{34.1, 0.04}, {13.5, 0.025}},
};
#define WIDEST_B 0.04

// Computes one of the Gaussians, normalised to a sum of 1. Returns the sum of its products over the
// plane, before normalisation.
static double sensitivity_kernel(double a, double b, double pixels_per_degree,
                                 struct kernel_1d *out)
{
    out->radius = bounded_radius(3 * sqrt(WIDEST_B / (2 * M_PI * M_PI)) * pixels_per_degree);
    double sum = 0;
    for (int i = -out->radius; i <= out->radius; i++) {
        double d = i / pixels_per_degree;
        sum += out->weight[i + out->radius] = exp(-M_PI * M_PI * d * d / b);
    }
    for (int i = 0; i <= 2 * out->radius; i++)
        out->weight[i] /= sum;
    return a * sqrt(M_PI / b) * sum * sum;
}

// Computes the detectors of edges (first derivative of a Gaussian) and of points (second
// derivative). Their positive weights sum to 1 and their negative ones to -1. `smooth` is the
// Gaussian for the perpendicular direction.
static void feature_kernels(double pixels_per_degree, struct kernel_1d *smooth,
                            struct kernel_1d *edge, struct kernel_1d *point)
{
    double sigma = 0.5 * 0.082 * pixels_per_degree, sum = 0;
    int radius = bounded_radius(3 * sigma);
    smooth->radius = edge->radius = point->radius = radius;
    for (int i = -radius; i <= radius; i++) {
        double g = exp(-i * i / (2 * sigma * sigma));
        sum += smooth->weight[i + radius] = g;
        edge->weight[i + radius] = -i * g;
        point->weight[i + radius] = (i * i / (sigma * sigma) - 1) * g;
    }
    struct kernel_1d *detectors[2] = {edge, point};
    for (int k = 0; k < 2; k++) {
        double positive = 0, negative = 0;
        for (int i = 0; i <= 2 * radius; i++) {
            positive += fmax(detectors[k]->weight[i], 0);
            negative -= fmin(detectors[k]->weight[i], 0);
        }
        for (int i = 0; i <= 2 * radius; i++) {
            double *weight = &detectors[k]->weight[i];
            *weight = *weight > 0 ? *weight / positive : *weight < 0 ? *weight / negative : 0;
        }
    }
    for (int i = 0; i <= 2 * radius; i++)
        smooth->weight[i] /= sum;
}

// --- one image -----------------------------------------------------------------------------------

struct planes {
    uint32_t width, height;
    float *opponent[3]; // YCxCz; after filtering, L*a*b*
    float *edges, *points;
    float *scratch[2];
    const struct progress *progress; // may request a stop; may be NULL
};

enum { PLANES_A_PICTURE = 7, PIXELS_A_CHUNK = 8192 };

static uint64_t pixels_of(const struct planes *p)
{
    return (uint64_t)p->width * p->height;
}

static bool planes_create(const struct picture_pair *pair, const struct progress *progress,
                          struct planes *out)
{
    *out = (struct planes){.width = pair->width, .height = pair->height, .progress = progress};
    float **all[PLANES_A_PICTURE] = {&out->opponent[0], &out->opponent[1], &out->opponent[2],
                                     &out->edges,       &out->points,      &out->scratch[0],
                                     &out->scratch[1]};
    bool ok = true;
    for (int i = 0; i < PLANES_A_PICTURE; i++) {
        *all[i] = memory_alloc(pixels_of(out) * sizeof **all[i]);
        ok = ok && *all[i];
    }
    return ok;
}

static void planes_finish(struct planes *p)
{
    for (int c = 0; c < 3; c++)
        memory_free(p->opponent[c]);
    for (int i = 0; i < 2; i++)
        memory_free(p->scratch[i]);
    memory_free(p->edges);
    memory_free(p->points);
}

// Computes the magnitude of a detector's responses along x and y.
static bool detect(struct planes *p, const float *lightness, const struct kernel_1d *smooth,
                   const struct kernel_1d *detector, float *out)
{
    if (!convolve(lightness, p->width, p->height, detector, smooth, p->progress, p->scratch[0],
                  out) ||
        !convolve(lightness, p->width, p->height, smooth, detector, p->progress, p->scratch[0],
                  p->scratch[1]))
        return false;
    for (uint64_t i = 0; i < pixels_of(p); i++)
        out[i] = sqrtf(out[i] * out[i] + p->scratch[1][i] * p->scratch[1][i]);
    return true;
}

// Filters an opponent channel by its contrast sensitivity at a viewing distance, in place.
static bool see(struct planes *p, int channel, double pixels_per_degree)
{
    struct kernel_1d kernel;
    double share[2], total = 0;
    bool ok = true;
    float *sum = memory_alloc(pixels_of(p) * sizeof *sum);
    if (!sum)
        return false;
    for (int g = 0; g < 2; g++)
        total += share[g] = sensitivity_kernel(sensitivity[channel][g].a, sensitivity[channel][g].b,
                                               pixels_per_degree, &kernel);
    for (int g = 0; g < 2 && ok; g++) {
        if (share[g] == 0)
            continue;
        sensitivity_kernel(sensitivity[channel][g].a, sensitivity[channel][g].b, pixels_per_degree,
                           &kernel);
        ok = convolve(p->opponent[channel], p->width, p->height, &kernel, &kernel, p->progress,
                      p->scratch[0], p->scratch[1]);
        for (uint64_t i = 0; ok && i < pixels_of(p); i++)
            sum[i] += (float)(share[g] / total) * p->scratch[1][i];
    }
    memory_free(p->opponent[channel]);
    p->opponent[channel] = sum;
    return ok;
}

static void perceive(void *context, size_t begin, size_t end, unsigned thread)
{
    (void)thread;
    const struct planes *p = context;
    for (size_t i = begin; i < end; i++) {
        double color[3], rgb[3];
        for (int c = 0; c < 3; c++)
            color[c] = (double)p->opponent[c][i];
        flip_rgb_of_ycxcz(color, rgb);
        for (int c = 0; c < 3; c++)
            rgb[c] = fmin(fmax(rgb[c], 0), 1);
        flip_hunt_lab(rgb, color);
        for (int c = 0; c < 3; c++)
            p->opponent[c][i] = (float)color[c];
    }
}

struct separation {
    const struct planes *planes;
    const float (*pixels)[3];
    float *lightness;
};

static void separate(void *context, size_t begin, size_t end, unsigned thread)
{
    (void)thread;
    const struct separation *s = context;
    for (size_t i = begin; i < end; i++) {
        double rgb[3], color[3];
        for (int c = 0; c < 3; c++)
            rgb[c] = fmin(fmax((double)s->pixels[i][c], 0), 1);
        flip_ycxcz_of_rgb(rgb, color);
        for (int c = 0; c < 3; c++)
            s->planes->opponent[c][i] = (float)color[c];
        s->lightness[i] = (float)((color[0] + 16) / 116);
    }
}

// Fills the planes of an image from linear values for display, which are clamped to [0, 1].
static bool analyse(struct planes *p, const float (*pixels)[3], double pixels_per_degree)
{
    struct kernel_1d smooth, edge, point;
    float *lightness = memory_alloc(pixels_of(p) * sizeof *lightness);
    if (!lightness)
        return false;
    struct separation separation = {p, pixels, lightness};
    feature_kernels(pixels_per_degree, &smooth, &edge, &point);
    bool ok = stoppable_for(pixels_of(p), PIXELS_A_CHUNK, p->progress, separate, &separation) &&
              detect(p, lightness, &smooth, &edge, p->edges) &&
              detect(p, lightness, &smooth, &point, p->points);
    memory_free(lightness);
    for (int c = 0; c < 3; c++)
        ok = ok && see(p, c, pixels_per_degree);
    return ok && stoppable_for(pixels_of(p), PIXELS_A_CHUNK, p->progress, perceive, p);
}

// --- both images ---------------------------------------------------------------------------------

// Returns the greatest possible colour difference, which is that between green and blue.
static double greatest_difference(void)
{
    double green[3], blue[3];
    flip_hunt_lab((const double[3]){0, 1, 0}, green);
    flip_hunt_lab((const double[3]){0, 0, 1}, blue);
    return pow(flip_hyab(green, blue), 0.7);
}

// Maps colour differences to [0, 1]: differences up to .4 of the greatest take up .95 of the range
// (eq. 8).
static double redistribute(double difference, double greatest)
{
    const double knee = 0.4 * greatest, at_knee = 0.95;
    double d = pow(difference, 0.7);
    if (d < knee)
        return at_knee * d / knee;
    return at_knee + (d - knee) / (greatest - knee) * (1 - at_knee);
}

struct combination {
    struct planes image, reference;
    double greatest;
    float *map;
};

static void combine(void *context, size_t begin, size_t end, unsigned thread)
{
    (void)thread;
    const struct combination *both = context;
    const struct planes *image = &both->image, *reference = &both->reference;
    for (size_t i = begin; i < end; i++) {
        double a[3], b[3];
        for (int c = 0; c < 3; c++) {
            a[c] = (double)image->opponent[c][i];
            b[c] = (double)reference->opponent[c][i];
        }
        double color = redistribute(flip_hyab(a, b), both->greatest);
        double edges = fabs((double)image->edges[i] - (double)reference->edges[i]);
        double points = fabs((double)image->points[i] - (double)reference->points[i]);
        double feature = sqrt(fmax(edges, points) / M_SQRT2);
        both->map[i] = (float)pow(color, 1 - feature);
    }
}

static bool flip_map(const struct picture_pair *pair, double pixels_per_degree,
                     const struct progress *progress, float *map)
{
    struct combination both = {.greatest = greatest_difference(), .map = map};
    bool ok = planes_create(pair, progress, &both.image);
    ok = planes_create(pair, progress, &both.reference) && ok;
    ok = ok && analyse(&both.image, pair->image, pixels_per_degree) &&
         analyse(&both.reference, pair->reference, pixels_per_degree) &&
         stoppable_for(pixels_of(&both.image), PIXELS_A_CHUNK, progress, combine, &both);
    planes_finish(&both.image);
    planes_finish(&both.reference);
    return ok;
}

// Bytes per pixel of the planes of both images, and of one more plane for the lightness or a
// filtered channel.
enum { MAP_BYTES_A_PIXEL = (2 * PLANES_A_PICTURE + 1) * (int)sizeof(float) };

static double mean_of(const float *map, uint64_t count)
{
    double sum = 0;
    for (uint64_t i = 0; i < count; i++)
        sum += (double)map[i];
    return sum / (double)count;
}

// --- exposures -----------------------------------------------------------------------------------

// The tone curve of ACES (Narkowicz 2015), (k0 x^2 + k1 x + k2) / (k3 x^2 + k4 x + k5), for an
// input scaled by .6.
static const double curve[6] = {0.6 * 0.6 * 2.51, 0.6 * 0.03, 0,
                                0.6 * 0.6 * 2.43, 0.6 * 0.59, 0.14};

static double tone(double x)
{
    double value =
        (curve[0] * x * x + curve[1] * x + curve[2]) / (curve[3] * x * x + curve[4] * x + curve[5]);
    return fmin(fmax(value, 0), 1);
}

// Returns the value that the curve maps to .85.
static double knee_of_curve(void)
{
    double a = curve[0] - 0.85 * curve[3], b = curve[1] - 0.85 * curve[4];
    double c = curve[2] - 0.85 * curve[5], half = -0.5 * b / a;
    return half + sqrt(half * half - c / a);
}

static bool is_finite_pair(const struct picture_pair *pair, uint64_t i)
{
    return pixel_is_finite(pair->image[i]) && pixel_is_finite(pair->reference[i]);
}

// Returns the luminance, at least 0; it is 0 if a channel is not finite.
static float luminance_of(const float pixel[3])
{
    double light[3];
    for (int c = 0; c < 3; c++)
        light[c] = fmax((double)pixel[c], 0);
    // Adding 0 turns -0 into 0.
    return pixel_is_finite(pixel) ? (float)flip_luminance(light) + 0.0f : 0.0f;
}

struct luminances {
    float brightest, median;
};

// Finds the greatest and the median luminance. The bits of non-negative floats have the same order
// as their values. So the median is determined from the highest bits on: each pass counts the next
// bits of all values that have the known prefix. This needs neither memory nor a sort, which could
// not be stopped.
static bool find_luminances(const struct picture_pair *pair, const struct progress *progress,
                            struct luminances *out)
{
    enum { BITS_A_PASS = 11 };
    uint64_t count = (uint64_t)pair->width * pair->height, rank = (count - 1) / 2;
    uint32_t known = 0;
    *out = (struct luminances){0};
    for (uint32_t left = 33; left > 0;) { // one bit more than a value has; the additional bit is 0
        uint64_t with[1 << BITS_A_PASS] = {0};
        uint32_t prefix = known, digit = 0;
        left -= BITS_A_PASS;
        for (uint64_t i = 0; i < count; i++) {
            if (progress_stops_at(progress, i))
                return false;
            float luminance = luminance_of(pair->reference[i]);
            uint32_t bits;
            memcpy(&bits, &luminance, sizeof bits);
            out->brightest = fmaxf(out->brightest, luminance);
            if ((uint64_t)bits >> (left + BITS_A_PASS) == prefix)
                with[bits >> left & ((1 << BITS_A_PASS) - 1)]++;
        }
        for (; rank >= with[digit]; digit++)
            rank -= with[digit];
        known = prefix << BITS_A_PASS | digit;
    }
    memcpy(&out->median, &known, sizeof known);
    return true;
}

struct flip_exposures metrics_flip_exposures_between(double start, double stop)
{
    return (struct flip_exposures){start, stop, (uint32_t)fmax(2, ceil(stop - start))};
}

bool metrics_flip_exposures(const struct picture_pair *pair, const struct progress *progress,
                            struct flip_exposures *out)
{
    struct luminances of;
    if (!find_luminances(pair, progress, &of))
        return false;
    double brightest = (double)of.brightest, median = (double)of.median;
    double knee = knee_of_curve();
    double start = brightest > 0 ? log2(knee / brightest) : 0;
    double stop = median > 0 ? log2(knee / median) : start + FLIP_STOPS_MAX;
    *out = metrics_flip_exposures_between(start, fmin(stop, start + FLIP_STOPS_MAX));
    return true;
}

struct exposition {
    const struct picture_pair *pair;
    double factor;
    float (*exposed[2])[3]; // the image and the reference at one exposure
};

static void expose(void *context, size_t begin, size_t end, unsigned thread)
{
    (void)thread;
    const struct exposition *e = context;
    const float(*pixels[2])[3] = {e->pair->image, e->pair->reference};
    for (size_t i = begin; i < end; i++) {
        bool finite = is_finite_pair(e->pair, i);
        for (int k = 0; k < 2; k++)
            for (int c = 0; c < 3; c++) {
                double light = e->factor * fmax((double)pixels[k][i][c], 0);
                e->exposed[k][i][c] = finite ? (float)tone(light) : 0.0f;
            }
    }
}

// Raises each value of `greatest` to the FLIP of the pair at one exposure if that is larger.
static bool raise_map(const struct picture_pair *pair, double pixels_per_degree, double stops,
                      const struct progress *progress, float (*exposed[2])[3], float *map,
                      float *greatest)
{
    uint64_t count = (uint64_t)pair->width * pair->height;
    struct exposition exposition = {pair, exp2(stops), {exposed[0], exposed[1]}};
    if (!stoppable_for(count, PIXELS_A_CHUNK, progress, expose, &exposition))
        return false;
    struct picture_pair shown = {(const float(*)[3])exposed[0], (const float(*)[3])exposed[1],
                                 pair->width, pair->height};
    if (!flip_map(&shown, pixels_per_degree, progress, map))
        return false;
    for (uint64_t i = 0; i < count; i++)
        greatest[i] = fmaxf(greatest[i], map[i]);
    return true;
}

// Counts the exposed images, the map of one exposure and the map of all exposures.
uint64_t metrics_flip_hdr_bytes(uint32_t width, uint32_t height)
{
    return (uint64_t)width * height *
           (2 * sizeof(float[3]) + 2 * sizeof(float) + MAP_BYTES_A_PIXEL);
}

bool metrics_flip_hdr(const struct picture_pair *pair, double pixels_per_degree,
                      const struct flip_exposures *exposures, const struct progress *progress,
                      float *map, double *out)
{
    uint64_t count = (uint64_t)pair->width * pair->height;
    float(*exposed[2])[3] = {memory_alloc(count * sizeof **exposed),
                             memory_alloc(count * sizeof **exposed)};
    float *one = memory_alloc(count * sizeof *one);
    float *greatest = memory_alloc(count * sizeof *greatest);
    bool ok = exposed[0] && exposed[1] && one && greatest;
    for (uint32_t i = 0; i < exposures->count && ok; i++) {
        double stops =
            exposures->start + (exposures->stop - exposures->start) * i / (exposures->count - 1);
        progress_report(progress, "Comparing", (double)i / exposures->count);
        ok = raise_map(pair, pixels_per_degree, stops, progress, exposed, one, greatest);
    }
    if (ok) {
        *out = mean_of(greatest, count);
        if (map)
            memcpy(map, greatest, count * sizeof *map);
    }
    memory_free(exposed[0]);
    memory_free(exposed[1]);
    memory_free(one);
    memory_free(greatest);
    return ok;
}

// Counts the map, and copies of the images in which pixels that are not finite are black.
uint64_t metrics_flip_bytes(uint32_t width, uint32_t height)
{
    return (uint64_t)width * height * (2 * sizeof(float[3]) + sizeof(float) + MAP_BYTES_A_PIXEL);
}

bool metrics_flip(const struct picture_pair *pair, double pixels_per_degree,
                  const struct progress *progress, float *map, double *out)
{
    uint64_t count = (uint64_t)pair->width * pair->height;
    float(*clean[2])[3] = {memory_alloc(count * sizeof **clean),
                           memory_alloc(count * sizeof **clean)};
    float *own = map ? map : memory_alloc(count * sizeof *own);
    bool ok = clean[0] && clean[1] && own;
    for (uint64_t i = 0; i < count && ok; i++) {
        ok = !progress_stops_at(progress, i);
        if (!is_finite_pair(pair, i))
            continue;
        memcpy(clean[0][i], pair->image[i], sizeof clean[0][i]);
        memcpy(clean[1][i], pair->reference[i], sizeof clean[1][i]);
    }
    struct picture_pair shown = {(const float(*)[3])clean[0], (const float(*)[3])clean[1],
                                 pair->width, pair->height};
    ok = ok && flip_map(&shown, pixels_per_degree, progress, own);
    if (ok)
        *out = mean_of(own, count);
    memory_free(clean[0]);
    memory_free(clean[1]);
    if (own != map)
        memory_free(own);
    return ok;
}
