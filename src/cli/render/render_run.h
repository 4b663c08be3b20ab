// One run of `lampyris render`: what its parts (writing, reporting, showing) share. How it is
// rendered is the job's affair.
#ifndef LAMPYRIS_CLI_RENDER_RENDER_RUN_H
#define LAMPYRIS_CLI_RENDER_RENDER_RUN_H

#include "base/file_lock.h"
#include "cli/options.h"
#include "image/image.h"
#include "job/job.h"

// A viewer that is sent the picture.
struct tev;
struct render_tev {
    struct tev *viewer;         // NULL: none
    uint64_t begin_ns, sent_ns; // when rendering began; when the last picture was read
    double seconds;             // that reading and packing took
    uint64_t next_sample;       // after which the next picture goes
};

struct render_run {
    const struct options *options;
    struct arena arena; // names
    struct scene scene;
    struct gpu gpu;
    struct job job;
    uint32_t camera;
    const char **outputs;
    struct file_lock *locks; // one an output, then the checkpoint's and the trace's
    uint32_t output_count, lock_count;

    uint64_t start_ns;
    struct progress progress;   // the options', but patient: see render_stop.c
    uint64_t stop_ns;           // when a signal was first seen that every pixel's sample puts off
    bool stop_is_told;          // that it is put off
    struct reference reference; // no pixels without one
    struct render_tev tev;
    bool is_written; // the pictures of the whole render were, or it was tried
    float exposure;  // stops of the PNG pictures written last
};

// --- render_stop.c ---
// The options' progress, whose wish to stop is granted only when every pixel has a sample or that
// takes too long.
const struct progress *render_progress(struct render_run *run);
// Says how many pixels of the film as it was read last have no sample, if any.
void render_warn_of_unsampled(const struct render_run *run);
// Says where the film is too dark for an error that was asked for.
void render_warn_of_blind_error(const struct render_run *run);

// --- render_names.c ---
// That no two outputs are one file, numbered pictures among them.
bool render_check_distinct(const struct render_run *run, struct err *err);
// When all that is read is known: that no output is one of those files, either.
bool render_check_inputs(struct render_run *run, struct err *err);

// --- render_output.c ---
// Settles the names and finds out what can be found out before rendering: whether the formats are
// known, the folders can be written to, and no other run is writing the same files. They stay
// locked until render_release_outputs.
bool render_check_outputs(struct render_run *run, struct err *err);
// When the size of the pictures is known: whether they fit where they are to go.
bool render_check_space(const struct render_run *run, struct err *err);
// Writes all pictures; frame > 0: numbered, "NAME.0012.exr". One that cannot be written does not
// keep the others from it; where no EXR file could be, the picture is saved in the system's folder
// for temporary files.
bool render_write_outputs(struct render_run *run, uint32_t frame, struct err *err);
void render_release_outputs(struct render_run *run);

// --- render_report.c ---
void render_print_summary(struct render_run *run);
bool render_print_json(const struct render_run *run, struct err *err);
// The command to which --pixel and --sample are to be added to follow a path; NULL where paths
// split, which cannot be followed.
const char *render_following_command(const struct render_run *run);
// The command that follows the path of a dropped contribution, or NULL; lives in the run's arena.
const char *render_reproducing_command(struct render_run *run);

// --- render_trace.c ---
// Reads the reference and compares its size with the picture's. Nothing without --reference.
bool render_open_reference(struct render_run *run, struct err *err);
// A render that goes on from a checkpoint also goes on with its trace. To be called after
// job_open(); does nothing without --trace.
bool render_read_trace(struct render_run *run, struct err *err);
// Writes the rows that there are so far. A file that cannot be written is a warning.
bool render_update_trace(struct render_run *run, struct err *err);
// Adds the row of the finished picture and writes them all.
bool render_end_trace(struct render_run *run, struct err *err);

// --- render_tev.c ---
// With --tev, begins to connect; only a malformed address is an error.
bool render_tev_open(struct render_run *run, struct err *err);
// Sends what there is before the first sample.
bool render_tev_begin(struct render_run *run, struct err *err);
// Sends the picture when the samples have doubled or some time went by, unless the last is under
// way still or it would cost too much. False: the film could not be read.
bool render_tev_when_due(struct render_run *run, struct err *err);
// Sends the picture as it was read last, and says goodbye.
void render_tev_end(struct render_run *run);

// --- render_replay.c ---
// --pixel X,Y --sample S: renders nothing, prints one path.
bool render_replay(struct render_run *run, struct err *err);

#endif
