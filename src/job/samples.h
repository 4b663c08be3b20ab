// Sets of sample indices, or of rows of the image. A sample index stands for one sample of every
// pixel of the image; a row stands for all samples of its pixels.
#ifndef LAMPYRIS_JOB_SAMPLES_H
#define LAMPYRIS_JOB_SAMPLES_H

#include "base/arena.h"
#include "base/err.h"
#include <stdbool.h>
#include <stdint.h>

// The samples or rows `first` to `end` - 1. For samples, both numbers are even, or `end` is the
// number of all samples: sample s is number s >> 1 of half-buffer s & 1, so the halves of a part
// contain the same samples as in the whole render. For rows, both are multiples of the side of a
// tile, or `end` is the height of the image, because tiles may have different numbers of samples.
struct sample_range {
    uint64_t first, end;
};

// Ranges in ascending order, none of which is empty and no two of which are adjacent or overlap.
struct sample_ranges {
    struct sample_range *list;
    uint32_t count;
};

// Returns part `index`, from 1, of `samples` divided into `count` parts. Parts differ by at most
// two samples, or by three if the number is odd, because the last part gets the odd sample. There
// must be at least one pair of samples per part, unless count is 1.
struct sample_range samples_of_part(uint32_t index, uint32_t count, uint64_t samples);

// Returns part `index`, from 1, of `rows` rows divided into `count` parts of whole tiles, which are
// `side` rows high. There must be at least one row of tiles per part.
struct sample_range rows_of_part(uint32_t index, uint32_t count, uint32_t rows, uint32_t side);

// Returns the number of samples, or rows, in all ranges.
uint64_t samples_count(const struct sample_ranges *ranges);

// Parses "FIRST:END". Returns the rest of the text, or NULL if the text does not begin like that.
const char *samples_parse_range(const char *text, struct sample_range *out);
// Parses ascending ranges, "FIRST:END,FIRST:END ...". Returns false if the text has another form,
// or when out of memory.
bool samples_parse(const char *text, size_t length, struct arena *arena, struct sample_ranges *out);
// Returns the ranges in the form that samples_parse() reads, or "none" if there are none. Returns
// NULL when out of memory.
const char *samples_text(const struct sample_ranges *ranges, struct arena *arena);

// Returns whether the two sets have a sample in common. If so, *out is the first range that they
// share.
bool samples_overlap(const struct sample_ranges *a, const struct sample_ranges *b,
                     struct sample_range *out);
// Makes the union of two sets that have no sample in common.
bool samples_join(const struct sample_ranges *a, const struct sample_ranges *b, struct arena *arena,
                  struct sample_ranges *out, struct err *err);
// Makes the set of all samples or rows below `end` that are not in `ranges`.
bool samples_missing(const struct sample_ranges *ranges, uint64_t end, struct arena *arena,
                     struct sample_ranges *out, struct err *err);

#endif
