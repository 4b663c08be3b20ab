#define _GNU_SOURCE // for environ
#include "base/process.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <signal.h>
#include <spawn.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>
#ifdef __APPLE__
#include <crt_externs.h>
#include <mach-o/dyld.h>
#define environ (*_NSGetEnviron())
#endif

void process_begin(int *argc, char ***argv)
{
    (void)argc, (void)argv;
}

uint64_t process_id(void)
{
    return (uint64_t)getpid();
}

bool process_own_path(char *out, size_t size)
{
#ifdef __APPLE__
    uint32_t length = (uint32_t)size;
    return _NSGetExecutablePath(out, &length) == 0;
#else
    const ssize_t length = readlink("/proc/self/exe", out, size - 1);
    out[length > 0 ? length : 0] = '\0';
    return length > 0;
#endif
}

bool program_is_installed(const char *name)
{
    const char *path = getenv("PATH");
    char program[PATH_MAX];
    while (path && *path) {
        const size_t length = strcspn(path, ":");
        snprintf(program, sizeof program, "%.*s/%s", (int)length, path, name);
        if (access(program, X_OK) == 0)
            return true;
        path += length + (path[length] == ':');
    }
    return false;
}

// Gives the child default signal handling: signals may be blocked in this thread, and SIGPIPE is
// ignored.
static int set_signals(posix_spawnattr_t *attributes)
{
    sigset_t none, pipes;
    sigemptyset(&none);
    sigemptyset(&pipes);
    sigaddset(&pipes, SIGPIPE);
    int failure = posix_spawnattr_setsigmask(attributes, &none);
    if (failure == 0)
        failure = posix_spawnattr_setsigdefault(attributes, &pipes);
    return failure ? failure
                   : posix_spawnattr_setflags(attributes,
                                              POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF);
}

static int set_files(posix_spawn_file_actions_t *actions, const struct process_params *params)
{
    int failure = params->in
                      ? posix_spawn_file_actions_adddup2(actions, fileno(params->in), 0)
                      : posix_spawn_file_actions_addopen(actions, 0, "/dev/null", O_RDONLY, 0);
    if (failure == 0)
        failure = posix_spawn_file_actions_adddup2(actions, fileno(params->out), 1);
    if (failure == 0 && params->has_errors_in_out)
        failure = posix_spawn_file_actions_adddup2(actions, 1, 2);
    return failure;
}

bool process_start(struct process *process, const struct process_params *params, struct err *err)
{
    posix_spawn_file_actions_t actions;
    posix_spawnattr_t attributes;
    pid_t child = 0;
    if (posix_spawn_file_actions_init(&actions) != 0)
        return err_memory(err, "another process", 0);
    if (posix_spawnattr_init(&attributes) != 0) {
        posix_spawn_file_actions_destroy(&actions);
        return err_memory(err, "another process", 0);
    }
    int failure = set_signals(&attributes);
    if (failure == 0)
        failure = set_files(&actions, params);
    if (failure == 0) // casts away const: POSIX says that the strings are not modified
        failure = posix_spawnp(&child, params->arguments[0], &actions, &attributes,
                               (char *const *)params->arguments, environ);
    posix_spawnattr_destroy(&attributes);
    posix_spawn_file_actions_destroy(&actions);
    *process = (struct process){failure == 0 ? child : 0};
    return failure == 0 || err_set(err, ERR_SYSTEM, "%s cannot be run: %s", params->arguments[0],
                                   strerror(failure));
}

static bool collect(struct process *process, int flags, bool *is_well)
{
    int status = 0;
    pid_t ended;
    do
        ended = waitpid((pid_t)process->handle, &status, flags);
    while (ended < 0 && errno == EINTR);
    if (ended == 0)
        return false;
    *is_well = ended > 0 && WIFEXITED(status) && WEXITSTATUS(status) == 0;
    *process = (struct process){0};
    return true;
}

void process_wait(struct process *process, bool *is_well)
{
    collect(process, 0, is_well);
}

bool process_has_ended(struct process *process, bool *is_well)
{
    return collect(process, WNOHANG, is_well);
}

void process_kill(struct process *process)
{
    bool is_well;
    if (process->handle == 0)
        return;
    kill((pid_t)process->handle, SIGKILL);
    collect(process, 0, &is_well);
}

void process_become(const char *program, char **arguments)
{
    execvp(program, arguments);
}
