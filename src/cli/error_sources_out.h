// Reports the sources of a film's error, for --error-by.
#ifndef LAMPYRIS_CLI_ERROR_SOURCES_OUT_H
#define LAMPYRIS_CLI_ERROR_SOURCES_OUT_H

#include "job/error_sources.h"

#include <jansson.h>

// These functions print text or return a JSON object; without --error-by they print nothing or
// return null. `command` is the command line of the render, to which --pixel and --sample are added
// to follow a path; NULL if paths cannot be followed.
void error_sources_print(const struct error_sources *sources, const char *command);
json_t *error_sources_json(const struct error_sources *sources, const char *command);

#endif
