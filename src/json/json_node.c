#include "json/json_node.h"

#include "base/suggest.h"
#include "json/json_parse.h"
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// The macros of json_node.h would replace the names in the definitions below.
#undef node_fail
#undef node_prepend
#undef node_unexpected

struct json_node node_root(const char *file, json_t *value)
{
    return (struct json_node){.value = value, .file = file};
}

struct json_node node_member(const struct json_node *object, const char *key)
{
    return (struct json_node){
        .parent = object,
        .key = key,
        .value = json_object_get(object->value, key),
        .file = object->file,
    };
}

struct json_node node_element(const struct json_node *array, size_t index)
{
    return (struct json_node){
        .parent = array,
        .index = index,
        .value = json_array_get(array->value, index),
        .file = array->file,
    };
}

// --- messages ------------------------------------------------------------------------------------

// Appends to a buffer of `capacity` bytes. Text that does not fit is cut off.
static void append(char *text, size_t capacity, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

static void append(char *text, size_t capacity, const char *format, ...)
{
    size_t length = strlen(text);
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text + length, capacity - length, format, arguments);
    va_end(arguments);
}

// Writes a path such as "shapes[3].transform[0].scale"; "" for the document itself.
static void write_path(const struct json_node *node, char *text, size_t capacity)
{
    if (!node->parent)
        return;
    write_path(node->parent, text, capacity);
    if (node->key)
        append(text, capacity, "%s%s", text[0] ? "." : "", node->key);
    else
        append(text, capacity, "[%zu]", node->index);
}

// Writes the path as a JSON pointer, such as "/shapes/3/transform/0/scale".
static void write_pointer(const struct json_node *node, char *text, size_t capacity)
{
    if (!node->parent)
        return;
    write_pointer(node->parent, text, capacity);
    append(text, capacity, "/");
    if (!node->key)
        append(text, capacity, "%zu", node->index);
    for (const char *c = node->key; c && *c; c++)
        if (*c == '~' || *c == '/')
            append(text, capacity, "~%c", *c == '~' ? '0' : '1');
        else
            append(text, capacity, "%c", *c);
}

bool node_prepend(const struct json_node *node, struct err *err)
{
    char path[256] = "", pointer[256] = "";
    write_path(node, path, sizeof path);
    write_pointer(node, pointer, sizeof pointer);
    err_locate(err, node->file, pointer);
    return path[0] ? err_prepend(err, "%s: %s", node->file, path)
                   : err_prepend(err, "%s", node->file);
}

bool node_fail(const struct json_node *node, struct err *err, const char *format, ...)
{
    char message[384];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(message, sizeof message, format, arguments);
    va_end(arguments);
    err_set(err, ERR_INPUT, "%s", message);
    return node_prepend(node, err);
}

struct node_text node_describe(const json_t *value)
{
    struct node_text described = {""};
    if (json_is_object(value) || json_is_array(value)) {
        snprintf(described.text, sizeof described.text, "an %s of %zu",
                 json_is_object(value) ? "object" : "array",
                 json_is_object(value) ? json_object_size(value) : json_array_size(value));
        return described;
    }
    char *dumped = json_dumps(value, JSON_ENCODE_ANY | JSON_ENSURE_ASCII | JSON_REAL_PRECISION(9));
    if (!dumped)
        return (struct node_text){"this value"};
    bool fits = strlen(dumped) < sizeof described.text;
    snprintf(described.text, sizeof described.text, fits ? "%s" : "%.56s …", dumped);
    json_release(dumped);
    return described;
}

bool node_unexpected(const struct json_node *node, const char *what, struct err *err)
{
    return node_fail(node, err, "expected %s, not %s", what, node_describe(node->value).text);
}

// --- suggestions ---------------------------------------------------------------------------------

// Returns the name at an index, or NULL after the last name.
typedef const char *(*name_at_fn)(const void *names, size_t index);

// Suggests the most similar name, or lists all names if none is similar.
static struct node_hint suggest(const char *word, name_at_fn name_at, const void *names)
{
    struct node_hint hint = {""};
    struct suggestion suggestion = {.wanted = word};
    const char *name;
    for (size_t i = 0; (name = name_at(names, i)) != NULL; i++)
        suggest_offer(&suggestion, name);
    if (suggestion.nearest) {
        snprintf(hint.text, sizeof hint.text, "; did you mean %s?", suggestion.nearest);
        return hint;
    }
    for (size_t i = 0; (name = name_at(names, i)) != NULL; i++)
        append(hint.text, sizeof hint.text, i ? ", %s" : "; known: %s", name);
    return hint;
}

static const char *name_in_list(const void *names, size_t index)
{
    return ((const char *const *)names)[index];
}

static const char *name_in_object(const void *names, size_t index)
{
    void *at = json_object_iter((json_t *)names);
    while (at && index-- > 0)
        at = json_object_iter_next((json_t *)names, at);
    return at ? json_object_iter_key(at) : NULL;
}

struct node_hint node_suggest_key(const char *word, const json_t *object)
{
    return suggest(word, name_in_object, object);
}

struct two_lists {
    const char *const *first, *const *second;
};

static size_t list_length(const char *const *list)
{
    size_t length = 0;
    while (list[length])
        length++;
    return length;
}

static const char *name_in_two_lists(const void *names, size_t index)
{
    const struct two_lists *lists = names;
    size_t first_length = list_length(lists->first);
    return index < first_length ? lists->first[index] : lists->second[index - first_length];
}

// --- structure -----------------------------------------------------------------------------------

static bool is_in_list(const char *const *list, const char *word)
{
    for (; *list; list++)
        if (strcmp(*list, word) == 0)
            return true;
    return false;
}

bool node_check_object(const struct json_node *node, const char *const *required,
                       const char *const *optional, struct err *err)
{
    if (!json_is_object(node->value))
        return node_unexpected(node, "an object", err);
    const struct two_lists known = {required, optional};
    const char *key;
    json_t *value;
    json_object_foreach(node->value, key, value)
    {
        if (strcmp(key, "comment") == 0 || is_in_list(required, key) || is_in_list(optional, key))
            continue;
        const struct json_node unknown = node_member(node, key);
        return node_fail(&unknown, err, "unknown key%s",
                         suggest(key, name_in_two_lists, &known).text);
    }
    for (; *required; required++)
        if (!json_object_get(node->value, *required))
            return node_fail(node, err, "\"%s\" is missing", *required);
    return true;
}

bool node_check_array(const struct json_node *node, size_t min_count, size_t max_count,
                      struct err *err)
{
    if (!json_is_array(node->value))
        return node_unexpected(node, "an array", err);
    size_t count = json_array_size(node->value);
    if (count >= min_count && count <= max_count)
        return true;
    if (min_count == max_count)
        return node_fail(node, err, "%zu elements; expected %zu", count, min_count);
    return node_fail(node, err, "%zu elements; expected %s %zu", count,
                     count < min_count ? "at least" : "at most",
                     count < min_count ? min_count : max_count);
}

bool node_check_either(const struct json_node *object, const char *a, const char *b,
                       struct err *err)
{
    bool has_a = json_object_get(object->value, a) != NULL;
    bool has_b = json_object_get(object->value, b) != NULL;
    if (has_a && has_b)
        return node_fail(object, err, "both \"%s\" and \"%s\" are given; expected one", a, b);
    if (!has_a && !has_b)
        return node_fail(object, err, "\"%s\" or \"%s\" is missing", a, b);
    return true;
}

bool node_check_name(const struct json_node *node, const char *name, struct err *err)
{
    static const char allowed[] =
        "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-";
    if (*name && strspn(name, allowed) == strlen(name))
        return true;
    return node_fail(node, err, "a name consists of letters, digits, \"_\" and \"-\"");
}

// --- values --------------------------------------------------------------------------------------

bool node_number(const struct json_node *node, struct range range, double *out, struct err *err)
{
    if (!json_is_number(node->value))
        return node_unexpected(node, "a number", err);
    double value = json_number_value(node->value);
    bool inside = range.open ? value > range.min && value < range.max
                             : value >= range.min && value <= range.max;
    if (!inside)
        return node_fail(
            node, err, range.open ? "%.9g is outside (%.9g, %.9g)" : "%.9g is outside [%.9g, %.9g]",
            value, range.min, range.max);
    *out = value;
    return true;
}

bool node_read_number(const struct json_node *object, const char *key, struct range range,
                      double *out, struct err *err)
{
    const struct json_node node = node_member(object, key);
    return !node.value || node_number(&node, range, out, err);
}

bool node_read_integer(const struct json_node *object, const char *key, uint64_t min, uint64_t max,
                       uint64_t *out, struct err *err)
{
    const struct json_node node = node_member(object, key);
    if (!node.value)
        return true;
    if (!json_is_integer(node.value))
        return node_unexpected(&node, "a whole number", err);
    json_int_t value = json_integer_value(node.value);
    if (value < 0 || (uint64_t)value < min || (uint64_t)value > max)
        return node_fail(&node, err, "%lld is outside [%llu, %llu]", (long long)value,
                         (unsigned long long)min, (unsigned long long)max);
    *out = (uint64_t)value;
    return true;
}

bool node_read_boolean(const struct json_node *object, const char *key, bool *out, struct err *err)
{
    const struct json_node node = node_member(object, key);
    if (!node.value)
        return true;
    if (!json_is_boolean(node.value))
        return node_unexpected(&node, "true or false", err);
    *out = json_is_true(node.value);
    return true;
}

bool node_read_string(const struct json_node *object, const char *key, const char **out,
                      struct err *err)
{
    const struct json_node node = node_member(object, key);
    if (!node.value)
        return true;
    if (!json_is_string(node.value))
        return node_unexpected(&node, "a string", err);
    *out = json_string_value(node.value);
    return true;
}

bool node_numbers(const struct json_node *array, size_t count, struct range range, double *out,
                  struct err *err)
{
    if (!node_check_array(array, count, count, err))
        return false;
    for (size_t i = 0; i < count; i++) {
        const struct json_node element = node_element(array, i);
        if (!node_number(&element, range, &out[i], err))
            return false;
    }
    return true;
}

bool node_read_pair(const struct json_node *object, const char *key, struct range range,
                    double out[2], struct err *err)
{
    const struct json_node node = node_member(object, key);
    if (!node.value)
        return true;
    if (!node_numbers(&node, 2, range, out, err))
        return false;
    return out[0] <= out[1] ||
           node_fail(&node, err, "%.9g is above %.9g; expected the minimum first", out[0], out[1]);
}

bool node_read_vector(const struct json_node *object, const char *key, struct range range,
                      double out[3], struct err *err)
{
    const struct json_node node = node_member(object, key);
    return !node.value || node_numbers(&node, 3, range, out, err);
}

bool node_read_color(const struct json_node *object, const char *key, struct range range,
                     float out[3], struct err *err)
{
    double color[3] = {out[0], out[1], out[2]};
    if (!node_read_vector(object, key, range, color, err))
        return false;
    for (int i = 0; i < 3; i++)
        out[i] = (float)color[i];
    return true;
}

bool node_choice(const struct json_node *node, const char *const *names, uint32_t *out,
                 struct err *err)
{
    const char *word = json_string_value(node->value);
    if (!word)
        return node_unexpected(node, "a string", err);
    for (uint32_t i = 0; names[i]; i++) {
        if (strcmp(names[i], word) == 0) {
            *out = i;
            return true;
        }
    }
    return node_fail(node, err, "%s is unknown%s", node_describe(node->value).text,
                     suggest(word, name_in_list, names).text);
}

bool node_read_choice(const struct json_node *object, const char *key, const char *const *names,
                      uint32_t *out, struct err *err)
{
    const struct json_node node = node_member(object, key);
    return !node.value || node_choice(&node, names, out, err);
}
