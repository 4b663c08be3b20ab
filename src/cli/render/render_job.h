// One run of `lampyris render`: what its parts (rendering, writing, reporting) share.
#ifndef LAMPYRIS_CLI_RENDER_RENDER_JOB_H
#define LAMPYRIS_CLI_RENDER_RENDER_JOB_H

#include "base/file_lock.h"
#include "cli/options.h"
#include "cli/render/trace_file.h"
#include "image/image.h"
#include "job/reference.h"
#include "metrics/forecast.h"
#include "metrics/metrics.h"
#include "render/adaptive.h"
#include "render/checkpoint.h"
#include "render/render.h"

struct job_seconds {
    double load, bvh, upload, compile, render;
    double bvh_uncached; // what building took, where some of it came from --bvh-cache; else 0
    double judge; // reading the film and finding its error, with what --trace and --reference add
    double write, total;
    double render_before; // the part of `render` that runs before this one took
};

enum render_end {
    ENDED_BY_SAMPLES,
    ENDED_BY_TIME,
    ENDED_BY_ERROR,
    ENDED_BY_SIGNAL,
    ENDED_BY_DEVICE, // this and the next: failures that the film was rescued from
    ENDED_BY_MEMORY
};

// What --error saw.
struct error_look {
    uint64_t samples; // a pixel
    double confidence;
    struct half_error error;
};

// What --error is on the way to: a checkpoint keeps it.
struct job_goal {
    double error;
    uint64_t next_look; // after so many samples a pixel
};

// What a reference tells of the picture; its own noise is subtracted from the first three.
struct job_against {
    double local_relmse, relmse, mse, smape, psnr;
    struct forecast_bias bias; // of local relMSE
};

// A viewer that is sent the picture.
struct tev;
struct job_tev {
    struct tev *viewer;         // NULL: none
    uint64_t begin_ns, sent_ns; // when rendering began; when the last picture was read
    double seconds;             // that reading and packing took
    uint64_t next_sample;       // after which the next picture goes
};

// What the renderer says of a film that is read from it.
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
};

struct render_job {
    const struct options *options;
    struct arena arena; // names, the list of frames
    struct scene scene;
    struct gpu gpu;
    struct renderer renderer;
    uint32_t camera;
    const char **outputs;
    struct file_lock *locks; // one an output, then the checkpoint's and the trace's
    uint32_t output_count, lock_count;

    uint64_t start_ns;
    struct job_seconds seconds;
    double *frames_ms; // of each frame rendered
    uint32_t frame_count, frame_capacity;
    bool stopped;      // by a signal; some pixels may have fewer samples
    bool is_rendering; // from the first sample on: see render_stop.c
    uint64_t stop_ns;  // when a signal was first seen that every pixel's sample puts off
    bool stop_is_told; // that it is put off
    enum render_end ended_by;
    struct progress progress; // the options', told of --time, and patient: see render_stop.c
    uint64_t samples_most;    // of a pixel, on average: as many as there may be
    uint32_t round_samples;   // with --adaptive: on average, of a round of the plan
    struct tile_plan plan;    // of the tiles; no counts before the pilot has ended
    struct error_look *looks;
    uint32_t look_count, look_capacity;
    struct job_goal goal;
    struct reference reference; // no pixels without one
    struct trace trace;
    struct job_tev tev;

    const char *identity;      // of what a checkpoint is of
    struct checkpoint resumed; // closed once it is restored
    uint64_t checkpoint_ns;    // when the last one was written, or rendering began
    bool has_checkpoint;       // a file from which this render can go on

    struct job_rescue rescue;
    bool is_written; // the pictures of the whole render were, or it was tried

    struct arena film_arena; // of the film as last read, and what is said about it
    struct film_image film;
    struct half_error error;
    struct job_against against; // with a reference
    uint64_t image_hash;        // of the mean's bits
    float exposure;             // stops of the PNG pictures written last
};

// --- render_scene.c: shared with `lampyris info` and the viewer ---
// What the options say of loading; as long as they live.
struct scene_load_params job_scene_params(const struct options *options);
// Applies the rest of the command line to a scene as it was loaded: settings, camera, lens.
bool job_adapt_scene(const struct options *options, struct scene *scene, uint32_t *camera,
                     struct err *err);
// Loads the scene and applies the command line to it.
bool job_load_scene(const struct options *options, struct scene *scene, uint32_t *camera,
                    struct err *err);
// What of a renderer the options decide, for any command; without AOVs.
struct renderer_params job_renderer_params(const struct options *options, struct gpu *gpu,
                                           const struct scene *scene, uint32_t camera);

// --- render_loop.c ---
// How many samples there are to be at most; refuses what cannot be decided on. Before the renderer
// is created.
bool job_settle_samples(struct render_job *job, struct err *err);
// Whether a clock, or each tile for itself, decides how many samples there are.
bool job_is_open_ended(const struct options *options);
// Of a renderer: the listener of the options hears what part is done of whatever ends the render
// first, its samples or its time.
const struct progress *job_progress(struct render_job *job);
// Renders until something ends it, writing numbered frames.
bool job_render(struct render_job *job, struct err *err);
// Samples of a pixel that are rendered; by tile, on average.
uint64_t job_samples(const struct render_job *job);
const char *job_ended_by(const struct render_job *job); // "spp", "time", "error" ...
// Has the renderer take 16 samples a pixel that are not part of the picture, and makes the plan of
// the tiles from them. Leaves the film empty, unless the job was stopped.
bool job_run_pilot(struct render_job *job, struct err *err);

// --- render_stop.c ---
// Whether the options' progress asks to stop; from the first sample on, only when every pixel has
// one or that takes too long. As struct progress' should_stop.
bool job_should_stop(void *job);
// Asks it. The renderer asks between the waves of a call only, and a call may be one wave.
bool job_is_stopped(struct render_job *job);
// Says how many pixels of the film as it was read last have no sample, if any.
void job_warn_of_unsampled(const struct render_job *job);

// --- render_rescue.c ---
// Copies the film when that costs less than a hundredth of the time of rendering; as
// render_call.after_wave.
bool job_rescue_copy_when_due(struct render_job *job, struct err *err);
// To be called when the job's film was read.
void job_rescue_note_film(struct render_job *job);
// After a failure of the device, or for lack of memory: makes the newest film that there is the
// job's, and what the renderer said of it then its statistics. False: there is none, or the failure
// is another.
bool job_rescue(struct render_job *job, enum err_code failure);
// Whether that was done.
bool job_is_rescued(const struct render_job *job);

// --- render_judge.c ---
// Reads the film; and says how good it is, too.
bool job_fetch_film(struct render_job *job, struct err *err);
bool job_read_film(struct render_job *job, struct err *err);
// The same of the film as it was read last.
bool job_judge_film(struct render_job *job, struct err *err);
// The finished picture, rescued or not.
bool job_judge_end(struct render_job *job, struct err *err);
// Of the film as it was read last. confidence: 0 for the usual.
bool job_estimate_error(struct render_job *job, double confidence, struct half_error *out,
                        struct err *err);
// The film's samples of a pixel: where tiles have their own, the mean.
uint64_t job_film_samples(const struct render_job *job);
// Of all pixels, and all frames.
double job_total_samples(const struct render_job *job);
// What twice the time of rendering would bring. Returns why it is not known, or NULL.
const char *job_forecast(const struct render_job *job, struct forecast *out);

// --- render_checkpoint.c ---
// All that decides what the samples are, as text; NULL when out of memory. Needs the device.
const char *job_identity(struct render_job *job);
// With --resume, reads the checkpoint and compares what it is of with this run. Needs the device.
bool job_checkpoint_open(struct render_job *job, struct err *err);
// Puts the new renderer into the state that was read, if any.
bool job_checkpoint_restore(struct render_job *job, struct err *err);
// Writes one, if --checkpoint asks for it.
bool job_checkpoint_save(struct render_job *job, struct err *err);
// The same when the time for it has come; as render_call.after_wave.
bool job_checkpoint_when_due(void *job, struct err *err);
// Adds to a device's failure what is left of the work.
void job_checkpoint_mention(const struct render_job *job, struct err *err);

// --- render_names.c ---
// That no two outputs are one file, numbered pictures among them.
bool job_check_distinct(const struct render_job *job, struct err *err);
// When all that is read is known: that no output is one of those files, either.
bool job_check_inputs(struct render_job *job, struct err *err);

// --- render_output.c ---
// Settles the names and finds out what can be found out before rendering: whether the formats are
// known, the folders can be written to, and no other run is writing the same files. They stay
// locked until job_release_outputs.
bool job_check_outputs(struct render_job *job, struct err *err);
// When the size of the pictures is known: whether they fit where they are to go.
bool job_check_space(const struct render_job *job, struct err *err);
// Writes all pictures; frame > 0: numbered, "NAME.0012.exr". One that cannot be written does not
// keep the others from it; where no EXR file could be, the picture is saved in the system's folder
// for temporary files.
bool job_write_outputs(struct render_job *job, uint32_t frame, struct err *err);
void job_release_outputs(struct render_job *job);
enum image_tone job_image_tone(enum tone_curve curve);

// --- render_layers.c ---
#define JOB_MAX_LAYERS 15

struct job_layers {
    struct image_layer list[JOB_MAX_LAYERS];
    uint32_t count;
};

// Those that --aov asks for; their values are the film's.
void job_list_layers(const struct render_job *job, struct job_layers *out);
// What they take in a file at most, uncompressed, a pixel.
uint64_t job_layer_bytes(const struct render_job *job);

// --- render_metadata.c ---
#define JOB_MAX_ATTRIBUTES (56 + SETTING_TOTAL)

struct job_attributes {
    struct image_attribute list[JOB_MAX_ATTRIBUTES];
    uint32_t count;
};

// What is written into a picture about how it was made. The values live as long as the job's
// options, scene and `arena`. frame: as of job_write_outputs.
bool job_describe(const struct render_job *job, uint32_t frame, struct arena *arena,
                  struct job_attributes *out, struct err *err);

// --- render_report.c ---
void job_print_summary(const struct render_job *job);
bool job_print_json(const struct render_job *job, struct err *err);
// The command that follows the path of a dropped contribution, or NULL; lives in the job's arena.
const char *job_reproducing_command(struct render_job *job);

// --- render_tev.c ---
// With --tev, begins to connect; only a malformed address is an error.
bool job_tev_open(struct render_job *job, struct err *err);
// Sends what there is before the first sample.
bool job_tev_begin(struct render_job *job, struct err *err);
// Sends the picture when the samples have doubled or some time went by, unless the last is under
// way still or it would cost too much. False: the film could not be read.
bool job_tev_when_due(struct render_job *job, struct err *err);
// Sends the picture as it was read last, and says goodbye.
void job_tev_end(struct render_job *job);

// --- render_replay.c ---
// --pixel X,Y --sample S: renders nothing, prints one path.
bool job_replay(struct render_job *job, struct err *err);

#endif
