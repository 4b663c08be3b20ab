// JSON results on stdout.
#ifndef LAMPYRIS_REPORT_JSON_OUT_H
#define LAMPYRIS_REPORT_JSON_OUT_H

#include "base/err.h"
#include "metrics/curve.h"
#include <jansson.h>

// A number; null where it is not finite, for which JSON has no word.
json_t *json_number(double value);
json_t *json_interval(struct interval interval); // {value, ci_low, ci_high}
// A string; bytes that are no valid UTF-8 (file names may have them) become '?'.
json_t *json_words(const char *text);

// The text, to be given to json_release(); or NULL with *err set where memory ran out: while the
// object was put together, from which something may be missing then, or here, where jansson leaves
// out what its buffer cannot take. Drops the reference; so do those below.
char *json_to_text(json_t *object, size_t flags, struct err *err);
// Prints one object and a newline to stdout. NULL, which is what jansson's
// constructors return, means that memory ran out; nothing is printed either where it ran out for a
// part of the object.
bool json_put(json_t *object, struct err *err);
// The same into a file, at one stroke.
bool json_write(json_t *object, const char *path, struct err *err);

#endif
