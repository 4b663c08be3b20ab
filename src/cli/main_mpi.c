// lampyris-mpi: `lampyris render` as one of the processes that mpirun has started. lampyris
// replaces itself by this program, so that lampyris does not depend on MPI.
#include "base/clock.h"
#include "base/log.h"
#include "base/process.h"
#include "cli/commands.h"
#include "cli/mpi/ranks.h"
#include "cli/program.h"
#include "cli/render/render_ranks.h"
#include <stdio.h>

// Time for the first process to print a message before another one ends, because some versions of
// mpirun then end all processes.
#define MESSAGE_SECONDS 5.0

// If the processes were started by the mpirun of another MPI, each of them takes itself for rank 0.
// One message is enough.
static int leave_message_to_first(void)
{
    clock_sleep(MESSAGE_SECONDS);
    return EXIT_CODE_INPUT;
}

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
    if (ranks_open(&ranks, options, &err))
        code = render_with_ranks(options, &ranks);
    else if (err.code == ERR_USAGE && render_ranks_launched_as() > 0)
        return leave_message_to_first();
    else
        code = command_fail(&err);
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
