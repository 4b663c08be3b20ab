#include "base/file_inputs.h"

#include "base/file.h"
#include "base/file_system.h"
#include "base/hash.h"
#include <stdlib.h>
#include <string.h>

struct file_input {
    char *path;
    uint64_t hash; // hash of the path, compared first
    bool is_own;   // the run may replace the file under this path
};

static struct file_inputs *current; // inputs of the current run; NULL: no run

void file_inputs_begin(struct file_inputs *inputs)
{
    *inputs = (struct file_inputs){.mutex = MUTEX_INIT};
    current = inputs;
}

void file_inputs_end(struct file_inputs *inputs)
{
    if (current == inputs)
        current = NULL;
    for (size_t i = 0; i < inputs->count; i++)
        free(inputs->list[i].path);
    free(inputs->list);
    *inputs = (struct file_inputs){0};
}

static struct file_input *find(const struct file_inputs *inputs, const char *path, uint64_t hash)
{
    for (size_t i = 0; i < inputs->count; i++)
        if (inputs->list[i].hash == hash && strcmp(inputs->list[i].path, path) == 0)
            return &inputs->list[i];
    return NULL;
}

static bool reserve_one(struct file_inputs *inputs, struct err *err)
{
    if (inputs->count < inputs->capacity)
        return true;
    size_t capacity = inputs->capacity ? 2 * inputs->capacity : 16;
    struct file_input *list = realloc(inputs->list, capacity * sizeof *list);
    if (!list)
        return err_memory(err, "the list of inputs", capacity * sizeof *list);
    inputs->list = list;
    inputs->capacity = capacity;
    return true;
}

static bool append(struct file_inputs *inputs, const char *path, uint64_t hash, bool is_own,
                   struct err *err)
{
    if (!reserve_one(inputs, err))
        return false;
    char *copy = strdup(path);
    if (!copy)
        return err_memory(err, "the list of inputs", strlen(path) + 1);
    inputs->list[inputs->count++] = (struct file_input){copy, hash, is_own};
    return true;
}

// Adds a file. A file that the run may replace (is_own) loses that right if it is also read as an
// ordinary input.
static bool add(const char *path, bool is_own, struct err *err)
{
    if (!current || !file_is_regular(path))
        return true;
    uint64_t hash = hash_bytes(HASH_INIT, path, strlen(path));
    mutex_lock(&current->mutex);
    struct file_input *known = find(current, path, hash);
    if (known)
        known->is_own &= is_own;
    bool ok = known || append(current, path, hash, is_own, err);
    mutex_unlock(&current->mutex);
    return ok;
}

bool file_inputs_add(const char *path, struct err *err)
{
    return add(path, false, err);
}

bool file_inputs_add_own(const char *path, struct err *err)
{
    return add(path, true, err);
}

void file_inputs_forget(const char *path)
{
    struct file_status status, input;
    if (!current || !file_status(path, &status))
        return;
    mutex_lock(&current->mutex);
    for (size_t i = current->count; i-- > 0;)
        if (file_status(current->list[i].path, &input) && file_status_same(&status, &input)) {
            free(current->list[i].path);
            current->list[i] = current->list[--current->count];
        }
    mutex_unlock(&current->mutex);
}

// Compares device and inode as they are now, not as they were when the file was read: an editor may
// have replaced the file by renaming a new one. The path then still is an input, while another file
// may have got the old inode.
bool file_inputs_check(const char *output, struct err *err)
{
    struct file_status status, input;
    if (!current || !file_status(output, &status) || status.kind != FILE_REGULAR)
        return true;
    bool ok = true;
    mutex_lock(&current->mutex);
    for (size_t i = 0; ok && i < current->count; i++) {
        const char *path = current->list[i].path;
        const bool is_named = strcmp(output, path) == 0;
        if (!file_status(path, &input) || !file_status_same(&status, &input) ||
            (is_named && current->list[i].is_own))
            continue;
        ok = is_named
                 ? err_set(err, ERR_USAGE, "%s: is read by this run; expected another output", path)
                 : err_set(err, ERR_USAGE,
                           "%s: is the file %s, which this run reads; expected another output",
                           output, path);
    }
    mutex_unlock(&current->mutex);
    return ok;
}

// Compares two files that do not exist yet. They are the same if they have the same name and
// folder.
static bool same_place(const char *a, const char *b)
{
    struct arena arena = {0};
    struct file_status folder_a, folder_b;
    const char *path_a = path_folder(&arena, a), *path_b = path_folder(&arena, b);
    bool same = strcmp(path_name(a), path_name(b)) == 0 && path_a && path_b &&
                file_status(path_a, &folder_a) && file_status(path_b, &folder_b) &&
                file_status_same(&folder_a, &folder_b);
    arena_finish(&arena);
    return same;
}

bool file_is_same(const char *a, const char *b)
{
    struct file_status status_a, status_b;
    bool has_a = file_status(a, &status_a), has_b = file_status(b, &status_b);
    if (has_a || has_b)
        return has_a && has_b && status_a.kind == FILE_REGULAR &&
               file_status_same(&status_a, &status_b);
    char *target_a = file_target(a), *target_b = file_target(b);
    bool same = target_a && target_b && same_place(target_a, target_b);
    free(target_a);
    free(target_b);
    return same;
}

bool file_check_distinct(const char *a, const char *b, struct err *err)
{
    return !a || !b || !file_is_same(a, b) ||
           err_set(err, ERR_USAGE, "%s and %s are the same file; expected a file for each output",
                   a, b);
}
