#define _GNU_SOURCE // environ
#include "report/gnuplot.h"

#include <errno.h>
#include <spawn.h>
#include <stdio.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

// Runs it between two files; its messages go where ours go.
static bool spawn(FILE *in, FILE *out, struct err *err)
{
    char *const arguments[] = {"gnuplot", NULL};
    posix_spawn_file_actions_t actions;
    pid_t child;
    int status;
    if (posix_spawn_file_actions_init(&actions) != 0)
        return err_memory(err, "gnuplot", 0);
    int failure = posix_spawn_file_actions_adddup2(&actions, fileno(in), STDIN_FILENO);
    if (failure == 0)
        failure = posix_spawn_file_actions_adddup2(&actions, fileno(out), STDOUT_FILENO);
    if (failure == 0)
        failure = posix_spawnp(&child, "gnuplot", &actions, NULL, arguments, environ);
    posix_spawn_file_actions_destroy(&actions);
    if (failure != 0)
        return err_set(err, ERR_SYSTEM, "gnuplot cannot be run: %s", strerror(failure));
    while (waitpid(child, &status, 0) < 0)
        if (errno != EINTR)
            return err_set(err, ERR_SYSTEM, "gnuplot: %s", strerror(errno));
    return (WIFEXITED(status) && WEXITSTATUS(status) == 0) ||
           err_set(err, ERR_SYSTEM, "gnuplot failed");
}

static bool read_all(FILE *file, struct arena *arena, char **out, struct err *err)
{
    if (fseek(file, 0, SEEK_END) != 0)
        return err_set(err, ERR_SYSTEM, "what gnuplot printed: %s", strerror(errno));
    long size = ftell(file);
    rewind(file);
    *out = size > 0 ? ARENA_NEW(arena, char, (size_t)size + 1) : NULL;
    if (size > 0 && !*out)
        return err_memory(err, "a plot", (size_t)size);
    return (size > 0 && fread(*out, 1, (size_t)size, file) == (size_t)size) ||
           err_set(err, ERR_SYSTEM, "gnuplot printed nothing");
}

bool gnuplot_run(const char *script, struct arena *arena, char **out, struct err *err)
{
    FILE *in = tmpfile(), *printed = tmpfile();
    bool ok = in && printed && fputs(script, in) >= 0 && fflush(in) == 0;
    if (ok) {
        rewind(in);
        ok = spawn(in, printed, err) && read_all(printed, arena, out, err);
    } else
        err_set(err, ERR_SYSTEM, "a temporary file for gnuplot: %s", strerror(errno));
    if (in)
        fclose(in);
    if (printed)
        fclose(printed);
    return ok;
}
