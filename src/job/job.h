// A render: scene, device, settings and a goal in; film, estimates and records out. All commands
// that render, and the viewer, drive it by these calls. How many samples there are and in which
// steps, what ends them and how good the film is, is decided here and nowhere else.
//
//   struct job job;
//   const struct job_params params = {
//       .renderer = {.gpu = &gpu}, .scene = &scene, .goal = {.error = 1e-3}};
//   job_start(&params, &job, &err) && job_run(&job, &err) && job_judge_end(&job, &err);
//   job_finish(&job);
//
// One thread at a time, unless a function says otherwise. The film's bits depend on what
// renderer.h says alone: not on steps, clocks, listeners or on how often the error is estimated.
#ifndef LAMPYRIS_JOB_JOB_H
#define LAMPYRIS_JOB_JOB_H

#include "job/crew.h"
#include "job/error_sources.h"
#include "job/film_error.h"
#include "job/reference.h"
#include "job/samples.h"
#include "metrics/forecast.h"
#include "render/adaptive.h"
#include "render/checkpoint.h"
#include "render/film_copy.h"

struct kernel_recording;
struct kernel_recording_params;
struct probe_hit;
struct probe_ray;
struct replay;

// --- what is asked for ---------------------------------------------------------------------------

// The render ends with whichever of these comes first.
struct job_goal {
    // Samples per pixel; with `adaptive` on average. 0: as many as `seconds` and `error` need, or,
    // without these, the number of the scene's settings.
    uint64_t samples;
    // Rendering time, including that before a checkpoint. 0: no limit. INFINITY: no limit either,
    // but the number of samples is open, so that no sampler can plan on it.
    double seconds;
    double error;  // upper bound of the local relMSE; 0: none
    bool adaptive; // each tile has a number of samples of its own: see adaptive.h
    // Number of frames, each with this many samples, instead of one image of `samples`; 0: one
    // image.
    uint32_t frames, samples_per_frame;
    bool accumulate; // each frame goes on from the one before; else the film is emptied between
};

struct job_checkpoint_params {
    const char *path; // NULL: none is kept
    double seconds;   // between two of them
    bool resume;      // go on from the one at `path`, if there is one; else there must be none
};

// A part of a render that several processes share: it has some of the samples of every pixel, and
// its checkpoint is a part that merge.h adds to others. Only a number of samples can be its goal.
struct job_shard {
    // The index-th, from 1, of `count` parts of the samples; count 0: `samples` instead.
    uint32_t index, count;
    struct sample_range samples; // end 0: there is no shard, the render has all samples
};

// The film of a render that was merged from its parts.
struct job_merged {
    struct film_copy film; // its records are released when the device has them
    struct arena arena;    // holds the records
    const char *identity;  // the parts' identity, without the samples that they have
    bool is_partial;       // samples are missing, and no --spp gives the same picture
};

// Called during job_run(), between waves; each may be NULL, and returning false ends the render as
// failed.
struct job_listener {
    // After every wave, when the film and the renderer's state are consistent.
    bool (*after_wave)(void *context, struct err *err);
    // When `frame` frames are finished.
    bool (*after_frame)(void *context, uint32_t frame, struct err *err);
    // When the trace has a new row.
    bool (*after_row)(void *context, struct err *err);
    void *context;
};

struct job_params {
    // The job sets `scene`, `tiles`, `open_ended` and `progress`.
    struct renderer_params renderer;
    struct scene *scene; // outlives the job; its settings.spp becomes the number that is planned
    struct job_goal goal;
    struct job_checkpoint_params checkpoint;
    struct job_shard shard;
    struct job_merged *merged; // the film is this one, and nothing is left to be rendered; or NULL
    struct crew
        *crew; // others that render, too, for --error, --time or a number of samples; or NULL
    const char *command;               // the command line, which checkpoints keep; NULL: none
    const struct reference *reference; // must have the image's size and outlive the job; NULL: none
    bool keeps_trace;                  // rows at doubling numbers of samples
    // How often a device that is lost during job_run() is reopened: only the job may use it then.
    // 0: never.
    uint32_t reopens;
    struct job_listener listener;
    const struct progress *progress; // NULL: nobody listens or asks to stop
};

// --- what comes out ------------------------------------------------------------------------------

struct job_seconds {
    double load, bvh, upload, compile, render;
    double bvh_uncached; // build time of hierarchies that were loaded from --bvh-cache; else 0
    double judge;        // reading the film and estimating its error, with trace and reference
    double write, total;
    double render_before; // the part of `render` that runs before this one took
};

enum job_end {
    ENDED_BY_SAMPLES,
    ENDED_BY_TIME,
    ENDED_BY_ERROR,
    ENDED_BY_SIGNAL,
    ENDED_BY_DEVICE, // this and the next: failures that the film was rescued from
    ENDED_BY_MEMORY
};

// An error estimate during the render.
struct job_look {
    double samples, seconds; // per pixel; rendering time
    double confidence;       // confidence of error.at_most; 0: the default
    struct half_error error;
};

// A row of a trace: the state at one time. Unknown numbers are not finite.
struct trace_row {
    double spp;             // samples per pixel of the film; the mean if pixels have different
                            // counts
    double frames;          // rendered so far; 0 without frames
    double seconds;         // rendering time of all runs
    double judging_seconds; // time of reading the film and estimating its error, in this run so far
    double msamples_per_s;  // since the beginning
    double closest_rays, shadow_rays;
    double local_relmse, ci_low, ci_high, at_most; // estimated from the half-buffers
    // Compared with a reference.
    double true_local_relmse, true_relmse, true_mse, true_smape, true_psnr;
    const char *reason; // why there is no interval; NULL where there is
};

#define TRACE_ROWS_MAX 4096u

struct trace {
    // 16 hexadecimal digits each: a hash of everything that determines the samples, and one of the
    // reference ("" without one). A file must not contain rows of other renders.
    const char *render, *reference;
    struct trace_row *rows; // in chronological order; room for TRACE_ROWS_MAX
    uint32_t count;
};

// The renderer's state when a film was read from it.
struct film_state {
    struct render_stats stats;
    uint64_t next_sample;
    struct pass pass;
    bool is_even; // as renderer_is_even
};

// The last copy of the film from the device, in case rendering fails. If the job's own film was
// read later, that is used.
struct job_rescue {
    struct arena arena;
    struct film_image film;   // no pixels before the first copy
    struct film_state copied; // after the rescue, of the job's film
    struct film_state read;   // state of the job's film when it was last read
    bool is_read;             // whether there is one
    double copied_at;         // seconds of rendering
    double worst_seconds;     // greatest time of a copy
    double seconds;           // and all of them
    bool is_too_large;        // for the memory budget, which was reported
    struct film_copy records; // from which rendering can be resumed; they live in the arena, too
    bool has_records;
    uint32_t reopened; // how often the device was reopened
};

// Samples that a crew renders until the film is wanted.
struct crew_deal {
    uint64_t next, end; // samples from `next` up to `end` are nobody's yet
    uint64_t start_ns;
    double seconds;                  // after which nothing more is dealt; 0: no limit
    double all;                      // samples of the step
    uint64_t done;                   // and those of its finished blocks
    uint64_t (*blocks)[CREW_BLOCKS]; // samples of the blocks that each worker has, oldest first
    uint32_t given;                  // blocks
    bool is_closed;                  // nothing more is dealt
    bool took_part;                  // a worker has finished a block
    bool is_in_block;                // of its own: a stop waits until it is finished
};

// May be read by all; only the functions below change it.
struct job {
    struct job_params params;
    struct scene *scene;
    struct gpu *gpu;
    struct renderer renderer;
    struct progress progress; // the renderer's: the params' with what part of the clock is over
    struct arena arena;

    // A clock, or each tile for itself, decides how many samples there are; as it was asked for at
    // the beginning, when the samples were planned.
    bool is_open_ended;
    bool is_rendering; // since the first sample of job_run()
    bool stopped;      // before the goal was reached; some pixels may have fewer samples
    enum job_end ended_by;
    double begun_seconds;   // rendering time at job_begin()
    uint64_t samples_most;  // limit of samples per pixel, on average; of a shard, its end
    uint64_t samples_first; // the first one, but 0 of a shard alone
    uint32_t round_samples; // with `adaptive`: samples of a round of the plan, on average
    struct tile_plan plan;  // the tiles' plan; empty until the pilot has ended

    // With a crew, or as a worker of one.
    struct crew_deal deal;
    bool has_samples;    // the renderer's film has some
    uint64_t first_held; // the first of them

    // Records.
    struct job_seconds seconds;
    double *frames_ms; // rendering time of each frame
    uint32_t frame_count, frame_capacity;
    struct job_look *looks; // for goal.error
    uint32_t look_count, look_capacity;
    struct trace trace;

    // The film as last read, and its estimates.
    struct arena film_arena;
    struct film_image film;
    struct half_error error;
    struct error_sources sources;    // sources of the error, if requested
    struct reference_errors against; // NAN without a reference
    struct forecast_bias bias;       // the part of that local relMSE that is bias
    uint64_t image_hash;             // hash of the mean's bits

    // For resuming elsewhere, or after a failure.
    const char *identity;      // identity of the render in checkpoints
    struct checkpoint resumed; // closed once it is restored
    uint64_t checkpoint_ns;    // when the last one was written, or rendering began
    bool has_checkpoint;       // a file from which this render can go on
    uint64_t next_look;        // samples per pixel at the next interim test
    double looks_error;        // ... on the way to this goal.error
    struct job_rescue rescue;
};

// --- life ----------------------------------------------------------------------------------------

// Checks the goal. ERR_USAGE if a method, a shard and a goal exclude each other. Needs no device
// yet, but params->renderer.gpu must be the address at which it will be opened.
bool job_init(const struct job_params *params, struct job *out, struct err *err);
// With an open device: computes the job's identity if a checkpoint or a trace needs it, and reads
// the checkpoint to resume, if any. ERR_INPUT if that belongs to another render.
bool job_open(struct job *job, struct err *err);
// Creates the renderer, and puts it into the state that was read.
bool job_create(struct job *job, struct err *err);
// Calls all three functions; on failure the job is finished.
bool job_start(const struct job_params *params, struct job *out, struct err *err);
void job_finish(struct job *job); // accepts NULL and {0}

// --- rendering -----------------------------------------------------------------------------------

// Renders until the goal is reached or the listener stops it (`stopped`).
bool job_run(struct job *job, struct err *err);

// Sets another number of samples, time or error as the goal of the next job_run(), which goes on
// from the film as it is, also after a stop. Samples stay planned as they were at the beginning.
// ERR_USAGE if the goal excludes a method, or if frames, tiles or a shard do not permit another
// one.
bool job_set_goal(struct job *job, const struct job_goal *goal, struct err *err);

// For callers that decide themselves when to test: replicates, repetitions, a viewer's frames.
// Empties the film and begins with the first sample of another seed, with `planned` samples per
// pixel.
bool job_begin(struct job *job, uint32_t seed, uint64_t planned, struct err *err);
// Returns the seed of a reference for renders with `seed` and the seeds above it: they share no
// samples.
uint32_t job_reference_seed(uint32_t seed);
// The time of samples, measured with samples that are not part of an image.
struct job_speed {
    uint64_t samples; // per pixel
    double seconds;   // rendering time; 0: not known
};
// Compiles, as drivers do at the first dispatch; then measures for this time, unless 0. job_begin()
// resets the film.
bool job_warm_up(struct job *job, double seconds, struct job_speed *out, struct err *err);
struct job_step {
    uint64_t samples; // per pixel since the beginning (with `adaptive`: rounds); UINT64_MAX: no
                      // limit
    double seconds;   // rendering time since the beginning; 0: no limit
    double from, to;  // the part of the progress that this step is
    const struct wave_observer *observer; // see render_call
};
// Renders at least one wave, until every pixel has this many samples, the time is over, or the
// listener stops it.
bool job_advance(struct job *job, const struct job_step *step, struct err *err);
// Polls for a stop, which job_advance() does between waves only.
bool job_is_stopped(struct job *job);
// Continues after a stop that was not the end.
void job_go_on(struct job *job);

double job_elapsed(const struct job *job); // seconds of rendering since the beginning

// --- what may change on the way ------------------------------------------------------------------

// See renderer_set_camera(): the film is restarted.
bool job_set_camera(struct job *job, const struct camera *camera, uint32_t width, uint32_t height,
                    bool *fits, struct err *err);
// See renderer_clear(): the film is restarted with samples that it had not before.
bool job_clear(struct job *job, struct err *err);
// See renderer_resize(): sets the number of paths in flight.
bool job_set_wave(struct job *job, uint32_t paths, struct err *err);
void job_set_progress(struct job *job, const struct progress *progress);
void job_set_listener(struct job *job, const struct job_listener *listener); // NULL: nobody
// Adds the caller's work to the job's seconds: the time since start_ns of clock_ns().
enum job_work { JOB_LOADING, JOB_JUDGING, JOB_WRITING, JOB_TOTAL };
void job_add_time(struct job *job, enum job_work work, uint64_t start_ns);
// Copies rows of a run before this one, which it goes on from.
void job_resume_trace(struct job *job, const struct trace_row *rows, uint32_t count);

// --- probes, which leave the film alone ----------------------------------------------------------

bool job_replay(struct job *job, uint32_t x, uint32_t y, uint64_t sample, struct arena *arena,
                struct replay *out, struct err *err);            // see renderer_replay()
bool job_count_steps(struct job *job, bool on, struct err *err); // see wave_count_steps()
bool job_record_kernel(struct job *job, const struct kernel_recording_params *params,
                       struct kernel_recording *out, struct err *err); // see kernel_recording.h
// See ray_probe_trace(): finds the nearest hits.
bool job_trace_rays(struct job *job, const struct probe_ray *rays, uint32_t count,
                    struct probe_hit *hits, bool *complete, struct err *err);

// --- the film and its error ----------------------------------------------------------------------

// Reads the film.
bool job_fetch_film(struct job *job, struct err *err);
// Finds where the error of the film that was read last comes from.
bool job_find_sources(const struct job *job, struct error_sources *out, struct err *err);
// Estimates the error of the film as read last, compares it with the reference, if there is one,
// and computes its hash.
bool job_judge_film(struct job *job, struct err *err);
// Reads the film for the caller alone, into their arena.
bool job_copy_film(struct job *job, struct arena *arena, struct film_image *out, struct err *err);
// Reads the film and judges it.
bool job_read_film(struct job *job, struct err *err);
// Judges the finished film: the rescued one, or the current one, which is read.
bool job_judge_end(struct job *job, struct err *err);

// The error of the current film, and its sources if requested, in two parts: only the first needs
// the renderer, so that another thread may do the second, which takes longer. The caller finishes
// the arena.
struct job_estimate {
    struct arena arena;
    struct film_image film;
    struct film_error_params params;
    uint32_t aovs; // the renderer's AOV_*
    struct half_error error;
    struct error_sources sources;
};
bool job_estimate_begin(struct job *job, struct job_estimate *out, struct err *err);
bool job_estimate_end(struct job_estimate *estimate, struct err *err); // any thread

// Returns the film's samples per pixel; the mean if tiles have their own.
uint64_t job_film_samples(const struct job *job);
// Returns the number of samples, as `goal.samples`, that gives the same image.
uint64_t job_samples(const struct job *job);
// Returns the number of samples of all pixels and all frames.
double job_total_samples(const struct job *job);
const char *job_ended_by(const struct job *job); // "spp", "time", "error" ...
// Forecasts the effect of twice the rendering time. Returns why that is not known, or NULL.
const char *job_forecast(const struct job *job, struct forecast *out);
// Adds the row of the finished image to the trace, if there is one to be kept.
void job_end_trace(struct job *job);

// --- going on ------------------------------------------------------------------------------------

// Returns everything that determines the samples, as lines of "name=value"; NULL when out of
// memory. Needs the device.
const char *job_identity(struct job *job);
// Writes a checkpoint, if one is to be kept.
bool job_checkpoint_save(struct job *job, struct err *err);
// Writes one to `path`, whether or not one is to be kept. ERR_USAGE while there is nothing to go on
// from: before a pilot has ended.
bool job_checkpoint_write(struct job *job, const char *path, struct err *err);
// Adds to a device's failure what is left of the work.
void job_checkpoint_mention(const struct job *job, struct err *err);

// After a failure of the device, or for lack of memory: makes the newest film available the job's,
// with the statistics of that time. Returns false if there is none, or if the failure is another.
bool job_rescue(struct job *job, enum err_code failure);
bool job_is_rescued(const struct job *job); // whether that was done

#endif
