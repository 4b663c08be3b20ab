#include "render/film.h"

#include "base/clock.h"
#include "render/frame.h"
#include "render/sampling_plan.h"
#include "shared/aov.h"

#include <math.h>
#include <string.h>

static uint64_t pixel_count(const struct renderer *r)
{
    return (uint64_t)r->frame.width * r->frame.height;
}

// Returns the number of film buffers that the image uses: all of them, unless the image is smaller
// than the film.
static uint32_t chunks_in_use(const struct renderer *r)
{
    return (uint32_t)((pixel_count(r) + r->plan.film_chunk_pixels - 1) / r->plan.film_chunk_pixels);
}

// Returns the number of pixels in one of the film's buffers.
static uint64_t chunk_pixels(const struct renderer *r, uint32_t chunk)
{
    uint64_t first = chunk * r->plan.film_chunk_pixels;
    uint64_t left = pixel_count(r) - first;
    return left < r->plan.film_chunk_pixels ? left : r->plan.film_chunk_pixels;
}

static uint64_t pixel_bytes(const struct renderer *r)
{
    return 16 * AOV_FILM_WORDS(r->specialization.aovs);
}

bool film_create(struct renderer *r, struct err *err)
{
    r->film = ARENA_NEW(&r->arena, struct gpu_buffer, r->plan.film_chunks);
    if (!r->film)
        return err_memory(err, "film", r->plan.film_chunks * sizeof *r->film);
    for (uint32_t i = 0; i < r->plan.film_chunks; i++) {
        uint64_t bytes = chunk_pixels(r, i) * pixel_bytes(r);
        // The viewer's kernels read the film as texels if the device permits.
        if (!gpu_buffer_create(r->gpu, binding_name(BINDING_FILM), bytes, GPU_DEVICE,
                               gpu_texel_fits(r->gpu, bytes), &r->film[i], err))
            return false;
    }
    return true;
}

void film_finish(struct renderer *r)
{
    for (uint32_t i = 0; r->film && i < r->plan.film_chunks; i++)
        gpu_buffer_finish(r->gpu, &r->film[i]);
}

bool renderer_clear(struct renderer *r, struct err *err)
{
    r->pass = (struct pass){0};
    r->emptied_at = r->next_sample;
    if (!gpu_begin(r->gpu, &r->commands, err))
        return false;
    for (uint32_t i = 0; i < chunks_in_use(r); i++)
        gpu_fill(r->gpu, &r->commands, &r->film[i], 0, chunk_pixels(r, i) * pixel_bytes(r), 0);
    gpu_barrier(r->gpu, &r->commands);
    return gpu_submit(r->gpu, &r->commands, err) && gpu_wait(r->gpu, &r->commands, err);
}

bool renderer_restart(struct renderer *r, uint32_t seed, struct err *err)
{
    r->frame.seed = seed;
    r->next_sample = r->round_target = 0;
    r->stats.nonfinite = (struct nonfinite_stats){0};
    if (r->tiles.done)
        memset(r->tiles.done, 0, r->tiles.count * sizeof *r->tiles.done);
    return frame_upload(r, err) && renderer_clear(r, err);
}

// Resolves `count` pixels from `first` of a chunk and copies them into the mapped buffer.
static bool resolve(struct renderer *r, uint32_t chunk, uint64_t first, uint32_t count,
                    struct err *err)
{
    uint32_t workgroup = r->specialization.workgroup;
    r->push.film_first_pixel = (uint32_t)(chunk * r->plan.film_chunk_pixels);
    r->push.first_pixel = (uint32_t)(r->push.film_first_pixel + first);
    r->push.pixel_count = count;
    r->push.first_item = 0;
    r->push.part_items = count;
    if (!gpu_begin(r->gpu, &r->commands, err))
        return false;
    gpu_bind(r->gpu, &r->commands, &r->bindings[chunk]);
    gpu_timestamp(r->gpu, &r->commands);
    gpu_push(r->gpu, &r->commands, &r->push, sizeof r->push);
    gpu_dispatch(r->gpu, &r->commands, &r->kernels[KERNEL_resolve],
                 (count + workgroup - 1) / workgroup);
    gpu_barrier(r->gpu, &r->commands);
    gpu_timestamp(r->gpu, &r->commands);
    double ns[GPU_MAX_TIMESTAMPS];
    uint64_t start = clock_ns();
    if (!gpu_submit(r->gpu, &r->commands, err) || !gpu_wait(r->gpu, &r->commands, err))
        return false;
    double waited_ns = (double)(clock_ns() - start);
    if (r->gpu->has_timestamps && !gpu_timestamps_ns(r->gpu, &r->commands, ns, err))
        return false;
    pace_learn(&r->pace, KERNEL_resolve, count, r->gpu->has_timestamps ? ns[1] - ns[0] : waited_ns);
    struct kernel_stats *stats = &r->stats.kernels[KERNEL_resolve];
    double ms = r->gpu->has_timestamps ? (ns[1] - ns[0]) * 1e-6 : 0.0;
    stats->launches++;
    stats->ms += ms;
    stats->longest_ms = ms > stats->longest_ms ? ms : stats->longest_ms;
    return true;
}

// Returns how many of a pixel's samples are in the first half-buffer, by the rule of
// lib/halves.glsl.
static uint32_t samples_of_first_half(const struct renderer *r, uint32_t samples)
{
    uint32_t planned = r->frame.samples - r->frame.samples / 2;
    if (halves_are_contiguous(r))
        return samples < planned ? samples : planned;
    return samples - samples / 2;
}

static void add_pixel(const struct renderer *r, struct film_image *image, uint64_t at,
                      const struct gpu_resolved_pixel *p)
{
    uint32_t samples_a = samples_of_first_half(r, p->samples);
    uint32_t samples_b = p->samples - samples_a;
    for (int c = 0; c < 3; c++) {
        double sum = (double)samples_a * p->mean_a[c] + (double)samples_b * p->mean_b[c];
        image->mean[at][c] = p->samples ? (float)(sum / p->samples) : 0.0f;
    }
    // The expected squared difference of the halves' means is the variance of one sample times (1 /
    // samples_a + 1 / samples_b).
    double share = (double)samples_a * samples_b / fmax((double)p->samples * p->samples, 1.0);
    for (int c = 0; c < 3 && image->aovs.variance; c++) {
        double difference = (double)p->mean_a[c] - (double)p->mean_b[c];
        bool known = samples_a > 0 && samples_b > 0;
        image->aovs.variance[at][c] = known ? (float)(difference * difference * share) : INFINITY;
    }
    memcpy(image->half_a[at], p->mean_a, sizeof p->mean_a);
    memcpy(image->half_b[at], p->mean_b, sizeof p->mean_b);
    image->samples[at] = p->samples;
    image->dropped += p->dropped;
    if (at < (uint64_t)image->rows.first * image->width ||
        at >= (uint64_t)image->rows.end * image->width)
        return;
    image->unsampled += p->samples == 0;
    if (p->samples < image->least_samples)
        image->least_samples = p->samples;
    if (p->samples > image->most_samples)
        image->most_samples = p->samples;
}

// Reads record i of the resolved records.
static void read_pixel(const struct renderer *r, const uint32_t (*words)[4], uint64_t i,
                       struct film_image *image)
{
    uint32_t device = r->specialization.aovs;
    uint64_t at = r->push.first_pixel + i;
    struct gpu_resolved_pixel pixel;
    words += i * AOV_RESOLVED_WORDS(device);
    memcpy(&pixel, words, sizeof pixel);
    add_pixel(r, image, at, &pixel);
    if (r->aovs)
        film_aovs_read(&image->aovs, at, words[RESOLVED_WORDS], device, &r->flat);
}

bool renderer_read(struct renderer *r, struct arena *arena, struct film_image *out, struct err *err)
{
    uint64_t pixels = pixel_count(r);
    *out = (struct film_image){
        .width = r->frame.width,
        .height = r->frame.height,
        .mean = arena_alloc(arena, pixels, sizeof *out->mean),
        .half_a = arena_alloc(arena, pixels, sizeof *out->half_a),
        .half_b = arena_alloc(arena, pixels, sizeof *out->half_b),
        .samples = ARENA_NEW(arena, uint32_t, pixels),
        .rows = r->rows,
        .least_samples = UINT64_MAX,
    };
    if (!out->mean || !out->half_a || !out->half_b || !out->samples)
        return err_memory(err, "image", pixels * (3 * sizeof *out->mean + 4));
    if (!film_aovs_allocate(r->aovs, pixels, arena, &out->aovs, err))
        return false;

    const struct gpu_buffer *resolved = &r->buffers[BINDING_RESOLVED];
    for (uint32_t chunk = 0; chunk < chunks_in_use(r); chunk++) {
        uint64_t step;
        for (uint64_t first = 0; first < chunk_pixels(r, chunk); first += step) {
            uint64_t left = chunk_pixels(r, chunk) - first;
            step = pace_items(&r->pace, KERNEL_resolve, (uint32_t)r->plan.resolve_pixels);
            uint64_t count = left < step ? left : step;
            if (!resolve(r, chunk, first, (uint32_t)count, err))
                return false;
            for (uint64_t i = 0; i < count; i++)
                read_pixel(r, (const uint32_t(*)[4])resolved->mapped, i, out);
        }
    }
    return true;
}
