#include "cli/check/check_command.h"

#include "cli/commands.h"

int check_device_command(const struct options *options)
{
    (void)options;
    struct err err = {0};
    (void)err_set(&err, ERR_USAGE, "expected check SCENE");
    return command_fail(&err);
}
