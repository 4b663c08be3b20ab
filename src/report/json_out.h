// Writes JSON results to stdout and to files.
#ifndef LAMPYRIS_REPORT_JSON_OUT_H
#define LAMPYRIS_REPORT_JSON_OUT_H

#include "base/err.h"
#include "metrics/curve.h"
#include <jansson.h>

// Makes a number, or null if the value is not finite, which JSON cannot represent.
json_t *json_number(double value);
json_t *json_interval(struct interval interval); // {value, ci_low, ci_high}
// Makes a string. If the text is not valid UTF-8, as file names may be, all its bytes beyond ASCII
// are replaced by '?'.
json_t *json_words(const char *text);
json_t *json_word_list(const char *const *words, uint32_t count); // an array of such strings

// Returns the object as text, which is freed with json_release(). Returns NULL and sets *err if
// memory ran out while the object was made or while it was converted. Releases the reference to the
// object, as the functions below do.
char *json_to_text(json_t *object, size_t flags, struct err *err);
// Prints an object and a newline to stdout. An object that is NULL, which jansson's constructors
// return when memory runs out, is an error; nothing is printed if memory ran out for any part of
// the object.
bool json_put(json_t *object, struct err *err);
// Prints the object on one line, as a record of JSON Lines. Errors are handled likewise.
bool json_put_line(json_t *object, struct err *err);
// Writes an object to a file atomically.
bool json_write(json_t *object, const char *path, struct err *err);

#endif
