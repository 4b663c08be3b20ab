// Several devices that render one picture: the job's own renderer, and workers, which are other
// devices of this process or other processes. The job gives blocks of samples to whoever has none,
// in ascending order, and adds the workers' films to its own where it needs the film. Sums have no
// order, so the film is that of one renderer, bit for bit, on devices of one kind with one driver.
#ifndef LAMPYRIS_JOB_CREW_H
#define LAMPYRIS_JOB_CREW_H

#include "job/samples.h"
#include "render/film_copy.h"

struct job;

// Blocks that a worker may have at a time: the next one is there when it has finished one.
#define CREW_BLOCKS 2u

struct crew_member {
    const char *device, *driver; // owned by who made the crew
    uint64_t samples;            // per pixel, of finished blocks
    double busy_seconds;         // rendering them
    uint32_t blocks;             // that it has now
};

// A block that a worker has finished.
struct crew_done {
    uint32_t worker; // from 0
    double seconds;
};

// What a worker hands over: a film, with the statistics of its samples.
struct crew_film {
    struct film_copy copy; // without records where there are no samples
    bool has_samples;
};

// Functions return false after a failure, which ends the job's rendering.
struct crew {
    uint32_t count;              // workers
    struct crew_member *members; // count + 1 of them: the job's own renderer first
    const char *word;            // what a member is: "device", "rank"
    // Gives a worker one more block; there are never more than CREW_BLOCKS. `samples` of the block
    // are counted by the job.
    bool (*give)(void *context, uint32_t worker, const struct sample_range *block, struct err *err);
    // Looks whether a worker has finished a block; `waits` until one has.
    bool (*poll)(void *context, bool waits, struct crew_done *out, bool *is_there, struct err *err);
    // No worker has a block. Adds the films of all to `to` by crew_add(), and empties them. bytes:
    // size of the records; aovs: the renderers' specialization.aovs.
    bool (*gather)(void *context, uint32_t aovs, uint64_t bytes, struct crew_film *to,
                   struct err *err);
    void *context;
};

// --- for workers, whose job has only its scene, settings and goal --------------------------------

// Renders a block into the job's film.
bool crew_render(struct job *job, const struct sample_range *block, double *seconds,
                 struct err *err);
// Copies the film, with `emptied_at` as its first sample, and the statistics since the last call;
// empties it. The records live in the arena.
bool crew_take(struct job *job, struct arena *arena, struct crew_film *out, struct err *err);

// --- for those who make a crew -------------------------------------------------------------------

// Adds a film and its statistics, in any order and grouping.
void crew_add(uint32_t aovs, uint64_t bytes, const struct crew_film *part, struct crew_film *to);
// Returns whether all members have the same device and driver.
bool crew_is_uniform(const struct crew *crew);

#endif
