// --shard of render: which part of the samples this process renders, and the file of its part.
#ifndef LAMPYRIS_CLI_SHARD_H
#define LAMPYRIS_CLI_SHARD_H

#include "base/err.h"
#include "job/job.h"

struct options;

// Parses I/N, FIRST:END, auto or auto/N. Of auto, I and N come from the variables that Slurm, the
// mpirun of Open MPI and MPICH, and Kubernetes set; N from the text where it has one. ERR_USAGE,
// with what was expected, where the text is wrong or the variables do not say it.
bool shard_parse(const char *text, struct job_shard *out, struct err *err);

// Settles --shard, if it was given: finds the shard and names its part, FILE of --checkpoint with
// %i and %n replaced by I and N (or FIRST and END), or else a name made of the scene's. In the
// names of outputs %i and %n are replaced, too.
bool shard_settle(struct options *options, struct err *err);

#endif
