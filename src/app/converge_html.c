// The report for people: one file that needs no network, with plots, tables and pictures.
#define _GNU_SOURCE // memmem
#include "converge.h"

#include "file.h"
#include "gnuplot.h"
#include "image.h"
#include "log.h"
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/utsname.h>

struct page {
    const struct converge *c;
    struct arena *arena;
    const char *folder;
    FILE *out;
};

// --- text ----------------------------------------------------------------------------------------

static void put_escaped(FILE *out, const char *text)
{
    for (; *text; text++) {
        switch (*text) {
        case '&':
            fputs("&amp;", out);
            break;
        case '<':
            fputs("&lt;", out);
            break;
        case '"':
            fputs("&quot;", out);
            break;
        default:
            fputc(*text, out);
        }
    }
}

static void put_base64(FILE *out, const unsigned char *bytes, size_t count)
{
    static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    for (size_t i = 0; i < count; i += 3) {
        uint32_t group = (uint32_t)bytes[i] << 16;
        group |= i + 1 < count ? (uint32_t)bytes[i + 1] << 8 : 0u;
        group |= i + 2 < count ? bytes[i + 2] : 0u;
        fputc(digits[group >> 18], out);
        fputc(digits[group >> 12 & 63u], out);
        fputc(i + 1 < count ? digits[group >> 6 & 63u] : '=', out);
        fputc(i + 2 < count ? digits[group & 63u] : '=', out);
    }
}

static void put_interval(FILE *out, struct interval i, const char *format)
{
    if (isnan(i.value)) {
        fputs("<td>not known</td>", out);
        return;
    }
    char text[3][32];
    snprintf(text[0], sizeof text[0], format, i.value);
    snprintf(text[1], sizeof text[1], format, i.low);
    snprintf(text[2], sizeof text[2], format, i.high);
    fprintf(out, "<td>%s <small>[%s, %s]</small></td>", text[0], text[1], text[2]);
}

// --- plots ---------------------------------------------------------------------------------------

// gnuplot knows escapes in double quotes only; single ones are doubled.
static void put_quoted(FILE *out, const char *text)
{
    fputc('\'', out);
    for (; *text; text++) {
        if (*text == '\'')
            fputc('\'', out);
        fputc(*text, out);
    }
    fputc('\'', out);
}

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
        if (c->curves[i].scene == scene)
            put_data(out, c, &c->curves[i], i, over_time);
    for (uint32_t i = 0; i < c->curve_count; i++) {
        if (c->curves[i].scene != scene)
            continue;
        fprintf(out,
                "%s$curve%u using 1:2:3:4 with yerrorlines linewidth 2 pointtype 7 "
                "pointsize .4 title ",
                separator, i);
        put_quoted(out, converge_label(&c->curves[i]));
        separator = ", \\\n     ";
    }
    fputc('\n', out);
}

// A plot's SVG without its XML declaration, inline.
static bool put_plot(struct page *page, uint32_t scene, bool over_time, struct err *err)
{
    char *script = NULL;
    size_t size = 0;
    FILE *file = open_memstream(&script, &size);
    if (!file)
        return err_memory(err, "a plot", 0);
    put_script(file, page->c, scene, over_time);
    const char *path = arena_printf(page->arena, "%s/%s-%u", page->folder,
                                    over_time ? "error-time" : "error-samples", scene);
    bool ok = fclose(file) == 0 && path;
    struct err failure = {0};
    struct file_bytes svg = {0};
    if (ok && gnuplot_run(script, path, &failure)) {
        path = arena_printf(page->arena, "%s.svg", path);
        ok = path && file_read(page->arena, path, SIZE_MAX, &svg, err);
        const char *begin = ok ? memmem(svg.data, svg.size, "<svg", 4) : NULL;
        if (begin)
            fwrite(begin, 1, svg.size - (size_t)(begin - (const char *)svg.data), page->out);
    } else if (ok) {
        log_warn("no plots: %s", failure.msg);
        fputs("<p>No plot: gnuplot is not there, or failed.</p>\n", page->out);
    }
    free(script);
    return ok || err_memory(err, "a plot", size);
}

// --- pictures ------------------------------------------------------------------------------------

static bool put_picture(struct page *page, const char *name, const struct image *image,
                        const char *attributes, struct err *err)
{
    const char *path = arena_printf(page->arena, "%s/%s.png", page->folder, name);
    struct image_write_params params = {.path = path, .image = image};
    struct file_bytes png = {0};
    if (!path)
        return err_memory(err, "file names", 0);
    if (!image_write(&params, err) || !file_read(page->arena, path, SIZE_MAX, &png, err))
        return false;
    fprintf(page->out, "<img %s src=\"data:image/png;base64,", attributes);
    put_base64(page->out, png.data, png.size);
    fputs("\">", page->out);
    return true;
}

// Relative differences in false colours, which are display values.
static bool put_error_map(struct page *page, const char *name, const struct image *image,
                          const struct converge_reference *reference, struct err *err)
{
    uint64_t count = (uint64_t)image->width * image->height;
    struct image map = {image->width, image->height,
                        arena_alloc(page->arena, count, sizeof *map.pixels)};
    if (!map.pixels)
        return err_memory(err, "an error map", count * sizeof *map.pixels);
    metrics_difference_picture((const float(*)[3])image->pixels,
                               (const float(*)[3])reference->pixels, count, map.pixels);
    for (uint64_t i = 0; i < count; i++)
        for (int k = 0; k < 3; k++)
            map.pixels[i][k] = image_srgb_to_linear(map.pixels[i][k]);
    return put_picture(page, name, &map, "", err);
}

// Picture and reference one above the other: the slider cuts the upper one off.
static bool put_slider(struct page *page, uint32_t index, struct err *err)
{
    const struct converge *c = page->c;
    const struct converge_curve *curve = &c->curves[index];
    const struct converge_reference *reference = &c->references[curve->scene];
    const struct settings *settings = &curve->scene_data.settings;
    struct image image = {settings->width, settings->height, curve->pictures[0]};
    struct image truth = {settings->width, settings->height, reference->pixels};
    const char *name = arena_printf(page->arena, "curve-%u", index);
    const char *map = arena_printf(page->arena, "curve-%u-error", index);
    const char *base = arena_printf(page->arena, "reference-%u", curve->scene);
    if (!name || !map || !base)
        return err_memory(err, "file names", 0);
    fputs("<figure><figcaption>", page->out);
    put_escaped(page->out, converge_label(curve));
    fputs("</figcaption><div class=\"slider\">", page->out);
    if (reference->name && !put_picture(page, base, &truth, "", err))
        return false;
    if (!put_picture(page, name, &image, "class=\"over\"", err))
        return false;
    if (reference->name)
        fputs(
            "<input type=\"range\" min=\"0\" max=\"100\" value=\"100\" title=\"left: the curve's "
            "picture, right: the reference\" oninput=\"this.previousElementSibling.style.clipPath="
            "'inset(0 '+(100-this.value)+'% 0 0)'\">",
            page->out);
    fputs("</div>", page->out);
    if (reference->name && !put_error_map(page, map, &image, reference, err))
        return false;
    fputs("</figure>\n", page->out);
    return true;
}

// --- tables --------------------------------------------------------------------------------------

static void put_row(struct page *page, uint32_t index)
{
    const struct converge *c = page->c;
    const struct converge_curve *curve = &c->curves[index];
    FILE *out = page->out;
    uint32_t last = c->point_count - 1;
    fputs("<tr><th>", out);
    put_escaped(out, converge_label(curve));
    fputs("</th>", out);
    put_interval(out, curve->error[last], "%.3g");
    put_interval(out, curve->slope, "%.3f");
    put_interval(out, curve->seconds[last], "%.3g");
    put_interval(out, curve->efficiency, "%.3g");
    put_interval(out, curve->ratio, "%.3g");
    fprintf(out, "<td>%s</td>", converge_verdict(curve));
    for (int i = 0; i < CONVERGE_TARGETS; i++) {
        if (isnan(curve->time_to[i]))
            fputs("<td>not known</td>", out);
        else
            fprintf(out, "<td>%.3g%s</td>", curve->time_to[i], curve->extrapolated[i] ? "*" : "");
    }
    put_interval(out, curve->bias, "%.2g");
    const struct converge_sample *first = converge_at(c, curve, 0, last);
    for (int m = CONVERGE_SMAPE; m < CONVERGE_METRICS; m++)
        fprintf(out, "<td>%.4g</td>", first->metric[m]);
    fputs("</tr>\n", out);
}

static bool put_scene(struct page *page, uint32_t scene, struct err *err)
{
    const struct converge *c = page->c;
    FILE *out = page->out;
    fputs("<h2>", out);
    put_escaped(out, c->options->arguments[scene]);
    fputs("</h2>\n<div class=\"plots\">", out);
    if (!put_plot(page, scene, false, err) || !put_plot(page, scene, true, err))
        return false;
    fputs("</div>\n<table><tr><th>curve</th><th>relMSE at the end</th><th>slope</th><th>seconds"
          "</th><th>efficiency</th><th>ratio to the first</th><th></th><th>s to 1e-2</th><th>to "
          "1e-3</th><th>to 1e-4</th><th>bias</th><th>SMAPE</th><th>PSNR</th><th>SSIM"
          "</th><th>FLIP</th></tr>\n",
          out);
    for (uint32_t i = 0; i < c->curve_count; i++)
        if (c->curves[i].scene == scene)
            put_row(page, i);
    fputs("</table>\n<div class=\"pictures\">", out);
    for (uint32_t i = 0; i < c->curve_count; i++)
        if (c->curves[i].scene == scene && !put_slider(page, i, err))
            return false;
    fputs("</div>\n", out);
    return true;
}

static void put_machine(struct page *page)
{
    const struct converge *c = page->c;
    struct utsname system;
    FILE *out = page->out;
    fputs("<h2>How this was made</h2>\n<p>Device: ", out);
    put_escaped(out, c->gpu.info.name);
    fputs(", ", out);
    put_escaped(out, c->gpu.info.driver);
    if (uname(&system) == 0)
        fprintf(out, ". System: %s %s, %s", system.sysname, system.release, system.machine);
    fprintf(out,
            ". Lampyris %s, %u replicates.</p>\n<p>Errors are geometric means over replicates with "
            "95 %% intervals of Student's t. Times are of rendering alone; those to an error add "
            "loading, building and compiling, and follow 1/t from the last point; * marks those "
            "beyond it. Efficiency is 1 / (relMSE &times; seconds). Bias is what of relMSE more "
            "samples would not remove: there is some where the interval is above 0. SMAPE, "
            "PSNR, SSIM and FLIP are of the first replicate.</p>\n<pre>",
            LAMPYRIS_VERSION, c->replicates_done);
    put_escaped(out, c->options->command_line);
    fputs("</pre>\n", out);
}

static const char head[] =
    "<!DOCTYPE html>\n<html lang=\"en\"><meta charset=\"utf-8\"><title>Error against time</title>\n"
    "<style>body{font:15px sans-serif;margin:2em;max-width:1280px}table{border-collapse:collapse;"
    "font-size:13px}td,th{border:1px solid #bbb;padding:3px "
    "6px;text-align:right}th{text-align:left}"
    "small{color:#666}figure{display:inline-block;margin:8px}.slider{position:relative;display:"
    "inline-block}.slider img{display:block}.slider .over{position:absolute;left:0;top:0}.slider "
    ".over:first-child{position:static}.slider input{position:absolute;left:0;bottom:0;width:100%;"
    "margin:0}.plots svg{width:49%;height:auto}pre{white-space:pre-wrap}</style>\n"
    "<h1>Error against run time</h1>\n";

static bool put_page(struct page *page, struct err *err)
{
    fputs(head, page->out);
    for (uint32_t scene = 0; scene < page->c->options->argument_count; scene++)
        if (!put_scene(page, scene, err))
            return false;
    put_machine(page);
    return true;
}

bool converge_write_html(struct converge *c, const char *folder, struct err *err)
{
    char *text = NULL;
    size_t size = 0;
    const char *path = arena_printf(&c->arena, "%s/report.html", folder);
    struct page page = {.c = c, .arena = &c->arena, .folder = folder};
    page.out = open_memstream(&text, &size);
    if (!page.out || !path)
        return err_memory(err, "report.html", 0);
    bool ok = put_page(&page, err);
    if (fclose(page.out) != 0 && ok)
        ok = err_memory(err, "report.html", size);
    ok = ok && file_write_atomic(path, text, size, err);
    free(text);
    return ok;
}
