// Writes the JSON output of `lampyris bench`.
#include "cli/bench/bench.h"

#include "report/json_out.h"
#include "report/machine.h"
#include <inttypes.h>
#include <math.h>
#include <string.h>

static json_t *count_json(uint64_t count)
{
    return count ? json_integer((json_int_t)count) : json_null();
}

static json_t *times_json(const struct bench *b, const double *ms)
{
    json_t *list = json_array();
    for (uint32_t r = 0; r < b->repeats_done; r++)
        json_array_append_new(list, json_number(ms[r]));
    return list;
}

static json_t *row_json(const struct bench *b, const struct bench_variant *v,
                        const struct bench_row *row)
{
    static const char *const kinds[] = {
        [BENCH_WALL] = "wall",
        [BENCH_KERNEL] = "kernel",
        [BENCH_HOST] = "host",
        [BENCH_ALONE] = "alone",
    };
    double seconds = row->median.value * 1e-3, items = row->items ? (double)row->items : NAN;
    json_t *object = json_pack(
        "{s:s, s:s, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o}", "name", row->name, "kind",
        kinds[row->kind], "ms", json_interval(row->median), "repeat_ms", times_json(b, row->ms),
        "share", json_number(row->share), "speed_ratio", json_interval(row->ratio), "launches",
        count_json(row->launches), "items", count_json(row->items), "items_per_s",
        json_number(items / seconds), "record_bytes", json_number(row->bytes));
    double bvh_bytes = bench_bvh_bytes(v, row);
    double bytes = row->bytes + (row->nodes ? bvh_bytes : 0.0);
    json_object_set_new(object, "bytes_per_s", json_number(bytes / seconds));
    json_object_set_new(object, "bvh_bytes", json_number(bvh_bytes));
    json_object_set_new(object, "nodes", count_json(row->nodes));
    json_object_set_new(object, "primitives",
                        row->nodes ? json_integer((json_int_t)row->primitives) : json_null());
    if (row->kind == BENCH_ALONE) {
        json_object_set_new(object, "rays", row->rays ? json_string(row->rays) : json_null());
        json_object_set_new(object, "depth", json_integer(row->depth));
    }
    return object;
}

static double mean_of(const struct bench *b, const double *ms)
{
    double sum = 0.0;
    for (uint32_t r = 0; r < b->repeats_done; r++)
        sum += ms[r];
    return sum / b->repeats_done;
}

static json_t *bounce_json(const struct bench *b, const struct bench_variant *v, uint32_t bounce)
{
    const struct bench_bounce *at = &v->bounces[bounce];
    json_t *kernels = json_object();
    for (int k = 0; k < KERNEL_COUNT; k++)
        if (at->ms[k] && at->items[k] > 0)
            json_object_set_new(kernels, v->job.renderer.kernels[k].name,
                                json_pack("{s:I, s:o}", "items", (json_int_t)at->items[k], "ms",
                                          json_number(mean_of(b, at->ms[k]))));
    return json_pack("{s:i, s:b, s:o, s:o}", "bounce", (int)bounce, "and_later",
                     bounce + 1 == STATS_BOUNCES, "occupancy",
                     json_number(bench_occupancy(v, bounce)), "kernels", kernels);
}

static json_t *start_json(const struct bench_variant *v)
{
    const struct render_stats *s = &v->job.renderer.stats;
    return json_pack("{s:f, s:f, s:f, s:f, s:f}", "load", v->load_seconds, "flatten",
                     s->flatten_seconds, "bvh", s->bvh_seconds, "upload", s->upload_seconds,
                     "compile", s->compile_seconds);
}

static json_t *bvh_json(const struct bvh *bvh)
{
    return json_pack("{s:f, s:I, s:I, s:I}", "sah_cost", bvh->stats.sah_cost, "nodes",
                     (json_int_t)bvh->node_count, "node_bytes", (json_int_t)bvh_nodes_bytes(bvh),
                     "triangles", (json_int_t)bvh->triangle_count);
}

// Makes the object about a frame, which is a repetition; null with --kernel.
static json_t *frame_json(const struct bench_variant *v)
{
    const struct bench_row *wall = bench_wall(v);
    if (!wall)
        return json_null();
    double seconds = wall->median.value * 1e-3;
    double rays = (double)v->closest_rays + (double)v->shadow_rays;
    return json_pack("{s:o, s:o, s:o, s:o, s:o, s:I, s:I, s:I, s:o, s:s}", "ms",
                     json_interval(wall->median), "fps", json_number(1 / seconds), "samples_per_s",
                     json_number((double)v->paths / seconds), "mrays_per_s",
                     json_number(rays / seconds * 1e-6), "warm_up_ms", json_number(v->warm_up_ms),
                     "closest_rays", (json_int_t)v->closest_rays, "shadow_rays",
                     (json_int_t)v->shadow_rays, "paths", (json_int_t)v->paths, "speed_ratio",
                     json_interval(wall->ratio), "verdict", bench_verdict(wall->ratio));
}

static json_t *variant_json(const struct bench *b, const struct bench_variant *v)
{
    const struct settings *s = &v->scene_data.settings;
    char hash[20];
    snprintf(hash, sizeof hash, "%016" PRIx64, v->image_hash);
    json_t *rows = json_array(), *bounces = json_array();
    for (uint32_t i = 0; i < v->row_count; i++)
        json_array_append_new(rows, row_json(b, v, &v->rows[i]));
    for (uint32_t i = 0; i < v->bounce_count; i++)
        json_array_append_new(bounces, bounce_json(b, v, i));
    return json_pack(
        "{s:o, s:o, s:i, s:i, s:I, s:I, s:I, s:i, s:I, s:I, s:o, s:o, s:o, s:o, s:o, s:o}", "scene",
        json_words(v->scene_data.path), "label", json_words(v->variant.label), "width",
        (int)s->width, "height", (int)s->height, "spp", (json_int_t)s->spp, "seed",
        (json_int_t)s->seed, "wave", (json_int_t)v->job.renderer.plan.wave_slots, "waves_in_flight",
        (int)v->job.renderer.plan.waves, "workgroup",
        (json_int_t)v->job.renderer.specialization.workgroup, "device_bytes",
        (json_int_t)v->job.renderer.plan.total_bytes, "image_hash",
        v->image_hash ? json_string(hash) : json_null(), "start_seconds", start_json(v), "bvh",
        bvh_json(&v->job.renderer.bvh), "frame", frame_json(v), "rows", rows, "bounces", bounces);
}

static json_t *baseline_json(const struct bench *b)
{
    if (!b->baseline)
        return json_null();
    json_t *changes = json_array();
    for (uint32_t i = 0; i < b->change_count; i++) {
        const struct bench_change *c = &b->changes[i];
        json_array_append_new(changes,
                              json_pack("{s:o, s:o, s:s, s:o, s:o, s:o, s:s}", "scene",
                                        json_words(c->variant->scene_data.path), "label",
                                        json_words(c->variant->variant.label), "row", c->row->name,
                                        "before_ms", json_number(c->before_ms), "now_ms",
                                        json_number(c->row->median.value), "time_ratio",
                                        json_interval(c->ratio), "verdict", bench_change_word(c)));
    }
    return json_pack("{s:o, s:f, s:f, s:b, s:o}", "file", json_words(b->options->bench.baseline),
                     "floor", BENCH_FLOOR, "false_alarms", BENCH_FALSE_ALARMS, "slower",
                     bench_is_slower(b), "changes", changes);
}

static json_t *seconds_json(const struct bench_seconds *s)
{
    return json_pack("{s:f, s:f, s:f, s:f, s:f, s:f}", "device", s->device, "start", s->start,
                     "warm_up", s->warm_up, "counting", s->counting, "timed", s->timed, "pictures",
                     s->pictures);
}

json_t *bench_json(const struct bench *b)
{
    json_t *variants = json_array();
    for (uint32_t i = 0; i < b->variant_count; i++)
        json_array_append_new(variants, variant_json(b, &b->variants[i]));
    return json_pack("{s:o, s:o, s:o, s:o, s:i, s:b, s:b, s:o, s:o, s:o}", "load",
                     json_number(b->load), "seconds", seconds_json(&b->seconds), "machine",
                     machine_json(&b->gpu), "command", json_words(b->options->command_line),
                     "repeats", (int)b->repeats_done, "stopped_early", b->stopped, "timestamps",
                     b->gpu.has_timestamps, "difference",
                     b->differs ? json_words(b->difference.msg) : json_null(), "variants", variants,
                     "baseline", baseline_json(b));
}
