// Conversion of values to and from text, and the result of dragging.
#include "viewer/gui/gui_state.h"

#include <errno.h>
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static bool same(double a, double b, bool is_float)
{
    return is_float ? (float)a == (float)b : a == b;
}

// Returns the word that replaces a value, or NULL.
static const char *word_of(double value, const struct gui_range *range)
{
    if (range && range->infinite && value >= range->max)
        return range->infinite;
    return range && range->least && value <= range->min ? range->least : NULL;
}

static void write_one(double value, bool is_float, const struct gui_range *range, char *out)
{
    const char *word = word_of(value, range);
    if (word) {
        snprintf(out, GUI_VALUE_MAX, "%s", word);
        return;
    }
    if (fabs(value) < 1e15 && value == rint(value)) {
        snprintf(out, GUI_VALUE_MAX, "%.0f", value == 0.0 ? 0.0 : value);
        return;
    }
    // 17 significant digits are enough to distinguish all doubles (IEEE 754-2019, 5.12.2).
    for (int digits = 1; digits <= 17; digits++) {
        snprintf(out, GUI_VALUE_MAX, "%.*g", digits, value);
        if (same(strtod(out, NULL), value, is_float))
            return;
    }
}

void value_write(const double *value, uint32_t count, bool is_float, const struct gui_range *range,
                 char *out)
{
    size_t used = 0;
    for (uint32_t i = 0; i < count; i++) {
        char one[GUI_VALUE_MAX];
        write_one(value[i], is_float, range, one);
        used += (size_t)snprintf(out + used, GUI_VALUE_MAX - used, "%s%.60s", i ? "," : "", one);
    }
}

void value_show(double value, const struct gui_range *range, int digits, char *out)
{
    const char *word = word_of(value, range);
    if (word) {
        snprintf(out, GUI_VALUE_MAX, "%s", word);
        return;
    }
    bool whole = range->integer && fabs(value) < 1e15;
    int length = whole ? snprintf(out, GUI_VALUE_MAX, "%.0f", value)
                       : snprintf(out, GUI_VALUE_MAX, "%.*g", digits, value);
    if (range->unit)
        snprintf(out + length, GUI_VALUE_MAX - (size_t)length, " %s", range->unit);
}

// Prints a decimal number that is the value, with no more digits than necessary. A value that is a
// float is compared as a float: 0.01f is printed as 0.01, although the double differs.
static const char *shortest(double value, char out[32])
{
    enum { DIGITS_MIN = 7, DIGITS_MAX = 17 }; // a float has 7 digits; 17 identify every double
    const bool is_float = value == (double)(float)value;
    for (int digits = DIGITS_MIN; digits <= DIGITS_MAX; digits++) {
        snprintf(out, 32, "%.*g", digits, value);
        const double read = strtod(out, NULL);
        if (read == value || (is_float && (float)read == (float)value))
            break;
    }
    return out;
}

void gui_item_help(const struct gui_item *item, char out[GUI_HELP_MAX])
{
    char least[32], greatest[32];
    const char *help = item->help ? item->help : "";
    bool has_range = item->range[0] < item->range[1] && isfinite(item->range[1]);
    if (has_range && item->range[1] >= (double)FLT_MAX)
        snprintf(out, GUI_HELP_MAX, "%s From %s on.", help, shortest(item->range[0], least));
    else if (has_range)
        snprintf(out, GUI_HELP_MAX, "%s From %s to %s.", help, shortest(item->range[0], least),
                 shortest(item->range[1], greatest));
    else
        snprintf(out, GUI_HELP_MAX, "%s", help);
}

static const char *skip_spaces(const char *text)
{
    return text + strspn(text, " \t");
}

static void say_range(const struct gui_range *range, bool is_float, const char *value, char *why)
{
    char min[GUI_VALUE_MAX], max[GUI_VALUE_MAX];
    write_one(range->min, is_float, NULL, min);
    write_one(range->infinite ? range->greatest : range->max, is_float, NULL, max);
    if (range->infinite)
        snprintf(why, GUI_WHY_MAX, "%.60s is outside [%.40s, %.40s] and is not \"%s\"", value, min,
                 max, range->infinite);
    else
        snprintf(why, GUI_WHY_MAX, "%.60s is outside [%.40s, %.40s]", value, min, max);
}

// Reads a number at the beginning of a text. *end is set to the position after it and after its
// unit, if that follows.
static bool read_one(const char *text, const char **end, bool is_float,
                     const struct gui_range *range, double *out, char *why)
{
    text = skip_spaces(text);
    const char *const words[] = {range->infinite, range->least, range->file_word};
    for (int i = 0; i < 3; i++) {
        size_t length = words[i] ? strlen(words[i]) : 0;
        if (!length || strncmp(text, words[i], length) != 0)
            continue;
        *end = text + length;
        *out = range->infinite && i != 1 ? range->max : range->min;
        return true;
    }
    char *behind;
    double value = strtod(text, &behind);
    if (behind == text || isnan(value)) {
        snprintf(why, GUI_WHY_MAX, "\"%.60s\" is not a number%s%s%s", text,
                 range->infinite ? ", and not \"" : "", range->infinite ? range->infinite : "",
                 range->infinite ? "\"" : "");
        return false;
    }
    char written[64];
    snprintf(written, sizeof written, "%.*s", (int)(behind - text), text);
    *end = skip_spaces(behind);
    if (range->unit && strncmp(*end, range->unit, strlen(range->unit)) == 0)
        *end += strlen(range->unit);
    // The range is checked before the number is rounded, as in scene files and options.
    if (!(value >= range->min && value <= (range->infinite ? range->greatest : range->max))) {
        say_range(range, is_float, written, why);
        return false;
    }
    if (range->integer && value != rint(value)) {
        snprintf(why, GUI_WHY_MAX, "%s is not a whole number", written);
        return false;
    }
    *out = is_float ? (double)(float)value : value;
    return true;
}

bool value_read(const char *text, uint32_t count, bool is_float, const struct gui_range *range,
                double *out, char *why)
{
    double values[3];
    const char *end = text;
    for (uint32_t i = 0; i < count; i++) {
        if (!read_one(end, &end, is_float, range, &values[i], why))
            return false;
        end = skip_spaces(end);
        if (*end == (i + 1 < count ? ',' : '\0')) {
            end += i + 1 < count;
            continue;
        }
        if (count > 1)
            snprintf(why, GUI_WHY_MAX, "\"%.60s\" is not three numbers separated by commas", text);
        else
            snprintf(why, GUI_WHY_MAX, "\"%.60s\" has other text besides a number%s%s", text,
                     range->unit ? " and its unit, " : "", range->unit ? range->unit : "");
        return false;
    }
    memcpy(out, values, count * sizeof *out);
    return true;
}

bool value_read_switch(const char *text, bool *out, char *why)
{
    if (strcmp(text, "on") != 0 && strcmp(text, "off") != 0) {
        snprintf(why, GUI_WHY_MAX, "\"%.60s\" is neither \"on\" nor \"off\"", text);
        return false;
    }
    *out = text[1] == 'n';
    return true;
}

bool value_read_choice(const char *text, const char *const *names, uint32_t *out, char *why)
{
    for (uint32_t i = 0; names[i]; i++) {
        if (strcmp(names[i], text) != 0)
            continue;
        *out = i;
        return true;
    }
    size_t used =
        (size_t)snprintf(why, GUI_WHY_MAX, "\"%.60s\" is not a choice; the choices are", text);
    for (uint32_t i = 0; names[i] && used < GUI_WHY_MAX; i++)
        used += (size_t)snprintf(why + used, GUI_WHY_MAX - used, "%s %s", i ? "," : "", names[i]);
    return false;
}

// --- dragging ------------------------------------------------------------------------------------
// Dragging over the width of a control covers its whole range if that is not wide, or a factor of
// 1000 if the range is logarithmic. Results are rounded to the resolution of a few hundred pixels,
// so that they are round numbers.

#define FACTOR_A_WIDTH 1000.0
// If the range is wider, dragging by a width changes the value by its own magnitude, or by 1.
#define WIDE 1e4

static double rounded(double value, double step)
{
    double unit = pow(10.0, floor(log10(step)));
    // If the unit is below 1, dividing by its inverse makes the result for 0.3 the double nearest
    // to 0.3.
    return unit < 1.0 ? rint(value * rint(1.0 / unit)) / rint(1.0 / unit)
                      : rint(value / unit) * unit;
}

static double dragged_logarithmic(double start, double widths, const struct gui_range *range)
{
    double least = range->integer ? 1.0 : 1e-2;
    double factor = pow(FACTOR_A_WIDTH, widths);
    if (start <= 0.0)
        return widths > 0.0 ? rounded(least * (factor - 1.0), least * factor / 1000.0) : range->min;
    double value = start * factor;
    if (range->min <= 0.0 && widths <= -1.0)
        return range->min; // dragging further down stays at min
    return value > 1e-300 && isfinite(value) ? rounded(value, value / 200.0) : value;
}

static double dragged_linear(double start, double widths, const struct gui_range *range)
{
    double span = range->drag > 0.0 ? range->drag : range->max - range->min;
    if (!(span <= WIDE))
        span = fmax(fabs(start), 1.0);
    return rounded(start + widths * span, span / 500.0);
}

double value_dragged(double start, double widths, const struct gui_range *range, bool is_float)
{
    if (widths == 0.0)
        return start;
    if (range->infinite && start >= range->max && start > 1e3) { // decreasing starts at 1000
        if (widths > 0.0)
            return start;
        start = 1e3;
    }
    double value = range->logarithmic ? dragged_logarithmic(start, widths, range)
                                      : dragged_linear(start, widths, range);
    if (range->integer)
        value = rint(value);
    if (is_float)
        value = (double)(float)value;
    return fmin(fmax(value, range->min), range->max);
}
