#include "render/tables/environment_table.h"

#include "base/parallel.h"
#include "scene/core/environment.h"
#include "shared/methods.h"
#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

#define END UINT32_MAX // marks the end of the numbers that select bins

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

// Distributes the numbers below END among the bins: one to each bin of positive weight, the rest in
// proportion to the weights. Thresholds are computed from running sums, so that the error of a bin
// is one rounding, not the sum of all. Replaces the weights by the resulting probabilities; these
// are all 0 if all weights are 0.
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

// Writes a table as a tree of thresholds, with the coarsest level first.
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

static bool is_bilinear(const struct environment_table *table)
{
    return table->filter == ENVIRONMENT_FILTER_BILINEAR;
}

// Returns the number of rows of words: `height` for nearest filtering; `height` + 2 for bilinear
// filtering, which has a row of nodes at each pole. The rows that are sampled are those of texels,
// or the height + 1 rows of cells between rows of nodes (bin_rows()).
static uint64_t word_rows(const struct environment_table *table, uint32_t height)
{
    return (uint64_t)height + (is_bilinear(table) ? 2 : 0);
}

static uint32_t bin_rows(const struct environment_table *table, uint32_t height)
{
    return height + (is_bilinear(table) ? 1 : 0);
}

uint64_t environment_table_words(const struct environment_table *table)
{
    struct environment image = with_image(table->environment);
    uint64_t words = image.width * word_rows(table, image.height);
    uint32_t rows = bin_rows(table, image.height);
    return words + (table->is_sampled ? table_words(rows) + rows * table_words(image.width) : 0);
}

struct build {
    const struct environment_table *table;
    struct environment image;
    uint32_t rows;    // rows of bins
    float pole[2][3]; // the radiance at the zenith and at the nadir
    uint32_t (*words)[4];
    double *row_weights; // NULL: the image is not sampled
    atomic_bool failed;
};

// A pole is a single direction, so it has a single radiance: the mean of the texels around it,
// which are all equally far from it. The radiance is then continuous at the pole.
static void find_poles(struct build *b)
{
    for (int i = 0; i < 2; i++) {
        size_t first = i ? (size_t)b->image.width * (b->image.height - 1) : 0;
        double sum[3] = {0.0, 0.0, 0.0};
        for (size_t x = 0; x < b->image.width; x++)
            for (int c = 0; c < 3; c++)
                sum[c] += (double)b->image.texels[first + x][c];
        for (int c = 0; c < 3; c++)
            b->pole[i][c] = (float)(sum[c] / b->image.width);
    }
}

// Returns the radiance of an entry in a row of words.
static const float *word_texel(const struct build *b, size_t row, uint32_t column)
{
    if (!is_bilinear(b->table))
        return b->image.texels[row * b->image.width + column];
    if (row == 0 || row > b->image.height)
        return b->pole[row > 0];
    return b->image.texels[(row - 1) * b->image.width + column];
}

static void write_word(const struct build *b, size_t row, uint32_t column, float density)
{
    uint32_t *word = b->words[row * b->image.width + column];
    memcpy(word, word_texel(b, row, column), 3 * sizeof(float));
    memcpy(&word[3], &density, sizeof density);
}

// Returns the weight by which a texel is sampled.
static double texel_weight(const struct build *b, const float texel[3])
{
    return fmax(texel_luminance(&b->image, texel) - (double)b->table->floor, 0.0);
}

// Computes the mean weight of each bin of a row. In a cell the weight is bilinear, so its mean is
// the mean of the weights at the four corners.
static void weigh(const struct build *b, size_t row, double *weights)
{
    uint32_t width = b->image.width;
    for (uint32_t i = 0; i < width; i++)
        weights[i] = texel_weight(b, word_texel(b, row, i));
    if (!is_bilinear(b->table))
        return;
    for (uint32_t i = 0; i < width; i++)
        weights[i] += texel_weight(b, word_texel(b, row + 1, i));
    double first = weights[0];
    for (uint32_t i = 0; i < width; i++)
        weights[i] = 0.25 * (weights[i] + (i + 1 < width ? weights[i + 1] : first));
}

static double bin_solid_angle(const struct build *b, size_t row)
{
    return is_bilinear(b->table) ? environment_cell_solid_angle(&b->image, (uint32_t)row)
                                 : environment_texel_solid_angle(&b->image, (uint32_t)row);
}

// Builds the words of some rows, the probabilities of bins within each row, and the tables of the
// rows.
static void build_rows(void *context, size_t begin, size_t end, unsigned thread)
{
    (void)thread;
    struct build *b = context;
    uint32_t width = b->image.width;
    double *weights = calloc(width, sizeof *weights);
    uint32_t *thresholds = calloc(width, sizeof *thresholds);
    if (!weights || !thresholds)
        b->failed = true;
    uint64_t tables = width * word_rows(b->table, b->image.height) + table_words(b->rows);
    for (size_t row = begin; row < end && weights && thresholds; row++) {
        weigh(b, row, weights);
        double sum = 0.0;
        for (uint32_t i = 0; i < width; i++)
            sum += weights[i];
        if (b->row_weights) {
            b->row_weights[row] = sum * bin_solid_angle(b, row);
            if (sum > 0.0)
                deal(weights, width, thresholds);
            write_table(thresholds, width, b->words + tables + row * table_words(width));
        }
        for (uint32_t i = 0; i < width; i++)
            write_word(b, row, i, (float)weights[i]);
    }
    free(weights);
    free(thresholds);
}

// Multiplies the densities of bins by the probabilities of their rows.
static void scale_rows(void *context, size_t begin, size_t end, unsigned thread)
{
    (void)thread;
    const struct build *b = context;
    uint32_t width = b->image.width;
    for (size_t row = begin; row < end; row++) {
        double factor = b->row_weights ? b->row_weights[row] : 0.0;
        factor /= bin_solid_angle(b, row);
        for (uint32_t i = 0; i < width; i++) {
            uint32_t *word = &b->words[row * width + i][3];
            float part;
            memcpy(&part, word, sizeof part);
            part = (float)(part * factor);
            memcpy(word, &part, sizeof part);
        }
    }
}

bool environment_table_build(const struct environment_table *table, uint32_t (*words)[4])
{
    struct build build = {.table = table, .image = with_image(table->environment), .words = words};
    build.rows = bin_rows(table, build.image.height);
    uint32_t width = build.image.width;
    uint32_t *thresholds = calloc(build.rows, sizeof *thresholds);
    if (table->is_sampled)
        build.row_weights = calloc(build.rows, sizeof *build.row_weights);
    bool ok = thresholds && (!table->is_sampled || build.row_weights);
    if (ok && is_bilinear(table)) {
        find_poles(&build);
        for (uint32_t i = 0; i < width; i++) // nodes below the last row of cells
            write_word(&build, build.rows, i, 0.0f);
    }
    if (ok)
        parallel_for(build.rows, 16, 0, build_rows, &build);
    ok = ok && !build.failed;
    if (ok && table->is_sampled) {
        deal(build.row_weights, build.rows, thresholds);
        write_table(thresholds, build.rows, words + width * word_rows(table, build.image.height));
    }
    if (ok)
        parallel_for(build.rows, 16, 0, scale_rows, &build);
    free(thresholds);
    free(build.row_weights);
    return ok;
}

bool environment_table_upload(struct gpu *gpu, const struct environment_table *table,
                              struct gpu_buffer *buffer, struct err *err)
{
    uint64_t count = environment_table_words(table);
    struct arena scratch = {0};
    uint32_t(*words)[4] = arena_alloc(&scratch, count, sizeof *words);
    bool ok = words && environment_table_build(table, words);
    if (!ok)
        err_memory(err, "environment", count * sizeof *words);
    ok = ok && gpu_upload(gpu, buffer, 0, words, count * sizeof *words, err);
    arena_finish(&scratch);
    return ok;
}
