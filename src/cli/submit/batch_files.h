// The two files that Slurm runs: one renders a shard, one merges them.
#ifndef LAMPYRIS_CLI_SUBMIT_BATCH_FILES_H
#define LAMPYRIS_CLI_SUBMIT_BATCH_FILES_H

#include "cli/options.h"

struct batch_files {
    const char *shards, *merge; // their paths, in the working directory
    const char *parts;          // a pattern of a shell that all parts match, and nothing else
    struct arena arena;
};

// Writes both. ERR_USAGE where --slurm has a line break; ERR_INPUT where a file of such a name was
// not written by this function; ERR_OUTPUT where they cannot be written. *out must be finished in
// any case.
bool batch_files_write(const struct options *options, struct batch_files *out, struct err *err);
void batch_files_finish(struct batch_files *files); // accepts NULL and {0}

#endif
