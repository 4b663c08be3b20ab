// JSON pointers (RFC 6901) in the document of a scene.
#include "library/library.h"

#include "json/json_node.h"
#include <stdlib.h>
#include <string.h>

enum { STEP_BYTES = 128 };

// Copies the next step of the pointer, with ~1 and ~0 decoded, and moves *pointer past it.
static bool next_step(const char **pointer, char step[STEP_BYTES], struct err *err)
{
    const char *at = *pointer;
    size_t length = 0;
    if (*at++ != '/')
        return err_set(err, ERR_USAGE,
                       "the JSON pointer \"%s\" does not begin with \"/\"; expected one such as "
                       "\"/materials/white/base_color\"",
                       *pointer);
    for (; *at && *at != '/' && length + 1 < STEP_BYTES; at++) {
        char c = *at;
        if (c == '~' && at[1] != '0' && at[1] != '1')
            return err_set(
                err, ERR_USAGE,
                "the JSON pointer \"%s\": expected \"~0\" for \"~\" and \"~1\" for \"/\"",
                *pointer);
        if (c == '~')
            c = *++at == '0' ? '~' : '/';
        step[length++] = c;
    }
    step[length] = '\0';
    if (*at && *at != '/')
        return err_set(err, ERR_USAGE, "the JSON pointer \"%s\": a step has more than %d bytes",
                       *pointer, STEP_BYTES - 1);
    *pointer = at;
    return true;
}

// Parses an index into an array: a decimal number without leading zeros, or "-" for the place after
// the last element.
static bool parse_index(const json_t *array, const char *step, size_t *index)
{
    bool is_number = *step && step[strspn(step, "0123456789")] == '\0' && strlen(step) < 10 &&
                     (step[0] != '0' || step[1] == '\0');
    *index = strcmp(step, "-") == 0 ? json_array_size(array)
             : is_number            ? strtoul(step, NULL, 10)
                                    : SIZE_MAX;
    return *index != SIZE_MAX;
}

static bool fail_missing(const json_t *from, const char *step, struct err *err)
{
    if (json_is_object(from))
        return err_set(err, ERR_INPUT, "there is no \"%s\" in the document%s", step,
                       node_suggest_key(step, from).text);
    if (json_is_array(from))
        return err_set(err, ERR_INPUT, "there is no element \"%s\" in an array of %zu", step,
                       json_array_size(from));
    return err_set(err, ERR_INPUT, "there is no \"%s\" inside %s", step, node_describe(from).text);
}

static json_t *follow(const json_t *from, const char *step)
{
    size_t index;
    if (json_is_object(from))
        return json_object_get(from, step);
    return json_is_array(from) && parse_index(from, step, &index) ? json_array_get(from, index)
                                                                  : NULL;
}

static bool locate(bool ok, const char *pointer, struct err *err)
{
    if (ok || !err)
        return ok;
    err_prepend(err, "%s", pointer);
    err_locate(err, "document", pointer);
    return false;
}

static json_t *find(json_t *document, const char *pointer, struct err *err)
{
    char step[STEP_BYTES];
    json_t *at = document;
    while (*pointer) {
        const json_t *from = at;
        if (!next_step(&pointer, step, err))
            return NULL;
        if (!(at = follow(from, step))) {
            fail_missing(from, step, err);
            return NULL;
        }
    }
    return at;
}

json_t *pointer_find(json_t *document, const char *pointer, struct err *err)
{
    json_t *found = find(document, pointer, err);
    locate(found != NULL, pointer, err);
    return found;
}

// Returns the object or array that contains the value which the pointer names; `step` receives the
// last step. If `makes` is not NULL, missing objects are made and *makes is set.
static json_t *find_parent(json_t *document, const char *pointer, bool *makes,
                           char step[STEP_BYTES], struct err *err)
{
    json_t *at = document;
    bool may_make = makes != NULL;
    while (next_step(&pointer, step, err)) {
        if (!*pointer)
            return at;
        json_t *next = follow(at, step);
        if (!next && may_make && json_is_object(at)) {
            next = json_object();
            if (!next || json_object_set_new(at, step, next) != 0) {
                err_memory(err, "an object", strlen(step));
                return NULL;
            }
            *makes = true;
        }
        if (!next) {
            fail_missing(at, step, err);
            return NULL;
        }
        at = next;
    }
    return NULL;
}

// Stores a value in an object or array. Takes over the reference to `value`.
static bool put(json_t *parent, const char *step, json_t *value, bool *is_made, struct err *err)
{
    size_t index;
    int status = 0;
    if (json_is_object(parent)) {
        status = json_object_set_new(parent, step, value);
    } else if (json_is_array(parent) && parse_index(parent, step, &index) &&
               index <= json_array_size(parent)) {
        *is_made |= index == json_array_size(parent);
        status = index == json_array_size(parent) ? json_array_append_new(parent, value)
                                                  : json_array_set_new(parent, index, value);
    } else {
        json_decref(value);
        return fail_missing(parent, step, err);
    }
    return status == 0 || err_memory(err, "a value of the document", strlen(step));
}

bool pointer_set(json_t **document, const char *pointer, json_t *value, bool *is_made,
                 struct err *err)
{
    char step[STEP_BYTES];
    *is_made = false;
    if (!*pointer) {
        json_decref(*document);
        *document = value;
        *is_made = true;
        return true;
    }
    json_t *parent = find_parent(*document, pointer, is_made, step, err);
    if (parent)
        return locate(put(parent, step, value, is_made, err), pointer, err);
    json_decref(value);
    return locate(false, pointer, err);
}

bool pointer_remove(json_t *document, const char *pointer, struct err *err)
{
    char step[STEP_BYTES];
    size_t index;
    json_t *parent = find_parent(document, pointer, NULL, step, err);
    if (parent && !follow(parent, step))
        fail_missing(parent, step, err);
    else if (parent && json_is_object(parent))
        return json_object_del(parent, step) == 0;
    else if (parent && parse_index(parent, step, &index))
        return json_array_remove(parent, index) == 0;
    return locate(false, pointer, err);
}

char *pointer_key(const char *pointer, struct arena *arena)
{
    char step[STEP_BYTES], *key = arena_strdup(arena, "");
    while (*pointer && key) {
        if (!next_step(&pointer, step, NULL) || !*step || strpbrk(step, ".[]"))
            return NULL;
        key = arena_printf(arena, "%s%s%s", key, *key ? "." : "", step);
    }
    return key && *key ? key : NULL;
}
