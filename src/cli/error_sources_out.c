#include "cli/error_sources_out.h"

#include "report/json_out.h"
#include "report/text_out.h"
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

// --- for people ----------------------------------------------------------------------------------

static void print_share(const char *name, const struct error_share *share, bool has_interval)
{
    char interval[48] = "";
    if (has_interval)
        snprintf(interval, sizeof interval, "(%.1f to %.1f)", 100.0 * share->share.low,
                 100.0 * share->share.high);
    printf("          %-13s %6.1f %% %-19s %9.3g", name, 100.0 * share->share.value, interval,
           share->error);
}

static bool is_empty(const struct error_by *by, uint32_t class)
{
    return !(by->classes[class].error > 0.0) && !(by->light[class] > 0.0);
}

// Explains the sign of the covariances of the classes, if it is certain.
static const char *common_words(const struct error_share *together, bool has_interval)
{
    const struct interval *share = &together->share;
    if ((has_interval ? share->high : share->value) < 0.0)
        return "   less: one contributes more where another contributes less";
    if ((has_interval ? share->low : share->value) > 0.0)
        return "   more: the same samples contribute to several at once";
    return "";
}

static void print_kind(const struct error_sources *sources, enum error_kind kind)
{
    const struct error_by *by = &sources->by[kind];
    bool has_interval = sources->has_intervals && by->error > 0.0;
    printf("error by  %-13s %6s   %-19s %9s %8s\n", error_kind_names[kind], "share",
           has_interval ? "(95 %)" : "", "relMSE", "light");
    for (uint32_t i = 0; i < by->count; i++) {
        if (is_empty(by, i))
            continue;
        print_share(error_class_name(kind, i), &by->classes[i], has_interval);
        printf(" %6.1f %%\n", 100.0 * by->light[i]);
    }
    print_share("together", &by->together, has_interval);
    puts(common_words(&by->together, has_interval));
}

static void print_path(const struct bright_path *path, const char *command)
{
    printf("          %.4g %.4g %.4g, %.2g times the brightness around it, after %u scattering "
           "event%s from "
           "%s, %s, in pixel %u,%u",
           (double)path->radiance[0], (double)path->radiance[1], (double)path->radiance[2],
           path->excess, path->scattering_events, path->scattering_events == 1 ? "" : "s",
           error_class_name(ERROR_BY_EMITTER, path->emitter),
           path->is_connection ? "by a shadow ray" : "met by the path", path->x, path->y);
    if (path->share >= 0.0)
        printf(" with %.2g %% of the error", 100.0 * path->share);
    putchar('\n');
    if (!command)
        return;
    fputs("            ", stdout);
    print_words(command);
    printf(" --pixel %u,%u --sample %u\n", path->x, path->y, path->sample);
}

void error_sources_print(const struct error_sources *sources, const char *command)
{
    if (!sources->kinds)
        return;
    if (sources->reason)
        printf("error by  not known: %s\n", sources->reason);
    for (int kind = 0; kind < ERROR_KIND_COUNT && !sources->reason; kind++)
        if (sources->kinds & error_kind_aov((enum error_kind)kind))
            print_kind(sources, (enum error_kind)kind);
    if (sources->brightest_count > 0)
        printf("brightest contributions%s:\n",
               command ? ", and the commands that follow their paths"
                       : "; --pixel follows neither paths that split nor those of a sequence");
    for (uint32_t i = 0; i < sources->brightest_count; i++)
        print_path(&sources->brightest[i], command);
}

// --- for machines --------------------------------------------------------------------------------

static json_t *share_json(const struct error_share *share, bool has_interval)
{
    struct interval interval = share->share;
    if (!has_interval)
        interval.low = interval.high = NAN;
    return json_pack("{s:o, s:o}", "local_relmse", json_number(share->error), "share",
                     json_interval(interval));
}

static json_t *kind_json(const struct error_sources *sources, enum error_kind kind)
{
    const struct error_by *by = &sources->by[kind];
    if (sources->reason || !(sources->kinds & error_kind_aov(kind)))
        return json_null();
    json_t *classes = json_array();
    for (uint32_t i = 0; i < by->count; i++) {
        json_t *object = share_json(&by->classes[i], sources->has_intervals);
        json_object_set_new(object, "name", json_string(error_class_name(kind, i)));
        json_object_set_new(object, "light", json_number(by->light[i]));
        json_array_append_new(classes, object);
    }
    return json_pack("{s:o, s:o, s:o}", "local_relmse", json_number(by->error), "classes", classes,
                     "together", share_json(&by->together, sources->has_intervals));
}

static json_t *command_json(const struct bright_path *path, const char *command)
{
    int length = command ? snprintf(NULL, 0, "%s --pixel %u,%u --sample %u", command, path->x,
                                    path->y, path->sample)
                         : -1;
    char *text = length < 0 ? NULL : malloc((size_t)length + 1);
    if (!text)
        return command ? NULL : json_null();
    snprintf(text, (size_t)length + 1, "%s --pixel %u,%u --sample %u", command, path->x, path->y,
             path->sample);
    json_t *words = json_words(text);
    free(text);
    return words;
}

static json_t *path_json(const struct bright_path *path, const char *command)
{
    const float *radiance = path->radiance;
    return json_pack("{s:[i, i], s:I, s:I, s:s, s:s, s:[o, o, o], s:o, s:o, s:o}", "pixel", path->x,
                     path->y, "sample", (json_int_t)path->sample, "scattering_events",
                     (json_int_t)path->scattering_events, "emitter",
                     error_class_name(ERROR_BY_EMITTER, path->emitter), "found_by",
                     path->is_connection ? "shadow ray" : "path", "radiance",
                     json_number((double)radiance[0]), json_number((double)radiance[1]),
                     json_number((double)radiance[2]), "excess", json_number(path->excess), "share",
                     json_number(path->share), "command", command_json(path, command));
}

json_t *error_sources_json(const struct error_sources *sources, const char *command)
{
    if (!sources->kinds)
        return json_null();
    json_t *brightest = json_array(), *object = json_object();
    json_object_set_new(object, "reason",
                        sources->reason ? json_string(sources->reason) : json_null());
    for (int kind = 0; kind < ERROR_KIND_COUNT; kind++)
        json_object_set_new(object, error_kind_names[kind],
                            kind_json(sources, (enum error_kind)kind));
    for (uint32_t i = 0; i < sources->brightest_count; i++)
        json_array_append_new(brightest, path_json(&sources->brightest[i], command));
    json_object_set_new(object, "brightest", brightest);
    return object;
}
