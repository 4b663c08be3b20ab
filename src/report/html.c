#include "report/html.h"

#include "base/file.h"
#include "base/file_inputs.h"
#include "base/log.h"
#include "report/gnuplot.h"
#include "report/machine.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

// Two pictures one above the other: a range input cuts the upper one off.
static const char head[] =
    "<!DOCTYPE html>\n<html lang=\"en\"><meta charset=\"utf-8\"><title>%s</title>\n"
    "<meta name=\"viewport\" content=\"width=device-width,initial-scale=1\">\n<style>\n"
    "body{font:15px/1.5 system-ui,sans-serif;color:#1d2733;background:#fff;margin:2em auto;"
    "padding:0 1.5em;max-width:1280px}\n"
    "h1{font-size:1.6em;font-weight:600;margin:0 0 .3em}"
    "h2{font-size:1.2em;font-weight:600;margin:2em 0 .5em;border-bottom:2px solid #dfe4ea}"
    "h3{font-size:1em;font-weight:600;margin:1.5em 0 .4em}\n"
    ".wide{overflow-x:auto}"
    "table{border-collapse:collapse;font-size:13px;font-variant-numeric:tabular-nums}"
    "td,th{border-bottom:1px solid #dfe4ea;padding:4px 9px;text-align:right;vertical-align:top}"
    "th{text-align:left;font-weight:600;white-space:nowrap}tr:first-child th{background:#f3f5f8;"
    "vertical-align:bottom}tr:first-child th+th{text-align:right}\n"
    "td small{display:block;color:#66727f;white-space:nowrap}"
    ".better{background:#e3f4e6}.worse{background:#fbe7e4}.alarm{background:#fbe7e4;"
    "font-weight:600}\n"
    ".note{background:#fff6dd;border-left:4px solid #e0a800;padding:.4em .8em}\n"
    ".plots{display:flex;flex-wrap:wrap;gap:8px}.plots svg{flex:1 1 460px;max-width:620px;"
    "height:auto}\n"
    ".pictures{display:flex;flex-wrap:wrap;gap:14px}figure{margin:0}"
    "figcaption{font-size:13px;max-width:270px;overflow-wrap:anywhere}"
    "figure img{width:128px;margin-right:3px;image-rendering:pixelated}\n"
    ".scale{font-size:12px;display:inline-block;margin:.5em 0}.scale img{display:block;width:320px;"
    "height:12px}.scale span{display:flex;justify-content:space-between}\n"
    ".slider{position:relative;display:inline-block;line-height:0}"
    ".slider img{width:100%%;image-rendering:pixelated}"
    ".slider .over{position:absolute;left:0;top:0;clip-path:inset(0 50%% 0 0)}"
    ".slider input{position:absolute;left:0;bottom:0;width:100%%;margin:0;opacity:.85}\n"
    "pre{white-space:pre-wrap;overflow-wrap:anywhere;background:#f3f5f8;padding:.6em .8em;"
    "font-size:12px}</style>\n"
    "<h1>%s</h1>\n";

bool html_check_files(const char *folder, struct arena *arena, struct err *err)
{
    static const char *const names[] = {"report.html", "results.json", "results.csv"};
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
        const char *path = arena_printf(arena, "%s/%s", folder, names[i]);
        if (!path)
            return err_memory(err, "file names", strlen(folder));
        if (!file_inputs_check(path, err))
            return false;
    }
    return true;
}

bool html_check_file(const char *path, struct err *err)
{
    if (path && !path_has_extension(path, "html") && !path_has_extension(path, "htm"))
        return err_set(err, ERR_USAGE, "%s: expected a name that ends in .html", path);
    return !path || (file_inputs_check(path, err) && file_check_writable(path, err));
}

bool html_begin(struct html_page *page, struct arena *arena, const char *folder, const char *title,
                struct err *err)
{
    *page = (struct html_page){.arena = arena, .folder = folder};
    if (!memory_stream_open(&page->stream))
        return err_memory(err, "report.html", 0);
    page->out = page->stream.file;
    fprintf(page->out, head, title, title);
    return true;
}

bool html_end(struct html_page *page, bool ok, struct err *err)
{
    const char *path =
        page->path ? page->path : arena_printf(page->arena, "%s/report.html", page->folder);
    if (page->out && !memory_stream_close(&page->stream) && ok)
        ok = err_memory(err, "report.html", page->stream.size);
    if (ok && !path)
        ok = err_memory(err, "file names", strlen(page->folder));
    ok = ok && file_write_atomic(path, page->stream.text, page->stream.size, err);
    memory_stream_finish(&page->stream);
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

void html_value(struct html_page *page, struct interval i, const char *format)
{
    fprintf(page->out, format, i.value);
    if (isnan(i.low) || isnan(i.high))
        return;
    fputs(" <small>[", page->out);
    fprintf(page->out, format, i.low);
    fputs(", ", page->out);
    fprintf(page->out, format, i.high);
    fputs("]</small>", page->out);
}

void html_interval(struct html_page *page, struct interval i, const char *format)
{
    fputs("<td>", page->out);
    if (isnan(i.value))
        fputs("not known", page->out);
    else
        html_value(page, i, format);
    fputs("</td>", page->out);
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

static bool keep_part(struct html_page *page, const char *name, const char *extension,
                      const void *data, size_t size, struct err *err)
{
    if (!page->keeps_parts)
        return true;
    const char *path = arena_printf(page->arena, "%s/%s.%s", page->folder, name, extension);
    return path ? file_write_atomic(path, data, size, err)
                : err_memory(err, "file names", strlen(name));
}

// The SVG goes in without its XML declaration.
bool html_plot(struct html_page *page, const char *name, const char *script, struct err *err)
{
    struct err failure = {0};
    char *svg;
    if (!keep_part(page, name, "gp", script, strlen(script), err))
        return false;
    if (page->has_no_plots || !gnuplot_run(script, page->arena, &svg, &failure)) {
        if (!page->has_no_plots) {
            log_warn("no plots: %s", failure.msg);
            fputs("<p class=\"note\">No plots: gnuplot is not there, or failed.</p>\n", page->out);
        }
        page->has_no_plots = true;
        return true;
    }
    const char *begin = strstr(svg, "<svg");
    fputs(begin ? begin : svg, page->out);
    return keep_part(page, name, "svg", svg, strlen(svg), err);
}

// --- pictures ------------------------------------------------------------------------------------

bool html_picture(struct html_page *page, const char *name, const struct image *image,
                  const char *attributes, struct err *err)
{
    const struct image_write_params params = {
        .path = "a picture.png",
        .image = image,
        .exposure_stops = page->exposure_stops,
        .tone = page->tone,
    };
    uint8_t *png;
    size_t size;
    if (!image_encode(&params, page->arena, &png, &size, err) ||
        !keep_part(page, name, "png", png, size, err))
        return false;
    fprintf(page->out, "<img %s src=\"data:image/png;base64,", attributes);
    put_base64(page->out, png, size);
    fputs("\">", page->out);
    return true;
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
