// lampyris-view: the interactive viewer. Its command line is that of `lampyris view` without the
// word `view`.
#include "base/process.h"
#include "cli/exit_code.h"
#include "cli/program.h"
#include "viewer/run.h"

#include <stdlib.h>
#include <string.h>

int main(int argc, char **argv)
{
    static char name[] = "lampyris", command[] = "view";
    process_begin(&argc, &argv);
    char **arguments = calloc((size_t)argc + 2, sizeof *arguments);
    if (!arguments)
        return EXIT_CODE_DEVICE;
    arguments[0] = name;
    arguments[1] = command;
    if (argc > 1)
        memcpy(&arguments[2], &argv[1], (size_t)(argc - 1) * sizeof *argv);
    int count = argc > 1 ? argc + 1 : 2;
    int code = program_run(count, arguments, viewer_run);
    free(arguments);
    return code;
}
