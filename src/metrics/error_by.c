// Computes the interval of a share R = E_k / E, where E_k and E are sums of e_k and e over pixels.
// Pixels have independent noise, so the variance of R is, to first order, the sum of (e_k - R e)^2
// over E^2 (Cochran 1977, "Sampling Techniques", section 2.11). The expectation of such a square is
// the variance of e_k - R e plus its squared mean, which is not 0 if shares differ between parts of
// the image; so the interval may be too wide but not too narrow. A few pixels may contribute most
// of the sum. Student's t allows for that, with as many degrees of freedom as a sum of equal terms
// with the same uncertainty would have (Satterthwaite 1946).
#include "metrics/error_by.h"

#include "metrics/pixel.h"
#include <math.h>

// The terms are the classes and, as the last one, their covariances.
enum { TERMS_MAX = ERROR_BY_CLASSES_MAX + 1 };

// The terms e_k of one pixel, or their sums over pixels.
struct terms {
    double whole, parts[TERMS_MAX];
};

static double half_difference(const float a[3], const float b[3], int c)
{
    return ((double)a[c] - (double)b[c]) / 2;
}

double metrics_error_of_pixel(const struct error_by_params *p, uint64_t pixel)
{
    double sum = 0;
    for (int c = 0; c < 3; c++) {
        double weight = p->weights[pixel][c];
        if (!(weight > 0))
            continue;
        double d = half_difference(p->halves->half_a[pixel], p->halves->half_b[pixel], c);
        sum += weight * d * d;
    }
    return sum;
}

double metrics_error_sum(const struct error_by_params *p)
{
    uint64_t pixels = (uint64_t)p->halves->width * p->halves->height;
    double sum = 0;
    for (uint64_t i = 0; i < pixels; i++)
        sum += metrics_error_of_pixel(p, i);
    return sum;
}

static struct terms find_terms(const struct error_by_params *p, uint64_t pixel)
{
    struct terms terms = {.whole = metrics_error_of_pixel(p, pixel)};
    double *together = &terms.parts[p->count];
    for (int c = 0; c < 3; c++) {
        double weight = p->weights[pixel][c];
        if (!(weight > 0))
            continue;
        for (uint32_t k = 0; k < p->count; k++) {
            uint64_t at = pixel * p->stride + k;
            double of_class = half_difference(p->class_a[at], p->class_b[at], c);
            terms.parts[k] += weight * of_class * of_class;
        }
    }
    *together = terms.whole;
    for (uint32_t k = 0; k < p->count; k++)
        *together -= terms.parts[k];
    return terms;
}

static double luminance(const float a[3], const float b[3])
{
    static const double parts[3] = {0.2126, 0.7152, 0.0722};
    double sum = 0;
    for (int c = 0; c < 3; c++)
        sum += parts[c] * ((double)a[c] + (double)b[c]) / 2;
    return sum;
}

static void find_light(const struct error_by_params *p, uint64_t pixels, double light[])
{
    double whole = 0;
    for (uint64_t i = 0; i < pixels; i++) {
        const float *a = p->halves->half_a[i], *b = p->halves->half_b[i];
        if (!pixel_is_finite(a) || !pixel_is_finite(b))
            continue;
        whole += luminance(a, b);
        for (uint32_t k = 0; k < p->count; k++)
            light[k] += luminance(p->class_a[i * p->stride + k], p->class_b[i * p->stride + k]);
    }
    for (uint32_t k = 0; k < p->count; k++)
        light[k] /= whole; // NAN if the image is black
}

// Returns the interval of `share`. `whole` is E; `squares` and `fourths` are the sums of (e_k - R
// e)^2 and of its square over pixels.
static struct interval share_interval(double share, double whole, double squares, double fourths)
{
    double reach = 0;
    if (squares > 0)
        reach =
            sqrt(squares) / whole * stats_t_quantile(0.975, fmax(squares * squares / fourths, 1));
    return (struct interval){share, share - reach, share + reach};
}

void metrics_error_by(const struct error_by_params *p, struct error_by *out)
{
    uint64_t pixels = (uint64_t)p->halves->width * p->halves->height;
    struct terms sums = {0};
    double share[TERMS_MAX], squares[TERMS_MAX] = {0}, fourths[TERMS_MAX] = {0}, judged = 0;
    *out = (struct error_by){.count = p->count};
    find_light(p, pixels, out->light);
    for (uint64_t i = 0; i < pixels; i++) {
        struct terms terms = find_terms(p, i);
        judged += p->weights[i][0] > 0;
        sums.whole += terms.whole;
        for (uint32_t k = 0; k <= p->count; k++)
            sums.parts[k] += terms.parts[k];
    }
    for (uint32_t k = 0; k <= p->count; k++)
        share[k] = sums.whole > 0 ? sums.parts[k] / sums.whole : NAN;
    for (uint64_t i = 0; i < pixels; i++) {
        struct terms terms = find_terms(p, i);
        for (uint32_t k = 0; k <= p->count; k++) {
            double off = terms.parts[k] - share[k] * terms.whole, square = off * off;
            squares[k] += square;
            fourths[k] += square * square;
        }
    }
    out->error = sums.whole / judged;
    for (uint32_t k = 0; k <= p->count; k++) {
        struct error_share *to = k < p->count ? &out->classes[k] : &out->together;
        to->error = sums.parts[k] / judged;
        to->share = share_interval(share[k], sums.whole, squares[k], fourths[k]);
        if (k < p->count) // the error of a class is a sum of squares, so not negative
            to->share.low = fmax(to->share.low, 0);
    }
}

// --- several pictures ----------------------------------------------------------------------------

// Returns the share of class k; k = count stands for the classes' covariances.
static const struct error_share *share_at(const struct error_by *by, uint32_t k)
{
    return k < by->count ? &by->classes[k] : &by->together;
}

static struct error_share pool_share(const struct error_by *pictures, uint32_t count, uint32_t k,
                                     double whole)
{
    double error = 0, squares = 0;
    for (uint32_t i = 0; i < count; i++)
        error += share_at(&pictures[i], k)->error / count;
    double share = whole > 0 ? error / whole : NAN;
    for (uint32_t i = 0; i < count; i++) {
        double off = share_at(&pictures[i], k)->error - share * pictures[i].error;
        squares += off * off;
    }
    // The variance of the ratio of two means, as described at the top of this file.
    double reach = NAN;
    if (count > 1)
        reach = sqrt(squares / ((double)count * (count - 1))) / whole *
                stats_t_quantile(0.975, count - 1.0);
    return (struct error_share){error, {share, share - reach, share + reach}};
}

void metrics_error_by_pool(const struct error_by *pictures, uint32_t count, struct error_by *out)
{
    *out = (struct error_by){.count = pictures[0].count};
    for (uint32_t i = 0; i < count; i++) {
        out->error += pictures[i].error / count;
        for (uint32_t k = 0; k < out->count; k++)
            out->light[k] += pictures[i].light[k] / count;
    }
    for (uint32_t k = 0; k < out->count; k++) {
        out->classes[k] = pool_share(pictures, count, k, out->error);
        if (count > 1)
            out->classes[k].share.low = fmax(out->classes[k].share.low, 0);
    }
    out->together = pool_share(pictures, count, out->count, out->error);
}
