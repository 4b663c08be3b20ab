#include "viewer/core/watch_files.h"

#include "base/file.h"
#include "base/hash.h"
#include <dirent.h>
#include <limits.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

// Longer files have their names of other files at the beginning (OBJ), or have none (binary glTF).
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

// Whatever stands in quotation marks (JSON) or between blanks, and is a file beside this one, is
// taken for one that it names: too many are no harm.
static void add_word(struct watch_files *files, const char *folder, const char *word, size_t length)
{
    char path[PATH_MAX];
    struct stat status;
    if (length == 0 || length > NAME_MAX || !memchr(word, '.', length))
        return;
    int size = word[0] == '/' ? snprintf(path, sizeof path, "%.*s", (int)length, word)
                              : snprintf(path, sizeof path, "%s/%.*s", folder, (int)length, word);
    if (size < (int)sizeof path && stat(path, &status) == 0 && S_ISREG(status.st_mode))
        watch_files_add(files, path);
}

static void add_named(struct watch_files *files, const char *path)
{
    char text[4096];
    FILE *file = fopen(path, "rb");
    char *folder = path_folder(&files->arena, path);
    bool is_json = path_has_extension(path, "json") || path_has_extension(path, "gltf");
    const char *ends = is_json ? "\"" : " \t\r\n";
    size_t used = 0, total = 0;
    for (int c; file && folder && total < TEXT_MAX && (c = fgetc(file)) != EOF; total++) {
        if (!c || !strchr(ends, c)) {
            text[used] = (char)c;
            used += used + 1 < sizeof text; // too long for a name, then
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
    DIR *entries = opendir(path);
    for (const struct dirent *entry; entries && (entry = readdir(entries));) {
        const char *extension = path_extension(entry->d_name);
        if (strcmp(extension, "comp") != 0 && strcmp(extension, "glsl") != 0 &&
            strcmp(extension, "h") != 0)
            continue;
        char name[PATH_MAX + NAME_MAX + 2];
        snprintf(name, sizeof name, "%s/%s", path, entry->d_name);
        watch_files_add(files, name);
    }
    if (entries)
        closedir(entries);
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
        struct stat status;
        uint64_t words[5] = {0};
        if (stat(files->paths[i], &status) == 0) {
            words[0] = (uint64_t)status.st_mtim.tv_sec;
            words[1] = (uint64_t)status.st_mtim.tv_nsec;
            words[2] = (uint64_t)status.st_size;
            words[3] = (uint64_t)status.st_ino;
            words[4] = 1;
        }
        hash = hash_bytes(hash, words, sizeof words);
    }
    return hash;
}
