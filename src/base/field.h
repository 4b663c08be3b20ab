// Describes a member of a struct that is read from and written to text: its name, its range and its
// representation in memory. All readers and writers use tables of fields: scene files
// (field_json.h), the command line, metadata of images, checkpoints and the viewer's panel.
#ifndef LAMPYRIS_BASE_FIELD_H
#define LAMPYRIS_BASE_FIELD_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum field_type {
    FIELD_SWITCH, // bool, or one bit of a uint32_t
    FIELD_COUNT,  // uint32_t or uint64_t
    FIELD_CHOICE, // uint32_t, or some bits of one: the index of a word
    FIELD_REAL,   // float or double; or an array of them
};

struct field {
    const char *key; // in scene files
    enum field_type type;
    size_t offset, size;      // place and size of the member, in bytes
    uint32_t count;           // number of elements of an array; 0: the member is no array
    double min, max;          // range of a number
    bool open;                // the bounds themselves are outside
    const char *const *words; // words of a choice, in the order of its values; ended by NULL
    uint32_t mask;            // the adjacent bits that a switch or choice is; 0: the whole member
    // The word that may replace a number, or NULL. It stands for word_value; or, if there is a
    // flag, it sets the uint32_t at this offset to 1, which a number sets to 0.
    const char *word;
    double word_value;
    size_t flag;
    // For angles and lengths: the member is the number times `unit` (0: 1), and the range applies
    // to the number. exact_key, or NULL, takes numbers times exact_unit (0: 1), for values that are
    // no rounded product with the unit.
    double unit, exact_unit;
    const char *exact_key;
};
// For tables: the offset and the size of a member.
#define FIELD_OF(type, member)                                                                     \
    .offset = offsetof(struct type, member), .size = sizeof(((struct type *)NULL)->member)

#define FIELD_TEXT_MAX 40

// Returns the value of a field without elements: a number, 0 or 1 for a switch, the index of a
// word.
double field_get(const struct field *field, const void *object);
// Sets it, and its flag to 0.
void field_set(const struct field *field, void *object, double value);
// Returns whether the word stands in place of the number.
bool field_is_word(const struct field *field, const void *object);
void field_set_word(const struct field *field, void *object);

// Writes the value as text: "on", "sobol", "off", "0.7"; reading a number back gives the same bits.
void field_text(const struct field *field, const void *object, char out[FIELD_TEXT_MAX]);
// Returns whether both are bitwise equal.
bool field_same(const struct field *field, const void *a, const void *b);
bool fields_same(const struct field *fields, size_t count, const void *a, const void *b);
void field_copy(const struct field *field, void *to, const void *from);
// Returns the word of a choice; "unknown" for a value without one.
const char *field_word(const struct field *field, uint32_t value);

#endif
