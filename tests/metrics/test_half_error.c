// Tests the estimate from half-buffers with synthetic noise: its mean over images against the
// expectation of the local relMSE, and the intervals against the error of each image.
#include "metrics/metrics.h"
#include "random.h"
#include "test.h"

// Returns the mean of `samples` draws from a distribution with mean 1.
typedef double (*noise_fn)(uint64_t *random, int samples);

static double exponential_noise(uint64_t *random, int samples)
{
    double product = 1;
    for (int i = 0; i < samples; i++)
        product *= random_uniform(random);
    return -log(product) / samples; // the variance is 1 per sample
}

static double spike_noise(uint64_t *random, int samples)
{
    int hits = 0;
    for (int i = 0; i < samples; i++)
        hits += random_uniform(random) <= 0.05;
    return hits / 0.05 / samples; // the variance is 1 / .05 - 1 = 19 per sample
}

struct picture {
    uint32_t width, height;
    float (*half_a)[3], (*half_b)[3];
    bool gray; // all channels share their noise, as those of light mostly do; otherwise each has
               // its own
};

static void picture_finish(struct picture *picture)
{
    free(picture->half_a);
    free(picture->half_b);
}

static struct picture picture_create(uint32_t width, uint32_t height)
{
    size_t count = (size_t)width * height;
    return (struct picture){.width = width,
                            .height = height,
                            .half_a = calloc(count, sizeof(float[3])),
                            .half_b = calloc(count, sizeof(float[3]))};
}

// Returns the true value of a pixel.
typedef double (*content_fn)(uint32_t x, uint32_t y, int channel);

static double flat_content(uint32_t x, uint32_t y, int channel)
{
    return x + y + (uint32_t)channel < UINT32_MAX ? 1 : 0;
}

static double smooth_content(uint32_t x, uint32_t y, int channel)
{
    return 0.05 * (channel + 1) + x * 0.01 + 0.3 * (1 + sin(y * 0.2));
}

// Squares of 8 pixels with values 1 and 4.
static double checked_content(uint32_t x, uint32_t y, int channel)
{
    return (x / 8 + y / 8 + (uint32_t)channel) % 2 ? 4 : 1;
}

static void fill(struct picture *picture, content_fn content, noise_fn noise, int samples,
                 uint64_t *random)
{
    for (uint32_t i = 0; i < picture->width * picture->height; i++) {
        double a = 0, b = 0;
        for (int c = 0; c < 3; c++) {
            double value = content(i % picture->width, i / picture->width, c);
            if (c == 0 || !picture->gray) {
                a = noise(random, samples / 2);
                b = noise(random, samples / 2);
            }
            picture->half_a[i][c] = (float)(value * a);
            picture->half_b[i][c] = (float)(value * b);
        }
    }
}

// The true values of an image, and their local means.
struct truth {
    float (*values)[3], (*means)[3];
    uint64_t pixels;
};

static struct truth truth_create(const struct picture *picture, content_fn content)
{
    uint64_t pixels = (uint64_t)picture->width * picture->height;
    struct truth truth = {calloc(pixels, sizeof(float[3])), calloc(pixels, sizeof(float[3])),
                          pixels};
    for (uint32_t i = 0; i < pixels; i++)
        for (int c = 0; c < 3; c++)
            truth.values[i][c] = (float)content(i % picture->width, i / picture->width, c);
    CHECK(metrics_local_means((const float(*)[3])truth.values, picture->width, picture->height,
                              NULL, truth.means));
    return truth;
}

static void truth_finish(struct truth *truth)
{
    free(truth->values);
    free(truth->means);
}

// Returns the expectation of the local relMSE for noise with this variance per sample.
static double expected_error(const struct truth *truth, double variance, int samples)
{
    double sum = 0;
    for (uint64_t i = 0; i < truth->pixels; i++)
        for (int c = 0; c < 3; c++) {
            double value = truth->values[i][c], mean = truth->means[i][c];
            sum += value * value * variance / samples / (mean * mean + METRICS_RELMSE_EPSILON);
        }
    return sum / (3.0 * (double)truth->pixels);
}

// Returns the local relMSE of this image.
static double own_error(const struct picture *picture, const struct truth *truth)
{
    double sum = 0;
    for (uint64_t i = 0; i < truth->pixels; i++)
        for (int c = 0; c < 3; c++) {
            double mean = truth->means[i][c];
            double off =
                ((double)picture->half_a[i][c] + picture->half_b[i][c]) / 2 - truth->values[i][c];
            sum += off * off / (mean * mean + METRICS_RELMSE_EPSILON);
        }
    return sum / (3.0 * (double)truth->pixels);
}

// Returns the relMSE of this image.
static double own_relmse(const struct picture *picture, const struct truth *truth)
{
    struct truth classic = {truth->values, truth->values, truth->pixels};
    return own_error(picture, &classic);
}

static struct half_error estimate_with(const struct picture *picture, uint64_t samples,
                                       double confidence)
{
    struct half_error_params params = {.half_a = (const float(*)[3])picture->half_a,
                                       .half_b = (const float(*)[3])picture->half_b,
                                       .width = picture->width,
                                       .height = picture->height,
                                       .samples = samples,
                                       .confidence = confidence};
    struct half_error error;
    CHECK(metrics_half_error(&params, &error));
    return error;
}

static struct half_error estimate(const struct picture *picture, uint64_t samples)
{
    return estimate_with(picture, samples, 0);
}

// Averages over so many images that the test's own noise is well below the tolerance.
static double mean_ratio(content_fn content, noise_fn noise, double variance, int samples)
{
    enum { PICTURES = 24, SIDE = 128 };
    struct picture picture = picture_create(SIDE, SIDE);
    uint64_t random = 1;
    double sum = 0;
    for (int i = 0; i < PICTURES; i++) {
        fill(&picture, content, noise, samples, &random);
        struct half_error error = estimate(&picture, (uint64_t)samples);
        CHECK(error.known, "%s", error.reason ? error.reason : "");
        sum += error.local_relmse;
    }
    struct truth truth = truth_create(&picture, content);
    double ratio = sum / PICTURES / expected_error(&truth, variance, samples);
    truth_finish(&truth);
    picture_finish(&picture);
    return ratio;
}

static void check_unbiased(const char *name, content_fn content, noise_fn noise, double variance,
                           int samples, double tolerance)
{
    double ratio = mean_ratio(content, noise, variance, samples);
    printf("     %s, %d spp: estimate / truth %.4f\n", name, samples, ratio);
    CHECK(fabs(ratio - 1) <= tolerance, "%s, %d spp: %g", name, samples, ratio);
}

TEST(the_error_is_unbiased)
{
    check_unbiased("flat, exponential", flat_content, exponential_noise, 1, 16, 0.02);
    check_unbiased("flat, exponential", flat_content, exponential_noise, 1, 64, 0.02);
    check_unbiased("flat, spikes", flat_content, spike_noise, 19, 16, 0.02);
    check_unbiased("flat, spikes", flat_content, spike_noise, 19, 64, 0.02);
    check_unbiased("smooth, exponential", smooth_content, exponential_noise, 1, 16, 0.02);
    check_unbiased("smooth, spikes", smooth_content, spike_noise, 19, 16, 0.05);
}

TEST(at_edges_it_is_within_its_known_bias)
{
    check_unbiased("checks, exponential", checked_content, exponential_noise, 1, 16, 0.1);
    check_unbiased("checks, exponential", checked_content, exponential_noise, 1, 64, 0.05);
}

enum { LAMP_SIDE = 80 };
static const double wall = 0.2, lamp = 17, lamp_part = 0.05;

// The first rows show a lamp on a wall; it covers a twentieth of the last one of them.
static double lamp_content(uint32_t x, uint32_t y, int channel)
{
    double at_edge = wall + lamp_part * (lamp - wall);
    bool beside = x < 10 || x > 69 || y % 16 < 5 || y % 16 > 10 || channel > 2;
    return beside ? wall : y % 16 == 5 ? at_edge : lamp;
}

static double lamp_noise(double value, uint64_t *random, int samples)
{
    if (value == wall || value == lamp)
        return value * (0.9 + 0.1 * exponential_noise(random, samples));
    int hits = 0;
    for (int i = 0; i < samples; i++)
        hits += random_uniform(random) <= lamp_part;
    return wall + (lamp - wall) * hits / samples;
}

// Like the edge of the lamp in the Cornell box, except that edges have nearly all of the error.
// With the pixels' own noisy values in the denominators, the estimate would be .4 of the error.
TEST(lamps_edges_are_not_the_lamp)
{
    enum { PICTURES = 40, SAMPLES = 64 };
    struct picture picture = picture_create(LAMP_SIDE, LAMP_SIDE);
    uint64_t random = 4;
    struct truth content = truth_create(&picture, lamp_content);
    double told = 0, truth = 0;
    int covers = 0;
    for (int i = 0; i < PICTURES; i++) {
        for (uint32_t p = 0; p < LAMP_SIDE * LAMP_SIDE; p++) {
            double value = lamp_content(p % LAMP_SIDE, p / LAMP_SIDE, 0);
            float a = (float)lamp_noise(value, &random, SAMPLES / 2);
            float b = (float)lamp_noise(value, &random, SAMPLES / 2);
            for (int c = 0; c < 3; c++) {
                picture.half_a[p][c] = a;
                picture.half_b[p][c] = b;
            }
        }
        struct half_error error = estimate(&picture, SAMPLES);
        double own = own_error(&picture, &content);
        CHECK(error.known, "%s", error.reason);
        covers += error.ci_low <= own && own <= error.ci_high;
        told += error.local_relmse;
        truth += own;
    }
    printf("     lamp: estimate / truth %.3f, coverage %d of %d\n", told / truth, covers, PICTURES);
    CHECK(fabs(told / truth - 1) < 0.1 && covers >= 34, "%g, %d", told / truth, covers);
    truth_finish(&content);
    picture_finish(&picture);
}

TEST(mse_matches_hand_value)
{
    enum { SIDE = 16 };
    struct picture picture = picture_create(SIDE, SIDE);
    for (int i = 0; i < SIDE * SIDE; i++)
        for (int c = 0; c < 3; c++) {
            picture.half_a[i][c] = i % 2 ? 3.5f : 4.5f; // the mean is 4, and A - B is -1 or 1
            picture.half_b[i][c] = i % 2 ? 4.5f : 3.5f;
        }
    struct half_error error = estimate(&picture, 16);
    CHECK(error.known && fabs(error.mse - 0.25) < 1e-12, "%.17g", error.mse);
    // All neighbours are 4, and the variance of their mean is small.
    CHECK(fabs(error.local_relmse / (0.25 / 16.01) - 1) < 0.01, "%g", error.local_relmse);
    CHECK(error.ci_low <= error.local_relmse && error.local_relmse <= error.ci_high);
    picture_finish(&picture);
}

// The interval must contain the error in 95 % of images, and so must the bounds. The test permits 3
// % less, which is 4.4 standard deviations of 1,000 draws. If the interval allows for unknown
// values of single pixels, it contains the error more often, but its mean width as a factor is at
// most `factor_most`.
static void check_coverage(const char *name, content_fn content, noise_fn noise, uint32_t width,
                           uint32_t height, int samples, double factor_most)
{
    enum { DRAWS = 1000 };
    struct picture picture = picture_create(width, height);
    struct truth truth = truth_create(&picture, content);
    picture.gray = true;
    uint64_t random = 7;
    int covered = 0, below = 0, bounded = 0, classic = 0;
    double log_factor = 0;
    for (int i = 0; i < DRAWS; i++) {
        fill(&picture, content, noise, samples, &random);
        struct half_error error = estimate(&picture, (uint64_t)samples);
        double own = own_error(&picture, &truth);
        CHECK(error.known && error.bounded, "%s", error.reason);
        covered += error.ci_low <= own && own <= error.ci_high;
        below += own < error.ci_low;
        bounded += own <= error.at_most;
        classic += own_relmse(&picture, &truth) <= error.relmse_at_most;
        log_factor += log(error.ci_high / error.ci_low) / 2 / DRAWS;
    }
    double coverage = (double)covered / DRAWS, bound = (double)bounded / DRAWS;
    printf("     %s, %u x %u, %d spp: interval %.3f (error below %.3f), factor %.3f, bound %.3f, "
           "of relMSE %.3f\n",
           name, width, height, samples, coverage, (double)below / DRAWS, exp(log_factor), bound,
           (double)classic / DRAWS);
    CHECK(coverage >= 0.92 && bound >= 0.92 && classic >= 0.92 * DRAWS, "%s: %g, %g, %d", name,
          coverage, bound, classic);
    CHECK(exp(log_factor) <= factor_most, "%s: %g", name, exp(log_factor));
    truth_finish(&truth);
    picture_finish(&picture);
}

TEST(interval_covers_the_truth)
{
    check_coverage("exponential", flat_content, exponential_noise, 64, 64, 16, 1.2);
    check_coverage("exponential", flat_content, exponential_noise, 50, 20, 16, 1.3);
    check_coverage("spikes", flat_content, spike_noise, 64, 64, 16, 2);
    check_coverage("smooth, spikes", smooth_content, spike_noise, 48, 48, 64, 2);
}

// The share of wider intervals that miss the truth is at most four standard deviations above the
// expected one.
TEST(confidence_is_what_is_asked_for)
{
    enum { DRAWS = 2000, SAMPLES = 16, SIDE = 40 };
    const double confidence = 0.99;
    struct picture picture = picture_create(SIDE, SIDE);
    struct truth truth = truth_create(&picture, flat_content);
    uint64_t random = 11;
    int missed = 0;
    for (int i = 0; i < DRAWS; i++) {
        fill(&picture, flat_content, exponential_noise, SAMPLES, &random);
        struct half_error error = estimate_with(&picture, SAMPLES, confidence);
        double own = own_error(&picture, &truth);
        CHECK(error.known);
        missed += own < error.ci_low || error.ci_high < own;
    }
    printf("     99 %%: missed %.4f\n", (double)missed / DRAWS);
    double expected = (1 - confidence) * DRAWS;
    CHECK(missed <= expected + 4 * sqrt(expected), "%d of %d", missed, DRAWS);
    truth_finish(&truth);
    struct half_error narrow = estimate_with(&picture, SAMPLES, 0.95);
    struct half_error usual = estimate(&picture, SAMPLES);
    struct half_error wide = estimate_with(&picture, SAMPLES, 0.998);
    CHECK(memcmp(&narrow, &usual, sizeof usual) == 0 && narrow.local_relmse == wide.local_relmse);
    CHECK(wide.ci_low < narrow.ci_low && narrow.ci_high < wide.ci_high);
    picture_finish(&picture);
}

// Squares of 16 pixels have 4 or 64 samples.
static int uneven_samples(uint32_t x, uint32_t y)
{
    return (x / 16 + y / 16) % 2 ? 64 : 4;
}

TEST(unequal_counts_change_no_expectation)
{
    enum { PICTURES = 32, SIDE = 128 };
    struct picture picture = picture_create(SIDE, SIDE);
    uint64_t random = 3;
    double sum = 0, truth = 0, by_tile[2] = {0};
    for (uint32_t i = 0; i < SIDE * SIDE; i++)
        truth += 1 / 1.01 / uneven_samples(i % SIDE, i / SIDE) / (SIDE * SIDE);
    for (int i = 0; i < PICTURES; i++) {
        double tiles[SIDE / 16 * SIDE / 16];
        for (uint32_t p = 0; p < SIDE * SIDE; p++)
            for (int c = 0; c < 3; c++) {
                int half = uneven_samples(p % SIDE, p / SIDE) / 2;
                picture.half_a[p][c] = (float)exponential_noise(&random, half);
                picture.half_b[p][c] = (float)exponential_noise(&random, half);
            }
        struct half_error error = estimate(&picture, 34);
        CHECK(error.known, "%s", error.reason);
        sum += error.local_relmse / PICTURES;
        const struct half_error_params params = {.half_a = (const float(*)[3])picture.half_a,
                                                 .half_b = (const float(*)[3])picture.half_b,
                                                 .width = SIDE,
                                                 .height = SIDE};
        CHECK(metrics_tile_errors(&params, 16, tiles));
        by_tile[0] += tiles[0] / PICTURES;
        by_tile[1] += tiles[1] / PICTURES;
    }
    printf("     estimate / truth %.4f, of tiles with 4 and 64 spp %.4f, %.4f\n", sum / truth,
           by_tile[0] * 4 * 1.01, by_tile[1] * 64 * 1.01);
    // Next to a noisy tile, the correction for the filter uses the mean noise of both: the error is
    // within 5 %.
    CHECK(fabs(sum / truth - 1) < 0.05, "%g", sum / truth);
    CHECK(fabs(by_tile[0] * 4 * 1.01 - 1) < 0.1 && fabs(by_tile[1] * 64 * 1.01 - 1) < 0.1);
    picture_finish(&picture);
}

TEST(unknown_where_it_cannot_be_known)
{
    struct picture picture = picture_create(64, 64);
    uint64_t random = 1;
    struct half_error error = estimate(&picture, 64);
    CHECK(!error.known && !error.bounded && strstr(error.reason, "black"), "%s", error.reason);
    fill(&picture, flat_content, exponential_noise, 16, &random);
    error = estimate(&picture, 1);
    CHECK(!error.known && !error.bounded && strstr(error.reason, "two samples"));
    CHECK(estimate(&picture, 2).known && !estimate(&picture, 2).reason);
    for (int i = 29; i < 64 * 64; i++)
        picture.half_b[i][1] = NAN;
    error = estimate(&picture, 16);
    CHECK(!error.known && !error.bounded && strstr(error.reason, "finite"), "%s", error.reason);
    for (int i = 0; i < 29; i++)
        picture.half_b[i][1] = NAN;
    error = estimate(&picture, 16);
    CHECK(!error.known && strstr(error.reason, "finite"), "%s", error.reason);
    picture_finish(&picture);
}

// A bright sample is in one half of a pixel. It is the error, whatever the pixel's own value may
// be.
TEST(one_bright_sample_has_a_bound)
{
    struct picture picture = picture_create(64, 64);
    uint64_t random = 1;
    fill(&picture, flat_content, exponential_noise, 16, &random);
    for (int c = 0; c < 3; c++)
        picture.half_a[2000][c] = 1e3f;
    struct half_error error = estimate(&picture, 16);
    double share = 500.0 * 500.0 / (1.01 * 64 * 64);
    CHECK(!error.known && error.bounded && strstr(error.reason, "few pixels"), "%s", error.reason);
    CHECK(error.at_most > share && error.at_most < 5 * share, "%g, %g", error.at_most, share);
    picture_finish(&picture);
}

// Light of 1,000 may still be found by chance. After a sample has found it, the halves give the
// error.
TEST(light_that_no_sample_has_found_counts)
{
    enum { SAMPLES = 16, SIDE = 64 };
    struct picture picture = picture_create(SIDE, SIDE);
    uint64_t random = 1;
    fill(&picture, flat_content, exponential_noise, SAMPLES, &random);
    struct half_error without = estimate(&picture, SAMPLES), with;
    struct half_error_params params = {.half_a = (const float(*)[3])picture.half_a,
                                       .half_b = (const float(*)[3])picture.half_b,
                                       .width = SIDE,
                                       .height = SIDE,
                                       .samples = SAMPLES,
                                       .unseen.by_chance = 1000};
    CHECK(without.known && metrics_half_error(&params, &with));
    CHECK(!with.known && with.bounded && strstr(with.reason, "chance"), "%s", with.reason);
    // 3 x 1000 / 16 over 4096 pixels, distributed in the worst way: see half_error.c; p is 1 / (2
    // pi 1.5^2).
    double p = 0.0708, worst = 3000.0 / SAMPLES / (SIDE * SIDE) / (2 * p * (1 - p + 1));
    double added = with.at_most - without.at_most;
    CHECK(fabs(added / worst - 1) < 0.05, "%g, %g", added, worst);
    for (int c = 0; c < 3; c++)
        picture.half_b[777][c] = 1000.0f / (SAMPLES / 2);
    without = estimate(&picture, SAMPLES);
    CHECK(metrics_half_error(&params, &with) && memcmp(&with, &without, sizeof with) == 0);
    picture_finish(&picture);
}

static struct half_error estimate_in_view(const struct picture *picture, uint64_t samples,
                                          const struct small_light *light)
{
    struct half_error error;
    const struct half_error_params params = {.half_a = (const float(*)[3])picture->half_a,
                                             .half_b = (const float(*)[3])picture->half_b,
                                             .width = picture->width,
                                             .height = picture->height,
                                             .samples = samples,
                                             .unseen = {.small = light, .small_count = 1}};
    CHECK(metrics_half_error(&params, &error), "out of memory");
    return error;
}

// An emitter with radiance 5,000 covers a hundredth of a pixel. As long as no sample has hit it, r
// = 50 is missing. Then four samples have hit it, two in each half, so that D^2 is 0.
TEST(an_emitter_in_view_counts_before_it_is_met)
{
    enum { SAMPLES = 256, SIDE = 64 };
    const double p = 0.0708, r = 50, pixels = SIDE * SIDE; // p is 1 / (2 pi 1.5^2)
    const struct small_light light = {30, 40, 0, 0.01f, {5000, 5000, 5000}};
    struct picture picture = picture_create(SIDE, SIDE);
    uint64_t random = 1;
    fill(&picture, flat_content, exponential_noise, SAMPLES, &random);
    struct half_error without = estimate(&picture, SAMPLES);
    struct half_error with = estimate_in_view(&picture, SAMPLES, &light);
    double local = p * r + (1 - p), missing = r * r / (local * local + 0.01) / pixels;
    CHECK(!with.known && with.bounded && strstr(with.reason, "in view"), "%s", with.reason);
    // The missing light counts as certain, except for the factor that applies to the whole bound.
    double added = with.at_most - without.at_most;
    CHECK(added > 0.95 * missing && added < 1.3 * missing, "%g, %g", added, missing);
    for (int c = 0; c < 3; c++)
        picture.half_a[40 * SIDE + 30][c] = picture.half_b[40 * SIDE + 30][c] =
            2 * 5000.0f / (SAMPLES / 2);
    without = estimate(&picture, SAMPLES);
    with = estimate_in_view(&picture, SAMPLES, &light);
    double error = 4 * 5000.0 / SAMPLES - r, square = error * error;
    double truth = square / (local * local + 0.01) / pixels;
    CHECK(without.at_most < truth && with.at_most > truth && with.at_most < 20 * truth,
          "%g and %g, true is %g", without.at_most, with.at_most, truth);
    // This many samples would have hit the emitter if nothing occluded it.
    const struct small_light hidden = {10, 10, 0, 0.5f, {1000, 1000, 1000}};
    with = estimate_in_view(&picture, SAMPLES, &hidden);
    CHECK(memcmp(&with, &without, sizeof with) == 0, "%g, %g", with.at_most, without.at_most);
    picture_finish(&picture);
}

TEST(small_and_odd_pictures)
{
    static const uint32_t sizes[][2] = {{1, 1}, {29, 1}, {1, 30}, {7, 5}, {1000, 1}, {33, 31}};
    for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; i++) {
        struct picture picture = picture_create(sizes[i][0], sizes[i][1]);
        uint64_t random = i;
        fill(&picture, flat_content, exponential_noise, 64, &random);
        struct half_error error = estimate(&picture, 64);
        uint32_t pixels = sizes[i][0] * sizes[i][1];
        CHECK(pixels >= 30 || (!error.known && strstr(error.reason, "the image has fewer")),
              "%u pixels: %s", pixels, error.reason ? error.reason : "known");
        CHECK(pixels < 1000 || (error.known && error.ci_low < error.ci_high), "%u pixels", pixels);
        picture_finish(&picture);
    }
}

TEST(no_variance_is_no_error)
{
    struct picture picture = picture_create(40, 40);
    for (int i = 0; i < 1600; i++)
        picture.half_a[i][0] = picture.half_b[i][0] = 0.7f;
    struct half_error error = estimate(&picture, 16);
    CHECK(error.known && error.local_relmse == 0 && error.ci_low == 0 && error.ci_high == 0);
    picture_finish(&picture);
}

TEST(nonfinite_pixels_are_left_out)
{
    struct picture picture = picture_create(64, 64);
    uint64_t random = 5;
    fill(&picture, flat_content, exponential_noise, 64, &random);
    double before = estimate(&picture, 64).local_relmse;
    picture.half_a[2000][1] = INFINITY;
    picture.half_b[77][2] = NAN;
    struct half_error error = estimate(&picture, 64);
    CHECK(error.known && fabs(error.local_relmse / before - 1) < 0.01, "%g",
          error.local_relmse / before);
    picture_finish(&picture);
}

TEST(extreme_values_stay_finite)
{
    struct picture picture = picture_create(64, 64);
    uint64_t random = 5;
    fill(&picture, flat_content, exponential_noise, 16, &random);
    for (int i = 0; i < 64 * 64; i++)
        for (int c = 0; c < 3; c++) {
            float scale = i % 64 < 32 ? 1e37f : 1e-37f;
            picture.half_a[i][c] *= scale;
            picture.half_b[i][c] *= scale;
        }
    struct half_error error = estimate(&picture, 16);
    CHECK(error.known && isfinite(error.local_relmse) && isfinite(error.mse) &&
          isfinite(error.ci_high));
    picture_finish(&picture);
}

TEST(estimate_is_deterministic)
{
    struct picture picture = picture_create(96, 64);
    uint64_t random = 9;
    fill(&picture, smooth_content, exponential_noise, 16, &random);
    struct half_error first = estimate(&picture, 16), again = estimate(&picture, 16);
    CHECK(memcmp(&first, &again, sizeof first) == 0);
    picture_finish(&picture);
}

TEST_MAIN(TEST_CASE(the_error_is_unbiased), TEST_CASE(at_edges_it_is_within_its_known_bias),
          TEST_CASE(lamps_edges_are_not_the_lamp), TEST_CASE(mse_matches_hand_value),
          TEST_CASE(interval_covers_the_truth), TEST_CASE(confidence_is_what_is_asked_for),
          TEST_CASE(unequal_counts_change_no_expectation),
          TEST_CASE(unknown_where_it_cannot_be_known), TEST_CASE(one_bright_sample_has_a_bound),
          TEST_CASE(light_that_no_sample_has_found_counts),
          TEST_CASE(an_emitter_in_view_counts_before_it_is_met), TEST_CASE(small_and_odd_pictures),
          TEST_CASE(no_variance_is_no_error), TEST_CASE(nonfinite_pixels_are_left_out),
          TEST_CASE(extreme_values_stay_finite), TEST_CASE(estimate_is_deterministic))
