#include "file.h"

#include "log.h"
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
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

// A short name of its own, so that a long name of the picture does not become too long, and so that
// two processes, or two writers of one, do not meet.
static bool temporary_create(struct file_writer *writer, const char *path, mode_t mode,
                             struct err *err)
{
    enum { ATTEMPTS = 1000 };
    int folder = folder_length(path);
    size_t size = (size_t)folder + 64;
    writer->temporary_path = malloc(size);
    if (!writer->temporary_path)
        return err_memory(err, "a path", size);
    for (int i = 0; i < ATTEMPTS; i++) {
        snprintf(writer->temporary_path, size, "%.*s.lampyris-%ld-%d.tmp", folder, path,
                 (long)getpid(), i);
        int flags = O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC;
        writer->fd = open(writer->temporary_path, flags, mode ? mode : 0666);
        if (writer->fd >= 0 || errno != EEXIST)
            break;
    }
    if (writer->fd < 0) {
        fail(err, path, "create a file in its folder");
        free(writer->temporary_path); // not ours to remove
        writer->temporary_path = NULL;
        return false;
    }
    // open() applied the umask; an older file's permissions are kept as they are.
    if (mode && fchmod(writer->fd, mode) != 0)
        return fail(err, path, "keep its permissions");
    return true;
}

// Non-blocking while opening, because a pipe that nobody reads would block for ever; a picture is
// then written as slowly as the reader likes.
static bool stream_open(struct file_writer *writer, const char *path, struct err *err)
{
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

bool file_writer_open(struct file_writer *writer, const char *path, struct err *err)
{
    *writer = (struct file_writer){.fd = -1};
    enum target target;
    mode_t mode;
    if (!target_examine(path, &target, &mode, err))
        return false;
    // A link that leads nowhere has no real path and is replaced by the file.
    writer->path = target == TARGET_REGULAR ? realpath(path, NULL) : strdup(path);
    bool ok = writer->path ? true : fail(err, path, "resolve");
    if (ok)
        ok = target == TARGET_STREAM ? stream_open(writer, path, err)
                                     : temporary_create(writer, writer->path, mode, err);
    if (!ok)
        file_writer_finish(writer);
    return ok;
}

bool file_writer_write(struct file_writer *writer, const void *data, size_t size, struct err *err)
{
    const char *bytes = data;
    while (size > 0) {
        // Linux writes at most 0x7ffff000 bytes at once; the loop handles that and signals alike.
        ssize_t written = write(writer->fd, bytes, size < SSIZE_MAX ? size : SSIZE_MAX);
        if (written < 0 && errno == EINTR)
            continue;
        if (written < 0)
            return fail(err, writer->path, "write");
        bytes += written;
        size -= (size_t)written;
    }
    return true;
}

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

bool file_writer_commit(struct file_writer *writer, struct err *err)
{
    bool ok = true;
    if (writer->temporary_path && fsync(writer->fd) != 0)
        ok = fail(err, writer->path, "sync");
    int closed = close(writer->fd);
    writer->fd = -1;
    if (ok && closed != 0)
        ok = fail(err, writer->path, "close");
    if (ok && writer->temporary_path) {
        ok = rename(writer->temporary_path, writer->path) == 0;
        if (ok) {
            free(writer->temporary_path);
            writer->temporary_path = NULL;
            sync_folder(writer->path);
        } else {
            fail(err, writer->path, "rename the temporary file");
        }
    }
    file_writer_finish(writer);
    return ok;
}

void file_writer_finish(struct file_writer *writer)
{
    if (!writer || !writer->path)
        return;
    if (writer->fd >= 0)
        close(writer->fd);
    if (writer->temporary_path)
        unlink(writer->temporary_path);
    free(writer->temporary_path);
    free(writer->path);
    *writer = (struct file_writer){.fd = -1};
}

bool file_write_atomic(const char *path, const void *data, size_t size, struct err *err)
{
    struct file_writer writer;
    if (!file_writer_open(&writer, path, err))
        return false;
    if (!file_writer_write(&writer, data, size, err)) {
        file_writer_finish(&writer);
        return false;
    }
    return file_writer_commit(&writer, err);
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
