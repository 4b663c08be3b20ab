// gnuplot scripts of curves.
#include "converge.h"

#include "html.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

// gnuplot cannot place an error bar at a bound that is not known.
static bool is_drawn(struct interval i)
{
    return isfinite(i.value) && i.value > 0;
}

static void put_data(FILE *out, const struct converge *c, const struct converge_curve *curve,
                     uint32_t number, bool over_time)
{
    fprintf(out, "$curve%u << EOD\n", number);
    for (uint32_t p = 0; p < c->point_count; p++) {
        const struct converge_point *point = &curve->points[p];
        struct interval e = point->metric[CONVERGE_RELMSE];
        double x = over_time ? point->seconds.value : point->spp.value;
        if (is_drawn(e))
            fprintf(out, "%.9g %.9g %.9g %.9g\n", x, e.value, isfinite(e.low) ? e.low : e.value,
                    isfinite(e.high) ? e.high : e.value);
    }
    fputs("EOD\n", out);
}

static bool is_in(const struct converge *c, uint32_t i, uint32_t scene)
{
    const struct converge_curve *curve = &c->curves[i];
    if (curve->variant.scene != scene)
        return false;
    for (uint32_t p = 0; p < c->point_count; p++)
        if (is_drawn(curve->points[p].metric[CONVERGE_RELMSE]))
            return true;
    return false;
}

static bool put_script(FILE *out, const struct converge *c, uint32_t scene, bool over_time)
{
    bool is_empty = true;
    fprintf(out,
            "set terminal svg size 620,440 dynamic font 'sans-serif,12' noenhanced name '%s%u'\n"
            "set logscale xy\nset grid xtics ytics mytics linecolor '#dfe4ea'\n"
            "set border 3 linecolor '#66727f'\nset tics nomirror\nset bars 0.6\n"
            "set key below left maxrows 6 samplen 2\nset offsets 0, 0, 0, 0\n"
            "set format y '10^{%%T}'\nset format x '%%g'\nset ylabel 'relMSE'\nset xlabel '%s'\n",
            over_time ? "time" : "samples", scene,
            over_time ? "seconds of rendering" : "samples a pixel");
    for (uint32_t i = 0; i < c->curve_count; i++)
        if (is_in(c, i, scene))
            put_data(out, c, &c->curves[i], i, over_time);
    for (uint32_t i = 0; i < c->curve_count; i++) {
        if (!is_in(c, i, scene))
            continue;
        fprintf(out,
                "%s$curve%u using 1:2:3:4 with yerrorlines linewidth 1.6 pointtype 7 "
                "pointsize .35 title ",
                is_empty ? "plot " : ", \\\n     ", i);
        html_plot_words(out, converge_label(&c->curves[i]));
        is_empty = false;
    }
    fputc('\n', out);
    return !is_empty;
}

bool converge_plot(const struct converge *c, uint32_t scene, bool over_time, char **script,
                   struct err *err)
{
    size_t size = 0;
    *script = NULL;
    FILE *file = open_memstream(script, &size);
    if (!file)
        return err_memory(err, "a plot", 0);
    bool is_drawing = put_script(file, c, scene, over_time);
    bool ok = fclose(file) == 0 || err_memory(err, "a plot", size);
    if (!ok || !is_drawing) {
        free(*script);
        *script = NULL;
    }
    return ok;
}
