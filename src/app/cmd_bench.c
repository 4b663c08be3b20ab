#include "commands.h"

#include "bench.h"

int cmd_bench(const struct options *options)
{
    struct err err = {0};
    err_set(&err, ERR_BUG, "%s: nothing is measured yet", options->arguments[0]);
    return command_fail(&err);
}
