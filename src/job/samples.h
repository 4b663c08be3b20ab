// Numbers of samples that a part of a render has: each is of every pixel of the picture.
#ifndef LAMPYRIS_JOB_SAMPLES_H
#define LAMPYRIS_JOB_SAMPLES_H

#include "base/arena.h"
#include "base/err.h"
#include <stdbool.h>
#include <stdint.h>

// The samples from `first` up to, but without, `end`. Both are even, because sample s belongs to
// half-buffer s & 1 and is number s >> 1 of it: only so do a part's halves have the samples that
// the whole render gives them.
struct sample_range {
    uint64_t first, end;
};

// Ranges in ascending order, of which none is empty and no two touch.
struct sample_ranges {
    struct sample_range *list;
    uint32_t count;
};

// Returns the index-th, from 1, of `count` parts of `samples`, which differ by two samples at most,
// or by three where an odd last sample is the last part's. There must be a pair of samples for each
// part, or one part.
struct sample_range samples_of_part(uint32_t index, uint32_t count, uint64_t samples);

// Parses "FIRST:END"; returns the rest of the text, or NULL.
const char *samples_parse_range(const char *text, struct sample_range *out);
// Parses "FIRST:END,FIRST:END ..." of ascending ranges. False where the text is something else, or
// there is no memory.
bool samples_parse(const char *text, size_t length, struct arena *arena, struct sample_ranges *out);
// Formats what samples_parse() reads; "none" without ranges. NULL when out of memory.
const char *samples_text(const struct sample_ranges *ranges, struct arena *arena);

// Returns whether both have a sample in common; then the first such range is in *out.
bool samples_overlap(const struct sample_ranges *a, const struct sample_ranges *b,
                     struct sample_range *out);
// Makes a new list of the ranges of both, which have no sample in common.
bool samples_join(const struct sample_ranges *a, const struct sample_ranges *b, struct arena *arena,
                  struct sample_ranges *out, struct err *err);
// Makes the list of what is lacking to all samples below `end`.
bool samples_missing(const struct sample_ranges *ranges, uint64_t end, struct arena *arena,
                     struct sample_ranges *out, struct err *err);

#endif
