// Removes what killed shards have left in the folders of their parts.
#ifndef LAMPYRIS_CLI_MERGE_LEFTOVERS_H
#define LAMPYRIS_CLI_MERGE_LEFTOVERS_H

#include <stdint.h>

// Removes the hidden lock files of these parts, unless a run holds them, and hidden temporary files
// in their folders that no run has changed for an hour.
void leftovers_remove(const char *const *parts, uint32_t count);

#endif
