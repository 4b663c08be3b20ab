#include "base/file.h"

#include "base/file_handle.h"
#include "base/file_inputs.h"
#include <errno.h>
#include <stdlib.h>
#include <string.h>

static const char *const kind_names[] = {
    [FILE_REGULAR] = "a regular file",
    [FILE_FOLDER] = "a folder",
    [FILE_PIPE] = "a pipe",
    [FILE_CHARACTER_DEVICE] = "a character device",
    [FILE_BLOCK_DEVICE] = "a block device",
    [FILE_SOCKET] = "a socket",
};

static bool read_opened(struct arena *arena, int handle, const char *path, size_t max_bytes,
                        struct file_bytes *out, struct err *err)
{
    struct file_status status;
    if (!file_handle_status(handle, &status))
        return err_set(err, ERR_INPUT, "%s: %s", path, strerror(errno));
    if (status.kind != FILE_REGULAR)
        return err_set(err, ERR_INPUT, "%s: is %s; expected a regular file", path,
                       kind_names[status.kind]);
    if (status.size > max_bytes)
        return err_set(err, ERR_INPUT, "%s: is %ju bytes long; expected at most %zu", path,
                       (uintmax_t)status.size, max_bytes);
    size_t size = (size_t)status.size;
    uint8_t *data = arena_alloc(arena, size + 1, 1);
    if (!data) {
        err_memory(err, "the file's content", (unsigned long long)size + 1);
        return err_prepend(err, "%s", path);
    }
    const int64_t got = file_handle_read(handle, data, size);
    if (got < 0)
        return err_set(err, ERR_INPUT, "%s: %s", path, strerror(errno));
    data[got] = '\0';
    *out = (struct file_bytes){data, (size_t)got};
    return true;
}

static bool fail_to_open(const char *path, int error, struct err *err)
{
    err_set(err, ERR_INPUT, "%s: %s", path, strerror(error));
    if (err)
        err->is_missing = error == ENOENT || error == ENOTDIR;
    return false;
}

bool file_read(struct arena *arena, const char *path, size_t max_bytes, struct file_bytes *out,
               struct err *err)
{
    return file_inputs_add(path, err) && file_read_own(arena, path, max_bytes, out, err);
}

bool file_read_own(struct arena *arena, const char *path, size_t max_bytes, struct file_bytes *out,
                   struct err *err)
{
    const int handle = file_handle_open(path);
    if (handle < 0)
        return fail_to_open(path, errno, err);
    size_t limit = max_bytes > 0 ? max_bytes : (size_t)1 << 32;
    bool ok = read_opened(arena, handle, path, limit, out, err);
    file_handle_close(handle);
    return ok;
}

static int hex_digit(char c)
{
    return c >= '0' && c <= '9'   ? c - '0'
           : c >= 'a' && c <= 'f' ? c - 'a' + 10
           : c >= 'A' && c <= 'F' ? c - 'A' + 10
                                  : -1;
}

// Decodes %XX in place (RFC 3986, 2.1). Returns false for a malformed escape and for %00.
static bool decode_escapes(char *text)
{
    char *to = text;
    for (const char *from = text; *from; from++) {
        if (*from != '%') {
            *to++ = *from;
            continue;
        }
        int high = hex_digit(from[1]);
        int low = high >= 0 ? hex_digit(from[2]) : -1;
        if (low < 0 || high + low == 0)
            return false;
        *to++ = (char)(high * 16 + low);
        from += 2;
    }
    *to = '\0';
    return true;
}

// Returns whether a path begins with a scheme (RFC 3986, 3.1): a letter, then letters, digits, "+",
// "-" and ".", up to a colon.
static bool has_scheme(const char *path)
{
    static const char letters[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ";
    size_t length = strspn(path, "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ"
                                 "0123456789+-.");
    return *path && strchr(letters, *path) && path[length] == ':';
}

static bool has_parent_component(const char *path)
{
    for (const char *part = path;; part++) {
        const size_t length = strcspn(part, PATH_SEPARATORS);
        if (length == 2 && part[0] == '.' && part[1] == '.')
            return true;
        part += length;
        if (!*part)
            return false;
    }
}

// Returns what is wrong with a decoded path that was found inside a file, or NULL.
static const char *path_objection(const char *path)
{
    if (!*path)
        return "is empty";
    if (path_is_absolute(path))
        return "is absolute";
    if (has_scheme(path))
        return "has a scheme";
    if (has_parent_component(path))
        return "contains \"..\"";
    return NULL;
}

static bool is_under(const char *path, const char *folder)
{
    size_t length = strlen(folder);
    if (length > 0 && folder[length - 1] == '/') // the folder is "/" itself
        length--;
    return strncmp(path, folder, length) == 0 && path[length] == '/';
}

// Returns the path with symbolic links resolved, in the arena. On failure returns NULL and sets
// *err.
static char *real_path(struct arena *arena, const char *path, struct err *err)
{
    char *resolved = file_real_path(path);
    if (!resolved && errno == ENOMEM) {
        err_memory(err, "a path", strlen(path));
        return NULL;
    }
    if (!resolved) {
        fail_to_open(path, errno, err);
        return NULL;
    }
    char *copy = arena_strdup(arena, resolved);
    if (!copy)
        err_memory(err, "a path", strlen(resolved) + 1);
    free(resolved);
    return copy;
}

// Returns the regular file to which `joined` leads, which must be under `folder`. `joined` is the
// decoded path with the folder prepended; `written` is the path for messages. On failure returns
// NULL and sets *err.
static char *resolve_inside(struct arena *arena, const char *folder, const char *joined,
                            const char *written, struct err *err)
{
    char *base = real_path(arena, folder, err);
    char *path = base ? real_path(arena, joined, err) : NULL;
    if (!path)
        return NULL;
    if (!is_under(path, base)) {
        err_set(err, ERR_INPUT,
                "path \"%s\" leads out of the file's folder %s, which needs --allow-outside-paths",
                written, base);
        return NULL;
    }
    if (!file_is_regular(path)) {
        err_set(err, ERR_INPUT, "%s: is not a regular file", path);
        return NULL;
    }
    return path;
}

char *file_resolve(struct arena *arena, const struct file_reference *reference, const char *path,
                   struct err *err)
{
    char *decoded = arena_strdup(arena, path);
    if (!decoded) {
        err_memory(err, "a path", strlen(path) + 1);
        return NULL;
    }
    if (reference->percent_decode && !decode_escapes(decoded)) {
        err_set(err, ERR_INPUT, "path \"%s\" has a malformed %%XX escape, or %%00", path);
        return NULL;
    }
    const char *objection = reference->allow_outside ? NULL : path_objection(decoded);
    if (objection) {
        err_set(err, ERR_INPUT,
                "path \"%s\" %s; expected one relative to the file's folder, or "
                "--allow-outside-paths",
                path, objection);
        return NULL;
    }
    if (path_is_absolute(decoded))
        return decoded;
    char *joined = arena_printf(arena, "%s/%s", reference->folder, decoded);
    if (!joined) {
        err_memory(err, "a path", strlen(reference->folder) + strlen(decoded) + 2);
        return NULL;
    }
    return reference->allow_outside ? joined
                                    : resolve_inside(arena, reference->folder, joined, path, err);
}

bool file_make_folder(const char *path, struct err *err)
{
    struct file_status status;
    if (folder_create(path))
        return true;
    int reason = errno;
    if (reason == EEXIST && file_status(path, &status) && status.kind == FILE_FOLDER)
        return true;
    return err_set(err, ERR_OUTPUT, "%s: cannot create this folder: %s", path, strerror(reason));
}
