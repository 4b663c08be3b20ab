// An accumulating image: a renderer with its own settings, and the estimates of its error. A split
// view has two.
#ifndef LAMPYRIS_VIEWER_CORE_VIEW_H
#define LAMPYRIS_VIEWER_CORE_VIEW_H

#include "bvh/bvh.h"
#include "job/job.h"
#include "render/show/denoise.h"
#include "viewer/core/motion.h"
#include "viewer/core/worker.h"

// The rendering settings of a side that are not part of the scene; the history can restore them
// (TARGET_METHOD).
struct method {
    struct settings settings; // width and height are replaced by those of the image
    uint32_t wave, workgroup; // 0: the device's default
    bool compile_all;         // --features all
    bool merge_classes;
    bool fresh_frames;        // samples do not accumulate: each frame is an image of its own
    uint32_t samples_a_frame; // per pixel; 0: as many as fit into the time of a frame
};

#define VIEW_LOOKS_MAX 64

struct view {
    struct method method;
    // The viewer's scene with the method's settings; it shares the scene's arrays.
    struct scene scene;
    struct job job;
    struct denoiser denoiser;
    struct motion motion; // motion of objects since the denoiser's history
    bool is_ready;        // the renderer can render the image
    bool is_preview; // the film has fewer pixels than the full-size image, because the camera moves
    uint64_t epoch;  // number of the image; results of jobs for older images are discarded
    double seconds;  // rendering time of this image
    struct render_stats seen; // the renderer's statistics at the last frame
    // Number of samples in the denoised image; 0: it belongs to another film.
    uint64_t denoised_samples;
    uint32_t denoised_by[2];  // settings with which it was denoised: iterations, temporal
    double denoised_seconds;  // time at which it was denoised
    double denoising_seconds; // time that the denoising took
    uint32_t usual_wave;      // number of paths in flight of a new renderer
    bool is_looking;          // a job is estimating the error
    double changed_seconds;   // time of the last change that emptied the film
    double turn_seconds;      // rendering time since the sides began to alternate
    uint64_t first_sample;    // index of the film's first sample: not 0 with fresh frames
    double looked_seconds;    // time of the last error estimate
    // Error estimates at doubling numbers of samples, and some at numbers in between.
    struct job_look looks[VIEW_LOOKS_MAX];
    uint32_t look_count;
    double next_look;             // number of samples at which the error is estimated next
    struct error_sources sources; // sources of the error in the newest estimate
};

struct viewer;

// Returns whether the error of the current film should be estimated now.
bool view_wants_look(const struct viewer *viewer, const struct view *view);
// Starts an estimate of the error on the worker's thread if one is due; the result is added to
// `looks`.
bool view_look_at_error(struct viewer *viewer, uint32_t side, struct err *err);
// Estimates the error at once. Does nothing if there are fewer than two samples, if the image is a
// preview, or if the newest estimate is of the same number of samples.
bool view_look_now(struct viewer *viewer, uint32_t side, struct err *err);
// Starts a new image and discards the estimates of the previous one.
void view_begin(struct view *view);
// Returns the newest estimate, or an empty estimate with 0 samples if there is none.
struct job_look view_newest_look(const struct view *view);
// Returns false if the denoised image should be displayed but lacks samples or was made with other
// settings.
bool view_is_denoised(const struct viewer *viewer, const struct view *view);
// Returns the parameters of the denoiser for the current state.
struct denoise_call view_denoise_call(const struct viewer *viewer, const struct view *view);
// Returns the least number of samples of a pixel of the film.
uint64_t view_samples(const struct view *view);

#endif
