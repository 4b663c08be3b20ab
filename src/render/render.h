// Renders a scene on a device into a film. The wavefront loop itself is in wave.c.
//
//   struct renderer r = {0};
//   renderer_create(&(struct renderer_params){.gpu = &gpu, .scene = &scene}, &r, &err)
//       && renderer_render(&r, &(struct render_call){.samples = 64}, &err)
//       && renderer_read(&r, &arena, &film, &err);
//   renderer_finish(&r);
//
// Only one thread at a time may use a renderer. The values of a pixel's samples depend on (scene,
// settings, seed) alone; on one device and driver the film has the same bits for every wave size
// and for every division of the samples into calls.
#ifndef LAMPYRIS_RENDER_RENDER_H
#define LAMPYRIS_RENDER_RENDER_H

#include "base/arena.h"
#include "base/progress.h"
#include "bvh/bvh.h"
#include "flatten/flatten.h"
#include "gpu/gpu.h"
#include "render/film_aovs.h"
#include "render/memory_plan.h"
#include "render/pace.h"
#include "render/specialize.h"
#include "render/wave_size.h"
#include "scene/core/scene.h"
#include "shared/types.h"

// A wave takes 2^USUAL_SAMPLE_SHIFT samples of each of its pixels if the image has enough pixels to
// fill it: its paths are then coherent, and the sample counts of all pixels grow evenly.
#define USUAL_SAMPLE_SHIFT 4u
// An image of few pixels fills its waves with more samples of each pixel, at most
// 2^MAX_SAMPLE_SHIFT. One thread accumulates all samples of a pixel. With all AOVs this takes 8 *
// 2^12 iterations, half of the 65,535 after which lavapipe silently ends loops.
#define MAX_SAMPLE_SHIFT 12u
// Each class of --error-by adds iterations, up to 17 a sample, so the limit is lower with classes.
#define MAX_SAMPLE_SHIFT_OF_CLASSES 10u

// A part of the picture, in pixels from its upper left corner; width 0: all of it.
struct render_window {
    uint32_t x, y, width, height;
};

struct renderer_params {
    struct gpu *gpu;           // must outlive the renderer
    const struct scene *scene; // must outlive the renderer; its settings are used
    // Geometry that was prepared earlier and is shared by several renderers. It must outlive them
    // and belong to this scene; `bvh`, `instancing` and `bvh_cache` are then ignored. NULL: the
    // renderer prepares its own geometry.
    const struct geometry *geometry;
    const struct kernel_set *kernels; // NULL: the embedded kernels. The set must outlive the
                                      // device, unless the device forgets it (gpu_kernels_forget)
    uint32_t wave;                    // paths in flight; 0: the device's default
    bool tunes_wave;                  // tunes the default wave size by measured speed: see
                                      // wave_size.h
    uint32_t workgroup;               // threads of a workgroup, a power of two; 0: the device's
                                      // default
    struct bvh_method bvh;
    enum instancing instancing;
    const char *bvh_cache; // folder of the BVH cache; NULL: none
    uint32_t camera;       // index of the camera in the scene
    uint32_t aovs;         // AOV_*: images to compute besides the radiance
    bool compile_all;      // compiles features in that the scene does not need (--features all)
    bool merge_classes;    // shades all surfaces with one kernel (--classes merged)
    bool tiles;            // sample counts by tile: see adaptive.h
    bool open_ended;       // the number of samples is not known in advance
    // The film has these pixels only, with the bits that they have in the whole picture. The window
    // must be inside of the picture. It cannot be combined with tiles or light paths.
    struct render_window window;
    // Why the scene has no light paths, for part_reason(); NULL: the settings say so. Must outlive
    // the renderer.
    const char *why_path;
    const struct progress *progress;
};

struct kernel_stats {
    double ms;         // time on the device, by timestamps; 0 without them
    double longest_ms; // the longest single dispatch
    uint64_t launches;
};

// Bounces whose times are kept separately; the last one includes all later bounces.
#define STATS_BOUNCES 16u

// Time of the host's work other than waiting for kernels, in milliseconds.
struct host_stats {
    double recording;    // recording commands
    double submitting;   // submitting and waiting, less the time of kernels
    double reading_back; // reading back times and counters
};

struct nonfinite_stats {
    uint64_t count[SITE_COUNT]; // dropped contributions, by SITE_*
    // The lowest recorded contribution (by pixel, then sample), for the command that reproduces it.
    bool recorded;
    uint32_t pixel, sample, site, bounce;
};

struct render_stats {
    double flatten_seconds, bvh_seconds, upload_seconds, compile_seconds, render_seconds;
    struct kernel_stats kernels[KERNEL_COUNT];
    // Time of kernels by bounce. Shadow rays are attributed to the bounce that spawned them, and
    // work outside of bounces to bounce 0.
    double bounce_ms[STATS_BOUNCES][KERNEL_COUNT];
    struct host_stats host;
    uint64_t closest_rays, shadow_rays;
    uint64_t steps[STEPS_COUNT];        // steps of all rays through the BVH; see wave_count_steps
    uint64_t surface_hits[CLASS_COUNT]; // by class; without FEATURE_CLASSES all count in the first
    uint64_t paths;                     // number of paths added to the film
    uint64_t sparse;                    // paths, or branches of split paths, ended by --min-density
    uint64_t branches; // branches of split paths except the first one of each path, with
                       // --min-density
    uint64_t clamped;  // clamped contributions, and the total luminance lost by clamping
    double clamped_light;
    uint64_t media_lost; // overflows of the stack of media, and exits from a medium that the stack
                         // did not have
    uint64_t waves, voided_waves; // voided: traced again because a ray exceeded its budget
    uint64_t waves_ahead;         // waves begun while another one was in flight
    uint64_t suspended;           // traversals that continued in a later dispatch
    struct nonfinite_stats nonfinite;
};

static inline double render_stats_rays(const struct render_stats *stats)
{
    return (double)stats->closest_rays + (double)stats->shadow_rays;
}

// A pass takes 2^shift samples of every pixel, or, with tiles, of the pixels of all tiles that need
// so many. A pass that was interrupted continues in the next call.
struct pass {
    uint32_t shift;
    uint64_t position, length; // pixels finished, and pixels in all; length 0: no pass is under way
};

// Rows of the film, from `first` up to, but not including, `end`.
struct film_rows {
    uint32_t first, end;
};

// State of an image whose tiles have sample counts of their own.
struct tiles {
    uint32_t across, count;
    uint32_t *counts, *done; // samples of each tile in a round, and in all finished passes
    uint32_t *pixels, *first_samples, list_length; // the lists of the wave in flight
};

// The emitters that the camera sees directly: see probe/in_view.h.
struct small_light;
struct in_view {
    bool is_known;
    struct small_light *lights;
    size_t count;
    uint8_t *mask; // one byte for each pixel
};

// The objects that a second wave in flight needs; struct renderer has those of the first.
// wave_exchange() swaps the two sets, so that the same code works on the other wave.
struct other_wave {
    struct gpu_buffer buffers[BINDING_COUNT]; // the buffers for which memory_plan_is_of_wave()
                                              // returns true
    struct gpu_bindings *bindings;
    struct gpu_counters *counters;
    struct gpu_buffer counters_copy;
};

// A batch of paths: pixel_count << sample_shift samples, at most plan.wave_samples.
struct wave {
    uint32_t film_chunk;
    uint64_t first_pixel; // index in the image; with tiles, lists replace this and first_sample
    uint32_t pixel_count;
    uint32_t sample_shift;
    uint64_t first_sample;
};

// The wave after the one that wave_render() has rendered, if it was begun during that call.
struct wave_ahead {
    bool is_begun;
    struct wave wave;
    uint32_t bounce; // the next bounce to record
    struct gpu_counters before;
};

// The kernel and the bounce that end at a timestamp.
struct mark {
    uint8_t kernel, bounce;
    uint32_t first, items; // the dispatch's first item and number of items; 0: negligible work
};

struct renderer {
    struct gpu *gpu;
    const struct scene *scene;
    struct camera camera;        // the camera in use; the scene owns its name
    struct render_window window; // part of the picture that the film has; {0}: all of it
    uint64_t pixels;             // capacity: frame.width * frame.height is at most this
    uint32_t aovs;               // AOV_*, as requested
    const char *why_path;        // see struct renderer_params
    struct arena arena;
    struct flat_scene flat; // arrays are in the arena, or in the shared geometry
    struct bvh bvh;
    bool large_spheres_anyway;           // whether any camera needs large spheres: see
                                         // large_spheres.h
    const struct kernel_set *kernel_set; // NULL: the embedded ones
    struct shading_tables tables;
    struct emitter_lamps lamps; // found only if the light choice needs them
    struct specialization specialization;
    float brightest_by_chance; // see chance.h
    struct in_view in_view;
    struct memory_plan plan;
    struct gpu_buffer buffers[BINDING_COUNT]; // all buffers except the film's
    struct gpu_buffer *film;                  // plan.film_chunks buffers, each for a range of
                                              // pixels
    struct gpu_bindings *bindings;            // one for each film chunk
    struct gpu_kernel kernels[KERNEL_COUNT];
    struct gpu_commands commands;
    struct gpu_push push;
    struct gpu_frame frame; // contents of the uniform block: see frame.h
    struct film_rows rows;  // rows that are rendered: all, until renderer_set_rows()
    struct gpu_buffer frame_buffer;
    struct gpu_counters *counters;   // the values last read back
    struct gpu_buffer counters_copy; // see counters.h
    struct mark *marks;              // for each timestamp of the commands being recorded
    uint32_t mark_count;
    bool barrier_is_due;   // something was recorded since the last barrier
    uint64_t recording_ns; // time at which recording began
    struct pace pace;
    bool tunes_wave;
    struct wave_size wave_size;
    uint32_t wave_items;     // slots of the wave in flight
    struct other_wave other; // used if plan.waves is 2
    struct wave_ahead ahead;
    uint32_t bounces;        // bounces that the last wave had
    bool warned_beyond_plan; // see sampling_plan.h
    uint64_t next_sample;    // samples taken of every pixel; with tiles: finished rounds
    uint64_t round_target;   // with tiles: the round at which the current passes end
    uint64_t emptied_at;     // next_sample when the film was last emptied
    struct pass pass;
    bool takes_pairs; // all passes except the last take an even number of samples, so that both
                      // half-buffers have equally many if the render stops between two passes
    struct tiles tiles;
    struct render_stats stats;
    const struct progress *progress;
};

// Flattens the scene, builds the BVH, chooses the features, builds the tables and plans memory,
// without allocating anything on the device. *out can then be inspected and finished, but cannot
// render. On failure it is already finished.
bool renderer_prepare(const struct renderer_params *params, struct renderer *out, struct err *err);
// Checks what renderer_prepare() refuses on any device. params->gpu is not used; params->geometry
// must be given if the integrator is INTEGRATOR_BIDIR.
bool renderer_check(const struct renderer_params *params, struct err *err);
// Prepares the renderer, uploads the scene and compiles the kernels. *out must not be moved.
bool renderer_create(const struct renderer_params *params, struct renderer *out, struct err *err);
void renderer_finish(struct renderer *renderer); // accepts NULL and {0}

// Adds `samples` samples to every pixel. If the progress asks to stop, the call ends after the wave
// in flight and sets *stopped. Some pixels then have more samples than others, which the film
// records; the next call continues from there. `progress_from` and `progress_to` are the fractions
// of the whole render at which this call begins and ends.
struct render_call {
    uint64_t samples; // with tiles: number of rounds
    double progress_from, progress_to;
    bool *stopped; // may be NULL
    // The renderer calls after_wave after every wave, when the film and the renderer's state agree.
    // If after_wave returns false, the render fails. It may be NULL.
    bool (*after_wave)(void *context, struct err *err);
    // Observes the wave kernel by kernel: see wave.h. Each kernel is then submitted alone, which is
    // slow; the film is the same. May be NULL.
    const struct wave_observer *observer;
    void *context; // argument of after_wave
};
bool renderer_render(struct renderer *renderer, const struct render_call *call, struct err *err);
// Returns the smallest number of samples per pixel that makes good use of the device: as many as
// fill one wave if the image is small, else the usual number of a pass.
uint64_t renderer_samples_at_once(const struct renderer *renderer);
// Returns whether all pixels have the same samples: those (with tiles: the rounds) before
// next_sample.
bool renderer_is_even(const struct renderer *renderer);
// Returns whether every pixel of the film has a sample.
bool renderer_has_all_pixels(const struct renderer *renderer);

// Changes the sizes of waves and workgroups, and recompiles kernels if necessary; the film is kept.
// If the wave was lowered to fit, plan.wave_slots has its size. A failure may leave the renderer
// without buffers until another call succeeds.
bool renderer_resize(struct renderer *renderer, uint32_t wave, uint32_t workgroup, struct err *err);

// Reopens a lost device and recreates everything that was on it, with waves of at most `wave`
// paths. The renderer must have been the only user of the device. The film is then empty;
// film_copy.h can restore it. After a failure the renderer can only be finished.
bool renderer_reopen(struct renderer *renderer, uint32_t wave, struct err *err);

// Empties the film. The sample numbers continue, so later samples are independent of earlier ones.
bool renderer_clear(struct renderer *renderer, struct err *err);
// Plans for a number of samples per pixel other than that of the settings, for samplers and
// half-buffers (sampling_plan.h); 0: the number is not known. Call renderer_restart() next, because
// the existing samples were planned for another number.
void renderer_plan_samples(struct renderer *renderer, uint64_t samples);
// Empties the film and begins again with sample 0 of another seed. The result is that of a new
// renderer, but nothing is built or compiled. stats.nonfinite is reset, because it describes the
// film's samples; the other statistics describe the renderer's work and continue.
bool renderer_restart(struct renderer *renderer, uint32_t seed, struct err *err);

// Empties the film and begins again with sample 0, another camera (copied) and another image size,
// without building or compiling anything. The image is that of a new renderer. If a new renderer is
// necessary, sets *fits to false and does nothing: for more pixels than the renderer was created
// for, another kind of camera, a lens that the kernels lack, a far camera, spheres that become or
// cease to be large, and with tiles.
bool renderer_set_camera(struct renderer *renderer, const struct camera *camera, uint32_t width,
                         uint32_t height, bool *fits, struct err *err);

// Restricts rendering to the pixels of these rows: a pass then covers only these rows. Each pixel
// gets the samples that a render of the whole picture gives it. With light paths, which contribute
// to all pixels, all pixels get the light of the light paths of these rows. With tiles, the rows
// must begin and end at tiles. If the rows change, a pass that was stopped is ended.
void renderer_set_rows(struct renderer *renderer, const struct film_rows *rows);

// Means of the half-buffers, and sample counts. Pixels are in rows from the top.
struct film_image {
    uint32_t width, height;
    float (*mean)[3];   // mean over all samples
    float (*half_a)[3]; // mean of the first half-buffer
    float (*half_b)[3]; // mean of the second half-buffer; (0, 0, 0) with one sample
    uint32_t *samples;
    struct film_rows rows;                // the rows that were rendered
    uint64_t least_samples, most_samples; // least and most samples of a pixel of these rows
    uint64_t unsampled;                   // number of pixels of these rows without a sample
    uint64_t dropped;                     // number of samples that lost a non-finite contribution
    struct film_aovs aovs;
};
bool renderer_read(struct renderer *renderer, struct arena *arena, struct film_image *out,
                   struct err *err);

#endif
