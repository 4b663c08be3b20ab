// Checks that no output is written twice, and that none replaces an input. Numbered images
// (--every) may be millions of files, so only those that exist, which may be links, are compared as
// files. All others are compared by name.
#include "cli/render/render_run.h"

#include "base/file.h"
#include "base/file_inputs.h"
#include "base/file_system.h"
#include "base/log.h"
#include <stdlib.h>
#include <string.h>

// Returns file n, from 0, of the files that are written at the end: the images, the checkpoint and
// the trace. Returns NULL for a file that was not requested.
static const char *output_at(const struct render_run *run, uint32_t n)
{
    return n < run->output_count    ? run->outputs[n]
           : n == run->output_count ? run->options->render.checkpoint
                                    : run->options->render.trace;
}

// --- numbered pictures ---------------------------------------------------------------------------

// A numbered image that exists before rendering.
struct numbered {
    const char *path;
    bool is_link;
};

struct numbered_list {
    struct arena arena;
    struct numbered *files;
    uint32_t count, capacity;
};

static bool is_written(const struct render_run *run, uint32_t number)
{
    const struct options *options = run->options;
    return number > 0 && options->render.every > 0 && number <= options->render.frames &&
           number % options->render.every == 0;
}

static bool append(struct numbered_list *list, const char *path, struct err *err)
{
    struct numbered *added = path ? arena_append(&list->arena, &list->files, &list->count,
                                                 &list->capacity, sizeof *added, NULL)
                                  : NULL;
    if (!added)
        return err_memory(err, "output names", list->count * sizeof *added);
    *added = (struct numbered){path, file_is_link(path)};
    return true;
}

static bool list_those_of(const struct render_run *run, const char *output,
                          struct numbered_list *list, struct err *err)
{
    const char *path = path_folder(&list->arena, output);
    struct folder_reader *folder = path ? folder_open(path) : NULL;
    bool ok = true;
    for (const char *name; ok && folder && (name = folder_next(folder));) {
        uint32_t number = path_number_of(name, output);
        if (is_written(run, number))
            ok = append(list, path_numbered(&list->arena, output, number), err);
    }
    folder_close(folder);
    return ok;
}

static bool list_numbered(const struct render_run *run, struct numbered_list *list, struct err *err)
{
    bool ok = true;
    for (uint32_t i = 0; ok && run->options->render.every && i < run->output_count; i++)
        ok = list_those_of(run, run->outputs[i], list, err);
    return ok;
}

// --- two outputs ---------------------------------------------------------------------------------

// Checks that `path`, or the file to which it links, is not one of the numbered images.
static bool check_name(const struct render_run *run, const char *path, struct arena *arena,
                       struct err *err)
{
    char *target = file_target(path);
    bool ok = target || err_memory(err, "output names", strlen(path) + 1);
    for (uint32_t i = 0; ok && i < run->output_count; i++) {
        uint32_t number = path_number_of(target, run->outputs[i]);
        const char *other =
            is_written(run, number) ? path_numbered(arena, run->outputs[i], number) : NULL;
        if (other && strcmp(other, path) != 0)
            ok = file_check_distinct(path, other, err);
        else if (other)
            ok = err_set(err, ERR_USAGE,
                         "%s: is also the picture after frame %u (--every %u); expected a file of "
                         "its own for each output",
                         path, (unsigned)number, (unsigned)run->options->render.every);
    }
    free(target);
    return ok;
}

static bool check_numbered(const struct render_run *run, struct numbered_list *list,
                           struct err *err)
{
    bool ok = list_numbered(run, list, err);
    for (uint32_t i = 0; ok && i < run->output_count + 2; i++) {
        const char *output = output_at(run, i);
        ok = !output || check_name(run, output, &list->arena, err);
        for (size_t k = 0; ok && output && k < list->count; k++)
            ok = file_check_distinct(output, list->files[k].path, err);
    }
    // Only links can make two numbered images the same file.
    for (size_t i = 0; ok && i < list->count; i++) {
        const struct numbered *link = &list->files[i];
        for (size_t k = 0; ok && link->is_link && k < list->count; k++)
            ok = k == i || file_check_distinct(link->path, list->files[k].path, err);
        char *target = ok && link->is_link ? file_target(link->path) : NULL;
        ok = ok && (!target || check_name(run, target, &list->arena, err));
        free(target);
    }
    return ok;
}

bool render_check_distinct(const struct render_run *run, struct err *err)
{
    for (uint32_t i = 0; i < run->output_count + 2; i++)
        for (uint32_t k = 0; k < i; k++)
            if (!file_check_distinct(output_at(run, k), output_at(run, i), err))
                return false;
    struct numbered_list list = {0};
    bool ok = run->options->render.every == 0 || check_numbered(run, &list, err);
    arena_finish(&list.arena);
    return ok;
}

// --- outputs and inputs --------------------------------------------------------------------------

// Drops the default PNG if an input has its name, as a texture spot.png of spot.obj has. Only the
// EXR is then written.
static void drop_default_of_inputs(struct render_run *run)
{
    struct err reason = {0};
    if (run->options->render.output_count > 0 || run->output_count < 2 ||
        file_inputs_check(run->outputs[1], &reason))
        return;
    run->output_count = 1;
    log_info("%s: only %s is written", reason.msg, run->outputs[0]);
}

bool render_check_inputs(struct render_run *run, struct err *err)
{
    struct numbered_list list = {0};
    bool ok = true;
    drop_default_of_inputs(run);
    for (uint32_t i = 0; ok && i < run->output_count + 2; i++)
        ok = !output_at(run, i) || file_inputs_check(output_at(run, i), err);
    ok = ok && list_numbered(run, &list, err);
    for (size_t i = 0; ok && i < list.count; i++)
        ok = file_inputs_check(list.files[i].path, err);
    arena_finish(&list.arena);
    return ok;
}
