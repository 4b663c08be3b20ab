// One run of `lampyris render`: what its parts (rendering, writing, reporting) share.
#ifndef LAMPYRIS_APP_RENDER_JOB_H
#define LAMPYRIS_APP_RENDER_JOB_H

#include "metrics.h"
#include "options.h"
#include "render.h"

struct job_seconds {
    double load, bvh, upload, compile, render, write, total;
};

struct render_job {
    const struct options *options;
    struct arena arena; // pictures, names, the list of frames
    struct scene scene;
    struct gpu gpu;
    struct renderer renderer;
    uint32_t camera;
    const char **outputs;
    uint32_t output_count;

    uint64_t start_ns;
    struct job_seconds seconds;
    double *frames_ms; // of each frame rendered
    uint32_t frame_count;
    bool stopped;   // by a signal; some pixels may have fewer samples
    bool timed_out; // --time ended it

    struct film_image film;
    struct half_error error;
    uint64_t image_hash; // of the mean's bits
};

// --- render_scene.c: shared with `lampyris info` ---
// Loads the scene and applies the command line to it.
bool job_load_scene(const struct options *options, struct scene *scene, uint32_t *camera,
                    struct err *err);

// --- render_output.c ---
// Settles the names and finds out what can be found out before rendering.
bool job_check_outputs(struct render_job *job, struct err *err);
// Writes all pictures; frame > 0: numbered, "NAME.0012.exr".
bool job_write_outputs(struct render_job *job, uint32_t frame, struct err *err);

// --- render_report.c ---
void job_print_summary(const struct render_job *job);
void job_print_json(const struct render_job *job);
// The command line, quoted for a shell, with `extra` behind it; NULL when out of memory.
const char *job_command_line(const struct options *options, struct arena *arena,
                             const char *extra);
// The command that follows the path of a dropped contribution, or NULL; lives in the job's arena.
const char *job_reproducing_command(struct render_job *job);

// --- render_replay.c ---
// --pixel X,Y --sample S: renders nothing, prints one path.
bool job_replay(struct render_job *job, struct err *err);

#endif
