#include "report/html.h"

#include "base/file.h"
#include "base/file_inputs.h"
#include "base/log.h"
#include "embedded_page.h"
#include "report/gnuplot.h"
#include "report/machine.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char head[] =
    "<!DOCTYPE html>\n<html lang=\"en\"><meta charset=\"utf-8\"><title>%s</title>\n"
    "<meta name=\"viewport\" content=\"width=device-width,initial-scale=1\">\n<style>\n";

// The style and the code of the page, embedded from the files in this folder.
static const char style[] = EMBEDDED_PAGE_CSS;
static const char *const scripts[] = {EMBEDDED_FIGURE_JS, EMBEDDED_VIEWER_JS,
                                      EMBEDDED_VIEWER_FIGURES_JS};

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
        return err_set(err, ERR_USAGE, "%s: expected a name that ends in .html or .htm", path);
    return !path || (file_inputs_check(path, err) && file_check_writable(path, err));
}

bool html_begin(struct html_page *page, struct arena *arena, const char *folder, const char *title,
                struct err *err)
{
    *page = (struct html_page){.arena = arena, .folder = folder};
    if (!memory_stream_open(&page->stream))
        return err_memory(err, "report.html", 0);
    page->out = page->stream.file;
    fprintf(page->out, head, title);
    fputs(style, page->out);
    fprintf(page->out, "</style>\n<h1>%s</h1>\n", title);
    return true;
}

// Writes the page's scripts. Only pages with viewers or plots have any.
static void put_scripts(struct html_page *page)
{
    if (page->viewers == 0 && !page->has_plots)
        return;
    for (size_t i = 0; i < sizeof scripts / sizeof scripts[0]; i++) {
        fputs("<script>\n", page->out);
        fputs(scripts[i], page->out);
        fputs("</script>\n", page->out);
    }
}

bool html_end(struct html_page *page, bool ok, struct err *err)
{
    const char *path =
        page->path ? page->path : arena_printf(page->arena, "%s/report.html", page->folder);
    if (page->out)
        put_scripts(page);
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

void html_base64(struct html_page *page, const uint8_t *bytes, size_t count)
{
    FILE *out = page->out;
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

// Writes a digit of base 91. Two digits represent 13 bits, because 91 * 91 >= 2^13. So 16
// characters carry 13 bytes, which is 8 % more per character than in base64. The digits are the
// characters from '#' on; '~' replaces '<', which could end a script element.
static void put_digit(FILE *out, uint32_t digit)
{
    const int character = '#' + (int)digit;
    fputc(character == '<' ? '~' : character, out);
}

void html_base91(struct html_page *page, const uint8_t *bytes, size_t count)
{
    uint32_t bits = 0, bit_count = 0; // the next bits to be written, and their number
    for (size_t i = 0; i < count || bit_count > 0;) {
        for (; bit_count < 13 && i < count; bit_count += 8)
            bits |= (uint32_t)bytes[i++] << bit_count;
        put_digit(page->out, (bits & 8191u) % 91u);
        put_digit(page->out, (bits & 8191u) / 91u);
        bits >>= 13;
        bit_count = bit_count > 13 ? bit_count - 13 : 0;
    }
}

// All formats are string literals of the callers with a single double.
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

// Writes a text in single quotes. gnuplot has no escapes there, so quotes in the text are doubled.
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

// The plot's SVG is embedded without its XML declaration.
bool html_plot(struct html_page *page, const char *name, const char *script, struct err *err)
{
    struct err failure = {0};
    char *svg;
    if (!keep_part(page, name, "gp", script, strlen(script), err))
        return false;
    if (page->has_no_plots || !gnuplot_run(script, page->arena, &svg, &failure)) {
        if (!page->has_no_plots) {
            log_warn("no plots: %s", failure.msg);
            fputs("<p class=\"note\">There are no plots, because gnuplot is not installed or "
                  "failed.</p>\n",
                  page->out);
        }
        page->has_no_plots = true;
        return true;
    }
    const char *begin = strstr(svg, "<svg");
    fprintf(page->out, "<figure class=\"plot\" data-name=\"%s\"><div class=\"paper\">", name);
    fputs(begin ? begin : svg, page->out);
    fputs("</div></figure>\n", page->out);
    page->has_plots = true;
    return keep_part(page, name, "svg", svg, strlen(svg), err);
}

// --- images --------------------------------------------------------------------------------------

static bool encode(struct html_page *page, const char *name, const struct image *image,
                   uint8_t **png, size_t *size, struct err *err)
{
    const struct image_write_params params = {
        .path = "a picture.png",
        .image = image,
        .exposure_stops = page->exposure_stops,
        .tone = page->tone,
    };
    return image_encode(&params, page->arena, png, size, err) &&
           keep_part(page, name, "png", *png, *size, err);
}

bool html_picture(struct html_page *page, const char *name, const struct image *image,
                  const char *attributes, struct err *err)
{
    uint8_t *png;
    size_t size;
    if (!encode(page, name, image, &png, &size, err))
        return false;
    fprintf(page->out, "<img %s src=\"data:image/png;base64,", attributes);
    html_base64(page, png, size);
    fputs("\">", page->out);
    return true;
}

bool html_keep_picture(struct html_page *page, const char *name, const struct image *image,
                       struct err *err)
{
    uint8_t *png;
    size_t size;
    return !page->keeps_parts || encode(page, name, image, &png, &size, err);
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
