// Pictures of one scene by many seeds at several sample counts, kept in a file: so many do not fit
// into memory, and a run that was interrupted goes on with those that are there.
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
    uint32_t samples[LEVELS_MAX]; // even numbers, rising
    uint32_t levels;
    const char *folder; // where files are kept; NULL: none is
};

struct pictures {
    const struct plan *plan;
    uint64_t pixels;
    struct unseen_light unseen; // in `arena`
    struct arena arena;
    FILE *file; // by seeds, then levels: all of the one half, all of the other
};

// Renders what is not in the file yet, and says on stderr how far it is.
bool pictures_render(const struct subject *subject, const struct plan *plan, struct pictures *out,
                     struct err *err);
// The halves of a seed's picture, pixels long each.
bool pictures_read(const struct pictures *pictures, uint32_t seed, uint32_t level,
                   float (*half_a)[3], float (*half_b)[3], struct err *err);
void pictures_finish(struct pictures *pictures);

#endif
