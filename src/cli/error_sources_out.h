// Reports where the error of a film comes from, for --error-by.
#ifndef LAMPYRIS_CLI_ERROR_SOURCES_OUT_H
#define LAMPYRIS_CLI_ERROR_SOURCES_OUT_H

#include "job/error_sources.h"

#include <jansson.h>

// Print lines of text, or return an object; nothing, or null, without --error-by. `command` is the
// command of the render, to which --pixel and --sample are added to follow a path; NULL if a path
// cannot be followed.
void error_sources_print(const struct error_sources *sources, const char *command);
json_t *error_sources_json(const struct error_sources *sources, const char *command);

#endif
