// Declarations that the files of src/job share.
#ifndef LAMPYRIS_JOB_JOB_INTERNAL_H
#define LAMPYRIS_JOB_JOB_INTERNAL_H

#include "job/job.h"

// The words that a job stores in a checkpoint's note.
enum job_note {
    JOB_NOTE_ERROR,     // goal.error on the way to which the next look is planned, as a double
    JOB_NOTE_NEXT_LOOK, // see struct job
    JOB_NOTE_SAMPLES,   // per pixel that were planned; of a shard, of the whole render
    JOB_NOTE_AOVS,      // AOV_*: the device's
};
_Static_assert(JOB_NOTE_AOVS + 1 == CHECKPOINT_NOTE_WORDS, "a word for each");

// The last line of identities: the samples that a part is to have; "none" of a whole render.
#define JOB_SHARD_LINE "--shard="

// --- identity.c ---
// Copies an identity without the lines that begin with one of `names`. NULL when out of memory.
const char *job_identity_without(const char *identity, const char *const *names, uint32_t count,
                                 struct arena *arena);

// --- job.c ---
// Returns whether a clock, or each tile for itself, decides how many samples there are.
bool job_is_open_ended(const struct job *job);
// Returns the samples per pixel of a step of renderer_render(): one, or those of a round.
uint64_t job_step_samples(const struct job *job);
// Returns whether there are no samples but the pilot's, which are not part of the image.
bool job_is_pilot(const struct job *job);

// --- film.c ---
// Reads the film, where the device is well.
bool job_read_now(struct job *job, struct err *err);
struct film_state job_film_state(const struct renderer *r);

// --- steps.c ---
// Goes on to so many steps since the beginning, after failures of the device too where it may be
// opened again.
bool job_render_to(struct job *job, const struct job_step *step, uint64_t steps, double from,
                   double to, struct err *err);

// --- judge.c ---
// As film_error(), of the film as it was read last. confidence: 0 for the usual.
bool job_estimate_error(struct job *job, double confidence, struct half_error *out,
                        struct err *err);
// Makes the renderer prepare what estimates need, while the device works.
bool job_prepare_estimates(struct job *job, struct err *err);

// --- pilot.c ---
// Takes samples that are not part of the image, and makes the plan of the tiles from them. Leaves
// the film empty, unless the job was stopped.
bool job_run_pilot(struct job *job, struct err *err);

// --- trace.c ---
bool job_open_trace(struct job *job, struct err *err); // makes room, and names what it is of
// Returns at how many samples (or rounds, or frames) the next row is due: 1, 2, 4, ...; UINT64_MAX
// without a trace.
uint64_t job_next_row(const struct job *job, uint64_t done);
// Reads and judges the film, and adds a row.
bool job_look_for_trace(struct job *job, struct err *err);

// --- resume.c ---
bool job_checkpoint_open(struct job *job, struct err *err);
bool job_checkpoint_restore(struct job *job, struct err *err);
bool job_checkpoint_when_due(struct job *job, struct err *err);

// --- shard.c ---
// Finds the samples of the shard, if it is one; ERR_USAGE where it cannot be one.
bool job_settle_shard(struct job *job, struct err *err);
bool job_is_shard(const struct job *job);
// Checks that the merged film, if there is one, is of this render. Needs the device.
bool job_check_merged(struct job *job, struct err *err);
// Puts the renderer before the shard's first sample, or the merged film into it.
bool job_begin_shard(struct job *job, struct err *err);

// Checks that parts of the samples may be rendered by others; `whose` they are begins the message.
bool job_check_divisible(const struct job *job, const char *whose, struct err *err);

// --- crew_film.c ---
// Adds what was counted and measured of one film to that of another.
void job_add_stats(const struct render_stats *part, struct render_stats *to);

// --- crew.c ---
bool job_check_crew(const struct job *job, struct err *err);
// When the film is as it was left: prepares to give blocks.
bool job_begin_crew(struct job *job, struct err *err);
// As job_advance(), by all members.
bool job_advance_crew(struct job *job, const struct job_step *step, struct err *err);
// Between waves of the own block: keeps the workers busy.
bool job_attend_crew(struct job *job, struct err *err);

// --- rescue.c ---
// Copies the film when that costs less than a hundredth of the time of rendering.
bool job_rescue_copy_when_due(struct job *job, struct err *err);
// Called when rendering begins, resumes from a checkpoint, or empties the film: a rescue starts
// from here.
bool job_rescue_begin(struct job *job, struct err *err);
// After a failure of the device: reopens it, with the last copy of the film. Returns false, with
// *err unchanged, if it was reopened too often, or if there is nothing to resume; with another
// reason if reopening failed.
bool job_recover(struct job *job, struct err *err);

#endif
