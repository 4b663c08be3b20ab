// A render: from a scene, a device, settings and a goal it produces a film, error estimates and
// records. The viewer and all commands that render use these functions. Only this module decides
// how many samples are rendered and in which steps, what ends a render, and how accurate the film
// is.
//
//   struct job job;
//   const struct job_params params = {
//       .renderer = {.gpu = &gpu}, .scene = &scene, .goal = {.error = 1e-3}};
//   job_start(&params, &job, &err) && job_run(&job, &err) && job_judge_end(&job, &err);
//   job_finish(&job);
//
// One thread at a time may use a job, unless a function says otherwise. The film's bits depend only
// on what renderer.h names, not on steps, clocks, listeners, or how often the error is estimated.
#ifndef LAMPYRIS_JOB_JOB_H
#define LAMPYRIS_JOB_JOB_H

#include "flatten/geometry.h"
#include "job/choice.h"
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

// --- parameters ----------------------------------------------------------------------------------

// The goal of a render. The render ends as soon as one of these limits is reached.
struct job_goal {
    // Samples per pixel; with `adaptive` their mean over pixels. 0: as many as `seconds` and
    // `error` require, or, if both are 0, the number in the scene's settings.
    uint64_t samples;
    // Rendering time, including the time of earlier runs from a checkpoint. 0: no limit. INFINITY:
    // no limit, and samplers must not rely on a planned number of samples.
    double seconds;
    double error;  // upper bound of the local relMSE; 0: no limit
    bool adaptive; // each tile gets a number of samples of its own: see adaptive.h
    // Number of frames and samples per pixel of each frame, instead of one image with `samples`. 0:
    // one image.
    uint32_t frames, samples_per_frame;
    bool accumulate; // each frame adds its samples to those of the frames before; otherwise the
                     // film is emptied
};

struct job_checkpoint_params {
    const char *path;  // NULL: no checkpoint is written
    double seconds;    // greatest interval between two checkpoints
    bool resume;       // resume from the file at `path` if it exists; if false, the file must not
                       // exist
    bool is_paced;     // intervals are shorter if checkpoints then take a small part of the time
    bool keeps_blocks; // for a rank of a crew: saves its samples after each of its blocks
};

// Samples that the ranks of a lost run had saved, and that are not yet in the film: see blocks.c.
struct job_saved_blocks {
    struct arena arena;
    struct crew_film film;       // the sum of the saved samples
    struct sample_ranges ranges; // the samples that `film` has
    uint64_t end;                // all samples below this one must be in the job's film before the
                                 // render continues as usual; 0: nothing was saved
};

// A shard: one of several processes that share a render renders some of the samples of every pixel,
// or all samples of some rows of tiles. Its checkpoint is a part, which merge.h adds to others. Its
// goal can only be a number of samples.
struct job_shard {
    // Selects part `index`, from 1, of `count` equal parts of the samples or rows. If count is 0,
    // `range` selects them.
    uint32_t index, count;
    struct sample_range range; // end = 0: the job is not a shard and renders all samples
    bool by_tiles; // divides rows instead of samples; also set for a film merged from such parts
};

// The film of a render that was merged from its parts.
struct job_merged {
    struct film_copy film; // the records are released after they were copied to the device
    struct arena arena;    // owns the records
    const char *identity;  // identity of the parts, without their samples
    bool is_partial;       // samples are missing, so no --spp gives the same picture
    const char *devices;   // names of all devices, if they or their drivers differ; otherwise NULL
    // With --adaptive: samples of each tile in a round; the film's `done` has those of all rounds.
    uint32_t *counts;
};

// Functions that job_run() calls between waves. Each may be NULL. If one returns false, the render
// fails.
struct job_listener {
    // Called after each wave, when the film and the renderer's state are consistent.
    bool (*after_wave)(void *context, struct err *err);
    // Called when `frame` frames are finished.
    bool (*after_frame)(void *context, uint32_t frame, struct err *err);
    // Called when a row was added to the trace.
    bool (*after_row)(void *context, struct err *err);
    void *context;
};

struct job_params {
    // The job sets `scene`, `tiles`, `open_ended` and `progress`.
    struct renderer_params renderer;
    struct scene *scene; // must outlive the job, which sets settings.spp to the planned number of
                         // samples
    struct job_goal goal;
    struct job_checkpoint_params checkpoint;
    struct job_shard shard;
    // A merged film, of which no samples remain to be rendered; NULL: none.
    struct job_merged *merged;
    // Other devices or processes that take part in the render; only for goals with an error, a time
    // or a number of samples. NULL: none.
    struct crew *crew;
    // With INTEGRATOR_AUTO, the job chooses the integrator and sets it in the scene's settings. If
    // this is false, INTEGRATOR_AUTO means INTEGRATOR_PATH.
    bool chooses_integrator;
    const char *command;               // command line to store in checkpoints; NULL: none
    const struct reference *reference; // must have the image's size and outlive the job; NULL: none
    bool keeps_trace;                  // adds rows to the trace at doubling numbers of samples
    // How many times the device is reopened if it is lost during job_run(). If not 0, only the job
    // may use the device.
    uint32_t reopens;
    struct job_listener listener;
    const struct progress *progress; // NULL: progress is not reported and no stop is requested
};

// --- results -------------------------------------------------------------------------------------

struct job_seconds {
    double load, bvh, upload, compile, render;
    double bvh_uncached; // time to build the hierarchies that were loaded from --bvh-cache;
                         // otherwise 0
    double judge;        // time for reading the film and estimating its error, including trace and
                         // reference
    double write, total;
    double render_before; // the part of `render` that earlier runs took
};

enum job_end {
    ENDED_BY_SAMPLES,
    ENDED_BY_TIME,
    ENDED_BY_ERROR,
    ENDED_BY_SIGNAL,
    ENDED_BY_DEVICE, // the device failed, and the film was rescued
    ENDED_BY_MEMORY  // memory ran out, and the film was rescued
};

// An error estimate during the render.
struct job_look {
    double samples, seconds; // samples per pixel; rendering time
    double confidence;       // confidence of error.at_most; 0: the default
    struct half_error error;
};

// A row of a trace: the state at one time. Unknown numbers are not finite.
struct trace_row {
    double spp;             // samples per pixel of the film; the mean if pixels have different
                            // counts
    double frames;          // number of frames rendered so far; 0 if the render has no frames
    double seconds;         // rendering time of all runs
    double judging_seconds; // time for reading the film and estimating its error, in this run so
                            // far
    double msamples_per_s;  // millions of samples per second, from the beginning
    double closest_rays, shadow_rays;
    double local_relmse, ci_low, ci_high, at_most; // estimated from the half-buffers
    // Errors measured against a reference.
    double true_local_relmse, true_relmse, true_mse, true_smape, true_psnr;
    const char *reason; // why there is no interval; NULL if there is one
};

#define TRACE_ROWS_MAX 4096u

struct trace {
    // Hashes of everything that determines the samples and of the reference ("" if there is none),
    // as 16 hexadecimal digits. A file must only contain rows of renders with equal hashes.
    const char *render, *reference;
    struct trace_row *rows; // in chronological order; room for TRACE_ROWS_MAX
    uint32_t count;
};

// The renderer's state when a film was read from it.
struct film_state {
    struct render_stats stats;
    uint64_t next_sample;
    struct pass pass;
    bool is_even; // see renderer_is_even()
};

// The last copy of the film from the device, for the case that rendering fails. If the job's own
// film was read later than this copy, a rescue uses that film.
struct job_rescue {
    struct arena arena;
    struct film_image film;   // the copy; has no pixels before the first one
    struct film_state copied; // state of the copy; after a rescue, state of the job's film
    struct film_state read;   // state of the job's film when it was last read
    bool is_read;             // `read` is valid
    double copied_at;         // rendering time, in seconds, at which the copy was made
    double worst_seconds;     // longest time that a copy has taken
    double seconds;           // total time of all copies
    bool is_too_large;        // the copy exceeds its share of the memory budget, which was reported
    struct film_copy records; // data from which rendering can be resumed; owned by `arena`
    bool has_records;
    uint32_t reopened; // number of times that the device was reopened
};

// A range of samples that a crew renders before the film is needed again.
struct crew_deal {
    uint64_t next, end; // samples from `next` to before `end` are not yet assigned to a member
    uint64_t start_ns;
    double seconds;                  // rendering time after which no more blocks are assigned; 0:
                                     // no limit
    double all;                      // number of samples of the step
    uint64_t done;                   // number of samples in finished blocks of the step
    uint64_t (*blocks)[CREW_BLOCKS]; // samples of the blocks assigned to each worker, oldest first
    uint32_t given;                  // number of blocks assigned so far
    bool is_closed;                  // no more blocks are assigned
    bool took_part;                  // a worker has finished a block
    bool is_in_block;                // the job renders a block of its own; a stop waits until it is
                                     // finished
};

// Callers may read all members, but only the functions below change them.
struct job {
    struct job_params params;
    struct scene *scene;
    struct gpu *gpu;
    struct renderer renderer;
    struct geometry geometry; // the renderer's geometry, if the choice of the integrator needed it
    struct integrator_choice choice;
    struct progress progress; // passed to the renderer; reports to params.progress, with the
                              // elapsed fraction of the time limit
    struct arena arena;

    // When the samples were planned, their number depended on a time limit or on the errors of
    // tiles.
    bool is_open_ended;
    bool is_rendering; // job_run() has rendered its first sample
    bool stopped;      // stopped before the goal was reached; some pixels may have fewer samples
                       // than others
    enum job_end ended_by;
    double begun_seconds;     // rendering time at job_begin()
    uint64_t samples_most;    // limit of samples per pixel (with `adaptive`, of their mean); for a
                              // shard of samples, the end of its range
    uint64_t samples_first;   // the first sample; not 0 only for a shard of samples
    struct sample_range rows; // rows of a shard by tiles; end = 0: all
    uint32_t round_samples;   // with `adaptive`: mean number of samples per pixel in a round of the
                              // plan
    struct tile_plan plan;    // the number of samples of each tile; empty until the pilot has ended

    // Used if the job has a crew, or is a worker of one.
    struct crew_deal deal;
    bool has_samples;          // the renderer's film has samples
    uint64_t first_held;       // the first sample in the renderer's film
    struct sample_ranges held; // all samples in the renderer's film
    uint32_t held_capacity;
    uint64_t held_saved; // number of samples in `held` when the film was saved last
    bool removes_blocks; // all files of saved blocks belong to this render
    struct job_saved_blocks saved;

    // Records.
    struct job_seconds seconds;
    double *frames_ms; // rendering time of each frame, in milliseconds
    uint32_t frame_count, frame_capacity;
    struct job_look *looks; // the interim tests for goal.error
    uint32_t look_count, look_capacity;
    struct trace trace;

    // The film that was read last, and its estimates.
    struct arena film_arena;
    struct film_image film;
    struct half_error error;
    struct error_sources sources;    // sources of the error, if requested
    struct reference_errors against; // errors against the reference; NAN if there is none
    struct forecast_bias bias;       // the part of against.local_relmse that is bias
    uint64_t image_hash;             // hash of the bits of the film's mean

    // State for resuming from a checkpoint or after a failure.
    const char *identity;      // identity of the render in checkpoints
    struct checkpoint resumed; // the checkpoint that is resumed; closed once its state is restored
    uint64_t checkpoint_ns;    // time at which the last checkpoint was written or, if there is
                               // none, at which rendering began
    uint64_t checkpoint_from;  // time at which the job began to add the crew's films for the next
                               // checkpoint; 0: the job has no crew
    double checkpoint_cost;    // seconds that the last checkpoint took; 0: there is none yet
    bool has_checkpoint;       // there is a file from which this render can continue
    uint64_t next_look;        // samples per pixel at the next interim test
    double looks_error;        // the goal.error for which next_look was planned
    struct job_rescue rescue;
};

// --- create and finish ---------------------------------------------------------------------------

// Initialises a job and checks its goal. Fails with ERR_USAGE if the method, the shard and the goal
// cannot be combined. Needs no device yet, but params->renderer.gpu must be the address of the
// device that will be opened.
bool job_init(const struct job_params *params, struct job *out, struct err *err);
// Checks what renderers refuse on any device: settings and layers that the integrator does not
// support. Needs no device.
bool job_check_renderer(struct job *job, struct err *err);
// Needs an open device. Chooses the integrator, if params.chooses_integrator is set. job_open()
// calls this function, too. Callers with a crew call it before they start the workers, which use
// the same scene.
bool job_choose_integrator(struct job *job, struct err *err);
// Needs an open device. Chooses the integrator. Computes the job's identity if a checkpoint or a
// trace needs it, and reads the checkpoint to resume from, if there is one. Fails with ERR_INPUT if
// the checkpoint belongs to another render.
bool job_open(struct job *job, struct err *err);
// Creates the renderer and restores the state from the checkpoint.
bool job_create(struct job *job, struct err *err);
// Calls job_init(), job_open() and job_create(). On failure, also calls job_finish().
bool job_start(const struct job_params *params, struct job *out, struct err *err);
void job_finish(struct job *job); // accepts NULL and {0}

// --- rendering -----------------------------------------------------------------------------------

// Renders until the goal is reached, or until the progress listener requests a stop, which sets
// `stopped`.
bool job_run(struct job *job, struct err *err);

// Sets other limits of samples, time or error for the next job_run(), which continues from the
// present film, also after a stop. The plan of the samples remains that of the beginning. Fails
// with ERR_USAGE if the method does not permit the goal, or if the goal of a render with frames,
// adaptive tiles or a shard would change.
bool job_set_goal(struct job *job, const struct job_goal *goal, struct err *err);

// For callers that decide themselves when to end a render: replicates, repetitions and frames of
// the viewer. Empties the film and begins with the first sample of another seed, planning `planned`
// samples per pixel.
bool job_begin(struct job *job, uint32_t seed, uint64_t planned, struct err *err);
// Returns a seed for the reference of renders with `seed` and higher seeds. The reference shares no
// samples with them.
uint32_t job_reference_seed(uint32_t seed);
// A measurement of rendering speed. Its samples are not part of an image.
struct job_speed {
    uint64_t samples; // samples per pixel
    double seconds;   // rendering time; 0: not known
};
// Renders samples so that the driver compiles the kernels, which it may do at the first dispatch.
// Then measures the speed for `seconds`, unless that is 0. job_begin() empties the film afterwards.
bool job_warm_up(struct job *job, double seconds, struct job_speed *out, struct err *err);
struct job_step {
    uint64_t samples; // samples per pixel since the beginning (with `adaptive`: rounds);
                      // UINT64_MAX: no limit
    double seconds;   // rendering time since the beginning; 0: no limit
    double from, to;  // the progress, in [0, 1], at the beginning and at the end of this step
    const struct wave_observer *observer; // see struct render_call
};
// Renders at least one wave. Ends when every pixel has step->samples samples, when step->seconds
// have passed, or when the progress listener requests a stop.
bool job_advance(struct job *job, const struct job_step *step, struct err *err);
// Returns whether the progress listener requests a stop. job_advance() asks it only between waves.
bool job_is_stopped(struct job *job);
// Clears the state `stopped`, so that the job can continue.
void job_go_on(struct job *job);

double job_elapsed(const struct job *job); // rendering time since the beginning, in seconds

// --- changes during a render ---------------------------------------------------------------------

// See renderer_set_camera(). The film is restarted.
bool job_set_camera(struct job *job, const struct camera *camera, uint32_t width, uint32_t height,
                    bool *fits, struct err *err);
// Begins the next picture of a sequence. Sets the camera as job_set_camera() does, with the same
// size. Discards the records of the former picture, so the next job_run() begins as in a new job.
bool job_begin_view(struct job *job, const struct camera *camera, bool *fits, struct err *err);
// See renderer_clear(). The film is restarted with samples that it did not have before.
bool job_clear(struct job *job, struct err *err);
// See renderer_resize(). Sets the number of paths in flight.
bool job_set_wave(struct job *job, uint32_t paths, struct err *err);
void job_set_progress(struct job *job, const struct progress *progress);
// Sets the listener. NULL removes it.
void job_set_listener(struct job *job, const struct job_listener *listener);
// Adds the time since start_ns, a value of clock_ns(), to the job's seconds for this kind of work.
enum job_work { JOB_LOADING, JOB_BUILDING, JOB_JUDGING, JOB_WRITING, JOB_TOTAL };
void job_add_time(struct job *job, enum job_work work, uint64_t start_ns);
// Copies the rows of an earlier run that this one continues.
void job_resume_trace(struct job *job, const struct trace_row *rows, uint32_t count);

// --- probes, which do not change the film --------------------------------------------------------

bool job_replay(struct job *job, uint32_t x, uint32_t y, uint64_t sample, struct arena *arena,
                struct replay *out, struct err *err);            // see renderer_replay()
bool job_count_steps(struct job *job, bool on, struct err *err); // see wave_count_steps()
bool job_record_kernel(struct job *job, const struct kernel_recording_params *params,
                       struct kernel_recording *out, struct err *err); // see kernel_recording.h
// See ray_probe_trace(). Finds the nearest hits.
bool job_trace_rays(struct job *job, const struct probe_ray *rays, uint32_t count,
                    struct probe_hit *hits, bool *complete, struct err *err);

// --- the film and its error ----------------------------------------------------------------------

// Reads the film from the device.
bool job_fetch_film(struct job *job, struct err *err);
// Finds the sources of the error of the film that was read last.
bool job_find_sources(const struct job *job, struct error_sources *out, struct err *err);
// Estimates the error of the film that was read last, compares it with the reference if there is
// one, and computes its hash.
bool job_judge_film(struct job *job, struct err *err);
// Reads the film into the caller's arena. The job's own film remains unchanged.
bool job_copy_film(struct job *job, struct arena *arena, struct film_image *out, struct err *err);
// Calls job_fetch_film() and job_judge_film().
bool job_read_film(struct job *job, struct err *err);
// Judges the film at the end of the render: the rescued film, or else the current one, which is
// read first.
bool job_judge_end(struct job *job, struct err *err);

// Estimates the error of the current film, and finds its sources if requested, in two parts. Only
// the first part uses the renderer, so another thread may execute the second one, which takes
// longer. The caller finishes the arena.
struct job_estimate {
    struct arena arena;
    struct film_image film;
    struct film_error_params params;
    uint32_t aovs; // the renderer's AOV_*
    struct half_error error;
    struct error_sources sources;
};
bool job_estimate_begin(struct job *job, struct job_estimate *out, struct err *err);
bool job_estimate_end(struct job_estimate *estimate, struct err *err); // may be called by any
                                                                       // thread

// Returns the film's samples per pixel; their mean if pixels have different numbers.
uint64_t job_film_samples(const struct job *job);
// Returns the value of goal.samples with which a render gives the same image.
uint64_t job_samples(const struct job *job);
// Returns the total number of samples of all pixels and all frames.
double job_total_samples(const struct job *job);
const char *job_ended_by(const struct job *job); // "spp", "time", "error" ...
// Forecasts the error after twice the rendering time. Returns NULL, or the reason why it is not
// known.
const char *job_forecast(const struct job *job, struct forecast *out);
// Adds a row for the finished image to the trace, if the job keeps one.
void job_end_trace(struct job *job);

// --- checkpoints and rescue ----------------------------------------------------------------------

// Returns everything that determines the samples, as lines of "name=value". Returns NULL when out
// of memory. Needs the device.
const char *job_identity(struct job *job);

// The device and its driver. If the samples come from different devices or drivers, `name` is
// "several devices: " with all names, and `driver` is "several".
struct job_device {
    const char *name, *driver; // `name` is NULL when out of memory
};
struct job_device job_device(const struct job *job, struct arena *arena);
// Writes a checkpoint if params.checkpoint has a path.
bool job_checkpoint_save(struct job *job, struct err *err);
// Writes a checkpoint to `path`, whatever params.checkpoint is. Fails with ERR_USAGE as long as an
// adaptive render has only its pilot, from which no render can resume.
bool job_checkpoint_write(struct job *job, const char *path, struct err *err);
// Adds to the message of a device failure that the last checkpoint is kept, if there is one.
void job_checkpoint_mention(const struct job *job, struct err *err);

// After a failure of the device or a lack of memory, makes the newest available film, with its
// statistics, the job's film. Returns false if there is none, or if the failure is of another kind.
bool job_rescue(struct job *job, enum err_code failure);
bool job_is_rescued(const struct job *job); // returns whether job_rescue() has succeeded

#endif
