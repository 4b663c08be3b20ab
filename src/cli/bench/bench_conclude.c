// Computes statistics of the measured times.
#include "cli/bench/bench.h"

#include "metrics/spread.h"
#include <inttypes.h>
#include <math.h>
#include <string.h>

const char *bench_label(const struct bench_variant *v)
{
    return *v->variant.label ? v->variant.label : "as given";
}

const char *bench_verdict(struct interval ratio)
{
    static const char *const words[] = {
        [CURVE_NOT_TOLD_APART] = "not told apart",
        [CURVE_BETTER] = "faster",
        [CURVE_WORSE] = "slower",
    };
    return words[curve_judge(ratio)];
}

const struct bench_variant *bench_first(const struct bench *b, const struct bench_variant *v)
{
    while (v > b->variants && v[-1].variant.scene == v->variant.scene)
        v--;
    return v;
}

const struct bench_row *bench_find(const struct bench_variant *v, const char *name)
{
    for (uint32_t i = 0; i < v->row_count; i++)
        if (strcmp(v->rows[i].name, name) == 0)
            return &v->rows[i];
    return NULL;
}

const struct bench_row *bench_wall(const struct bench_variant *v)
{
    const struct bench_row *last = v->rows + v->row_count - 1;
    return v->row_count > 0 && last->kind == BENCH_WALL ? last : NULL;
}

double bench_occupancy(const struct bench_variant *v, uint32_t bounce)
{
    return (double)v->bounces[bounce].items[KERNEL_intersect_closest] / (double)v->paths;
}

double bench_bvh_bytes(const struct bench_variant *v, const struct bench_row *row)
{
    const struct bvh *bvh = &v->job.renderer.bvh;
    if (row->nodes == 0)
        return NAN;
    return (double)row->nodes * (double)bvh_nodes_bytes(bvh) / (double)bvh->node_count +
           (double)row->primitives * (double)sizeof(struct gpu_triangle);
}

// Returns the ratio of the times of two rows. For a single kernel these are times per item, because
// other wave sizes give other numbers of items.
static struct interval speed_ratio(const struct bench_row *first, const struct bench_row *row,
                                   uint32_t count)
{
    struct interval ratio = {NAN, NAN, NAN};
    if (!first)
        return ratio;
    ratio = curve_paired_ratio(first->ms, row->ms, count);
    double scale = row->kind == BENCH_ALONE ? (double)row->items / (double)first->items : 1.0;
    return (struct interval){ratio.value * scale, ratio.low * scale, ratio.high * scale};
}

static bool conclude_variant(const struct bench *b, struct bench_variant *v, struct err *err)
{
    uint32_t count = b->repeats_done;
    const struct bench_variant *first = bench_first(b, v);
    const struct bench_row *wall = bench_wall(v);
    for (uint32_t i = 0; i < v->row_count; i++) {
        struct bench_row *row = &v->rows[i];
        const struct bench_row *other = bench_find(first, row->name);
        if (!spread_median(row->ms, count, &row->median))
            return err_memory(err, "times", count * sizeof *row->ms);
        row->ratio = speed_ratio(other, row, count);
        double sum = 0.0, all = 0.0;
        for (uint32_t r = 0; r < count; r++) {
            sum += row->ms[r];
            all += wall ? wall->ms[r] : NAN;
        }
        row->share = sum / all;
    }
    return true;
}

// Checks that images are equal bit for bit where they must be: those of all repetitions of a
// variant, and those of variants whose options must not change the image.
static bool same_pictures(const struct bench *b, struct err *err)
{
    for (uint32_t i = 0; i < b->variant_count; i++) {
        const struct bench_variant *v = &b->variants[i];
        if (v->differs)
            return err_set(err, ERR_BUG, "%s, %s: the repetitions have different pictures",
                           v->scene_data.path, bench_label(v));
        for (uint32_t k = 0; k < i; k++) {
            const struct bench_variant *other = &b->variants[k];
            if (variants_share_picture(&other->variant, &v->variant) &&
                v->image_hash != other->image_hash)
                return err_set(err, ERR_BUG,
                               "%s: the picture of \"%s\" (hash %016" PRIx64
                               ") differs from that of \"%s\" (hash %016" PRIx64 ")",
                               v->scene_data.path, bench_label(v), v->image_hash,
                               bench_label(other), other->image_hash);
        }
    }
    return true;
}

bool bench_conclude(struct bench *b, struct err *err)
{
    for (uint32_t i = 0; i < b->variant_count; i++)
        if (!conclude_variant(b, &b->variants[i], err))
            return false;
    b->differs = !same_pictures(b, &b->difference);
    return true;
}
