// Writes the HTML report: a single file with plots, tables and images that needs no network.
#include "cli/converge/converge.h"

#include "report/html_viewer.h"
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

struct page {
    const struct converge *c;
    struct html_page html;
};

// The greatest number of curves for which a matrix of all pairs is readable.
#define MATRIX_CURVES 8

static bool put_plot(struct page *page, uint32_t scene, bool over_time, struct err *err)
{
    char *script;
    const char *name =
        arena_printf(page->html.arena, "%s-%u", over_time ? "error-time" : "error-samples", scene);
    if (!name)
        return err_memory(err, "file names", 0);
    if (!converge_plot(page->c, scene, over_time, &script, err))
        return false;
    bool ok = !script || html_plot(&page->html, name, script, err);
    free(script);
    return ok;
}

// --- images --------------------------------------------------------------------------------------

static bool put_reference(struct page *page, struct html_viewer *viewer, uint32_t scene,
                          struct err *err)
{
    const struct converge_reference *reference = &page->c->references[scene];
    if (!reference->name)
        return true;
    const char *name = arena_printf(page->html.arena, "reference-%u", scene);
    const struct html_viewer_picture picture = {
        .label = "reference",
        .title = reference->name,
        .pixels = (const float(*)[3])reference->picture.image.pixels,
        .is_reference = true,
    };
    if (!name)
        return err_memory(err, "file names", 0);
    return html_keep_picture(&page->html, name, &reference->picture.image, err) &&
           html_viewer_add(viewer, &picture, err);
}

static bool put_picture(struct page *page, struct html_viewer *viewer, uint32_t index,
                        struct err *err)
{
    const struct converge_curve *curve = &page->c->curves[index];
    const struct converge_reference *reference = &page->c->references[curve->variant.scene];
    const struct settings *settings = &curve->scene_data.settings;
    const struct image image = {settings->width, settings->height, curve->pictures[0]};
    const struct converge_point *last = &curve->points[page->c->point_count - 1];
    const char *name = arena_printf(page->html.arena, "curve-%u", index);
    const char *map = arena_printf(page->html.arena, "curve-%u-error", index);
    const struct html_viewer_picture picture = {
        .label = converge_label(curve),
        .title = converge_label(curve),
        .pixels = (const float(*)[3])image.pixels,
    };
    if (!name || !map)
        return err_memory(err, "file names", 0);
    if (!html_keep_picture(&page->html, name, &image, err) ||
        (reference->name &&
         !html_keep_difference(&page->html, map, &image, &reference->picture.image, err)) ||
        !html_viewer_add(viewer, &picture, err))
        return false;
    html_viewer_figure(viewer, "local relMSE", last->metric[CONVERGE_LOCAL_RELMSE]);
    html_viewer_figure(viewer, "relMSE", last->metric[CONVERGE_RELMSE]);
    html_viewer_figure(viewer, "MSE", last->metric[CONVERGE_MSE]);
    return true;
}

static bool put_pictures(struct page *page, uint32_t scene, uint32_t first, uint32_t count,
                         struct err *err)
{
    const struct settings *settings = &page->c->curves[first].scene_data.settings;
    const struct html_viewer_params params = {
        .width = settings->width,
        .height = settings->height,
        .count = count + (page->c->references[scene].name != NULL),
        .exposure_stops = page->html.exposure_stops,
        .tone = page->html.tone,
    };
    struct html_viewer viewer;
    fputs("<h3>Pictures of the first replicate</h3>\n<p>The numbers below the insets are those of "
          "all replicates.</p>\n",
          page->html.out);
    bool ok = html_viewer_begin(&page->html, &params, &viewer, err);
    for (uint32_t i = 0; i < count && ok; i++)
        ok = put_picture(page, &viewer, first + i, err);
    ok = ok && put_reference(page, &viewer, scene, err);
    return html_viewer_end(&viewer, ok, err);
}

// --- tables --------------------------------------------------------------------------------------

static void put_label(struct page *page, const struct converge_curve *curve)
{
    fputs("<tr><th>", page->html.out);
    html_text(&page->html, converge_label(curve));
    fputs("</th>", page->html.out);
}

static void put_ratio(struct page *page, struct interval ratio)
{
    static const char *const classes[] = {
        [CURVE_NOT_TOLD_APART] = "", [CURVE_BETTER] = "better", [CURVE_WORSE] = "worse"};
    FILE *out = page->html.out;
    if (isnan(ratio.value)) {
        fputs("<td>not known</td>", out);
        return;
    }
    fprintf(out, "<td class=\"%s\">%.3g &times; <small>", classes[curve_judge(ratio)], ratio.value);
    if (!isnan(ratio.low))
        fprintf(out, "[%.3g, %.3g]", ratio.low, ratio.high);
    fprintf(out, "</small>%s</td>", curve_verdict_words(curve_judge(ratio)));
}

static void put_row(struct page *page, const struct converge_curve *curve, bool is_first)
{
    const struct converge *c = page->c;
    FILE *out = page->html.out;
    const struct converge_point *last = &curve->points[c->point_count - 1];
    put_label(page, curve);
    if (isnan(last->metric[CONVERGE_LOCAL_RELMSE].value) && isfinite(last->at_most))
        fprintf(out, "<td>at most %.3g</td>", last->at_most);
    else
        html_interval(&page->html, last->metric[CONVERGE_LOCAL_RELMSE], "%.3g");
    html_interval(&page->html, curve->slope, "%.3f");
    if (c->spp)
        html_number(&page->html, last->spp.value, "%.0f");
    else
        html_interval(&page->html, last->spp, "%.4g");
    html_interval(&page->html, last->seconds, "%.3g");
    html_number(&page->html, curve->start_seconds, "%.2g");
    html_interval(&page->html, curve->efficiency, "%.3g");
    if (is_first)
        fputs("<td>1</td>", out);
    else
        put_ratio(page, curve->ratios[0]);
    if (isnan(curve->bias.value))
        fputs("<td>not known</td>", out);
    else
        fprintf(out, "<td%s>%.2g <small>[%.2g, %.2g]</small>%s</td>",
                converge_is_biased(curve) ? " class=\"alarm\"" : "", curve->bias.value,
                curve->bias.low, curve->bias.high, converge_is_biased(curve) ? "biased" : "");
    fputs("</tr>\n", out);
}

static void put_curves(struct page *page, uint32_t first, uint32_t count)
{
    FILE *out = page->html.out;
    fprintf(out,
            "<div class=\"wide\"><table><tr><th>curve</th><th>local relMSE at the end</th>"
            "<th>slope on %s</th><th>samples a pixel</th><th>seconds</th><th>start, "
            "s</th><th>efficiency</th>"
            "<th>against the first</th><th>bias</th></tr>\n",
            page->c->spp ? "samples" : "time");
    for (uint32_t i = 0; i < count; i++)
        put_row(page, &page->c->curves[first + i], i == 0);
    fputs("</table></div>\n", out);
}

static void put_metrics(struct page *page, uint32_t first, uint32_t count)
{
    static const char *const formats[CONVERGE_METRICS] = {
        [CONVERGE_RELMSE] = "%.3g", [CONVERGE_MSE] = "%.3g",  [CONVERGE_SMAPE] = "%.4f",
        [CONVERGE_PSNR] = "%.2f",   [CONVERGE_SSIM] = "%.4f", [CONVERGE_FLIP] = "%.4f",
    };
    fputs("<h3>Other metrics at the end</h3>\n<div class=\"wide\"><table><tr><th>curve</th>"
          "<th>relMSE</th><th>MSE</th><th>efficiency, MSE</th><th>SMAPE</th><th>PSNR, "
          "dB</th><th>SSIM</th>"
          "<th>FLIP</th></tr>\n",
          page->html.out);
    for (uint32_t i = 0; i < count; i++) {
        const struct converge_curve *curve = &page->c->curves[first + i];
        put_label(page, curve);
        for (int m = CONVERGE_RELMSE; m < CONVERGE_METRICS; m++) {
            html_interval(&page->html, curve->points[page->c->point_count - 1].metric[m],
                          formats[m]);
            if (m == CONVERGE_MSE)
                html_interval(&page->html, curve->efficiency_mse, "%.3g");
        }
        fputs("</tr>\n", page->html.out);
    }
    fputs("</table></div>\n", page->html.out);
}

static void put_target(struct page *page, const struct converge_target *target)
{
    FILE *out = page->html.out;
    const char *mark = target->extrapolated ? "&#8776; " : "";
    if (isnan(target->seconds.value)) {
        fputs("<td>not known</td><td>not known</td>", out);
        return;
    }
    fprintf(out, "<td>%s", mark);
    html_value(&page->html, target->seconds, "%.3g");
    fprintf(out, "</td><td>%s", mark);
    html_value(&page->html, target->spp, "%.3g");
    fputs("</td>", out);
}

static void put_targets(struct page *page, uint32_t first, uint32_t count)
{
    FILE *out = page->html.out;
    fputs("<h3>Time and samples to reach an error</h3>\n<div "
          "class=\"wide\"><table><tr><th>curve</th>",
          out);
    for (int t = 0; t < CONVERGE_TARGETS; t++)
        fprintf(out, "<th>seconds to local relMSE %g</th><th>samples a pixel</th>",
                converge_targets[t]);
    fputs("</tr>\n", out);
    for (uint32_t i = 0; i < count; i++) {
        put_label(page, &page->c->curves[first + i]);
        for (int t = 0; t < CONVERGE_TARGETS; t++)
            put_target(page, &page->c->curves[first + i].targets[t]);
        fputs("</tr>\n", out);
    }
    fputs("</table></div>\n", out);
}

static void put_share(struct page *page, const char *name, const struct error_share *share)
{
    fputs("<tr><th>", page->html.out);
    html_text(&page->html, name);
    fputs("</th>", page->html.out);
    const struct interval percent = {100.0 * share->share.value, 100.0 * share->share.low,
                                     100.0 * share->share.high};
    html_interval(&page->html, percent, "%.1f");
    html_number(&page->html, share->error, "%.3g");
}

static void put_kind(struct page *page, const struct error_by *by, enum error_kind kind)
{
    FILE *out = page->html.out;
    fprintf(out,
            "<div class=\"wide\"><table><tr><th>%s</th><th>share of the error, %%</th>"
            "<th>local relMSE</th><th>share of the light, %%</th></tr>\n",
            error_kind_names[kind]);
    for (uint32_t i = 0; i < by->count; i++) {
        put_share(page, error_class_name(kind, i), &by->classes[i]);
        html_number(&page->html, 100.0 * by->light[i], "%.1f");
        fputs("</tr>\n", out);
    }
    put_share(page, "together", &by->together);
    fputs("<td></td></tr>\n</table></div>\n", out);
}

// Writes the sources of the error (--error-by) of the last images of each curve.
static void put_sources(struct page *page, uint32_t first, uint32_t count)
{
    FILE *out = page->html.out;
    for (uint32_t i = 0; i < count; i++) {
        const struct converge_curve *curve = &page->c->curves[first + i];
        const struct error_sources *sources = &curve->pooled;
        if (!sources->kinds)
            continue;
        fputs("<h3>Sources of the error: ", out);
        html_text(&page->html, converge_label(curve));
        fputs("</h3>\n", out);
        if (sources->reason)
            fprintf(out, "<p class=\"note\">Not known: %s.</p>\n", sources->reason);
        for (int kind = 0; kind < ERROR_KIND_COUNT && !sources->reason; kind++)
            if (sources->kinds & error_kind_aov((enum error_kind)kind))
                put_kind(page, &sources->by[kind], (enum error_kind)kind);
    }
}

static void put_matrix(struct page *page, uint32_t first, uint32_t count)
{
    FILE *out = page->html.out;
    if (count < 3 || count > MATRIX_CURVES)
        return;
    fputs("<h3>Efficiency of each row's curve divided by that of each column's</h3>\n<div "
          "class=\"wide\"><table><tr><th></th>",
          out);
    for (uint32_t i = 0; i < count; i++) {
        fputs("<th>", out);
        html_text(&page->html, converge_label(&page->c->curves[first + i]));
        fputs("</th>", out);
    }
    fputs("</tr>\n", out);
    for (uint32_t i = 0; i < count; i++) {
        put_label(page, &page->c->curves[first + i]);
        for (uint32_t k = 0; k < count; k++)
            if (k == i)
                fputs("<td></td>", out);
            else
                put_ratio(page, page->c->curves[first + i].ratios[k]);
        fputs("</tr>\n", out);
    }
    fputs("</table></div>\n", out);
}

// --- text ----------------------------------------------------------------------------------------

static void put_reference_words(struct page *page, const struct converge_reference *reference)
{
    FILE *out = page->html.out;
    if (!reference->name)
        fputs("There is no reference: errors are estimated from the half-buffers, which do not "
              "show bias.",
              out);
    else if (reference->spp)
        fprintf(out,
                "The reference has %" PRIu64
                " samples per pixel; its own noise, a local relMSE of %.2g, is subtracted.",
                reference->spp, reference->picture.local_relmse);
    else {
        fputs("The reference is ", out);
        html_text(&page->html, reference->name);
        if (reference->picture.noise_known)
            fprintf(out, "; its own noise, a local relMSE of %.2g, is subtracted.",
                    reference->picture.local_relmse);
        else
            fputs("; its own noise is not known.", out);
    }
}

static bool is_any_error_known(const struct converge *c, uint32_t first, uint32_t count)
{
    for (uint32_t i = 0; i < count; i++)
        for (uint32_t p = 0; p < c->point_count; p++)
            if (!isnan(c->curves[first + i].points[p].metric[CONVERGE_LOCAL_RELMSE].value))
                return true;
    return false;
}

static bool put_scene(struct page *page, uint32_t scene, struct err *err)
{
    const struct converge *c = page->c;
    FILE *out = page->html.out;
    uint32_t first = 0;
    while (c->curves[first].variant.scene != scene)
        first++;
    uint32_t count = converge_siblings(c, &c->curves[first], &first);
    const struct settings *settings = &c->curves[first].scene_data.settings;
    fputs("<h2>", out);
    html_text(&page->html, c->options->arguments[scene]);
    fprintf(out, "</h2>\n<p>%u &times; %u pixels, %u replicates. ", settings->width,
            settings->height, c->replicates_done);
    put_reference_words(page, &c->references[scene]);
    page->html.exposure_stops = settings->exposure;
    page->html.tone = settings->tone_curve;
    fputs("</p>\n<div class=\"plots\">", out);
    if (!is_any_error_known(c, first, count))
        fputs("<p class=\"note\">No error is known, so there is nothing to plot.</p>", out);
    if (!put_plot(page, scene, false, err) || !put_plot(page, scene, true, err))
        return false;
    fputs("</div>\n", out);
    put_curves(page, first, count);
    put_targets(page, first, count);
    put_metrics(page, first, count);
    put_matrix(page, first, count);
    put_sources(page, first, count);
    return put_pictures(page, scene, first, count, err);
}

static void put_notes(struct page *page)
{
    char notes[CONVERGE_NOTES][CONVERGE_NOTE_SIZE];
    uint32_t count = converge_notes(page->c, notes);
    for (uint32_t i = 0; i < count; i++)
        fprintf(page->html.out, "<p class=\"note\">Note: %s.</p>\n", notes[i]);
}

static void put_explanation(struct page *page)
{
    fputs(
        "<h2>How to read this</h2>\n<p>The error is the local relMSE, mean (x &minus; "
        "r)&sup2; / (L&sup2; + 0.01), where L is the mean of the reference r around a pixel by a "
        "Gaussian of 1.5 pixels. Errors are geometric means over replicates, other metrics "
        "means, with 95 % intervals by Student's t. Seconds are rendering time; the start "
        "(loading, "
        "building and compiling) is included only in the times to reach an error. &#8776; marks "
        "times that are extrapolated as if the error decreased with 1/t; their intervals allow for "
        "the measured slope. Efficiency is 1 / (local relMSE &times; seconds), or "
        "1 / (MSE &times; seconds). Pairs are compared seed by seed. Bias is the part of relMSE "
        "that "
        "more samples do not remove: the method is biased if its interval is above 0.</p>\n",
        page->html.out);
}

static void put_commands(struct page *page)
{
    fputs("<h3>Commands that render the first replicate's pictures</h3>\n<pre>", page->html.out);
    for (uint32_t i = 0; i < page->c->curve_count; i++) {
        html_text(&page->html, page->c->curves[i].command);
        fprintf(page->html.out, "  # %016" PRIx64 "\n", page->c->curves[i].image_hash);
    }
    fputs("</pre>\n", page->html.out);
}

bool converge_write_html(struct converge *c, const char *folder, struct err *err)
{
    struct page page = {.c = c};
    if (!html_begin(&page.html, &c->arena, folder, "Error against run time", err))
        return false;
    page.html.keeps_parts = c->options->converge.images;
    put_notes(&page);
    bool ok = true;
    for (uint32_t scene = 0; scene < c->options->argument_count && ok; scene++)
        ok = put_scene(&page, scene, err);
    put_explanation(&page);
    html_machine(&page.html, &c->gpu, c->options->command_line);
    put_commands(&page);
    return html_end(&page.html, ok, err);
}
