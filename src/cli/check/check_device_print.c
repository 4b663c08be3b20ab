#include "cli/check/device_check.h"

#include "cli/options.h"
#include "report/json_out.h"
#include "report/machine.h"
#include <stdio.h>

static void print_heading(const struct device_check *d, size_t row)
{
    const struct check_group *group = d->rows[row].group;
    if (row == 0 || d->rows[row - 1].group != group)
        printf("%s%s: %s\n", row ? "\n" : "", group->name, group->about);
}

void device_check_print_list(const struct device_check *d)
{
    for (size_t i = 0; i < d->count; i++) {
        const struct check_case *c = d->rows[i].this_case;
        print_heading(d, i);
        printf("  %-44s %s%s\n", c->name, c->expected, c->is_long ? " (long)" : "");
    }
}

void device_check_print_row(const struct device_check *d, size_t row)
{
    const struct check_case *c = d->rows[row].this_case;
    const struct check_result *r = &d->rows[row].result;
    print_heading(d, row);
    printf("  %-7s %s: %s", check_outcome_names[r->outcome], c->name, c->expected);
    if (*r->expected)
        printf(" = %s", r->expected);
    if (*r->seen)
        printf("; seen %s", r->seen);
    if (*r->why)
        printf("; %s", r->why);
    printf(" (%.1f s)\n", r->seconds);
    fflush(stdout);
}

// Prints a sentence, for use in publications, about which bits were equal on which device. The
// first case only renders the same image again.
static void print_reproducible(const struct device_check *d)
{
    size_t same = device_check_outcomes(d, CHECK_PASSED), others = 0, broken = 0;
    const char *hash = "";
    for (size_t i = 0; i < d->done; i++) {
        const struct check_result *r = &d->rows[i].result;
        others += r->outcome == CHECK_FAILED && *r->seen;
        broken += r->is_lost || (r->outcome == CHECK_FAILED && !*r->seen);
        hash = *hash ? hash : r->expected;
    }
    printf("lampyris %s on %s (%s): %zu of %zu renders with different waves, splits of the "
           "samples, features and limits have the same bits, hash %s%s",
           LAMPYRIS_VERSION, d->gpu.info.name, d->gpu.info.driver, same, same + others,
           *hash ? hash : "not known", others > 0 ? "; the others do not" : "");
    if (broken > 0)
        printf("; %zu could not be rendered", broken);
    puts(".");
}

void device_check_print_end(const struct device_check *d)
{
    size_t passed = device_check_outcomes(d, CHECK_PASSED);
    size_t failed = device_check_outcomes(d, CHECK_FAILED);
    printf("%s%zu of %zu cases pass, %zu fail, %zu were not run, in %.0f s, on %s (%s)\n",
           d->options->quiet ? "" : "\n", passed, d->count, failed, d->count - passed - failed,
           d->seconds, d->gpu.info.name, d->gpu.info.driver);
    if (d->options->check.reproducible)
        print_reproducible(d);
}

static json_t *words_or_null(const char *text)
{
    return *text ? json_words(text) : json_null();
}

static json_t *row_json(const struct device_check *d, size_t row)
{
    const struct check_case *c = d->rows[row].this_case;
    const struct check_result *r = &d->rows[row].result;
    json_t *object = json_pack("{s:s, s:s, s:s, s:b}", "group", d->rows[row].group->name, "name",
                               c->name, "expected", c->expected, "long", c->is_long);
    if (row < d->done) {
        static const char *const words[] = {
            [CHECK_NOT_RUN] = "not run", [CHECK_PASSED] = "pass", [CHECK_FAILED] = "fail"};
        json_object_set_new(object, "outcome", json_string(words[r->outcome]));
        json_object_set_new(object, "value", words_or_null(r->expected));
        json_object_set_new(object, "seen", words_or_null(r->seen));
        json_object_set_new(object, "why", words_or_null(r->why));
        json_object_set_new(object, "seconds", json_number(r->seconds));
    }
    return object;
}

json_t *device_check_json(const struct device_check *d)
{
    json_t *cases = json_array();
    for (size_t i = 0; i < d->count; i++)
        json_array_append_new(cases, row_json(d, i));
    if (d->options->check.list)
        return json_pack("{s:o}", "cases", cases);
    size_t passed = device_check_outcomes(d, CHECK_PASSED);
    size_t failed = device_check_outcomes(d, CHECK_FAILED);
    return json_pack("{s:o, s:s, s:f, s:I, s:I, s:I, s:o}", "machine", machine_json(&d->gpu),
                     "command", d->options->command_line, "seconds", d->seconds, "passed",
                     (json_int_t)passed, "failed", (json_int_t)failed, "not_run",
                     (json_int_t)(d->count - passed - failed), "cases", cases);
}
