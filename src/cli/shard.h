// --shard of render: determines the samples that this process renders, and the file of its part.
#ifndef LAMPYRIS_CLI_SHARD_H
#define LAMPYRIS_CLI_SHARD_H

#include "base/err.h"
#include "job/job.h"

struct options;

// Parses I/N, FIRST:END, auto or auto/N. For auto, I and N are taken from the environment variables
// of Slurm, mpirun (Open MPI and MPICH) or Kubernetes. With auto/N, the text contains N. Fails with
// ERR_USAGE if the text is invalid, or if the variables do not determine I and N.
bool shard_parse(const char *text, struct job_shard *out, struct err *err);

// If --shard was given, sets options->render.shard and the name of the part. The name is the FILE
// of --checkpoint. Without --checkpoint, it is made from the scene's name. In FILE and in the names
// of outputs, %i and %n are replaced by I and N (or FIRST and END).
bool shard_settle(struct options *options, struct err *err);

// Returns the name of a shard's part without --checkpoint. Returns NULL when out of memory.
const char *shard_default_part(const struct options *options, const struct job_shard *shard,
                               struct arena *arena);

#endif
