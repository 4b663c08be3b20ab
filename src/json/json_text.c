#include "json/json_text.h"

#include "json/json_parse.h"
#include <jansson.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

bool json_text_begin(struct json_text *t, uint32_t indent, struct err *err)
{
    *t = (struct json_text){.err = err, .indent = indent, .key = ""};
    t->failed = !memory_stream_open(&t->stream);
    return !t->failed || err_memory(err, "a JSON text", 1);
}

char *json_text_end(struct json_text *t)
{
    bool ok = memory_stream_close(&t->stream);
    if (ok && !t->failed)
        return t->stream.text;
    if (!t->failed)
        err_memory(t->err, "a JSON text", t->stream.size);
    memory_stream_finish(&t->stream);
    return NULL;
}

// --- structure -----------------------------------------------------------------------------------

static void put(struct json_text *t, const char *text)
{
    if (!t->failed && fputs(text, t->stream.file) == EOF) {
        t->failed = true;
        err_memory(t->err, "a JSON text", strlen(text));
    }
}

static void new_line(struct json_text *t)
{
    put(t, "\n");
    for (uint32_t i = 0; i < t->depth + t->indent; i++)
        put(t, "  ");
}

void json_text_open(struct json_text *t, char bracket, bool in_line)
{
    put(t, bracket == '{' ? "{" : "[");
    t->levels[t->depth].close = bracket == '{' ? '}' : ']';
    t->levels[t->depth].in_line = in_line;
    t->levels[t->depth].has_any = false;
    t->depth++;
}

void json_text_close(struct json_text *t)
{
    t->depth--;
    const char close[] = {t->levels[t->depth].close, '\0'};
    if (!t->levels[t->depth].in_line && t->levels[t->depth].has_any)
        new_line(t);
    put(t, close);
}

void json_text_next(struct json_text *t)
{
    bool in_line = t->levels[t->depth - 1].in_line, has_any = t->levels[t->depth - 1].has_any;
    t->levels[t->depth - 1].has_any = true;
    if (has_any)
        put(t, in_line ? ", " : ",");
    if (!in_line)
        new_line(t);
}

void json_text_key(struct json_text *t, const char *key)
{
    json_text_next(t);
    t->key = key;
    put(t, "\"");
    put(t, key);
    put(t, "\": ");
}

// --- values --------------------------------------------------------------------------------------

static bool is_finite(struct json_text *t, double value)
{
    if (isfinite(value))
        return true;
    if (!t->failed)
        err_set(t->err, ERR_INPUT, "%s: %g cannot be stored in JSON; expected a finite number",
                t->key, value);
    t->failed = true;
    return false;
}

// Writes a number with this many significant digits, or with more where these avoid an exponent
// (magnitudes from 1 to 1e15). Negative zero becomes "-0.0", because "-0" would be read as an
// integer, which has no signed zero.
static void put_digits(struct json_text *t, double value, int count)
{
    char digits[40];
    double magnitude = fabs(value);
    if (magnitude >= 1 && magnitude < 1e15)
        count = (int)fmax(count, floor(log10(magnitude)) + 1);
    snprintf(digits, sizeof digits, "%.*g", count, value);
    put(t, strcmp(digits, "-0") == 0 ? "-0.0" : digits);
}

// Returns the value that is read when the number is written with this many digits.
static double with_digits(double value, int count)
{
    char digits[40];
    snprintf(digits, sizeof digits, "%.*g", count, value);
    return strtod(digits, NULL);
}

void json_text_double(struct json_text *t, double value)
{
    int count = 1;
    if (!is_finite(t, value))
        return;
    while (count < 17 && with_digits(value, count) != value)
        count++;
    put_digits(t, value, count);
}

// Readers parse a double and then round it to a float.
void json_text_float(struct json_text *t, float value)
{
    int count = 1;
    if (!is_finite(t, (double)value))
        return;
    while (count < 17 && (float)with_digits((double)value, count) != value)
        count++;
    put_digits(t, (double)value, count);
}

void json_text_uint(struct json_text *t, uint64_t value)
{
    char digits[32];
    snprintf(digits, sizeof digits, "%llu", (unsigned long long)value);
    put(t, digits);
}

void json_text_bool(struct json_text *t, bool value)
{
    put(t, value ? "true" : "false");
}

bool json_text_can_hold(const char *text)
{
    json_t *string = json_string(text);
    json_decref(string);
    return string && !strstr(text, "${");
}

void json_text_string(struct json_text *t, const char *text)
{
    json_t *string = json_text_can_hold(text) ? json_string(text) : NULL;
    char *dumped = string ? json_dumps(string, JSON_ENCODE_ANY) : NULL;
    if (dumped)
        put(t, dumped);
    else if (!t->failed)
        t->failed =
            !err_set(t->err, ERR_INPUT,
                     "%s: \"%s\" cannot be written to a scene file; expected UTF-8 without \"${\"",
                     t->key, text);
    json_release(dumped);
    json_decref(string);
}

void json_text_raw(struct json_text *t, const char *json)
{
    put(t, json);
}

static bool is_factor(double factor, double unit, bool is_float, double value)
{
    return is_float ? (float)(factor * unit) == (float)value : factor * unit == value;
}

// Tries short decimal numbers first, and then the neighbours of the quotient, because a solution is
// at most two roundings away from it.
bool json_text_factor(double value, double unit, bool is_float, double *out)
{
    double quotient = value / unit, near[4];
    for (int count = 1; count <= 17; count++) {
        *out = with_digits(quotient, count);
        if (is_factor(*out, unit, is_float, value))
            return true;
    }
    near[0] = nextafter(quotient, INFINITY);
    near[1] = nextafter(quotient, -INFINITY);
    near[2] = nextafter(near[0], INFINITY);
    near[3] = nextafter(near[1], -INFINITY);
    for (int i = 0; i < 4; i++) {
        *out = near[i];
        if (is_factor(*out, unit, is_float, value))
            return true;
    }
    return false;
}
