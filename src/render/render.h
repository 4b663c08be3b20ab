// The renderer as a library: a scene and a device in, a film out. The wavefront loop itself is in
// wave.c.
//
//   struct renderer r = {0};
//   renderer_create(&(struct renderer_params){.gpu = &gpu, .scene = &scene}, &r, &err)
//       && renderer_render(&r, &(struct render_call){.samples = 64}, &err)
//       && renderer_read(&r, &arena, &film, &err);
//   renderer_finish(&r);
//
// One thread at a time. What a pixel's samples are depends on (scene, settings, seed) alone; on one
// device and driver the film has the same bits for every wave size and every way to split the
// samples over calls.
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

// A wave takes 2^this samples of each of its pixels, where the picture has pixels enough to fill
// it: its paths stay coherent, and the samples of all pixels grow together.
#define USUAL_SAMPLE_SHIFT 4u
// A picture of few pixels fills its waves with more samples of each, at most 2^this. One thread
// accumulates all of a pixel's: with every AOV these are 8 * 2^this iterations, half of the 65,535
// after which lavapipe ends loops silently.
#define MAX_SAMPLE_SHIFT 12u
// The same with the classes of --error-by, for which there are up to 17 iterations a sample more.
#define MAX_SAMPLE_SHIFT_OF_CLASSES 10u

struct renderer_params {
    struct gpu *gpu;           // must outlive the renderer
    const struct scene *scene; // the same; its settings are the render's
    // Prepared before, and shared by several renderers: must outlive them, and be of this scene.
    // `bvh`, `instancing` and `bvh_cache` are of no account then. NULL: the renderer's own.
    const struct geometry *geometry;
    const struct kernel_set *kernels; // NULL: the embedded ones. Must outlive the device, or be
                                      // forgotten by it (gpu_kernels_forget)
    uint32_t wave;                    // paths in flight; 0: the device's default
    bool tunes_wave;                  // the default may change by measured speed: see wave_size.h
    uint32_t workgroup;               // threads, a power of two; 0: the device's default
    struct bvh_method bvh;
    enum instancing instancing;
    const char *bvh_cache; // folder in which hierarchies are kept; NULL: none
    uint32_t camera;       // index into the scene's
    uint32_t aovs;         // AOV_*: pictures wanted besides the radiance
    bool compile_all;      // compile in what the scene does not need (--features all)
    bool merge_classes;    // one kernel for all surfaces (--classes merged)
    bool tiles;            // sample counts by tile: see adaptive.h
    bool open_ended;       // how many samples there will be is not known
    const struct progress *progress;
};

struct kernel_stats {
    double ms;         // on the device, by timestamps; 0 without them
    double longest_ms; // of one dispatch
    uint64_t launches;
};

// Bounces whose times are kept apart; the last one stands for all later ones, too.
#define STATS_BOUNCES 16u

// The host's work besides waiting for kernels, in milliseconds.
struct host_stats {
    double recording;    // commands
    double submitting;   // them, until the host knows that they are done, less the kernels' times
    double reading_back; // times and counters
};

struct nonfinite_stats {
    uint64_t count[SITE_COUNT]; // dropped contributions
    // One of them, the lowest of those recorded, for the command that reproduces it.
    bool recorded;
    uint32_t pixel, sample, site, bounce;
};

struct render_stats {
    double flatten_seconds, bvh_seconds, upload_seconds, compile_seconds, render_seconds;
    struct kernel_stats kernels[KERNEL_COUNT];
    // Kernels' time by bounce. Shadow rays count to the bounce that sent them, work outside of all
    // bounces to the first.
    double bounce_ms[STATS_BOUNCES][KERNEL_COUNT];
    struct host_stats host;
    uint64_t closest_rays, shadow_rays;
    uint64_t steps[STEPS_COUNT];        // of them through the BVH; see wave_count_steps
    uint64_t surface_hits[CLASS_COUNT]; // by class; all in the first without FEATURE_CLASSES
    uint64_t paths;                     // that reached the film
    uint64_t sparse;                    // paths, or branches of them, that --min-density has ended
    uint64_t branches; // that paths got beside themselves where they split, with --min-density
    uint64_t clamped;  // contributions, and the luminance that all of them lost
    double clamped_light;
    uint64_t media_lost;          // times that a stack of media overflowed, or missed one to leave
    uint64_t waves, voided_waves; // voided: traced again because a ray ran out of its budget
    uint64_t waves_ahead;         // begun while another one was in flight
    uint64_t suspended;           // traversals continued in a later dispatch
    struct nonfinite_stats nonfinite;
};

static inline double render_stats_rays(const struct render_stats *stats)
{
    return (double)stats->closest_rays + (double)stats->shadow_rays;
}

// Samples over the picture that are taken together: 2^shift of every pixel, or of those that the
// plan says. One that a signal cut short goes on with the next call.
struct pass {
    uint32_t shift;
    uint64_t position, length; // pixels done, and in all; 0: none is under way
};

// State of a picture whose tiles have sample counts of their own.
struct tiles {
    uint32_t across, count;
    uint32_t *counts, *done; // of each: samples a round, and in all the passes that are over
    uint64_t total;          // samples of all pixels in a round
    uint32_t *pixels, *first_samples, list_length; // of the wave in flight
};

// The emitters that the camera sees directly: see probe/in_view.h.
struct small_light;
struct in_view {
    bool is_known;
    struct small_light *lights;
    size_t count;
    uint8_t *mask; // a byte a pixel
};

// A second wave in flight has these of its own, as the first one has them in struct renderer. Both
// are exchanged whenever the other wave is meant.
struct other_wave {
    struct gpu_buffer buffers[BINDING_COUNT]; // those of memory_plan_is_of_wave()
    struct gpu_bindings *bindings;
    struct gpu_counters *counters;
    struct gpu_buffer counters_copy;
};

// A batch of paths, pixel_count << sample_shift samples: at most plan.wave_samples.
struct wave {
    uint32_t film_chunk;
    uint64_t first_pixel; // of the image; with tiles this and first_sample are in lists instead
    uint32_t pixel_count;
    uint32_t sample_shift;
    uint64_t first_sample;
};

// The wave after the one that wave_render() has ended, where that has begun it meanwhile.
struct wave_ahead {
    bool is_begun;
    struct wave wave;
    uint32_t bounce; // the next one
    struct gpu_counters before;
};

// The kernel and the bounce that a timestamp ends.
struct mark {
    uint8_t kernel, bounce;
    uint32_t first, items; // of the dispatch; 0 items: of little work
};

struct renderer {
    struct gpu *gpu;
    const struct scene *scene;
    struct camera camera; // looked through; its name is the scene's
    uint64_t pixels;      // that there is room for: frame.width * frame.height is at most this
    uint32_t aovs;        // AOV_*, as asked for
    struct arena arena;
    struct flat_scene flat; // their arrays are the arena's, or those of the geometry that is shared
    struct bvh bvh;
    bool large_spheres_anyway;           // wherever the camera is: see large_spheres.h
    const struct kernel_set *kernel_set; // NULL: the embedded ones
    struct shading_tables tables;
    struct emitter_lamps lamps; // where the choice of lights asks for them
    struct specialization specialization;
    float brightest_by_chance; // see chance.h
    struct in_view in_view;
    struct memory_plan plan;
    struct gpu_buffer buffers[BINDING_COUNT]; // but the film
    struct gpu_buffer *film;                  // plan.film_chunks of them, by ranges of pixels
    struct gpu_bindings *bindings;            // one a film chunk
    struct gpu_kernel kernels[KERNEL_COUNT];
    struct gpu_commands commands;
    struct gpu_push push;
    struct gpu_frame frame; // as last uploaded: see frame.h
    struct gpu_buffer frame_buffer;
    struct gpu_counters *counters;   // as last read back
    struct gpu_buffer counters_copy; // see counters.h
    struct mark *marks;              // one a timestamp of the commands being recorded
    uint32_t mark_count;
    bool barrier_is_due;   // something was recorded since the last one
    uint64_t recording_ns; // when recording them began
    struct pace pace;
    bool tunes_wave;
    struct wave_size wave_size;
    uint32_t wave_items;     // slots that the wave in flight has
    struct other_wave other; // with plan.waves of 2
    struct wave_ahead ahead;
    uint32_t bounces;        // that the last wave had
    bool warned_beyond_plan; // see sampling_plan.h
    uint64_t next_sample;    // of every pixel; with tiles: rounds that are over
    uint64_t round_target;   // with tiles: rounds that the passes lead up to
    uint64_t emptied_at;     // next_sample when the film was last emptied
    struct pass pass;
    struct tiles tiles;
    struct render_stats stats;
    const struct progress *progress;
};

// Flattens, builds the BVH, chooses the features, builds the tables and plans memory: all that a
// render needs is known then, and nothing is allocated on the device. *out can be looked at and
// finished, but cannot render. On failure it is finished.
bool renderer_prepare(const struct renderer_params *params, struct renderer *out, struct err *err);
// Prepares the renderer, uploads and compiles. *out must stay where it is.
bool renderer_create(const struct renderer_params *params, struct renderer *out, struct err *err);
void renderer_finish(struct renderer *renderer); // accepts NULL and {0}

// Adds `samples` further samples to every pixel. When the progress asks to stop, ends after the
// wave in flight and sets *stopped; some pixels then have more samples than others, which the film
// knows, and the next call goes on there. `progress_from`, `progress_to`: the part of the whole
// that this call is.
struct render_call {
    uint64_t samples; // with tiles: rounds
    double progress_from, progress_to;
    bool *stopped; // may be NULL
    // Called after every wave, when the film and the renderer's state agree; may be NULL. False
    // ends the call as failed.
    bool (*after_wave)(void *context, struct err *err);
    // To look at what happens, kernel by kernel: see wave.h. Each is then submitted alone, which is
    // slow; the film stays the same. May be NULL.
    const struct wave_observer *observer;
    void *context; // of after_wave
};
bool renderer_render(struct renderer *renderer, const struct render_call *call, struct err *err);
// Samples of every pixel that one wave holds where the picture is small, else the usual number of a
// pass: fewer at a time leave lanes idle.
uint64_t renderer_samples_at_once(const struct renderer *renderer);
// Returns whether every pixel has all samples up to next_sample, or of all rounds up to it, and no
// others.
bool renderer_is_even(const struct renderer *renderer);
// Returns whether every pixel of the film has a sample.
bool renderer_has_all_pixels(const struct renderer *renderer);

// Goes on with waves and workgroups of other sizes, and recompiles where need be: the film keeps
// what it has. plan.wave_slots tells whether the wave was lowered to what fits. A failure may leave
// the renderer without buffers, until another call succeeds.
bool renderer_resize(struct renderer *renderer, uint32_t wave, uint32_t workgroup, struct err *err);

// Opens the device again, which was lost, and makes all anew that was on it, with waves of at most
// `wave` paths. Nothing but the renderer may have been on it. The film is empty; see film_copy.h.
// On failure the renderer can only be finished.
bool renderer_reopen(struct renderer *renderer, uint32_t wave, struct err *err);

// Empties the film; the sample numbers go on, so that what follows is independent of what was.
bool renderer_clear(struct renderer *renderer, struct err *err);
// Another number of samples a pixel than the settings' is planned, as samplers and half-buffers
// need to know it (sampling_plan.h); 0: none. To be followed by renderer_restart(), since the
// samples so far were planned otherwise.
void renderer_plan_samples(struct renderer *renderer, uint64_t samples);
// Empties the film and begins anew with sample 0 of another seed: what a new renderer would do, but
// without building and compiling anything. stats.nonfinite begins anew, too: it is about the film's
// samples; the other statistics are of the renderer's work and go on.
bool renderer_restart(struct renderer *renderer, uint32_t seed, struct err *err);

// Empties the film and begins anew with sample 0, another camera (copied) and another size of the
// picture, without building and compiling anything: the picture is the one that a new renderer
// would make. Sets *fits to false and does nothing where only a new renderer can: for more pixels
// than it was created for, another kind of camera, a lens that was not there, a camera that is far,
// spheres that become large where the camera is, or cease to be, and with tiles.
bool renderer_set_camera(struct renderer *renderer, const struct camera *camera, uint32_t width,
                         uint32_t height, bool *fits, struct err *err);

// Means of the half-buffers and counts, pixels in rows from the top.
struct film_image {
    uint32_t width, height;
    float (*mean)[3];   // of all samples
    float (*half_a)[3]; // of the even samples
    float (*half_b)[3]; // of the odd ones; (0,0,0) with one sample
    uint32_t *samples;
    uint64_t least_samples, most_samples; // a pixel
    uint64_t unsampled;                   // pixels without a sample
    uint64_t dropped;                     // samples with a non-finite contribution left out
    struct film_aovs aovs;
};
bool renderer_read(struct renderer *renderer, struct arena *arena, struct film_image *out,
                   struct err *err);

#endif
