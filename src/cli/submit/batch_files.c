#include "cli/submit/batch_files.h"

#include "base/file.h"
#include "base/file_system.h"
#include "base/process.h"
#include <limits.h>
#include <stdio.h>
#include <string.h>

// The second line of both files. A file without this line is not replaced.
#define MARK "# Written by lampyris submit."

// The head of a batch file. If an option is given twice, Slurm uses its last value, so the options
// of --slurm come last.
#define HEAD                                                                                       \
    "#!/bin/sh\n" MARK "\n"                                                                        \
    "#SBATCH --job-name=%s\n"                                                                      \
    "#SBATCH --output=%s\n"                                                                        \
    "#SBATCH --open-mode=append\n"

// The rest of the file of shards. Slurm sends SIGUSR1 only to the shell, but SIGTERM, when a task
// is preempted or cancelled, to all processes of the task. The shell does not pass SIGTERM on,
// because a second SIGTERM would end the render at once, without writing its part. `wait` returns
// when a signal arrives, so it is called in a loop.
#define SHARDS                                                                                     \
    "#SBATCH --array=1-%u\n"                                                                       \
    "#SBATCH --requeue\n"                                                                          \
    "#SBATCH --signal=B:USR1@60\n"                                                                 \
    "%s%s%s"                                                                                       \
    "# A minute before the time limit, the shard writes its part, and its task is queued again,\n" \
    "# to continue from it.\n"                                                                     \
    "trap 'is_over=1; kill -USR1 \"$shard\"' USR1\n"                                               \
    "trap : TERM\n"                                                                                \
    "%s%s%s --shard \"$SLURM_ARRAY_TASK_ID/%u\" --resume --quiet &\n"                              \
    "shard=$!\n"                                                                                   \
    "code=0\n"                                                                                     \
    "while kill -0 \"$shard\" 2>/dev/null; do\n"                                                   \
    "    wait \"$shard\"\n"                                                                        \
    "    code=$?\n"                                                                                \
    "done\n"                                                                                       \
    "if [ -n \"$is_over\" ] && [ \"$code\" -ne 0 ]; then\n"                                        \
    "    exec scontrol requeue \"${SLURM_ARRAY_JOB_ID}_$SLURM_ARRAY_TASK_ID\"\n"                   \
    "fi\n"                                                                                         \
    "exit \"$code\"\n"

#define MERGE                                                                                      \
    "%s%s%s"                                                                                       \
    "exec %s merge --expect %s %s%s\n"

static const char *quote(struct arena *arena, const char *word)
{
    char *out = word ? ARENA_NEW(arena, char, 4 * strlen(word) + 4) : NULL;
    if (out)
        options_quote(word, out);
    return out;
}

// Returns the scene's name without its extension. Names of parts begin with it, too
// (shard_default_part()).
static const char *stem_of(struct arena *arena, const struct options *options)
{
    const char *name = path_name(options->arguments[0]), *extension = path_extension(name);
    size_t length = strlen(name) - strlen(extension) - (*extension ? 1 : 0);
    return arena_printf(arena, "%.*s", (int)length, name);
}

// Replaces characters that are special in names in batch files: '%' and '\' are patterns of Slurm,
// and '#' begins a comment.
static const char *plain_name(struct arena *arena, const char *stem)
{
    static const char plain[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_.-";
    char *name = stem ? arena_strdup(arena, stem) : NULL;
    for (char *c = name; c && *c; c++)
        if (!strchr(plain, *c))
            *c = '_';
    return name;
}

// Returns the path of this program, quoted for a shell. The nodes of the cluster may have another
// lampyris in their PATH.
static const char *own_program(struct arena *arena)
{
    char own[PATH_MAX];
    return quote(arena, process_own_path(own, sizeof own) ? own : "lampyris");
}

// Returns the command of the shards: for "lampyris submit OPTIONS", " render OPTIONS".
static const char *render_words(struct arena *arena, const struct options *options)
{
    const char *line = options->render.shared_line, *command = strstr(line, " submit");
    return arena_printf(arena, "%.*s render%s", (int)(command - line - (int)strlen("lampyris")),
                        line + strlen("lampyris"), command + strlen(" submit"));
}

// Returns a pattern that matches the names of all parts (shard_default_part()), but no part of
// another scene: the numbers of all parts have equally many digits.
static const char *pattern_of_parts(struct arena *arena, const char *stem, uint32_t count)
{
    const char *quoted = quote(arena, stem), *digits = "";
    for (uint32_t left = count; left > 0 && digits; left /= 10)
        digits = arena_printf(arena, "%s[0-9]", digits);
    if (!quoted || !digits)
        return NULL;
    return arena_printf(arena, "%s%s.%s-of-%u.part", options_folder_of(stem), quoted, digits,
                        count);
}

static const char *output_words(struct arena *arena, const struct options *options)
{
    const char *words = "";
    for (uint32_t i = 0; words && i < options->render.output_count; i++) {
        const char *name = quote(arena, options->render.outputs[i]);
        words = name ? arena_printf(arena, "%s -o %s%s", words,
                                    options_folder_of(options->render.outputs[i]), name)
                     : NULL;
    }
    return words;
}

static bool write_one(const char *path, const char *text, struct err *err)
{
    struct arena scratch = {0};
    struct file_bytes bytes;
    bool ok = true;
    if (file_exists(path)) {
        ok = file_read_own(&scratch, path, 0, &bytes, err);
        if (ok && !(bytes.size > sizeof "#!/bin/sh\n" MARK &&
                    memcmp(bytes.data, "#!/bin/sh\n" MARK, sizeof "#!/bin/sh\n" MARK - 1) == 0))
            ok = err_set(err, ERR_INPUT,
                         "%s: exists already and was not written by lampyris submit; expected it "
                         "under another name",
                         path);
    }
    arena_finish(&scratch);
    return ok && file_write_atomic(path, text, strlen(text), err);
}

bool batch_files_write(const struct options *options, const char *hash, struct batch_files *out,
                       struct err *err)
{
    *out = (struct batch_files){0};
    struct arena *arena = &out->arena;
    const char *slurm = options->submit.slurm ? options->submit.slurm : "";
    if (strpbrk(slurm, "\r\n"))
        return err_set(err, ERR_USAGE,
                       "--slurm: has a line break; expected options of sbatch in "
                       "one line");
    const uint32_t count = options->submit.parts;
    const char *stem = stem_of(arena, options), *name = plain_name(arena, stem);
    const char *program = own_program(arena);
    const char *render = render_words(arena, options), *outputs = output_words(arena, options);
    const char *by = options->render.shard_by == SHARD_BY_TILES ? " --shard-by tiles" : "";
    const char *before = *slurm ? "#SBATCH " : "", *after = *slurm ? "\n" : "";
    if (!stem || !name || !program || !render || !outputs)
        return err_memory(err, "batch files", 4096);
    out->parts = pattern_of_parts(arena, stem, count);
    out->shards = arena_printf(arena, "%s%s.shards.sh", options_folder_of(stem), stem);
    out->merge = arena_printf(arena, "%s%s.merge.sh", options_folder_of(stem), stem);
    const char *log_of_shards = arena_printf(arena, "%s.%%a-of-%u.log", name, count);
    const char *log_of_merge = arena_printf(arena, "%s.merge.log", name);
    const char *shards = log_of_shards
                             ? arena_printf(arena, HEAD SHARDS, name, log_of_shards, count, before,
                                            slurm, after, program, render, by, count)
                             : NULL;
    const char *merge = log_of_merge && out->parts
                            ? arena_printf(arena, HEAD MERGE, name, log_of_merge, before, slurm,
                                           after, program, hash, out->parts, outputs)
                            : NULL;
    if (!out->shards || !out->merge || !shards || !merge)
        return err_memory(err, "batch files", 4096);
    return write_one(out->shards, shards, err) && write_one(out->merge, merge, err);
}

void batch_files_finish(struct batch_files *files)
{
    if (files)
        arena_finish(&files->arena);
}
