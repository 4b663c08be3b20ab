#include "viewer/core/shader_compile.h"

#include "base/arena.h"
#include "base/clock.h"
#include "base/file.h"
#include "base/file_system.h"
#include "base/hash.h"
#include "base/parallel.h"
#include "base/process.h"
#include "kernel_source.h"
#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define COMPILER "glslangValidator"
#define SECOND_NS UINT64_C(1000000000)
#define SPIRV_MAGIC 0x07230203u // first word of a module (SPIR-V specification, section 2.3)
#define SPIRV_HEADER_BYTES 20u  // the five words before the first instruction (section 2.3)

// --- checks before compilation -------------------------------------------------------------------

const char *shader_why_not(const char *folder)
{
    char name[PATH_MAX];
    snprintf(name, sizeof name, "%s/lib", folder);
    if (!program_is_installed(COMPILER))
        return COMPILER " is not installed (Debian: glslang-tools)";
    if (!file_is_executable(name))
        return "the folder of the kernels' sources does not exist; name another one by --shaders";
    return NULL;
}

// --- source files of a kernel --------------------------------------------------------------------

// Hashes the paths and contents of all files. Returns false if one cannot be read.
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

// Returns whether a file cannot be read or has changed at this time or later. Times are compared in
// whole seconds, because some file systems store no fractions.
static bool is_newer(const char *files, uint64_t than_ns)
{
    for (const char *path = files; *path; path += strlen(path) + 1) {
        struct file_status status;
        if (!file_status(path, &status) || status.changed_ns / SECOND_NS >= than_ns / SECOND_NS)
            return true;
    }
    return false;
}

// Parses a dependency file in make's syntax, "TARGET: FILE FILE …". The compiler does not escape
// names, so a folder with a blank in its name gives paths that do not exist, and then there is no
// hash.
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
    struct process process;
    uint32_t unit;
    const char *code, *dependencies, *messages; // files that the compiler writes
};

static bool spawn(struct run *run, const char *const *arguments, struct err *err)
{
    FILE *messages = file_stream(run->messages, "w");
    if (!messages)
        return err_set(err, ERR_SYSTEM, "%s: %s", run->messages, strerror(errno));
    const struct process_params params = {
        .arguments = arguments, .out = messages, .has_errors_in_out = true};
    const bool ok = process_start(&run->process, &params, err);
    fclose(messages);
    return ok;
}

// Starts the compiler for one unit. The arena owns the names.
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
    return spawn(run, arguments, err);
}

static void remove_files(const struct run *run)
{
    file_remove(run->code);
    file_remove(run->dependencies);
    file_remove(run->messages);
}

// --- results -------------------------------------------------------------------------------------

// Returns a copy of the code, or NULL if the file is not SPIR-V.
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

// Adds a line unless it is there already: an error in a file that several kernels include is
// reported only once.
static void add_error(char *errors, size_t size, const char *line)
{
    size_t used = strlen(errors), length = strlen(line);
    for (const char *at = errors; *at; at += strcspn(at, "\n") + 1)
        if (strncmp(at, line, length) == 0 && at[length] == '\n')
            return;
    if (used + length + 2 <= size)
        snprintf(errors + used, size - used, "%s\n", line);
}

// Returns whether a line of the compiler's output is an error. Summaries name no place, and the
// final failure follows from other errors.
static bool is_fault(const char *line)
{
    const char *colon = strchr(line, ':');
    size_t digits = colon ? strspn(colon + 1, "0123456789") : 0;
    return digits > 0 && colon[1 + digits] == ':' && !strstr(line, ": compilation terminated");
}

// Adds the errors in the compiler's output; "ERROR: FOLDER/lib/x.glsl:12: text" becomes
// "lib/x.glsl:12: text".
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
             *text ? text : COMPILER " produced no SPIR-V");
    add_error(errors, size, line);
}

// Collects the result of a run. `started` is the time at which it started: files that changed after
// it may have been read before or after the change.
static void collect(const struct shader_job *job, const struct run *run, bool exited_well,
                    uint64_t started_ns, struct shader_result *result, char *errors, size_t size)
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
            (is_newer(unit->files, started_ns) || !hash_files(unit->files, &arena, &unit->hash))) {
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

// --- all units -----------------------------------------------------------------------------------

struct batch {
    const struct shader_job *job;
    struct shader_result *results;
    char *errors;
    size_t size;
    struct arena arena;
    char *temporary;
    uint64_t started_ns;
    struct run *runs; // the runs in progress
    uint32_t run_count, most_runs;
    bool failed;
};

// Collects a run that has ended. Returns whether there was one.
static bool reap(struct batch *batch)
{
    for (uint32_t i = 0; i < batch->run_count; i++) {
        struct run *run = &batch->runs[i];
        bool is_well;
        if (!process_has_ended(&run->process, &is_well))
            continue;
        struct shader_result *result = &batch->results[run->unit];
        collect(batch->job, run, is_well, batch->started_ns, result, batch->errors, batch->size);
        batch->failed |= result->outcome == SHADER_FAILED;
        remove_files(run);
        *run = batch->runs[--batch->run_count];
        return true;
    }
    return false;
}

static void rest(void)
{
    clock_sleep(2e-3);
}

static void kill_all(struct batch *batch)
{
    for (uint32_t i = 0; i < batch->run_count; i++) {
        process_kill(&batch->runs[i].process);
        remove_files(&batch->runs[i]);
    }
    batch->run_count = 0;
}

// Lists the units whose files have changed, and returns their number.
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
    batch->temporary = folder_create_temporary();
    return batch->temporary ||
           err_set(err, ERR_SYSTEM, "no temporary folder can be created: %s", strerror(errno));
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
    batch.started_ns = clock_wall_ns();
    bool ok = make_folder(&batch, err);
    if (ok) {
        ok = run_all(&batch, err);
        kill_all(&batch);
        folder_remove(batch.temporary);
        free(batch.temporary);
    }
    arena_finish(&batch.arena);
    if (ok && batch.failed)
        ok = err_set(err, ERR_INPUT, "%.*s", (int)strcspn(errors, "\n"), errors);
    return ok;
}
