#define _GNU_SOURCE // O_TMPFILE
#include "file.h"

#include "log.h"
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
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

enum { NAME_ATTEMPTS = 1000, NAME_BYTES = 64 };

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
        writer->fd = open(folder, O_WRONLY | O_TMPFILE | O_CLOEXEC, mode);
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
        int flags = O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC;
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

bool file_writer_open(struct file_writer *writer, const char *path, struct err *err)
{
    *writer = (struct file_writer){.fd = -1};
    enum target target;
    mode_t mode;
    if (!target_examine(path, &target, &mode, err))
        return false;
    // A link that leads nowhere has no real path and is replaced by the file.
    writer->path = target == TARGET_REGULAR ? realpath(path, NULL) : strdup(path);
    if (!writer->path)
        return fail(err, path, "resolve");
    writer->direct = target == TARGET_STREAM;
    if (writer->direct ? stream_open(writer, err) : temporary_create(writer, mode, err))
        return true;
    file_writer_finish(writer);
    return false;
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
    bool ok = writer->direct || fsync(writer->fd) == 0 || fail(err, writer->path, "sync");
    ok = ok && (writer->direct || replace_target(writer, err));
    int closed = close(writer->fd);
    writer->fd = -1;
    if (ok && closed != 0)
        ok = fail(err, writer->path, "close");
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

bool file_check_space(const char *path, uint64_t bytes, struct err *err)
{
    struct stat status;
    bool exists = stat(path, &status) == 0;
    if (exists && !S_ISREG(status.st_mode))
        return true;
    int length = folder_length(path);
    char *place = exists ? strdup(path) : length > 0 ? strndup(path, (size_t)length) : strdup(".");
    struct statvfs space;
    bool is_known = place && statvfs(place, &space) == 0 && space.f_blocks > 0;
    free(place);
    if (!is_known || bytes / space.f_frsize < space.f_bavail)
        return true;
    return err_set(err, ERR_OUTPUT, "%s: may take %llu bytes, but its disk has only %llu left",
                   path, (unsigned long long)bytes,
                   (unsigned long long)space.f_bavail * space.f_frsize);
}
