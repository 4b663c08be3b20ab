// Typed, checked reading of a JSON document. Every error names the file, the path in the document,
// the value and what was expected: "cornell.json: materials.white.base_color[1]: 1.7 is outside [0,
// 1]".
//
// A node is a value together with its path; nodes live on the stack and point at their parents.
// Readers take the object and a key. An absent key leaves the output unchanged. Set defaults
// before, and name required keys in node_check_object.
#ifndef LAMPYRIS_JSON_JSON_NODE_H
#define LAMPYRIS_JSON_JSON_NODE_H

#include "base/err.h"
#include <jansson.h>
#include <stddef.h>
#include <stdint.h>

struct json_node {
    const struct json_node *parent; // NULL: this is the document itself
    const char *key;                // NULL: this is element `index` of the parent array
    size_t index;
    json_t *value; // borrowed from the document; NULL: the parent lacks this key
    const char *file;
};

struct json_node node_root(const char *file, json_t *value);
struct json_node node_member(const struct json_node *object, const char *key);
struct json_node node_element(const struct json_node *array, size_t index);

// Sets ERR_INPUT with the message "FILE: PATH: MESSAGE" and the node's place, and returns false.
// node_prepend() puts FILE and PATH before an existing message.
bool node_fail(const struct json_node *node, struct err *err, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
bool node_prepend(const struct json_node *node, struct err *err);
// Fails with "expected WHAT, not VALUE".
bool node_unexpected(const struct json_node *node, const char *what, struct err *err);

// Show static analysers that the result is always false (see err_false()).
#define node_fail(...) (node_fail(__VA_ARGS__), err_false())
#define node_prepend(...) (node_prepend(__VA_ARGS__), err_false())
#define node_unexpected(...) (node_unexpected(__VA_ARGS__), err_false())

// A short form of a value for messages.
struct node_text {
    char text[64];
};
struct node_text node_describe(const json_t *value);

// Checks that the node is an object with all of `required` and no keys other than these, `optional`
// and "comment". Both lists end with NULL. For an unknown key the error suggests the most similar
// known one.
bool node_check_object(const struct json_node *node, const char *const *required,
                       const char *const *optional, struct err *err);
bool node_check_array(const struct json_node *node, size_t min_count, size_t max_count,
                      struct err *err);
// Checks that exactly one of the two keys is present.
bool node_check_either(const struct json_node *object, const char *a, const char *b,
                       struct err *err);

struct range {
    double min, max;
    bool open; // the range excludes its bounds
};

// Read a value of a type, and check its range. node_number() takes the number itself, the others an
// object and a key.
bool node_number(const struct json_node *node, struct range range, double *out, struct err *err);
bool node_read_number(const struct json_node *object, const char *key, struct range range,
                      double *out, struct err *err);
bool node_read_integer(const struct json_node *object, const char *key, uint64_t min, uint64_t max,
                       uint64_t *out, struct err *err);
bool node_read_boolean(const struct json_node *object, const char *key, bool *out, struct err *err);
// Reads a string, which belongs to the document.
bool node_read_string(const struct json_node *object, const char *key, const char **out,
                      struct err *err);
bool node_read_vector(const struct json_node *object, const char *key, struct range range,
                      double out[3], struct err *err);
bool node_read_color(const struct json_node *object, const char *key, struct range range,
                     float out[3], struct err *err);
// Read the index of a string in `names`, which ends with NULL. node_choice() takes the string
// itself.
bool node_choice(const struct json_node *node, const char *const *names, uint32_t *out,
                 struct err *err);
bool node_read_choice(const struct json_node *object, const char *key, const char *const *names,
                      uint32_t *out, struct err *err);

// Reads an array of exactly `count` numbers.
bool node_numbers(const struct json_node *array, size_t count, struct range range, double *out,
                  struct err *err);

// Reads two numbers, of which the first must not exceed the second.
bool node_read_pair(const struct json_node *object, const char *key, struct range range,
                    double out[2], struct err *err);

// Checks that a name can be used in error messages and overrides: letters, digits, "_" and "-"
// only.
bool node_check_name(const struct json_node *node, const char *name, struct err *err);

// Returns "; did you mean KEY?" if a key of the object is similar to the word, else "; known: A, B,
// C".
struct node_hint {
    char text[160];
};
struct node_hint node_suggest_key(const char *word, const json_t *object);

#endif
