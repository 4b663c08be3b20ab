// Merges the parts of a render: checkpoints of shards (struct job_shard), and sums of parts. A part
// has some samples of all pixels, or all samples of some rows; parts of both kinds cannot be
// merged. The sums of the film do not depend on the order and grouping of additions, so the merged
// film is that of one process, bit for bit. Needs neither the scene nor a device.
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
    bool mixed;        // accepts parts of several devices and drivers
    bool only_look_at; // as `partial`, without a warning; films cannot be added then
    bool partial;      // leaves out parts that were stopped within a pass, with a warning
};

struct merge_part {
    const char *path, *command;
    struct sample_ranges samples; // samples, or rows, that the part has
    struct sample_ranges wanted;  // samples, or rows, that the finished part will have
    uint64_t planned;             // samples per pixel of the whole render
    uint64_t film_at;             // offset of its film in the whole film, in bytes
    uint32_t device;              // index into merge.devices
    uint64_t head_hash;           // identifies the file: the hash of the data before its film
    bool is_left_out;             // the part's film is not added
};

// The picture's mean luminance as rendered by one device, with its standard error. It is computed
// only with `mixed`, and not comparable if parts are by tiles: devices then have different pixels.
struct merge_device {
    const char *name; // names of the device and its driver
    uint32_t part_count;
    double mean, standard_error;
    bool has_mean; // both halves of all pixels have samples
};

struct merge {
    struct arena arena;
    struct merge_part *parts;
    uint32_t count;
    struct merge_device *devices;
    uint32_t device_count;
    uint32_t name_count;          // number of different devices; sums of parts may have several
    const char *command;          // command of the part with the most planned samples
    bool by_tiles;                // each part has all samples of some rows
    struct sample_ranges samples; // the samples, or rows, of all parts together
    uint64_t planned;             // samples per pixel of the largest render
    uint64_t all;                 // number of samples, or rows, of the whole picture
    uint32_t width, height;
    uint32_t *counts; // samples of each of `tile_count` tiles in a round of an adaptive render;
                      // NULL: the render is not adaptive
    uint32_t tile_count;
    uint64_t rounds; // rounds of the whole render; without tiles, a round is a sample per pixel
    uint64_t film_bytes;
    bool has_whole_films; // parts by tiles have films of the whole picture: light paths reach all
                          // rows
    uint32_t aovs;        // AOV_* of the film
    const char *own_identity; // identity of the first part, with its device and driver
    struct job_merged merged;
};

// Reads the data before the films, and checks that the parts belong together. Fails with ERR_INPUT
// if a file does not belong to the others, is not a part, is unfinished within a pass, or is
// damaged; the message names the first such file. The caller must call merge_finish() in any case.
bool merge_open(const struct merge_params *params, struct merge *out, struct err *err);
// Returns the command that finishes a part with one range, for a shell. NULL: out of memory.
const char *merge_resuming_command(const struct merge *merge, const struct merge_part *part,
                                   struct arena *arena);
// Reads the films and adds them. One film is in memory at a time, two with several devices. Damaged
// files are logged as errors; after all files were read, it fails with ERR_INPUT.
bool merge_add_films(struct merge *merge, const struct progress *progress, struct err *err);
// Writes the sum of the parts as a part.
bool merge_write(const struct merge *merge, const char *path, struct err *err);
void merge_finish(struct merge *merge); // accepts NULL and {0}

#endif
