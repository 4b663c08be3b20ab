// Messages between the ranks of a render, by MPI.
#ifndef LAMPYRIS_CLI_MPI_RANKS_H
#define LAMPYRIS_CLI_MPI_RANKS_H

#include "cli/render/render_ranks.h"

// Joins the processes that mpirun started. ERR_USAGE if they are those of another MPI.
bool ranks_open(struct render_ranks *out, const struct options *options, struct err *err);
// Leaves them; rank 0 lets the workers end.
void ranks_close(struct render_ranks *ranks);
// Ends the processes of all ranks.
_Noreturn void ranks_abort(int code);

#endif
