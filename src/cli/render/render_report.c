// Reports a render as text.
#include "cli/render/render_report.h"

#include "base/file.h"
#include "base/memory.h"
#include "cli/error_sources_out.h"
#include "cli/sharing.h"
#include "job/bias.h"
#include "job/film_error.h"
#include "render/sampling_plan.h"
#include "report/text_out.h"
#include <inttypes.h>
#include <stdio.h>
#include <string.h>

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

const char *render_following_command(const struct render_run *run)
{
    bool splits = run->job.renderer.specialization.split_lobes > 0;
    return splits ? NULL : run->options->render.following_line;
}

const char *render_reproducing_command(struct render_run *run)
{
    const struct nonfinite_stats *stats = &run->job.renderer.stats.nonfinite;
    if (!stats->recorded || !run->options->render.following_line)
        return NULL;
    // Pixels are numbered in the whole picture, of which the film may be a window.
    const uint32_t width = run->window.width > 0 ? run->scene.settings.width : run->job.film.width;
    return arena_printf(&run->arena, "%s --pixel %u,%u --sample %u",
                        run->options->render.following_line, stats->pixel % width,
                        stats->pixel / width, stats->sample);
}

// --- for people ----------------------------------------------------------------------------------

static void print_biases(const struct render_run *run)
{
    struct job_bias list[JOB_MAX_BIASES];
    uint32_t count = job_list_biases(&run->job, list);
    for (uint32_t i = 0; i < count; i++)
        print_line("bias      ", list[i].text);
}

static void print_error(const struct render_run *run)
{
    const struct half_error *e = &run->job.error;
    char words[FILM_ERROR_WORDS];
    film_error_words(e, words);
    if (!e->known && !e->bounded && !film_error_is_plain(e))
        printf("error     not yet known: %s\n", e->reason);
    else
        printf("error     %s, in %.3f s%s%s\n", words, run->job.seconds.render,
               e->known ? " (bias not included)" : ": ", e->known ? "" : e->reason);
}

static void print_against(const struct render_run *run)
{
    const struct reference_errors *against = &run->job.against;
    const struct interval *stays = &run->job.bias.stays;
    const struct reference *reference = &run->reference;
    if (!run->options->reference)
        return;
    printf("against   ");
    print_words(run->options->reference);
    printf(": local relMSE %.3g, relMSE %.3g, MSE %.3g, SMAPE %.3g, PSNR %.2f dB",
           against->local_relmse, against->relmse, against->mse, against->smape, against->psnr);
    if (reference->noise_known)
        printf(" (after the noise of the reference, local relMSE %.2g, was subtracted)\n",
               reference->local_relmse);
    else
        printf(" (the noise of the reference was not subtracted: %s)\n", reference->reason);
    if (run->job.bias.is_certain)
        printf(
            "stays     local relMSE %.3g, 95 %% interval %.3g to %.3g, however many samples: %s\n",
            stays->value, stays->low, stays->high,
            reference->noise_known ? "bias" : "bias, or the reference's noise");
}

static void print_forecast(const struct render_run *run)
{
    struct forecast f;
    const char *reason = job_forecast(&run->job, &f);
    if (reason) {
        printf("forecast  not known: %s\n", reason);
        return;
    }
    bool is_bound = f.basis == FORECAST_AT_LEAST || halves_are_contiguous(&run->job.renderer);
    printf("forecast  twice the time: local relMSE %s about %.2g (%.2g to %.2g), ",
           is_bound ? "at most" : "of", f.error.value, f.error.low, f.error.high);
    if (f.basis == FORECAST_SLOPE)
        printf("by slope %.2f (%.2f to %.2f)", f.slope.value, f.slope.low, f.slope.high);
    else
        printf("as 1 / samples%s", is_bound ? " or faster" : "");
    if (run->options->reference && run->job.bias.is_certain)
        printf(", of which %.2g stays", run->job.bias.stays.value);
    putchar('\n');
}

static void print_ending(const struct render_run *run)
{
    const struct job_look *look = run->job.looks + run->job.look_count - 1;
    if (run->job.look_count > 0 && look->error.bounded)
        printf("looks     %u; at the last, after %" PRIu64 " spp, the error is below %.3g with "
               "%.4g %% confidence, where %.3g was requested%s\n",
               run->job.look_count, (uint64_t)look->samples, look->error.at_most,
               100.0 * look->confidence, run->options->render.error,
               look->error.known ? "" : " (only this bound is known)");
    if (run->job.plan.counts)
        printf("adaptive  %u to %u samples for every %u planned ones, after a pilot of 16\n",
               run->job.plan.least, run->job.plan.most, run->job.round_samples);
    if (run->options->render.checkpoint && run->job.has_checkpoint) {
        fputs("kept      ", stdout);
        print_words(run->options->render.checkpoint);
        puts(", from which --resume continues");
    }
}

static void print_memory(const struct render_run *run)
{
    const struct renderer *r = &run->job.renderer;
    printf("memory    %.1f MiB on the device", (double)run->gpu.peak_bytes / 1048576.0);
    if (run->gpu.sharers > 1)
        printf(" (one of %u that share its memory)", run->gpu.sharers);
    printf(", %.1f MiB on the host at its peak; ", (double)memory_peak() / 1048576.0);
    if (r->wave_size.least_used < r->wave_size.most_used)
        printf("waves of %u to %u samples, finally of %u, which was the fastest\n",
               r->wave_size.least_used, r->wave_size.most_used, r->wave_size.now);
    else
        printf("wave of %u paths%s\n", r->plan.wave_slots, memory_plan_in_flight(&r->plan));
}

const char *render_auto_reason(const struct render_run *run)
{
    if (run->job.choice.is_made)
        return run->job.choice.reason;
    return run->scene.settings.integrator == INTEGRATOR_AUTO
               ? "the pictures of a sequence have the same integrator"
               : NULL;
}

// Prints the integrator that auto has chosen.
static void print_auto(const struct render_run *run)
{
    const char *reason = render_auto_reason(run);
    if (reason)
        printf("auto      %s: %s\n", integrator_names[settings_integrator(&run->scene.settings)],
               reason);
}

void report_print_kernels(const struct render_stats *stats)
{
    bool any = false;
    double sum = 0.0;
    for (int id = 0; id < KERNEL_COUNT; id++)
        sum += stats->kernels[id].ms;
    for (int id = 0; id < KERNEL_COUNT; id++) {
        double ms = stats->kernels[id].ms;
        if (ms > 0.0)
            printf("%s%s %.0f ms (%.0f %%)", any ? ", " : "kernels   ",
                   kernel_code((enum kernel_id)id, true).name, ms, 100.0 * ms / sum);
        any |= ms > 0.0;
    }
    if (any)
        putchar('\n');
}

// Marks the largest amounts in `is_large`: at most `most` of the `count` amounts, and only amounts
// above 0. Returns the sum of the others.
static double pick_largest(const double *amounts, int count, int most, bool *is_large)
{
    double others = 0.0;
    for (int i = 0; i < count; i++) {
        int larger = 0;
        for (int k = 0; k < count; k++)
            larger += amounts[k] > amounts[i] || (amounts[k] == amounts[i] && k < i);
        is_large[i] = larger < most && amounts[i] > 0.0;
        others += is_large[i] ? 0.0 : amounts[i];
    }
    return others;
}

// Prints the three slowest kernels; --explain prints all.
static void print_largest_kernels(const struct render_stats *stats)
{
    double ms[KERNEL_COUNT], sum = 0.0;
    bool is_large[KERNEL_COUNT];
    for (int id = 0; id < KERNEL_COUNT; id++)
        sum += ms[id] = stats->kernels[id].ms;
    if (sum <= 0.0)
        return;
    double others = pick_largest(ms, KERNEL_COUNT, 3, is_large);
    printf("kernels   %.0f ms:", sum);
    for (int id = 0; id < KERNEL_COUNT; id++)
        if (is_large[id])
            printf(" %s %.0f %%,", kernel_code((enum kernel_id)id, true).name,
                   100.0 * ms[id] / sum);
    printf(" others %.0f %%\n", 100.0 * others / sum);
}

#define STEP_COUNT 7

static void list_steps(const struct job_seconds *s, double seconds[STEP_COUNT])
{
    const double list[STEP_COUNT] = {
        s->load, s->bvh, s->upload, s->compile, s->render - s->render_before, s->judge, s->write};
    memcpy(seconds, list, sizeof list);
}

static void print_steps(const struct job_seconds *s, int most)
{
    static const char *const names[STEP_COUNT] = {"load",   "BVH",   "upload", "compile",
                                                  "render", "judge", "write"};
    double seconds[STEP_COUNT], named = 0.0;
    bool is_large[STEP_COUNT];
    list_steps(s, seconds);
    pick_largest(seconds, STEP_COUNT, most, is_large);
    printf("time      %.3f s =", s->total);
    for (int i = 0; i < STEP_COUNT; i++) {
        if (is_large[i])
            printf(" %s %.3f +", names[i], seconds[i]);
        named += is_large[i] ? seconds[i] : 0.0;
    }
    printf(" other %.3f\n", s->total - named);
}

void report_print_steps(const struct render_run *run)
{
    print_steps(&run->job.seconds, STEP_COUNT);
}

// Prints a line for each device or rank if there are several.
static void print_crew(const struct render_run *run)
{
    const struct crew *crew = run->job.params.crew;
    const struct job_seconds *s = &run->job.seconds;
    const struct film_rows rows = run->job.film.rows;
    const double pixels = (double)run->job.film.width * (rows.end - rows.first);
    for (uint32_t i = 0; crew && i <= crew->count; i++) {
        const struct crew_member *m = &crew->members[i];
        printf("%s%s%-3u", crew->word, strlen(crew->word) < 6 ? "   " : " ", i);
        print_words(m->device);
        printf(": %" PRIu64 " samples a pixel, %.3f Msamples/s, busy %.0f %%\n", m->samples,
               m->busy_seconds > 0.0 ? pixels * (double)m->samples * 1e-6 / m->busy_seconds : 0.0,
               100.0 * m->busy_seconds / (s->render - s->render_before));
    }
}

static void print_times(const struct render_run *run)
{
    const struct job_seconds *s = &run->job.seconds;
    const struct render_stats *stats = &run->job.renderer.stats;
    print_steps(s, 4);
    if (s->bvh_uncached > 0.0)
        printf("BVH       from the cache, %.3f s instead of %.3f s\n", s->bvh, s->bvh_uncached);
    if (s->render_before > 0.0)
        printf("before    %.3f s of rendering by runs before this one\n", s->render_before);
    printf("speed     %.3f Msamples/s, %.2f Mrays/s (%.1f M closest, %.1f M shadow)\n",
           job_total_samples(&run->job) * 1e-6 / s->render,
           render_stats_rays(stats) * 1e-6 / s->render, (double)stats->closest_rays * 1e-6,
           (double)stats->shadow_rays * 1e-6);
    print_largest_kernels(stats);
    print_crew(run);
}

const char *const report_class_names[CLASS_COUNT] = {
    [CLASS_DIFFUSE] = "diffuse",
    [CLASS_PRINCIPLED] = "principled",
    [CLASS_TRANSMISSIVE] = "transmissive",
    [CLASS_CLASSICAL] = "classical",
};

static void print_nonfinite(const struct render_run *run)
{
    const struct nonfinite_stats *stats = &run->job.renderer.stats.nonfinite;
    for (int site = 0; site < SITE_COUNT; site++)
        if (stats->count[site])
            printf("dropped   %" PRIu64 " contributions that were not finite (%s)\n",
                   stats->count[site], site_name(site));
}

// Prints the first note; --explain prints all.
static void print_notes(const struct scene *scene)
{
    if (scene->note_count == 0)
        return;
    fputs("note      ", stdout);
    print_words(scene->notes[0]);
    if (scene->note_count > 1)
        printf(" (and %u more: --explain)", scene->note_count - 1);
    putchar('\n');
}

// Prints the exposure of PNG images if neither the scene file nor an option sets it.
static void print_exposure(const struct render_run *run)
{
    const struct settings *s = &run->scene.settings;
    if (s->exposure_is_auto)
        printf(" (exposure %+.2f stops%s, tone %s: --exposure, --tone)", (double)run->exposure,
               run->scene.exposure_is_replaced ? ", not the file's" : "",
               tone_names[s->tone_curve]);
}

static void print_outputs(const struct render_run *run)
{
    uint32_t last_exposed = run->output_count;
    for (uint32_t i = 0; i < run->output_count; i++)
        if (image_is_tone_mapped(run->outputs[i]))
            last_exposed = i;
    for (uint32_t i = 0; i < run->output_count; i++) {
        fputs(i == 0 ? "wrote     " : ", ", stdout);
        print_words(run->outputs[i]);
        if (i == last_exposed)
            print_exposure(run);
    }
    if (run->output_count > 0)
        putchar('\n');
}

void render_print_summary(struct render_run *run)
{
    const struct film_image *film = &run->job.film;
    print_words(run->scene.path);
    printf("  %u x %u, %" PRIu64, film->width, film->height, film->least_samples);
    if (film->most_samples != film->least_samples)
        printf(" to %" PRIu64, film->most_samples);
    printf(" spp, seed %u%s\n", run->scene.settings.seed,
           run->job.stopped                       ? ", stopped early"
           : run->job.ended_by == ENDED_BY_TIME   ? ", ended by --time"
           : run->job.ended_by == ENDED_BY_ERROR  ? ", ended by --error"
           : run->job.ended_by == ENDED_BY_DEVICE ? ", ended by a failure of the device"
           : run->job.ended_by == ENDED_BY_MEMORY ? ", ended by lack of memory"
                                                  : "");
    if (film->rows.end - film->rows.first < film->height)
        printf(
            "rows      %u to %u of %u are in this part: the error is that of these rows, and all "
            "others are black\n",
            film->rows.first, film->rows.end, film->height);
    if (film->unsampled)
        printf("unsampled %" PRIu64 " of %" PRIu64 " pixels have no sample and are black\n",
               film->unsampled, (uint64_t)film->width * film->height);
    if (run->window.width > 0)
        printf("window    from %u,%u of %u x %u pixels\n", run->window.x, run->window.y,
               run->scene.settings.width, run->scene.settings.height);
    const struct job_device device = job_device(&run->job, &run->arena);
    if (device.name && device.name != run->gpu.info.name)
        print_line("device    ", device.name);
    else
        printf("device    %s (%s)\n", run->gpu.info.name, run->gpu.info.kind);
    print_notes(&run->scene);
    const struct flat_scene *flat = &run->job.renderer.flat;
    if (flat->dropped_degenerate || flat->skipped_instances)
        printf("dropped   %u triangles without area, %u instances with a singular transform\n",
               flat->dropped_degenerate, flat->skipped_instances);
    sharing_print(flat, run->job.renderer.specialization.features);
    print_error(run);
    print_against(run);
    print_forecast(run);
    print_biases(run);
    error_sources_print(&run->job.sources, render_following_command(run));
    print_ending(run);
    print_times(run);
    print_nonfinite(run);
    if (run->job.renderer.stats.media_lost)
        printf("media     %" PRIu64
               " crossings of surfaces that are open, or nested deeper than four: "
               "the medium inside them may be wrong\n",
               run->job.renderer.stats.media_lost);
    print_memory(run);
    print_auto(run);
    explain_print_line(&run->job.renderer);
    print_outputs(run);
    if (run->options->render.trace) {
        fputs("wrote     ", stdout);
        print_words(run->options->render.trace);
        printf(", %u rows\n", run->job.trace.count);
    }
    if (run->options->render.explain)
        explain_print(run);
}
