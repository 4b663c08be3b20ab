// Several devices that render one picture: the job's own renderer, and workers, which are other
// devices of this process or other processes. The job assigns blocks of samples in ascending order,
// and adds the workers' films to its own when it needs the film. The sums do not depend on the
// order of additions. So on devices of one kind with one driver, the film is that of one renderer,
// bit for bit.
#ifndef LAMPYRIS_JOB_CREW_H
#define LAMPYRIS_JOB_CREW_H

#include "job/samples.h"
#include "render/film_copy.h"

struct job;

// Maximum number of blocks of a worker. With two, it can begin the second one without waiting.
#define CREW_BLOCKS 2u

struct crew_member {
    const char *device, *driver; // owned by the caller that made the crew
    uint64_t samples;            // samples per pixel in finished blocks
    double busy_seconds;         // rendering time of these blocks
    uint32_t blocks;             // number of unfinished blocks
};

// A block that a worker has finished.
struct crew_done {
    uint32_t worker; // number of the worker, from 0
    double seconds;
};

// A worker's film, with the statistics of its samples.
struct crew_film {
    struct film_copy copy; // has no records if there are no samples
    bool has_samples;
};

// The functions return false with *err set on failure. The job's rendering then ends.
struct crew {
    uint32_t count;              // number of workers
    struct crew_member *members; // count + 1 members; the first is the job's own renderer
    const char *word;            // what a member is: "device", "rank"
    // Gives a worker one more block. It never has more than CREW_BLOCKS.
    bool (*give)(void *context, uint32_t worker, const struct sample_range *block, struct err *err);
    // Finds out whether a worker has finished a block; with `waits`, waits until one has.
    bool (*poll)(void *context, bool waits, struct crew_done *out, bool *is_there, struct err *err);
    // Adds the films of all workers to `to` by crew_add(), and empties them. No worker may have a
    // block. `bytes` is the size of the records, and `aovs` the renderers' specialization.aovs.
    bool (*gather)(void *context, uint32_t aovs, uint64_t bytes, struct crew_film *to,
                   struct err *err);
    void *context;
};

// --- for workers, whose job has only its scene, settings and goal --------------------------------

// Renders a block into the job's film.
bool crew_render(struct job *job, const struct sample_range *block, double *seconds,
                 struct err *err);
// Copies the film and the statistics since the last call, and empties the film. `emptied_at` of the
// copy is the film's first sample. The records are in the arena.
bool crew_take(struct job *job, struct arena *arena, struct crew_film *out, struct err *err);

// Saves the film, with the list of its samples, in a file beside the checkpoint at `path`: its name
// is that of the checkpoint with ".blocks-" and the number of the first sample. Does nothing if the
// film has no samples that were not saved yet, or if a block is not finished. The job that has the
// crew may call this function, too.
bool crew_save(struct job *job, const char *path, struct err *err);

// --- for the makers of a crew --------------------------------------------------------------------

// Adds the film and the statistics of `part` to those of `to`. The order of additions does not
// matter.
void crew_add(uint32_t aovs, uint64_t bytes, const struct crew_film *part, struct crew_film *to);
// Returns whether all members have the same device and driver.
bool crew_is_uniform(const struct crew *crew);

#endif
