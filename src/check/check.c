#include "check/check.h"

#include "base/clock.h"
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

const char *const check_outcome_names[] = {
    [CHECK_NOT_RUN] = "not run", [CHECK_PASSED] = "pass", [CHECK_FAILED] = "FAIL"};

bool check_run(const struct check *check, const struct check_case *this_case,
               struct check_result *result, struct err *err)
{
    uint64_t start = clock_ns();
    *result = (struct check_result){0};
    *err = (struct err){0};
    uint32_t messages = check->gpu->validation_messages;
    bool ok = this_case->run(check, this_case, result, err);
    // The renders of a case that was stopped may be incomplete, so its outcome is not valid.
    if (progress_should_stop(check->progress))
        ok = err_set(err, ERR_STOPPED, "stopped");
    if (!ok && err->code != ERR_STOPPED) {
        result->is_lost = check->gpu->lost;
        result->outcome = result->is_lost ? CHECK_NOT_RUN : CHECK_FAILED;
        snprintf(result->why, sizeof result->why, "%s", err->msg);
    }
    uint32_t told = check->gpu->validation_messages - messages;
    if (told > 0) {
        result->outcome = CHECK_FAILED;
        snprintf(result->why, sizeof result->why,
                 "the validation layers reported %u messages; expected none", told);
    }
    result->seconds = clock_seconds_since(start);
    return ok || err->code != ERR_STOPPED;
}

bool check_seen(struct check_result *result, bool passed, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(result->seen, sizeof result->seen, format, arguments);
    va_end(arguments);
    result->outcome = passed ? CHECK_PASSED : CHECK_FAILED;
    return true;
}

bool check_not_run(struct check_result *result, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(result->why, sizeof result->why, format, arguments);
    va_end(arguments);
    result->outcome = CHECK_NOT_RUN;
    return true;
}

bool check_keep_picture(const struct check *check, struct renderer *renderer,
                        struct check_result *result, struct err *err)
{
    struct film_image film;
    if (!check->arena)
        return true;
    if (!renderer_read(renderer, check->arena, &film, err))
        return false;
    result->picture = (struct check_picture){film.width, film.height, film.mean};
    return true;
}
