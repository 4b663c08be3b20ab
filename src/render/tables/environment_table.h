// The environment image as kernels read it, and its tables for sampling (lib/environment.glsl).
//
// Words of four, in this order. Where texels are patches (ENVIRONMENT_FILTER_NEAREST):
//   a texel: its radiance and the density per solid angle with which it is sampled, row by row;
// where radiance is interpolated between the centres of texels (ENVIRONMENT_FILTER_BILINEAR):
//   a node: its radiance, and the mean density of the cell between it, the node to the right (the
//   first one after the last) and the two below; one row of nodes for the zenith, one for each row
//   of texels, one for the nadir. All nodes of a pole have the mean of the texels about it. Within
//   a cell the density is bilinear in longitude and in the cosine of the angle from the zenith, and
//   proportional to what the luminances at the corners exceed the table's floor by: where that is 0,
//   it is 0 where the radiance is, and nowhere else.
// And where the image is sampled
//   the table of rows of texels or cells;
//   for each row the table of its texels or cells.
// A table of n bins holds n ascending thresholds of 32 bits, four a word, as a tree: first the
// word whose components are every 4^k-th threshold, last the words of all. Bin i is chosen by the
// numbers from its threshold to the next one: of 2^32 - 1 numbers in all, 2^32 - 1 itself stands
// for the end. Bins of weight 0 have none, all others at least one, and the last of those one more,
// since the sampler takes 2^32 - 1 for the number before. Densities are those of the numbers, so
// they are right whatever rounding made of the weights.
#ifndef LAMPYRIS_RENDER_TABLES_ENVIRONMENT_TABLE_H
#define LAMPYRIS_RENDER_TABLES_ENVIRONMENT_TABLE_H

#include "base/err.h"
#include "gpu/gpu.h"
#include "scene/core/scene.h"
#include <stdbool.h>
#include <stdint.h>

struct environment_table {
    const struct environment *environment; // no image counts as one white texel
    uint32_t filter;                       // ENVIRONMENT_FILTER_*
    bool is_sampled;
    float floor; // sampled is what luminance exceeds this by; 0: all of it
};

// Words of four that the buffer has.
uint64_t environment_table_words(const struct environment_table *table);

// Fills words[environment_table_words()]. False when out of memory.
bool environment_table_build(const struct environment_table *table, uint32_t (*words)[4]);
bool environment_table_upload(struct gpu *gpu, const struct environment_table *table,
                              struct gpu_buffer *buffer, struct err *err);

#endif
