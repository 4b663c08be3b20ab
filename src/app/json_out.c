#include "json_out.h"

#include "commands.h"
#include "file.h"
#include "log.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

json_t *json_number(double value)
{
    return isfinite(value) ? json_real(value) : json_null();
}

json_t *json_interval(struct interval interval)
{
    return json_pack("{s:o, s:o, s:o}", "value", json_number(interval.value), "ci_low",
                     json_number(interval.low), "ci_high", json_number(interval.high));
}

json_t *json_words(const char *text)
{
    json_t *string = json_string(text);
    if (string)
        return string;
    char *ascii = strdup(text);
    for (char *c = ascii; c && *c; c++)
        if ((unsigned char)*c >= 0x80)
            *c = '?';
    string = ascii ? json_string(ascii) : NULL;
    free(ascii);
    return string;
}

int json_print(json_t *object)
{
    if (!object) {
        struct err err = {0};
        err_set(&err, ERR_SYSTEM, "out of memory for the JSON result");
        return command_fail(&err);
    }
    // Nine digits are enough for floats, and times are not known better.
    json_dumpf(object, stdout, JSON_INDENT(2) | JSON_REAL_PRECISION(9));
    putchar('\n'); // main notices when stdout cannot be written
    json_decref(object);
    return EXIT_CODE_OK;
}

bool json_write(json_t *object, const char *path, struct err *err)
{
    char *text = object ? json_dumps(object, JSON_INDENT(1) | JSON_REAL_PRECISION(9)) : NULL;
    json_decref(object);
    bool ok = text ? file_write_atomic(path, text, strlen(text), err) : err_memory(err, path, 0);
    free(text);
    return ok;
}
