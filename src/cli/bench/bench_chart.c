#include "cli/bench/bench_chart.h"

#include "base/memory_stream.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct chart {
    struct html_page *page;
    const struct bench *b;
    const struct bench_variant *first;
    uint32_t count;
};

static const char head[] =
    "set terminal svg size 620,440 dynamic font 'sans-serif,12' noenhanced background 'white'\n"
    "set grid ytics lc '#dddddd'\nset border 3\nset tics nomirror\n";

// --- one bar per variant -------------------------------------------------------------------------

// Returns whether a kernel is in the chart of stacked bars, which shows all kernels that at least
// one variant runs, and the host's work.
static bool is_stacked(const struct chart *c, int kernel)
{
    for (uint32_t i = 0; i < c->count; i++)
        for (uint32_t r = 0; r < c->first[i].row_count; r++) {
            const struct bench_row *row = &c->first[i].rows[r];
            if (row->kind == BENCH_KERNEL && (int)row->kernel == kernel && row->median.value > 0)
                return true;
        }
    return false;
}

static double stacked_ms(const struct bench_variant *v, int kernel)
{
    double sum = 0.0;
    for (uint32_t r = 0; r < v->row_count; r++) {
        const struct bench_row *row = &v->rows[r];
        bool is_host = row->kind == BENCH_HOST && kernel == KERNEL_COUNT;
        bool is_kernel = row->kind == BENCH_KERNEL && (int)row->kernel == kernel;
        if ((is_host || is_kernel) && isfinite(row->median.value))
            sum += row->median.value;
    }
    return fmax(sum, 0.0);
}

// Writes a label; in gnuplot's data, text must be in double quotes.
static void put_tick(FILE *out, const char *label)
{
    fputc('"', out);
    for (; *label; label++)
        fputc(*label == '"' || *label == '\\' ? '\'' : *label, out);
    fputc('"', out);
}

static bool write_bars(const struct chart *c, FILE *out)
{
    if (!bench_wall(c->first))
        return false;
    fputs(head, out);
    fputs("set style data histograms\nset style histogram rowstacked\nset style fill solid 0.85 "
          "noborder\nset boxwidth 0.7\nset ylabel 'ms per frame'\nset yrange [0:*]\nset key "
          "outside right top invert reverse Left\n",
          out);
    if (c->count > 3)
        fputs("set xtics rotate by -35\n", out);
    fputs("$data << EOD\n", out);
    for (uint32_t i = 0; i < c->count; i++) {
        put_tick(out, bench_label(&c->first[i]));
        for (int k = 0; k <= KERNEL_COUNT; k++)
            if (k == KERNEL_COUNT || is_stacked(c, k))
                fprintf(out, " %.6g", stacked_ms(&c->first[i], k));
        fputc('\n', out);
    }
    fputs("EOD\nplot ", out);
    int column = 2;
    for (int k = 0; k < KERNEL_COUNT; k++) {
        if (!is_stacked(c, k))
            continue;
        fprintf(out, "$data using %d%s title '%s' lc %d, ", column, column == 2 ? ":xtic(1)" : "",
                kernel_code((enum kernel_id)k, true).name, column);
        column++;
    }
    fprintf(out, "$data using %d%s title 'host' lc rgb '#999999'\n", column,
            column == 2 ? ":xtic(1)" : "");
    return true;
}

// --- occupancy by bounce -------------------------------------------------------------------------

// Returns whether no earlier variant has the same image; variants with the same image have the same
// rays.
static bool is_new_picture(const struct chart *c, uint32_t i)
{
    for (uint32_t k = 0; k < i; k++)
        if (variants_share_picture(&c->first[k].variant, &c->first[i].variant))
            return false;
    return true;
}

static bool write_bounces(const struct chart *c, FILE *out)
{
    if (!c->first->bounces || c->first->bounce_count < 2)
        return false;
    fputs(head, out);
    fputs("set ylabel '% of the paths'\nset xlabel 'bounce'\nset yrange [0:*]\nset xtics 1\n"
          "set key top right\n",
          out);
    for (uint32_t i = 0; i < c->count; i++) {
        const struct bench_variant *v = &c->first[i];
        if (!is_new_picture(c, i))
            continue;
        fprintf(out, "$v%u << EOD\n", i);
        for (uint32_t n = 0; n < v->bounce_count; n++)
            fprintf(out, "%u %.6g %.6g\n", n, 100.0 * bench_occupancy(v, n),
                    100.0 * (double)v->bounces[n].items[KERNEL_intersect_shadow] /
                        (double)v->paths);
        fputs("EOD\n", out);
    }
    const char *separator = "plot ";
    for (uint32_t i = 0; i < c->count; i++) {
        const char *label = *c->first[i].variant.picture ? c->first[i].variant.picture : "";
        if (!is_new_picture(c, i))
            continue;
        for (int shadow = 0; shadow < 2; shadow++) {
            fprintf(out, "%s$v%u using 1:%d with linespoints lc %u lw 2 pt %d ps .6%s title ",
                    separator, i, 2 + shadow, i + 1, shadow ? 6 : 7, shadow ? " dt 2" : "");
            char title[256];
            snprintf(title, sizeof title, "%s%s%s", shadow ? "shadow rays" : "rays",
                     *label ? ", " : "", label);
            html_plot_words(out, title);
            separator = ", ";
        }
    }
    fputc('\n', out);
    return true;
}

// --- time against a number that varies -----------------------------------------------------------

// Returns the number in the variant's label "KEY=VALUE"; NAN if it is a word, or if several options
// vary.
static double swept_number(const struct bench_variant *v)
{
    const char *value = strchr(v->variant.label, '=');
    char *end;
    if (!value || strchr(v->variant.label, ' ') || value[1] == '\0')
        return NAN;
    double number = strtod(value + 1, &end);
    static const char suffixes[] = "kMG";
    const char *suffix = *end ? strchr(suffixes, *end) : NULL;
    if (suffix) {
        number *= pow(1024.0, (double)(suffix - suffixes + 1));
        end++;
    }
    return *end || !(number > 0) ? NAN : number;
}

static bool write_sweep(const struct chart *c, FILE *out)
{
    if (c->count < 2 || !bench_wall(c->first))
        return false;
    size_t key = strcspn(c->first->variant.label, "=");
    for (uint32_t i = 0; i < c->count; i++)
        if (isnan(swept_number(&c->first[i])) ||
            strncmp(c->first[i].variant.label, c->first->variant.label, key + 1) != 0)
            return false;
    double least = INFINITY, most = 0.0;
    for (uint32_t i = 0; i < c->count; i++) {
        least = fmin(least, swept_number(&c->first[i]));
        most = fmax(most, swept_number(&c->first[i]));
    }
    fputs(head, out);
    fprintf(out, "set xrange [%.9g:%.9g]\n", least / 1.2, most * 1.2);
    fprintf(out,
            "set logscale x 2\nset ylabel 'ms per frame'\nset yrange [0:*]\nset key off\nset "
            "xlabel '%.*s'\nset xtics (",
            (int)key, c->first->variant.label);
    for (uint32_t i = 0; i < c->count; i++) {
        fputs(i ? ", " : "", out);
        html_plot_words(out, c->first[i].variant.label + key + 1);
        fprintf(out, " %.9g", swept_number(&c->first[i]));
    }
    fputs(")\n$data << EOD\n", out);
    for (uint32_t i = 0; i < c->count; i++) {
        struct interval ms = bench_wall(&c->first[i])->median;
        fprintf(out, "%.9g %.6g %.6g %.6g\n", swept_number(&c->first[i]), ms.value,
                isnan(ms.low) ? ms.value : ms.low, isnan(ms.high) ? ms.value : ms.high);
    }
    fputs("EOD\nplot $data using 1:2:3:4 with yerrorlines lw 2 pt 7 ps .6\n", out);
    return true;
}

// --- single kernels against the depth ------------------------------------------------------------

// Writes the points of a kernel's rows and returns their number. The rows form a line: camera rays
// first, then scattered rays. Nothing is written if `out` is NULL.
static uint32_t write_line(const struct bench_variant *v, enum kernel_id kernel, FILE *out)
{
    uint32_t points = 0;
    for (uint32_t r = 0; r < v->row_count; r++) {
        const struct bench_row *row = &v->rows[r];
        struct interval ms = row->median;
        double items = (double)row->items * 1e-3;
        if (row->kind != BENCH_ALONE || row->kernel != kernel || !(ms.value > 0))
            continue;
        points++;
        if (out)
            fprintf(out, "%u %.6g %.6g %.6g\n", row->depth, items / ms.value,
                    items / (isnan(ms.high) ? ms.value : ms.high),
                    items / (isnan(ms.low) ? ms.value : ms.low));
    }
    return points;
}

// If `data` is set, writes the points of all variants and kernels; otherwise the commands that draw
// them. Returns the number of lines.
static uint32_t write_lines(const struct chart *c, bool data, FILE *out)
{
    uint32_t lines = 0;
    for (uint32_t i = 0; i < c->count; i++) {
        const struct bench_variant *v = &c->first[i];
        for (int k = 0; k < KERNEL_COUNT; k++) {
            if (write_line(v, (enum kernel_id)k, NULL) == 0)
                continue;
            lines++;
            if (data) {
                fprintf(out, "$l%u << EOD\n", lines);
                write_line(v, (enum kernel_id)k, out);
                fputs("EOD\n", out);
                continue;
            }
            char title[256];
            snprintf(title, sizeof title, "%s%s%s", kernel_code((enum kernel_id)k, true).name,
                     c->count > 1 ? ", " : "", c->count > 1 ? bench_label(v) : "");
            fprintf(out, "%s$l%u using 1:2:3:4 with yerrorlines lw 2 pt 7 ps .6 title ",
                    lines > 1 ? ", " : "plot ", lines);
            html_plot_words(out, title);
        }
    }
    return lines;
}

static bool write_depths(const struct chart *c, FILE *out)
{
    uint32_t deepest = 0;
    for (uint32_t r = 0; r < c->first->row_count; r++)
        if (c->first->rows[r].kind == BENCH_ALONE && c->first->rows[r].depth > deepest)
            deepest = c->first->rows[r].depth;
    fputs(head, out);
    fprintf(out,
            "set ylabel 'million items per second'\nset xlabel 'depth'\nset yrange [0:*]\nset "
            "xtics 1\nset xrange [-.2:%u.2]\nset key outside bottom center horizontal\n",
            deepest);
    if (deepest == 0 || write_lines(c, true, out) == 0)
        return false;
    write_lines(c, false, out);
    fputc('\n', out);
    return true;
}

// --- all charts ----------------------------------------------------------------------------------

static bool put(const struct chart *c, const char *kind,
                bool (*write)(const struct chart *, FILE *), struct err *err)
{
    struct memory_stream stream;
    const char *name = arena_printf(c->page->arena, "%s-%u", kind, c->first->variant.scene);
    if (!name || !memory_stream_open(&stream))
        return err_memory(err, "a chart", 0);
    bool there = write(c, stream.file);
    bool ok = memory_stream_close(&stream) || err_memory(err, "a chart", stream.size);
    ok = ok && (!there || html_plot(c->page, name, stream.text, err));
    memory_stream_finish(&stream);
    return ok;
}

bool bench_put_charts(struct html_page *page, const struct bench *b,
                      const struct bench_variant *first, uint32_t count, struct err *err)
{
    const struct chart chart = {page, b, first, count};
    return put(&chart, "kernels", write_bars, err) && put(&chart, "bounces", write_bounces, err) &&
           put(&chart, "sweep", write_sweep, err) && put(&chart, "depths", write_depths, err);
}
