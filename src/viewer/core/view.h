// An accumulating image: a renderer with its own settings, and its error so far. The split view has
// two.
#ifndef LAMPYRIS_VIEWER_CORE_VIEW_H
#define LAMPYRIS_VIEWER_CORE_VIEW_H

#include "bvh/bvh.h"
#include "job/job.h"
#include "render/show/denoise.h"
#include "viewer/core/motion.h"
#include "viewer/core/worker.h"

// The rendering choices of a side in addition to the scene; undone as TARGET_METHOD.
struct method {
    struct settings settings; // width and height are those of the image
    uint32_t wave, workgroup; // 0: the device's default
    bool compile_all;         // --features all
    bool merge_classes;
    bool fresh_frames;        // each frame is an image of its own: nothing accumulates
    uint32_t samples_a_frame; // per pixel; 0: as many as fit into the frame's time
};

#define VIEW_LOOKS_MAX 64

struct view {
    struct method method;
    struct scene scene; // the viewer's scene with the method's settings: arrays are shared
    struct job job;
    struct denoiser denoiser;
    struct motion motion;      // since the denoiser's history
    bool is_ready;             // the renderer holds the state of an image
    bool is_preview;           // the film has fewer pixels, because the camera moves
    uint64_t epoch;            // counts images: results of jobs for older ones are discarded
    double seconds;            // rendering time of this image
    struct render_stats seen;  // the renderer's at the last frame
    uint64_t denoised_samples; // samples of the denoised image; 0: it belongs to another film
    uint32_t denoised_by[2];   // iterations, temporal
    double denoised_seconds;   // clock time of the denoised image, and its cost
    double denoising_seconds;
    uint32_t usual_wave;    // paths in flight of a new renderer
    bool is_looking;        // a job is estimating the error
    double changed_seconds; // clock of the last change that emptied the film
    double turn_seconds;    // rendering time since the sides began to alternate
    uint64_t first_sample;  // index of the film's first sample: not 0 with fresh frames
    double looked_seconds;  // clock time of the last error estimate
    // Error estimates at doubling numbers of samples, and some in between.
    struct job_look looks[VIEW_LOOKS_MAX];
    uint32_t look_count;
    double next_look;             // samples at which the error is estimated next
    struct error_sources sources; // sources in the newest error estimate
};

struct viewer;

// Returns whether the error of the current film is to be estimated now.
bool view_wants_look(const struct viewer *viewer, const struct view *view);
// Estimates the error of the current film if it is due: on the worker's thread, into `looks`.
bool view_look_at_error(struct viewer *viewer, uint32_t side, struct err *err);
// Estimates the error at once, with two samples or more.
bool view_look_now(struct viewer *viewer, uint32_t side, struct err *err);
// Starts a new image: estimates of the last one are discarded.
void view_begin(struct view *view);
// Returns the newest estimate; before the first one, an empty estimate without samples.
struct job_look view_newest_look(const struct view *view);
// Returns whether the denoised image, if it is displayed, includes all samples and uses the current
// settings.
bool view_is_denoised(const struct viewer *viewer, const struct view *view);
// Returns the denoiser's call for the current state.
struct denoise_call view_denoise_call(const struct viewer *viewer, const struct view *view);
// Returns the lowest number of samples of all pixels of the film.
uint64_t view_samples(const struct view *view);

#endif
