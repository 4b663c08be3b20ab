// What a render reports: a summary for people, one JSON object for machines.
#include "json_out.h"
#include "render_bias.h"
#include "render_job.h"
#include "text_out.h"
#include <inttypes.h>
#include <stdio.h>
#include <string.h>
#include <sys/resource.h>

static double host_peak_bytes(void)
{
    struct rusage usage;
    return getrusage(RUSAGE_SELF, &usage) == 0 ? (double)usage.ru_maxrss * 1024.0 : 0.0;
}

static double total_rays(const struct render_stats *stats)
{
    return (double)stats->closest_rays + (double)stats->shadow_rays;
}

static double total_samples(const struct render_job *job)
{
    double sum = 0.0;
    uint64_t pixels = (uint64_t)job->film.width * job->film.height;
    for (uint64_t i = 0; i < pixels; i++)
        sum += job->film.samples[i];
    return sum;
}

static uint64_t nonfinite(const struct render_stats *stats)
{
    uint64_t sum = 0;
    for (int site = 0; site < SITE_COUNT; site++)
        sum += stats->nonfinite.count[site];
    return sum;
}

static const char *site_name(int site)
{
    static const char *const names[SITE_COUNT] = {
        [SITE_MISS] = "shade_miss: environment",
        [SITE_EMISSION] = "shade_surface: emission",
        [SITE_SHADOW] = "intersect_shadow: light connection",
        [SITE_THROUGHPUT] = "shade_surface: throughput",
    };
    return names[site];
}

const char *job_reproducing_command(struct render_job *job)
{
    const struct nonfinite_stats *stats = &job->renderer.stats.nonfinite;
    if (!stats->recorded)
        return NULL;
    return arena_printf(&job->arena, "%s --pixel %u,%u --sample %u", job->options->command_line,
                        stats->pixel % job->film.width, stats->pixel / job->film.width,
                        stats->sample);
}

// --- what was kept and left out
// -------------------------------------------------------------------

typedef void (*feature_fn)(void *context, bool kept, const char *kind, const char *name,
                           uint64_t bytes);

static void for_each_feature(const struct renderer *r, feature_fn fn, void *context)
{
    for (int bit = 0; bit < 32; bit++) {
        const char *name = feature_name(1u << bit);
        if (name)
            fn(context, r->specialization.features >> bit & 1u, "feature", name, 0);
    }
    for (int bit = 0; bit < 32; bit++) {
        const char *name = lobe_name(1u << bit);
        if (name)
            fn(context, r->specialization.lobes >> bit & 1u, "lobe", name, 0);
    }
    for (int bit = 0; bit < 32; bit++) {
        const char *name = emitter_name(1u << bit);
        if (name)
            fn(context, r->specialization.emitters >> bit & 1u, "emitter", name, 0);
    }
    for (int id = 0; id < KERNEL_COUNT; id++) {
        struct kernel_code code = kernel_code((enum kernel_id)id, r->gpu->has_ballot);
        fn(context, r->kernels[id].pipeline != VK_NULL_HANDLE, "kernel", code.name, 0);
    }
    for (uint32_t b = 0; b < BINDING_COUNT; b++) {
        const struct planned_buffer *plan = &r->plan.buffers[b];
        fn(context, plan->name, "buffer", binding_name(b),
           plan->name ? plan->bytes * plan->copies : plan->unneeded_bytes);
    }
}

struct left_out {
    const char *kind; // of the line that is being printed
    bool any;
};

static void print_left_out(void *context, bool kept, const char *kind, const char *name,
                           uint64_t bytes)
{
    struct left_out *line = context;
    if (kept)
        return;
    if (!line->kind || strcmp(kind, line->kind) != 0)
        printf("%s%-8s  %ss: %s", line->any ? "\n" : "", line->any ? "" : "left out", kind, name);
    else
        printf(", %s", name);
    if (bytes)
        printf(" (%.1f KiB)", (double)bytes / 1024.0);
    line->kind = kind;
    line->any = true;
}

struct feature_lists {
    json_t *kept, *left_out;
};

static void list_feature(void *context, bool kept, const char *kind, const char *name,
                         uint64_t bytes)
{
    struct feature_lists *lists = context;
    json_array_append_new(
        kept ? lists->kept : lists->left_out,
        json_pack("{s:s, s:s, s:I}", "kind", kind, "name", name, "bytes", (json_int_t)bytes));
}

// --- for people
// -----------------------------------------------------------------------------------

static void print_biases(const struct render_job *job)
{
    struct job_bias list[JOB_MAX_BIASES];
    uint32_t count = job_list_biases(job, list);
    for (uint32_t i = 0; i < count; i++)
        print_line("bias      ", list[i].text);
}

static json_t *biases_json(const struct render_job *job)
{
    struct job_bias list[JOB_MAX_BIASES];
    uint32_t count = job_list_biases(job, list);
    json_t *array = json_array();
    for (uint32_t i = 0; i < count; i++)
        json_array_append_new(array,
                              json_pack("{s:s, s:s}", "kind", list[i].kind, "text", list[i].text));
    return array;
}

static void print_error(const struct render_job *job)
{
    const struct half_error *e = &job->error;
    bool is_bound = job->renderer.specialization.halves == HALVES_CONTIGUOUS;
    if (e->known && job_shares_depths(job))
        printf("error     relMSE %.3g, without an interval: all pixels share their paths' depths "
               "(variance from half-buffers, blind to bias)\n",
               e->relmse);
    else if (e->known)
        printf(
            "error     relMSE %s%.3g, 95 %% interval %.3g to %.3g (variance from %shalf-buffers, "
            "blind to bias)\n",
            is_bound ? "at most " : "", e->relmse, e->ci_low, e->ci_high,
            is_bound ? "contiguous " : "");
    else
        printf("error     not yet known: %s\n", e->reason);
}

static void print_ending(const struct render_job *job)
{
    const struct error_look *look = job->looks + job->look_count - 1;
    if (job->look_count > 0 && look->error.known)
        printf("looks     %u; at the last, after %" PRIu64 " spp, the error is below %.3g with "
               "%.4g %% confidence, where %.3g was asked for\n",
               job->look_count, look->samples, look->error.ci_high, 100.0 * look->confidence,
               job->options->error);
    if (job->plan.counts)
        printf("adaptive  %u to %u samples for every %u, by a pilot of 16 besides\n",
               job->plan.least, job->plan.most, job->round_samples);
    if (job->options->checkpoint && job->has_checkpoint)
        printf("kept      %s, from which --resume goes on\n", job->options->checkpoint);
}

static void print_times(const struct render_job *job)
{
    const struct job_seconds *s = &job->seconds;
    const struct render_stats *stats = &job->renderer.stats;
    printf("time      %.3f s = load %.3f + BVH %.3f + upload %.3f + compile %.3f + render %.3f + "
           "write %.3f + other %.3f\n",
           s->total, s->load, s->bvh, s->upload, s->compile, s->render, s->write,
           s->total - s->load - s->bvh - s->upload - s->compile - s->render - s->write);
    printf("speed     %.3f Msamples/s, %.2f Mrays/s (%.1f M closest, %.1f M shadow)\n",
           total_samples(job) * 1e-6 / s->render, total_rays(stats) * 1e-6 / s->render,
           (double)stats->closest_rays * 1e-6, (double)stats->shadow_rays * 1e-6);
    double sum = 0.0;
    for (int id = 0; id < KERNEL_COUNT; id++)
        sum += stats->kernels[id].ms;
    if (sum <= 0.0)
        return;
    printf("kernels  ");
    for (int id = 0; id < KERNEL_COUNT; id++)
        if (stats->kernels[id].ms > 0.005 * sum)
            printf(" %s %.0f ms (%.0f %%)", kernel_code((enum kernel_id)id, true).name,
                   stats->kernels[id].ms, 100.0 * stats->kernels[id].ms / sum);
    putchar('\n');
}

static const char *const class_names[CLASS_COUNT] = {
    [CLASS_DIFFUSE] = "diffuse",
    [CLASS_PRINCIPLED] = "principled",
    [CLASS_TRANSMISSIVE] = "transmissive",
    [CLASS_CLASSICAL] = "classical",
};

static void print_classes(const struct renderer *r)
{
    if (!(r->specialization.features & FEATURE_CLASSES))
        return;
    printf("classes  ");
    for (int c = 0; c < (int)CLASS_COUNT; c++)
        if (r->specialization.class_lobes[c])
            printf(" %s %.1f M hits", class_names[c], (double)r->stats.surface_hits[c] * 1e-6);
    putchar('\n');
}

static json_t *classes_json(const struct renderer *r)
{
    bool sorted = r->specialization.features & FEATURE_CLASSES;
    json_t *classes = json_object();
    for (int c = 0; c < (int)CLASS_COUNT && sorted; c++)
        if (r->specialization.class_lobes[c])
            json_object_set_new(classes, class_names[c],
                                json_integer((json_int_t)r->stats.surface_hits[c]));
    return classes;
}

static uint64_t surface_hits(const struct render_stats *stats)
{
    uint64_t sum = 0;
    for (int c = 0; c < (int)CLASS_COUNT; c++)
        sum += stats->surface_hits[c];
    return sum;
}

static void print_nonfinite(const struct render_job *job)
{
    const struct nonfinite_stats *stats = &job->renderer.stats.nonfinite;
    for (int site = 0; site < SITE_COUNT; site++)
        if (stats->count[site])
            printf("dropped   %" PRIu64 " contributions that were not finite (%s)\n",
                   stats->count[site], site_name(site));
}

void job_print_summary(const struct render_job *job)
{
    const struct film_image *film = &job->film;
    printf("%s  %u x %u, %" PRIu64, job->scene.path, film->width, film->height,
           film->least_samples);
    if (film->most_samples != film->least_samples)
        printf(" to %" PRIu64, film->most_samples);
    printf(" spp, seed %u%s\n", job->scene.settings.seed,
           job->stopped                      ? ", stopped early"
           : job->ended_by == ENDED_BY_TIME  ? ", ended by --time"
           : job->ended_by == ENDED_BY_ERROR ? ", ended by --error"
                                             : "");
    printf("device    %s (%s)\n", job->gpu.info.name, job->gpu.info.kind);
    for (uint32_t i = 0; i < job->scene.note_count; i++)
        print_line("note      ", job->scene.notes[i]);
    const struct flat_scene *flat = &job->renderer.flat;
    if (flat->dropped_degenerate || flat->skipped_instances)
        printf("dropped   %u triangles without area, %u instances with a singular transform\n",
               flat->dropped_degenerate, flat->skipped_instances);
    print_error(job);
    print_biases(job);
    print_ending(job);
    print_times(job);
    print_classes(&job->renderer);
    print_nonfinite(job);
    if (job->renderer.stats.media_lost)
        printf("media     %" PRIu64
               " crossings of surfaces that are open, or nest deeper than four: "
               "what is inside is not certain there\n",
               job->renderer.stats.media_lost);
    printf("memory    %.1f MiB on the device, %.1f MiB on the host at its peak; wave of %u paths\n",
           (double)job->gpu.peak_bytes / 1048576.0, host_peak_bytes() / 1048576.0,
           job->renderer.plan.wave_slots);
    if (job->renderer.stats.suspended)
        printf("continued %" PRIu64 " traversals of more than %u steps\n",
               job->renderer.stats.suspended, job->renderer.specialization.iteration_budget);
    struct left_out left_out = {0};
    for_each_feature(&job->renderer, print_left_out, &left_out);
    puts(left_out.any ? "" : "left out  nothing");
    for (uint32_t i = 0; i < job->output_count; i++)
        printf("wrote     %s\n", job->outputs[i]);
}

// --- for machines
// ---------------------------------------------------------------------------------

static json_t *kernels_json(const struct renderer *r)
{
    json_t *kernels = json_object();
    for (int id = 0; id < KERNEL_COUNT; id++) {
        const struct kernel_stats *stats = &r->stats.kernels[id];
        if (r->kernels[id].pipeline)
            json_object_set_new(kernels, r->kernels[id].name,
                                json_pack("{s:f, s:I, s:f}", "ms", stats->ms, "launches",
                                          (json_int_t)stats->launches, "longest_ms",
                                          stats->longest_ms));
    }
    return kernels;
}

static json_t *error_json(const struct half_error *error, bool is_bound)
{
    if (!error->known)
        return json_pack("{s:n, s:n, s:n, s:s}", "relmse", "ci_low", "ci_high", "reason",
                         error->reason);
    // Without an interval null stands for its ends.
    return json_pack("{s:o, s:o, s:o, s:b}", "relmse", json_number(error->relmse), "ci_low",
                     json_number(error->ci_low), "ci_high", json_number(error->ci_high),
                     "upper_bound", is_bound);
}

static json_t *seconds_json(const struct job_seconds *s)
{
    return json_pack("{s:f, s:f, s:f, s:f, s:f, s:f, s:f}", "load", s->load, "bvh", s->bvh,
                     "upload", s->upload, "compile", s->compile, "render", s->render, "write",
                     s->write, "total", s->total);
}

static json_t *strings_json(const char *const *strings, uint32_t count)
{
    json_t *array = json_array();
    for (uint32_t i = 0; i < count; i++)
        json_array_append_new(array, json_words(strings[i]));
    return array;
}

static json_t *frames_json(const struct render_job *job)
{
    json_t *array = json_array();
    for (uint32_t i = 0; i < job->frame_count; i++)
        json_array_append_new(array, json_number(job->frames_ms[i]));
    return array;
}

static json_t *looks_json(const struct render_job *job)
{
    json_t *looks = json_array();
    for (uint32_t i = 0; i < job->look_count; i++) {
        const struct error_look *look = &job->looks[i];
        json_t *object = error_json(&look->error, false);
        json_object_set_new(object, "spp", json_integer((json_int_t)look->samples));
        json_object_set_new(object, "confidence", json_number(look->confidence));
        json_array_append_new(looks, object);
    }
    return looks;
}

static json_t *adaptive_json(const struct render_job *job)
{
    if (!job->plan.counts)
        return json_null();
    return json_pack("{s:i, s:i, s:i, s:i}", "pilot_spp", 16, "round_spp", job->round_samples,
                     "least", job->plan.least, "most", job->plan.most);
}

// How it ended, and what it takes to go on.
static void add_ending(json_t *object, const struct render_job *job)
{
    json_object_set_new(object, "ended_by", json_string(job_ended_by(job)));
    json_object_set_new(object, "looks", looks_json(job));
    json_object_set_new(object, "adaptive", adaptive_json(job));
    json_object_set_new(object, "checkpoint",
                        job->has_checkpoint ? json_words(job->options->checkpoint) : json_null());
}

void job_print_json(const struct render_job *job)
{
    const struct render_stats *stats = &job->renderer.stats;
    const struct film_image *film = &job->film;
    double render = job->seconds.render;
    char hash[20];
    snprintf(hash, sizeof hash, "%016" PRIx64, job->image_hash);
    struct feature_lists lists = {json_array(), json_array()};
    for_each_feature(&job->renderer, list_feature, &lists);
    json_t *object = json_pack(
        "{s:o, s:s, s:s, s:i, s:i, s:I, s:I, s:I, s:o, s:{s:I, s:I}, s:I, s:o, s:I, s:o, s:o, s:o, "
        "s:o, s:I, "
        "s:o, s:{s:o, s:o}, s:{s:I, s:I}, s:I, s:I, s:I, s:I, s:s, s:o, s:o, s:b, s:s}",
        "scene", json_words(job->scene.path), "device", job->gpu.info.name, "driver",
        job->gpu.info.driver, "width", film->width, "height", film->height, "spp",
        (json_int_t)film->least_samples, "spp_most", (json_int_t)film->most_samples, "seed",
        (json_int_t)job->scene.settings.seed, "seconds", seconds_json(&job->seconds), "rays",
        "closest", (json_int_t)stats->closest_rays, "shadow", (json_int_t)stats->shadow_rays,
        "surface_hits", (json_int_t)surface_hits(stats), "hits_by_class",
        classes_json(&job->renderer), "media_lost", (json_int_t)stats->media_lost, "mrays_per_s",
        json_number(total_rays(stats) * 1e-6 / render), "samples_per_s",
        json_number(total_samples(job) / render), "kernels", kernels_json(&job->renderer), "error",
        error_json(&job->error, job->renderer.specialization.halves == HALVES_CONTIGUOUS),
        "nonfinite", (json_int_t)nonfinite(stats), "frames_ms", frames_json(job), "features",
        "kept", lists.kept, "left_out", lists.left_out, "memory", "device_bytes",
        (json_int_t)job->gpu.peak_bytes, "host_peak_bytes", (json_int_t)host_peak_bytes(), "wave",
        (json_int_t)job->renderer.plan.wave_slots, "continued_traversals",
        (json_int_t)stats->suspended, "dropped_degenerate",
        (json_int_t)job->renderer.flat.dropped_degenerate, "skipped_instances",
        (json_int_t)job->renderer.flat.skipped_instances, "image_hash", hash, "outputs",
        strings_json(job->outputs, job->output_count), "notes",
        strings_json(job->scene.notes, job->scene.note_count), "stopped_early", job->stopped,
        "version", LAMPYRIS_VERSION);
    add_ending(object, job);
    json_object_set_new(object, "bias", biases_json(job));
    json_print(object);
}
