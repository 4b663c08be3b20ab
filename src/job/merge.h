// Merges the parts of a render: checkpoints of shards (struct job_shard), and sums of some of them.
// The film's sums do not depend on the order and the grouping in which they are added, so the
// merged film is that of one process, bit for bit. Needs neither the scene nor a device.
//
//   struct merge merge;
//   merge_open(&params, &merge, &err) && merge_add_films(&merge, progress, &err) && ...
//   merge_finish(&merge);
#ifndef LAMPYRIS_JOB_MERGE_H
#define LAMPYRIS_JOB_MERGE_H

#include "job/job.h"

struct merge_params {
    const char *const *paths;
    uint32_t count;
    bool mixed;        // parts of several devices and drivers are taken, too
    bool only_look_at; // parts that were stopped amid a pass are taken, too: no film can be added
};

struct merge_part {
    const char *path, *command;
    struct sample_ranges samples; // samples that it has
    struct sample_ranges wanted;  // samples that it has when it is finished
    uint64_t planned;             // samples per pixel of the whole render
    uint32_t device;              // index into merge.devices
    uint64_t head_hash;           // a file with another one is another file
};

// The picture's mean luminance by one device, with its standard error; of no use without mixed.
struct merge_device {
    const char *name; // with the driver
    uint32_t part_count;
    double mean, standard_error;
};

struct merge {
    struct arena arena;
    struct merge_part *parts;
    uint32_t count;
    struct merge_device *devices;
    uint32_t device_count;
    const char *command;          // the command of the part with the largest render
    struct sample_ranges samples; // the samples of all parts together
    uint64_t planned;             // samples per pixel of the largest render
    uint64_t film_bytes;
    uint32_t aovs; // AOV_*: the device's
    struct job_merged merged;
};

// Reads what stands before the films, and decides whether the parts belong together. ERR_INPUT
// names the first part that does not, or that is no part, is unfinished amid a pass or damaged.
// *out is to be finished in any case.
bool merge_open(const struct merge_params *params, struct merge *out, struct err *err);
// Reads the films and adds them, with one film in memory, or two with several devices. A damaged
// file is logged as an error, and the others are looked at before it fails with ERR_INPUT.
bool merge_add_films(struct merge *merge, const struct progress *progress, struct err *err);
// Writes the sum as a part.
bool merge_write(const struct merge *merge, const char *path, struct err *err);
void merge_finish(struct merge *merge); // accepts NULL and {0}

#endif
