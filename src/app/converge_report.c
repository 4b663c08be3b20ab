#include "converge.h"

#include "clock.h"
#include "file.h"
#include "json_out.h"
#include "text_out.h"
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

static bool is_first(const struct converge *c, const struct converge_curve *curve)
{
    return curve == c->curves || curve[-1].variant.scene != curve->variant.scene;
}

const char *converge_label(const struct converge_curve *curve)
{
    return *curve->variant.label ? curve->variant.label : "as given";
}

const char *converge_verdict(const struct converge_curve *curve)
{
    static const char *const words[] = {
        [CURVE_NOT_TOLD_APART] = "not told apart",
        [CURVE_BETTER] = "better",
        [CURVE_WORSE] = "worse",
    };
    return words[curve_judge(curve->ratio)];
}

// --- for people ----------------------------------------------------------------------------------

static void print_head(const struct converge *c, const struct converge_curve *curve)
{
    const struct settings *settings = &curve->scene_data.settings;
    const struct converge_reference *reference = &c->references[curve->variant.scene];
    printf("%s  %u x %u, %u replicates", curve->scene_data.path, settings->width, settings->height,
           c->replicates_done);
    if (!reference->name)
        printf(", no reference: errors of the half-buffers, blind to bias\n");
    else if (reference->spp)
        printf(", reference of %" PRIu64 " spp\n", reference->spp);
    else
        printf(", reference %s%s\n", reference->name,
               reference->picture.noise_known ? "" : ", whose own noise is not known");
    printf("  %-28s %21s %22s %9s %22s  %s\n", "curve", "relMSE at the end", "slope", "s",
           "efficiency, ratio", "");
}

static void print_interval(struct interval i, const char *format, int width)
{
    char text[80], part[3][24];
    snprintf(part[0], sizeof part[0], format, i.value);
    snprintf(part[1], sizeof part[1], format, i.low);
    snprintf(part[2], sizeof part[2], format, i.high);
    if (isnan(i.value))
        snprintf(text, sizeof text, "not known");
    else
        snprintf(text, sizeof text, "%s [%s, %s]", part[0], part[1], part[2]);
    printf(" %*s", width, text);
}

static void print_times(const struct converge_curve *curve)
{
    printf("      to relMSE");
    for (int i = 0; i < CONVERGE_TARGETS; i++) {
        if (isnan(curve->time_to[i]))
            printf("  %g: not known", converge_targets[i]);
        else
            printf("  %g: %.3g s%s", converge_targets[i], curve->time_to[i],
                   curve->extrapolated[i] ? " (extrapolated)" : "");
    }
    if (!isnan(curve->bias.value))
        printf("; bias %.2g [%.2g, %.2g]%s", curve->bias.value, curve->bias.low, curve->bias.high,
               curve->bias.low > 0 ? ": BIASED" : "");
    putchar('\n');
}

void converge_print(const struct converge *c)
{
    for (uint32_t i = 0; i < c->curve_count; i++) {
        const struct converge_curve *curve = &c->curves[i];
        uint32_t last = c->point_count - 1;
        if (is_first(c, curve))
            print_head(c, curve);
        printf("  %-28s", converge_label(curve));
        print_interval(curve->error[last], "%.3g", 30);
        print_interval(curve->slope, "%.3f", 24);
        printf(" %9.3g", curve->seconds[last].value);
        print_interval(curve->ratio, "%.3g", 22);
        printf("  %s\n", is_first(c, curve) ? "" : converge_verdict(curve));
        print_times(curve);
    }
    printf("device  %s, %s\n", c->gpu.info.name, c->gpu.info.driver);
}

// --- for machines --------------------------------------------------------------------------------

static json_t *interval_json(struct interval i)
{
    return json_pack("{s:o, s:o, s:o}", "value", json_number(i.value), "ci_low", json_number(i.low),
                     "ci_high", json_number(i.high));
}

static json_t *point_json(const struct converge *c, const struct converge_curve *curve,
                          uint32_t point)
{
    json_t *metrics = json_object(), *seconds = json_array();
    for (int m = 0; m < CONVERGE_METRICS; m++) {
        json_t *values = json_array();
        for (uint32_t r = 0; r < c->replicates_done; r++)
            json_array_append_new(values, json_number(converge_at(c, curve, r, point)->metric[m]));
        json_object_set_new(metrics, converge_metric_names[m], values);
    }
    for (uint32_t r = 0; r < c->replicates_done; r++)
        json_array_append_new(seconds, json_number(converge_at(c, curve, r, point)->seconds));
    return json_pack("{s:I, s:o, s:o, s:o, s:o}", "spp", (json_int_t)c->spp[point], "relmse",
                     interval_json(curve->error[point]), "seconds",
                     interval_json(curve->seconds[point]), "replicate_seconds", seconds,
                     "replicate_metrics", metrics);
}

static json_t *curve_json(const struct converge *c, const struct converge_curve *curve)
{
    json_t *points = json_array(), *times = json_array();
    for (uint32_t p = 0; p < c->point_count; p++)
        json_array_append_new(points, point_json(c, curve, p));
    for (int i = 0; i < CONVERGE_TARGETS; i++)
        json_array_append_new(times, json_pack("{s:f, s:o, s:b}", "relmse", converge_targets[i],
                                               "seconds", json_number(curve->time_to[i]),
                                               "extrapolated", curve->extrapolated[i]));
    return json_pack("{s:o, s:o, s:f, s:o, s:o, s:o, s:o, s:o, s:s, s:o}", "scene",
                     json_words(curve->scene_data.path), "label", json_words(curve->variant.label),
                     "start_seconds", curve->start_seconds, "slope", interval_json(curve->slope),
                     "efficiency", interval_json(curve->efficiency), "bias",
                     interval_json(curve->bias), "efficiency_ratio", interval_json(curve->ratio),
                     "time_to", times, "verdict", converge_verdict(curve), "points", points);
}

static json_t *references_json(const struct converge *c)
{
    json_t *references = json_array();
    for (uint32_t s = 0; s < c->options->argument_count; s++) {
        const struct converge_reference *r = &c->references[s];
        json_array_append_new(
            references,
            r->name ? json_pack("{s:o, s:I, s:o, s:o}", "name", json_words(r->name), "spp",
                                (json_int_t)r->spp, "own_mse",
                                json_number(r->picture.noise_known ? r->picture.mse : NAN),
                                "own_relmse",
                                json_number(r->picture.noise_known ? r->picture.relmse : NAN))
                    : json_null());
    }
    return references;
}

static json_t *result_json(const struct converge *c)
{
    json_t *curves = json_array();
    for (uint32_t i = 0; i < c->curve_count; i++)
        json_array_append_new(curves, curve_json(c, &c->curves[i]));
    return json_pack("{s:s, s:o, s:s, s:s, s:i, s:b, s:o, s:o}", "version", LAMPYRIS_VERSION,
                     "command", json_words(c->options->command_line), "device", c->gpu.info.name,
                     "driver", c->gpu.info.driver, "replicates", (int)c->replicates_done,
                     "stopped_early", c->stopped, "references", references_json(c), "curves",
                     curves);
}

int converge_print_json(const struct converge *c)
{
    return json_print(result_json(c));
}

// --- files ---------------------------------------------------------------------------------------

static bool write_json(const struct converge *c, const char *path, struct err *err)
{
    json_t *object = result_json(c);
    char *text = object ? json_dumps(object, JSON_INDENT(1)) : NULL;
    json_decref(object);
    bool ok = text ? file_write_atomic(path, text, strlen(text), err)
                   : err_memory(err, "results", c->curve_count);
    free(text);
    return ok;
}

static void print_csv(const struct converge *c, FILE *file)
{
    fprintf(file, "scene,curve,replicate,spp,seconds");
    for (int m = 0; m < CONVERGE_METRICS; m++)
        fprintf(file, ",%s", converge_metric_names[m]);
    fputc('\n', file);
    for (uint32_t i = 0; i < c->curve_count; i++)
        for (uint32_t r = 0; r < c->replicates_done; r++)
            for (uint32_t p = 0; p < c->point_count; p++) {
                const struct converge_curve *curve = &c->curves[i];
                const struct converge_sample *s = converge_at(c, curve, r, p);
                fprintf(file, "\"%s\",\"%s\",%u,%" PRIu64 ",%.9g", curve->scene_data.path,
                        curve->variant.label, r, c->spp[p], s->seconds);
                for (int m = 0; m < CONVERGE_METRICS; m++)
                    if (isnan(s->metric[m]))
                        fputc(',', file);
                    else
                        fprintf(file, ",%.9g", s->metric[m]);
                fputc('\n', file);
            }
}

static bool write_csv(const struct converge *c, const char *path, struct err *err)
{
    char *text = NULL;
    size_t size = 0;
    FILE *file = open_memstream(&text, &size);
    if (!file)
        return err_memory(err, "results.csv", 0);
    print_csv(c, file);
    bool ok = fclose(file) == 0 ? file_write_atomic(path, text, size, err)
                                : err_memory(err, "results.csv", size);
    free(text);
    return ok;
}

bool converge_write(struct converge *c, const char *folder, struct err *err)
{
    const char *json = arena_printf(&c->arena, "%s/results.json", folder);
    const char *csv = arena_printf(&c->arena, "%s/results.csv", folder);
    if (!json || !csv)
        return err_memory(err, "file names", 0);
    return file_make_folder(folder, err) && write_json(c, json, err) && write_csv(c, csv, err) &&
           converge_write_html(c, folder, err);
}
