// The environment image as kernels read it, and its tables for sampling (lib/environment.glsl).
//
// Words of four, in this order:
//   a texel: its radiance and the density per solid angle with which it is sampled, row by row;
// and where the image is sampled
//   the table of rows;
//   for each row the table of its texels.
// A table of n bins holds n ascending thresholds of 32 bits, four a word, as a tree: first the
// word whose components are every 4^k-th threshold, last the words of all. Bin i is chosen by the
// numbers from its threshold to the next one: of 2^32 - 1 numbers in all, 2^32 - 1 itself stands
// for the end. Bins of weight 0 have none, all others at least one, and the last of those one more,
// since the sampler takes 2^32 - 1 for the number before. Densities are those of the numbers, so
// they are right whatever rounding made of the weights.
#ifndef LAMPYRIS_RENDER_ENVIRONMENT_TABLE_H
#define LAMPYRIS_RENDER_ENVIRONMENT_TABLE_H

#include "err.h"
#include "gpu.h"
#include "scene.h"
#include <stdbool.h>
#include <stdint.h>

// Words of four that the buffer has; no image counts as one white texel.
uint64_t environment_table_words(const struct environment *environment, bool is_sampled);

// Fills words[environment_table_words()]. False when out of memory.
bool environment_table_build(const struct environment *environment, bool is_sampled,
                             uint32_t (*words)[4]);
bool environment_table_upload(struct gpu *gpu, const struct environment *environment,
                              bool is_sampled, struct gpu_buffer *buffer, struct err *err);

#endif
