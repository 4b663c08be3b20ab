// Writes a JSON document as human-readable text. Every number reads back to the same bits, and has
// as few digits as that permits.
#ifndef LAMPYRIS_JSON_JSON_TEXT_H
#define LAMPYRIS_JSON_JSON_TEXT_H

#include "base/err.h"
#include "base/memory_stream.h"
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define JSON_TEXT_DEPTH_MAX 8

// After a failure all functions do nothing; `failed` is set and *err describes the first failure.
struct json_text {
    struct memory_stream stream;
    struct {
        char close;
        bool in_line, has_any;
    } levels[JSON_TEXT_DEPTH_MAX];
    uint32_t depth, indent; // indent: additional levels of indentation of the whole text
    const char *key;        // the last key written, for messages
    bool failed;
    struct err *err;
};

bool json_text_begin(struct json_text *out, uint32_t indent, struct err *err);
// Returns the finished text, which the caller frees; NULL on failure.
char *json_text_end(struct json_text *t);

// Opens an object ('{') or an array ('['). If in_line, the whole is written on one line.
void json_text_open(struct json_text *t, char bracket, bool in_line);
void json_text_close(struct json_text *t);
void json_text_key(struct json_text *t, const char *key); // its value must follow
void json_text_next(struct json_text *t);                 // an element of an array must follow

void json_text_double(struct json_text *t, double value);
void json_text_float(struct json_text *t, float value);
void json_text_uint(struct json_text *t, uint64_t value);
void json_text_bool(struct json_text *t, bool value);
// Fails for text that is not UTF-8, or that contains "${", which would be a reference.
void json_text_string(struct json_text *t, const char *text);
bool json_text_can_hold(const char *text);
void json_text_raw(struct json_text *t, const char *json); // written verbatim

// Finds a number with as few digits as possible whose product with the unit, rounded to single
// precision if is_float, is exactly the value. Returns false if there is none.
bool json_text_factor(double value, double unit, bool is_float, double *out);

#endif
