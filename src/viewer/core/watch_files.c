#include "viewer/core/watch_files.h"

#include "base/file.h"
#include "base/file_system.h"
#include "base/hash.h"
#include <limits.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

// Only the first bytes of a file are searched: longer files name other files at their beginning
// (OBJ), or not at all (binary glTF).
#define TEXT_MAX (1u << 20)

void watch_files_finish(struct watch_files *files)
{
    arena_finish(&files->arena);
    *files = (struct watch_files){0};
}

static bool is_listed(const struct watch_files *files, const char *path)
{
    for (uint32_t i = 0; i < files->count; i++)
        if (strcmp(files->paths[i], path) == 0)
            return true;
    return false;
}

void watch_files_add(struct watch_files *files, const char *path)
{
    const char *copy = files->count < WATCH_FILES_MAX && *path && !is_listed(files, path)
                           ? arena_strdup(&files->arena, path)
                           : NULL;
    if (copy)
        files->paths[files->count++] = copy;
}

// --- scenes --------------------------------------------------------------------------------------

static bool has_text(const char *path)
{
    static const char *const kinds[] = {"json", "gltf", "obj", "mtl"};
    for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++)
        if (path_has_extension(path, kinds[i]))
            return true;
    return false;
}

// Takes any text in quotation marks (JSON) or between blanks for a reference if it is the name of a
// file in the folder. Superfluous files do no harm.
static void add_word(struct watch_files *files, const char *folder, const char *word, size_t length)
{
    char path[PATH_MAX];
    if (length == 0 || length > NAME_MAX || !memchr(word, '.', length))
        return;
    int size = path_is_absolute(word)
                   ? snprintf(path, sizeof path, "%.*s", (int)length, word)
                   : snprintf(path, sizeof path, "%s/%.*s", folder, (int)length, word);
    if (size < (int)sizeof path && file_is_regular(path))
        watch_files_add(files, path);
}

static void add_named(struct watch_files *files, const char *path)
{
    char text[4096];
    FILE *file = file_stream(path, "rb");
    char *folder = path_folder(&files->arena, path);
    bool is_json = path_has_extension(path, "json") || path_has_extension(path, "gltf");
    const char *ends = is_json ? "\"" : " \t\r\n";
    size_t used = 0, total = 0;
    for (int c; file && folder && total < TEXT_MAX && (c = fgetc(file)) != EOF; total++) {
        if (!c || !strchr(ends, c)) {
            text[used] = (char)c;
            used += used + 1 < sizeof text; // longer words are cut, because they are not names
            continue;
        }
        add_word(files, folder, text, used);
        used = 0;
    }
    if (file) {
        add_word(files, folder ? folder : ".", text, used);
        fclose(file);
    }
}

void watch_files_add_scene(struct watch_files *files, const char *path)
{
    uint32_t next = files->count;
    watch_files_add(files, path);
    for (; next < files->count; next++)
        if (has_text(files->paths[next]))
            add_named(files, files->paths[next]);
}

// --- shaders -------------------------------------------------------------------------------------

static void add_folder(struct watch_files *files, const char *folder, const char *below)
{
    char path[PATH_MAX];
    snprintf(path, sizeof path, "%s%s", folder, below);
    struct folder_reader *entries = folder_open(path);
    for (const char *entry; entries && (entry = folder_next(entries));) {
        const char *extension = path_extension(entry);
        if (strcmp(extension, "comp") != 0 && strcmp(extension, "glsl") != 0 &&
            strcmp(extension, "h") != 0)
            continue;
        char name[PATH_MAX + NAME_MAX + 2];
        snprintf(name, sizeof name, "%s/%s", path, entry);
        watch_files_add(files, name);
    }
    folder_close(entries);
}

void watch_files_add_shaders(struct watch_files *files, const char *folder)
{
    add_folder(files, folder, "");
    add_folder(files, folder, "/lib");
    add_folder(files, folder, "/shared");
}

// --- changes -------------------------------------------------------------------------------------

uint64_t watch_files_stamp(const struct watch_files *files)
{
    uint64_t hash = HASH_INIT;
    for (uint32_t i = 0; i < files->count; i++) {
        struct file_status status;
        uint64_t words[4] = {0};
        if (file_status(files->paths[i], &status)) {
            words[0] = status.changed_ns;
            words[1] = status.size;
            words[2] = status.number;
            words[3] = 1;
        }
        hash = hash_bytes(hash, words, sizeof words);
    }
    return hash;
}
