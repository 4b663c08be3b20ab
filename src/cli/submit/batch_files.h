// The two batch files for Slurm: one renders the shards, one merges them.
#ifndef LAMPYRIS_CLI_SUBMIT_BATCH_FILES_H
#define LAMPYRIS_CLI_SUBMIT_BATCH_FILES_H

#include "cli/options.h"

struct batch_files {
    const char *shards, *merge; // their paths, in the working directory
    const char *parts;          // a shell pattern that matches exactly the parts
    struct arena arena;
};

// Writes both files. `hash` is that of the render (job/expected.h). Fails with ERR_USAGE if --slurm
// has a line break, with ERR_INPUT if a file of the same name was not written by this function, and
// with ERR_OUTPUT if a file cannot be written. The caller must call batch_files_finish() in any
// case.
bool batch_files_write(const struct options *options, const char *hash, struct batch_files *out,
                       struct err *err);
void batch_files_finish(struct batch_files *files); // accepts NULL and {0}

#endif
