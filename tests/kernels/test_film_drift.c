// Measures the drift of the film's ways of adding samples from the samples' mean, and compares it
// with closed forms: the table of docs/sampling.md. The renderer's `accumulate` runs on radiance
// that the test makes.
#include "film_reference.h"
#include "kernel_fixture.h"

// A wave that every device supports.
enum { WAVE_SHIFT = 8, PIXELS = 64, SLOTS = PIXELS << WAVE_SHIFT, MIXES = 3, WAYS = 3 };

// The distribution of samples for each channel: uniform in mean +- half_width.
struct mix {
    const char *name;
    double mean, half_width;
};
static const struct mix mixes[MIXES] = {
    {"noise", 1.4, 1.4}, {"nearly constant", 1.4, 0.014}, {"constant", (double)1.4f, 0}};

// --- closed forms --------------------------------------------------------------------------------

// Computes the mean and the variance of the rounding error when a uniform sample is added to a
// multiple of `unit`.
static void rounded(const struct mix *s, double unit, double *mean, double *variance)
{
    enum { PARTS = 1 << 14 };
    double sum = 0, squares = 0;
    for (int i = 0; i < PARTS; i++) {
        double x = s->mean + s->half_width * ((2 * i + 1.0) / PARTS - 1);
        double error = unit * rint(x / unit) - x;
        sum += error;
        squares += error * error;
    }
    *mean = s->mean + sum / PARTS;
    *variance =
        fmax(squares / PARTS - sum / PARTS * (sum / PARTS), 0); // rounding may make it negative
    // If `unit` is smaller than the parts, the rounding error is uniform.
    if (s->half_width > 0 && s->half_width / PARTS * 16 > unit) {
        *mean = s->mean;
        *variance = unit * unit / 12;
    }
}

// Returns the drift of the plain sum of `count` samples. Between 2^j and 2^(j+1) the sum is a
// multiple of 2^(j-23), and grows by samples rounded to that: a piecewise linear function, plus the
// noise of the rounding errors.
static double drift_of_sum(const struct mix *s, double count)
{
    double sum = s->mean, added = 1, noise = 0;
    for (int j = ilogb(s->mean); added < count; j++) {
        double mean, variance;
        rounded(s, ldexp(1, j - 23), &mean, &variance);
        double steps = fmin(mean > 0 ? (ldexp(1, j + 1) - sum) / mean : INFINITY, count - added);
        sum += steps * mean;
        noise += steps * variance;
        added += steps;
    }
    return hypot(sum - count * s->mean, sqrt(noise)) / (count * s->mean);
}

// Returns the drift of the running mean m += (x - m) / k of `count` samples. Rounding errors e_k
// are uniform within half an ulp of m, and have the weight k / n in the end, so their variance is n
// unit^2 / 36. From k0 = 2 h / unit samples on, no step reaches half an ulp, and m no longer
// changes. With s = k / k0, from s = 1/3 on, m only changes by whole ulps, downwards or upwards,
// with a mean of -2 (m - mean) / k0 and a variance of unit^2 (1 - s). Its variance D about the mean
// satisfies D' = -4 D + unit^2 k0 (1 - s), whose solution from D(1/3) = unit^2 k0 (1/4 + 1/108)
// ends with D(1) = 0.0646 unit^2 k0. After that, the samples' mean changes but m does not.
static double drift_of_running_mean(const struct mix *s, double count)
{
    double unit = ldexp(1, ilogb(s->mean) - 23), spread = s->half_width * s->half_width / 3;
    double frozen = 2 * s->half_width / unit, known = fmin(1, frozen / count);
    double before = known * known * fmin(count, frozen) * unit * unit / 36;
    double after = (1 - known) * (1 - known) * 0.0646 * unit * unit * frozen +
                   spread * known * (1 - known) / fmax(frozen, 1);
    return sqrt(before + after) / s->mean;
}

// --- measured ------------------------------------------------------------------------------------

static float radiance[SLOTS][4];
static double exact[PIXELS][2][MIXES]; // exact sums
static struct gpu_film_pixel film[PIXELS];

static void fill_wave(struct random *random)
{
    for (uint32_t slot = 0; slot < SLOTS; slot++) {
        for (int c = 0; c < MIXES; c++) {
            double unit = 2 * random_unit(random) - 1;
            radiance[slot][c] = (float)(mixes[c].mean + mixes[c].half_width * unit);
            exact[slot >> WAVE_SHIFT][slot & 1][c] += (double)radiance[slot][c];
        }
    }
}

static bool accumulate_wave(struct renderer *r, uint32_t first_sample, struct err *err)
{
    r->push.pixel_count = r->push.part_items = PIXELS;
    r->push.sample_shift = WAVE_SHIFT;
    r->push.first_sample = first_sample;
    return gpu_upload(r->gpu, &r->buffers[BINDING_RADIANCE], 0, radiance, sizeof radiance, err) &&
           run_kernel(r, &r->kernels[KERNEL_accumulate], PIXELS, err);
}

// Returns the root mean square of the relative error over pixels and halves, each of `count`
// samples.
static double drift(uint32_t way, int c, double count)
{
    double squares = 0;
    for (int i = 0; i < PIXELS; i++) {
        const struct gpu_film_pixel *p = &film[i];
        for (int half = 0; half < 2; half++) {
            const uint32_t *words = half ? &p->sums_b[4 * c] : &p->sums_a[4 * c];
            float kept;
            memcpy(&kept, words, sizeof kept);
            double sum = way == ACCUMULATION_RUNNING ? (double)kept * count : (double)kept;
            if (way == ACCUMULATION_BINNED)
                sum = film_reference_value(words, half ? p->digits_b : p->digits_a, (uint32_t)c);
            squares += pow(sum / exact[i][half][c] - 1, 2);
        }
    }
    return sqrt(squares / (2 * PIXELS));
}

// Measured and expected drift agree within a factor of 1.5: from 128 halves it is known to 6 %, and
// the closed form of the running mean interpolates between its two ends.
static void check_drift(uint32_t way, int c, double count)
{
    double measured = drift(way, c, count);
    double noise = mixes[c].half_width / sqrt(3 * count) / mixes[c].mean;
    double expected = way == ACCUMULATION_SUM       ? drift_of_sum(&mixes[c], count)
                      : way == ACCUMULATION_RUNNING ? drift_of_running_mean(&mixes[c], count)
                                                    : 0;
    printf("  2^%-2d samples, %-15s %-11s %.2g, expected %.2g; the samples' noise %.2g\n",
           1 + ilogb(count), mixes[c].name, accumulation_names[way], measured, expected, noise);
    // No sample is above 2.8, so the unit of the lower digit is below 2^-33 of its half.
    if (way == ACCUMULATION_BINNED)
        CHECK(measured <= 0x1p-32, "%s, binned: %g", mixes[c].name, measured);
    else
        CHECK(measured <= 1.5 * expected && measured >= expected / 1.5,
              "%s, %s of %g: %.3g, expected %.3g", mixes[c].name, accumulation_names[way], count,
              measured, expected);
}

// Adds the same samples in all three ways, and measures at powers of four.
static void measure(int log_samples)
{
    static struct setup setups[WAYS];
    struct random random = {64};
    struct err err = {0};
    memset(exact, 0, sizeof exact);
    for (uint32_t way = 0; way < WAYS; way++) {
        scene_start(&setups[way].scene, PIXELS, 1);
        setups[way].scene.environment =
            (struct environment){.present = true, .radiance = {1, 1, 1}};
        setups[way].scene.settings.accumulation = way;
        OPEN_SETUP(&setups[way], SLOTS);
    }
    bool ok = true;
    for (uint32_t wave = 0; wave < 1u << (log_samples - WAVE_SHIFT) && ok; wave++) {
        uint32_t samples = (wave + 1) << WAVE_SHIFT;
        bool look = (samples & (samples - 1)) == 0 && ilogb(samples) % 2 == 0;
        fill_wave(&random);
        for (uint32_t way = 0; way < WAYS && ok; way++) {
            struct renderer *r = &setups[way].r;
            ok = accumulate_wave(r, wave << WAVE_SHIFT, &err);
            if (ok && look && (ok = gpu_download(r->gpu, &r->film[0], 0, film, sizeof film, &err)))
                for (int c = 0; c < MIXES; c++)
                    check_drift(way, c, samples / 2.0);
        }
    }
    CHECK(ok, "%s", err.msg);
    for (uint32_t way = 0; way < WAYS; way++)
        setup_close(&setups[way]);
}

TEST(drifts)
{
    measure(16);
}

// Prints the table of docs/sampling.md.
TEST(drifts_long)
{
    measure(24);
}

TEST_MAIN(TEST_CASE(drifts), TEST_CASE(drifts_long))
