#include "environment_table.h"

#include "environment.h"
#include "parallel.h"
#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

#define END UINT32_MAX // of the numbers that choose a bin

// --- one table -----------------------------------------------------------------------------------

static uint32_t level_count(uint32_t bins)
{
    uint32_t levels = 1;
    while ((uint64_t)bins > UINT64_C(1) << (2 * levels))
        levels++;
    return levels;
}

static uint32_t level_words(uint32_t bins, uint32_t level)
{
    return ((bins - 1) >> (2 * level + 2)) + 1;
}

static uint64_t table_words(uint32_t bins)
{
    uint64_t words = 0;
    for (uint32_t level = 0; level < level_count(bins); level++)
        words += level_words(bins, level);
    return words;
}

// Deals out the numbers below END: one to each bin with weight, the rest in proportion. Thresholds
// come from running sums, so that a bin's error is a rounding and not their sum. Replaces weights
// by probabilities; leaves all at 0 where all are 0.
static void deal(double *weights, uint32_t bins, uint32_t *thresholds)
{
    double total = 0.0, sum = 0.0;
    uint32_t lit = 0, before = 0, last = bins;
    for (uint32_t i = 0; i < bins; i++) {
        total += weights[i];
        lit += weights[i] > 0.0;
        last = weights[i] > 0.0 ? i : last;
    }
    uint32_t given = 0;
    for (uint32_t i = 0; i < bins; i++) {
        bool is_lit = weights[i] > 0.0;
        thresholds[i] = given;
        sum += weights[i];
        before += is_lit;
        if (is_lit)
            given = (uint32_t)fmin(floor(sum / total * (double)(END - lit)), END - lit) + before;
        if (i == last)
            given = END;
        weights[i] = (given - thresholds[i] + (i == last ? 1.0 : 0.0)) * 0x1p-32;
    }
}

// The levels of a table above its thresholds, coarsest first.
static void write_table(const uint32_t *thresholds, uint32_t bins, uint32_t (*words)[4])
{
    for (uint32_t level = level_count(bins); level-- > 0;) {
        uint32_t count = level_words(bins, level);
        for (uint64_t i = 0; i < (uint64_t)count * 4; i++) {
            uint64_t bin = i << (2 * level);
            words[i / 4][i % 4] = bin < bins ? thresholds[bin] : END;
        }
        words += count;
    }
}

// --- the image -----------------------------------------------------------------------------------

static double texel_luminance(const struct environment *environment, const float texel[3])
{
    const float *factor = environment->radiance;
    return 0.2126 * (double)texel[0] * (double)factor[0] +
           0.7152 * (double)texel[1] * (double)factor[1] +
           0.0722 * (double)texel[2] * (double)factor[2];
}

static const float white_texel[1][3] = {{1.0f, 1.0f, 1.0f}};

static struct environment with_image(const struct environment *environment)
{
    struct environment image = *environment;
    if (image.width == 0) {
        image.width = image.height = 1;
        image.texels = (float(*)[3])white_texel;
        image.radiance[0] = image.radiance[1] = image.radiance[2] = 1.0f;
    }
    return image;
}

uint64_t environment_table_words(const struct environment *environment, bool is_sampled)
{
    const struct environment image = with_image(environment);
    uint64_t texels = (uint64_t)image.width * image.height;
    if (!is_sampled)
        return texels;
    return texels + table_words(image.height) + image.height * table_words(image.width);
}

struct build {
    struct environment image;
    uint32_t (*words)[4];
    double *row_weights; // NULL: not sampled
    atomic_bool failed;
};

static void write_texel(uint32_t word[4], const float texel[3], float density)
{
    memcpy(word, texel, 3 * sizeof *texel);
    memcpy(&word[3], &density, sizeof density);
}

// Texels of some rows, with their probabilities within the row, and the rows' tables.
static void build_rows(void *context, size_t begin, size_t end, unsigned thread)
{
    (void)thread;
    struct build *b = context;
    uint32_t width = b->image.width, height = b->image.height;
    double *weights = calloc(width, sizeof *weights);
    uint32_t *thresholds = calloc(width, sizeof *thresholds);
    if (!weights || !thresholds)
        b->failed = true;
    uint64_t tables = (uint64_t)width * height + table_words(height);
    for (size_t row = begin; row < end && weights && thresholds; row++) {
        const float(*texels)[3] = (const float(*)[3])b->image.texels + row * width;
        double sum = 0.0;
        for (uint32_t i = 0; i < width; i++) {
            weights[i] = texel_luminance(&b->image, texels[i]);
            sum += weights[i];
        }
        if (b->row_weights) {
            b->row_weights[row] = sum * environment_texel_solid_angle(&b->image, (uint32_t)row);
            if (sum > 0.0)
                deal(weights, width, thresholds);
            write_table(thresholds, width, b->words + tables + row * table_words(width));
        }
        for (uint32_t i = 0; i < width; i++)
            write_texel(b->words[row * width + i], texels[i], (float)weights[i]);
    }
    free(weights);
    free(thresholds);
}

// What rows' probabilities make of the densities of their texels.
static void scale_rows(void *context, size_t begin, size_t end, unsigned thread)
{
    (void)thread;
    const struct build *b = context;
    uint32_t width = b->image.width;
    for (size_t row = begin; row < end; row++) {
        double factor = b->row_weights ? b->row_weights[row] : 0.0;
        factor /= environment_texel_solid_angle(&b->image, (uint32_t)row);
        for (uint32_t i = 0; i < width; i++) {
            uint32_t *word = &b->words[row * width + i][3];
            float part;
            memcpy(&part, word, sizeof part);
            part = (float)(part * factor);
            memcpy(word, &part, sizeof part);
        }
    }
}

bool environment_table_build(const struct environment *environment, bool is_sampled,
                             uint32_t (*words)[4])
{
    struct build build = {.image = with_image(environment), .words = words};
    uint32_t width = build.image.width, height = build.image.height;
    uint32_t *thresholds = calloc(height, sizeof *thresholds);
    if (is_sampled)
        build.row_weights = calloc(height, sizeof *build.row_weights);
    bool ok = thresholds && (!is_sampled || build.row_weights);
    if (ok)
        parallel_for(height, 16, 0, build_rows, &build);
    ok = ok && !build.failed;
    if (ok && is_sampled) {
        deal(build.row_weights, height, thresholds);
        write_table(thresholds, height, words + (uint64_t)width * height);
    }
    if (ok)
        parallel_for(height, 16, 0, scale_rows, &build);
    free(thresholds);
    free(build.row_weights);
    return ok;
}

bool environment_table_upload(struct gpu *gpu, const struct environment *environment,
                              bool is_sampled, struct gpu_buffer *buffer, struct err *err)
{
    uint64_t count = environment_table_words(environment, is_sampled);
    struct arena scratch = {0};
    uint32_t(*words)[4] = arena_alloc(&scratch, count, sizeof *words);
    bool ok = words && environment_table_build(environment, is_sampled, words);
    if (!ok)
        err_memory(err, "environment", count * sizeof *words);
    ok = ok && gpu_upload(gpu, buffer, 0, words, count * sizeof *words, err);
    arena_finish(&scratch);
    return ok;
}
