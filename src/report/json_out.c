#include "report/json_out.h"

#include "base/file.h"
#include "json/json_parse.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

json_t *json_number(double value)
{
    return isfinite(value) ? json_real(value) : json_null();
}

json_t *json_interval(struct interval interval)
{
    return json_pack("{s:o, s:o, s:o}", "value", json_number(interval.value), "ci_low",
                     json_number(interval.low), "ci_high", json_number(interval.high));
}

json_t *json_words(const char *text)
{
    json_t *string = json_string(text);
    if (string)
        return string;
    char *ascii = strdup(text);
    for (char *c = ascii; c && *c; c++)
        if ((unsigned char)*c >= 0x80)
            *c = '?';
    string = ascii ? json_string(ascii) : NULL;
    free(ascii);
    return string;
}

json_t *json_word_list(const char *const *words, uint32_t count)
{
    json_t *array = json_array();
    for (uint32_t i = 0; i < count; i++)
        json_array_append_new(array, json_words(words[i]));
    return array;
}

char *json_to_text(json_t *object, size_t flags, struct err *err)
{
    char *text = object ? json_dumps(object, flags) : NULL;
    json_decref(object);
    if (text && !json_lost_memory())
        return text;
    json_release(text);
    err_memory(err, "the JSON result", 0);
    return NULL;
}

static bool put(json_t *object, size_t layout, struct err *err)
{
    // Nine digits distinguish all floats, and times are not more accurate.
    char *text = json_to_text(object, layout | JSON_REAL_PRECISION(9), err);
    if (text)
        puts(text); // main() detects that stdout cannot be written
    json_release(text);
    return text != NULL;
}

bool json_put(json_t *object, struct err *err)
{
    return put(object, JSON_INDENT(2), err);
}

bool json_put_line(json_t *object, struct err *err)
{
    return put(object, JSON_COMPACT, err);
}

bool json_write(json_t *object, const char *path, struct err *err)
{
    char *text = json_to_text(object, JSON_INDENT(1) | JSON_REAL_PRECISION(9), err);
    if (!text)
        return err_prepend(err, "%s", path);
    bool ok = file_write_atomic(path, text, strlen(text), err);
    json_release(text);
    return ok;
}
