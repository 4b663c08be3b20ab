// What commands take from the file that `bench --tune` keeps: sizes where the command line gives
// none, unless --tuning is off.
#ifndef LAMPYRIS_CLI_TUNED_H
#define LAMPYRIS_CLI_TUNED_H

#include "cli/options.h"
#include "cli/tune_cache.h"

// Once a run, after the options are parsed: reads the file where the command may use it.
void tuned_load(struct options *options, struct tune_cache *cache);

// What is taken for this device; 0 where the command line says something, or nothing is known.
struct tuned tuned_sizes(const struct options *options, const struct gpu *gpu);

// {wave, workgroup, file}, null for a size that is not taken; null where none is.
json_t *tuned_json(const struct options *options, const struct gpu *gpu);
// A line of a summary, where anything is taken.
void tuned_print(const struct options *options, const struct gpu *gpu);

#endif
