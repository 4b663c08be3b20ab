// Declarations that the files of src/job share.
#ifndef LAMPYRIS_JOB_JOB_INTERNAL_H
#define LAMPYRIS_JOB_JOB_INTERNAL_H

#include "job/job.h"

// The words of the note that a job stores in a checkpoint.
enum job_note {
    JOB_NOTE_ERROR,     // goal.error for which the next interim test was planned, as a double
    JOB_NOTE_NEXT_LOOK, // next_look of struct job
    JOB_NOTE_SAMPLES,   // planned samples per pixel; for a shard, those of the whole render
    JOB_NOTE_AOVS,      // AOV_* of the renderer's device
};
_Static_assert(JOB_NOTE_AOVS + 1 == CHECKPOINT_NOTE_WORDS, "a word for each");

// The last line of an identity: the samples or rows of a shard, or "none" for a whole render.
#define JOB_SHARD_LINE "--shard="
// A part's line that says what JOB_SHARD_LINE counts: "samples", or, for rows, JOB_BY_TILES with
// the number of samples.
#define JOB_SHARD_BY_LINE "--shard-by="
#define JOB_BY_TILES "tiles"
// Lines that merge reads: the size of the picture, and the samples per pixel in a round.
#define JOB_SIZE_LINE "--size="
#define JOB_ROUND_LINE "samples a round="
// Lines of the device and its driver. Samples of different devices, or of one with different
// drivers, have the names of all of them, each with its driver, after JOB_SEVERAL_DEVICES.
#define JOB_DEVICE_LINE "device="
#define JOB_DRIVER_LINE "driver="
#define JOB_SEVERAL_DEVICES "several devices: "
#define JOB_DEVICE_SEPARATOR "; "
// The line of the integrator.
#define JOB_INTEGRATOR_LINE "--integrator="

// --- identity.c ---
// Returns a copy of an identity without the lines that begin with one of `names`. Returns NULL when
// out of memory.
const char *job_identity_without(const char *identity, const char *const *names, uint32_t count,
                                 struct arena *arena);
// Returns whether the identity is that of a part, not of a whole render.
bool job_identity_is_part(const char *identity);

// --- job.c ---
// Returns whether the number of samples depends on a time limit or on the errors of tiles.
bool job_is_open_ended(const struct job *job);
// Returns the samples per pixel of a step of renderer_render(): one, or with `adaptive` a round's.
uint64_t job_step_samples(const struct job *job);
// Returns whether the film has only samples of the pilot, which are not part of the image.
bool job_is_pilot(const struct job *job);

// --- film.c ---
// Reads the film from a device that works.
bool job_read_now(struct job *job, struct err *err);
struct film_state job_film_state(const struct renderer *r);

// --- steps.c ---
// Renders until `steps` steps since the beginning are done. If the device fails and may be
// reopened, continues after the failure. The progress goes from `from` to `to`.
bool job_render_to(struct job *job, const struct job_step *step, uint64_t steps, double from,
                   double to, struct err *err);

// --- judge.c ---
// Estimates the error of the film that was read last, as film_error() does. confidence = 0: the
// default.
bool job_estimate_error(struct job *job, double confidence, struct half_error *out,
                        struct err *err);
// Makes the renderer compute the data that estimates need, while the device works.
bool job_prepare_estimates(struct job *job, struct err *err);

// Returns the listener for renderers, which reports to params.progress.
struct progress job_progress(struct job *job);

// --- pilot.c ---
// Returns the seed of a pilot for renders with this seed.
uint32_t job_pilot_seed(uint32_t seed);
// Renders samples that are not part of the image, and plans each tile's number of samples from
// their errors. Leaves the film empty, unless the job was stopped.
bool job_run_pilot(struct job *job, struct err *err);

// --- trace.c ---
bool job_open_trace(struct job *job, struct err *err); // allocates the rows and computes the hashes
// Returns the number of samples (or rounds, or frames) at which the next row is due: 1, 2, 4, ...;
// UINT64_MAX if the job keeps no trace.
uint64_t job_next_row(const struct job *job, uint64_t done);
// Reads the film, estimates its error and adds a row.
bool job_look_for_trace(struct job *job, struct err *err);

// --- resume.c ---
bool job_checkpoint_open(struct job *job, struct err *err);
bool job_checkpoint_restore(struct job *job, struct err *err);
bool job_checkpoint_when_due(struct job *job, struct err *err);
// Sets the note that the job stores in a checkpoint.
void job_checkpoint_note(const struct job *job, uint64_t out[CHECKPOINT_NOTE_WORDS]);
// Returns the number of seconds until the next checkpoint is due; 0: now; INFINITY: never.
double job_checkpoint_wait(const struct job *job);

// --- run.c ---
// Returns the number of samples at which the film is needed next: for an error estimate, for a row
// of the trace, or at the end.
uint64_t job_next_stop(struct job *job);

// --- crew.c ---
// Renders until the step is complete, unless the job is stopped, and adds the films of the crew.
bool job_advance_crew_once(struct job *job, const struct job_step *step, struct err *err);

// --- blocks.c ---
// Adds a block to job->held.
bool job_hold(struct job *job, const struct sample_range *block, struct err *err);
// Makes `range` the only one in job->held; it may be empty.
bool job_hold_only(struct job *job, const struct sample_range *range, struct err *err);
// The name of a file of saved blocks: that of the checkpoint, this, and its first sample.
#define BLOCKS_MARK ".blocks-"
// The first samples of files of saved blocks.
struct blocks_firsts {
    uint64_t *list;
    uint32_t count, capacity;
};
// Lists the files of blocks saved beside the checkpoint at `path`. If the folder cannot be read,
// the list is empty.
void blocks_list(const char *path, struct arena *arena, struct blocks_firsts *out);
// Returns the lines of an identity that do not depend on which samples a film has.
const char *blocks_identity(const char *identity, struct arena *arena);
// Fails with ERR_INPUT if ranks of a lost run have saved blocks beside the checkpoint at `path`.
bool job_check_no_blocks(const char *path, struct err *err);
// Removes saved blocks of this render that are in the checkpoint.
void job_remove_blocks(const struct job *job);

// --- blocks_add.c ---
// For a render that is resumed: reads the blocks that ranks of a lost run have saved.
bool job_open_blocks(struct job *job, struct err *err);
// Renders the samples between the saved blocks, and adds the blocks to the film.
bool job_fill_blocks(struct job *job, struct err *err);

// --- shard.c ---
// Determines the samples or rows of a shard; does nothing for other jobs. Fails with ERR_USAGE if
// the render cannot be divided into shards.
bool job_settle_shard(struct job *job, struct err *err);
bool job_is_shard(const struct job *job);
// Returns the number of steps of the whole render: samples per pixel, or rounds of the tiles' plan.
uint64_t job_steps(const struct job *job);
// Checks that the merged film, if there is one, belongs to this render. Needs the device.
bool job_check_merged(struct job *job, struct err *err);
// Sets the renderer to the shard's first sample, or copies the merged film to the renderer.
bool job_begin_shard(struct job *job, struct err *err);

// How several renderers share a render: parts with some samples, parts with some rows, or a crew.
enum job_division { JOB_BY_SAMPLES, JOB_BY_ROWS, JOB_BY_CREW };
// Checks that several renderers may share this render by `division`.
bool job_check_divisible(const struct job *job, enum job_division division, struct err *err);

// --- crew_film.c ---
// Adds the counts and times of one film to those of another.
void job_add_stats(const struct render_stats *part, struct render_stats *to);

// --- crew.c ---
bool job_check_crew(const struct job *job, struct err *err);
// Prepares to assign blocks of samples to the workers. The film must be complete.
bool job_begin_crew(struct job *job, struct err *err);
// Does the same as job_advance(), with all members of the crew.
bool job_advance_crew(struct job *job, const struct job_step *step, struct err *err);
// Called between waves of the job's own block, to assign further blocks to workers.
bool job_attend_crew(struct job *job, struct err *err);

// --- rescue.c ---
// Copies the film if all copies together take less than a hundredth of the rendering time.
bool job_rescue_copy_when_due(struct job *job, struct err *err);
// Must be called when rendering begins, when it resumes from a checkpoint, and when the film is
// emptied: a rescue restores this state until a copy is made.
bool job_rescue_begin(struct job *job, struct err *err);
// Reopens the device after a failure and restores the last copy of the film. Returns false with
// *err unchanged if the device was reopened too often already, or if there is no state to restore.
// If reopening fails, returns false and *err has the reason.
bool job_recover(struct job *job, struct err *err);

#endif
