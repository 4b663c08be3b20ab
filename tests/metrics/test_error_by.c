// Tests the parts of an error with synthetic noise of known variances and covariances.
#include "metrics/error_by.h"
#include "random.h"
#include "test.h"
#include <math.h>
#include <stdlib.h>

enum { SIDE = 64, PIXELS = SIDE * SIDE, CLASSES = 3 };

// An image with light 1 in each class, grey except for rounding.
struct picture {
    float (*half_a)[3], (*half_b)[3], (*class_a)[3], (*class_b)[3];
    double (*weights)[3];
};

static struct picture picture_create(void)
{
    return (struct picture){calloc(PIXELS, 12), calloc(PIXELS, 12), calloc(PIXELS * CLASSES, 12),
                            calloc(PIXELS * CLASSES, 12), calloc(PIXELS, 24)};
}

static void picture_finish(struct picture *p)
{
    free(p->half_a);
    free(p->half_b);
    free(p->class_a);
    free(p->class_b);
    free(p->weights);
}

// Fills the image: the means of class k deviate by `deviation[k]` times noise of its own, and by
// `common[k]` times noise that all classes share.
static void fill(struct picture *p, const double *deviation, const double *common)
{
    for (uint32_t i = 0; i < 2 * PIXELS; i++) {
        float *half = i < PIXELS ? p->half_a[i] : p->half_b[i - PIXELS];
        float(*classes)[3] = i < PIXELS ? p->class_a + (size_t)i * CLASSES
                                        : p->class_b + (size_t)(i - PIXELS) * CLASSES;
        double shared = normal(), sum = 0;
        for (int k = 0; k < CLASSES; k++) {
            double value = 1 + deviation[k] * normal() + common[k] * shared;
            sum += value;
            for (int c = 0; c < 3; c++)
                classes[k][c] = (float)value;
        }
        for (int c = 0; c < 3; c++)
            half[c] = (float)sum;
    }
}

static struct error_by split(struct picture *p)
{
    struct error_by by;
    const struct half_error_params halves = {.half_a = (const float(*)[3])p->half_a,
                                             .half_b = (const float(*)[3])p->half_b,
                                             .width = SIDE,
                                             .height = SIDE,
                                             .samples = 16};
    const struct error_by_params params = {.halves = &halves,
                                           .weights = (const double(*)[3])p->weights,
                                           .class_a = (const float(*)[3])p->class_a,
                                           .class_b = (const float(*)[3])p->class_b,
                                           .count = CLASSES,
                                           .stride = CLASSES};
    struct half_error error;
    CHECK(metrics_half_error_weights(&halves, p->weights) && metrics_half_error(&halves, &error));
    metrics_error_by(&params, &by);
    CHECK(fabs(by.error - error.local_relmse) <= 1e-12 * by.error, "%g, but %g in all", by.error,
          error.local_relmse);
    CHECK(fabs(metrics_error_sum(&params) - by.error * PIXELS) <= 1e-9 * by.error * PIXELS);
    double sum = by.together.error;
    for (int k = 0; k < CLASSES; k++)
        sum += by.classes[k].error;
    CHECK(fabs(sum - by.error) <= 1e-12 * by.error, "parts of %g in all, the whole is %g", sum,
          by.error);
    return by;
}

// Checks the shares d_k^2 + s_k^2 of (sum s_k)^2 + sum d_k^2, and how often the intervals contain
// them.
static void check_shares(const double *deviation, const double *common)
{
    enum { TRIALS = 200 };
    struct picture p = picture_create();
    double own[CLASSES + 1], whole = 0, covariances = 0, shared = 0;
    int held = 0;
    for (int k = 0; k < CLASSES; k++) {
        own[k] = deviation[k] * deviation[k] + common[k] * common[k];
        whole += deviation[k] * deviation[k];
        shared += common[k];
        covariances -= own[k];
    }
    whole += shared * shared;
    own[CLASSES] = covariances + whole;
    double means[CLASSES + 1] = {0};
    for (int t = 0; t < TRIALS; t++) {
        fill(&p, deviation, common);
        struct error_by by = split(&p);
        for (int k = 0; k <= CLASSES; k++) {
            const struct error_share *e = k < CLASSES ? &by.classes[k] : &by.together;
            double expected = own[k] / whole;
            means[k] += e->share.value / TRIALS;
            held += e->share.low <= expected + 1e-9 && e->share.high >= expected - 1e-9;
        }
    }
    printf("  intervals held in %.1f %%\n", 100.0 * held / (TRIALS * (CLASSES + 1)));
    CHECK(held >= 0.93 * TRIALS * (CLASSES + 1), "intervals held in %d of %d", held,
          TRIALS * (CLASSES + 1));
    for (int k = 0; k <= CLASSES; k++)
        CHECK(fabs(means[k] - own[k] / whole) < 0.01 * (1 + fabs(own[k] / whole)),
              "class %d: %g, expected %g", k, means[k], own[k] / whole);
    picture_finish(&p);
}

TEST(independent_classes)
{
    check_shares((const double[]){0.05, 0.02, 0.01}, (const double[]){0, 0, 0});
}

TEST(classes_that_come_together)
{
    check_shares((const double[]){0.05, 0.02, 0.01}, (const double[]){0.02, 0.03, 0});
}

TEST(classes_that_take_turns)
{
    check_shares((const double[]){0.01, 0.02, 0.03}, (const double[]){0.05, -0.04, 0});
}

// Shares of the mean error of several images, with intervals from the differences between images.
TEST(pictures_together)
{
    enum { COUNT = 3, TRIALS = 100 };
    const double deviation[] = {0.05, 0.03, 0.02}, common[] = {0, 0, 0}, whole = 0.0038;
    struct picture p = picture_create();
    int held = 0;
    for (int t = 0; t < TRIALS; t++) {
        struct error_by pictures[COUNT], by;
        double sum = 0;
        for (int i = 0; i < COUNT; i++) {
            fill(&p, deviation, common);
            pictures[i] = split(&p);
            sum += pictures[i].classes[0].error;
        }
        metrics_error_by_pool(pictures, COUNT, &by);
        CHECK(fabs(by.classes[0].error - sum / COUNT) < 1e-12 * sum &&
              fabs(by.light[1] - 1.0 / 3) < 1e-3);
        for (int k = 0; k < CLASSES; k++) {
            double expected = deviation[k] * deviation[k] / whole;
            held += by.classes[k].share.low <= expected && by.classes[k].share.high >= expected;
        }
        metrics_error_by_pool(pictures, 1, &by);
        CHECK(by.error == pictures[0].error && isnan(by.classes[0].share.low));
    }
    printf("  intervals held in %.1f %%\n", 100.0 * held / (TRIALS * CLASSES));
    CHECK(held >= 0.9 * TRIALS * CLASSES, "intervals held in %d of %d", held, TRIALS * CLASSES);
    picture_finish(&p);
}

TEST(nothing_to_split)
{
    struct picture p = picture_create();
    const double none[CLASSES] = {0};
    fill(&p, none, none);
    p.half_a[7][1] = NAN; // this pixel is omitted
    struct half_error_params halves = {.half_a = (const float(*)[3])p.half_a,
                                       .half_b = (const float(*)[3])p.half_b,
                                       .width = SIDE,
                                       .height = SIDE,
                                       .samples = 16};
    const struct error_by_params params = {&halves,
                                           (const double(*)[3])p.weights,
                                           (const float(*)[3])p.class_a,
                                           (const float(*)[3])p.class_b,
                                           CLASSES,
                                           CLASSES};
    struct error_by by;
    CHECK(metrics_half_error_weights(&halves, p.weights) && p.weights[7][0] == 0);
    metrics_error_by(&params, &by);
    CHECK(by.error == 0 && isnan(by.classes[0].share.value) && fabs(by.light[0] - 1.0 / 3) < 1e-6,
          "an error of %g, light of %g", by.error, by.light[0]);
    picture_finish(&p);
}

TEST_MAIN(TEST_CASE(independent_classes), TEST_CASE(classes_that_come_together),
          TEST_CASE(classes_that_take_turns), TEST_CASE(pictures_together),
          TEST_CASE(nothing_to_split))
