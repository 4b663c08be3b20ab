// Processes started by mpirun that render one picture. Rank 0 has the job, and all others are its
// workers. cli/mpi sends their messages.
#ifndef LAMPYRIS_CLI_RENDER_RENDER_RANKS_H
#define LAMPYRIS_CLI_RENDER_RENDER_RANKS_H

#include "cli/options.h"
#include "job/crew.h"

// The data that each rank sends to rank 0 before rendering.
struct rank_card {
    char device[256], driver[512];
    uint64_t hash; // hash of the command line, the scene and the kernels; equal on all ranks
    uint8_t memory_id[16]; // see struct gpu_device_info
};

enum rank_order_kind {
    RANK_RENDERS,
    RANK_GIVES_FILM,
    RANK_ENDS,
    RANK_IS_ABORTED, // rank 0 has failed with a message of its own; next() does not return this
};
struct rank_order {
    enum rank_order_kind kind;
    struct sample_range block;
};

struct render_ranks {
    struct job *job;        // the job of this rank; set before rendering
    const char *checkpoint; // the rank saves its blocks beside this file; NULL: it saves none
    uint32_t rank, count;   // number of this rank, from 0; number of ranks
    uint32_t local_rank;    // number of this rank, from 0, among the ranks of this machine
    struct crew crew;       // used by rank 0 only
    // Called by all ranks. Sends the card to rank 0. On rank 0, sets crew.members, and fails with
    // ERR_INPUT if the hashes differ. Gives all ranks rank 0's value of *integrator. Sets *sharers
    // to the number of ranks of this machine that have the same device memory. When the function
    // returns, all ranks of this machine have called it.
    bool (*meet)(void *context, const struct rank_card *own, uint32_t *integrator,
                 uint32_t *sharers, struct err *err);
    // Returns when all ranks of this machine have called it.
    void (*wait_for_local)(void *context);
    // Called by workers. next() waits for an order, report() reports a finished block, and
    // hand_over() sends a film.
    bool (*next)(void *context, struct rank_order *out, struct err *err);
    bool (*report)(void *context, double seconds, struct err *err);
    bool (*hand_over)(void *context, uint32_t aovs, uint64_t bytes, const struct crew_film *film,
                      struct err *err);
    void *context;
};

// Returns the number of processes, including this one, that mpirun or srun started together.
// Returns 1 if this process was started alone.
uint32_t render_ranks_expected(void);
// Returns the index of this process among them, from 0.
uint32_t render_ranks_launched_as(void);

// Saves the blocks of this rank that were not saved yet. A failure is only logged, as an error.
void render_ranks_save(struct render_ranks *ranks);

// Renders as one of the ranks. Rank 0 prints the result. A rank that fails prints the reason.
// Returns the exit code. If the code is not EXIT_CODE_OK, other ranks may still wait for this one,
// and the caller must abort them.
int render_with_ranks(const struct options *options, struct render_ranks *ranks);

#endif
