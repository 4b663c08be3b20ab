// Processes that mpirun started and that render one picture: rank 0 is the job, all others are its
// workers. What carries their messages is in cli/mpi.
#ifndef LAMPYRIS_CLI_RENDER_RENDER_RANKS_H
#define LAMPYRIS_CLI_RENDER_RENDER_RANKS_H

#include "cli/options.h"
#include "job/crew.h"

// What a rank tells the others before they render.
struct rank_card {
    char device[256], driver[512];
    uint64_t hash; // of the command line, the scene and the kernels: that of all ranks
};

enum rank_order_kind { RANK_RENDERS, RANK_GIVES_FILM, RANK_ENDS };
struct rank_order {
    enum rank_order_kind kind;
    struct sample_range block;
};

struct render_ranks {
    uint32_t rank, count;
    uint32_t local_rank; // among the ranks of this machine
    struct crew crew;    // rank 0's
    // All ranks: tells the others who this one is, and sets crew.members. ERR_INPUT unless all
    // hashes are the same.
    bool (*meet)(void *context, const struct rank_card *own, struct err *err);
    // Workers: wait for an order; tell that a block is finished; hand over a film.
    bool (*next)(void *context, struct rank_order *out, struct err *err);
    bool (*report)(void *context, double seconds, struct err *err);
    bool (*hand_over)(void *context, uint32_t aovs, uint64_t bytes, const struct crew_film *film,
                      struct err *err);
    void *context;
};

// Returns how many processes mpirun or srun started of which this is one; 1 where none did.
uint32_t render_ranks_expected(void);

// Renders as a rank. Prints the result on rank 0, and failures on any. Returns the exit code. If it
// is not EXIT_CODE_OK, other ranks may still wait for this one, and the caller must abort them.
int render_with_ranks(const struct options *options, struct render_ranks *ranks);

#endif
