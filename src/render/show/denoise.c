#include "render/show/denoise.h"

#include "base/maths.h"
#include "base/memory.h"
#include "render/show/denoise_view.h"
#include "render/show/paced.h"
#include "shared/aov.h"
#include <stdlib.h>
#include <string.h>

#include "denoise_blend.spv.h"
#include "denoise_finish.spv.h"
#include "denoise_gather.spv.h"
#include "denoise_variance.spv.h"
#include "denoise_wavelet.spv.h"

#define WORD_BYTES 16u // bytes that a pixel takes in each buffer

// The buffers of one view. They become the history of the next view.
struct layers {
    struct gpu_buffer guides, blended, records;
};

enum kernel {
    GATHER,
    GATHER_LIGHT,
    GATHER_PICTURE,
    BLEND,
    BLEND_HISTORY,
    BLEND_COMPARED,
    BLEND_CHECKED,
    VARIANCE,
    WAVELET,
    WAVELET_LAST,
    WAVELET_LINEAR,
    FINISH,
    KERNELS
};
_Static_assert((int)KERNELS <= (int)PACE_KERNELS, "each has a pace");

struct denoiser_state {
    struct paced paced;
    struct gpu_buffer frame; // struct gpu_denoise
    // The kernels and their specialization constants.
    struct gpu_kernel kernels[KERNELS];
    bool has_kernels, texel;
    uint32_t aovs;
    // Number of pixels that the buffers have room for.
    uint64_t capacity;
    struct layers layers[2];
    uint32_t now;               // index in `layers` of the current film's view
    struct gpu_buffer light[2]; // the passes read one and write the other
    struct gpu_buffer modulation, emission;
    struct gpu_bindings bindings[2][2]; // indexed by `now`, and by the index of the light that is
                                        // read
    // The camera of the history.
    struct camera camera;
    uint32_t width, height, seed;
};

#define CODE(name) "denoise_" #name, denoise_##name##_spirv, sizeof denoise_##name##_spirv
static const struct code {
    const char *name;
    const uint32_t *spirv;
    size_t bytes;
    enum denoise_pass pass; // the pass to which the kernel's time is attributed
    uint32_t history, wavelet, gather;
} codes[KERNELS] = {
    [GATHER] = {CODE(gather), DENOISE_PASS_gather, .gather = DENOISE_GATHER_ALL},
    [GATHER_LIGHT] = {CODE(gather), DENOISE_PASS_gather, .gather = DENOISE_GATHER_LIGHT},
    [GATHER_PICTURE] = {CODE(gather), DENOISE_PASS_gather, .gather = DENOISE_GATHER_PICTURE},
    [BLEND] = {CODE(blend), DENOISE_PASS_blend},
    [BLEND_HISTORY] = {CODE(blend), DENOISE_PASS_blend, DENOISE_HISTORY_MIXED},
    [BLEND_COMPARED] = {CODE(blend), DENOISE_PASS_blend, DENOISE_HISTORY_COMPARED},
    [BLEND_CHECKED] = {CODE(blend), DENOISE_PASS_blend, DENOISE_HISTORY_CHECKED},
    [VARIANCE] = {CODE(variance), DENOISE_PASS_variance},
    [WAVELET] = {CODE(wavelet), DENOISE_PASS_wavelet},
    [WAVELET_LAST] = {CODE(wavelet), DENOISE_PASS_wavelet, .wavelet = DENOISE_WAVELET_LAST},
    [WAVELET_LINEAR] = {CODE(wavelet), DENOISE_PASS_blend, .wavelet = DENOISE_WAVELET_LINEAR},
    [FINISH] = {CODE(finish), DENOISE_PASS_finish},
};

// --- objects created once ------------------------------------------------------------------------

bool denoiser_create(struct gpu *gpu, struct denoiser *out, struct err *err)
{
    *out = (struct denoiser){.gpu = gpu, .own = calloc(1, sizeof *out->own)};
    if (!out->own)
        return err_memory(err, "denoiser", sizeof *out->own);
    if (paced_create(gpu, &out->own->paced, err) &&
        gpu_buffer_create(gpu, "denoiser's frame", sizeof(struct gpu_denoise), GPU_DEVICE, false,
                          &out->own->frame, err))
        return true;
    denoiser_finish(out);
    return false;
}

static void finish_kernels(struct denoiser *d)
{
    for (int i = 0; i < KERNELS; i++)
        gpu_kernel_finish(d->gpu, &d->own->kernels[i]);
    d->own->has_kernels = false;
}

// Returns whether inputs are gathered by two kernels. One kernel would bind more storage buffers
// than Vulkan guarantees, unless images are read as texels; no other kernel binds so many.
static bool gathers_in_two(const struct denoiser *d)
{
    return d->gpu->storage_count < DENOISE_GATHER_STORAGE;
}

static bool needs_kernel(const struct denoiser *d, int kernel)
{
    bool is_half = kernel == GATHER_LIGHT || kernel == GATHER_PICTURE;
    return kernel == GATHER ? !gathers_in_two(d) : !is_half || gathers_in_two(d);
}

static bool prepare_kernels(struct denoiser *d, const struct renderer *r, struct err *err)
{
    struct denoiser_state *own = d->own;
    // The renderer has one of these features if the device should read texels.
    const uint32_t texels = FEATURE_TEXEL_STATE | FEATURE_TEXEL_SCENE;
    bool texel =
        (r->specialization.features & texels) != 0 && own->light[0].texel_view != VK_NULL_HANDLE;
    if (own->has_kernels && own->texel == texel && own->aovs == r->specialization.aovs)
        return true;
    finish_kernels(d);
    for (int i = 0; i < KERNELS; i++) {
        if (!needs_kernel(d, i))
            continue;
        const uint32_t constants[DENOISE_CONSTANT_COUNT] = {
            [DENOISE_CONSTANT_TEXEL] = texel,
            [DENOISE_CONSTANT_AOVS] = r->specialization.aovs,
            [DENOISE_CONSTANT_WAVELET] = codes[i].wavelet,
            [DENOISE_CONSTANT_HISTORY] = codes[i].history,
            [DENOISE_CONSTANT_GATHER] = codes[i].gather,
        };
        const struct gpu_kernel_params params = {
            .name = codes[i].name,
            .spirv = codes[i].spirv,
            .spirv_bytes = codes[i].bytes,
            .constants = constants,
            .constant_count = DENOISE_CONSTANT_COUNT,
        };
        if (!gpu_kernel_create(d->gpu, &params, &own->kernels[i], err))
            return false;
    }
    own->has_kernels = true;
    own->texel = texel;
    own->aovs = r->specialization.aovs;
    return true;
}

// --- buffers that grow with the image ------------------------------------------------------------

static void finish_layers(struct gpu *gpu, struct layers *layers)
{
    gpu_buffer_finish(gpu, &layers->guides);
    gpu_buffer_finish(gpu, &layers->blended);
    gpu_buffer_finish(gpu, &layers->records);
}

static void finish_buffers(struct denoiser *d)
{
    struct denoiser_state *own = d->own;
    for (int i = 0; i < 4; i++)
        gpu_bindings_finish(d->gpu, &own->bindings[i >> 1][i & 1]);
    for (int i = 0; i < 2; i++) {
        finish_layers(d->gpu, &own->layers[i]);
        gpu_buffer_finish(d->gpu, &own->light[i]);
    }
    gpu_buffer_finish(d->gpu, &own->modulation);
    gpu_buffer_finish(d->gpu, &own->emission);
    gpu_buffer_finish(d->gpu, &d->picture);
    own->capacity = 0;
}

void denoiser_finish(struct denoiser *denoiser)
{
    if (denoiser && denoiser->own) {
        finish_kernels(denoiser);
        finish_buffers(denoiser);
        gpu_buffer_finish(denoiser->gpu, &denoiser->own->frame);
        paced_finish(&denoiser->own->paced);
        free(denoiser->own);
        *denoiser = (struct denoiser){0};
    }
}

static bool create_layers(struct gpu *gpu, uint64_t bytes, bool texel, struct layers *out,
                          struct err *err)
{
    return gpu_buffer_create(gpu, "denoiser's guides", bytes, GPU_DEVICE, texel, &out->guides,
                             err) &&
           gpu_buffer_create(gpu, "denoiser's blended light", bytes, GPU_DEVICE, texel,
                             &out->blended, err) &&
           gpu_buffer_create(gpu, "denoiser's records", bytes, GPU_DEVICE, texel, &out->records,
                             err);
}

// Fills a descriptor set with all buffers: with layers[now] as the current view, and light[from] as
// the light to read.
static bool bind(const struct denoiser *d, uint32_t now, uint32_t from,
                 const struct gpu_buffer *film, struct gpu_bindings *out, struct err *err)
{
    const struct denoiser_state *own = d->own;
    const struct layers *layers = &own->layers[now], *history = &own->layers[1 - now];
    const struct gpu_buffer *const buffers[DENOISE_BINDINGS] = {
        [DENOISE_FILM] = film,
        [DENOISE_GUIDES] = &layers->guides,
        [DENOISE_GUIDES_HISTORY] = &history->guides,
        [DENOISE_BLENDED] = &layers->blended,
        [DENOISE_BLENDED_HISTORY] = &history->blended,
        [DENOISE_RECORDS] = &layers->records,
        [DENOISE_RECORDS_HISTORY] = &history->records,
        [DENOISE_FROM] = &own->light[from],
        [DENOISE_TO] = &own->light[1 - from],
        [DENOISE_MODULATION] = &own->modulation,
        [DENOISE_PICTURE] = &d->picture,
        [DENOISE_EMISSION] = &own->emission,
    };
    struct gpu_binding storage[GPU_MAX_STORAGE] = {0};
    const struct gpu_buffer *texels[GPU_MAX_TEXEL] = {0};
    for (int i = 0; i < DENOISE_BINDINGS; i++) {
        storage[i].buffer = buffers[i];
        if (i != DENOISE_FILM && buffers[i]->texel_view)
            texels[i] = buffers[i];
    }
    return gpu_bindings_create(d->gpu, storage, texels, &own->frame, out, err);
}

static bool create_buffers(struct denoiser *d, uint64_t pixels, struct err *err)
{
    struct denoiser_state *own = d->own;
    uint64_t bytes = pixels * WORD_BYTES;
    bool texel = gpu_texel_fits(d->gpu, bytes);
    for (int i = 0; i < 2; i++)
        if (!create_layers(d->gpu, bytes, texel, &own->layers[i], err) ||
            !gpu_buffer_create(d->gpu, "denoiser's light", bytes, GPU_DEVICE, texel, &own->light[i],
                               err))
            return false;
    if (!gpu_buffer_create(d->gpu, "denoiser's albedo", bytes, GPU_DEVICE, texel, &own->modulation,
                           err) ||
        !gpu_buffer_create(d->gpu, "denoiser's emission", bytes, GPU_DEVICE, texel, &own->emission,
                           err) ||
        !gpu_buffer_create(d->gpu, "denoised picture", bytes, GPU_DEVICE, texel, &d->picture, err))
        return false;
    for (uint32_t i = 0; i < 4; i++)
        if (!bind(d, i >> 1, i & 1, NULL, &own->bindings[i >> 1][i & 1], err))
            return false;
    own->capacity = pixels;
    return true;
}

static bool copy_history(struct denoiser *d, const struct layers *from, const struct layers *to,
                         struct err *err)
{
    uint64_t bytes = (uint64_t)d->own->width * d->own->height * WORD_BYTES;
    struct gpu_commands *commands = &d->own->paced.commands;
    if (!paced_begin(&d->own->paced, err))
        return false;
    gpu_copy(d->gpu, commands, &from->guides, 0, &to->guides, 0, bytes);
    gpu_copy(d->gpu, commands, &from->blended, 0, &to->blended, 0, bytes);
    gpu_copy(d->gpu, commands, &from->records, 0, &to->records, 0, bytes);
    gpu_barrier(d->gpu, commands);
    return paced_end(&d->own->paced, err);
}

// Makes room for an image. If buffers grow, the history is copied.
static bool prepare_buffers(struct denoiser *d, uint32_t width, uint32_t height, struct err *err)
{
    struct denoiser_state *own = d->own;
    uint64_t pixels = (uint64_t)width * height;
    if (pixels <= own->capacity)
        return true;
    if (pixels * WORD_BYTES > d->gpu->max_storage_range)
        return err_set(err, ERR_GPU,
                       "a denoised preview of %u x %u pixels takes buffers of %s; expected at most "
                       "%s, the device's limit (maxStorageBufferRange)",
                       width, height, memory_print(pixels * WORD_BYTES).text,
                       memory_print(d->gpu->max_storage_range).text);
    struct layers history = {0};
    uint32_t was = 1 - own->now;
    if (d->has_history) {
        history = own->layers[was];
        own->layers[was] = (struct layers){0};
    }
    finish_buffers(d);
    bool ok = create_buffers(d, pixels, err) &&
              (!d->has_history || copy_history(d, &history, &own->layers[was], err));
    finish_layers(d->gpu, &history);
    if (!ok)
        finish_buffers(d);
    d->has_history = d->has_history && ok;
    return ok;
}

// --- one call ------------------------------------------------------------------------------------

static bool check(const struct denoise_call *call, struct err *err)
{
    if (call->motion_count > DENOISE_MOTIONS_MAX)
        return err_set(err, ERR_BUG, "%u objects moved; expected at most %u", call->motion_count,
                       DENOISE_MOTIONS_MAX);
    if (call->iterations > DENOISE_LEVELS)
        return err_set(err, ERR_USAGE, "%u levels of the denoiser's wavelet; expected 1 to %u",
                       call->iterations, DENOISE_LEVELS);
    uint32_t missing = DENOISE_AOVS & ~call->renderer->specialization.aovs;
    if (missing != 0)
        return err_set(err, ERR_BUG,
                       "the denoiser's renderer lacks layers 0x%x; expected all of 0x%x", missing,
                       DENOISE_AOVS);
    return true;
}

static bool uses_history(const struct denoiser *d, const struct denoise_call *call)
{
    return d->has_history && call->temporal;
}

// Sets a row of an affine map between positions relative to `origin`, from a map in world space.
static void set_row(const double map[3][4], int row, const double origin[3], float out[3],
                    float *at)
{
    *at = (float)(vec3_dot(map[row], origin) + map[row][3] - origin[row]);
    for (int c = 0; c < 3; c++)
        out[c] = (float)map[row][c];
}

static void set_motion(const struct denoise_motion *motion, const double origin[3],
                       struct gpu_denoise_motion *out)
{
    set_row(motion->to_past, 0, origin, out->past_x, &out->past_x_at);
    set_row(motion->to_past, 1, origin, out->past_y, &out->past_y_at);
    set_row(motion->to_past, 2, origin, out->past_z, &out->past_z_at);
    out->first_primitive = motion->first_primitive;
    out->primitive_count = motion->primitive_count;
    out->instance = motion->instance == NO_INSTANCE ? 0 : motion->instance + 1;
}

static bool upload_frame(struct denoiser *d, const struct denoise_call *call, struct err *err)
{
    const struct gpu_frame *film = &call->renderer->frame;
    struct gpu_denoise frame = {
        .halves = call->renderer->specialization.halves,
        .first_half = film->samples - film->samples / 2,
    };
    const double *origin = call->camera->position;
    denoise_view_fill(call->camera, film->width, film->height, origin, &frame.now);
    while (frame.motion_count < call->motion_count) {
        uint32_t i = frame.motion_count++;
        set_motion(&call->motions[i], origin, &frame.motions[i]);
    }
    frame.repeats = film->seed == d->own->seed;
    if (uses_history(d, call))
        denoise_view_fill(&d->own->camera, d->own->width, d->own->height, origin, &frame.history);
    return gpu_upload(d->gpu, &d->own->frame, 0, &frame, sizeof frame, err);
}

static bool dispatch(struct denoiser *d, enum kernel kernel, struct gpu_bindings *bindings,
                     struct gpu_denoise_push push, uint64_t groups, struct err *err)
{
    const struct paced_work work = {
        .number = kernel,
        .kernel = &d->own->kernels[kernel],
        .bindings = bindings,
        .push = &push,
        .push_bytes = sizeof push,
        .first = &push.first_group,
        .first_unit = 1,
        .groups = groups,
        .workgroup = DENOISE_WORKGROUP,
    };
    return paced_dispatch(&d->own->paced, &work, err);
}

// Dispatches a kernel over the whole image; it reads light[from].
static bool dispatch_picture(struct denoiser *d, enum kernel kernel, uint32_t from, uint32_t step,
                             struct err *err)
{
    uint64_t across = (d->width + DENOISE_TILE - 1) / DENOISE_TILE;
    uint64_t down = (d->height + DENOISE_TILE - 1) / DENOISE_TILE;
    return dispatch(d, kernel, &d->own->bindings[d->own->now][from],
                    (struct gpu_denoise_push){.step = step}, across * down, err);
}

static uint64_t chunk_pixels(const struct renderer *r, uint32_t chunk)
{
    uint64_t first = chunk * r->plan.film_chunk_pixels;
    uint64_t pixels = (uint64_t)r->frame.width * r->frame.height;
    uint64_t left = pixels > first ? pixels - first : 0;
    return left < r->plan.film_chunk_pixels ? left : r->plan.film_chunk_pixels;
}

static bool gather_by(struct denoiser *d, enum kernel kernel, const struct renderer *r,
                      struct gpu_bindings *films, struct err *err)
{
    for (uint32_t chunk = 0; chunk < r->plan.film_chunks; chunk++) {
        uint64_t pixels = chunk_pixels(r, chunk);
        const struct gpu_denoise_push push = {
            .first_pixel = (uint32_t)(chunk * r->plan.film_chunk_pixels),
            .pixel_count = (uint32_t)pixels,
        };
        uint64_t groups = (pixels + DENOISE_WORKGROUP - 1) / DENOISE_WORKGROUP;
        if (!dispatch(d, kernel, &films[chunk], push, groups, err))
            return false;
    }
    return true;
}

// Writes the light of the film to light[0].
static bool gather(struct denoiser *d, const struct renderer *r, struct gpu_bindings *films,
                   struct err *err)
{
    if (!gathers_in_two(d))
        return gather_by(d, GATHER, r, films, err);
    return gather_by(d, GATHER_LIGHT, r, films, err) && gather_by(d, GATHER_PICTURE, r, films, err);
}

// Writes the difference between history and film to light[1], and once more the light of the film
// to light[0], which the wavelet filter has overwritten.
static bool compare(struct denoiser *d, const struct renderer *r, struct gpu_bindings *films,
                    struct err *err)
{
    if (!dispatch_picture(d, BLEND_COMPARED, 0, 0, err))
        return false;
    for (uint32_t level = 0; level < DENOISE_COMPARED_LEVELS; level++)
        if (!dispatch_picture(d, WAVELET_LINEAR, 1 - level % 2, 1u << level, err))
            return false;
    return gather(d, r, films, err);
}

static bool blend(struct denoiser *d, const struct denoise_call *call, struct gpu_bindings *films,
                  struct err *err)
{
    enum kernel kernel = BLEND;
    if (uses_history(d, call))
        kernel = call->has_changed ? BLEND_CHECKED : BLEND_HISTORY;
    if (kernel == BLEND_CHECKED && !compare(d, call->renderer, films, err))
        return false;
    return dispatch_picture(d, kernel, 0, 0, err);
}

// Filters light[1], which the variance pass has written. The image is complete afterwards.
static bool filter(struct denoiser *d, uint32_t levels, struct err *err)
{
    uint32_t from = 1;
    if (!dispatch_picture(d, VARIANCE, 0, 0, err))
        return false;
    for (uint32_t level = 0; level < levels; level++, from = 1 - from)
        if (!dispatch_picture(d, level + 1 < levels ? WAVELET : WAVELET_LAST, from, 1u << level,
                              err))
            return false;
    return dispatch_picture(d, FINISH, from, 0, err);
}

static void add_times(struct denoiser *d)
{
    memset(d->pass_ms, 0, sizeof d->pass_ms);
    d->ms = 0.0;
    for (int i = 0; i < KERNELS; i++) {
        double ms = d->own->paced.ns[i] * 1e-6;
        d->pass_ms[codes[i].pass] += ms;
        d->ms += ms;
    }
}

static bool work(struct denoiser *d, const struct denoise_call *call, bool filtered,
                 struct gpu_bindings *films, struct err *err)
{
    uint32_t levels = call->iterations ? call->iterations : DENOISE_LEVELS;
    bool ok = paced_begin(&d->own->paced, err) && gather(d, call->renderer, films, err) &&
              blend(d, call, films, err) && (!filtered || filter(d, levels, err)) &&
              paced_end(&d->own->paced, err);
    if (ok)
        add_times(d);
    return ok;
}

// Runs all passes. The renderer may have recreated the film's buffers since the last call, so the
// descriptor sets that bind them are only used in this call.
static bool process(struct denoiser *d, const struct denoise_call *call, bool filtered,
                    struct err *err)
{
    const struct renderer *r = call->renderer;
    if (!check(call, err) || !prepare_buffers(d, r->frame.width, r->frame.height, err) ||
        !prepare_kernels(d, r, err) || !upload_frame(d, call, err))
        return false;
    d->width = r->frame.width;
    d->height = r->frame.height;
    struct gpu_bindings *films = calloc(r->plan.film_chunks, sizeof *films);
    if (!films)
        return err_memory(err, "denoiser", r->plan.film_chunks * sizeof *films);
    bool ok = true;
    for (uint32_t i = 0; i < r->plan.film_chunks && ok; i++)
        ok = bind(d, d->own->now, 1, &r->film[i], &films[i], err);
    ok = ok && work(d, call, filtered, films, err);
    for (uint32_t i = 0; i < r->plan.film_chunks; i++)
        gpu_bindings_finish(d->gpu, &films[i]);
    free(films);
    return ok;
}

bool denoiser_run(struct denoiser *denoiser, const struct denoise_call *call, struct err *err)
{
    return process(denoiser, call, true, err);
}

bool denoiser_keep(struct denoiser *denoiser, const struct denoise_call *call, struct err *err)
{
    struct gpu_film_pixel first; // the first pixel, which gets a sample before all others
    if (!gpu_download(denoiser->gpu, &call->renderer->film[0], 0, &first, sizeof first, err))
        return false;
    if (first.samples == 0)
        return true;
    if (!process(denoiser, call, false, err))
        return false;
    struct denoiser_state *own = denoiser->own;
    own->now = 1 - own->now;
    own->camera = *call->camera;
    own->width = denoiser->width;
    own->height = denoiser->height;
    own->seed = call->renderer->frame.seed;
    denoiser->has_history = true;
    return true;
}

void denoiser_forget(struct denoiser *denoiser)
{
    denoiser->has_history = false;
}
