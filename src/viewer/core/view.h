// One picture that accumulates: a renderer with settings of its own, and how good it is so far. The
// split view has two.
#ifndef LAMPYRIS_VIEWER_CORE_VIEW_H
#define LAMPYRIS_VIEWER_CORE_VIEW_H

#include "bvh/bvh.h"
#include "job/job.h"
#include "render/show/denoise.h"
#include "viewer/core/motion.h"
#include "viewer/core/worker.h"

// The choices that a side renders with besides the scene; undone as TARGET_METHOD.
struct method {
    struct settings settings; // width and height are the picture's
    uint32_t wave, workgroup; // 0: the device's
    bool compile_all;         // --features all
    bool merge_classes;
    bool fresh_frames;        // each frame is a picture of its own: nothing accumulates
    uint32_t samples_a_frame; // of every pixel; 0: as many as the frame's time allows
};

#define VIEW_LOOKS_MAX 64

struct view {
    struct method method;
    struct scene scene; // the viewer's, but with the method's settings: arrays are shared
    struct job job;
    struct denoiser denoiser;
    struct motion motion;      // since the denoiser's history
    bool is_ready;             // renderer holds a picture's state
    bool is_preview;           // its film has fewer pixels, because the camera moves
    uint64_t epoch;            // counts pictures begun: what a job says of an older one is void
    double seconds;            // of rendering this picture
    struct render_stats seen;  // the renderer's, as of the last frame
    uint64_t denoised_samples; // that the denoiser's picture is of; 0: it is of another film
    uint32_t denoised_by[2];   // iterations, temporal
    double denoised_seconds;   // clock of when it was made, and what it took
    double denoising_seconds;
    uint32_t usual_wave;    // paths in flight, as the renderer was created
    bool is_looking;        // a job finds out the error
    double changed_seconds; // clock of the last change that emptied the film
    double turn_seconds;    // of rendering, since the sides began to take turns
    uint64_t first_sample;  // of the film: not 0 with fresh frames
    double looked_seconds;  // clock of the last look
    // The error at doubling numbers of samples, and in between now and then.
    struct job_look looks[VIEW_LOOKS_MAX];
    uint32_t look_count;
    double next_look; // samples at which the error is to be found again
    struct error_sources sources; // of the newest look's error
};

struct viewer;

// Returns whether the error is to be found now, of the film as it is.
bool view_wants_look(const struct viewer *viewer, const struct view *view);
// Of the film as it is, where the time for it has come: on the worker's thread, into `looks`.
bool view_look_at_error(struct viewer *viewer, uint32_t side, struct err *err);
// Looks at the error at once, whatever the time, of two samples and more.
bool view_look_now(struct viewer *viewer, uint32_t side, struct err *err);
// A picture begins: what is known of the last one is void.
void view_begin(struct view *view);
// The newest look; before the first one, one without samples that knows nothing.
struct job_look view_newest_look(const struct view *view);
// Returns whether the denoiser's picture, if one is to be seen, is of all samples and by the
// settings of now.
bool view_is_denoised(const struct viewer *viewer, const struct view *view);
// By which the denoiser is called, as things are.
struct denoise_call view_denoise_call(const struct viewer *viewer, const struct view *view);
// The lowest number of samples that a pixel of the film has.
uint64_t view_samples(const struct view *view);

#endif
