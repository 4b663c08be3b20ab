// Writes JSON results to stdout.
#ifndef LAMPYRIS_REPORT_JSON_OUT_H
#define LAMPYRIS_REPORT_JSON_OUT_H

#include "base/err.h"
#include "metrics/curve.h"
#include <jansson.h>

// Makes a number; null if it is not finite, which JSON cannot represent.
json_t *json_number(double value);
json_t *json_interval(struct interval interval); // {value, ci_low, ci_high}
// Makes a string; bytes that are not valid UTF-8 (possible in file names) become '?'.
json_t *json_words(const char *text);

// Returns the text, to be freed with json_release(); or NULL with *err set if memory ran out: while
// the object was made, which may then be incomplete, or here, where jansson omits what its buffer
// cannot hold. Drops the reference, and so do the functions below.
char *json_to_text(json_t *object, size_t flags, struct err *err);
// Prints one object and a newline to stdout. NULL, which is what jansson's
// constructors return, means that memory ran out; nothing is printed either where it ran out for a
// part of the object.
bool json_put(json_t *object, struct err *err);
// Writes it to a file atomically.
bool json_write(json_t *object, const char *path, struct err *err);

#endif
