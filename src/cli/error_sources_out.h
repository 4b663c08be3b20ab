// Says where the error of a film comes from, as --error-by asks.
#ifndef LAMPYRIS_CLI_ERROR_SOURCES_OUT_H
#define LAMPYRIS_CLI_ERROR_SOURCES_OUT_H

#include "job/error_sources.h"

#include <jansson.h>

// Lines of text, or null, where nobody asked. `command`: the render's, to which --pixel and
// --sample are added to follow a path; NULL where that cannot be done.
void error_sources_print(const struct error_sources *sources, const char *command);
json_t *error_sources_json(const struct error_sources *sources, const char *command);

#endif
