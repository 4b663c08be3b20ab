// Finds rows that are slower than in an earlier run (the baseline).
#include "cli/bench/bench.h"

#include "base/file.h"
#include "base/log.h"
#include "base/parallel.h"
#include "json/json_parse.h"
#include "metrics/spread.h"
#include "report/machine.h"
#include <inttypes.h>
#include <math.h>
#include <string.h>

static const char *text_of(const json_t *object, const char *key)
{
    const char *text = json_string_value(json_object_get(object, key));
    return text ? text : "";
}

static json_t *find_variant(const struct bench *b, const struct bench_variant *v)
{
    size_t i;
    json_t *other;
    json_array_foreach(json_object_get(b->baseline, "variants"), i,
                       other) if (strcmp(text_of(other, "scene"), v->scene_data.path) == 0 &&
                                  strcmp(text_of(other, "label"), v->variant.label) ==
                                      0) return other;
    return NULL;
}

static json_t *find_row(json_t *variant, const char *name)
{
    size_t i;
    json_t *row;
    json_array_foreach(json_object_get(variant, "rows"), i,
                       row) if (strcmp(text_of(row, "name"), name) == 0) return row;
    return NULL;
}

// Checks that both runs did the same work. Their results may differ, which is reported.
static bool check_work(const struct bench *b, const struct bench_variant *v, const json_t *before,
                       struct err *err)
{
    const struct settings *s = &v->scene_data.settings;
    const struct {
        const char *key;
        uint64_t now;
    } same[] = {{"width", s->width}, {"height", s->height}, {"spp", s->spp}, {"seed", s->seed}};
    for (size_t i = 0; i < sizeof same / sizeof same[0]; i++) {
        json_int_t was = json_integer_value(json_object_get(before, same[i].key));
        if ((uint64_t)was != same[i].now)
            return err_set(err, ERR_INPUT,
                           "%s: %s, \"%s\": %s was %" JSON_INTEGER_FORMAT ", and is %" PRIu64
                           "; expected the same number",
                           b->options->bench.baseline, v->scene_data.path, bench_label(v),
                           same[i].key, was, same[i].now);
    }
    return true;
}

static void look_at_picture(const struct bench *b, const struct bench_variant *v,
                            const json_t *before)
{
    char hash[20];
    snprintf(hash, sizeof hash, "%016" PRIx64, v->image_hash);
    if (v->image_hash && strcmp(text_of(before, "image_hash"), hash) != 0)
        log_warn("%s: the picture of %s, \"%s\" was different (hash %s, now %s); times are "
                 "compared nevertheless",
                 b->options->bench.baseline, v->scene_data.path, bench_label(v),
                 text_of(before, "image_hash"), hash);
}

// Reads the times of all repetitions of a row. Returns NULL if the file has none.
static double *read_times(struct bench *b, json_t *row, size_t *count, struct err *err)
{
    const json_t *list = json_object_get(row, "repeat_ms");
    *count = json_array_size(list);
    double *ms = ARENA_NEW(&b->arena, double, *count);
    if (!ms)
        err_memory(err, "times", *count * sizeof *ms);
    for (size_t i = 0; ms && i < *count; i++) {
        const json_t *value = json_array_get(list, i);
        ms[i] = json_is_number(value) ? json_number_value(value) : NAN;
    }
    return ms;
}

static bool compare_row(struct bench *b, struct bench_change *change, json_t *before,
                        double confidence, struct err *err)
{
    struct spread_set then, now = {change->row->ms, b->repeats_done};
    double *ms = read_times(b, before, &then.count, err);
    struct interval median;
    if (!ms)
        return false;
    if (!spread_median(ms, then.count, &median))
        return err_memory(err, "times", then.count * sizeof *ms);
    then.values = ms;
    change->before_ms = median.value;
    change->ratio = spread_ratio(now, then, confidence);
    change->verdict = change->ratio.low > BENCH_FLOOR        ? CURVE_WORSE
                      : change->ratio.high < 1 / BENCH_FLOOR ? CURVE_BETTER
                                                             : CURVE_NOT_TOLD_APART;
    return true;
}

// Lists the rows to compare: all except those of the host, whose times depend on the operating
// system.
static uint32_t list_rows(const struct bench_variant *v, json_t *before, struct bench_change *out)
{
    uint32_t count = 0;
    for (uint32_t i = 0; i < v->row_count; i++) {
        const struct bench_row *row = &v->rows[i];
        json_t *then = row->kind == BENCH_HOST ? NULL : find_row(before, row->name);
        if (!then || isnan(row->median.value))
            continue;
        out[count++] = (struct bench_change){.variant = v, .row = row};
    }
    return count;
}

static bool check_machine(const struct bench *b, struct err *err)
{
    const json_t *machine = json_object_get(b->baseline, "machine");
    const struct gpu_device_info *info = &b->gpu.info;
    const char *path = b->options->bench.baseline;
    if (strcmp(text_of(machine, "device"), info->name) != 0)
        return err_set(err, ERR_INPUT,
                       "%s was measured on the device \"%s\"; expected this device, \"%s\"", path,
                       text_of(machine, "device"), info->name);
    if (strcmp(text_of(machine, "driver"), info->driver) != 0)
        log_warn("%s: the driver was \"%s\" and is now \"%s\"", path, text_of(machine, "driver"),
                 info->driver);
    if (strcmp(text_of(machine, "processor"), machine_describe().processor) != 0)
        log_warn("%s: it was measured on another processor, \"%s\"", path,
                 text_of(machine, "processor"));
    const json_t *load = json_object_get(b->baseline, "load");
    if (info->is_cpu && json_is_number(load) &&
        fabs(json_number_value(load) - b->load) > 0.5 * cpu_count())
        log_warn("%s: the machine's load was %.1f and is now %.1f, which affects times", path,
                 json_number_value(load), b->load);
    return true;
}

static bool check_variants(const struct bench *b, struct err *err)
{
    uint32_t found = 0;
    for (uint32_t i = 0; i < b->variant_count; i++) {
        const struct bench_variant *v = &b->variants[i];
        const json_t *before = find_variant(b, v);
        if (!before)
            log_warn("%s has no result for %s, \"%s\"", b->options->bench.baseline,
                     v->scene_data.path, bench_label(v));
        else if (!check_work(b, v, before, err))
            return false;
        found += before != NULL;
    }
    return found > 0 ||
           err_set(err, ERR_INPUT, "%s has no result for any of these scenes and variants",
                   b->options->bench.baseline);
}

bool bench_load_baseline(struct bench *b, struct err *err)
{
    const char *path = b->options->bench.baseline;
    struct file_bytes bytes;
    if (!file_read(&b->arena, path, 0, &bytes, err))
        return false;
    b->baseline = json_parse(path, &bytes, JSON_REJECT_DUPLICATES, err);
    if (!b->baseline)
        return false;
    if (!json_is_array(json_object_get(b->baseline, "variants")) ||
        !json_is_object(json_object_get(b->baseline, "machine")))
        return err_set(err, ERR_INPUT,
                       "%s is not the JSON output of lampyris bench: expected the keys \"machine\" "
                       "and \"variants\"",
                       path);
    return check_machine(b, err) && check_variants(b, err);
}

bool bench_compare_baseline(struct bench *b, struct err *err)
{
    uint32_t total = 0;
    for (uint32_t i = 0; i < b->variant_count; i++)
        total += b->variants[i].row_count;
    b->changes = ARENA_NEW(&b->arena, struct bench_change, total);
    if (!b->changes)
        return err_memory(err, "changes", total * sizeof *b->changes);
    for (uint32_t i = 0; i < b->variant_count; i++) {
        json_t *before = find_variant(b, &b->variants[i]);
        if (!before)
            continue;
        look_at_picture(b, &b->variants[i], before);
        b->change_count += list_rows(&b->variants[i], before, b->changes + b->change_count);
    }
    // The confidence of each row, by Bonferroni's inequality (Dunn 1961).
    double confidence = 1 - BENCH_FALSE_ALARMS / fmax(b->change_count, 1.0);
    for (uint32_t i = 0; i < b->change_count; i++) {
        struct bench_change *change = &b->changes[i];
        json_t *before = find_row(find_variant(b, change->variant), change->row->name);
        if (!compare_row(b, change, before, confidence, err))
            return false;
    }
    return true;
}

const char *bench_change_word(const struct bench_change *change)
{
    return change->verdict == CURVE_WORSE    ? "slower"
           : change->verdict == CURVE_BETTER ? "faster"
                                             : "not told apart";
}

bool bench_is_slower(const struct bench *b)
{
    for (uint32_t i = 0; i < b->change_count; i++)
        if (b->changes[i].verdict == CURVE_WORSE)
            return true;
    return false;
}
