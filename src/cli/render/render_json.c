// Reports a render as one JSON object, described by docs/render.schema.json.
#include "base/memory.h"
#include "cli/error_sources_out.h"
#include "cli/render/render_report.h"
#include "cli/sharing.h"
#include "job/bias.h"
#include "render/sampling_plan.h"
#include "report/json_out.h"
#include <inttypes.h>
#include <math.h>
#include <stdio.h>

static uint64_t nonfinite(const struct render_stats *stats)
{
    uint64_t sum = 0;
    for (int site = 0; site < SITE_COUNT; site++)
        sum += stats->nonfinite.count[site];
    return sum;
}

struct part_lists {
    json_t *kept, *left_out;
    const struct renderer *explained; // NULL: without reasons
};

static void list_part(void *context, const struct part *part)
{
    struct part_lists *lists = context;
    json_t *object = json_pack("{s:s, s:s, s:I}", "kind", part_kind_name(part->kind), "name",
                               part->name, "bytes", (json_int_t)part->bytes);
    if (!part->is_kept && lists->explained)
        json_object_set_new(object, "saved", explain_json(lists->explained, part));
    json_array_append_new(part->is_kept ? lists->kept : lists->left_out, object);
}

static json_t *biases_json(const struct render_run *run)
{
    struct job_bias list[JOB_MAX_BIASES];
    uint32_t count = job_list_biases(&run->job, list);
    json_t *array = json_array();
    for (uint32_t i = 0; i < count; i++)
        json_array_append_new(array,
                              json_pack("{s:s, s:s}", "kind", list[i].kind, "text", list[i].text));
    return array;
}

static json_t *classes_json(const struct renderer *r)
{
    bool sorted = r->specialization.features & FEATURE_CLASSES;
    json_t *classes = json_object();
    for (int c = 0; c < (int)CLASS_COUNT && sorted; c++)
        if (r->specialization.class_lobes[c])
            json_object_set_new(classes, report_class_names[c],
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

static json_t *error_json(const struct half_error *error)
{
    return json_pack("{s:b, s:o, s:o, s:o, s:o, s:o, s:o}", "known", error->known, "local_relmse",
                     json_number(error->local_relmse), "ci_low", json_number(error->ci_low),
                     "ci_high", json_number(error->ci_high), "at_most", json_number(error->at_most),
                     "relmse_at_most", json_number(error->relmse_at_most), "reason",
                     error->reason ? json_string(error->reason) : json_null());
}

static json_t *seconds_json(const struct job_seconds *s)
{
    json_t *uncached = s->bvh_uncached > 0.0 ? json_real(s->bvh_uncached) : json_null();
    return json_pack("{s:f, s:f, s:o, s:f, s:f, s:f, s:f, s:f, s:f, s:f}", "load", s->load, "bvh",
                     s->bvh, "bvh_uncached", uncached, "upload", s->upload, "compile", s->compile,
                     "render", s->render, "judge", s->judge, "write", s->write, "total", s->total,
                     "render_before", s->render_before);
}

static json_t *reference_json(const struct render_run *run)
{
    const struct reference_errors *against = &run->job.against;
    const struct reference *reference = &run->reference;
    if (!run->options->reference)
        return json_null();
    bool has_own = reference->noise_known;
    return json_pack("{s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:b}", "name",
                     json_words(run->options->reference), "own_local_relmse",
                     json_number(has_own ? reference->local_relmse : NAN), "own_relmse",
                     json_number(has_own ? reference->relmse : NAN), "local_relmse",
                     json_number(against->local_relmse), "relmse", json_number(against->relmse),
                     "mse", json_number(against->mse), "smape", json_number(against->smape), "psnr",
                     json_number(against->psnr), "stays", json_interval(run->job.bias.stays),
                     "biased", run->job.bias.is_certain);
}

static json_t *forecast_json(const struct render_run *run)
{
    static const char *const bases[] = {
        [FORECAST_INVERSE] = "1/samples",
        [FORECAST_AT_LEAST] = "1/samples or faster",
        [FORECAST_SLOPE] = "slope",
    };
    struct forecast f;
    const char *reason = job_forecast(&run->job, &f);
    bool is_bound = f.basis == FORECAST_AT_LEAST || halves_are_contiguous(&run->job.renderer);
    bool is_biased = run->options->reference && run->job.bias.is_certain;
    bool has_slope = f.basis == FORECAST_SLOPE;
    return json_pack("{s:o, s:o, s:o, s:o, s:f, s:s, s:b, s:o, s:i, s:o}", "local_relmse",
                     json_number(f.error.value), "ci_low", json_number(f.error.low), "ci_high",
                     json_number(f.error.high), "stays",
                     is_biased ? json_number(run->job.bias.stays.value) : json_null(), "seconds",
                     2.0 * run->job.seconds.render, "basis", bases[f.basis], "upper_bound",
                     is_bound, "slope", has_slope ? json_interval(f.slope) : json_null(), "looks",
                     (int)f.looks, "reason", reason ? json_string(reason) : json_null());
}

static json_t *frames_json(const struct render_run *run)
{
    json_t *array = json_array();
    for (uint32_t i = 0; i < run->job.frame_count; i++)
        json_array_append_new(array, json_number(run->job.frames_ms[i]));
    return array;
}

static json_t *looks_json(const struct render_run *run)
{
    json_t *looks = json_array();
    for (uint32_t i = 0; i < run->job.look_count; i++) {
        const struct job_look *look = &run->job.looks[i];
        json_t *object = error_json(&look->error);
        json_object_set_new(object, "spp", json_integer((json_int_t)look->samples));
        json_object_set_new(object, "confidence", json_number(look->confidence));
        json_array_append_new(looks, object);
    }
    return looks;
}

static json_t *adaptive_json(const struct render_run *run)
{
    if (!run->job.plan.counts)
        return json_null();
    return json_pack("{s:i, s:i, s:i, s:i}", "pilot_spp", 16, "round_spp", run->job.round_samples,
                     "least", run->job.plan.least, "most", run->job.plan.most);
}

static json_t *trial_json(const struct choice_trial *trial)
{
    return json_pack("{s:o, s:f}", "local_relmse", json_number(trial->error), "rays", trial->rays);
}

// Returns the integrator, and why it was chosen if the setting is auto.
static json_t *integrator_json(const struct render_run *run)
{
    const struct integrator_choice *choice = &run->job.choice;
    const uint32_t integrator = settings_integrator(&run->scene.settings);
    json_t *pilot = json_null();
    if (choice->samples > 0)
        pilot =
            json_pack("{s:i, s:i, s:i, s:f, s:o, s:o}", "width", (int)choice->width, "height",
                      (int)choice->height, "spp", (int)choice->samples, "seconds", choice->seconds,
                      "path", trial_json(&choice->path), "bidir", trial_json(&choice->bidir));
    const char *reason = render_auto_reason(run);
    return json_pack("{s:s, s:b, s:o, s:o}", "name", integrator_names[integrator], "auto",
                     reason != NULL, "reason", reason ? json_string(reason) : json_null(), "pilot",
                     pilot);
}

// Adds how the render ended, and how to resume it.
static void add_ending(json_t *object, const struct render_run *run)
{
    json_object_set_new(object, "ended_by", json_string(job_ended_by(&run->job)));
    json_object_set_new(object, "pixels_without_samples",
                        json_integer((json_int_t)run->job.film.unsampled));
    json_object_set_new(object, "looks", looks_json(run));
    json_object_set_new(object, "adaptive", adaptive_json(run));
    json_object_set_new(object, "checkpoint",
                        run->job.has_checkpoint ? json_words(run->options->render.checkpoint)
                                                : json_null());
}

static json_t *crew_json(const struct render_run *run)
{
    const struct crew *crew = run->job.params.crew;
    const struct job_seconds *s = &run->job.seconds;
    json_t *array = json_array();
    for (uint32_t i = 0; crew && i <= crew->count; i++) {
        const struct crew_member *m = &crew->members[i];
        json_array_append_new(
            array, json_pack("{s:o, s:o, s:I, s:f, s:o}", "device", json_words(m->device), "driver",
                             json_words(m->driver), "spp", (json_int_t)m->samples, "seconds",
                             m->busy_seconds, "busy",
                             json_number(m->busy_seconds / (s->render - s->render_before))));
    }
    return array;
}

json_t *render_frame_json(const struct render_frame *frame)
{
    return json_pack("{s:i, s:i, s:o, s:o}", "number", (int)frame->number, "count",
                     (int)frame->count, "at_seconds", json_number(frame->at_seconds), "degrees",
                     json_number(frame->degrees));
}

bool render_print_json(const struct render_run *run, struct err *err)
{
    const struct render_stats *stats = &run->job.renderer.stats;
    const struct film_image *film = &run->job.film;
    double render = run->job.seconds.render;
    char hash[20];
    struct arena arena = {0};
    const struct job_device device = job_device(&run->job, &arena);
    snprintf(hash, sizeof hash, "%016" PRIx64, run->job.image_hash);
    struct part_lists lists = {json_array(), json_array(),
                               run->options->render.explain ? &run->job.renderer : NULL};
    parts_visit(&run->job.renderer, list_part, &lists);
    json_t *object = json_pack(
        "{s:o, s:s, s:s, s:i, s:i, s:I, s:I, s:I, s:o, s:{s:I, s:I}, s:I, s:o, s:I, s:o, s:o, s:o, "
        "s:o, s:I, "
        "s:o, s:{s:o, s:o}, s:{s:I, s:I}, s:I, s:I, s:I, s:I, s:s, s:o, s:o, s:b, s:s}",
        "scene", json_words(run->scene.path), "device",
        device.name ? device.name : run->gpu.info.name, "driver", device.driver, "width",
        film->width, "height", film->height, "spp", (json_int_t)film->least_samples, "spp_most",
        (json_int_t)film->most_samples, "seed", (json_int_t)run->scene.settings.seed, "seconds",
        seconds_json(&run->job.seconds), "rays", "closest", (json_int_t)stats->closest_rays,
        "shadow", (json_int_t)stats->shadow_rays, "surface_hits", (json_int_t)surface_hits(stats),
        "hits_by_class", classes_json(&run->job.renderer), "media_lost",
        (json_int_t)stats->media_lost, "mrays_per_s",
        json_number(render_stats_rays(stats) * 1e-6 / render), "samples_per_s",
        json_number(job_total_samples(&run->job) / render), "kernels",
        kernels_json(&run->job.renderer), "error", error_json(&run->job.error), "nonfinite",
        (json_int_t)nonfinite(stats), "frames_ms", frames_json(run), "features", "kept", lists.kept,
        "left_out", lists.left_out, "memory", "device_bytes", (json_int_t)run->gpu.peak_bytes,
        "host_peak_bytes", (json_int_t)memory_peak(), "wave",
        (json_int_t)run->job.renderer.plan.wave_slots, "continued_traversals",
        (json_int_t)stats->suspended, "dropped_degenerate",
        (json_int_t)run->job.renderer.flat.dropped_degenerate, "skipped_instances",
        (json_int_t)run->job.renderer.flat.skipped_instances, "image_hash", hash, "outputs",
        json_word_list(run->outputs, run->output_count), "notes",
        json_word_list(run->scene.notes, run->scene.note_count), "stopped_early", run->job.stopped,
        "version", LAMPYRIS_VERSION);
    arena_finish(&arena);
    add_ending(object, run);
    json_object_set_new(object, "integrator", integrator_json(run));
    json_object_set_new(object, "rows", json_pack("[i, i]", film->rows.first, film->rows.end));
    json_object_set_new(object, "workgroup",
                        json_integer(run->job.renderer.specialization.workgroup));
    const struct wave_size *sizes = &run->job.renderer.wave_size;
    json_object_set_new(object, "wave_samples",
                        json_pack("{s:I, s:I, s:I}", "least", (json_int_t)sizes->least_used, "most",
                                  (json_int_t)sizes->most_used, "last", (json_int_t)sizes->now));
    json_object_set_new(object, "waves_in_flight", json_integer(run->job.renderer.plan.waves));
    json_object_set_new(object, "waves_begun_ahead", json_integer((json_int_t)stats->waves_ahead));
    json_object_set_new(object, "shared_stack_entries",
                        json_integer(run->job.renderer.specialization.stack_shared));
    json_object_set_new(object, "sorts_rays",
                        json_boolean(run->job.renderer.specialization.sort_rays));
    json_object_set_new(
        object, "shared",
        sharing_json(&run->job.renderer.flat, run->job.renderer.specialization.features));
    json_object_set_new(object, "members", crew_json(run));
    json_object_set_new(object, "bias", biases_json(run));
    json_object_set_new(object, "reference", reference_json(run));
    json_object_set_new(object, "forecast", forecast_json(run));
    json_object_set_new(object, "error_by",
                        error_sources_json(&run->job.sources, render_following_command(run)));
    json_object_set_new(object, "trace",
                        run->options->render.trace ? json_words(run->options->render.trace)
                                                   : json_null());
    if (run->window.width > 0)
        json_object_set_new(object, "crop",
                            json_pack("[i, i, i, i]", (int)run->window.x, (int)run->window.y,
                                      (int)(run->window.x + run->window.width),
                                      (int)(run->window.y + run->window.height)));
    if (run->frame.number == 0)
        return json_put(object, err);
    json_object_set_new(object, "frame", render_frame_json(&run->frame));
    return json_put_line(object, err);
}
