#include "cli/render/trace_file.h"

#include "base/file.h"
#include "base/memory_stream.h"
#include "json/json_parse.h"
#include "report/json_out.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define TRACE_BYTES_MAX (64u << 20)

static const struct column {
    const char *name;
    size_t offset;
    bool is_count;
} columns[] = {
#define NUMBER(field)                                                                              \
    {                                                                                              \
#field, offsetof(struct trace_row, field), false                                           \
    }
#define COUNT(field)                                                                               \
    {                                                                                              \
#field, offsetof(struct trace_row, field), true                                            \
    }
    COUNT(spp),
    COUNT(frames),
    NUMBER(seconds),
    NUMBER(judging_seconds),
    NUMBER(msamples_per_s),
    COUNT(closest_rays),
    COUNT(shadow_rays),
    NUMBER(local_relmse),
    NUMBER(ci_low),
    NUMBER(ci_high),
    NUMBER(at_most),
    NUMBER(true_local_relmse),
    NUMBER(true_relmse),
    NUMBER(true_mse),
    NUMBER(true_smape),
    NUMBER(true_psnr),
#undef NUMBER
#undef COUNT
};
enum { COLUMNS = sizeof columns / sizeof columns[0] };

static double *field(struct trace_row *row, size_t column)
{
    return (double *)((char *)row + columns[column].offset);
}

static double value(const struct trace_row *row, size_t column)
{
    return *(const double *)((const char *)row + columns[column].offset);
}

static bool is_json(const char *path)
{
    return path_has_extension(path, "json");
}

bool trace_check_format(const char *path, struct err *err)
{
    return is_json(path) || path_has_extension(path, "csv") ||
           err_set(err, ERR_USAGE, "--trace %s: expected a name that ends in .csv or .json", path);
}

// --- writing -------------------------------------------------------------------------------------

static void put_csv(FILE *out, const struct trace *trace)
{
    for (size_t c = 0; c < COLUMNS; c++)
        fprintf(out, "%s,", columns[c].name);
    fputs("render,reference,reason\n", out);
    for (uint32_t r = 0; r < trace->count; r++) {
        const struct trace_row *row = &trace->rows[r];
        for (size_t c = 0; c < COLUMNS; c++) {
            if (isfinite(value(row, c)))
                fprintf(out, "%.12g", value(row, c));
            fputc(',', out);
        }
        fprintf(out, "%s,%s,\"%s\"\n", trace->render, trace->reference,
                row->reason ? row->reason : "");
    }
}

static bool put_json(FILE *out, const struct trace *trace, json_t *head)
{
    json_t *rows = json_array();
    for (uint32_t r = 0; r < trace->count; r++) {
        const struct trace_row *row = &trace->rows[r];
        json_t *object = json_object();
        for (size_t c = 0; c < COLUMNS; c++)
            json_object_set_new(object, columns[c].name,
                                columns[c].is_count ? json_integer((json_int_t)value(row, c))
                                                    : json_number(value(row, c)));
        json_object_set_new(object, "reason", row->reason ? json_words(row->reason) : json_null());
        json_array_append_new(rows, object);
    }
    bool ok =
        json_object_set_new(head, "render", json_string(trace->render)) == 0 &&
        json_object_set_new(head, "reference_hash",
                            *trace->reference ? json_string(trace->reference) : json_null()) == 0 &&
        json_object_set_new(head, "rows", rows) == 0 &&
        json_dumpf(head, out, JSON_INDENT(2) | JSON_REAL_PRECISION(12)) == 0 && !json_lost_memory();
    fputc('\n', out);
    return ok;
}

bool trace_write(const char *path, const struct trace *trace, json_t *head, struct err *err)
{
    struct memory_stream stream;
    bool ok = memory_stream_open(&stream);
    if (ok && is_json(path))
        ok = put_json(stream.file, trace, head);
    else if (ok)
        put_csv(stream.file, trace);
    ok = memory_stream_close(&stream) && ok;
    ok = ok ? file_write_atomic(path, stream.text, stream.size, err)
            : err_memory(err, "a trace", stream.size);
    memory_stream_finish(&stream);
    return ok;
}

// --- reading -------------------------------------------------------------------------------------

static bool check_belongs(const struct trace *trace, const char *render, const char *reference,
                          struct err *err)
{
    if (strcmp(render, trace->render) != 0)
        return err_set(err, ERR_INPUT,
                       "is the trace of another render; expected one with the settings, scene and "
                       "device of the checkpoint, or another name");
    if (strcmp(reference, trace->reference) != 0)
        return err_set(err, ERR_INPUT,
                       "was made %s%s; expected the same --reference, or another name",
                       *reference ? "against another reference" : "without a reference",
                       *reference && !*trace->reference ? ", and this run has none" : "");
    return true;
}

static bool damaged(uint32_t row, const char *what, struct err *err)
{
    return err_set(err, ERR_INPUT, "row %u: wrong %s; expected a trace written by this version",
                   row, what);
}

// Returns the text before the next separator, and replaces the separator by NUL. Returns NULL if no
// text is left.
static char *next_part(char **rest, char separator)
{
    char *begin = *rest, *end = begin ? strchr(begin, separator) : NULL;
    if (end)
        *end = '\0';
    *rest = end ? end + 1 : NULL;
    return begin;
}

static char *next_field(char **rest)
{
    return next_part(rest, ',');
}

static bool parse_number(const char *text, bool is_count, double *out)
{
    char *end;
    *out = *text ? strtod(text, &end) : NAN;
    return *text ? *end == '\0' && isfinite(*out) : !is_count;
}

static bool read_csv_row(char *line, uint32_t number, const struct trace *trace,
                         struct trace_row *row, struct err *err)
{
    char *rest = line;
    for (size_t c = 0; c < COLUMNS; c++) {
        const char *text = next_field(&rest);
        if (!text || !parse_number(text, columns[c].is_count, field(row, c)))
            return damaged(number, columns[c].name, err);
    }
    const char *render = next_field(&rest), *reference = next_field(&rest);
    size_t length = rest ? strlen(rest) : 0;
    if (!render || !reference || length < 2 || rest[0] != '"' || rest[length - 1] != '"')
        return damaged(number, "reason", err);
    rest[length - 1] = '\0';
    row->reason = rest[1] ? rest + 1 : NULL;
    return check_belongs(trace, render, reference, err);
}

static bool has_names(char *line)
{
    char *rest = line;
    for (size_t c = 0; c < COLUMNS; c++) {
        const char *name = next_field(&rest);
        if (!name || strcmp(name, columns[c].name) != 0)
            return false;
    }
    return rest && strcmp(rest, "render,reference,reason") == 0;
}

static bool read_csv(char *text, struct trace *trace, struct err *err)
{
    char *rest = text, *line = next_part(&rest, '\n');
    if (!has_names(line))
        return damaged(0, "names of columns", err);
    while (rest && *rest) {
        line = next_part(&rest, '\n');
        if (trace->count == TRACE_ROWS_MAX)
            return damaged(trace->count, "number of rows", err);
        if (!read_csv_row(line, trace->count + 1, trace, &trace->rows[trace->count], err))
            return false;
        trace->count++;
    }
    return true;
}

static bool read_json_row(const json_t *object, uint32_t number, struct trace_row *row,
                          struct arena *arena, struct err *err)
{
    for (size_t c = 0; c < COLUMNS; c++) {
        const json_t *entry = json_object_get(object, columns[c].name);
        if (!(columns[c].is_count ? json_is_integer(entry)
                                  : json_is_number(entry) || json_is_null(entry)))
            return damaged(number, columns[c].name, err);
        *field(row, c) = json_is_null(entry) ? NAN : json_number_value(entry);
    }
    const json_t *reason = json_object_get(object, "reason");
    if (json_is_string(reason))
        row->reason = arena_strdup(arena, json_string_value(reason));
    return json_is_string(reason) || json_is_null(reason) || damaged(number, "reason", err);
}

static bool read_json(const struct file_bytes *bytes, struct trace *trace, struct arena *arena,
                      struct err *err)
{
    struct err problem = {0};
    json_t *head = json_parse("the trace", bytes, JSON_REJECT_DUPLICATES, &problem);
    if (!head && problem.code != ERR_INPUT)
        return err_set(err, problem.code, "%s", problem.msg);
    const json_t *rows = json_object_get(head, "rows");
    const char *render = json_string_value(json_object_get(head, "render"));
    const char *reference = json_string_value(json_object_get(head, "reference_hash"));
    size_t count = json_array_size(rows);
    bool ok = json_is_array(rows) && render && count <= TRACE_ROWS_MAX
                  ? check_belongs(trace, render, reference ? reference : "", err)
                  : damaged(0, "list of rows", err);
    for (size_t i = 0; ok && i < count; i++)
        ok = read_json_row(json_array_get(rows, i), (uint32_t)i + 1, &trace->rows[i], arena, err);
    trace->count = ok ? (uint32_t)count : 0;
    json_decref(head);
    return ok;
}

bool trace_read(const char *path, struct trace *trace, struct arena *arena, struct err *err)
{
    struct file_bytes bytes;
    if (!file_read_own(arena, path, TRACE_BYTES_MAX, &bytes, err))
        return false;
    trace->count = 0;
    trace->rows = ARENA_NEW(arena, struct trace_row, TRACE_ROWS_MAX);
    char *text = arena_printf(arena, "%s", (const char *)bytes.data);
    if (!text || !trace->rows)
        return err_memory(err, "a trace", bytes.size);
    bool ok = is_json(path) ? read_json(&bytes, trace, arena, err) : read_csv(text, trace, err);
    return ok || err_prepend(err, "%s", path);
}
