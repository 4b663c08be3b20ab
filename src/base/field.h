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
    FIELD_CHOICE, // uint32_t, or some bits of one: an index into `words`
    FIELD_REAL,   // float or double, or an array of either
};

struct field {
    const char *key; // key in scene files
    enum field_type type;
    size_t offset, size;      // place and size of the member, in bytes
    uint32_t count;           // number of elements of an array; 0: not an array
    double min, max;          // range of a number
    bool open;                // the range excludes min and max
    const char *const *words; // words of a choice, in the order of its values; ended by NULL
    uint32_t mask;            // adjacent bits that hold a switch or choice; 0: the whole member
    // A word that users may write in place of a number, or NULL. Without a flag it stands for
    // word_value. With a flag, a uint32_t at an offset in the same struct, the word sets the flag
    // to 1 and a number sets it to 0.
    const char *word;
    double word_value;
    size_t flag;
    // For angles and lengths, users write a number, and the member holds that number times `unit`
    // (0 means 1). The range applies to the number. exact_key, or NULL, is a second key whose
    // number is multiplied by exact_unit (0 means 1), for values that no rounded product with
    // `unit` equals.
    double unit, exact_unit;
    const char *exact_key;
};
// Initialisers for tables: the offset and the size of a member.
#define FIELD_OF(type, member)                                                                     \
    .offset = offsetof(struct type, member), .size = sizeof(((struct type *)NULL)->member)

#define FIELD_TEXT_MAX 40

// Returns the value of a field that is not an array: a number, 0 or 1 for a switch, the index of
// the word for a choice.
double field_get(const struct field *field, const void *object);
// Sets the value, and the field's flag to 0.
void field_set(const struct field *field, void *object, double value);
// Returns whether the value is the field's word instead of a number.
bool field_is_word(const struct field *field, const void *object);
void field_set_word(const struct field *field, void *object);

// Writes the value as text, such as "on", "sobol", "off" or "0.7". Reading a number back gives the
// same bits.
void field_text(const struct field *field, const void *object, char out[FIELD_TEXT_MAX]);
// Returns whether both objects have the same bits in this field.
bool field_same(const struct field *field, const void *a, const void *b);
bool fields_same(const struct field *fields, size_t count, const void *a, const void *b);
void field_copy(const struct field *field, void *to, const void *from);
// Returns the word for a value of a choice; "unknown" if the value has none.
const char *field_word(const struct field *field, uint32_t value);

#endif
