// Writes the HTML report: a single file with charts and tables that needs no network.
#include "cli/bench/bench.h"

#include "cli/bench/bench_chart.h"
#include "report/html_viewer.h"
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

struct page {
    const struct bench *b;
    struct html_page html;
};

// Writes the speed of a variant relative to the first variant.
static void put_speed(struct page *page, const struct bench_variant *v, const struct bench_row *row)
{
    if (v != bench_first(page->b, v))
        html_interval(&page->html, row->ratio, "%.3f");
    else
        fputs("<td></td>", page->html.out);
}

static void put_frame(struct page *page, const struct bench_variant *v)
{
    const struct bench_row *wall = bench_wall(v);
    FILE *out = page->html.out;
    if (!wall) {
        fputs("<td></td><td></td><td></td><td></td><td></td><td></td>", out);
        return;
    }
    double seconds = wall->median.value * 1e-3;
    html_interval(&page->html, wall->median, "%.2f");
    html_number(&page->html, 1 / seconds, "%.3g");
    html_number(&page->html, (double)v->paths * 1e-6 / seconds, "%.3f");
    html_number(&page->html, ((double)v->closest_rays + (double)v->shadow_rays) * 1e-6 / seconds,
                "%.2f");
    put_speed(page, v, wall);
    fprintf(out, "<td>%s</td>",
            v == bench_first(page->b, v) ? "" : curve_verdict_words(curve_judge(wall->ratio)));
}

static void put_variant(struct page *page, const struct bench_variant *v)
{
    const struct render_stats *s = &v->job.renderer.stats;
    FILE *out = page->html.out;
    fputs("<tr><th>", out);
    html_text(&page->html, bench_label(v));
    fputs("</th>", out);
    put_frame(page, v);
    html_number(&page->html, v->load_seconds, "%.3f");
    html_number(&page->html, s->bvh_seconds, "%.3f");
    html_number(&page->html, s->upload_seconds, "%.3f");
    html_number(&page->html, s->compile_seconds, "%.3f");
    html_number(&page->html, v->job.renderer.bvh.stats.sah_cost, "%.2f");
    html_number(&page->html, (double)v->job.renderer.plan.total_bytes / 1048576.0, "%.1f");
    if (v->image_hash)
        fprintf(out, "<td>%016" PRIx64 "</td>", v->image_hash);
    else
        fputs("<td></td>", out);
    fputs("</tr>\n", out);
}

static void put_count(struct page *page, double value, bool known, const char *format)
{
    if (known)
        html_number(&page->html, value, format);
    else
        fputs("<td></td>", page->html.out);
}

static void put_row(struct page *page, const struct bench_variant *v, const struct bench_row *row)
{
    double seconds = row->median.value * 1e-3, items = (double)row->items;
    bool counted = row->items > 0, traced = row->nodes > 0;
    double bytes = row->bytes + (traced ? bench_bvh_bytes(v, row) : 0.0);
    fprintf(page->html.out, "<tr><th>%s</th>", row->name);
    html_interval(&page->html, row->median, "%.3f");
    put_count(page, 100.0 * row->share, !isnan(row->share), "%.1f");
    put_count(page, (double)row->launches, row->launches > 0, "%.0f");
    put_count(page, items, counted, "%.0f");
    put_count(page, items * 1e-6 / seconds, counted, "%.2f");
    put_count(page, row->bytes / items, counted && !isnan(row->bytes), "%.0f");
    put_count(page, (double)row->nodes / items, traced, "%.1f");
    put_count(page, (double)row->primitives / items, traced, "%.1f");
    put_count(page, bytes * 1e-9 / seconds, counted && !isnan(bytes), "%.2f");
    put_speed(page, v, row);
    fputs("</tr>\n", page->html.out);
}

static void put_rows(struct page *page, const struct bench_variant *v)
{
    FILE *out = page->html.out;
    fputs("<h3>", out);
    html_text(&page->html, bench_label(v));
    fputs("</h3>\n<div class=\"wide\"><table><tr><th></th><th>ms</th><th>% of the "
          "frame</th><th>launches</th><th>items</th><th>M/s</th><th>bytes per "
          "item</th><th>nodes</th><th>primitives</th><th>GB/s</th><th>speed</th></tr>\n",
          out);
    for (uint32_t i = 0; i < v->row_count; i++)
        put_row(page, v, &v->rows[i]);
    fputs("</table></div>\n", out);
}

// --- images --------------------------------------------------------------------------------------

// Returns whether to show a variant's image: it exists, has the size of the first variant's, and no
// earlier variant has the same one.
static bool is_shown(const struct bench_variant *first, uint32_t index)
{
    const struct bench_variant *v = first + index;
    const struct film_image *film = &v->job.film;
    if (!v->image_hash || !film->mean || film->width != first->job.film.width ||
        film->height != first->job.film.height)
        return false;
    for (uint32_t i = 0; i < index; i++)
        if (variants_share_picture(&first[i].variant, &v->variant))
            return false;
    return true;
}

// Shows the images of the last repetition. Variants with the same image share one.
static bool put_pictures(struct page *page, const struct bench_variant *first, uint32_t count,
                         struct err *err)
{
    const struct settings *settings = &first->scene_data.settings;
    struct html_viewer_params params = {
        .width = first->job.film.width,
        .height = first->job.film.height,
        .exposure_stops = settings->exposure,
        .tone = settings->tone_curve,
    };
    for (uint32_t i = 0; i < count; i++)
        params.count += is_shown(first, i);
    if (params.count == 0)
        return true;
    struct html_viewer viewer;
    fprintf(page->html.out, "<h3>Picture%s</h3>\n", params.count > 1 ? "s" : "");
    bool ok = html_viewer_begin(&page->html, &params, &viewer, err);
    for (uint32_t i = 0; i < count && ok; i++) {
        const struct html_viewer_picture picture = {
            .label = bench_label(&first[i]),
            .title = bench_label(&first[i]),
            .pixels = (const float(*)[3])first[i].job.film.mean,
        };
        ok = !is_shown(first, i) || html_viewer_add(&viewer, &picture, err);
    }
    return html_viewer_end(&viewer, ok, err);
}

static bool put_scene(struct page *page, const struct bench_variant *first, struct err *err)
{
    const struct bench *b = page->b;
    const struct settings *s = &first->scene_data.settings;
    FILE *out = page->html.out;
    uint32_t count = 0;
    while (first + count < b->variants + b->variant_count &&
           first[count].variant.scene == first->variant.scene)
        count++;
    fputs("<h2>", out);
    html_text(&page->html, first->scene_data.path);
    fprintf(out, ", %u &times; %u, %" PRIu64 " samples per pixel</h2>\n<div class=\"plots\">",
            s->width, s->height, (uint64_t)s->spp);
    if (!bench_put_charts(&page->html, b, first, count, err))
        return false;
    fputs("</div>\n<div class=\"wide\"><table><tr><th>variant</th><th>ms per "
          "frame</th><th>frames/s</th><th>Msamples/s</th><th>Mrays/s</th><th>speed relative to the "
          "first</th><th></th><th>load s</th><th>BVH</th><th>upload</th><th>compile</th><th>SAH "
          "cost</th><th>MiB</th><th>picture</th></tr>\n",
          out);
    for (uint32_t i = 0; i < count; i++)
        put_variant(page, first + i);
    fputs("</table></div>\n", out);
    for (uint32_t i = 0; i < count; i++)
        put_rows(page, first + i);
    return put_pictures(page, first, count, err);
}

static void put_changes(struct page *page)
{
    const struct bench *b = page->b;
    FILE *out = page->html.out;
    if (!b->baseline)
        return;
    fputs("<h2>Since ", out);
    html_text(&page->html, b->options->bench.baseline);
    fputs("</h2>\n<div class=\"wide\"><table><tr><th></th><th>variant</th><th>ms "
          "before</th><th>now</th><th>ratio of "
          "times</th><th></th></tr>\n",
          out);
    for (uint32_t i = 0; i < b->change_count; i++) {
        const struct bench_change *c = &b->changes[i];
        fprintf(out, "<tr><th>%s</th><td>", c->row->name);
        html_text(&page->html, bench_label(c->variant));
        fputs("</td>", out);
        html_number(&page->html, c->before_ms, "%.3f");
        html_number(&page->html, c->row->median.value, "%.3f");
        html_interval(&page->html, c->ratio, "%.3f");
        fprintf(out, "<td>%s</td></tr>\n", curve_verdict_words(c->verdict));
    }
    fprintf(out,
            "</table></div>\n<p>The intervals hold for all rows simultaneously: if the machine is "
            "as busy as it was, at most %.0f of 100 runs report a change that is not real. Changes "
            "of less than %.0f %% are not reported.</p>\n",
            100.0 * BENCH_FALSE_ALARMS, 100.0 * (BENCH_FLOOR - 1));
}

static void put_explanation(struct page *page)
{
    fprintf(page->html.out,
            "<p>There were %u repetitions of each variant, in turns. Times are medians, with the "
            "order statistics that enclose the median with a probability of at least 95 %%. "
            "Kernels are timed by the device%s; together with the host's work in between they add "
            "up to the time of the frame. Speeds are relative to the first variant, from the "
            "ratios of repetitions in the same turn; below 1 is slower. Bytes per item are the "
            "least number of bytes of its records; GB/s also counts nodes and primitives.</p>\n",
            page->b->repeats_done,
            page->b->gpu.has_timestamps
                ? ""
                : " (this device has no timestamps, so their times are not known)");
}

bool bench_write_html(struct bench *b, const char *folder, struct err *err)
{
    struct page page = {.b = b};
    if (!html_begin(&page.html, &b->arena, folder, "How the time is spent", err))
        return false;
    bool ok = true;
    put_explanation(&page);
    if (b->differs) {
        fputs("<p><b>Pictures differ: ", page.html.out);
        html_text(&page.html, b->difference.msg);
        fputs("</b></p>\n", page.html.out);
    }
    for (uint32_t i = 0; i < b->variant_count && ok; i++)
        if (bench_first(b, &b->variants[i]) == &b->variants[i])
            ok = put_scene(&page, &b->variants[i], err);
    put_changes(&page);
    html_machine(&page.html, &b->gpu, b->options->command_line);
    return html_end(&page.html, ok, err);
}
