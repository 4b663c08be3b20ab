// A member of a struct that people read and write: what it is called, what it may be, and how it
// stands in memory. Tables of fields serve every reader and writer alike: scene files
// (field_json.h), the command line, pictures' metadata, checkpoints and the viewer's panel.
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
    size_t offset, size;      // of the member, in bytes
    uint32_t count;           // of an array's elements; 0: the member is no array
    double min, max;          // of a number
    bool open;                // the bounds themselves are outside
    const char *const *words; // of a choice, in the order of its values; ended by NULL
    uint32_t mask;            // the adjacent bits that a switch or choice is; 0: the whole member
    // The word that may stand in place of a number, or NULL. It means word_value; or, where there
    // is a flag, that the uint32_t at this offset is 1, which is 0 beside a number.
    const char *word;
    double word_value;
    size_t flag;
    // Angles and lengths: the member is the number times `unit` (0: 1), and the range is the
    // number's. exact_key takes numbers times exact_unit (0: 1), for values that no product with
    // the unit is; or NULL.
    double unit, exact_unit;
    const char *exact_key;
};
// For tables: the place of a member.
#define FIELD_OF(type, member)                                                                     \
    .offset = offsetof(struct type, member), .size = sizeof(((struct type *)NULL)->member)

#define FIELD_TEXT_MAX 40

// The value of a field without elements: a number, 0 or 1 of a switch, the index of a word.
double field_get(const struct field *field, const void *object);
// Sets it, and its flag to 0.
void field_set(const struct field *field, void *object, double value);
// Whether the word stands in the number's place.
bool field_is_word(const struct field *field, const void *object);
void field_set_word(const struct field *field, void *object);

// The value as people write it: "on", "sobol", "off", "0.7"; a number reads back to the same bits.
void field_text(const struct field *field, const void *object, char out[FIELD_TEXT_MAX]);
// Whether both are the same to the bit.
bool field_same(const struct field *field, const void *a, const void *b);
bool fields_same(const struct field *fields, size_t count, const void *a, const void *b);
void field_copy(const struct field *field, void *to, const void *from);
// The word of a choice; "unknown" of a value that has none.
const char *field_word(const struct field *field, uint32_t value);

#endif
