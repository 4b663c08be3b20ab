// Messages between the ranks of a render, by MPI.
#ifndef LAMPYRIS_CLI_MPI_RANKS_H
#define LAMPYRIS_CLI_MPI_RANKS_H

#include "cli/render/render_ranks.h"

// Connects to the other processes that mpirun started. Fails with ERR_USAGE if mpirun is that of
// another MPI.
bool ranks_open(struct render_ranks *out, const struct options *options, struct err *err);
// Disconnects. Rank 0 also tells the workers to end.
void ranks_close(struct render_ranks *ranks);
// Ends the processes of all ranks. Rank 0, which has printed why, first tells the others that it
// was not lost. Accepts what a failed ranks_open() has left.
_Noreturn void ranks_abort(const struct render_ranks *ranks, int code);

#endif
