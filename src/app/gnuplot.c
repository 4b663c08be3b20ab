#define _GNU_SOURCE // environ
#include "gnuplot.h"

#include "file.h"
#include <errno.h>
#include <fcntl.h>
#include <spawn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

// Runs it with the plot's file as standard output; its messages go where ours go.
static bool spawn(char *script_path, const char *svg_path, struct err *err)
{
    char *const arguments[] = {"gnuplot", script_path, NULL};
    posix_spawn_file_actions_t actions;
    pid_t child;
    int status;
    if (posix_spawn_file_actions_init(&actions) != 0)
        return err_memory(err, "gnuplot", 0);
    int failure = posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, svg_path,
                                                   O_WRONLY | O_CREAT | O_TRUNC, 0666);
    if (failure == 0)
        failure = posix_spawnp(&child, "gnuplot", &actions, NULL, arguments, environ);
    posix_spawn_file_actions_destroy(&actions);
    if (failure != 0)
        return err_set(err, ERR_SYSTEM, "gnuplot cannot be run: %s", strerror(failure));
    while (waitpid(child, &status, 0) < 0)
        if (errno != EINTR)
            return err_set(err, ERR_SYSTEM, "gnuplot: %s", strerror(errno));
    return (WIFEXITED(status) && WEXITSTATUS(status) == 0) ||
           err_set(err, ERR_SYSTEM, "gnuplot failed on %s", script_path);
}

bool gnuplot_run(const char *script, const char *path, struct err *err)
{
    char *script_path = NULL, *svg_path = NULL;
    bool ok =
        asprintf(&script_path, "%s.gp", path) >= 0 && asprintf(&svg_path, "%s.svg", path) >= 0;
    if (!ok)
        return err_memory(err, "file names", strlen(path));
    ok = file_write_atomic(script_path, script, strlen(script), err) &&
         spawn(script_path, svg_path, err);
    free(script_path);
    free(svg_path);
    return ok;
}
