#include "viewer/core/recent.h"

#include "base/arena.h"
#include "base/file.h"
#include "base/file_system.h"
#include "json/json_parse.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define VERSION 1
#define VERSION_KEY "lampyris_recent"
// Eight paths of the greatest length with all of their bytes escaped are less than this.
#define FILE_MAX (1u << 20)

// --- the place of the file -----------------------------------------------------------------------

// Returns the folder of the list, or NULL if there is none. With `creates`, also creates those of
// its parents that may be missing. The specification ignores paths that are not absolute.
static const char *folder_of(struct arena *arena, bool creates, struct err *err)
{
    static const char *const parts[] = {"/.local", "/state", "/lampyris"};
    const char *path = getenv("XDG_STATE_HOME");
    size_t first = 2;
    if (!path || !path_is_absolute(path)) {
        path = getenv("HOME");
        first = 0;
    }
    if (!path || !path_is_absolute(path))
        return NULL;
    if (creates && first == 2 && !file_make_folder(path, err))
        return NULL;
    for (size_t i = first; i < sizeof parts / sizeof *parts; i++) {
        path = arena_printf(arena, "%s%s", path, parts[i]);
        if (!path) {
            err_memory(err, "a path", RECENT_PATH_MAX);
            return NULL;
        }
        if (creates && !file_make_folder(path, err))
            return NULL;
    }
    return path;
}

// --- reading -------------------------------------------------------------------------------------

// Returns why a document is not a list of scenes, or NULL if it is one, which is then in *out.
static const char *take(const json_t *document, struct recent *out)
{
    const json_t *scenes = json_object_get(document, "scenes");
    if (json_integer_value(json_object_get(document, VERSION_KEY)) != VERSION)
        return VERSION_KEY " is not 1";
    if (!json_is_array(scenes))
        return "\"scenes\" is not an array";
    for (size_t i = 0; i < json_array_size(scenes) && out->count < RECENT_MAX; i++) {
        const char *path = json_string_value(json_array_get(scenes, i));
        if (!path || !path[0] || strlen(path) >= RECENT_PATH_MAX)
            return "an element of \"scenes\" is not a path";
        snprintf(out->paths[out->count++], RECENT_PATH_MAX, "%s", path);
    }
    return NULL;
}

static bool read_list(struct arena *arena, const char *path, struct recent *out, struct err *err)
{
    struct file_bytes bytes;
    if (!file_exists(path))
        return true;
    if (!file_read_own(arena, path, FILE_MAX, &bytes, err))
        return false;
    json_t *document = json_parse(path, &bytes, JSON_REJECT_DUPLICATES, err);
    if (!document)
        return false;
    const char *wrong = take(document, out);
    json_decref(document);
    return !wrong || err_set(err, ERR_INPUT, "%s: %s", path, wrong);
}

bool recent_read(struct recent *out, struct err *err)
{
    struct arena arena = {0};
    memset(out, 0, sizeof *out);
    const char *folder = folder_of(&arena, false, err);
    const char *path = folder ? arena_printf(&arena, "%s/recent.json", folder) : NULL;
    bool ok = !path || read_list(&arena, path, out, err);
    if (!ok)
        memset(out, 0, sizeof *out);
    arena_finish(&arena);
    return ok;
}

// --- changing ------------------------------------------------------------------------------------

void recent_add(struct recent *recent, const char *path)
{
    char *real = file_real_path(path); // the program may run in another folder next time
    const char *added = real ? real : path;
    uint32_t place = 0;
    if (strlen(added) >= RECENT_PATH_MAX) {
        free(real);
        return;
    }
    while (place < recent->count && strcmp(recent->paths[place], added) != 0)
        place++;
    if (place == recent->count && recent->count < RECENT_MAX)
        recent->count++;
    if (place == RECENT_MAX)
        place--;
    memmove(recent->paths[1], recent->paths[0], place * sizeof recent->paths[0]);
    snprintf(recent->paths[0], RECENT_PATH_MAX, "%s", added);
    free(real);
}

// Returns the list as JSON, or NULL when out of memory. Names that are not UTF-8 are left out,
// because JSON cannot represent them.
static char *text_of(const struct recent *recent)
{
    json_t *scenes = json_array();
    for (uint32_t i = 0; i < recent->count; i++) {
        json_t *path = json_string(recent->paths[i]);
        if (path)
            json_array_append_new(scenes, path);
    }
    json_t *document = json_pack("{s:i, s:o}", VERSION_KEY, VERSION, "scenes", scenes);
    char *text = document ? json_dumps(document, JSON_INDENT(2)) : NULL;
    json_decref(document);
    return text;
}

bool recent_write(const struct recent *recent, struct err *err)
{
    struct arena arena = {0};
    const char *folder = folder_of(&arena, true, err);
    const char *path = folder ? arena_printf(&arena, "%s/recent.json", folder) : NULL;
    bool ok = err->code == ERR_NONE;
    if (path) {
        char *text = text_of(recent);
        ok = text ? file_write_atomic(path, text, strlen(text), err)
                  : err_memory(err, "the list of recent scenes", FILE_MAX);
        json_release(text);
    }
    arena_finish(&arena);
    return ok;
}
