// Pictures of a scene with many seeds at several numbers of samples. They are stored in a file,
// because they do not fit into memory, and so that an interrupted run can continue.
#ifndef LAMPYRIS_TESTS_COVERAGE_PICTURES_H
#define LAMPYRIS_TESTS_COVERAGE_PICTURES_H

#include "base/arena.h"
#include "metrics/metrics.h"
#include "subjects.h"
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

enum { LEVELS_MAX = 16 };

struct plan {
    uint32_t side, seeds, first_seed;
    uint32_t samples[LEVELS_MAX]; // even numbers, ascending
    uint32_t levels;
    const char *folder; // folder for the files; NULL: they are not kept
};

struct pictures {
    const struct plan *plan;
    uint64_t pixels;
    struct unseen_light unseen; // owned by `arena`
    struct arena arena;
    FILE *file; // ordered by seeds, then by numbers of samples, then by halves
};

// Renders the pictures that the file lacks, and prints progress on stderr.
bool pictures_render(const struct subject *subject, const struct plan *plan, struct pictures *out,
                     struct err *err);
// Reads the two halves of a seed's picture, each with `pixels` pixels.
bool pictures_read(const struct pictures *pictures, uint32_t seed, uint32_t level,
                   float (*half_a)[3], float (*half_b)[3], struct err *err);
void pictures_finish(struct pictures *pictures);

#endif
