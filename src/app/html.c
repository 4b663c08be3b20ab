#define _GNU_SOURCE // memmem
#include "html.h"

#include "file.h"
#include "gnuplot.h"
#include "log.h"
#include "machine.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char head[] =
    "<!DOCTYPE html>\n<html lang=\"en\"><meta charset=\"utf-8\"><title>%s</title>\n"
    "<style>body{font:15px sans-serif;margin:2em;max-width:1280px}table{border-collapse:collapse;"
    "font-size:13px}td,th{border:1px solid #bbb;padding:3px "
    "6px;text-align:right}th{text-align:left}"
    "small{color:#666}figure{display:inline-block;margin:8px}.slider{position:relative;display:"
    "inline-block}.slider img{display:block}.slider .over{position:absolute;left:0;top:0}.slider "
    ".over:first-child{position:static}.slider input{position:absolute;left:0;bottom:0;width:100%%;"
    "margin:0}.plots svg{width:49%%;height:auto}pre{white-space:pre-wrap}</style>\n"
    "<h1>%s</h1>\n";

bool html_begin(struct html_page *page, struct arena *arena, const char *folder, const char *title,
                struct err *err)
{
    *page = (struct html_page){.arena = arena, .folder = folder};
    page->out = open_memstream(&page->text, &page->size);
    if (!page->out)
        return err_memory(err, "report.html", 0);
    fprintf(page->out, head, title, title);
    return true;
}

bool html_end(struct html_page *page, bool ok, struct err *err)
{
    const char *path = arena_printf(page->arena, "%s/report.html", page->folder);
    if (page->out && fclose(page->out) != 0 && ok)
        ok = err_memory(err, "report.html", page->size);
    if (ok && !path)
        ok = err_memory(err, "file names", strlen(page->folder));
    ok = ok && file_write_atomic(path, page->text, page->size, err);
    free(page->text);
    return ok;
}

// --- text ----------------------------------------------------------------------------------------

void html_text(struct html_page *page, const char *text)
{
    FILE *out = page->out;
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

// Formats are the callers' literals, of one double.
#pragma GCC diagnostic ignored "-Wformat-nonliteral"

void html_interval(struct html_page *page, struct interval i, const char *format)
{
    if (isnan(i.value)) {
        fputs("<td>not known</td>", page->out);
        return;
    }
    fputs("<td>", page->out);
    fprintf(page->out, format, i.value);
    fputs(" <small>[", page->out);
    fprintf(page->out, format, i.low);
    fputs(", ", page->out);
    fprintf(page->out, format, i.high);
    fputs("]</small></td>", page->out);
}

void html_number(struct html_page *page, double value, const char *format)
{
    if (isnan(value)) {
        fputs("<td>not known</td>", page->out);
        return;
    }
    fputs("<td>", page->out);
    fprintf(page->out, format, value);
    fputs("</td>", page->out);
}

// --- plots ---------------------------------------------------------------------------------------

// gnuplot knows escapes in double quotes only; single ones are doubled.
void html_plot_words(FILE *script, const char *text)
{
    fputc('\'', script);
    for (; *text; text++) {
        if (*text == '\'')
            fputc('\'', script);
        fputc(*text, script);
    }
    fputc('\'', script);
}

// A plot's SVG without its XML declaration, inline.
bool html_plot(struct html_page *page, const char *name, const char *script, struct err *err)
{
    const char *path = arena_printf(page->arena, "%s/%s", page->folder, name);
    const char *svg_path = arena_printf(page->arena, "%s/%s.svg", page->folder, name);
    struct err failure = {0};
    struct file_bytes svg;
    if (!path || !svg_path)
        return err_memory(err, "file names", strlen(name));
    if (!gnuplot_run(script, path, &failure)) {
        log_warn("no plots: %s", failure.msg);
        fputs("<p>No plot: gnuplot is not there, or failed.</p>\n", page->out);
        return true;
    }
    if (!file_read(page->arena, svg_path, SIZE_MAX, &svg, err))
        return false;
    const char *begin = memmem(svg.data, svg.size, "<svg", 4);
    if (begin)
        fwrite(begin, 1, svg.size - (size_t)(begin - (const char *)svg.data), page->out);
    return true;
}

// --- pictures ------------------------------------------------------------------------------------

bool html_picture(struct html_page *page, const char *name, const struct image *image,
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

void html_linearize(struct image *image)
{
    uint64_t count = (uint64_t)image->width * image->height;
    for (uint64_t i = 0; i < count; i++)
        for (int k = 0; k < 3; k++)
            image->pixels[i][k] = image_srgb_to_linear(image->pixels[i][k]);
}

// --- the machine ---------------------------------------------------------------------------------

void html_machine(struct html_page *page, const struct gpu *gpu, const char *command)
{
    const struct machine machine = machine_describe();
    fputs("<h2>How this was made</h2>\n<p>Device: ", page->out);
    html_text(page, gpu->info.name);
    fputs(", ", page->out);
    html_text(page, gpu->info.driver);
    fputs(". Machine: ", page->out);
    html_text(page, machine.processor);
    fprintf(page->out, ", %u threads, %.1f GiB; ", machine.threads,
            machine.memory_bytes / 1073741824.0);
    html_text(page, machine.system);
    fprintf(page->out, ". Lampyris %s.</p>\n<pre>", LAMPYRIS_VERSION);
    html_text(page, command);
    fputs("</pre>\n", page->out);
}
