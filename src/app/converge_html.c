// The report for people: one file that needs no network, with plots, tables and pictures.
#include "converge.h"

#include "html.h"
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

struct page {
    const struct converge *c;
    struct html_page html;
};

// --- plots ---------------------------------------------------------------------------------------

static bool is_known(struct interval i)
{
    return isfinite(i.value) && i.value > 0;
}

static void put_data(FILE *out, const struct converge *c, const struct converge_curve *curve,
                     uint32_t number, bool over_time)
{
    fprintf(out, "$curve%u << EOD\n", number);
    for (uint32_t p = 0; p < c->point_count; p++) {
        struct interval e = curve->error[p];
        double x = over_time ? curve->seconds[p].value : (double)c->spp[p];
        if (is_known(e))
            fprintf(out, "%.9g %.9g %.9g %.9g\n", x, e.value, e.low, e.high);
    }
    fputs("EOD\n", out);
}

static void put_script(FILE *out, const struct converge *c, uint32_t scene, bool over_time)
{
    fprintf(out,
            "set terminal svg size 620,440 dynamic font 'sans-serif,12' noenhanced\n"
            "set logscale xy\nset grid\nset key bottom left\n"
            "set format xy '%%g'\nset ylabel 'relMSE'\nset xlabel '%s'\n",
            over_time ? "seconds of rendering" : "samples a pixel");
    const char *separator = "plot ";
    for (uint32_t i = 0; i < c->curve_count; i++)
        if (c->curves[i].variant.scene == scene)
            put_data(out, c, &c->curves[i], i, over_time);
    for (uint32_t i = 0; i < c->curve_count; i++) {
        if (c->curves[i].variant.scene != scene)
            continue;
        fprintf(out,
                "%s$curve%u using 1:2:3:4 with yerrorlines linewidth 2 pointtype 7 "
                "pointsize .4 title ",
                separator, i);
        html_plot_words(out, converge_label(&c->curves[i]));
        separator = ", \\\n     ";
    }
    fputc('\n', out);
}

static bool put_plot(struct page *page, uint32_t scene, bool over_time, struct err *err)
{
    char *script = NULL;
    size_t size = 0;
    FILE *file = open_memstream(&script, &size);
    const char *name =
        arena_printf(page->html.arena, "%s-%u", over_time ? "error-time" : "error-samples", scene);
    if (!file || !name)
        return err_memory(err, "a plot", 0);
    put_script(file, page->c, scene, over_time);
    bool ok = fclose(file) == 0 ? html_plot(&page->html, name, script, err)
                                : err_memory(err, "a plot", size);
    free(script);
    return ok;
}

// --- pictures ------------------------------------------------------------------------------------

// Relative differences in false colours, which are display values.
static bool put_error_map(struct page *page, const char *name, const struct image *image,
                          const struct converge_reference *reference, struct err *err)
{
    uint64_t count = (uint64_t)image->width * image->height;
    struct image map = {image->width, image->height,
                        arena_alloc(page->html.arena, count, sizeof *map.pixels)};
    if (!map.pixels)
        return err_memory(err, "an error map", count * sizeof *map.pixels);
    metrics_difference_picture((const float(*)[3])image->pixels,
                               (const float(*)[3])reference->picture.image.pixels, count,
                               map.pixels);
    html_linearize(&map);
    return html_picture(&page->html, name, &map, "", err);
}

// Picture and reference one above the other: the slider cuts the upper one off.
static bool put_slider(struct page *page, uint32_t index, struct err *err)
{
    const struct converge *c = page->c;
    const struct converge_curve *curve = &c->curves[index];
    const struct converge_reference *reference = &c->references[curve->variant.scene];
    const struct settings *settings = &curve->scene_data.settings;
    struct image image = {settings->width, settings->height, curve->pictures[0]};
    struct image truth = {settings->width, settings->height, reference->picture.image.pixels};
    const char *name = arena_printf(page->html.arena, "curve-%u", index);
    const char *map = arena_printf(page->html.arena, "curve-%u-error", index);
    const char *base = arena_printf(page->html.arena, "reference-%u", curve->variant.scene);
    if (!name || !map || !base)
        return err_memory(err, "file names", 0);
    fputs("<figure><figcaption>", page->html.out);
    html_text(&page->html, converge_label(curve));
    fputs("</figcaption><div class=\"slider\">", page->html.out);
    if (reference->name && !html_picture(&page->html, base, &truth, "", err))
        return false;
    if (!html_picture(&page->html, name, &image, "class=\"over\"", err))
        return false;
    if (reference->name)
        fputs(
            "<input type=\"range\" min=\"0\" max=\"100\" value=\"100\" title=\"left: the curve's "
            "picture, right: the reference\" oninput=\"this.previousElementSibling.style.clipPath="
            "'inset(0 '+(100-this.value)+'% 0 0)'\">",
            page->html.out);
    fputs("</div>", page->html.out);
    if (reference->name && !put_error_map(page, map, &image, reference, err))
        return false;
    fputs("</figure>\n", page->html.out);
    return true;
}

// --- tables --------------------------------------------------------------------------------------

static void put_row(struct page *page, uint32_t index)
{
    const struct converge *c = page->c;
    const struct converge_curve *curve = &c->curves[index];
    FILE *out = page->html.out;
    uint32_t last = c->point_count - 1;
    fputs("<tr><th>", out);
    html_text(&page->html, converge_label(curve));
    fputs("</th>", out);
    html_interval(&page->html, curve->error[last], "%.3g");
    html_interval(&page->html, curve->slope, "%.3f");
    html_interval(&page->html, curve->seconds[last], "%.3g");
    html_interval(&page->html, curve->efficiency, "%.3g");
    html_interval(&page->html, curve->ratio, "%.3g");
    fprintf(out, "<td>%s</td>", converge_verdict(curve));
    for (int i = 0; i < CONVERGE_TARGETS; i++) {
        if (isnan(curve->time_to[i]))
            fputs("<td>not known</td>", out);
        else
            fprintf(out, "<td>%.3g%s</td>", curve->time_to[i], curve->extrapolated[i] ? "*" : "");
    }
    html_interval(&page->html, curve->bias, "%.2g");
    const struct converge_sample *first = converge_at(c, curve, 0, last);
    for (int m = CONVERGE_SMAPE; m < CONVERGE_METRICS; m++)
        fprintf(out, "<td>%.4g</td>", first->metric[m]);
    fputs("</tr>\n", out);
}

static bool put_scene(struct page *page, uint32_t scene, struct err *err)
{
    const struct converge *c = page->c;
    FILE *out = page->html.out;
    fputs("<h2>", out);
    html_text(&page->html, c->options->arguments[scene]);
    fputs("</h2>\n<div class=\"plots\">", out);
    if (!put_plot(page, scene, false, err) || !put_plot(page, scene, true, err))
        return false;
    fputs("</div>\n<table><tr><th>curve</th><th>relMSE at the end</th><th>slope</th><th>seconds"
          "</th><th>efficiency</th><th>ratio to the first</th><th></th><th>s to 1e-2</th><th>to "
          "1e-3</th><th>to 1e-4</th><th>bias</th><th>SMAPE</th><th>PSNR</th><th>SSIM"
          "</th><th>FLIP</th></tr>\n",
          out);
    for (uint32_t i = 0; i < c->curve_count; i++)
        if (c->curves[i].variant.scene == scene)
            put_row(page, i);
    fputs("</table>\n<div class=\"pictures\">", out);
    for (uint32_t i = 0; i < c->curve_count; i++)
        if (c->curves[i].variant.scene == scene && !put_slider(page, i, err))
            return false;
    fputs("</div>\n", out);
    return true;
}

static void put_explanation(struct page *page)
{
    fprintf(page->html.out,
            "<p>%u replicates. Errors are geometric means over replicates with 95 %% intervals of "
            "Student's t. Times are of rendering alone; those to an error add loading, building "
            "and compiling, and follow 1/t from the last point; * marks those beyond it. "
            "Efficiency is 1 / (relMSE &times; seconds). Bias is what of relMSE more samples would "
            "not remove: there is some where the interval is above 0. SMAPE, PSNR, SSIM and FLIP "
            "are of the first replicate.</p>\n",
            page->c->replicates_done);
}

bool converge_write_html(struct converge *c, const char *folder, struct err *err)
{
    struct page page = {.c = c};
    if (!html_begin(&page.html, &c->arena, folder, "Error against run time", err))
        return false;
    bool ok = true;
    for (uint32_t scene = 0; scene < c->options->argument_count && ok; scene++)
        ok = put_scene(&page, scene, err);
    put_explanation(&page);
    html_machine(&page.html, &c->gpu, c->options->command_line);
    return html_end(&page.html, ok, err);
}
