#include "base/field.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const void *member(const struct field *field, const void *object)
{
    return (const char *)object + field->offset;
}

static uint32_t mask(const struct field *field)
{
    return field->mask ? field->mask : UINT32_MAX;
}

static int shift(const struct field *field)
{
    return __builtin_ctz(mask(field));
}

// Returns the uint32_t at an offset, which holds a switch, a count, a choice or a flag.
static uint32_t get_word(const void *object, size_t offset)
{
    uint32_t word;
    memcpy(&word, (const char *)object + offset, sizeof word);
    return word;
}

static void set_word(void *object, size_t offset, uint32_t word)
{
    memcpy((char *)object + offset, &word, sizeof word);
}

double field_get(const struct field *field, const void *object)
{
    const void *from = member(field, object);
    uint64_t wide;
    double real;
    float narrow;
    switch (field->type) {
    case FIELD_SWITCH:
        if (field->size == sizeof(bool))
            return *(const bool *)from;
        return (get_word(object, field->offset) & mask(field)) != 0;
    case FIELD_COUNT:
        if (field->size != sizeof wide)
            break;
        memcpy(&wide, from, sizeof wide);
        return (double)wide;
    case FIELD_REAL:
        memcpy(&narrow, from, sizeof narrow);
        if (field->size == sizeof narrow)
            return (double)narrow;
        memcpy(&real, from, sizeof real);
        return real;
    case FIELD_CHOICE:
        break;
    }
    return (get_word(object, field->offset) & mask(field)) >> shift(field);
}

void field_set(const struct field *field, void *object, double value)
{
    char *to = (char *)object + field->offset;
    float narrow = (float)value;
    if (field->flag)
        set_word(object, field->flag, 0);
    if (field->type == FIELD_REAL)
        memcpy(to, field->size == sizeof narrow ? (const void *)&narrow : &value, field->size);
    else if (field->size == sizeof(bool))
        *(bool *)to = value != 0;
    else if (field->size == sizeof(uint64_t))
        memcpy(to, &(uint64_t){(uint64_t)value}, sizeof(uint64_t));
    else
        set_word(object, field->offset,
                 (get_word(object, field->offset) & ~mask(field)) | (uint32_t)value
                                                                        << shift(field));
}

bool field_is_word(const struct field *field, const void *object)
{
    if (!field->word)
        return false;
    return field->flag ? get_word(object, field->flag) != 0
                       : field_get(field, object) == field->word_value;
}

void field_set_word(const struct field *field, void *object)
{
    field_set(field, object, field->word_value);
    if (field->flag)
        set_word(object, field->flag, 1);
}

static void number_text(const struct field *field, double value, char out[FIELD_TEXT_MAX])
{
    bool is_narrow = field->size == sizeof(float);
    for (int digits = 1; digits <= 17; digits++) {
        snprintf(out, FIELD_TEXT_MAX, "%.*g", digits, value);
        double again = strtod(out, NULL);
        if (is_narrow ? (float)again == (float)value : again == value)
            return;
    }
}

const char *field_word(const struct field *field, uint32_t value)
{
    for (uint32_t i = 0; field->words[i]; i++)
        if (i == value)
            return field->words[i];
    return "unknown";
}

void field_text(const struct field *field, const void *object, char out[FIELD_TEXT_MAX])
{
    double value = field_get(field, object);
    if (field_is_word(field, object))
        snprintf(out, FIELD_TEXT_MAX, "%s", field->word);
    else if (field->type == FIELD_SWITCH)
        snprintf(out, FIELD_TEXT_MAX, "%s", value != 0 ? "on" : "off");
    else if (field->type == FIELD_CHOICE)
        snprintf(out, FIELD_TEXT_MAX, "%s", field_word(field, (uint32_t)value));
    else if (field->type == FIELD_COUNT)
        snprintf(out, FIELD_TEXT_MAX, "%.0f", value);
    else
        number_text(field, value, out);
}

// Compares by memcmp, not ==, so that 0.0 and -0.0 differ and a NaN equals itself.
bool field_same(const struct field *field, const void *a, const void *b)
{
    if (field->mask)
        return field_get(field, a) == field_get(field, b);
    if (field->flag && (field_is_word(field, a) || field_is_word(field, b)))
        return field_is_word(field, a) == field_is_word(field, b);
    return memcmp(member(field, a), member(field, b), field->size) == 0;
}

bool fields_same(const struct field *fields, size_t count, const void *a, const void *b)
{
    for (size_t i = 0; i < count; i++)
        if (!field_same(&fields[i], a, b))
            return false;
    return true;
}

void field_copy(const struct field *field, void *to, const void *from)
{
    if (field->mask) {
        field_set(field, to, field_get(field, from));
        return;
    }
    memcpy((char *)to + field->offset, member(field, from), field->size);
    if (field->flag)
        set_word(to, field->flag, get_word(from, field->flag));
}
