#define _GNU_SOURCE // environ
#include "viewer/core/shader_compile.h"

#include "base/arena.h"
#include "base/file.h"
#include "base/hash.h"
#include "base/parallel.h"
#include "kernel_source.h"
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <signal.h>
#include <spawn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#define COMPILER "glslangValidator"
#define SPIRV_MAGIC 0x07230203u // SPIR-V specification, section 2.3: the first word of a module
#define SPIRV_HEADER_BYTES 20u  // the same: five words before the first instruction

// --- what can be known before --------------------------------------------------------------------

static bool is_in_path(const char *program)
{
    const char *path = getenv("PATH");
    char name[PATH_MAX];
    while (path && *path) {
        size_t length = strcspn(path, ":");
        snprintf(name, sizeof name, "%.*s/%s", (int)length, path, program);
        if (access(name, X_OK) == 0)
            return true;
        path += length + (path[length] == ':');
    }
    return false;
}

const char *shader_why_not(const char *folder)
{
    char name[PATH_MAX];
    snprintf(name, sizeof name, "%s/lib", folder);
    if (!is_in_path(COMPILER))
        return COMPILER " is not installed (Debian: glslang-tools)";
    if (access(name, R_OK | X_OK) != 0)
        return "the folder of the kernels' source is not there; --shaders names another";
    return NULL;
}

// --- what a kernel is made from ------------------------------------------------------------------

// Of the paths and contents of all files. False where one cannot be read.
static bool hash_files(const char *files, struct arena *arena, uint64_t *hash)
{
    *hash = HASH_INIT;
    for (const char *path = files; *path; path += strlen(path) + 1) {
        struct file_bytes bytes;
        if (!file_read(arena, path, 0, &bytes, NULL))
            return false;
        *hash = hash_bytes(*hash, path, strlen(path) + 1);
        *hash = hash_bytes(*hash, bytes.data, bytes.size);
    }
    return true;
}

static bool is_unchanged(const struct shader_unit *unit, struct arena *arena)
{
    uint64_t hash;
    return unit->files && hash_files(unit->files, arena, &hash) && hash == unit->hash;
}

static bool is_newer(const char *files, const struct timespec *than)
{
    for (const char *path = files; *path; path += strlen(path) + 1) {
        struct stat status;
        if (stat(path, &status) != 0 || status.st_mtim.tv_sec >= than->tv_sec)
            return true;
    }
    return false;
}

// From make's syntax, "TARGET: FILE FILE …", in which the compiler escapes nothing: of a folder
// with a blank in its name come paths that do not exist, and so no hash.
static char *parse_dependencies(const char *text)
{
    const char *at = strchr(text, ':');
    char *files = calloc(strlen(text) + 2, 1);
    if (!at || !files) {
        free(files);
        return NULL;
    }
    char *out = files;
    for (at++; *at;) {
        size_t length = strcspn(at, " \n");
        memcpy(out, at, length);
        out += length ? length + 1 : 0;
        at += length + (at[length] != '\0');
    }
    return files;
}

// --- one run of the compiler ---------------------------------------------------------------------

struct run {
    pid_t process; // 0: none
    uint32_t unit;
    const char *code, *dependencies, *messages; // files that it writes
};

// Signals are as a fresh process has them: they are blocked in this thread, and SIGPIPE is ignored.
static bool set_signals(posix_spawnattr_t *attributes)
{
    sigset_t none, pipes;
    sigemptyset(&none);
    sigemptyset(&pipes);
    sigaddset(&pipes, SIGPIPE);
    return posix_spawnattr_setsigmask(attributes, &none) == 0 &&
           posix_spawnattr_setsigdefault(attributes, &pipes) == 0 &&
           posix_spawnattr_setflags(attributes, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF) ==
               0;
}

static bool spawn(struct run *run, char *const *arguments, struct err *err)
{
    posix_spawn_file_actions_t actions;
    posix_spawnattr_t attributes;
    posix_spawn_file_actions_init(&actions);
    posix_spawnattr_init(&attributes);
    const int flags = O_WRONLY | O_CREAT | O_TRUNC;
    bool ok = set_signals(&attributes) &&
              posix_spawn_file_actions_addopen(&actions, 0, "/dev/null", O_RDONLY, 0) == 0 &&
              posix_spawn_file_actions_addopen(&actions, 1, run->messages, flags, 0600) == 0 &&
              posix_spawn_file_actions_adddup2(&actions, 1, 2) == 0;
    int result =
        ok ? posix_spawnp(&run->process, COMPILER, &actions, &attributes, arguments, environ)
           : ENOMEM;
    posix_spawnattr_destroy(&attributes);
    posix_spawn_file_actions_destroy(&actions);
    if (result == 0)
        return true;
    run->process = 0;
    return err_set(err, ERR_SYSTEM, COMPILER ": cannot be run: %s", strerror(result));
}

// The names live in the arena.
static bool start(const struct shader_job *job, const char *temporary, uint32_t unit,
                  struct arena *arena, struct run *run, struct err *err)
{
    static const char *const flags[] = {KERNEL_FLAGS};
    const char *name = job->units[unit].name;
    *run = (struct run){
        .unit = unit,
        .code = arena_printf(arena, "%s/%s.spv", temporary, name),
        .dependencies = arena_printf(arena, "%s/%s.d", temporary, name),
        .messages = arena_printf(arena, "%s/%s.txt", temporary, name),
    };
    const char *source = arena_printf(arena, "%s/%s.comp", job->folder, name);
    const char *include = arena_printf(arena, "-I%s", job->folder);
    if (!run->code || !run->dependencies || !run->messages || !source || !include)
        return err_memory(err, "names of files", PATH_MAX);

    const char *arguments[sizeof flags / sizeof *flags + 10];
    uint32_t count = 0;
    arguments[count++] = COMPILER;
    for (size_t i = 0; i < sizeof flags / sizeof *flags; i++)
        arguments[count++] = flags[i];
    arguments[count++] = include;
    arguments[count++] = "--depfile";
    arguments[count++] = run->dependencies;
    if (job->ballot)
        arguments[count++] = "-DBALLOT";
    arguments[count++] = "-o";
    arguments[count++] = run->code;
    arguments[count++] = source;
    arguments[count] = NULL;
    return spawn(run, (char *const *)arguments, err); // POSIX: the strings are not modified
}

static void remove_files(const struct run *run)
{
    unlink(run->code);
    unlink(run->dependencies);
    unlink(run->messages);
}

// --- what came of it -----------------------------------------------------------------------------

// A copy; NULL where it is no SPIR-V.
static struct shader_code *read_code(const char *path, struct arena *arena)
{
    struct file_bytes bytes;
    uint32_t magic = 0;
    if (!file_read(arena, path, 0, &bytes, NULL) || bytes.size < SPIRV_HEADER_BYTES ||
        bytes.size % sizeof magic != 0)
        return NULL;
    memcpy(&magic, bytes.data, sizeof magic);
    struct shader_code *code = magic == SPIRV_MAGIC ? malloc(sizeof *code + bytes.size) : NULL;
    if (code) {
        code->users = 0;
        code->bytes = bytes.size;
        memcpy(code->words, bytes.data, bytes.size);
    }
    return code;
}

// Adds a line unless it is there: what is wrong in a file that several kernels include is said
// once.
static void add_error(char *errors, size_t size, const char *line)
{
    size_t used = strlen(errors), length = strlen(line);
    for (const char *at = errors; *at; at += strcspn(at, "\n") + 1)
        if (strncmp(at, line, length) == 0 && at[length] == '\n')
            return;
    if (used + length + 2 <= size)
        snprintf(errors + used, size - used, "%s\n", line);
}

// Of the compiler's other lines, summaries name no place, and that it gave up follows other faults.
static bool is_fault(const char *line)
{
    const char *colon = strchr(line, ':');
    size_t digits = colon ? strspn(colon + 1, "0123456789") : 0;
    return digits > 0 && colon[1 + digits] == ':' && !strstr(line, ": compilation terminated");
}

// "ERROR: FOLDER/lib/x.glsl:12: text" becomes "lib/x.glsl:12: text".
static void add_messages(const struct shader_job *job, const char *name, const char *text,
                         char *errors, size_t size)
{
    static const char prefix[] = "ERROR: ";
    size_t folder = strlen(job->folder);
    bool is_some = false;
    char line[1024];
    for (const char *at = text, *end; *at; at = *end ? end + 1 : end) {
        end = at + strcspn(at, "\n");
        if (strncmp(at, prefix, sizeof prefix - 1) != 0)
            continue;
        at += sizeof prefix - 1;
        if (strncmp(at, job->folder, folder) == 0 && at[folder] == '/')
            at += folder + 1;
        int length = (int)(end - at);
        while (length > 0 && at[length - 1] == ' ')
            length--;
        snprintf(line, sizeof line, "%.*s", length, at);
        if (is_fault(line)) {
            add_error(errors, size, line);
            is_some = true;
        }
    }
    if (is_some)
        return;
    snprintf(line, sizeof line, "%s.comp: %.*s", name, *text ? (int)strcspn(text, "\n") : 80,
             *text ? text : COMPILER " made no SPIR-V of it");
    add_error(errors, size, line);
}

// started: the clock's time; files that changed since then may have been read before or after.
static void collect(const struct shader_job *job, const struct run *run, bool exited_well,
                    const struct timespec *started, struct shader_result *result, char *errors,
                    size_t size)
{
    struct arena arena = {0};
    struct file_bytes text = {.data = (const uint8_t *)""};
    const char *name = job->units[run->unit].name;
    if (exited_well)
        result->code = read_code(run->code, &arena);
    result->unit = (struct shader_unit){.name = name};
    if (result->code) {
        result->outcome = SHADER_COMPILED;
        if (file_read(&arena, run->dependencies, 0, &text, NULL))
            result->unit.files = parse_dependencies((const char *)text.data);
        struct shader_unit *unit = &result->unit;
        if (unit->files &&
            (is_newer(unit->files, started) || !hash_files(unit->files, &arena, &unit->hash))) {
            free(unit->files);
            unit->files = NULL;
        }
    } else {
        result->outcome = SHADER_FAILED;
        file_read(&arena, run->messages, 0, &text, NULL);
        add_messages(job, name, (const char *)text.data, errors, size);
    }
    arena_finish(&arena);
}

// --- all of them ---------------------------------------------------------------------------------

struct batch {
    const struct shader_job *job;
    struct shader_result *results;
    char *errors;
    size_t size;
    struct arena arena;
    const char *temporary;
    struct timespec started;
    struct run *runs; // those under way
    uint32_t run_count, most_runs;
    bool failed;
};

// Takes what has ended; true when there was one.
static bool reap(struct batch *batch)
{
    for (uint32_t i = 0; i < batch->run_count; i++) {
        struct run *run = &batch->runs[i];
        int status = 0;
        pid_t ended = waitpid(run->process, &status, WNOHANG);
        if (ended == 0 || (ended < 0 && errno == EINTR))
            continue;
        struct shader_result *result = &batch->results[run->unit];
        collect(batch->job, run, ended > 0 && WIFEXITED(status) && WEXITSTATUS(status) == 0,
                &batch->started, result, batch->errors, batch->size);
        batch->failed |= result->outcome == SHADER_FAILED;
        remove_files(run);
        *run = batch->runs[--batch->run_count];
        return true;
    }
    return false;
}

static void rest(void)
{
    nanosleep(&(struct timespec){.tv_nsec = 2000000}, NULL);
}

static void kill_all(struct batch *batch)
{
    for (uint32_t i = 0; i < batch->run_count; i++) {
        kill(batch->runs[i].process, SIGKILL);
        while (waitpid(batch->runs[i].process, NULL, 0) < 0 && errno == EINTR)
            continue;
        remove_files(&batch->runs[i]);
    }
    batch->run_count = 0;
}

// Those units that are to be compiled; returns how many.
static uint32_t list_changed(const struct shader_job *job, uint32_t out[SHADER_UNITS_MAX])
{
    uint32_t count = 0;
    for (uint32_t i = 0; i < job->count; i++) {
        struct arena arena = {0};
        if (!is_unchanged(&job->units[i], &arena))
            out[count++] = i;
        arena_finish(&arena);
    }
    return count;
}

static bool run_all(struct batch *batch, struct err *err)
{
    uint32_t changed[SHADER_UNITS_MAX], next = 0;
    uint32_t count = list_changed(batch->job, changed);
    while (next < count || batch->run_count > 0) {
        if (atomic_load(batch->job->is_cancelled))
            return err_set(err, ERR_STOPPED, "compiling was stopped");
        if (next < count && batch->run_count < batch->most_runs) {
            struct run *run = &batch->runs[batch->run_count];
            if (!start(batch->job, batch->temporary, changed[next++], &batch->arena, run, err))
                return false;
            batch->run_count++;
        } else if (!reap(batch)) {
            rest();
        }
    }
    return true;
}

static bool make_folder(struct batch *batch, struct err *err)
{
    const char *parent = getenv("TMPDIR");
    if (!parent || !*parent)
        parent = "/tmp";
    char *name = arena_printf(&batch->arena, "%s/lampyris-XXXXXX", parent);
    batch->temporary = name;
    if (!name)
        return err_memory(err, "names of files", PATH_MAX);
    return mkdtemp(name) || err_set(err, ERR_SYSTEM, "%s: no folder can be created in it: %s",
                                    parent, strerror(errno));
}

bool shader_compile(const struct shader_job *job, struct shader_result *results, char *errors,
                    size_t size, struct err *err)
{
    struct run runs[SHADER_UNITS_MAX];
    unsigned cpus = cpu_count();
    struct batch batch = {
        .job = job,
        .results = results,
        .errors = errors,
        .size = size,
        .runs = runs,
        .most_runs = cpus < SHADER_UNITS_MAX ? cpus : SHADER_UNITS_MAX,
    };
    memset(results, 0, job->count * sizeof *results);
    errors[0] = '\0';
    clock_gettime(CLOCK_REALTIME, &batch.started);
    bool ok = make_folder(&batch, err);
    if (ok) {
        ok = run_all(&batch, err);
        kill_all(&batch);
        rmdir(batch.temporary);
    }
    arena_finish(&batch.arena);
    if (ok && batch.failed)
        ok = err_set(err, ERR_INPUT, "%.*s", (int)strcspn(errors, "\n"), errors);
    return ok;
}
