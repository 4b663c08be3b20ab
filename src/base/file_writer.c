#include "base/file.h"

#include "base/file_handle.h"
#include "base/file_inputs.h"
#include "base/log.h"
#include "base/memory.h"
#include "base/process.h"
#include <errno.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static bool fail(struct err *err, const char *path, const char *action)
{
    return err_set(err, ERR_OUTPUT, "%s: cannot %s: %s", path, action, strerror(errno));
}

// The kind of file that exists at the output's path.
enum target { TARGET_NONE, TARGET_REGULAR, TARGET_STREAM };

static bool target_examine(const char *path, enum target *target, unsigned *permissions,
                           struct err *err)
{
    struct file_status status;
    *target = TARGET_NONE;
    *permissions = 0;
    if (!*path)
        return err_set(err, ERR_OUTPUT, "the path of an output file is empty");
    if (!file_status(path, &status))
        return errno == ENOENT ? true : fail(err, path, "write");
    if (status.kind == FILE_FOLDER)
        return err_set(err, ERR_OUTPUT, "%s: is a folder; expected a file's path", path);
    if (status.kind == FILE_BLOCK_DEVICE || status.kind == FILE_SOCKET)
        return err_set(err, ERR_OUTPUT, "%s: is a block device or socket; expected a file's path",
                       path);
    if (!file_is_writable(path))
        return fail(err, path, "write");
    *target = status.kind == FILE_REGULAR ? TARGET_REGULAR : TARGET_STREAM;
    *permissions = status.permissions;
    return true;
}

// Returns the length of the folder part of a path, with its slash; 0 for a bare name.
static int folder_length(const char *path)
{
    return (int)(path_name(path) - path);
}

// Returns the folder of a path, allocated with malloc; NULL when out of memory.
static char *folder_of(const char *path)
{
    const size_t length = (size_t)folder_length(path);
    char *folder = malloc(length + 2);
    if (folder)
        snprintf(folder, length + 2, "%.*s", length > 0 ? (int)length : 1, length > 0 ? path : ".");
    return folder;
}

// Temporary files are named TEMPORARY_BEGIN, numbers, TEMPORARY_END.
#define TEMPORARY_BEGIN ".lampyris-"
#define TEMPORARY_END ".tmp"
enum { NAME_ATTEMPTS = 1000, NAME_BYTES = 64, BLOCK_BYTES = 1 << 16 };

// Allocates temporary_path. Temporary names are short, so that they fit even if the output's name
// is as long as the file system permits, and unique, so that processes and writers do not collide.
static bool temporary_path_allocate(struct file_writer *writer, struct err *err)
{
    size_t size = (size_t)folder_length(writer->path) + NAME_BYTES;
    writer->temporary_path = malloc(size);
    return writer->temporary_path ? true : err_memory(err, "a path", size);
}

static void temporary_path_print(struct file_writer *writer, int attempt)
{
    int folder = folder_length(writer->path);
    snprintf(writer->temporary_path, (size_t)folder + NAME_BYTES,
             "%.*s" TEMPORARY_BEGIN "%ld-%d" TEMPORARY_END, folder, writer->path,
             (long)process_id(), attempt);
}

bool file_is_temporary(const char *name)
{
    const size_t length = strlen(name), end = strlen(TEMPORARY_END);
    return strncmp(name, TEMPORARY_BEGIN, strlen(TEMPORARY_BEGIN)) == 0 && length > end &&
           strcmp(name + length - end, TEMPORARY_END) == 0;
}

static void temporary_path_forget(struct file_writer *writer)
{
    free(writer->temporary_path);
    writer->temporary_path = NULL;
}

static bool unnamed_create(struct file_writer *writer, unsigned permissions)
{
    char *folder = folder_of(writer->path);
    if (folder)
        writer->handle = file_handle_create_unnamed(folder, permissions);
    free(folder);
    return writer->handle >= 0;
}

static bool named_create(struct file_writer *writer, unsigned permissions, struct err *err)
{
    if (!temporary_path_allocate(writer, err))
        return false;
    for (int i = 0; i < NAME_ATTEMPTS && writer->handle < 0; i++) {
        temporary_path_print(writer, i);
        writer->handle = file_handle_create(writer->temporary_path, permissions);
        if (writer->handle < 0 && errno != EEXIST)
            break;
    }
    if (writer->handle >= 0)
        return true;
    fail(err, writer->path, "create a file in its folder");
    temporary_path_forget(writer); // the file of that name belongs to another writer
    return false;
}

static bool temporary_create(struct file_writer *writer, unsigned permissions, struct err *err)
{
    const unsigned wanted = permissions ? permissions : 0666;
    if (!unnamed_create(writer, wanted) && !named_create(writer, wanted, err))
        return false;
    // New files obey the umask. An existing file's permissions are copied.
    if (permissions && !file_handle_set_permissions(writer->handle, permissions))
        return fail(err, writer->path, "keep its permissions");
    return true;
}

static bool stream_open(struct file_writer *writer, struct err *err)
{
    writer->handle = file_handle_open_stream(writer->path);
    if (writer->handle < 0 && errno == ENXIO)
        return err_set(err, ERR_OUTPUT, "%s: is a pipe that nobody reads", writer->path);
    return writer->handle >= 0 || fail(err, writer->path, "open");
}

static bool writer_open(struct file_writer *writer, const char *path, struct err *err)
{
    *writer = (struct file_writer){.handle = -1};
    enum target target;
    unsigned permissions;
    if (!target_examine(path, &target, &permissions, err))
        return false;
    writer->direct = target == TARGET_STREAM;
    writer->path = writer->direct ? strdup(path) : file_target(path);
    writer->block = malloc(BLOCK_BYTES);
    bool ok = (writer->path && writer->block) || err_memory(err, "an output file", BLOCK_BYTES);
    if (ok &&
        (writer->direct ? stream_open(writer, err) : temporary_create(writer, permissions, err)))
        return true;
    file_writer_finish(writer);
    return false;
}

bool file_writer_open(struct file_writer *writer, const char *path, struct err *err)
{
    *writer = (struct file_writer){.handle = -1};
    return file_inputs_check(path, err) && writer_open(writer, path, err);
}

// --- the content ---------------------------------------------------------------------------------

static _Atomic uint64_t corrupt_countdown;

void file_corrupt_at(uint64_t n)
{
    atomic_store(&corrupt_countdown, n);
}

static void corrupt_if_due(uint8_t *block, size_t size)
{
    uint64_t n = atomic_load(&corrupt_countdown);
    if (n > 0 && n <= size)
        block[n - 1] ^= 0x10;
    if (n > 0)
        atomic_store(&corrupt_countdown, n <= size ? 0 : n - size);
}

// Adds a block to a hash. Blocks have the same size in writing and in reading back, except the
// last.
static struct hash128 add_block(struct hash128 sum, const uint8_t *block, size_t size)
{
    const struct hash128 pair[2] = {sum, hash128_bytes(block, size)};
    return hash128_bytes(pair, sizeof pair);
}

static bool write_block(struct file_writer *writer, struct err *err)
{
    const size_t size = writer->block_bytes;
    writer->sum = add_block(writer->sum, writer->block, size);
    corrupt_if_due(writer->block, size);
    writer->block_bytes = 0;
    return file_handle_write(writer->handle, writer->block, size) ||
           fail(err, writer->path, "write");
}

bool file_writer_write(struct file_writer *writer, const void *data, size_t size, struct err *err)
{
    const uint8_t *bytes = data;
    while (size > 0) {
        size_t room = BLOCK_BYTES - writer->block_bytes;
        size_t count = size < room ? size : room;
        memcpy(writer->block + writer->block_bytes, bytes, count);
        writer->block_bytes += count;
        bytes += count;
        size -= count;
        if (writer->block_bytes == BLOCK_BYTES && !write_block(writer, err))
            return false;
    }
    return true;
}

// Fills the block from the file, up to the file's end. Returns false when reading fails.
static bool read_block(struct file_writer *writer, struct err *err)
{
    const int64_t got = file_handle_read(writer->handle, writer->block, BLOCK_BYTES);
    writer->block_bytes = got > 0 ? (size_t)got : 0;
    return got >= 0 || fail(err, writer->path, "read back");
}

static bool verify(struct file_writer *writer, struct err *err)
{
    if (!file_handle_rewind(writer->handle))
        return fail(err, writer->path, "read back");
    struct hash128 sum = {0};
    do {
        if (!read_block(writer, err))
            return false;
        if (writer->block_bytes > 0)
            sum = add_block(sum, writer->block, writer->block_bytes);
    } while (writer->block_bytes == BLOCK_BYTES);
    return memcmp(&sum, &writer->sum, sizeof sum) == 0 ||
           err_set(err, ERR_OUTPUT,
                   "%s: the data read back differ from the data written; no file was replaced",
                   writer->path);
}

// --- the end -------------------------------------------------------------------------------------

// Makes the rename durable. The file is in place already, so a failure is only a warning.
static void sync_folder(const char *path)
{
    char *folder = folder_of(path);
    if (folder && !folder_sync(folder))
        log_warn("%s: written, but its folder could not be synced: %s", path, strerror(errno));
    free(folder);
}

// Names a file that was created without a name. It needs a temporary name for a moment, because
// replacing a file atomically means renaming another file over it.
static bool temporary_name(struct file_writer *writer, struct err *err)
{
    if (writer->temporary_path)
        return true;
    if (!temporary_path_allocate(writer, err))
        return false;
    for (int i = 0; i < NAME_ATTEMPTS; i++) {
        temporary_path_print(writer, i);
        if (file_handle_name(writer->handle, writer->temporary_path))
            return true;
        if (errno != EEXIST)
            break;
    }
    fail(err, writer->path, "name the temporary file");
    temporary_path_forget(writer);
    return false;
}

static bool replace_target(struct file_writer *writer, struct err *err)
{
    if (!file_rename(writer->temporary_path, writer->path))
        return fail(err, writer->path, "rename the temporary file");
    temporary_path_forget(writer);
    sync_folder(writer->path);
    return true;
}

bool file_writer_commit(struct file_writer *writer, struct err *err)
{
    bool ok = writer->block_bytes == 0 || write_block(writer, err);
    if (ok && !writer->direct)
        ok = (file_handle_sync(writer->handle) || fail(err, writer->path, "sync")) &&
             verify(writer, err) && temporary_name(writer, err);
    // The file is closed before the rename, because not every system can rename an open file over
    // another.
    const bool is_closed = file_handle_close(writer->handle);
    writer->handle = -1;
    if (ok && !is_closed)
        ok = fail(err, writer->path, "close");
    if (ok && !writer->direct)
        ok = replace_target(writer, err);
    file_writer_finish(writer);
    return ok;
}

void file_writer_finish(struct file_writer *writer)
{
    if (!writer || (!writer->path && !writer->block))
        return;
    if (writer->handle >= 0)
        file_handle_close(writer->handle);
    if (writer->temporary_path)
        file_remove(writer->temporary_path);
    free(writer->temporary_path);
    free(writer->path);
    free(writer->block);
    *writer = (struct file_writer){.handle = -1};
}

static bool write_all(struct file_writer *writer, const void *data, size_t size, struct err *err)
{
    if (file_writer_write(writer, data, size, err))
        return file_writer_commit(writer, err);
    file_writer_finish(writer);
    return false;
}

bool file_write_atomic(const char *path, const void *data, size_t size, struct err *err)
{
    struct file_writer writer;
    return file_writer_open(&writer, path, err) && write_all(&writer, data, size, err);
}

bool file_replace_atomic(const char *path, const void *data, size_t size, struct err *err)
{
    struct file_writer writer;
    return writer_open(&writer, path, err) && write_all(&writer, data, size, err);
}

bool file_check_writable(const char *path, struct err *err)
{
    enum target target;
    unsigned permissions;
    if (!target_examine(path, &target, &permissions, err))
        return false;
    // Opening a pipe and closing it again would signal the end to its reader.
    if (target == TARGET_STREAM)
        return true;
    struct file_writer writer;
    if (!file_writer_open(&writer, path, err))
        return false;
    file_writer_finish(&writer);
    return true;
}

bool file_check_space(const char *path, uint64_t bytes, struct err *err)
{
    struct file_status status;
    const bool exists = file_status(path, &status);
    if (exists && status.kind != FILE_REGULAR)
        return true;
    char *target = file_target(path);
    char *place = !target ? NULL : exists ? strdup(target) : folder_of(target);
    uint64_t left;
    const bool is_known = place && file_system_space(place, &left);
    free(place);
    free(target);
    if (!is_known || bytes < left)
        return true;
    return err_set(err, ERR_OUTPUT, "%s: needs up to %s, but its file system has only %s free",
                   path, memory_print(bytes).text, memory_print(left).text);
}
