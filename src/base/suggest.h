// "Did you mean …?": the nearest of some names.
#ifndef LAMPYRIS_BASE_SUGGEST_H
#define LAMPYRIS_BASE_SUGGEST_H

#include <stddef.h>

// The least number of insertions, deletions, replacements and swaps of neighbours that make one
// word the other, no place edited twice (optimal string alignment; Damerau 1964). Words longer than
// 63 bytes count as infinitely far: SIZE_MAX.
size_t suggest_distance(const char *a, const char *b);

// Keeps track of the nearest name. Start with {.wanted = …}; `nearest` is NULL as long as nothing
// offered is near enough to be what was meant: one edit for every three letters, and at least one.
struct suggestion {
    const char *wanted;
    const char *nearest;
    size_t distance;
};

void suggest_offer(struct suggestion *suggestion, const char *name);

#endif
