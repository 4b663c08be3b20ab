// Merges the parts of a render: checkpoints of shards (struct job_shard), and sums of some of them.
// Parts have samples of all pixels, or all samples of some rows; the two are not merged.
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
    struct sample_ranges samples; // samples, or rows, that it has
    struct sample_ranges wanted;  // those that it has when it is finished
    uint64_t planned;             // samples per pixel of the whole render
    uint64_t film_at;             // byte of the whole film where that of its file begins
    uint32_t device;              // index into merge.devices
    uint64_t head_hash;           // a file with another one is another file
};

// The picture's mean luminance by one device, with its standard error; of no use without mixed, and
// of parts by tiles, in which devices have different pixels.
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
    bool by_tiles;                // parts have rows of the picture
    struct sample_ranges samples; // the samples, or rows, of all parts together
    uint64_t planned;             // samples per pixel of the largest render
    uint64_t all;                 // how many samples, or rows, there are
    uint32_t width, height;
    uint32_t *counts; // samples of each of `tile_count` tiles in a round; NULL: tiles have none
    uint32_t tile_count;
    uint64_t rounds; // of the whole render: samples per pixel where there are no tiles
    uint64_t film_bytes;
    bool has_whole_films; // also where a part by tiles has some rows: light paths go everywhere
    uint32_t aovs;        // AOV_*: the device's
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
