// Makes gnuplot scripts that plot curves.
#include "cli/converge/converge.h"

#include "base/memory_stream.h"
#include "report/html.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

// Returns whether a value can be drawn on the logarithmic axis.
static bool is_drawn(struct interval i)
{
    return isfinite(i.value) && i.value > 0;
}

static double place_of(const struct converge_point *point, bool over_time)
{
    return over_time ? point->seconds.value : point->spp.value;
}

static void put_data(FILE *out, const struct converge *c, const struct converge_curve *curve,
                     uint32_t number, bool over_time)
{
    fprintf(out, "$curve%u << EOD\n", number);
    for (uint32_t p = 0; p < c->point_count; p++) {
        const struct converge_point *point = &curve->points[p];
        struct interval e = point->metric[CONVERGE_LOCAL_RELMSE];
        if (is_drawn(e))
            fprintf(out, "%.9g %.9g %.9g %.9g\n", place_of(point, over_time), e.value,
                    isfinite(e.low) ? e.low : e.value, isfinite(e.high) ? e.high : e.value);
    }
    fputs("EOD\n", out);
}

// The ranges of the axes, which contain all curves of a scene.
struct extent {
    uint32_t curves;
    double x_min, x_max, y_min, y_max;
};

static bool is_in(const struct converge *c, uint32_t i, uint32_t scene)
{
    const struct converge_curve *curve = &c->curves[i];
    if (curve->variant.scene != scene)
        return false;
    for (uint32_t p = 0; p < c->point_count; p++)
        if (is_drawn(curve->points[p].metric[CONVERGE_LOCAL_RELMSE]))
            return true;
    return false;
}

static struct extent find_extent(const struct converge *c, uint32_t scene, bool over_time)
{
    struct extent out = {0, INFINITY, 0, INFINITY, 0};
    for (uint32_t i = 0; i < c->curve_count; i++) {
        if (!is_in(c, i, scene))
            continue;
        out.curves++;
        for (uint32_t p = 0; p < c->point_count; p++) {
            const struct converge_point *point = &c->curves[i].points[p];
            struct interval e = point->metric[CONVERGE_LOCAL_RELMSE];
            if (!is_drawn(e))
                continue;
            out.x_min = fmin(out.x_min, place_of(point, over_time));
            out.x_max = fmax(out.x_max, place_of(point, over_time));
            out.y_min = fmin(out.y_min, fmin(e.value, e.low)); // fmin and fmax ignore NAN
            out.y_max = fmax(out.y_max, fmax(e.value, e.high));
        }
    }
    return out;
}

// Colours that people with colour blindness can distinguish: those of Okabe and Ito (2008) without
// yellow.
#define COLORS 7
static const char style[] = "set logscale xy\nset grid xtics ytics mytics linecolor '#dfe4ea'\n"
                            "set border 3 linecolor '#66727f'\nset tics nomirror\nset bars 0.6\n"
                            "set linetype 1 linecolor '#0072b2' pointtype 7\n"
                            "set linetype 2 linecolor '#d55e00' pointtype 5\n"
                            "set linetype 3 linecolor '#009e73' pointtype 9\n"
                            "set linetype 4 linecolor '#cc79a7' pointtype 11\n"
                            "set linetype 5 linecolor '#56b4e9' pointtype 13\n"
                            "set linetype 6 linecolor '#e69f00' pointtype 6\n"
                            "set linetype 7 linecolor '#000000' pointtype 4\n"
                            "set ylabel 'local relMSE'\nset format y '1e%T'\n";

// Adds tics at 1, 2 and 5 of each decade if the range is short, because gnuplot labels only powers
// of ten.
static void put_tics(FILE *out, char axis, double min, double max)
{
    if (max / min > 100)
        return;
    const char *separator = "";
    fprintf(out, "set %ctics (", axis);
    for (int decade = (int)floor(log10(min)); decade <= (int)floor(log10(max)); decade++)
        for (int i = 0; i < 3; i++) {
            double value = pow(10, decade) * (double[]){1, 2, 5}[i];
            if (value < min || value > max)
                continue;
            fprintf(out, axis == 'y' ? "%s'%.0e' %.9g" : "%s'%g' %.9g", separator, value, value);
            separator = ", ";
        }
    fputs(")\n", out);
}

#define KEY_INSIDE 6 // greatest number of curves whose names fit into a corner of the plot

static void put_frame(FILE *out, const struct converge *c, const struct extent *extent,
                      uint32_t scene, bool over_time)
{
    bool is_inside = extent->curves <= KEY_INSIDE;
    fprintf(out,
            "set terminal svg size %d,420 dynamic font 'sans-serif,12' noenhanced name '%s%u'\n%s",
            is_inside ? 600 : 760, over_time ? "time" : "samples", scene, style);
    fputs(is_inside ? "set key inside bottom left samplen 2 opaque\n"
                    : "set key outside right top samplen 2\n",
          out);
    double left = extent->x_min / 1.25, right = extent->x_max * 1.25;
    double bottom = extent->y_min / 1.5, top = extent->y_max * 1.5;
    fprintf(out, "set xlabel '%s'\nset xrange [%.9g:%.9g]\nset yrange [%.9g:%.9g]\n",
            over_time ? "seconds of rendering" : "samples per pixel", left, right, bottom, top);
    put_tics(out, 'x', left, right);
    put_tics(out, 'y', bottom, top);
    if (c->spp && !over_time) {
        fputs("set xtics (", out);
        for (uint32_t p = 0; p < c->point_count; p++)
            fprintf(out, "%s%llu", p ? ", " : "", (unsigned long long)c->spp[p]);
        fputs(")\n", out);
    }
}

static void put_script(FILE *out, const struct converge *c, const struct extent *extent,
                       uint32_t scene, bool over_time)
{
    put_frame(out, c, extent, scene, over_time);
    for (uint32_t i = 0; i < c->curve_count; i++)
        if (is_in(c, i, scene))
            put_data(out, c, &c->curves[i], i, over_time);
    // Adds a line with the slope of independent samples, through the upper left corner.
    fprintf(out, "plot %.9g / x with lines dashtype 3 linecolor '#8a949e' title '1 / %s'",
            extent->x_min * extent->y_max, over_time ? "time" : "samples");
    uint32_t number = 0;
    for (uint32_t i = 0; i < c->curve_count; i++) {
        if (!is_in(c, i, scene))
            continue;
        fprintf(out,
                ", \\\n     $curve%u using 1:2:3:4 with yerrorlines linetype %u dashtype %u "
                "linewidth 1.6 pointsize .5 title ",
                i, number % COLORS + 1, number / COLORS % 4 + 1);
        number++;
        html_plot_words(out, converge_label(&c->curves[i]));
    }
    fputc('\n', out);
}

bool converge_plot(const struct converge *c, uint32_t scene, bool over_time, char **script,
                   struct err *err)
{
    struct extent extent = find_extent(c, scene, over_time);
    struct memory_stream stream;
    *script = NULL;
    if (extent.curves == 0)
        return true;
    if (!memory_stream_open(&stream))
        return err_memory(err, "a plot", 0);
    put_script(stream.file, c, &extent, scene, over_time);
    if (memory_stream_close(&stream)) {
        *script = stream.text;
        return true;
    }
    memory_stream_finish(&stream);
    return err_memory(err, "a plot", 0);
}
