// lampyris: parses the command line and runs one command.
#include "cli/program.h"

#include "base/process.h"
#include <stddef.h>

int main(int argc, char **argv)
{
    process_begin(&argc, &argv);
    return program_run(argc, argv, NULL);
}
