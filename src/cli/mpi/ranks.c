#include "cli/mpi/ranks.h"

#include "base/clock.h"
#include "base/log.h"
#include "base/memory.h"
#include "base/progress.h"
#include "base/signals.h"
#include <mpi.h>
#include <stdlib.h>
#include <string.h>

enum { TAG_ORDER = 1, TAG_DONE };
// Time between two checks for a message. The waiting functions of MPI keep a core busy, which CPU
// drivers need.
#define PAUSE_SECONDS 2e-4
// Time in which a message arrives whose sender has ended. Open MPI kills ranks a second after
// SIGTERM.
#define ABORT_SECONDS 0.2

struct ranks_context {
    struct render_ranks *ranks;
    const struct options *options;
    MPI_Comm comm, local;    // all ranks, and those of this machine
    struct rank_card *cards; // on rank 0: the cards of all ranks
    bool is_told;            // the message about a stop was printed, or is not needed
    uint64_t sigterm_ns;     // on a worker: when SIGTERM was first noticed; 0: not yet
};

// --- films ---------------------------------------------------------------------------------------

// The head of a message with a film. The records follow it.
struct film_head {
    uint64_t first, bytes; // the first sample of the film; size of its records
    uint32_t aovs;
    uint32_t has_samples;
    struct render_stats stats;
};
// Records of films begin at a multiple of this many bytes, and their sizes are multiples of it.
#define FILM_UNIT 16u
#define HEAD_BYTES ((sizeof(struct film_head) + FILM_UNIT - 1) / FILM_UNIT * FILM_UNIT)

static struct crew_film unpack(char *message)
{
    struct film_head head;
    memcpy(&head, message, sizeof head);
    return (struct crew_film){
        .copy = {.records = message + HEAD_BYTES, .emptied_at = head.first, .stats = head.stats},
        .has_samples = head.has_samples,
    };
}

static void pack_head(char *message, uint32_t aovs, uint64_t bytes, const struct crew_film *film)
{
    const struct film_head head = {
        .first = film->copy.emptied_at,
        .bytes = bytes,
        .aovs = aovs,
        .has_samples = film->has_samples,
        .stats = film->copy.stats,
    };
    memcpy(message, &head, sizeof head);
}

// The reduction operation for MPI: adds `count` messages. MPI may group them in any way.
static void add_messages(void *in, void *inout, int *count, MPI_Datatype *type)
{
    (void)type;
    for (int i = 0; i < *count; i++) {
        struct film_head head;
        memcpy(&head, in, sizeof head);
        struct crew_film part = unpack(in), sum = unpack(inout);
        crew_add(head.aovs, head.bytes, &part, &sum);
        pack_head(inout, head.aovs, head.bytes, &sum);
        in = (char *)in + HEAD_BYTES + head.bytes;
        inout = (char *)inout + HEAD_BYTES + head.bytes;
    }
}

// Sleeps until a request is complete, so that MPI_Wait() returns at once.
static void sleep_until_done(MPI_Request request)
{
    int is_done = 0;
    while (MPI_Request_get_status(request, &is_done, MPI_STATUS_IGNORE), !is_done)
        clock_sleep(PAUSE_SECONDS);
}

// Adds the films of all ranks to that of rank 0. A whole message is one element of the reduction,
// because MPI does not split elements.
static bool reduce(struct ranks_context *c, uint32_t aovs, uint64_t bytes,
                   const struct crew_film *film, struct crew_film *sum, struct err *err)
{
    char *message = memory_alloc(HEAD_BYTES + bytes);
    if (!message)
        return err_memory(err, "a message with a film", HEAD_BYTES + bytes);
    pack_head(message, aovs, bytes, film);
    if (film->has_samples)
        memcpy(message + HEAD_BYTES, film->copy.records, bytes);
    MPI_Datatype unit, whole;
    MPI_Op op;
    MPI_Request request;
    MPI_Type_contiguous(FILM_UNIT, MPI_BYTE, &unit);
    MPI_Type_contiguous((int)((HEAD_BYTES + bytes) / FILM_UNIT), unit, &whole);
    MPI_Type_commit(&whole);
    MPI_Op_create(add_messages, 1, &op);
    const bool is_root = c->ranks->rank == 0;
    MPI_Ireduce(is_root ? MPI_IN_PLACE : message, is_root ? message : NULL, 1, whole, op, 0,
                c->comm, &request);
    sleep_until_done(request);
    MPI_Wait(&request, MPI_STATUS_IGNORE);
    if (sum) {
        const struct crew_film all = unpack(message);
        memcpy(sum->copy.records, all.copy.records, bytes);
        sum->copy.stats = all.copy.stats;
        sum->copy.emptied_at = all.copy.emptied_at;
        sum->has_samples = all.has_samples;
    }
    MPI_Op_free(&op);
    MPI_Type_free(&whole);
    MPI_Type_free(&unit);
    memory_free(message);
    return true;
}

// --- rank 0 --------------------------------------------------------------------------------------

static void send_order(struct ranks_context *c, uint32_t worker, const struct rank_order *order)
{
    MPI_Send(order, sizeof *order, MPI_BYTE, (int)worker + 1, TAG_ORDER, c->comm);
}

static bool give(void *context, uint32_t worker, const struct sample_range *block, struct err *err)
{
    (void)err;
    send_order(context, worker, &(struct rank_order){RANK_RENDERS, *block});
    return true;
}

// If the render is to stop, prints how to continue it, in case a rank was lost. After SIGTERM, also
// saves the blocks of rank 0, because mpirun kills all ranks a second after it has lost one.
static void mention_stop(struct ranks_context *c)
{
    if (!progress_should_stop(c->options->progress))
        return;
    if (signals_received_sigterm())
        render_ranks_save(c->ranks);
    if (c->is_told)
        return;
    c->is_told = true;
    if (c->options->render.checkpoint)
        log_warn("stopping: waiting for the blocks of other ranks; if a rank was lost, this "
                 "command continues from the last checkpoint and the saved blocks, with or without "
                 "mpirun: %s%s",
                 c->options->command_line, c->options->render.resume ? "" : " --resume");
    else
        log_warn("stopping: waiting for the blocks of other ranks; if a rank was lost, all samples "
                 "are lost; expected --checkpoint FILE");
}

static bool poll_done(void *context, bool waits, struct crew_done *out, bool *is_there,
                      struct err *err)
{
    (void)err;
    struct ranks_context *c = context;
    int is_here = 0;
    mention_stop(c);
    while (MPI_Iprobe(MPI_ANY_SOURCE, TAG_DONE, c->comm, &is_here, MPI_STATUS_IGNORE),
           !is_here && waits) {
        mention_stop(c);
        clock_sleep(PAUSE_SECONDS);
    }
    *is_there = is_here;
    if (is_here)
        MPI_Recv(out, sizeof *out, MPI_BYTE, MPI_ANY_SOURCE, TAG_DONE, c->comm, MPI_STATUS_IGNORE);
    return true;
}

static bool gather(void *context, uint32_t aovs, uint64_t bytes, struct crew_film *to,
                   struct err *err)
{
    struct ranks_context *c = context;
    for (uint32_t i = 0; i < c->ranks->crew.count; i++)
        send_order(c, i, &(struct rank_order){.kind = RANK_GIVES_FILM});
    return reduce(c, aovs, bytes, to, to, err);
}

// --- workers -------------------------------------------------------------------------------------

// After a rank was lost, mpirun sends SIGTERM to all remaining ranks before it kills them. This
// rank then saves its blocks. If rank 0 was lost, rank 1 prints how to continue; otherwise rank 0
// does, unless it has failed and printed the reason. Then RANK_IS_ABORTED may arrive after SIGTERM.
static void mention_lost_leader(struct ranks_context *c)
{
    if (!signals_received_sigterm())
        return;
    render_ranks_save(c->ranks);
    if (c->sigterm_ns == 0)
        c->sigterm_ns = clock_ns();
    if (c->is_told || c->ranks->rank != 1 || clock_seconds_since(c->sigterm_ns) < ABORT_SECONDS)
        return;
    c->is_told = true;
    if (c->options->render.checkpoint)
        log_message(
            LOG_ERROR,
            "stopping: if rank 0 was lost, this command continues from the last checkpoint and the "
            "saved blocks, with or without mpirun: %s%s",
            c->options->command_line, c->options->render.resume ? "" : " --resume");
}

static void wait_for_order(struct ranks_context *c, struct rank_order *out)
{
    MPI_Request request;
    int is_done = 0;
    MPI_Irecv(out, sizeof *out, MPI_BYTE, 0, TAG_ORDER, c->comm, &request);
    while (MPI_Request_get_status(request, &is_done, MPI_STATUS_IGNORE), !is_done) {
        mention_lost_leader(c);
        clock_sleep(PAUSE_SECONDS);
    }
    MPI_Wait(&request, MPI_STATUS_IGNORE);
}

static bool next(void *context, struct rank_order *out, struct err *err)
{
    (void)err;
    struct ranks_context *c = context;
    // After RANK_IS_ABORTED, mpirun ends this rank.
    while (wait_for_order(c, out), out->kind == RANK_IS_ABORTED)
        c->is_told = true;
    return true;
}

static bool report(void *context, double seconds, struct err *err)
{
    (void)err;
    struct ranks_context *c = context;
    const struct crew_done done = {.worker = c->ranks->rank - 1, .seconds = seconds};
    MPI_Send(&done, sizeof done, MPI_BYTE, 0, TAG_DONE, c->comm);
    return true;
}

static bool hand_over(void *context, uint32_t aovs, uint64_t bytes, const struct crew_film *film,
                      struct err *err)
{
    return reduce(context, aovs, bytes, film, NULL, err);
}

// --- all ranks -----------------------------------------------------------------------------------

static bool count_sharers(struct ranks_context *c, const struct rank_card *own, uint32_t *sharers,
                          struct err *err)
{
    int count;
    MPI_Comm_size(c->local, &count);
    uint8_t *ids = calloc((size_t)count, sizeof own->memory_id);
    if (!ids)
        return err_memory(err, "ranks", (uint64_t)count * sizeof own->memory_id);
    MPI_Allgather(own->memory_id, sizeof own->memory_id, MPI_BYTE, ids, sizeof own->memory_id,
                  MPI_BYTE, c->local);
    *sharers = 0;
    for (int i = 0; i < count; i++)
        *sharers += memcmp(ids + (size_t)i * sizeof own->memory_id, own->memory_id,
                           sizeof own->memory_id) == 0;
    free(ids);
    return true;
}

static void wait_for_local(void *context)
{
    const struct ranks_context *c = context;
    MPI_Barrier(c->local);
}

static bool meet(void *context, const struct rank_card *own, uint32_t *integrator,
                 uint32_t *sharers, struct err *err)
{
    struct ranks_context *c = context;
    struct render_ranks *ranks = c->ranks;
    if (!count_sharers(c, own, sharers, err))
        return false;
    MPI_Gather(own, sizeof *own, MPI_BYTE, c->cards, sizeof *own, MPI_BYTE, 0, c->comm);
    for (uint32_t i = 0; ranks->rank == 0 && i < ranks->count; i++) {
        if (c->cards[i].hash != own->hash)
            return err_set(err, ERR_INPUT,
                           "rank %u has another command line, another scene or another build of "
                           "lampyris than rank 0; expected the same for all ranks, or --shard auto",
                           i);
        ranks->crew.members[i].device = c->cards[i].device;
        ranks->crew.members[i].driver = c->cards[i].driver;
    }
    MPI_Bcast(integrator, sizeof *integrator, MPI_BYTE, 0, c->comm);
    return true;
}

static bool join(struct ranks_context *c, struct err *err)
{
    struct render_ranks *ranks = c->ranks;
    int rank, count, local_rank;
    MPI_Comm_dup(MPI_COMM_WORLD, &c->comm);
    MPI_Comm_rank(c->comm, &rank);
    MPI_Comm_size(c->comm, &count);
    MPI_Comm_split_type(c->comm, MPI_COMM_TYPE_SHARED, rank, MPI_INFO_NULL, &c->local);
    MPI_Comm_rank(c->local, &local_rank);
    *ranks = (struct render_ranks){
        .rank = (uint32_t)rank,
        .count = (uint32_t)count,
        .local_rank = (uint32_t)local_rank,
        .crew = {.count = (uint32_t)count - 1,
                 .word = "rank",
                 .give = give,
                 .poll = poll_done,
                 .gather = gather,
                 .context = c},
        .meet = meet,
        .wait_for_local = wait_for_local,
        .next = next,
        .report = report,
        .hand_over = hand_over,
        .context = c,
    };
    c->cards = calloc((size_t)count, sizeof *c->cards);
    ranks->crew.members = calloc((size_t)count, sizeof *ranks->crew.members);
    if (!c->cards || !ranks->crew.members)
        return err_memory(err, "ranks", (uint64_t)count * sizeof *c->cards);
    return (uint32_t)count == render_ranks_expected() ||
           err_set(err, ERR_USAGE,
                   "%u processes were started, but MPI knows %d; expected the mpirun of the MPI "
                   "that lampyris-mpi was built with",
                   render_ranks_expected(), count);
}

bool ranks_open(struct render_ranks *out, const struct options *options, struct err *err)
{
    int level;
    MPI_Init_thread(NULL, NULL, MPI_THREAD_FUNNELED, &level);
    struct ranks_context *c = calloc(1, sizeof *c);
    if (!c)
        return err_memory(err, "ranks", sizeof *c);
    c->ranks = out;
    c->options = options;
    return join(c, err);
}

void ranks_close(struct render_ranks *ranks)
{
    struct ranks_context *c = ranks->context;
    for (uint32_t i = 0; ranks->rank == 0 && i < ranks->crew.count; i++)
        send_order(c, i, &(struct rank_order){.kind = RANK_ENDS});
    MPI_Comm_free(&c->local);
    MPI_Comm_free(&c->comm);
    MPI_Finalize();
    free(ranks->crew.members);
    free(c->cards);
    free(c);
    *ranks = (struct render_ranks){0};
}

// Workers may not wait for an order, so this does not wait for them.
static void tell_abort(struct ranks_context *c)
{
    const struct rank_order order = {.kind = RANK_IS_ABORTED};
    const uint64_t start = clock_ns();
    const int count = (int)c->ranks->crew.count;
    MPI_Request *requests = calloc((size_t)count, sizeof *requests);
    int are_sent = requests == NULL;
    for (int i = 0; requests && i < count; i++)
        MPI_Isend(&order, sizeof order, MPI_BYTE, i + 1, TAG_ORDER, c->comm, &requests[i]);
    while (!are_sent && clock_seconds_since(start) < ABORT_SECONDS)
        MPI_Testall(count, requests, &are_sent, MPI_STATUSES_IGNORE);
    free(requests);
}

void ranks_abort(const struct render_ranks *ranks, int code)
{
    if (ranks->context && ranks->rank == 0 && ranks->crew.count > 0)
        tell_abort(ranks->context);
    MPI_Abort(MPI_COMM_WORLD, code);
    abort(); // MPI_Abort does not return
}
