// Option --kernel: measures a single kernel on the queues that it gets in a render.
#include "cli/bench/bench.h"

#include "base/log.h"
#include "base/suggest.h"
#include "render/probe/kernel_recording.h"
#include <math.h>
#include <stdio.h>
#include <string.h>

static const char *const kernel_names[KERNEL_COUNT] = {
#define X(name) #name,
    KERNEL_LIST(X)
#undef X
};
// Indexed by enum rays_option.
static const char *const rays_names[] = {"primary", "diffuse", "shadow"};
#define ALL_KINDS (sizeof rays_names / sizeof rays_names[0])

// --- rows to measure -----------------------------------------------------------------------------

// A row that is measured for each variant.
struct target {
    enum kernel_id kernel;
    const char *rays; // kind of rays; NULL for kernels that trace no rays
    uint32_t depth;
};

struct targets {
    struct target *list;
    uint32_t count;
};

static bool find_kernel(const char *name, enum kernel_id *out, struct err *err)
{
    struct suggestion suggestion = {.wanted = name};
    for (int id = 0; id < KERNEL_COUNT; id++) {
        *out = (enum kernel_id)id;
        if (strcmp(kernel_names[id], name) == 0)
            return true;
        suggest_offer(&suggestion, kernel_names[id]);
    }
    char list[400] = "";
    for (size_t id = 0, end = 0; id < KERNEL_COUNT; id++)
        end += (size_t)snprintf(list + end, sizeof list - end, "%s%s", id ? ", " : "",
                                kernel_names[id]);
    return suggestion.nearest
               ? err_set(err, ERR_USAGE,
                         "--kernel %s: there is no such kernel; did you mean \"%s\"?", name,
                         suggestion.nearest)
               : err_set(err, ERR_USAGE, "--kernel %s: there is no such kernel; expected one of %s",
                         name, list);
}

static bool is_traced(enum kernel_id kernel)
{
    return kernel == KERNEL_intersect_closest || kernel == KERNEL_intersect_shadow;
}

// Returns whether a kernel runs once per wave, and so has no depth.
static bool has_no_depth(enum kernel_id kernel)
{
    return kernel == KERNEL_generate_rays || kernel == KERNEL_accumulate ||
           kernel == KERNEL_resolve;
}

static void add(struct targets *out, const struct target *target)
{
    for (uint32_t i = 0; i < out->count; i++)
        if (out->list[i].kernel == target->kernel && out->list[i].depth == target->depth)
            return; // the option names the row twice
    out->list[out->count++] = *target;
}

// Adds rows for one kind of rays: camera rays have depth 0, scattered rays greater depths.
static bool add_rays(const struct bench_options *options, enum rays_option kind,
                     struct targets *out, struct err *err)
{
    const uint32_t usual = kind == RAYS_DIFFUSE ? 1 : 0;
    const uint32_t *depths = options->depths ? options->depths : &usual;
    uint32_t count = options->depths ? options->depth_count : 1, before = out->count;
    for (uint32_t i = 0; i < count; i++) {
        if ((kind == RAYS_PRIMARY && depths[i] > 0) || (kind == RAYS_DIFFUSE && depths[i] == 0))
            continue;
        add(out,
            &(struct target){
                .kernel = kind == RAYS_SHADOW ? KERNEL_intersect_shadow : KERNEL_intersect_closest,
                .rays = rays_names[kind],
                .depth = depths[i],
            });
    }
    return out->count > before || !options->rays ||
           err_set(err, ERR_USAGE, "--rays %s: expected a --depth of %s", rays_names[kind],
                   kind == RAYS_PRIMARY ? "0" : "1 or more");
}

static bool add_depths(const struct bench_options *options, enum kernel_id kernel,
                       struct targets *out, struct err *err)
{
    const uint32_t none = 0;
    const uint32_t *depths = options->depths ? options->depths : &none;
    if (options->rays)
        return err_set(err, ERR_USAGE,
                       "--rays: the kernel %s traces no rays; expected --kernel intersect_closest "
                       "or intersect_shadow",
                       kernel_names[kernel]);
    if (options->depths && has_no_depth(kernel))
        return err_set(err, ERR_USAGE,
                       "--depth: the kernel %s runs once for all bounces, so it has no depth",
                       kernel_names[kernel]);
    for (uint32_t i = 0; i < (options->depths ? options->depth_count : 1); i++)
        add(out, &(struct target){.kernel = kernel, .depth = depths[i]});
    return true;
}

static bool plan(const struct bench_options *options, struct arena *arena, struct targets *out,
                 struct err *err)
{
    enum kernel_id kernel;
    uint32_t most = (options->depth_count + 1) * (uint32_t)ALL_KINDS;
    *out = (struct targets){.list = ARENA_NEW(arena, struct target, most)};
    if (!out->list)
        return err_memory(err, "kernels to time", most * sizeof *out->list);
    if (!find_kernel(options->kernel, &kernel, err))
        return false;
    if (!is_traced(kernel))
        return add_depths(options, kernel, out, err);
    // The kind of rays determines which of the two intersection kernels traces them.
    uint32_t usual = kernel == KERNEL_intersect_shadow ? 1u << RAYS_SHADOW
                                                       : 1u << RAYS_PRIMARY | 1u << RAYS_DIFFUSE;
    uint32_t kinds = options->rays ? options->rays : usual;
    for (uint32_t kind = 0; kind < ALL_KINDS; kind++)
        if ((kinds >> kind & 1u) && !add_rays(options, (enum rays_option)kind, out, err))
            return false;
    return true;
}

bool bench_check_kernel(const struct bench_options *options, struct err *err)
{
    struct arena arena = {0};
    struct targets targets;
    bool ok = plan(options, &arena, &targets, err);
    arena_finish(&arena);
    return ok;
}

// --- timing --------------------------------------------------------------------------------------

// The measurement of one target for all variants.
struct contest {
    struct bench *b;
    const struct target *target;
    uint32_t index;                    // index of the row in each variant
    struct kernel_recording *recorded; // one per variant
    double from, to; // the range of the total progress that this measurement takes
};

static bool fail(const struct contest *c, const struct bench_variant *v, struct err *err)
{
    bool labelled = *v->variant.label;
    return err_prepend(err, "%s%s%s: %s", v->scene_data.path, labelled ? ", " : "",
                       v->variant.label, kernel_names[c->target->kernel]);
}

// Returns the bytes of the rays that are read, and of the entries that are written to the queues of
// hits and misses.
static double bytes_traced(const struct renderer *r, const struct bench_row *row)
{
    double bytes = (double)row->items * bench_bytes_read(r, row->kernel);
    for (uint32_t q = QUEUE_SURFACE; q <= QUEUE_MISS && row->kernel == KERNEL_intersect_closest;
         q++)
        bytes += (q == QUEUE_MISS ? 4.0 : 4.0 + 16.0) * r->counters->queue[q].count;
    return bytes;
}

// Records the queues of a kernel. If the variant does not use the kernel, the row remains empty.
static bool record(struct contest *c, uint32_t variant, struct err *err)
{
    struct bench_variant *v = &c->b->variants[variant];
    struct bench_row *row = &v->rows[c->index];
    struct kernel_recording *recorded = &c->recorded[variant];
    const struct kernel_recording_params params = {
        .kernel = c->target->kernel,
        .depth = c->target->depth,
        .samples = v->scene_data.settings.spp,
    };
    bool is_first = v == bench_first(c->b, v); // the first variant represents all in messages
    double ms;
    if (!v->job.renderer.kernels[params.kernel].pipeline) {
        if (is_first)
            log_warn("the kernel %s is not used to render %s", kernel_names[params.kernel],
                     v->scene_data.path);
        return true;
    }
    if (!job_record_kernel(&v->job, &params, recorded, err))
        return fail(c, v, err);
    row->items = recorded->items;
    row->launches = recorded->launches;
    if (recorded->items == 0) {
        if (is_first)
            log_warn("%s: the kernel %s gets no items at depth %u", v->scene_data.path,
                     kernel_names[params.kernel], params.depth);
        return true;
    }
    if (is_traced(params.kernel) &&
        !kernel_recording_count_steps(recorded, &row->nodes, &row->primitives, err))
        return fail(c, v, err);
    if (!kernel_recording_run(recorded, &ms, err)) // a run to warm up
        return fail(c, v, err);
    if (is_traced(params.kernel))
        row->bytes = bytes_traced(&v->job.renderer, row);
    return true;
}

static bool is_stopped(struct bench *b)
{
    b->stopped |= progress_should_stop(b->options->progress);
    return b->stopped;
}

static bool run_rounds(struct contest *c, struct err *err)
{
    struct bench *b = c->b;
    for (uint32_t round = 0; round < b->repeats; round++) {
        progress_report(b->options->progress, "Timing",
                        c->from + (c->to - c->from) * round / b->repeats);
        for (uint32_t n = 0; n < b->variant_count; n++) {
            uint32_t i = bench_turn(round, n, b->variant_count);
            struct bench_variant *v = &b->variants[i];
            if (is_stopped(b))
                return true;
            if (c->recorded[i].items > 0 &&
                !kernel_recording_run(&c->recorded[i], &v->rows[c->index].ms[round], err))
                return fail(c, v, err);
        }
    }
    return true;
}

static bool run_target(struct contest *c, struct err *err)
{
    struct bench *b = c->b;
    struct err ignored = {0};
    bool ok = true;
    memset(c->recorded, 0, b->variant_count * sizeof *c->recorded);
    for (uint32_t i = 0; i < b->variant_count && ok && !is_stopped(b); i++)
        ok = record(c, i, err);
    ok = ok && run_rounds(c, err);
    for (uint32_t i = 0; i < b->variant_count; i++)
        ok &= kernel_recording_finish(&c->recorded[i], ok ? err : &ignored);
    return ok;
}

static bool make_rows(struct bench *b, struct bench_variant *v, const struct targets *targets,
                      struct err *err)
{
    v->row_count = targets->count;
    v->rows = bench_rows_create(b, targets->count, err);
    for (uint32_t i = 0; v->rows && i < targets->count; i++) {
        const struct target *t = &targets->list[i];
        struct bench_row *row = &v->rows[i];
        row->kind = BENCH_ALONE;
        row->kernel = t->kernel;
        row->rays = t->rays;
        row->depth = t->depth;
        row->name = has_no_depth(t->kernel)
                        ? kernel_names[t->kernel]
                        : arena_printf(&b->arena, "%s%s%s %u", kernel_names[t->kernel],
                                       t->rays ? " " : "", t->rays ? t->rays : "", t->depth);
        if (!row->name)
            return err_memory(err, "rows", targets->count * sizeof *row);
        for (uint32_t r = 0; r < b->repeats; r++)
            row->ms[r] = NAN;
    }
    return v->rows;
}

// Checks that each kernel is used by at least one variant.
static bool check_there(const struct bench *b, const struct targets *targets, struct err *err)
{
    for (uint32_t t = 0; t < targets->count; t++) {
        bool there = false;
        for (uint32_t i = 0; i < b->variant_count; i++)
            there |= b->variants[i].job.renderer.kernels[targets->list[t].kernel].pipeline != NULL;
        if (!there)
            return err_set(err, ERR_USAGE,
                           "the kernel %s is not used to render %s; \"lampyris bench\" without "
                           "--kernel lists the kernels that are",
                           kernel_names[targets->list[t].kernel], b->variants[0].scene_data.path);
    }
    return true;
}

// Discards incomplete rows after a signal.
static void end_early(struct bench *b, uint32_t complete)
{
    b->repeats_done = complete > 0 ? b->repeats : 0;
    for (uint32_t i = 0; i < b->variant_count; i++)
        b->variants[i].row_count = complete;
}

bool bench_measure_kernel(struct bench *b, struct err *err)
{
    struct targets targets;
    if (!plan(&b->options->bench, &b->arena, &targets, err) || !check_there(b, &targets, err))
        return false;
    for (uint32_t i = 0; i < b->variant_count; i++)
        if (!make_rows(b, &b->variants[i], &targets, err))
            return false;
    struct contest c = {.b = b};
    c.recorded = ARENA_NEW(&b->arena, struct kernel_recording, b->variant_count);
    if (!c.recorded)
        return err_memory(err, "states", b->variant_count * sizeof *c.recorded);
    for (c.index = 0; c.index < targets.count; c.index++) {
        c.target = &targets.list[c.index];
        c.from = (double)c.index / targets.count;
        c.to = (c.index + 1.0) / targets.count;
        if (!run_target(&c, err))
            return false;
        if (b->stopped) {
            end_early(b, c.index);
            return true;
        }
    }
    b->repeats_done = b->repeats;
    return true;
}
