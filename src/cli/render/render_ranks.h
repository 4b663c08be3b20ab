// Processes started by mpirun that render one picture. Rank 0 has the job, and all others are its
// workers. cli/mpi sends their messages.
#ifndef LAMPYRIS_CLI_RENDER_RENDER_RANKS_H
#define LAMPYRIS_CLI_RENDER_RENDER_RANKS_H

#include "cli/options.h"
#include "job/crew.h"

// The data that each rank sends to rank 0 before rendering.
struct rank_card {
    char device[256], driver[512];
    uint64_t hash; // of the command line, the scene and the kernels; must be the same for all ranks
    uint8_t memory_id[16]; // see struct gpu_device_info
};

enum rank_order_kind { RANK_RENDERS, RANK_GIVES_FILM, RANK_ENDS };
struct rank_order {
    enum rank_order_kind kind;
    struct sample_range block;
};

struct render_ranks {
    struct job *job;        // this rank's; set before rendering
    const char *checkpoint; // beside which it saves its blocks; NULL: nowhere
    uint32_t rank, count;
    uint32_t local_rank; // among the ranks of this machine
    struct crew crew;    // rank 0's
    // Called by all ranks: sends the card to rank 0. There it sets crew.members, and fails with
    // ERR_INPUT if the hashes differ. Afterwards all ranks have rank 0's value of *integrator.
    // *sharers is the number of ranks of this machine that have the same device memory. All of them
    // have called it when it returns.
    bool (*meet)(void *context, const struct rank_card *own, uint32_t *integrator,
                 uint32_t *sharers, struct err *err);
    // Returns when all ranks of this machine have called it.
    void (*wait_for_local)(void *context);
    // Called by workers: wait for an order, report a finished block, send a film.
    bool (*next)(void *context, struct rank_order *out, struct err *err);
    bool (*report)(void *context, double seconds, struct err *err);
    bool (*hand_over)(void *context, uint32_t aovs, uint64_t bytes, const struct crew_film *film,
                      struct err *err);
    void *context;
};

// Returns the number of processes that mpirun or srun started together with this one; 1 if it was
// started alone.
uint32_t render_ranks_expected(void);

// Saves the blocks of this rank, if it has some that were not saved yet. Does not fail: a failure
// is a warning.
void render_ranks_save(struct render_ranks *ranks);

// Renders as a rank. Rank 0 prints the result, and any rank its failure. Returns the exit code. If
// it is not EXIT_CODE_OK, other ranks may still wait for this one, and the caller must abort them.
int render_with_ranks(const struct options *options, struct render_ranks *ranks);

#endif
