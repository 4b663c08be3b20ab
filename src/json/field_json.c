#include "json/field_json.h"

#include <stdio.h>

static struct field element_of(const struct field *field, uint32_t index)
{
    struct field element = *field;
    element.size = field->size / field->count;
    element.offset = field->offset + index * element.size;
    element.count = 0;
    return element;
}

static double unit_of(const struct field *field, bool is_exact)
{
    double unit = is_exact ? field->exact_unit : field->unit;
    return unit != 0 ? unit : 1;
}

// --- reading -------------------------------------------------------------------------------------

static bool read_choice(const struct field *field, const struct json_node *node, void *object,
                        struct err *err)
{
    uint32_t value;
    if (!node_choice(node, field->words, &value, err))
        return false;
    field_set(field, object, value);
    return true;
}

static bool read_switch(const struct field *field, const struct json_node *node, void *object,
                        struct err *err)
{
    bool value;
    if (!node_read_boolean(node->parent, node->key, &value, err))
        return false;
    field_set(field, object, value);
    return true;
}

static bool read_count(const struct field *field, const struct json_node *node, void *object,
                       struct err *err)
{
    uint64_t value;
    if (!node_read_integer(node->parent, node->key, (uint64_t)field->min, (uint64_t)field->max,
                           &value, err))
        return false;
    field_set(field, object, (double)value);
    return true;
}

// Reads a number. If is_exact, the node belongs to the exact key, whose unit applies.
static bool read_real(const struct field *field, const struct json_node *node, bool is_exact,
                      void *object, struct err *err)
{
    const double unit = unit_of(field, is_exact), scale = unit_of(field, false) / unit;
    const struct range range = {field->min * scale, field->max * scale, field->open};
    double value;
    if (!node_number(node, range, &value, err))
        return false;
    field_set(field, object, value * unit);
    return true;
}

static bool read_value(const struct field *field, const struct json_node *node, void *object,
                       struct err *err)
{
    if (field->word && json_is_string(node->value)) {
        const char *const only[] = {field->word, NULL};
        uint32_t choice;
        field_set_word(field, object);
        return node_choice(node, only, &choice, err);
    }
    if (field->word && !json_is_number(node->value)) {
        char expected[FIELD_TEXT_MAX];
        snprintf(expected, sizeof expected, "a number or \"%s\"", field->word);
        return node_unexpected(node, expected, err);
    }
    switch (field->type) {
    case FIELD_CHOICE:
        return read_choice(field, node, object, err);
    case FIELD_SWITCH:
        return read_switch(field, node, object, err);
    case FIELD_COUNT:
        return read_count(field, node, object, err);
    case FIELD_REAL:
        break;
    }
    return read_real(field, node, false, object, err);
}

static bool read_elements(const struct field *field, const struct json_node *node, void *object,
                          struct err *err)
{
    if (!node_check_array(node, field->count, field->count, err))
        return false;
    for (uint32_t i = 0; i < field->count; i++) {
        const struct field element = element_of(field, i);
        const struct json_node value = node_element(node, i);
        if (!read_value(&element, &value, object, err))
            return false;
    }
    return true;
}

bool field_read(const struct field *field, const struct json_node *object_node, void *object,
                struct err *err)
{
    const struct json_node node = node_member(object_node, field->key);
    if (field->exact_key) {
        const struct json_node exact = node_member(object_node, field->exact_key);
        if (node.value && exact.value)
            return node_fail(object_node, err, "both \"%s\" and \"%s\" are given; expected one",
                             field->key, field->exact_key);
        if (exact.value)
            return read_real(field, &exact, true, object, err);
    }
    if (!node.value)
        return true;
    return field->count ? read_elements(field, &node, object, err)
                        : read_value(field, &node, object, err);
}

bool fields_read(const struct field *fields, size_t count, const struct json_node *node,
                 void *object, struct err *err)
{
    for (size_t i = 0; i < count; i++)
        if (!field_read(&fields[i], node, object, err))
            return false;
    return true;
}

// --- writing -------------------------------------------------------------------------------------

static void write_real(const struct field *field, double value, struct json_text *text)
{
    if (field->size == sizeof(float))
        json_text_float(text, (float)value);
    else
        json_text_double(text, value);
}

static void write_value(const struct field *field, const void *object, struct json_text *text)
{
    double value = field_get(field, object);
    if (field_is_word(field, object))
        json_text_string(text, field->word);
    else if (field->type == FIELD_SWITCH)
        json_text_bool(text, value != 0);
    else if (field->type == FIELD_CHOICE)
        json_text_string(text, field_word(field, (uint32_t)value));
    else if (field->type == FIELD_COUNT)
        json_text_uint(text, (uint64_t)value);
    else
        write_real(field, value, text);
}

// Writes a number whose product with the unit is exactly the member's value. If there is none,
// writes the exact key, with the value in that key's unit.
static void write_product(const struct field *field, double value, struct json_text *text)
{
    double factor;
    bool is_found = json_text_factor(value, field->unit, field->size == sizeof(float), &factor);
    json_text_key(text, is_found ? field->key : field->exact_key);
    json_text_double(text, is_found ? factor : value / unit_of(field, true));
}

void field_write(const struct field *field, const void *object, struct json_text *text)
{
    if (field->unit != 0 && !field_is_word(field, object)) {
        write_product(field, field_get(field, object), text);
        return;
    }
    json_text_key(text, field->key);
    if (!field->count) {
        write_value(field, object, text);
        return;
    }
    json_text_open(text, '[', true);
    for (uint32_t i = 0; i < field->count; i++) {
        const struct field element = element_of(field, i);
        json_text_next(text);
        write_value(&element, object, text);
    }
    json_text_close(text);
}

void fields_write(const struct field *fields, size_t count, const void *object,
                  struct json_text *text)
{
    for (size_t i = 0; i < count; i++)
        field_write(&fields[i], object, text);
}

void fields_write_changed(const struct field *fields, size_t count, const void *object,
                          const void *former, struct json_text *text)
{
    for (size_t i = 0; i < count; i++)
        if (!field_same(&fields[i], object, former))
            field_write(&fields[i], object, text);
}
