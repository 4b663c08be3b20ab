// Runs the measurements. All variants run in turn, with the same samples in each repetition.
#include "cli/bench/bench.h"

#include "base/clock.h"
#include "base/hash.h"
#include "base/system.h"
#include "cli/scene_options.h"
#include "render/wave.h"
#include "shared/aov.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

// The default number of samples per pixel in a repetition.
#define BENCH_SPP 4

// --- variants ------------------------------------------------------------------------------------

static bool open_variant(struct bench *b, struct bench_variant *v, struct err *err)
{
    uint64_t start = clock_ns();
    uint32_t camera;
    const struct options *options = &v->variant.options;
    const struct progress *progress = options->progress;
    if (!options_load_scene(&options->scene, progress, &v->scene_data, &camera, err))
        return false;
    v->load_seconds = clock_seconds_since(start);
    const struct job_params params = {
        .renderer = options_renderer_params(&options->device, &b->gpu, &v->scene_data, camera),
        .scene = &v->scene_data,
        .goal.samples =
            options_given(options, OPTION_SPP) ? options->scene.settings.spp : BENCH_SPP,
        .progress = progress,
    };
    return job_start(&params, &v->job, err) ||
           (*v->variant.label && err_prepend(err, "%s", v->variant.label));
}

bool bench_prepare(struct bench *b, struct err *err)
{
    struct variant *variants;
    b->repeats = b->options->bench.repeats;
    b->load = system_load();
    if (!variants_make(b->options, &b->arena, &variants, &b->variant_count, err))
        return false;
    b->variants = ARENA_NEW(&b->arena, struct bench_variant, b->variant_count);
    if (!b->variants)
        return err_memory(err, "variants", b->variant_count * sizeof *b->variants);
    for (uint32_t i = 0; i < b->variant_count; i++)
        b->variants[i].variant = variants[i];
    uint64_t start = clock_ns();
    if (!gpu_open(&b->options->device.gpu, &b->gpu, err))
        return false;
    b->seconds.device = clock_seconds_since(start);
    start = clock_ns();
    for (uint32_t i = 0; i < b->variant_count; i++)
        if (!open_variant(b, &b->variants[i], err))
            return false;
    b->seconds.start = clock_seconds_since(start);
    return true;
}

void bench_finish(struct bench *b)
{
    for (uint32_t i = 0; b->variants && i < b->variant_count; i++) {
        job_finish(&b->variants[i].job);
        scene_finish(&b->variants[i].scene_data);
    }
    json_decref(b->baseline);
    gpu_close(&b->gpu);
    arena_finish(&b->arena);
}

uint32_t bench_turn(uint32_t round, uint32_t n, uint32_t variants)
{
    uint32_t turned = (n + round / 2) % variants;
    return round % 2 ? variants - 1 - turned : turned;
}

static double *make_times(struct bench *b, struct err *err)
{
    double *ms = ARENA_NEW(&b->arena, double, b->repeats);
    if (!ms)
        err_memory(err, "times", b->repeats * sizeof *ms);
    return ms;
}

struct bench_row *bench_rows_create(struct bench *b, uint32_t count, struct err *err)
{
    struct bench_row *rows = ARENA_NEW(&b->arena, struct bench_row, count);
    if (!rows) {
        err_memory(err, "rows", count * sizeof *rows);
        return NULL;
    }
    for (uint32_t i = 0; i < count; i++) {
        rows[i].bytes = NAN;
        rows[i].ms = make_times(b, err);
        if (!rows[i].ms)
            return NULL;
    }
    return rows;
}

// --- counting ------------------------------------------------------------------------------------

// The work of the kernels, counted in a repetition whose time is not reported.
struct census {
    struct bench_variant *v;
    // Numbers of entries in the queues of rays and shadow rays before the current kernel.
    uint64_t rays_before, shadow_before;
    double bytes[KERNEL_COUNT];
    uint64_t steps[STEPS_COUNT];
};

static bool is_shading(enum kernel_id kernel)
{
    return kernel >= KERNEL_shade_miss && kernel <= KERNEL_shade_whitted;
}

// Returns the least number of bytes that are read and written for an item: records of paths, rays
// and queues, but not of the scene. The rays and the queue entries that shading and intersection
// produce are counted separately, by their number.
double bench_bytes_read(const struct renderer *r, enum kernel_id kernel)
{
    const double queue = 4.0, word = 16.0;
    const uint32_t slot_words = AOV_SLOT_WORDS(r->specialization.aovs);
    switch (kernel) {
    case KERNEL_generate_light_rays: // writes everything except the hit, and weights
        return 4.0 * word + queue;
    case KERNEL_intersect_camera:
    case KERNEL_add_splats:
        return queue + (double)sizeof(struct gpu_shadow_ray);
    case KERNEL_generate_rays: // the whole record except for the hit
        return 3.0 * word + word * slot_words + queue;
    case KERNEL_intersect_closest: // reads origin and direction
        return queue + 2.0 * word;
    case KERNEL_intersect_shadow:
        return queue + (double)sizeof(struct gpu_shadow_ray);
    case KERNEL_shade_miss: // reads direction and throughput; adds to the radiance
        return queue + 4.0 * word;
    case KERNEL_shade_ao:
        return queue + 3.0 * word;
    case KERNEL_sort_count: // reads origin and direction; writes the key
        return queue + 3.0 * word;
    case KERNEL_sort_scan: // negligible per ray: reads and writes counters only
        return 0.0;
    case KERNEL_sort_scatter: // reads the key
        return 2.0 * queue + word;
    default:
        return queue + (double)sizeof(struct gpu_path);
    }
}

// Returns the bytes of shadow rays that a vertex writes into its slot.
static double bytes_of_shadow_rays(const struct renderer *r, uint32_t bounce)
{
    double others = (double)wave_shadow_launches(r, bounce + 1) - 1.0;
    return 4.0 + (double)sizeof(struct gpu_shadow_ray) + 16.0 * fmax(others, 0.0);
}

static uint64_t count_items(const struct renderer *r, const struct wave_step *step)
{
    switch (step->kernel) {
    case KERNEL_generate_rays:
        return (uint64_t)r->push.pixel_count << r->push.sample_shift;
    case KERNEL_intersect_closest:
    case KERNEL_intersect_shadow:
    case KERNEL_sort_count:
    case KERNEL_sort_scan:
    case KERNEL_sort_scatter:
        return r->counters->dispatch[step->queue * DISPATCH_PARTS].items;
    default:
        return r->counters->queue[step->queue].count;
    }
}

static bool count_step(void *context, const struct wave_step *step, struct err *err)
{
    (void)err;
    struct census *c = context;
    const struct renderer *r = &c->v->job.renderer;
    uint32_t bounce = step->bounce - (step->kernel == KERNEL_intersect_shadow);
    if (bounce >= STATS_BOUNCES)
        bounce = STATS_BOUNCES - 1;
    uint64_t items = count_items(r, step);
    c->v->bounces[bounce].items[step->kernel] += items;
    if (items > 0 && bounce >= c->v->bounce_count)
        c->v->bounce_count = bounce + 1;

    double *bytes = &c->bytes[step->kernel];
    *bytes += (double)items * bench_bytes_read(r, step->kernel);
    uint64_t rays = r->counters->queue[QUEUE_RAYS + (~step->bounce & 1u)].count;
    uint64_t shadow = r->counters->queue[QUEUE_SHADOW].count;
    if (is_shading(step->kernel)) {
        *bytes += (double)(rays - c->rays_before) * (4.0 + 3.0 * 16.0);
        *bytes += (double)(shadow - c->shadow_before) * bytes_of_shadow_rays(r, step->bounce);
    } else if (step->kernel == KERNEL_intersect_closest) {
        for (uint32_t q = QUEUE_SURFACE; q < QUEUE_MISS; q++)
            *bytes += (16.0 + 4.0) * r->counters->queue[q].count;
        *bytes += 4.0 * r->counters->queue[QUEUE_MISS].count;
    }
    c->rays_before = rays;
    c->shadow_before = shadow;
    return true;
}

static bool count_wave(void *context, struct err *err)
{
    (void)err;
    struct census *c = context;
    const struct renderer *r = &c->v->job.renderer;
    uint64_t pixels = r->push.pixel_count;
    c->v->bounces[0].items[KERNEL_accumulate] += pixels;
    c->bytes[KERNEL_accumulate] += (double)pixels * (2.0 * (double)sizeof(struct gpu_film_pixel) +
                                                     16.0 * (double)(1u << r->push.sample_shift));
    return true;
}

// --- rows ----------------------------------------------------------------------------------------

static const char *const host_names[] = {"recording", "submitting", "reading back", "other"};
#define HOST_ROWS (sizeof host_names / sizeof host_names[0])

// Returns whether a kernel runs during rendering. Resolving the film comes afterwards.
static bool runs(const struct bench_variant *v, int kernel)
{
    return v->job.renderer.kernels[kernel].pipeline && kernel != KERNEL_resolve;
}

static bool make_rows(struct bench *b, struct bench_variant *v, const struct census *census,
                      struct err *err)
{
    uint32_t kernels = 0;
    for (int k = 0; k < KERNEL_COUNT; k++)
        kernels += runs(v, k);
    v->row_count = kernels + HOST_ROWS + 1;
    v->rows = bench_rows_create(b, v->row_count, err);
    if (!v->rows)
        return false;
    struct bench_row *row = v->rows;
    for (int k = 0; k < KERNEL_COUNT; k++) {
        if (!runs(v, k))
            continue;
        row->kind = BENCH_KERNEL;
        row->kernel = (enum kernel_id)k;
        row->name = v->job.renderer.kernels[k].name;
        for (uint32_t bounce = 0; bounce < STATS_BOUNCES; bounce++)
            row->items += v->bounces[bounce].items[k];
        row->bytes = census->bytes[k] > 0 ? census->bytes[k] : NAN;
        if (k == KERNEL_intersect_closest || k == KERNEL_intersect_shadow) {
            const uint64_t *steps =
                census->steps + (k == KERNEL_intersect_shadow ? STEPS_SHADOW : STEPS_CLOSEST);
            row->nodes = steps[0];
            row->primitives = steps[1];
        }
        row++;
    }
    for (uint32_t i = 0; i < HOST_ROWS; i++, row++) {
        row->kind = BENCH_HOST;
        row->name = host_names[i];
    }
    row->kind = BENCH_WALL;
    row->name = "repetition";
    row->items = v->paths;
    return true;
}

static bool make_bounces(struct bench *b, struct bench_variant *v, struct err *err)
{
    v->bounces = ARENA_NEW(&b->arena, struct bench_bounce, STATS_BOUNCES);
    if (!v->bounces)
        return err_memory(err, "bounces", STATS_BOUNCES * sizeof *v->bounces);
    for (uint32_t bounce = 0; bounce < STATS_BOUNCES; bounce++)
        for (int k = 0; k < KERNEL_COUNT; k++) {
            double **ms = &v->bounces[bounce].ms[k];
            if (runs(v, k) && !(*ms = make_times(b, err)))
                return false;
        }
    return true;
}

// --- repetitions ---------------------------------------------------------------------------------

static bool hash_picture(struct bench *b, struct bench_variant *v, uint64_t *hash, struct err *err)
{
    uint64_t start = clock_ns();
    const struct film_image *film = &v->job.film;
    bool ok = job_fetch_film(&v->job, err);
    if (ok)
        *hash = hash_bytes(HASH_INIT, film->mean,
                           (size_t)film->width * film->height * sizeof *film->mean);
    b->seconds.pictures += clock_seconds_since(start);
    return ok;
}

// Returns whether to stop. This is checked separately, because a render of a single wave ends
// before it could be stopped.
static bool should_stop(struct bench *b)
{
    b->stopped |= progress_should_stop(b->options->progress);
    return b->stopped;
}

// Runs a repetition: all samples of the variant, from the first one.
static bool repeat(struct bench *b, struct bench_variant *v, struct job_step step, double *ms,
                   struct err *err)
{
    const struct settings *settings = &v->scene_data.settings;
    step.samples = settings->spp;
    *ms = 0.0;
    if (should_stop(b))
        return true;
    if (!job_begin(&v->job, settings->seed, settings->spp, err))
        return false;
    uint64_t start = clock_ns();
    bool ok = job_advance(&v->job, &step, err);
    *ms = (double)(clock_ns() - start) * 1e-6;
    b->stopped |= v->job.stopped;
    return ok;
}

// Stores the times of a repetition, which are the increases of the renderer's statistics, in the
// rows.
static void keep_times(const struct bench *b, struct bench_variant *v, uint32_t round,
                       const struct render_stats *before, double wall_ms)
{
    const struct render_stats *now = &v->job.renderer.stats;
    const double host[HOST_ROWS] = {
        now->host.recording - before->host.recording,
        now->host.submitting - before->host.submitting,
        now->host.reading_back - before->host.reading_back,
        0.0,
    };
    double rest = wall_ms;
    uint32_t host_row = 0;
    for (uint32_t i = 0; i < v->row_count; i++) {
        struct bench_row *row = &v->rows[i];
        double *ms = &row->ms[round];
        if (row->kind == BENCH_KERNEL) {
            const struct kernel_stats *stats = &now->kernels[row->kernel];
            double sum = stats->ms - before->kernels[row->kernel].ms;
            *ms = b->gpu.has_timestamps ? sum : NAN;
            row->launches = stats->launches - before->kernels[row->kernel].launches;
            rest -= sum;
        } else if (row->kind == BENCH_HOST && host_row + 1 < HOST_ROWS) {
            *ms = host[host_row++];
            rest -= *ms;
        } else {
            *ms = row->kind == BENCH_HOST ? rest : wall_ms;
        }
    }
    for (uint32_t bounce = 0; bounce < STATS_BOUNCES; bounce++)
        for (int k = 0; k < KERNEL_COUNT; k++)
            if (v->bounces[bounce].ms[k])
                v->bounces[bounce].ms[k][round] =
                    b->gpu.has_timestamps ? now->bounce_ms[bounce][k] - before->bounce_ms[bounce][k]
                                          : NAN;
}

// Runs a repetition to warm up, and one that counts. They also adapt the renderer to the scene's
// rays.
static bool warm_up(struct bench *b, struct bench_variant *v, struct job_step step, struct err *err)
{
    struct census census = {.v = v};
    const struct wave_observer observer = {.after = count_step, .context = &census};
    double ms, to = step.to;
    step.to = 0.5 * (step.from + to);
    if (!make_bounces(b, v, err) || !repeat(b, v, step, &v->warm_up_ms, err))
        return false;
    b->seconds.warm_up += v->warm_up_ms * 1e-3;
    uint64_t start = clock_ns();
    const struct render_stats before = v->job.renderer.stats;
    step.from = step.to;
    step.to = to;
    step.observer = &observer;
    if (b->stopped)
        return true;
    const struct job_listener listener = {.after_wave = count_wave, .context = &census};
    job_set_listener(&v->job, &listener);
    if (!job_count_steps(&v->job, true, err) || !repeat(b, v, step, &ms, err) ||
        !job_count_steps(&v->job, false, err))
        return false;
    job_set_listener(&v->job, NULL);
    b->seconds.counting += clock_seconds_since(start);
    v->closest_rays = v->job.renderer.stats.closest_rays - before.closest_rays;
    v->shadow_rays = v->job.renderer.stats.shadow_rays - before.shadow_rays;
    v->paths = v->job.renderer.stats.paths - before.paths;
    for (int i = 0; i < STEPS_COUNT; i++)
        census.steps[i] = v->job.renderer.stats.steps[i] - before.steps[i];
    return b->stopped || (make_rows(b, v, &census, err) && hash_picture(b, v, &v->image_hash, err));
}

static bool measure_once(struct bench *b, struct bench_variant *v, uint32_t round,
                         struct job_step step, struct err *err)
{
    const struct render_stats before = v->job.renderer.stats;
    double wall_ms;
    uint64_t hash;
    if (!repeat(b, v, step, &wall_ms, err))
        return false;
    if (b->stopped)
        return true;
    keep_times(b, v, round, &before, wall_ms);
    b->seconds.timed += wall_ms * 1e-3;
    if (!hash_picture(b, v, &hash, err))
        return false;
    v->differs |= hash != v->image_hash;
    return true;
}

bool bench_measure(struct bench *b, struct err *err)
{
    double all = (double)(b->repeats + 1) * b->variant_count, done = 0;
    for (uint32_t i = 0; i < b->variant_count && !should_stop(b); i++, done++) {
        const struct job_step step = {.from = done / all, .to = (done + 1) / all};
        if (!warm_up(b, &b->variants[i], step, err))
            return false;
    }
    for (uint32_t round = 0; round < b->repeats && !b->stopped; round++) {
        for (uint32_t n = 0; n < b->variant_count && !should_stop(b); n++, done++) {
            struct bench_variant *v = &b->variants[bench_turn(round, n, b->variant_count)];
            const struct job_step step = {.from = done / all, .to = (done + 1) / all};
            if (!measure_once(b, v, round, step, err))
                return false;
        }
        if (!b->stopped)
            b->repeats_done = round + 1;
    }
    return true;
}
