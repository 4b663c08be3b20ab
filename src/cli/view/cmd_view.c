// `lampyris view`: the viewer is a separate program, so that this one needs no window library.
#include "cli/commands.h"

#include "base/file.h"
#include "base/file_system.h"
#include "base/process.h"
#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <string.h>

#define PROGRAM "lampyris-view"
#define IN_BUILD_FOLDER "../viewer/" PROGRAM

// Finds the viewer: next to this program, as installed; else in the build folder; else by the
// system's search path.
static void find_program(char *out, size_t size)
{
    static const char *const places[] = {PROGRAM, IN_BUILD_FOLDER};
    char own[PATH_MAX];
    const bool is_known = process_own_path(own, sizeof own);
    for (size_t i = 0; is_known && i < sizeof places / sizeof *places; i++) {
        int folder = (int)(path_name(own) - own);
        if (snprintf(out, size, "%.*s%s", folder, own, places[i]) < (int)size &&
            file_is_executable(out))
            return;
    }
    snprintf(out, size, "%s", PROGRAM);
}

// The viewer's command line omits the word "view".
int cmd_view(const struct options *options)
{
    char program[PATH_MAX];
    find_program(program, sizeof program);
    char **argv = options->argv;
    for (int i = 1; i < options->argc; i++)
        if (strcmp(argv[i], "view") == 0) {
            memmove(&argv[i], &argv[i + 1], (size_t)(options->argc - i) * sizeof *argv);
            break;
        }
    process_become(program, argv);
    struct err err;
    err_set(&err, ERR_SYSTEM,
            "%s: cannot be run: %s; it is built where GLFW and Dear ImGui are "
            "installed (Debian: libglfw3-dev, libimgui-dev)",
            program, strerror(errno));
    return command_fail(&err);
}
