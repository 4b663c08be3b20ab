#include "base/err.h"

#include "base/memory.h"
#include "base/printable.h"
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

// The macros of err.h would replace the names in the definitions below.
#undef err_set
#undef err_prepend
#undef err_memory

// Formats a text and cuts it off after size - 1 bytes. If formatting fails, the text is "".
static void print(char *text, size_t size, const char *format, va_list arguments)
    __attribute__((format(printf, 3, 0)));

static void print(char *text, size_t size, const char *format, va_list arguments)
{
    if (vsnprintf(text, size, format, arguments) < 0)
        text[0] = '\0';
}

bool err_set(struct err *err, enum err_code code, const char *format, ...)
{
    if (!err)
        return false;
    char msg[sizeof err->msg];
    va_list arguments;
    va_start(arguments, format);
    print(msg, sizeof msg, format, arguments);
    va_end(arguments);
    printable_mask(msg);
    err->code = code;
    err->is_missing = false;
    err->file[0] = err->place[0] = '\0';
    memcpy(err->msg, msg, sizeof msg);
    return false;
}

bool err_prepend(struct err *err, const char *format, ...)
{
    if (!err)
        return false;
    char context[sizeof err->msg];
    va_list arguments;
    va_start(arguments, format);
    print(context, sizeof context, format, arguments);
    va_end(arguments);
    const struct err former = *err;
    err_set(err, err->code, "%s: %s", context, err->msg);
    err->is_missing = former.is_missing;
    err_locate(err, former.file, former.place);
    return false;
}

void err_locate(struct err *err, const char *file, const char *place)
{
    if (!err || err->file[0] || strlen(file) >= sizeof err->file)
        return;
    strcpy(err->file, file);
    if (strlen(place) < sizeof err->place)
        strcpy(err->place, place);
}

bool err_memory(struct err *err, const char *what, unsigned long long bytes)
{
    uint64_t left, refused = memory_refused(&left);
    if (refused == 0)
        return err_set(err, ERR_SYSTEM, "out of memory (%s for %s)", memory_print(bytes).text,
                       what);
    return err_set(err, ERR_BUDGET,
                   "out of memory for %s: %s are needed, but %s are left of the budget of %s; "
                   "expected a smaller scene or picture, or a larger --memory",
                   what, memory_print(bytes > refused ? bytes : refused).text,
                   memory_print(left).text, memory_print(memory_budget()).text);
}
