#include "base/process.h"

#include "base/windows/wide.h"
#include <errno.h>
#include <io.h>
#include <stdlib.h>
#include <string.h>
#include <windows.h>

#include <shellapi.h> // needs windows.h before it

uint64_t process_id(void)
{
    return GetCurrentProcessId();
}

bool process_own_path(char *out, size_t size)
{
    wchar_t wide[4096];
    const DWORD length = GetModuleFileNameW(NULL, wide, 4096);
    char *path = length > 0 && length < 4096 ? wide_to_path(wide) : NULL;
    const bool ok = path && strlen(path) < size;
    if (ok)
        memcpy(out, path, strlen(path) + 1);
    free(path);
    return ok;
}

void process_begin(int *argc, char ***argv)
{
    int count;
    wchar_t **wide = CommandLineToArgvW(GetCommandLineW(), &count);
    char **arguments = wide ? calloc((size_t)count + 1, sizeof *arguments) : NULL;
    SetConsoleOutputCP(CP_UTF8);
    for (int i = 0; arguments && i < count; i++) {
        arguments[i] = wide_to(wide[i]);
        if (!arguments[i])
            return; // keeps the arguments of main()
    }
    if (arguments) {
        *argc = count;
        *argv = arguments;
    }
    LocalFree(wide);
}

bool program_is_installed(const char *name)
{
    wchar_t *wide = wide_from(name);
    const bool ok = wide && SearchPathW(NULL, wide, L".exe", 0, NULL, NULL) > 0;
    free(wide);
    return ok;
}

// --- command lines -------------------------------------------------------------------------------

// Quotes an argument. A command line is one text, which programs split by these rules ("Parsing C
// command-line arguments", Microsoft): quotation marks enclose blanks; a quotation mark inside is
// preceded by a backslash, and backslashes before any quotation mark are doubled.
static size_t quote(const char *argument, char *out)
{
    size_t length = 0, backslashes = 0;
    out[length++] = '"';
    for (const char *at = argument;; at++) {
        const bool is_quoted = *at == '"' || *at == '\0';
        for (size_t i = 0; is_quoted && i < backslashes; i++)
            out[length++] = '\\';
        if (*at == '\0')
            break;
        if (*at == '"')
            out[length++] = '\\';
        out[length++] = *at;
        backslashes = *at == '\\' ? backslashes + 1 : 0;
    }
    out[length++] = '"';
    return length;
}

static wchar_t *command_line(const char *const *arguments)
{
    size_t size = 1, length = 0;
    for (size_t i = 0; arguments[i]; i++)
        size += 2 * strlen(arguments[i]) + 3;
    char *line = malloc(size);
    for (size_t i = 0; line && arguments[i]; i++) {
        length += quote(arguments[i], line + length);
        line[length++] = ' ';
    }
    if (line)
        line[length] = '\0';
    wchar_t *wide = line ? wide_from(line) : NULL;
    free(line);
    return wide;
}

// --- other programs ------------------------------------------------------------------------------

// Returns a handle that children inherit; the null device if there is no file.
static HANDLE inheritable(FILE *file, DWORD access)
{
    HANDLE own, out = INVALID_HANDLE_VALUE;
    SECURITY_ATTRIBUTES inherited = {.nLength = sizeof inherited, .bInheritHandle = TRUE};
    if (!file)
        return CreateFileW(L"NUL", access, FILE_SHARE_READ | FILE_SHARE_WRITE, &inherited,
                           OPEN_EXISTING, 0, NULL);
    own = (HANDLE)_get_osfhandle(_fileno(file));
    DuplicateHandle(GetCurrentProcess(), own, GetCurrentProcess(), &out, 0, TRUE,
                    DUPLICATE_SAME_ACCESS);
    return out;
}

static bool start(const char *const *arguments, STARTUPINFOW *startup, HANDLE *out)
{
    PROCESS_INFORMATION info;
    wchar_t *line = command_line(arguments);
    const bool ok =
        line && (CreateProcessW(NULL, line, NULL, NULL, TRUE, 0, NULL, NULL, startup, &info) ||
                 wide_fail());
    free(line);
    if (!ok)
        return false;
    CloseHandle(info.hThread);
    *out = info.hProcess;
    return true;
}

bool process_start(struct process *process, const struct process_params *params, struct err *err)
{
    STARTUPINFOW startup = {.cb = sizeof startup, .dwFlags = STARTF_USESTDHANDLES};
    HANDLE child = NULL;
    fflush(params->out);
    startup.hStdInput = inheritable(params->in, GENERIC_READ);
    startup.hStdOutput = inheritable(params->out, GENERIC_WRITE);
    startup.hStdError =
        inheritable(params->has_errors_in_out ? params->out : stderr, GENERIC_WRITE);
    const bool ok = start(params->arguments, &startup, &child);
    const int reason = errno;
    CloseHandle(startup.hStdInput);
    CloseHandle(startup.hStdOutput);
    CloseHandle(startup.hStdError);
    *process = (struct process){(intptr_t)child};
    return ok ||
           err_set(err, ERR_SYSTEM, "%s cannot be run: %s", params->arguments[0], strerror(reason));
}

static bool collect(struct process *process, DWORD milliseconds, bool *is_well)
{
    HANDLE child = (HANDLE)process->handle;
    DWORD code = 1;
    if (WaitForSingleObject(child, milliseconds) == WAIT_TIMEOUT)
        return false;
    *is_well = GetExitCodeProcess(child, &code) && code == 0;
    CloseHandle(child);
    *process = (struct process){0};
    return true;
}

void process_wait(struct process *process, bool *is_well)
{
    collect(process, INFINITE, is_well);
}

bool process_has_ended(struct process *process, bool *is_well)
{
    return collect(process, 0, is_well);
}

void process_kill(struct process *process)
{
    bool is_well;
    if (!process->handle)
        return;
    TerminateProcess((HANDLE)process->handle, 1);
    collect(process, INFINITE, &is_well);
}

// The other program handles Ctrl-C while it runs; this one ignores it.
void process_become(const char *program, char **arguments)
{
    STARTUPINFOW startup = {.cb = sizeof startup};
    HANDLE child;
    DWORD code = 1;
    arguments[0] = (char *)program;
    if (!start((const char *const *)arguments, &startup, &child))
        return;
    SetConsoleCtrlHandler(NULL, TRUE);
    WaitForSingleObject(child, INFINITE);
    GetExitCodeProcess(child, &code);
    ExitProcess(code);
}
