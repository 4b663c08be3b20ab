// Changes the document before it is read: overrides (-D KEY=VALUE) and references ("${NAME}").
#include "scene/json/load_json.h"

#include "json/json_parse.h"
#include <stdlib.h>
#include <string.h>

// --- overrides -----------------------------------------------------------------------------------

#define MAX_STEP 127

// Copies the next step of a key such as "shapes.0.material" or "shapes[0].material" to `step` and
// advances *key. Returns false if the key is malformed.
static bool next_step(const char **key, char step[MAX_STEP + 1])
{
    size_t length = strcspn(*key, ".[]");
    if (length == 0 || length > MAX_STEP)
        return false;
    memcpy(step, *key, length);
    step[length] = '\0';
    const char *at = *key + length;
    at += *at == ']';
    if (*at != '\0' && *at != '.' && *at != '[')
        return false;
    *key = *at ? at + 1 : at;
    return *at == '\0' || **key != '\0';
}

static bool parse_index(const char *step, size_t *index)
{
    if (step[strspn(step, "0123456789")] != '\0' || strlen(step) > 9)
        return false;
    *index = strtoul(step, NULL, 10);
    return true;
}

// Returns the value that `step` selects in `from`; NULL with *err set if there is none.
static json_t *follow(json_t *from, const char *step, const char *key, struct err *err)
{
    size_t index;
    json_t *to = NULL;
    if (json_is_object(from)) {
        to = json_object_get(from, step);
        if (!to)
            err_set(err, ERR_USAGE, "-D %s: there is no \"%s\" in the document%s", key, step,
                    node_suggest_key(step, from).text);
    } else if (json_is_array(from)) {
        to = parse_index(step, &index) ? json_array_get(from, index) : NULL;
        if (!to)
            err_set(err, ERR_USAGE, "-D %s: \"%s\" is not an index into an array of %zu", key, step,
                    json_array_size(from));
    } else {
        err_set(err, ERR_USAGE, "-D %s: there is no \"%s\" inside %s", key, step,
                node_describe(from).text);
    }
    return to;
}

// Stores the value at the last step: in an existing element, an existing key, or a new key.
static bool put(json_t *parent, const char *step, json_t *value, const char *key, struct err *err)
{
    size_t index;
    int status;
    if (json_is_object(parent)) {
        status = json_object_set(parent, step, value);
    } else {
        if (!follow(parent, step, key, err) || !parse_index(step, &index))
            return false;
        status = json_array_set(parent, index, value);
    }
    return status == 0 || err_memory(err, "an override", strlen(step));
}

static bool put_at_path(json_t *root, const char *key, json_t *value, struct err *err)
{
    char step[MAX_STEP + 1];
    const char *rest = key;
    for (json_t *parent = root; parent; parent = follow(parent, step, key, err)) {
        if (!next_step(&rest, step))
            return err_set(err, ERR_USAGE,
                           "-D %s: expected the name of a definition or a path such as "
                           "materials.white.base_color[1]",
                           key);
        if (*rest == '\0')
            return put(parent, step, value, key, err);
    }
    return false;
}

static bool is_document_key(const char *key)
{
    for (const char *const *known = load_json_document_keys; *known; known++)
        if (strcmp(*known, key) == 0)
            return true;
    return false;
}

static bool apply_override(json_t *root, const char *key, json_t *value, struct err *err)
{
    json_t *definitions = json_object_get(root, "define");
    if (json_object_get(definitions, key))
        return put(definitions, key, value, key, err);
    if (!strpbrk(key, ".[]") && !is_document_key(key))
        return err_set(err, ERR_USAGE, "-D %s: the scene file defines no such name%s", key,
                       node_suggest_key(key, definitions).text);
    return put_at_path(root, key, value, err);
}

json_t *load_json_override_value(const char *text, struct err *err)
{
    const struct file_bytes bytes = {(const uint8_t *)text, strlen(text)};
    struct err problem = {0};
    json_t *value =
        json_parse("the value", &bytes, JSON_DECODE_ANY | JSON_REJECT_DUPLICATES, &problem);
    if (value || problem.code != ERR_INPUT) {
        if (!value && err)
            *err = problem;
        return value;
    }
    value = json_string(text);
    if (!value && json_lost_memory())
        err_memory(err, "the value", bytes.size);
    else if (!value)
        err_set(err, ERR_USAGE, "the value is not UTF-8 text");
    return value;
}

bool load_json_apply_overrides(const struct json_node *document,
                               const struct scene_load_params *params, json_t *trusted,
                               struct err *err)
{
    for (uint32_t i = 0; i < params->override_count; i++) {
        const struct scene_override *override = &params->overrides[i];
        json_t *value = load_json_override_value(override->value, err);
        if (!value)
            return err_prepend(err, "-D %s", override->key);
        if (json_array_append_new(trusted, value) != 0)
            return err_memory(err, "an override", strlen(override->value));
        if (!apply_override(document->value, override->key, value, err))
            return err_prepend(err, "%s", document->file);
    }
    return true;
}

// --- references ----------------------------------------------------------------------------------

// Returns whether the text is "${NAME}", and copies NAME to `name`. *malformed becomes true if the
// text contains "${" in another form.
static bool is_reference(const char *text, char name[MAX_STEP + 1], bool *malformed)
{
    size_t length = strlen(text);
    const char *begin = strstr(text, "${");
    *malformed = false;
    if (!begin)
        return false;
    *malformed = begin != text || length < 4 || length > MAX_STEP || text[length - 1] != '}' ||
                 strcspn(text + 2, "${}") != length - 3;
    if (*malformed)
        return false;
    memcpy(name, text + 2, length - 3);
    name[length - 3] = '\0';
    return true;
}

static bool resolve(const struct json_node *node, json_t *definitions, struct err *err);

// Replaces the string by its definition, which is shared and not copied, so that a path in it stays
// trusted if the user gave it.
static bool resolve_string(const struct json_node *node, json_t *definitions, struct err *err)
{
    char name[MAX_STEP + 1];
    bool malformed;
    if (!is_reference(json_string_value(node->value), name, &malformed))
        return !malformed ||
               node_fail(node, err, "a reference must be the whole string: \"${NAME}\"");
    json_t *definition = json_object_get(definitions, name);
    if (!definition)
        return node_fail(node, err, "${%s} is not defined%s", name,
                         node_suggest_key(name, definitions).text);
    json_t *parent = node->parent->value;
    int status = node->key ? json_object_set(parent, node->key, definition)
                           : json_array_set(parent, node->index, definition);
    return status == 0 || err_memory(err, "a reference", strlen(name));
}

static bool resolve_object(const struct json_node *object, json_t *definitions, struct err *err)
{
    const char *key;
    json_t *value;
    // Replacing the value of an existing key does not disturb the iteration. The overrides of a
    // base are skipped, because references in them refer to the base's definitions.
    bool is_base = object->parent && !object->parent->parent && object->key &&
                   strcmp(object->key, "base") == 0;
    json_object_foreach(object->value, key, value)
    {
        if (strcmp(key, "comment") == 0 || (is_base && strcmp(key, "overrides") == 0))
            continue;
        const struct json_node member = node_member(object, key);
        if (!resolve(&member, definitions, err))
            return false;
    }
    return true;
}

// Replaces every reference at and below the node. The recursion is as deep as the document, which
// jansson limits to 2048 levels.
static bool resolve(const struct json_node *node, json_t *definitions, struct err *err)
{
    if (json_is_string(node->value))
        return resolve_string(node, definitions, err);
    if (json_is_object(node->value))
        return resolve_object(node, definitions, err);
    for (size_t i = 0; i < json_array_size(node->value); i++) {
        const struct json_node element = node_element(node, i);
        if (!resolve(&element, definitions, err))
            return false;
    }
    return true;
}

static bool has_reference(const json_t *value)
{
    const char *text = json_string_value(value), *key;
    json_t *child;
    size_t i;
    if (text)
        return strstr(text, "${") != NULL;
    json_object_foreach((json_t *)value, key,
                        child) if (strcmp(key, "comment") != 0 && has_reference(child)) return true;
    json_array_foreach(value, i, child) if (has_reference(child)) return true;
    return false;
}

static bool check_definitions(const struct json_node *definitions, struct err *err)
{
    if (!json_is_object(definitions->value))
        return node_unexpected(definitions, "an object", err);
    const char *name;
    json_t *value;
    json_object_foreach(definitions->value, name, value)
    {
        if (strcmp(name, "comment") == 0)
            continue;
        const struct json_node definition = node_member(definitions, name);
        if (!node_check_name(&definition, name, err))
            return false;
        if (json_is_null(value))
            return node_fail(&definition, err, "has no default; give it with -D %s=VALUE", name);
        if (has_reference(value))
            return node_fail(&definition, err, "a definition cannot refer to another");
    }
    return true;
}

bool load_json_resolve_references(const struct json_node *document, struct err *err)
{
    const struct json_node definitions = node_member(document, "define");
    if (definitions.value && !check_definitions(&definitions, err))
        return false;
    return resolve(document, definitions.value, err);
}
