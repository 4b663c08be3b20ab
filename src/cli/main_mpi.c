// lampyris-mpi: `lampyris render` as one of the processes that mpirun has started. lampyris
// replaces itself by this program, so that lampyris does not depend on MPI.
#include "base/log.h"
#include "base/process.h"
#include "cli/commands.h"
#include "cli/mpi/ranks.h"
#include "cli/program.h"
#include <stdio.h>

static int run_ranks(const struct options *options)
{
    struct render_ranks ranks = {0};
    struct err err = {0};
    int code;
    if (options->command != &commands[COMMAND_RENDER]) {
        err_set(&err, ERR_USAGE,
                "lampyris-mpi has only the command render; expected \"render\", or the program "
                "lampyris");
        return command_fail(&err);
    }
    if (!ranks_open(&ranks, options, &err))
        code = command_fail(&err);
    else
        code = render_with_ranks(options, &ranks);
    if (code != EXIT_CODE_OK) {
        fflush(stdout);
        ranks_abort(&ranks, code);
    }
    ranks_close(&ranks);
    return code;
}

int main(int argc, char **argv)
{
    process_begin(&argc, &argv);
    return program_run(argc, argv, run_ranks);
}
