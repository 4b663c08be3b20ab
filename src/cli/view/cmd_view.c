// `lampyris view`: the viewer is a separate program, so that this one needs no window library.
#include "cli/commands.h"

#include "base/process.h"
#include "cli/sibling.h"
#include <errno.h>
#include <limits.h>
#include <string.h>

#define PROGRAM "lampyris-view"
#define IN_BUILD_FOLDER "../viewer/" PROGRAM

// The viewer's command line omits the word "view".
int cmd_view(const struct options *options)
{
    char program[PATH_MAX];
    sibling_find(PROGRAM, IN_BUILD_FOLDER, program, sizeof program);
    char **name = &options->argv[options->command_index];
    memmove(name, name + 1, (size_t)(options->argc - options->command_index) * sizeof *name);
    process_become(program, options->argv);
    struct err err;
    err_set(&err, ERR_SYSTEM,
            "%s: cannot be run: %s; the viewer is only built if GLFW and Dear ImGui are "
            "installed (Debian: libglfw3-dev, libimgui-dev)",
            program, strerror(errno));
    return command_fail(&err);
}
