// Words, numbers and lines of text formats. Numbers are parsed here because strtof() depends on the
// locale, and takes twice as long for the short numbers of meshes.
#include "scene/core/text.h"

#include "base/ascii.h"
#include "base/c_locale.h"
#include <float.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct text_reader text_open(const char *path, const struct file_bytes *bytes)
{
    static const char byte_order_mark[] = "\xef\xbb\xbf"; // some editors begin UTF-8 files with it
    const char *data = (const char *)bytes->data;
    size_t skipped = strncmp(data, byte_order_mark, 3) == 0 ? 3 : 0;
    return (struct text_reader){
        .at = data + skipped, .end = data + bytes->size, .path = path, .line = 1};
}

size_t text_remaining(const struct text_reader *text)
{
    return (size_t)(text->end - text->at);
}

// --- blanks and lines ----------------------------------------------------------------------------

static bool is_newline(char c)
{
    return c == '\n' || c == '\r';
}

static bool is_blank(char c)
{
    return c == ' ' || c == '\t';
}

static bool is_digit(char c)
{
    return c >= '0' && c <= '9';
}

// Steps over one LF, CR LF or CR.
static void skip_newline(struct text_reader *text)
{
    bool is_pair = text->at[0] == '\r' && text->at[1] == '\n';
    text->at += is_pair ? 2 : 1;
    text->line++;
}

static bool is_continuation(const struct text_reader *text)
{
    return *text->at == '\\' && text->joins_lines && is_newline(text->at[1]);
}

void text_skip_blanks(struct text_reader *text)
{
    for (;;) {
        while (is_blank(*text->at))
            text->at++;
        if (!is_continuation(text))
            return;
        text->at++;
        skip_newline(text);
    }
}

void text_skip_space(struct text_reader *text)
{
    text_skip_blanks(text);
    while (is_newline(*text->at)) {
        skip_newline(text);
        text_skip_blanks(text);
    }
}

bool text_word_ended(const struct text_reader *text)
{
    char c = *text->at;
    return is_blank(c) || is_newline(c) || text->at == text->end || is_continuation(text);
}

bool text_line_ended(struct text_reader *text)
{
    text_skip_blanks(text);
    return is_newline(*text->at) || *text->at == '#' || text->at == text->end;
}

void text_next_line(struct text_reader *text)
{
    bool joins_lines = text->joins_lines && *text->at != '#';
    for (;;) {
        const char *at = text->at;
        while (!is_newline(*at) && at < text->end)
            at++;
        bool is_continued = at > text->at && at[-1] == '\\' && joins_lines;
        text->at = at;
        if (at == text->end)
            return;
        skip_newline(text);
        if (!is_continued)
            return;
    }
}

// --- words ---------------------------------------------------------------------------------------

struct text_span text_word(struct text_reader *text)
{
    text_skip_blanks(text);
    const char *start = text->at;
    while (!text_word_ended(text))
        text->at++;
    return (struct text_span){start, (size_t)(text->at - start)};
}

struct text_span text_rest_of_line(const struct text_reader *text)
{
    struct text_reader ahead = *text;
    text_skip_blanks(&ahead);
    const char *start = ahead.at, *end = start;
    while (!is_newline(*end) && end < text->end)
        end++;
    while (end > start && is_blank(end[-1]))
        end--;
    return (struct text_span){start, (size_t)(end - start)};
}

bool text_equals(struct text_span span, const char *word)
{
    return strlen(word) == span.size && memcmp(span.data, word, span.size) == 0;
}

char *text_copy(struct arena *arena, struct text_span span)
{
    char *copy = ARENA_NEW(arena, char, span.size + 1);
    if (copy)
        memcpy(copy, span.data, span.size);
    return copy;
}

void text_printable(struct text_span span, char *out, size_t size)
{
    size_t length = span.size < size ? span.size : size - 1;
    for (size_t i = 0; i < length; i++)
        out[i] = span.data[i] >= ' ' && span.data[i] <= '~' ? span.data[i] : '?';
    out[length] = '\0';
}

// --- numbers -------------------------------------------------------------------------------------

// A decimal number as written: digits * 10^exponent.
struct decimal {
    uint64_t digits; // the first 19 significant digits, which always fit
    int64_t exponent;
    bool is_negative;
    bool is_truncated; // there were more significant digits
};

#define MAX_DIGITS 19

// Reads a run of digits. Digits after the decimal point decrease the exponent; digits that no
// longer fit are dropped and increase it.
static const char *scan_digits(const char *at, bool is_fraction, int *digit_count,
                               struct decimal *out)
{
    for (; is_digit(*at); at++) {
        unsigned digit = (unsigned)(*at - '0');
        bool fits = *digit_count < MAX_DIGITS;
        if (fits) {
            out->digits = out->digits * 10 + digit;
            *digit_count += out->digits > 0; // leading zeros are not significant
        } else if (digit > 0) {
            out->is_truncated = true;
        }
        out->exponent += (fits ? 0 : 1) - (is_fraction ? 1 : 0);
    }
    return at;
}

// Reads an exponent such as "e+12" if there is one; otherwise returns `at` unchanged.
static const char *scan_exponent(const char *at, struct decimal *out)
{
    if (*at != 'e' && *at != 'E')
        return at;
    bool is_negative = at[1] == '-';
    const char *digits = at + (at[1] == '-' || at[1] == '+' ? 2 : 1);
    if (!is_digit(*digits))
        return at;
    // No text has enough digits to bring a larger exponent back into range.
    const int64_t bound = INT64_C(100000000000000000);
    int64_t exponent = 0;
    for (; is_digit(*digits); digits++)
        exponent = exponent < bound ? exponent * 10 + (*digits - '0') : exponent;
    out->exponent += is_negative ? -exponent : exponent;
    return digits;
}

static const char *scan_decimal(const char *at, struct decimal *out)
{
    *out = (struct decimal){.is_negative = *at == '-'};
    if (*at == '-' || *at == '+')
        at++;
    int digit_count = 0;
    const char *start = at;
    at = scan_digits(at, false, &digit_count, out);
    size_t written = (size_t)(at - start);
    if (*at == '.') {
        start = ++at;
        at = scan_digits(at, true, &digit_count, out);
        written += (size_t)(at - start);
    }
    return written > 0 ? scan_exponent(at, out) : NULL;
}

// Powers of ten that are exact in double precision.
static const double powers[] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                                1e8,  1e9,  1e10, 1e11, 1e12, 1e13, 1e14, 1e15,
                                1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};
static const int64_t max_power = sizeof powers / sizeof powers[0] - 1;

// Computes digits * 10^exponent with one operation. |exponent| must be at most max_power.
static double scale_digits(const struct decimal *decimal)
{
    double value = (double)decimal->digits;
    return decimal->exponent < 0 ? value / powers[-decimal->exponent]
                                 : value * powers[decimal->exponent];
}

// Converts with one double operation (the fast path of Clinger 1990, "How to read floating point
// numbers accurately"), then rounds to float. The conversion of the digits and the operation each
// err by at most half an ulp, 2^-53 of the value, together by less than 2.1 ulps of the double. So
// the float is correctly rounded unless the double lies within 3 ulps of the midpoint between two
// floats, which its last 29 bits show. Returns false in that case, and outside the floats' normal
// range.
static bool convert_fast(const struct decimal *decimal, float *out)
{
    double value = 0;
    if (decimal->is_truncated)
        return false;
    if (decimal->digits > 0) {
        if (decimal->exponent > max_power || decimal->exponent < -max_power)
            return false;
        value = scale_digits(decimal);
        if (value < (double)FLT_MIN || value > (double)FLT_MAX)
            return false;
        uint64_t bits;
        memcpy(&bits, &value, sizeof bits);
        int64_t from_middle = (int64_t)(bits & 0x1fffffff) - 0x10000000;
        if (from_middle >= -3 && from_middle <= 3)
            return false;
    }
    *out = (float)(decimal->is_negative ? -value : value);
    return true;
}

// As convert_fast(), but for double precision: if the digits and the power are exact, the one
// operation rounds correctly.
static bool convert_fast_double(const struct decimal *decimal, double *out)
{
    if (decimal->is_truncated || decimal->digits > UINT64_C(1) << 53)
        return false;
    if (decimal->digits > 0 && (decimal->exponent > max_power || decimal->exponent < -max_power))
        return false;
    double value = decimal->digits > 0 ? scale_digits(decimal) : 0;
    *out = decimal->is_negative ? -value : value;
    return true;
}

static const char *parse_special(const char *at, float *out)
{
    static const struct {
        const char *name;
        float value;
    } specials[] = {{"infinity", INFINITY}, {"inf", INFINITY}, {"nan", NAN}};
    float sign = *at == '-' ? -1.0f : 1.0f;
    if (*at == '-' || *at == '+')
        at++;
    for (size_t i = 0; i < sizeof specials / sizeof specials[0]; i++) {
        size_t length = strlen(specials[i].name);
        if (ascii_begins(at, specials[i].name)) {
            *out = sign * specials[i].value;
            return at + length;
        }
    }
    return NULL;
}

const char *text_parse_float(const char *at, float *out)
{
    struct decimal decimal;
    const char *end = scan_decimal(at, &decimal);
    if (!end)
        return parse_special(at, out);
    if (!convert_fast(&decimal, out))
        *out = c_locale_strtof(at);
    return end;
}

static const char *parse_double(const char *at, double *out)
{
    struct decimal decimal;
    const char *end = scan_decimal(at, &decimal);
    float special = 0;
    if (!end) {
        end = parse_special(at, &special);
        *out = (double)special;
    } else if (!convert_fast_double(&decimal, out)) {
        *out = c_locale_strtod(at);
    }
    return end;
}

bool text_take_float(struct text_reader *text, float *out)
{
    text_skip_blanks(text);
    struct text_reader ahead = *text;
    ahead.at = text_parse_float(text->at, out);
    if (!ahead.at || !text_word_ended(&ahead))
        return false;
    *text = ahead;
    return true;
}

bool text_take_double(struct text_reader *text, double *out)
{
    text_skip_blanks(text);
    struct text_reader ahead = *text;
    ahead.at = parse_double(text->at, out);
    if (!ahead.at || !text_word_ended(&ahead))
        return false;
    *text = ahead;
    return true;
}

bool text_take_integer(struct text_reader *text, int64_t *out)
{
    text_skip_blanks(text);
    const char *at = text->at;
    bool is_negative = *at == '-';
    if (*at == '-' || *at == '+')
        at++;
    if (!is_digit(*at))
        return false;
    int64_t value = 0;
    for (; is_digit(*at); at++) {
        if (__builtin_mul_overflow(value, 10, &value) ||
            __builtin_add_overflow(value, *at - '0', &value))
            value = INT64_MAX;
    }
    *out = is_negative ? -value : value;
    text->at = at;
    return true;
}

bool text_float(struct text_reader *text, const char *what, float *out, struct err *err)
{
    return text_take_float(text, out) || text_unexpected(text, what, err);
}

bool text_double(struct text_reader *text, const char *what, double *out, struct err *err)
{
    return text_take_double(text, out) || text_unexpected(text, what, err);
}

bool text_integer(struct text_reader *text, const char *what, int64_t *out, struct err *err)
{
    return text_take_integer(text, out) || text_unexpected(text, what, err);
}

// --- messages ------------------------------------------------------------------------------------

bool text_fail(const struct text_reader *text, struct err *err, const char *format, ...)
{
    char message[256];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(message, sizeof message, format, arguments);
    va_end(arguments);
    return err_set(err, ERR_INPUT, "%s:%llu: %s", text->path, (unsigned long long)text->line,
                   message);
}

bool text_unexpected(const struct text_reader *text, const char *what, struct err *err)
{
    struct text_reader copy = *text;
    struct text_span word = text_word(&copy);
    if (word.size == 0)
        return text_fail(text, err, "expected %s, found the end of the %s", what,
                         copy.at == copy.end ? "file" : "line");
    char shown[25];
    text_printable(word, shown, sizeof shown);
    return text_fail(text, err, "expected %s, found '%s'", what, shown);
}
