// Reads and writes fields in scene files.
#ifndef LAMPYRIS_JSON_FIELD_JSON_H
#define LAMPYRIS_JSON_FIELD_JSON_H

#include "base/field.h"
#include "json/json_node.h"
#include "json/json_text.h"

// Reads the field's key from the object in a file; without it the member stays as it is.
bool field_read(const struct field *field, const struct json_node *node, void *object,
                struct err *err);
bool fields_read(const struct field *fields, size_t count, const struct json_node *node,
                 void *object, struct err *err);
// Writes the key and a value that reads back to the same bits.
void field_write(const struct field *field, const void *object, struct json_text *text);
void fields_write(const struct field *fields, size_t count, const void *object,
                  struct json_text *text);
// Writes the fields that differ from their former values.
void fields_write_changed(const struct field *fields, size_t count, const void *object,
                          const void *former, struct json_text *text);

#endif
