#include "cli/exit_code.h"

#include "base/log.h"
#include "base/signals.h"
#include "report/json_out.h"

int exit_code(enum err_code code)
{
    switch (code) {
    case ERR_NONE:
        return EXIT_CODE_OK;
    case ERR_USAGE:
    case ERR_INPUT:
    case ERR_BUDGET:
        return EXIT_CODE_INPUT;
    case ERR_SYSTEM:
    case ERR_GPU:
    case ERR_BUG:
        return EXIT_CODE_DEVICE;
    case ERR_STOPPED:
        return signal_exit_code();
    case ERR_NO_VULKAN:
        return EXIT_CODE_NO_VULKAN;
    case ERR_OUTPUT:
        return EXIT_CODE_OUTPUT;
    }
    return EXIT_CODE_DEVICE;
}

int command_fail(const struct err *err)
{
    log_message(LOG_ERROR, "%s", err->msg);
    return exit_code(err->code);
}

int command_print(json_t *object)
{
    struct err err = {0};
    return json_put(object, &err) ? EXIT_CODE_OK : command_fail(&err);
}
