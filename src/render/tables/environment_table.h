// Makes the buffer of the environment image, with its tables for sampling (lib/environment.glsl).
//
// The buffer is an array of uvec4 words. If each texel is a patch of constant radiance
// (ENVIRONMENT_FILTER_NEAREST), the array begins with the texels, row by row: the radiance of each,
// and the density per solid angle with which it is sampled.
//
// If radiance is interpolated between the centres of texels (ENVIRONMENT_FILTER_BILINEAR), the
// array begins with nodes: the radiance of each, and the mean sampling density of the cell between
// the node, its right neighbour (the row's first node, for the last one) and the two nodes below.
// There is one row of nodes for the zenith, one for each row of texels, and one for the nadir. All
// nodes of a pole have the mean radiance of the texels around it. Within a cell the density is
// bilinear in longitude and in the cosine of the angle from the zenith, and proportional to the
// luminance at the corners above the table's floor. If the floor is 0, the density is 0 exactly
// where the radiance is 0.
//
// If the image is sampled, the table of the rows of texels or cells follows, and then for each row
// the table of its texels or cells.
//
// A table of n bins holds n ascending thresholds of 32 bits, four to a word, as a tree: it begins
// with the word whose components are every 4^k-th threshold, and ends with the words of all
// thresholds. A 32-bit random number selects bin i if it is at least the bin's threshold and less
// than the next one. The numbers 0 to 2^32 - 2 select bins. The number 2^32 - 1 marks the end; the
// sampler replaces it by 2^32 - 2, which therefore counts twice. Bins of weight 0 have no numbers,
// and all other bins have at least one. Densities are computed from these numbers, so they are
// exact whatever the rounding of the weights.
#ifndef LAMPYRIS_RENDER_TABLES_ENVIRONMENT_TABLE_H
#define LAMPYRIS_RENDER_TABLES_ENVIRONMENT_TABLE_H

#include "base/err.h"
#include "gpu/gpu.h"
#include "scene/core/scene.h"
#include <stdbool.h>
#include <stdint.h>

struct environment_table {
    const struct environment *environment; // an environment without an image counts as one white
                                           // texel
    uint32_t filter;                       // ENVIRONMENT_FILTER_*
    bool is_sampled;
    float floor; // only luminance above the floor is sampled; 0: all luminance
};

// Returns the length of the buffer in uvec4 words.
uint64_t environment_table_words(const struct environment_table *table);

// Fills words[environment_table_words()]. Returns false when out of memory.
bool environment_table_build(const struct environment_table *table, uint32_t (*words)[4]);
bool environment_table_upload(struct gpu *gpu, const struct environment_table *table,
                              struct gpu_buffer *buffer, struct err *err);

#endif
