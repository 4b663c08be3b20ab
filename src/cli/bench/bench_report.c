// Prints the text output of `lampyris bench`, and writes the files of --report.
#include "cli/bench/bench.h"

#include "base/file.h"
#include "base/parallel.h"
#include "report/csv_out.h"
#include "report/json_out.h"
#include "report/text_out.h"
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// --- text ----------------------------------------------------------------------------------------

static void print_head(const struct bench *b, const struct bench_variant *v)
{
    const struct settings *s = &v->scene_data.settings;
    const struct render_stats *stats = &v->job.renderer.stats;
    const struct bvh *bvh = &v->job.renderer.bvh;
    print_words(v->scene_data.path);
    printf(", %s  %u x %u, %" PRIu64 " spp, %u repetitions%s\n", bench_label(v), s->width,
           s->height, (uint64_t)s->spp, b->repeats_done, b->stopped ? ", stopped early" : "");
    printf("  start   load %.3f + flatten %.3f + BVH %.3f + upload %.3f + compile %.3f s\n",
           v->load_seconds, stats->flatten_seconds, stats->bvh_seconds, stats->upload_seconds,
           stats->compile_seconds);
    printf("  BVH     SAH cost %.2f, %u nodes of %.0f bytes, %u triangles\n", bvh->stats.sah_cost,
           bvh->node_count, (double)bvh_nodes_bytes(bvh) / (double)bvh->node_count,
           bvh->triangle_count);
    printf("  memory  %.1f MiB on the device; wave of %u paths%s, workgroups of %u\n",
           (double)v->job.renderer.plan.total_bytes / 1048576.0, v->job.renderer.plan.wave_slots,
           memory_plan_in_flight(&v->job.renderer.plan), v->job.renderer.specialization.workgroup);
}

static void print_frame(const struct bench *b, const struct bench_variant *v)
{
    const struct bench_row *wall = bench_wall(v);
    if (!wall)
        return;
    double seconds = wall->median.value * 1e-3;
    double rays = (double)v->closest_rays + (double)v->shadow_rays;
    printf("  frame   %.2f ms", wall->median.value);
    if (isfinite(wall->median.low))
        printf(" [%.2f, %.2f]", wall->median.low, wall->median.high);
    printf(", %.3g frames/s, %.3f Msamples/s, %.2f Mrays/s; the first took %.2f ms\n", 1 / seconds,
           (double)v->paths * 1e-6 / seconds, rays * 1e-6 / seconds, v->warm_up_ms);
    if (v != bench_first(b, v) && isfinite(wall->ratio.value))
        printf("  speed   %.3f [%.3f, %.3f] of \"%s\": %s\n", wall->ratio.value, wall->ratio.low,
               wall->ratio.high, bench_label(bench_first(b, v)),
               curve_verdict_words(curve_judge(wall->ratio)));
}

// Prints a number, or a dash if the number is not known.
static void print_number(const char *format, int width, double value)
{
    if (isnan(value)) {
        printf(" %*s", width, "-");
        return;
    }
    putchar(' ');
    printf(format, width, value);
}

static void print_row(const struct bench_variant *v, const struct bench_row *row, bool is_first)
{
    double seconds = row->median.value * 1e-3;
    double items = row->items ? (double)row->items : NAN;
    double bytes = row->bytes + (row->nodes ? bench_bvh_bytes(v, row) : 0.0);
    char range[48] = "-";
    if (isfinite(row->median.low))
        snprintf(range, sizeof range, "%.2f .. %.2f", row->median.low, row->median.high);
    printf("  %-28s", row->name);
    print_number("%*.2f", 9, row->median.value);
    printf(" %20s", range);
    print_number("%*.1f", 6, 100.0 * row->share);
    print_number("%*.0f", 8, row->launches ? (double)row->launches : NAN);
    print_number("%*.0f", 11, items);
    print_number("%*.2f", 8, items * 1e-6 / seconds);
    print_number("%*.0f", 6, row->bytes / items);
    print_number("%*.1f", 6, row->nodes ? (double)row->nodes / items : NAN);
    print_number("%*.1f", 6, row->nodes ? (double)row->primitives / items : NAN);
    print_number("%*.2f", 6, bytes * 1e-9 / seconds);
    print_number("%*.3f", 6, is_first ? NAN : row->ratio.value);
    putchar('\n');
}

static void print_bounces(const struct bench *b, const struct bench_variant *v)
{
    if (v->bounce_count == 0)
        return;
    printf("  %-10s %11s %9s %11s %9s\n", "bounce", "rays", "of wave", "shadow rays", "ms");
    for (uint32_t i = 0; i < v->bounce_count; i++) {
        const struct bench_bounce *at = &v->bounces[i];
        double ms = 0.0;
        for (int k = 0; k < KERNEL_COUNT; k++)
            for (uint32_t r = 0; at->ms[k] && r < b->repeats_done; r++)
                ms += at->ms[k][r] / b->repeats_done;
        char name[24];
        snprintf(name, sizeof name, "%u%s", i, i + 1 == STATS_BOUNCES ? " and later" : "");
        printf("  %-10s %11" PRIu64 " %7.1f %% %11" PRIu64, name,
               at->items[KERNEL_intersect_closest], 100.0 * bench_occupancy(v, i),
               at->items[KERNEL_intersect_shadow]);
        print_number("%*.2f", 9, ms);
        putchar('\n');
    }
}

static void print_changes(const struct bench *b)
{
    if (!b->baseline)
        return;
    printf("since %s\n", b->options->bench.baseline);
    printf("  %-28s %-24s %9s %9s %24s\n", "", "", "ms before", "now", "ratio of times");
    uint32_t slower = 0;
    for (uint32_t i = 0; i < b->change_count; i++) {
        const struct bench_change *c = &b->changes[i];
        char range[48] = "not known";
        if (isfinite(c->ratio.value))
            snprintf(range, sizeof range, "%.3f [%.3f, %.3f]", c->ratio.value, c->ratio.low,
                     c->ratio.high);
        printf("  %-28s %-24s", c->row->name, bench_label(c->variant));
        print_number("%*.2f", 9, c->before_ms);
        print_number("%*.2f", 9, c->row->median.value);
        printf(" %24s  %s\n", range,
               c->verdict == CURVE_NOT_TOLD_APART ? "" : curve_verdict_words(c->verdict));
        slower += c->verdict == CURVE_WORSE;
    }
    if (slower > 0 && slower == b->change_count)
        printf("  all rows are slower: the machine may be busier than it was\n");
}

static void print_pictures(const struct bench *b)
{
    for (uint32_t i = 0; i < b->variant_count; i++)
        if (b->variants[i].image_hash)
            printf("picture %016" PRIx64 "  %s\n", b->variants[i].image_hash,
                   bench_label(&b->variants[i]));
}

void bench_print(const struct bench *b)
{
    for (uint32_t i = 0; i < b->variant_count; i++) {
        const struct bench_variant *v = &b->variants[i];
        print_head(b, v);
        print_frame(b, v);
        printf("  %-28s %9s %20s %6s %8s %11s %8s %6s %6s %6s %6s %6s\n", "", "ms", "95 %", "%",
               "launches", "items", "M/s", "B/item", "nodes", "prims", "GB/s", "speed");
        for (uint32_t r = 0; r < v->row_count; r++)
            print_row(v, &v->rows[r], v == bench_first(b, v));
        print_bounces(b, v);
        putchar('\n');
    }
    print_pictures(b);
    printf("device  %s, %s%s\n", b->gpu.info.name, b->gpu.info.driver,
           b->gpu.has_timestamps ? "" : ", without timestamps: its kernels' times are not known");
    if (b->gpu.info.is_cpu && b->load > 0.5 * cpu_count())
        printf("note    the machine was busy (load %.1f)\n", b->load);
    print_changes(b);
    print_report(b->options->study.report);
}

// --- files ---------------------------------------------------------------------------------------

static void print_csv(const void *context, FILE *file)
{
    const struct bench *b = context;
    fprintf(file, "scene,variant,row,repetition,ms,launches,items,record_bytes,bvh_bytes\n");
    for (uint32_t i = 0; i < b->variant_count; i++) {
        const struct bench_variant *v = &b->variants[i];
        for (uint32_t r = 0; r < v->row_count; r++)
            for (uint32_t n = 0; n < b->repeats_done; n++) {
                const struct bench_row *row = &v->rows[r];
                const double numbers[] = {row->ms[n], (double)row->launches, (double)row->items,
                                          row->bytes, bench_bvh_bytes(v, row)};
                csv_words(file, v->scene_data.path);
                fputc(',', file);
                csv_words(file, v->variant.label);
                fprintf(file, ",%s,%u", row->name, n);
                for (size_t k = 0; k < sizeof numbers / sizeof numbers[0]; k++) {
                    fputc(',', file);
                    csv_number(file, numbers[k]);
                }
                fputc('\n', file);
            }
    }
}

bool bench_write(struct bench *b, const char *folder, struct err *err)
{
    const char *json = arena_printf(&b->arena, "%s/results.json", folder);
    const char *csv = arena_printf(&b->arena, "%s/results.csv", folder);
    if (!json || !csv)
        return err_memory(err, "file names", 0);
    return file_make_folder(folder, err) && json_write(bench_json(b), json, err) &&
           csv_write(csv, print_csv, b, err) && bench_write_html(b, folder, err);
}
