// "Did you mean …?": finds the name that is most similar to a word.
#ifndef LAMPYRIS_BASE_SUGGEST_H
#define LAMPYRIS_BASE_SUGGEST_H

#include <stddef.h>

// Returns the least number of insertions, deletions, replacements and swaps of neighbours that turn
// one word into the other, with no place edited twice (optimal string alignment; Damerau 1964).
// Returns SIZE_MAX if a word is longer than 63 bytes.
size_t suggest_distance(const char *a, const char *b);

// Tracks the most similar name. Start with {.wanted = …}. `nearest` is NULL until a name is similar
// enough: it may differ from `wanted` by one edit for every three letters, and in any case by one.
struct suggestion {
    const char *wanted;
    const char *nearest;
    size_t distance;
};

void suggest_offer(struct suggestion *suggestion, const char *name);

#endif
