// Reads and writes struct field in scene files.
#ifndef LAMPYRIS_JSON_FIELD_JSON_H
#define LAMPYRIS_JSON_FIELD_JSON_H

#include "base/field.h"
#include "json/json_node.h"
#include "json/json_text.h"

// Reads the field's key from a JSON object. If the object lacks the key, the member stays
// unchanged.
bool field_read(const struct field *field, const struct json_node *node, void *object,
                struct err *err);
bool fields_read(const struct field *fields, size_t count, const struct json_node *node,
                 void *object, struct err *err);
// Writes the key and its value, so that reading gives the same bits.
void field_write(const struct field *field, const void *object, struct json_text *text);
void fields_write(const struct field *fields, size_t count, const void *object,
                  struct json_text *text);
// Writes the fields of `object` that differ from those of `former`.
void fields_write_changed(const struct field *fields, size_t count, const void *object,
                          const void *former, struct json_text *text);

#endif
