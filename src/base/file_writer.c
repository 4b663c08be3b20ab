#define _GNU_SOURCE // O_TMPFILE
#include "base/file.h"

#include "base/file_inputs.h"
#include "base/log.h"
#include <errno.h>
#include <fcntl.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

static bool fail(struct err *err, const char *path, const char *action)
{
    return err_set(err, ERR_OUTPUT, "%s: cannot %s: %s", path, action, strerror(errno));
}

// What stands at the path now.
enum target { TARGET_NONE, TARGET_REGULAR, TARGET_STREAM };

static bool target_examine(const char *path, enum target *target, mode_t *mode, struct err *err)
{
    struct stat status;
    *target = TARGET_NONE;
    *mode = 0;
    if (!*path)
        return err_set(err, ERR_OUTPUT, "the path of an output file is empty");
    if (stat(path, &status) != 0)
        return errno == ENOENT ? true : fail(err, path, "write");
    if (S_ISDIR(status.st_mode))
        return err_set(err, ERR_OUTPUT, "%s: is a folder; expected a file's path", path);
    if (S_ISBLK(status.st_mode) || S_ISSOCK(status.st_mode))
        return err_set(err, ERR_OUTPUT, "%s: is a block device or socket; expected a file's path",
                       path);
    if (access(path, W_OK) != 0)
        return fail(err, path, "write");
    *target = S_ISREG(status.st_mode) ? TARGET_REGULAR : TARGET_STREAM;
    *mode = status.st_mode & 07777;
    return true;
}

// The folder's part of a path, with its slash, has this length; 0 where the path is a bare name.
static int folder_length(const char *path)
{
    const char *slash = strrchr(path, '/');
    return slash ? (int)(slash + 1 - path) : 0;
}

enum { NAME_ATTEMPTS = 1000, NAME_BYTES = 64, BLOCK_BYTES = 1 << 16 };

// A short name of its own, so that a long name of the picture does not become too long, and so that
// two processes, or two writers of one, do not meet.
static bool temporary_path_allocate(struct file_writer *writer, struct err *err)
{
    size_t size = (size_t)folder_length(writer->path) + NAME_BYTES;
    writer->temporary_path = malloc(size);
    return writer->temporary_path ? true : err_memory(err, "a path", size);
}

static void temporary_path_print(struct file_writer *writer, int attempt)
{
    int folder = folder_length(writer->path);
    snprintf(writer->temporary_path, (size_t)folder + NAME_BYTES, "%.*s.lampyris-%ld-%d.tmp",
             folder, writer->path, (long)getpid(), attempt);
}

static void temporary_path_forget(struct file_writer *writer)
{
    free(writer->temporary_path);
    writer->temporary_path = NULL;
}

// Linux: the link by which a file without a name can be given one.
static void descriptor_path(int fd, char path[NAME_BYTES])
{
    snprintf(path, NAME_BYTES, "/proc/self/fd/%d", fd);
}

// A file without a name is gone when the process ends, in whatever way. Not every system and file
// system has them; whether the folder can be written to at all is for the others to say.
static bool unnamed_create(struct file_writer *writer, mode_t mode)
{
#ifdef O_TMPFILE
    int length = folder_length(writer->path);
    char *folder = length > 0 ? strndup(writer->path, (size_t)length) : strdup(".");
    if (folder)
        writer->fd = open(folder, O_RDWR | O_TMPFILE | O_CLOEXEC, mode);
    free(folder);
    char link[NAME_BYTES];
    descriptor_path(writer->fd, link);
    if (writer->fd >= 0 && access(link, F_OK) == 0)
        return true;
    if (writer->fd >= 0)
        close(writer->fd);
    writer->fd = -1;
#else
    (void)writer, (void)mode;
#endif
    return false;
}

static bool named_create(struct file_writer *writer, mode_t mode, struct err *err)
{
    if (!temporary_path_allocate(writer, err))
        return false;
    for (int i = 0; i < NAME_ATTEMPTS && writer->fd < 0; i++) {
        temporary_path_print(writer, i);
        int flags = O_RDWR | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC;
        writer->fd = open(writer->temporary_path, flags, mode);
        if (writer->fd < 0 && errno != EEXIST)
            break;
    }
    if (writer->fd >= 0)
        return true;
    fail(err, writer->path, "create a file in its folder");
    temporary_path_forget(writer); // not ours to remove
    return false;
}

static bool temporary_create(struct file_writer *writer, mode_t mode, struct err *err)
{
    mode_t wanted = mode ? mode : 0666;
    if (!unnamed_create(writer, wanted) && !named_create(writer, wanted, err))
        return false;
    // open() applied the umask; an older file's permissions are kept as they are.
    if (mode && fchmod(writer->fd, mode) != 0)
        return fail(err, writer->path, "keep its permissions");
    return true;
}

// Non-blocking while opening, because a pipe that nobody reads would block for ever; a picture is
// then written as slowly as the reader likes.
static bool stream_open(struct file_writer *writer, struct err *err)
{
    const char *path = writer->path;
    writer->fd = open(path, O_WRONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC);
    if (writer->fd < 0 && errno == ENXIO)
        return err_set(err, ERR_OUTPUT, "%s: is a pipe that nobody reads", path);
    if (writer->fd < 0)
        return fail(err, path, "open");
    int flags = fcntl(writer->fd, F_GETFL);
    if (flags < 0 || fcntl(writer->fd, F_SETFL, flags & ~O_NONBLOCK) < 0)
        return fail(err, path, "open");
    return true;
}

static bool writer_open(struct file_writer *writer, const char *path, struct err *err)
{
    *writer = (struct file_writer){.fd = -1};
    enum target target;
    mode_t mode;
    if (!target_examine(path, &target, &mode, err))
        return false;
    writer->direct = target == TARGET_STREAM;
    writer->path = writer->direct ? strdup(path) : file_target(path);
    writer->block = malloc(BLOCK_BYTES);
    bool ok = (writer->path && writer->block) || err_memory(err, "an output file", BLOCK_BYTES);
    if (ok && (writer->direct ? stream_open(writer, err) : temporary_create(writer, mode, err)))
        return true;
    file_writer_finish(writer);
    return false;
}

bool file_writer_open(struct file_writer *writer, const char *path, struct err *err)
{
    *writer = (struct file_writer){.fd = -1};
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

// Blocks are of the same size in writing and in reading back, but for the last.
static struct hash128 add_block(struct hash128 sum, const uint8_t *block, size_t size)
{
    const struct hash128 pair[2] = {sum, hash128_bytes(block, size)};
    return hash128_bytes(pair, sizeof pair);
}

static bool write_block(struct file_writer *writer, struct err *err)
{
    const uint8_t *bytes = writer->block;
    size_t size = writer->block_bytes;
    writer->sum = add_block(writer->sum, bytes, size);
    corrupt_if_due(writer->block, size);
    writer->block_bytes = 0;
    while (size > 0) {
        ssize_t written = write(writer->fd, bytes, size);
        if (written < 0 && errno == EINTR)
            continue;
        if (written < 0)
            return fail(err, writer->path, "write");
        bytes += written;
        size -= (size_t)written;
    }
    return true;
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

// Fills the block from the file, up to its end; false when reading fails.
static bool read_block(struct file_writer *writer, struct err *err)
{
    writer->block_bytes = 0;
    while (writer->block_bytes < BLOCK_BYTES) {
        ssize_t got = read(writer->fd, writer->block + writer->block_bytes,
                           BLOCK_BYTES - writer->block_bytes);
        if (got < 0 && errno == EINTR)
            continue;
        if (got < 0)
            return fail(err, writer->path, "read back");
        if (got == 0)
            break;
        writer->block_bytes += (size_t)got;
    }
    return true;
}

static bool verify(struct file_writer *writer, struct err *err)
{
    if (lseek(writer->fd, 0, SEEK_SET) != 0)
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
                   "%s: what was written does not read back as it was; nothing is replaced",
                   writer->path);
}

// --- the end -------------------------------------------------------------------------------------

// Makes the rename durable. The file is in place already, so a failure is no more than a warning;
// some file systems cannot sync a folder at all.
static void sync_folder(const char *path)
{
    int length = folder_length(path);
    char *folder = length > 0 ? strndup(path, (size_t)length) : strdup(".");
    int fd = folder ? open(folder, O_RDONLY | O_DIRECTORY | O_CLOEXEC) : -1;
    if (fd >= 0 && fsync(fd) != 0 && errno != EINVAL && errno != ENOTSUP)
        log_warn("%s: written, but its folder could not be synced: %s", path, strerror(errno));
    if (fd >= 0)
        close(fd);
    free(folder);
}

// rename() is what replaces an older file at one stroke, and it needs a name: the file has one of
// its own for the moment between.
static bool temporary_name(struct file_writer *writer, struct err *err)
{
    if (writer->temporary_path)
        return true;
    if (!temporary_path_allocate(writer, err))
        return false;
    char link[NAME_BYTES];
    descriptor_path(writer->fd, link);
    for (int i = 0; i < NAME_ATTEMPTS; i++) {
        temporary_path_print(writer, i);
        if (linkat(AT_FDCWD, link, AT_FDCWD, writer->temporary_path, AT_SYMLINK_FOLLOW) == 0)
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
    if (!temporary_name(writer, err))
        return false;
    if (rename(writer->temporary_path, writer->path) != 0)
        return fail(err, writer->path, "rename the temporary file");
    temporary_path_forget(writer);
    sync_folder(writer->path);
    return true;
}

bool file_writer_commit(struct file_writer *writer, struct err *err)
{
    bool ok = writer->block_bytes == 0 || write_block(writer, err);
    if (ok && !writer->direct)
        ok = (fsync(writer->fd) == 0 || fail(err, writer->path, "sync")) && verify(writer, err) &&
             replace_target(writer, err);
    int closed = close(writer->fd);
    writer->fd = -1;
    if (ok && closed != 0)
        ok = fail(err, writer->path, "close");
    file_writer_finish(writer);
    return ok;
}

void file_writer_finish(struct file_writer *writer)
{
    if (!writer || (!writer->path && !writer->block))
        return;
    if (writer->fd >= 0)
        close(writer->fd);
    if (writer->temporary_path)
        unlink(writer->temporary_path);
    free(writer->temporary_path);
    free(writer->path);
    free(writer->block);
    *writer = (struct file_writer){.fd = -1};
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
    mode_t mode;
    if (!target_examine(path, &target, &mode, err))
        return false;
    // Opening a pipe and closing it again would tell its reader that all is over.
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
    struct stat status;
    bool exists = stat(path, &status) == 0;
    if (exists && !S_ISREG(status.st_mode))
        return true;
    char *target = file_target(path);
    int length = target ? folder_length(target) : 0;
    if (target && !exists)
        target[length] = '\0';
    struct statvfs space;
    bool is_known =
        target && statvfs(exists || length > 0 ? target : ".", &space) == 0 && space.f_blocks > 0;
    free(target);
    if (!is_known || bytes / space.f_frsize < space.f_bavail)
        return true;
    return err_set(err, ERR_OUTPUT, "%s: may take %llu bytes, but its disk has only %llu left",
                   path, (unsigned long long)bytes,
                   (unsigned long long)space.f_bavail * space.f_frsize);
}
