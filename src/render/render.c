#include "render/render.h"

#include "base/clock.h"
#include "base/log.h"
#include "flatten/geometry.h"
#include "flatten/large_spheres.h"
#include "render/adaptive.h"
#include "render/chance.h"
#include "render/counters.h"
#include "render/far_camera.h"
#include "render/film.h"
#include "render/frame.h"
#include "render/light_paths.h"
#include "render/sampling_plan.h"
#include "render/tables/light_choice.h"
#include "render/upload.h"
#include "render/wave.h"
#include "shared/aov.h"
#include <math.h>
#include <string.h>

// --- creation ------------------------------------------------------------------------------------

// Plans memory. waves: the maximum number of waves in flight; 0: as many as suit the device.
static bool plan_waves(struct renderer *r, uint32_t wave, uint32_t waves, bool wave_is_wish,
                       struct err *err)
{
    struct memory_plan_params params = {
        .scene = r->scene,
        .flat = &r->flat,
        .bvh = &r->bvh,
        .specialization = &r->specialization,
        .tables = &r->tables,
        .gpu = r->gpu,
        .pixels = r->pixels,
        .wave = wave,
        .waves = waves,
        .wave_is_wish = wave_is_wish,
    };
    for (uint32_t b = 0; b < BINDING_COUNT; b++)
        params.replaced_bytes += r->buffers[b].bytes + r->other.buffers[b].bytes;
    for (uint32_t i = 0; r->film && i < r->plan.film_chunks; i++)
        params.replaced_bytes += r->film[i].bytes;
    return memory_plan_make(&params, &r->specialization, &r->plan, err);
}

static bool plan_memory(struct renderer *r, uint32_t wave, bool wave_is_wish, struct err *err)
{
    return plan_waves(r, wave, 0, wave_is_wish, err);
}

// Plans the first waves. If their size is tuned by measured speed, the plan reserves room for the
// largest size, as far as memory suffices. The size is not tuned for images with too few pixels to
// fill such a wave, nor with tiles.
static bool plan_first_memory(struct renderer *r, uint32_t wave, struct err *err)
{
    bool is_large = r->pixels >= WAVE_SIZE_MOST && !(r->specialization.features & FEATURE_TILES);
    r->tunes_wave = r->tunes_wave && wave == 0 && is_large && r->gpu->info.is_cpu;
    if (r->tunes_wave)
        return plan_memory(r, WAVE_SIZE_MOST << r->specialization.split_lobes, true, err);
    return plan_memory(r, wave, false, err);
}

static bool create_buffer(struct renderer *r, uint32_t binding, enum gpu_memory memory, bool texel,
                          struct err *err)
{
    const struct planned_buffer *plan = &r->plan.buffers[binding];
    gpu_buffer_finish(r->gpu, &r->buffers[binding]);
    return !plan->name || gpu_buffer_create(r->gpu, plan->name, plan->bytes, memory, texel,
                                            &r->buffers[binding], err);
}

// Binds a scene buffer that is longer than a storage range: its first range to its own binding, the
// others to the next bindings for parts.
static void bind_parts(const struct renderer *r, uint32_t binding, struct gpu_binding *storage,
                       uint32_t *next)
{
    const struct gpu_buffer *buffer = &r->buffers[binding];
    const uint64_t bytes = r->plan.part_bytes;
    storage[binding].bytes = bytes;
    for (uint32_t part = 1; part < r->plan.buffers[binding].parts; part++) {
        uint64_t left = buffer->bytes - part * bytes;
        storage[(*next)++] =
            (struct gpu_binding){buffer, part * bytes, left < bytes ? left : bytes};
    }
}

static bool create_bindings(struct renderer *r, struct err *err)
{
    struct gpu_binding storage[GPU_MAX_STORAGE] = {0};
    uint32_t next_part = GPU_FIRST_STORAGE;
    const struct gpu_buffer *texels[GPU_MAX_TEXEL] = {0};
    for (uint32_t b = 0; b < BINDING_COUNT; b++) {
        if (!r->buffers[b].handle)
            continue;
        // A buffer longer than a storage range is read as texels; its storage binding is then not
        // used.
        bool is_long = r->buffers[b].bytes > r->gpu->max_storage_range;
        storage[b] = (struct gpu_binding){
            .buffer = &r->buffers[b],
            .bytes = is_long ? r->gpu->max_storage_range : 0,
        };
        if (r->plan.buffers[b].parts > 1)
            bind_parts(r, b, storage, &next_part);
    }
    for (uint32_t b = 0; b < TEXEL_BINDING_COUNT; b++)
        if (r->buffers[b].texel_view)
            texels[b] = &r->buffers[b];
    for (uint32_t i = 0; i < r->plan.film_chunks; i++) {
        gpu_bindings_finish(r->gpu, &r->bindings[i]);
        storage[BINDING_FILM].buffer = &r->film[i];
        if (!gpu_bindings_create(r->gpu, storage, texels, &r->frame_buffer, &r->bindings[i], err))
            return false;
    }
    return true;
}

// Creates the buffers that one wave needs, and the descriptor sets that bind them.
static bool create_state_of_one(struct renderer *r, struct err *err)
{
    bool texel = r->specialization.features & FEATURE_TEXEL_STATE;
    return create_buffer(r, BINDING_PATHS, GPU_DEVICE, texel, err) &&
           create_buffer(r, BINDING_SHADOW_RAYS, GPU_DEVICE, texel, err) &&
           create_buffer(r, BINDING_RADIANCE, GPU_DEVICE, texel, err) &&
           create_buffer(r, BINDING_QUEUES, GPU_DEVICE, false, err) && counters_create(r, err) &&
           create_buffer(r, BINDING_SORT, GPU_DEVICE, false, err) &&
           create_buffer(r, BINDING_SUSPENDED, GPU_DEVICE, false, err) && create_bindings(r, err);
}

static void finish_other_wave(struct renderer *r)
{
    for (uint32_t b = 0; b < BINDING_COUNT; b++)
        gpu_buffer_finish(r->gpu, &r->other.buffers[b]);
    gpu_buffer_finish(r->gpu, &r->other.counters_copy);
    for (uint32_t i = 0; r->other.bindings && i < r->plan.film_chunks; i++)
        gpu_bindings_finish(r->gpu, &r->other.bindings[i]);
}

static bool create_other_wave(struct renderer *r, struct err *err)
{
    finish_other_wave(r);
    if (r->plan.waves < 2)
        return true;
    wave_exchange(r);
    bool ok = create_state_of_one(r, err);
    wave_exchange(r);
    return ok;
}

static bool create_wave_state(struct renderer *r, struct err *err)
{
    r->frame.wave_slots = r->plan.wave_slots;
    return frame_upload(r, err) && create_state_of_one(r, err) && create_other_wave(r, err);
}

// Plans waves that need less memory than the last plan: one in flight instead of two, then smaller
// ones. Returns false if no smaller plan exists.
static bool plan_less(struct renderer *r, struct err *err)
{
    uint32_t slots = r->plan.wave_slots;
    if (r->plan.waves > 1)
        return plan_waves(r, slots, 1, true, err);
    return plan_waves(r, slots / 2, 1, true, err) && r->plan.wave_slots < slots;
}

// Creates the objects of waves; if device memory runs out, tries again with smaller waves.
static bool create_fitting_wave_state(struct renderer *r, struct err *err)
{
    struct err failure = {0};
    const struct memory_plan wanted = r->plan;
    r->gpu->out_of_memory = false;
    while (!create_wave_state(r, &failure)) {
        finish_other_wave(r);
        if (!r->gpu->out_of_memory || !plan_less(r, &failure)) {
            if (err)
                *err = failure;
            return false;
        }
        r->gpu->out_of_memory = false;
    }
    if (r->plan.wave_slots < wanted.wave_slots || r->plan.waves < wanted.waves)
        log_warn("%s: continuing with waves of %u paths in place of %u%s; rendering is slower, the "
                 "picture is the same",
                 failure.msg, r->plan.wave_slots, wanted.wave_slots,
                 memory_plan_in_flight(&wanted));
    return true;
}

static bool upload(struct renderer *r, struct err *err)
{
    struct upload_params params = {
        .scene = r->scene,
        .flat = &r->flat,
        .bvh = &r->bvh,
        .specialization = &r->specialization,
        .plan = &r->plan,
        .tables = &r->tables,
        .progress = r->progress,
    };
    r->counters = ARENA_NEW(&r->arena, struct gpu_counters, 1);
    r->marks = ARENA_NEW(&r->arena, struct mark, GPU_MAX_TIMESTAMPS);
    r->bindings = ARENA_NEW(&r->arena, struct gpu_bindings, r->plan.film_chunks);
    r->other.counters = ARENA_NEW(&r->arena, struct gpu_counters, 1);
    r->other.bindings = ARENA_NEW(&r->arena, struct gpu_bindings, r->plan.film_chunks);
    if (!r->counters || !r->marks || !r->bindings || !r->other.counters || !r->other.bindings)
        return err_memory(err, "renderer", sizeof *r->counters);
    return upload_scene(r->gpu, &params, r->buffers, err) &&
           create_buffer(r, BINDING_RESOLVED, GPU_READBACK, false, err) && film_create(r, err) &&
           frame_create(r, err) && create_fitting_wave_state(r, err) &&
           gpu_commands_create(r->gpu, &r->commands, err);
}

static bool check_workgroup(const struct gpu *gpu, uint32_t workgroup, struct err *err)
{
    if (workgroup <= gpu->max_invocations && (workgroup & (workgroup - 1)) == 0)
        return true;
    return err_set(err, ERR_USAGE,
                   "a workgroup of %u threads; expected a power of two of at most %u, the device's "
                   "limit",
                   workgroup, gpu->max_invocations);
}

static bool check_split(const struct settings *settings, struct err *err)
{
    if (settings->split_lobes == 0 || settings->directions == DIRECTIONS_BSDF)
        return true;
    return err_set(err, ERR_INPUT,
                   "--split-lobes %u needs --directions bsdf, because \"%s\" samples no lobes; "
                   "expected --directions bsdf, or --split-lobes 0",
                   settings->split_lobes, directions_names[settings->directions]);
}

// Takes the caller's geometry if there is one, which costs this renderer no time; otherwise
// prepares geometry of its own.
static bool get_geometry(const struct renderer_params *params, struct renderer *r, struct err *err)
{
    const struct geometry_params own = {
        .scene = r->scene,
        .bvh = params->bvh,
        .instancing = params->instancing,
        .bvh_cache = params->bvh_cache,
        .progress = r->progress,
        .camera = &r->camera,
    };
    if (params->geometry) {
        r->flat = params->geometry->flat;
        r->bvh = params->geometry->bvh;
        return true;
    }
    uint64_t start = clock_ns();
    if (!geometry_prepare(&own, &r->arena, &r->flat, &r->bvh, err))
        return false;
    r->stats.bvh_seconds = r->bvh.stats.build_seconds;
    r->stats.flatten_seconds = clock_seconds_since(start) - r->stats.bvh_seconds;
    return true;
}

static bool check_light_paths(const struct renderer_params *params, const struct flat_scene *flat,
                              struct err *err)
{
    return light_paths_check(
        &(struct light_paths_params){.scene = params->scene,
                                     .flat = flat,
                                     .camera = &params->scene->cameras[params->camera],
                                     .aovs = params->aovs,
                                     .tiles = params->tiles,
                                     .has_window = params->window.width > 0},
        err);
}

static void choose_features(const struct renderer_params *params, struct renderer *r)
{
    r->large_spheres_anyway = has_large_spheres_anyway(&r->flat);
    r->specialization = specialize(&(struct specialize_params){
        .scene = r->scene,
        .flat = &r->flat,
        .bvh = &r->bvh,
        .gpu = r->gpu,
        .camera = &r->camera,
        .lamps = &r->lamps,
        .aovs = params->aovs,
        .workgroup = params->workgroup,
        .compile_all = params->compile_all,
        .merge_classes = params->merge_classes,
        .tiles = params->tiles,
        .has_window = params->window.width > 0,
    });
}

static bool find_lamps(struct renderer *r, struct err *err)
{
    const struct settings *settings = &r->scene->settings;
    return settings->integrator == INTEGRATOR_WHITTED || settings->integrator == INTEGRATOR_BIDIR ||
           !light_choice_asks_lamps(settings->light_choice) ||
           emitter_lamps_find(r->scene, &r->flat, &r->arena, &r->lamps, err);
}

static bool build_tables(struct renderer *r, struct err *err)
{
    const struct shading_tables_params tables = {
        .scene = r->scene,
        .flat = &r->flat,
        .bvh = &r->bvh,
        .camera = &r->camera,
        .light_choice = r->specialization.light_choice,
        .lamps = &r->lamps,
        .progress = r->progress,
    };
    if (!shading_tables_build(&tables, &r->arena, &r->tables, err))
        return false;
    r->brightest_by_chance =
        brightest_by_chance(r->scene, &r->flat, &r->specialization, &r->tables.emitters);
    return true;
}

bool renderer_check(const struct renderer_params *params, struct err *err)
{
    const struct flat_scene *flat = params->geometry ? &params->geometry->flat : NULL;
    return check_split(&params->scene->settings, err) && check_light_paths(params, flat, err);
}

bool renderer_prepare(const struct renderer_params *params, struct renderer *r, struct err *err)
{
    const struct settings *settings = &params->scene->settings;
    *r = (struct renderer){
        .gpu = params->gpu,
        .scene = params->scene,
        .camera = params->scene->cameras[params->camera],
        .window = params->window,
        .pixels = params->window.width > 0 ? (uint64_t)params->window.width * params->window.height
                                           : (uint64_t)settings->width * settings->height,
        .aovs = params->aovs,
        .why_path = params->why_path,
        .tunes_wave = params->tunes_wave,
        .kernel_set = params->kernels,
        .progress = params->progress,
    };
    if (!check_workgroup(r->gpu, params->workgroup, err) || !check_split(settings, err) ||
        !get_geometry(params, r, err) || !check_light_paths(params, &r->flat, err))
        goto fail;

    uint64_t start = clock_ns();
    far_camera_warn(&r->flat, &r->camera, settings->height);
    if (!find_lamps(r, err))
        goto fail;
    choose_features(params, r);
    if (!build_tables(r, err) || !plan_first_memory(r, params->wave, err))
        goto fail;
    frame_fill(r);
    sampling_plan(r, params->open_ended || params->tiles);
    r->stats.upload_seconds = clock_seconds_since(start);
    return true;

fail:
    renderer_finish(r);
    return false;
}

bool renderer_create(const struct renderer_params *params, struct renderer *r, struct err *err)
{
    if (!renderer_prepare(params, r, err))
        return false;
    uint64_t start = clock_ns();
    progress_report(r->progress, "Uploading", 0);
    if (!upload(r, err))
        goto fail;
    r->stats.upload_seconds += clock_seconds_since(start);

    start = clock_ns();
    if (!wave_compile(r, err))
        goto fail;
    r->stats.compile_seconds = clock_seconds_since(start);
    return true;

fail:
    renderer_finish(r);
    return false;
}

// Finishes all objects that are on the device.
static void finish_device_objects(struct renderer *r)
{
    gpu_commands_finish(r->gpu, &r->commands);
    for (int i = 0; i < KERNEL_COUNT; i++)
        gpu_kernel_finish(r->gpu, &r->kernels[i]);
    for (uint32_t i = 0; r->bindings && i < r->plan.film_chunks; i++)
        gpu_bindings_finish(r->gpu, &r->bindings[i]);
    finish_other_wave(r);
    film_finish(r);
    gpu_buffer_finish(r->gpu, &r->frame_buffer);
    counters_finish(r);
    for (uint32_t b = 0; b < BINDING_COUNT; b++)
        gpu_buffer_finish(r->gpu, &r->buffers[b]);
}

void renderer_finish(struct renderer *r)
{
    if (!r || !r->gpu)
        return;
    finish_device_objects(r);
    in_view_finish(&r->in_view);
    arena_finish(&r->arena);
    *r = (struct renderer){0};
}

bool renderer_reopen(struct renderer *r, uint32_t wave, struct err *err)
{
    finish_device_objects(r);
    return gpu_reopen(r->gpu, err) && plan_memory(r, wave, true, err) && upload(r, err) &&
           wave_compile(r, err);
}

// --- rendering -----------------------------------------------------------------------------------

// Lets a ray that exceeds its iteration budget be suspended. Until then, such a ray makes its wave
// void.
static bool enable_suspension(struct renderer *r, struct err *err)
{
    log_warn("some rays need more than %u steps through the BVH: continuing with "
             "suspended traversals; rendering is slower, the picture is the same",
             r->specialization.iteration_budget);
    specialization_suspend(&r->specialization);
    return plan_memory(r, r->plan.wave_slots, false, err) && create_fitting_wave_state(r, err) &&
           wave_compile(r, err);
}

bool renderer_resize(struct renderer *r, uint32_t wave, uint32_t workgroup, struct err *err)
{
    if (!check_workgroup(r->gpu, workgroup, err))
        return false;
    uint64_t resolved = r->buffers[BINDING_RESOLVED].bytes;
    r->tunes_wave = false;
    specialization_set_workgroup(&r->specialization, r->gpu, workgroup);
    if (!plan_memory(r, wave, true, err))
        return false;
    if (r->plan.buffers[BINDING_RESOLVED].bytes != resolved &&
        !create_buffer(r, BINDING_RESOLVED, GPU_READBACK, false, err))
        return false;
    return create_fitting_wave_state(r, err) && wave_compile(r, err);
}

static bool has_tiles(const struct renderer *r)
{
    return r->specialization.features & FEATURE_TILES;
}

// Returns the maximum number of samples in a wave of the current pass. A pass of more samples a
// pixel than 2^USUAL_SAMPLE_SHIFT is one wave.
static uint32_t pass_samples(const struct renderer *r)
{
    if (r->pass.shift > USUAL_SAMPLE_SHIFT)
        return r->plan.wave_samples;
    return r->pace.is_on ? pace_samples(&r->pace, &r->plan) : wave_size_samples(&r->wave_size);
}

// Fills a wave with the pixels of the pass from `pixel` on. A wave does not extend over two film
// buffers.
static bool fill_wave(struct renderer *r, uint64_t pixel, struct wave *wave, struct err *err)
{
    *wave = (struct wave){.sample_shift = r->pass.shift, .first_sample = r->next_sample};
    if (has_tiles(r))
        return tile_wave_fill(r, wave, err);
    const uint64_t first = (uint64_t)r->rows.first * r->frame.width, end = first + r->pass.length;
    pixel += first;
    wave->film_chunk = (uint32_t)(pixel / r->plan.film_chunk_pixels);
    uint64_t chunk_end = (wave->film_chunk + 1) * r->plan.film_chunk_pixels;
    uint64_t count = (chunk_end < end ? chunk_end : end) - pixel;
    uint64_t fits = pass_samples(r) >> r->pass.shift;
    wave->first_pixel = pixel;
    wave->pixel_count = (uint32_t)(count < fits ? count : fits);
    return true;
}

// The progress of a call, counted in samples of single pixels.
struct work {
    const struct render_call *call;
    double done, total;
};

static void report(struct renderer *r, struct work *work, const struct wave *wave)
{
    const struct render_call *call = work->call;
    work->done += (double)wave->pixel_count * (1u << wave->sample_shift);
    double part = work->total > 0.0 ? fmin(work->done / work->total, 1.0) : 1.0;
    progress_report(r->progress, "Rendering",
                    call->progress_from + part * (call->progress_to - call->progress_from));
}

static void end_pass(struct renderer *r)
{
    if (has_tiles(r))
        tile_pass_end(r);
    else
        r->next_sample += UINT64_C(1) << r->pass.shift;
    r->pass = (struct pass){0};
}

// Updates size tuning and pacing after a wave that began at time `start`, when the device had
// traced `rays` rays.
static void learn_from_wave(struct renderer *r, const struct wave *wave, uint64_t start,
                            double rays)
{
    uint64_t ns = clock_ns() - start;
    r->stats.render_seconds += (double)ns * 1e-9;
    wave_size_learn(&r->wave_size, (uint64_t)wave->pixel_count << wave->sample_shift,
                    render_stats_rays(&r->stats) - rays, (double)ns);
}

// Renders the next wave of the pass, and begins the following one if two may be in flight. The two
// waves have no pixel in common, so each pixel's samples are added in order.
static bool render_next(struct renderer *r, const struct render_call *call, struct wave *wave,
                        bool *voided, struct err *err)
{
    struct wave next;
    if (r->ahead.is_begun)
        *wave = r->ahead.wave;
    else if (!fill_wave(r, r->pass.position, wave, err))
        return false;
    uint64_t after = r->pass.position + wave->pixel_count;
    bool has_next =
        r->plan.waves > 1 && !call->observer && after < r->pass.length && !*call->stopped;
    if (has_next && !fill_wave(r, after, &next, err))
        return false;
    return wave_render(r, wave, has_next ? &next : NULL, call->observer, voided, err);
}

// A light path may contribute to any pixel, so all light paths of a pass belong to the film:
// without some of them the film would be too dark.
static bool must_end_pass(const struct renderer *r)
{
    return r->specialization.integrator == INTEGRATOR_BIDIR && r->pass.position > 0;
}

static bool run_pass(struct renderer *r, struct work *work, struct err *err)
{
    const struct render_call *call = work->call;
    uint64_t start = clock_ns();
    while (r->pass.position < r->pass.length &&
           (!*call->stopped || r->ahead.is_begun || must_end_pass(r))) {
        struct wave wave;
        bool voided = false;
        double rays = render_stats_rays(&r->stats);
        if (!render_next(r, call, &wave, &voided, err))
            return false;
        if (voided) {
            if (!enable_suspension(r, err))
                return false;
            if (r->pass.position > 0)
                continue;
            r->pass = (struct pass){0}; // begins the pass anew: waves may have become smaller
            return true;
        }
        r->pass.position += wave.pixel_count;
        learn_from_wave(r, &wave, start, rays);
        report(r, work, &wave);
        bool is_over = r->pass.position == r->pass.length;
        if (is_over)
            end_pass(r);
        if (call->after_wave && !call->after_wave(call->context, err))
            return false;
        if (is_over)
            return true;
        start = clock_ns();
        if (progress_should_stop(r->progress))
            *call->stopped = true;
    }
    return true;
}

static uint64_t pixels_of_rows(const struct renderer *r)
{
    return (uint64_t)r->frame.width * (r->rows.end - r->rows.first);
}

void renderer_set_rows(struct renderer *r, const struct film_rows *rows)
{
    if (rows->first == r->rows.first && rows->end == r->rows.end)
        return;
    r->rows = *rows;
    r->pass = (struct pass){0};
}

// Returns the exponent of the largest power-of-two number of samples with which all pixels fit into
// one wave; 0 also if not even one sample fits.
static uint32_t fitting_shift(const struct renderer *r)
{
    uint64_t samples = pace_samples(&r->pace, &r->plan) / pixels_of_rows(r);
    uint32_t shift = samples ? 63u - (uint32_t)__builtin_clzll(samples) : 0;
    uint32_t most = r->aovs & AOVS_BY ? MAX_SAMPLE_SHIFT_OF_CLASSES : MAX_SAMPLE_SHIFT;
    return shift < most ? shift : most;
}

// Returns the maximum shift of a pass. A pass of more than the usual number of samples is one wave,
// which is never interrupted; so a run that continues from a checkpoint may have any wave size.
static uint32_t largest_shift(const struct renderer *r)
{
    uint32_t fitting = fitting_shift(r);
    return fitting > USUAL_SAMPLE_SHIFT && r->plan.film_chunks == 1 ? fitting : USUAL_SAMPLE_SHIFT;
}

// Returns the shift of the next pass. The first pass is the shortest that fills its waves, so that
// every pixel has a sample soon.
static uint32_t choose_shift(const struct renderer *r, uint64_t samples_left)
{
    uint32_t shift = renderer_has_all_pixels(r) ? largest_shift(r) : fitting_shift(r);
    while (UINT64_C(1) << shift > samples_left || 1u << shift > pace_samples(&r->pace, &r->plan))
        shift--;
    return shift == 0 && r->takes_pairs && samples_left > 1 ? 1 : shift;
}

uint64_t renderer_samples_at_once(const struct renderer *r)
{
    return UINT64_C(1) << (has_tiles(r) ? USUAL_SAMPLE_SHIFT : largest_shift(r));
}

bool renderer_is_even(const struct renderer *r)
{
    return r->pass.length == 0 && (!has_tiles(r) || r->next_sample == r->round_target);
}

bool renderer_has_all_pixels(const struct renderer *r)
{
    return has_tiles(r) ? tiles_all_begun(r) : r->next_sample > r->emptied_at;
}

// Begins a pass towards sample number (or round) `end`, unless a pass is under way; returns false
// if nothing is left to do.
static bool begin_pass(struct renderer *r, uint64_t end)
{
    if (r->pass.length > 0)
        return true;
    if (has_tiles(r)) {
        if (r->round_target == r->next_sample)
            r->round_target = end;
        if (tile_pass_begin(r))
            return true;
        r->next_sample = r->round_target;
        return r->next_sample < end && begin_pass(r, end);
    }
    if (r->next_sample >= end)
        return false;
    r->pass = (struct pass){
        .shift = choose_shift(r, end - r->next_sample),
        .length = pixels_of_rows(r),
    };
    return true;
}

bool renderer_render(struct renderer *r, const struct render_call *call, struct err *err)
{
    bool stopped = false;
    struct render_call c = *call;
    if (!c.stopped)
        c.stopped = &stopped;
    if (!(c.progress_to > c.progress_from))
        c.progress_to = c.progress_from + 1.0;
    double pixels = (double)pixels_of_rows(r);
    struct work work = {
        .call = &c,
        .total = has_tiles(r) ? (double)tile_samples(r, c.samples) : pixels * (double)c.samples,
    };
    uint64_t end = r->next_sample + c.samples;
    if (!wave_forget_ahead(r, err)) // a wave begun by a call that failed
        return false;
    sampling_plan_check(r, c.samples);
    while (!*c.stopped && begin_pass(r, end)) {
        if (!run_pass(r, &work, err))
            return false;
        if (!*c.stopped && r->next_sample < end && progress_should_stop(r->progress))
            *c.stopped = true;
    }
    return true;
}
