// Prints the JSON output of `lampyris converge`, and writes its files.
#include "cli/converge/converge.h"

#include "base/file.h"
#include "base/file_inputs.h"
#include "cli/error_sources_out.h"
#include "cli/exit_code.h"
#include "image/image.h"
#include "report/csv_out.h"
#include "report/html.h"
#include "report/json_out.h"
#include "report/machine.h"
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// --- JSON: docs/converge.schema.json -------------------------------------------------------------

static json_t *replicates_json(const struct converge *c, const struct converge_curve *curve,
                               uint32_t point)
{
    json_t *metrics = json_object(), *seconds = json_array(), *spp = json_array();
    json_t *bounds = json_array();
    for (int m = 0; m < CONVERGE_METRICS; m++) {
        json_t *values = json_array();
        for (uint32_t r = 0; r < c->replicates_done; r++)
            json_array_append_new(values, json_number(converge_at(c, curve, r, point)->metric[m]));
        json_object_set_new(metrics, converge_metric_names[m], values);
    }
    for (uint32_t r = 0; r < c->replicates_done; r++) {
        const struct converge_sample *s = converge_at(c, curve, r, point);
        json_array_append_new(seconds, json_number(s->seconds));
        json_array_append_new(spp, json_integer((json_int_t)s->spp));
        json_array_append_new(bounds, json_number(s->at_most));
    }
    return json_pack("{s:o, s:o, s:o, s:o}", "spp", spp, "seconds", seconds, "metrics", metrics,
                     "local_relmse_at_most", bounds);
}

static json_t *point_json(const struct converge *c, const struct converge_curve *curve,
                          uint32_t point)
{
    const struct converge_point *p = &curve->points[point];
    json_t *metrics = json_object();
    for (int m = 0; m < CONVERGE_METRICS; m++)
        json_object_set_new(metrics, converge_metric_names[m], json_interval(p->metric[m]));
    json_t *spp = c->spp ? json_integer((json_int_t)c->spp[point]) : json_number(p->spp.value);
    return json_pack("{s:o, s:o, s:o, s:o, s:o, s:i, s:o}", "spp", spp, "time_limit",
                     json_number(c->seconds ? c->seconds[point] : NAN), "seconds",
                     json_interval(p->seconds), "metrics", metrics, "local_relmse_at_most",
                     json_number(p->at_most), "unknown", (int)p->unknown, "replicates",
                     replicates_json(c, curve, point));
}

static json_t *curve_json(const struct converge *c, const struct converge_curve *curve)
{
    json_t *points = json_array(), *targets = json_array();
    for (uint32_t p = 0; p < c->point_count; p++)
        json_array_append_new(points, point_json(c, curve, p));
    for (int i = 0; i < CONVERGE_TARGETS; i++) {
        const struct converge_target *t = &curve->targets[i];
        json_array_append_new(targets,
                              json_pack("{s:f, s:o, s:o, s:b}", "local_relmse", converge_targets[i],
                                        "seconds", json_interval(t->seconds), "spp",
                                        json_interval(t->spp), "extrapolated", t->extrapolated));
    }
    char hash[24];
    snprintf(hash, sizeof hash, "%016" PRIx64, curve->image_hash);
    bool is_known = !isnan(curve->bias.value);
    return json_pack("{s:o, s:o, s:f, s:o, s:o, s:o, s:o, s:o, s:o, s:s, s:o, s:s, s:o}", "scene",
                     json_words(curve->scene_data.path), "label", json_words(curve->variant.label),
                     "start_seconds", curve->start_seconds, "slope", json_interval(curve->slope),
                     "efficiency", json_interval(curve->efficiency), "efficiency_mse",
                     json_interval(curve->efficiency_mse), "efficiency_ratio",
                     json_interval(curve->ratios[0]), "bias", json_interval(curve->bias), "biased",
                     is_known ? json_boolean(converge_is_biased(curve)) : json_null(), "verdict",
                     converge_verdict(curve->ratios[0]), "time_to", targets, "image_hash", hash,
                     "points", points);
}

static json_t *references_json(const struct converge *c)
{
    json_t *references = json_array();
    for (uint32_t s = 0; s < c->options->argument_count; s++) {
        const struct converge_reference *r = &c->references[s];
        const struct reference *p = &r->picture;
        json_array_append_new(
            references, r->name
                            ? json_pack("{s:o, s:I, s:o, s:o, s:o}", "name", json_words(r->name),
                                        "spp", (json_int_t)r->spp, "own_local_relmse",
                                        json_number(p->noise_known ? p->local_relmse : NAN),
                                        "own_relmse", json_number(p->noise_known ? p->relmse : NAN),
                                        "own_mse", json_number(p->noise_known ? p->mse : NAN))
                            : json_null());
    }
    return references;
}

// Makes a list with each pair of curves of the same scene.
static json_t *pairs_json(const struct converge *c)
{
    json_t *pairs = json_array();
    for (uint32_t i = 0; i < c->curve_count; i++) {
        const struct converge_curve *curve = &c->curves[i];
        uint32_t first, count = converge_siblings(c, curve, &first);
        for (uint32_t k = i - first + 1; k < count; k++) {
            struct interval ratio = c->curves[first + k].ratios[i - first];
            json_array_append_new(pairs, json_pack("{s:i, s:i, s:o, s:s}", "curve",
                                                   (int)(first + k), "than", (int)i,
                                                   "efficiency_ratio", json_interval(ratio),
                                                   "verdict", converge_verdict(ratio)));
        }
    }
    return pairs;
}

static json_t *result_json(const struct converge *c)
{
    json_t *curves = json_array(), *notes = json_array();
    char texts[CONVERGE_NOTES][CONVERGE_NOTE_SIZE];
    uint32_t count = converge_notes(c, texts);
    for (uint32_t i = 0; i < count; i++)
        json_array_append_new(notes, json_string(texts[i]));
    for (uint32_t i = 0; i < c->curve_count; i++) {
        json_t *curve = curve_json(c, &c->curves[i]);
        json_object_set_new(curve, "command", json_words(c->curves[i].command));
        // The brightest paths are reported for single images only.
        json_t *sources = error_sources_json(&c->curves[i].pooled, NULL);
        json_object_del(sources, "brightest");
        json_object_set_new(curve, "error_by", sources);
        json_array_append_new(curves, curve);
    }
    return json_pack("{s:s, s:o, s:o, s:i, s:b, s:s, s:o, s:o, s:o, s:o}", "version",
                     LAMPYRIS_VERSION, "command", json_words(c->options->command_line), "machine",
                     machine_json(&c->gpu), "replicates", (int)c->replicates_done, "stopped_early",
                     c->stopped, "slope_on", c->spp ? "spp" : "seconds", "references",
                     references_json(c), "curves", curves, "pairs", pairs_json(c), "notes", notes);
}

int converge_print_json(const struct converge *c)
{
    return command_print(result_json(c));
}

// --- files ---------------------------------------------------------------------------------------

static void print_csv(const void *context, FILE *file)
{
    const struct converge *c = context;
    fprintf(file, "scene,curve,replicate,spp,seconds");
    for (int m = 0; m < CONVERGE_METRICS; m++)
        fprintf(file, ",%s", converge_metric_names[m]);
    fputs(",local_relmse_at_most\n", file);
    for (uint32_t i = 0; i < c->curve_count; i++)
        for (uint32_t r = 0; r < c->replicates_done; r++)
            for (uint32_t p = 0; p < c->point_count; p++) {
                const struct converge_curve *curve = &c->curves[i];
                const struct converge_sample *s = converge_at(c, curve, r, p);
                csv_words(file, curve->scene_data.path);
                fputc(',', file);
                csv_words(file, curve->variant.label);
                fprintf(file, ",%u,%" PRIu64 ",%.9g", r, s->spp, s->seconds);
                for (int m = 0; m < CONVERGE_METRICS; m++) {
                    fputc(',', file);
                    csv_number(file, s->metric[m]);
                }
                fputc(',', file);
                csv_number(file, s->at_most);
                fputc('\n', file);
            }
}

static const char *reference_path(struct converge *c, const char *folder, uint32_t scene)
{
    return arena_printf(&c->arena, "%s/reference-%u.exr", folder, scene);
}

static const char *picture_path(struct converge *c, const char *folder,
                                const struct converge_curve *curve, uint32_t replicate)
{
    return arena_printf(&c->arena, "%s/curve-%u-seed-%u.exr", folder, (uint32_t)(curve - c->curves),
                        curve->scene_data.settings.seed + replicate);
}

static bool write_reference(struct converge *c, uint32_t scene, const char *folder, struct err *err)
{
    const struct converge_reference *reference = &c->references[scene];
    const struct reference *picture = &reference->picture;
    const struct image_layer layers[2] = {{.name = "half_a", .values = picture->halves[0]},
                                          {.name = "half_b", .values = picture->halves[1]}};
    struct image_write_params params = {
        .path = reference_path(c, folder, scene),
        .image = &picture->image,
        .layers = layers,
        .layer_count = picture->halves[0] ? 2 : 0,
    };
    return params.path ? image_write(&params, err) : err_memory(err, "file names", 0);
}

static bool write_pictures(struct converge *c, struct converge_curve *curve, const char *folder,
                           struct err *err)
{
    const struct settings *settings = &curve->scene_data.settings;
    for (uint32_t r = 0; r < c->replicates_done; r++) {
        struct image image = {settings->width, settings->height, curve->pictures[r]};
        struct image_write_params params = {
            .path = picture_path(c, folder, curve, r),
            .image = &image,
        };
        if (!params.path)
            return err_memory(err, "file names", 0);
        if (!image_write(&params, err))
            return false;
    }
    return true;
}

static bool write_images(struct converge *c, const char *folder, struct err *err)
{
    for (uint32_t scene = 0; scene < c->options->argument_count; scene++)
        if (c->references[scene].name && !write_reference(c, scene, folder, err))
            return false;
    for (uint32_t i = 0; i < c->curve_count; i++)
        if (!write_pictures(c, &c->curves[i], folder, err))
            return false;
    return true;
}

bool converge_write(struct converge *c, const char *folder, struct err *err)
{
    const char *json = arena_printf(&c->arena, "%s/results.json", folder);
    const char *csv = arena_printf(&c->arena, "%s/results.csv", folder);
    if (!json || !csv)
        return err_memory(err, "file names", 0);
    return file_make_folder(folder, err) && json_write(result_json(c), json, err) &&
           csv_write(csv, print_csv, c, err) && converge_write_html(c, folder, err) &&
           (!c->options->converge.images || write_images(c, folder, err));
}

static bool check_path(const char *path, struct err *err)
{
    return path ? file_inputs_check(path, err) : err_memory(err, "file names", 0);
}

bool converge_check_files(struct converge *c, const char *folder, struct err *err)
{
    // Registers the reference here, because it has not been read yet.
    if ((c->options->reference && !file_inputs_add(c->options->reference, err)) ||
        !html_check_files(folder, &c->arena, err))
        return false;
    for (uint32_t scene = 0; c->options->converge.images && scene < c->options->argument_count;
         scene++)
        if (!check_path(reference_path(c, folder, scene), err))
            return false;
    for (uint32_t i = 0; c->options->converge.images && i < c->curve_count; i++)
        for (uint32_t r = 0; r < c->replicate_count; r++)
            if (!check_path(picture_path(c, folder, &c->curves[i], r), err))
                return false;
    return true;
}
