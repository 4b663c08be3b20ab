// The state of a run of `lampyris render`. The files that write, report and show the image share
// it. struct job renders the image.
#ifndef LAMPYRIS_CLI_RENDER_RENDER_RUN_H
#define LAMPYRIS_CLI_RENDER_RENDER_RUN_H

#include "base/file_lock.h"
#include "cli/options.h"
#include "cli/render/render_devices.h"
#include "cli/render/render_ranks.h"
#include "image/image.h"
#include "job/job.h"

// The connection to the viewer tev, which receives the image while it is rendered.
struct tev;
struct render_tev {
    struct tev *viewer;         // NULL: none
    uint64_t begin_ns, sent_ns; // start of rendering; time when the last image was read
    double seconds;             // time of reading and packing images
    uint64_t next_sample;       // samples per pixel after which the next image is sent
};

// The key of the metadata by which --resume recognises a finished picture of a sequence.
#define SEQUENCE_ATTRIBUTE "lampyris:sequence"

// The place of a picture in a sequence.
struct render_frame {
    uint32_t number, count;     // number: from 1; 0: there is no sequence
    double at_seconds, degrees; // NAN: not an animation, or not a turntable
    const char *identity;       // everything that determines the picture, as lines "name=value"
};

struct render_run {
    const struct options *options;
    struct arena arena; // names
    struct scene scene;
    struct gpu gpu;
    struct job job;
    struct render_ranks *ranks;    // NULL: this process renders alone
    struct render_devices devices; // all devices but the first, if there are several
    uint32_t camera;
    struct render_window window; // the part of the picture that --crop selects; {0} without --crop
    const char **outputs;
    struct file_lock *locks; // one for each output, then for the checkpoint and the trace
    uint32_t output_count, lock_count;

    uint64_t start_ns;
    struct progress progress;   // the options' progress with delayed stops: see render_stop.c
    uint64_t stop_ns;           // time at which a stop was first delayed until every pixel has a
                                // sample; 0: no stop was delayed
    bool stop_is_told;          // the delay was reported
    struct reference reference; // has no pixels without --reference
    struct render_tev tev;
    bool is_written;           // the final images were written, or writing them has failed
    float exposure;            // exposure, in stops, of the PNG images that were written last
    bool exposure_is_kept;     // a sequence has the exposure of its first picture
    struct render_frame frame; // place of the current picture in its sequence
};

// --- cmd_render.c ---
struct job_goal render_goal(const struct options *options);
// Loads the scene of the options. Fails with ERR_INPUT if nothing in it is visible.
bool render_load_scene(const struct options *options, struct scene *scene, uint32_t *camera,
                       struct err *err);

// Finds the window of --crop, or {0} without --crop. Fails with ERR_USAGE if the window is not
// inside the picture.
bool render_find_window(const struct options *options, const struct scene *scene,
                        struct render_window *out, struct err *err);

// --- render_ranks.c ---
// Opens a device of this machine for this rank, and reports it to rank 0.
bool render_ranks_open_device(const struct options *options, struct render_ranks *ranks,
                              struct job *job, struct err *err);
// Renders blocks for rank 0 until rank 0 orders the end. Returns the exit code.
int render_ranks_work(const struct options *options, struct render_ranks *ranks);
// Replaces this process by lampyris-mpi. Returns an exit code if that program cannot be run.
int render_ranks_become(const struct options *options);

// --- render_stop.c ---
// Returns the progress of the options, but delays a stop until every pixel has a sample, or until
// that takes too long.
const struct progress *render_progress(struct render_run *run);
// Warns if pixels of the film as read last have no sample.
void render_warn_of_unsampled(const struct render_run *run);
// Warns if the film is too dark for the error limit.
void render_warn_of_blind_error(const struct render_run *run);

// --- render_names.c ---
// Checks that no two outputs, including numbered images, are the same file.
bool render_check_distinct(const struct render_run *run, struct err *err);
// Checks that no output is an input. All inputs must be known.
bool render_check_inputs(struct render_run *run, struct err *err);

// --- render_ranks.c ---
// Returns whether each rank saves its samples after each of its blocks.
bool render_ranks_save_each(const struct options *options);

// --- render_output.c ---
// Chooses the names and checks before rendering whether the formats are known, the folders are
// writable, and no other run writes the same files. The outputs stay locked until
// render_release_outputs().
bool render_check_outputs(struct render_run *run, struct err *err);
// Names the outputs of a run without -o.
bool render_default_outputs(struct render_run *run, struct err *err);
// Returns the number of bytes, before compression, of the picture in a file with the name `path`.
uint64_t render_picture_bytes(const struct render_run *run, const char *path);
// Checks that the images fit into the free space. The width and height must be known.
bool render_check_space(const struct render_run *run, struct err *err);
// Writes all images. If frame > 0, their names have the number of the frame, as in "NAME.0012.exr".
// If an image cannot be written, the others still are. If then no EXR file was written, the image
// is saved in the system's folder for temporary files.
bool render_write_outputs(struct render_run *run, uint32_t frame, struct err *err);
void render_release_outputs(struct render_run *run);

// --- render_sequence.c ---
// Renders the pictures of --turntable or --at START:END:FPS; returns the exit code.
int render_sequence(const struct options *options);

// --- render_report.c ---
void render_print_summary(struct render_run *run);
bool render_print_json(const struct render_run *run, struct err *err);
// Returns why --integrator auto has chosen its integrator. Returns NULL if the setting is not auto.
const char *render_auto_reason(const struct render_run *run);
// Returns the command to which --pixel and --sample are added to follow a path. Returns NULL if
// paths cannot be followed, because they split or belong to a sequence of pictures.
const char *render_following_command(const struct render_run *run);
// Returns the command that follows the path of a dropped contribution, in the run's arena. Returns
// NULL if no contribution was dropped, or if paths cannot be followed.
const char *render_reproducing_command(struct render_run *run);

// --- render_trace.c ---
// Reads the reference and compares its size with the image's. Does nothing without --reference.
bool render_open_reference(struct render_run *run, struct err *err);
// Reads the trace that a resumed render continues. Does nothing without --trace. Call it after
// job_open().
bool render_read_trace(struct render_run *run, struct err *err);
// Writes the rows so far. Only warns if the file cannot be written.
bool render_update_trace(struct render_run *run, struct err *err);
// Adds the row of the finished image and writes all rows.
bool render_end_trace(struct render_run *run, struct err *err);

// --- render_tev.c ---
// Starts to connect if --tev is given. A viewer that does not answer is not an error.
bool render_tev_open(struct render_run *run, struct err *err);
// Sends the initial image before the first sample.
bool render_tev_begin(struct render_run *run, struct err *err);
// Sends the image if the samples per pixel have doubled or two seconds have passed since the last
// one. Sends nothing while the last image is still being sent, or if sending has taken too much of
// the render's time. Returns false if the film could not be read.
bool render_tev_when_due(struct render_run *run, struct err *err);
// Sends the image as it was read last, and closes the connection.
void render_tev_end(struct render_run *run);

// --- render_replay.c ---
// Follows and prints the path of --pixel and --sample, and renders nothing else.
bool render_replay(struct render_run *run, struct err *err);

#endif
