#include "cli/tune_cache.h"

#include "base/file.h"
#include "base/log.h"
#include "cli/options.h"
#include "render/kernels.h"
#include "report/json_out.h"
#include "json/json_parse.h"
#include <errno.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#define FORMAT_VERSION 1
#define MOST_BYTES (1u << 20)
#define MOST_DEVICES 64 // drivers of long ago go first

// --- where ---------------------------------------------------------------------------------------

// The XDG Base Directory Specification, 0.8: a path that is not absolute is to be ignored.
static bool find_place(struct tune_cache *cache, struct err *err)
{
    const char *base = getenv("XDG_CACHE_HOME"), *home = getenv("HOME");
    if (base && *base == '/')
        cache->path = arena_printf(&cache->arena, "%s/lampyris/tuning.json", base);
    else if (home && *home == '/')
        cache->path = arena_printf(&cache->arena, "%s/.cache/lampyris/tuning.json", home);
    else
        return err_set(err, ERR_OUTPUT,
                       "no folder for what is found: expected an absolute path in XDG_CACHE_HOME "
                       "or HOME");
    return cache->path || err_memory(err, "a path", 0);
}

// All folders of the path that are not there yet; as the specification asks for, for the user
// alone.
static bool make_folders(const char *path, struct err *err)
{
    char *folder = strdup(path);
    if (!folder)
        return err_memory(err, "a path", strlen(path));
    bool ok = true;
    for (char *end = strchr(folder + 1, '/'); ok && end; end = strchr(end + 1, '/')) {
        *end = '\0';
        if (mkdir(folder, 0700) != 0 && errno != EEXIST)
            ok = err_set(err, ERR_OUTPUT, "%s: cannot be made a folder: %s", folder,
                         strerror(errno));
        *end = '/';
    }
    free(folder);
    return ok;
}

// --- reading -------------------------------------------------------------------------------------

// A number in the range of the option, or null.
static bool read_size(const json_t *entry, enum option_id option, uint32_t *out)
{
    const struct option_def *def = &option_table[option];
    const json_t *value = json_object_get(entry, def->name);
    double number = (double)json_integer_value(value);
    *out = 0;
    if (json_is_null(value))
        return true;
    if (!json_is_integer(value) || number < def->min || number > def->max)
        return false;
    *out = (uint32_t)number;
    return true;
}

static bool read_tuned(const json_t *entry, struct tuned *out)
{
    return read_size(entry, OPTION_WAVE, &out->wave) &&
           read_size(entry, OPTION_WORKGROUP, &out->workgroup) &&
           (out->workgroup & (out->workgroup - 1)) == 0;
}

static const char *text_of(const json_t *entry, const char *key)
{
    return json_string_value(json_object_get(entry, key));
}

static bool is_valid(const json_t *entry)
{
    struct tuned tuned;
    return text_of(entry, "device") && text_of(entry, "driver") && text_of(entry, "kernels") &&
           read_tuned(entry, &tuned);
}

// The list in the file, new; NULL with what is wrong in *err.
static json_t *parse(const struct file_bytes *bytes, const char *path, struct err *err)
{
    json_t *root = json_parse(path, bytes, JSON_REJECT_DUPLICATES, err);
    json_t *devices = json_object_get(root, "devices"), *entry;
    size_t i;
    if (root && (json_integer_value(json_object_get(root, "version")) != FORMAT_VERSION ||
                 !json_is_array(devices)))
        err_set(err, ERR_INPUT, "%s: expected {\"version\": %d, \"devices\": [...]}", path,
                FORMAT_VERSION);
    json_array_foreach(devices, i, entry)
    {
        if (err->code == ERR_NONE && !is_valid(entry))
            err_set(err, ERR_INPUT,
                    "%s: devices[%zu]: expected device, driver and kernels as text, wave in [64, "
                    "2^24] and workgroup a power of two in [8, 1024], or null",
                    path, i);
    }
    devices = err->code == ERR_NONE ? json_incref(devices) : NULL;
    json_decref(root);
    return devices;
}

static void read_file(struct tune_cache *cache)
{
    struct stat status;
    struct file_bytes bytes;
    struct err err = {0};
    if (stat(cache->path, &status) != 0 && (errno == ENOENT || errno == ENOTDIR))
        return;
    if (file_read_own(&cache->arena, cache->path, MOST_BYTES, &bytes, &err))
        cache->devices = parse(&bytes, cache->path, &err);
    if (!cache->devices)
        log_warn("%s; the file is ignored, and \"lampyris bench --tune\" will replace it", err.msg);
}

void tune_cache_load(struct tune_cache *out)
{
    struct err err = {0};
    *out = (struct tune_cache){0};
    if (find_place(out, &err))
        read_file(out);
    else
        log_info("tuning: %s", err.msg);
}

void tune_cache_finish(struct tune_cache *cache)
{
    file_lock_release(&cache->lock);
    json_decref(cache->devices);
    arena_finish(&cache->arena);
    *cache = (struct tune_cache){0};
}

json_t *tuned_size_json(uint32_t size)
{
    return size ? json_integer(size) : json_null();
}

// --- looking up and keeping ----------------------------------------------------------------------

static void print_hash(const struct gpu *gpu, char out[20])
{
    snprintf(out, 20, "%016" PRIx64, kernels_hash(gpu->has_ballot));
}

// Bytes of names that are no UTF-8 are written as '?', and so compared.
static bool same_words(const char *kept, const char *words)
{
    json_t *written = json_words(words);
    const char *text = json_string_value(written);
    bool same = kept && text && strcmp(kept, text) == 0;
    json_decref(written);
    return same;
}

static bool is_of_device(const json_t *entry, const struct gpu *gpu)
{
    return same_words(text_of(entry, "device"), gpu->info.name) &&
           same_words(text_of(entry, "driver"), gpu->info.driver);
}

struct tuned tune_cache_find(const struct tune_cache *cache, const struct gpu *gpu)
{
    json_t *entry;
    size_t i;
    char hash[20];
    json_array_foreach(cache->devices, i, entry)
    {
        struct tuned tuned;
        if (!is_of_device(entry, gpu) || !read_tuned(entry, &tuned))
            continue;
        print_hash(gpu, hash);
        if (strcmp(text_of(entry, "kernels"), hash) == 0 && tuned.workgroup <= gpu->max_invocations)
            return tuned;
    }
    return (struct tuned){0};
}

bool tune_cache_open(struct tune_cache *out, struct err *err)
{
    *out = (struct tune_cache){0};
    if (!find_place(out, err) || !make_folders(out->path, err) ||
        !file_lock_take(&out->lock, out->path, err) || !file_check_writable(out->path, err))
        return false;
    read_file(out);
    return true;
}

static bool write_file(const struct tune_cache *cache, struct err *err)
{
    json_t *root = json_pack("{s:i, s:O}", "version", FORMAT_VERSION, "devices", cache->devices);
    char *text = json_to_text(root, JSON_INDENT(2) | JSON_REAL_PRECISION(6), err);
    bool ok = text && file_write_atomic(cache->path, text, strlen(text), err);
    json_release(text);
    return ok;
}

bool tune_cache_keep(struct tune_cache *cache, const struct gpu *gpu, struct tuned tuned,
                     json_t *about, struct err *err)
{
    char hash[20];
    print_hash(gpu, hash);
    if (!cache->devices)
        cache->devices = json_array();
    for (size_t i = json_array_size(cache->devices); i-- > 0;)
        if (is_of_device(json_array_get(cache->devices, i), gpu))
            json_array_remove(cache->devices, i);
    while (json_array_size(cache->devices) >= MOST_DEVICES)
        json_array_remove(cache->devices, 0);
    json_t *entry =
        json_pack("{s:o, s:o, s:s, s:o, s:o}", "device", json_words(gpu->info.name), "driver",
                  json_words(gpu->info.driver), "kernels", hash, "wave",
                  tuned_size_json(tuned.wave), "workgroup", tuned_size_json(tuned.workgroup));
    bool ok = entry && about && json_object_update_missing(entry, about) == 0 &&
              json_array_append(cache->devices, entry) == 0;
    json_decref(entry);
    json_decref(about);
    return ok ? write_file(cache, err) : err_memory(err, "what was found", 0);
}
