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

#include "job/error_sources.h"
#include "job/film_error.h"
#include "job/reference.h"
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
    // Samples a pixel; with `adaptive` on average. 0: as many as `seconds` and `error` take, and
    // where neither is given, what the scene's settings say.
    uint64_t samples;
    // Time of rendering, with that before a checkpoint. 0: no limit. INFINITY: no limit either, but
    // the number of samples is open, so that no sampler can plan on it.
    double seconds;
    double error;  // upper bound of the local relMSE; 0: none
    bool adaptive; // each tile has a number of samples of its own: see adaptive.h
    // Frames of so many samples each, in place of one image of `samples`; 0: one image.
    uint32_t frames, samples_per_frame;
    bool accumulate; // each frame goes on from the one before; else the film is emptied between
};

struct job_checkpoint_params {
    const char *path; // NULL: none is kept
    double seconds;   // between two of them
    bool resume;      // go on from the one at `path`, if there is one; else there must be none
};

// Called during job_run(), between waves; each may be NULL, and false ends the render as failed.
struct job_listener {
    // After every wave, when the film and the renderer's state agree.
    bool (*after_wave)(void *context, struct err *err);
    // When `frame` frames are done.
    bool (*after_frame)(void *context, uint32_t frame, struct err *err);
    // When the trace has a new row.
    bool (*after_row)(void *context, struct err *err);
    void *context;
};

struct job_params {
    // `scene`, `tiles`, `open_ended` and `progress` are the job's to set.
    struct renderer_params renderer;
    struct scene *scene; // outlives the job; its settings.spp becomes the number that is planned
    struct job_goal goal;
    struct job_checkpoint_params checkpoint;
    const struct reference *reference; // as large as the image; outlives the job. NULL: none
    bool keeps_trace;                  // rows at doubling numbers of samples
    // How often a device that is lost during job_run() is opened again:
    // nothing but the job may be on it then. 0: never.
    uint32_t reopens;
    struct job_listener listener;
    const struct progress *progress; // NULL: nobody listens or asks to stop
};

// --- what comes out ------------------------------------------------------------------------------

struct job_seconds {
    double load, bvh, upload, compile, render;
    double bvh_uncached; // what building took, where some of it came from --bvh-cache; else 0
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

// The error as it was estimated on the way.
struct job_look {
    double samples, seconds; // of a pixel; of rendering
    double confidence;       // of error.at_most; 0: the usual
    struct half_error error;
};

// A row of a trace: the state at one time. Numbers that are not known are not finite.
struct trace_row {
    double spp;             // of the film, a pixel; on average, where pixels have their own
    double frames;          // rendered so far; 0 without frames
    double seconds;         // of rendering, of all runs
    double judging_seconds; // of reading the film and estimating its error, in this run so far
    double msamples_per_s;  // since the beginning
    double closest_rays, shadow_rays;
    double local_relmse, ci_low, ci_high, at_most; // as the half-buffers tell it
    // Against a reference.
    double true_local_relmse, true_relmse, true_mse, true_smape, true_psnr;
    const char *reason; // why there is no interval; NULL where there is
};

#define TRACE_ROWS_MAX 4096u

struct trace {
    // 16 hexadecimal digits each: a hash of all that decides what the samples are, and one of the
    // reference ("" without one). Rows of other renders do not belong into one file.
    const char *render, *reference;
    struct trace_row *rows; // in the order that they were seen; room for TRACE_ROWS_MAX
    uint32_t count;
};

// The renderer's state when a film was read from it.
struct film_state {
    struct render_stats stats;
    uint64_t next_sample;
    struct pass pass;
    bool is_even; // as renderer_is_even
};

// The film as it was copied out of the device last, in case that rendering fails. The job's own
// film serves as well where that was read since.
struct job_rescue {
    struct arena arena;
    struct film_image film;   // no pixels before the first copy
    struct film_state copied; // after the rescue, of the job's film
    struct film_state read;   // of the job's film as it was read last
    bool is_read;             // whether there is one
    double copied_at;         // seconds of rendering
    double worst_seconds;     // that a copy took
    double seconds;           // and all of them
    bool is_too_large;        // for the memory budget, which was said
    struct film_copy records; // from which rendering goes on; they live in the arena, too
    bool has_records;
    uint32_t reopened; // how often the device was
};

// To be read by all; to be changed by the functions below alone.
struct job {
    struct job_params params;
    struct scene *scene;
    struct gpu *gpu;
    struct renderer renderer;
    struct progress progress; // the renderer's: the params' with what part of the clock is over
    struct arena arena;

    bool is_rendering; // from the first sample of job_run() on
    bool stopped;      // before the goal was reached; some pixels may have fewer samples
    enum job_end ended_by;
    double begun_seconds;   // of rendering, at job_begin()
    uint64_t samples_most;  // of a pixel, on average: as many as there may be
    uint32_t round_samples; // with `adaptive`: on average, of a round of the plan
    struct tile_plan plan;  // of the tiles; no counts before the pilot has ended

    // Records.
    struct job_seconds seconds;
    double *frames_ms; // of each frame rendered
    uint32_t frame_count, frame_capacity;
    struct job_look *looks; // of goal.error
    uint32_t look_count, look_capacity;
    struct trace trace;

    // The film as last read, and what is estimated of it.
    struct arena film_arena;
    struct film_image film;
    struct half_error error;
    struct error_sources sources;    // where it comes from, if that was asked for
    struct reference_errors against; // NAN without a reference
    struct forecast_bias bias;       // what of that local relMSE is no noise
    uint64_t image_hash;             // of the mean's bits

    // For going on elsewhere, or after a failure.
    const char *identity;      // what a checkpoint is of
    struct checkpoint resumed; // closed once it is restored
    uint64_t checkpoint_ns;    // when the last one was written, or rendering began
    bool has_checkpoint;       // a file from which this render can go on
    uint64_t next_look;        // at the error, after so many samples a pixel ...
    double looks_error;        // ... on the way to this goal.error
    struct job_rescue rescue;
};

// --- life ----------------------------------------------------------------------------------------

// Settles the goal. ERR_USAGE where a method and a goal exclude each other. Needs no device yet,
// but params->renderer.gpu must be where it will be open.
bool job_init(const struct job_params *params, struct job *out, struct err *err);
// With an open device: finds the job's identity where a checkpoint or a trace needs it, and reads
// the checkpoint that is to be gone on from, if any. ERR_INPUT where that is of another render.
bool job_open(struct job *job, struct err *err);
// Creates the renderer, and puts it into the state that was read.
bool job_create(struct job *job, struct err *err);
// All three; on failure the job is finished.
bool job_start(const struct job_params *params, struct job *out, struct err *err);
void job_finish(struct job *job); // accepts NULL and {0}

// --- rendering -----------------------------------------------------------------------------------

// Renders until the goal is reached, or it is asked to stop (`stopped`).
bool job_run(struct job *job, struct err *err);

// For those that decide themselves when to look: replicates, repetitions, a viewer's frames.
// Empties the film and begins with the first sample of another seed, of `planned` samples a pixel.
bool job_begin(struct job *job, uint32_t seed, uint64_t planned, struct err *err);
// The seed of a reference for renders with `seed` and those above it: they share no samples.
uint32_t job_reference_seed(uint32_t seed);
// The time that samples take, measured on samples that are in no image.
struct job_speed {
    uint64_t samples; // of a pixel
    double seconds;   // of rendering; 0: not known
};
// Compiles, as drivers do at the first dispatch; then measures for so many seconds, unless 0.
// Leaves the film to job_begin().
bool job_warm_up(struct job *job, double seconds, struct job_speed *out, struct err *err);
struct job_step {
    uint64_t samples; // of a pixel since the beginning (with `adaptive`: rounds); UINT64_MAX: any
    double seconds;   // of rendering since the beginning; 0: no limit
    double from, to;  // the part of the progress that this step is
    const struct wave_observer *observer; // see render_call
};
// Goes on until every pixel has so many samples, the clock ends it, or it is asked to stop, but for
// one wave at least.
bool job_advance(struct job *job, const struct job_step *step, struct err *err);
// Asks whether to stop, which job_advance() does between waves only.
bool job_is_stopped(struct job *job);
// After a stop that was not the end.
void job_go_on(struct job *job);

double job_elapsed(const struct job *job); // seconds of rendering since the beginning

// --- what may change on the way ------------------------------------------------------------------

// See renderer_set_camera(): the film begins anew.
bool job_set_camera(struct job *job, const struct camera *camera, uint32_t width, uint32_t height,
                    bool *fits, struct err *err);
// See renderer_clear(): the film begins anew with samples that it had not before.
bool job_clear(struct job *job, struct err *err);
// See renderer_resize(): so many paths at a time.
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
// See ray_probe_trace(): to the nearest hit.
bool job_trace_rays(struct job *job, const struct probe_ray *rays, uint32_t count,
                    struct probe_hit *hits, bool *complete, struct err *err);

// --- the film and its error ----------------------------------------------------------------------

// Reads the film.
bool job_fetch_film(struct job *job, struct err *err);
// Finds where the error of the film that was read last comes from.
bool job_find_sources(const struct job *job, struct error_sources *out, struct err *err);
// Estimates the error of the film as it was read last, compares it with the reference, if there is
// one, and finds its hash.
bool job_judge_film(struct job *job, struct err *err);
// Reads the film for the caller alone, into their arena.
bool job_copy_film(struct job *job, struct arena *arena, struct film_image *out, struct err *err);
// Reads the film and judges it.
bool job_read_film(struct job *job, struct err *err);
// Judges the finished film: the rescued one, or that of now, which is read.
bool job_judge_end(struct job *job, struct err *err);

// The error of the film as it is now, and where it comes from if that was asked for, in two parts:
// only the first needs the renderer, so that another thread may do the second, which takes longer.
// The arena is the caller's to finish.
struct job_estimate {
    struct arena arena;
    struct film_image film;
    struct film_error_params params;
    uint32_t aovs; // of the renderer
    struct half_error error;
    struct error_sources sources;
};
bool job_estimate_begin(struct job *job, struct job_estimate *out, struct err *err);
bool job_estimate_end(struct job_estimate *estimate, struct err *err); // any thread

// The film's samples of a pixel: where tiles have their own, the mean.
uint64_t job_film_samples(const struct job *job);
// The number of samples, as `goal.samples`, that makes the same image.
uint64_t job_samples(const struct job *job);
// The samples of all pixels, and of all frames.
double job_total_samples(const struct job *job);
const char *job_ended_by(const struct job *job); // "spp", "time", "error" ...
// Forecasts what twice the time of rendering would bring. Returns why that is not known, or NULL.
const char *job_forecast(const struct job *job, struct forecast *out);
// Adds the row of the finished image to the trace, if there is one to be kept.
void job_end_trace(struct job *job);

// --- going on ------------------------------------------------------------------------------------

// All that decides what the samples are, as lines of "name=value"; NULL when out of memory. Needs
// the device.
const char *job_identity(struct job *job);
// Writes a checkpoint, if one is to be kept.
bool job_checkpoint_save(struct job *job, struct err *err);
// Adds to a device's failure what is left of the work.
void job_checkpoint_mention(const struct job *job, struct err *err);

// After a failure of the device, or for lack of memory: makes the newest film that there is the
// job's, and the statistics those of that time. False: there is none, or the failure is another.
bool job_rescue(struct job *job, enum err_code failure);
bool job_is_rescued(const struct job *job); // whether that was done

#endif
