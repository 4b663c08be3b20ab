// Files: reads whole files, writes atomically, and confines paths that come from inside files. Any
// thread may call, but only one at a time for the same arena or writer.
#ifndef LAMPYRIS_BASE_FILE_H
#define LAMPYRIS_BASE_FILE_H

#include "base/arena.h"
#include "base/err.h"
#include "base/hash.h"
#include <stddef.h>
#include <stdint.h>

struct file_bytes {
    const uint8_t *data; // owned by the arena; followed by a NUL byte that `size` does not count
    size_t size;
};

// Reads a regular file of at most max_bytes (0 means 4 GiB). Data that are appended after the file
// was opened are not read. FIFOs, devices and folders are ERR_INPUT, and opening them never blocks.
// Records the file as an input of this run (base/file_inputs.h). If the file does not exist, this
// function and file_resolve() set err->is_missing.
bool file_read(struct arena *arena, const char *path, size_t max_bytes, struct file_bytes *out,
               struct err *err);
// Reads a file that the program itself wrote and continues. Unlike file_read(), it does not record
// the file as an input.
bool file_read_own(struct arena *arena, const char *path, size_t max_bytes, struct file_bytes *out,
                   struct err *err);

// The rules by which a path that is written inside a file is interpreted.
struct file_reference {
    const char *folder;  // folder of the file that contains the path
    bool percent_decode; // decode %XX first, as in URIs; a malformed escape or %00 is refused
    bool allow_outside;  // the path may lead out of the folder
};

// Resolves `path`, found inside a file, relative to the working directory. Unless allow_outside is
// set, the result is a regular file under the folder, with symbolic links resolved; absolute paths,
// "..", schemes such as "file:" (also when escaped) and files that are not regular are rejected.
// With allow_outside nothing is checked here; reading the file reports errors. On failure sets
// ERR_INPUT or ERR_SYSTEM and returns NULL. The arena owns the result.
char *file_resolve(struct arena *arena, const struct file_reference *reference, const char *path,
                   struct err *err);

// Creates a folder unless it exists. Its parent must exist. Fails with ERR_OUTPUT.
bool file_make_folder(const char *path, struct err *err);

bool path_is_absolute(const char *path);
char *path_folder(struct arena *arena, const char *path);         // "a/b.c" -> "a", "b.c" -> "."
const char *path_extension(const char *path);                     // "a.PNG" -> "PNG", else ""
bool path_has_extension(const char *path, const char *extension); // case-insensitive
const char *path_name(const char *path);                          // "a/b.c" -> "b.c"
// Turns "a/b.c" and 12 into "a/b.0012.c". Returns NULL when out of memory.
char *path_numbered(struct arena *arena, const char *path, uint32_t number);
// Returns the number for which path_numbered() turns the file name of `path` into `name`; 0 if
// there is none. Folders do not matter.
uint32_t path_number_of(const char *name, const char *path);

// Returns the file that writing to `path` creates or replaces: symbolic links are followed, whether
// or not their target exists. Allocated with malloc; NULL when out of memory.
char *file_target(const char *path);

// Writes a file atomically: a temporary file in the same folder, fsync, reading it back, rename,
// fsync of the folder. Until commit succeeds, an older file of that name stays intact; its
// permissions pass to the new one. A symbolic link is followed and kept, even if its target does
// not exist yet. A file is not replaced if the user may not write it, or if this run reads it
// (base/file_inputs.h; ERR_USAGE).
//
// Before the rename, the file is read back and compared with the data written, by a 128-bit hash.
// If they differ, commit fails with ERR_OUTPUT and nothing is replaced.
//
// Where the system allows it, the temporary file has no name until the rename, so that nothing is
// left behind when the process is killed.
//
// Character devices and pipes (/dev/null, /dev/full, a shell's >(command)) cannot be replaced by
// renaming. They are written to directly, so that a failure may leave part of the data written.
// Block devices and sockets are refused.
struct file_writer {
    int handle;           // -1 when closed
    char *path;           // the file to replace, symbolic links resolved; NULL when closed
    char *temporary_path; // NULL when it has no name
    bool direct;          // writes directly to a device or pipe, without a temporary file
    uint8_t *block;       // buffered bytes, not yet written
    size_t block_bytes;
    struct hash128 sum; // hash of the blocks already written
};

// Creates the temporary file, so that an unwritable folder is reported before any work is done.
bool file_writer_open(struct file_writer *writer, const char *path, struct err *err);
// May buffer data; errors of writing them are then reported by a later call or by commit.
bool file_writer_write(struct file_writer *writer, const void *data, size_t size, struct err *err);
// Syncs, reads back and renames. On failure the temporary file is removed and the old file kept.
bool file_writer_commit(struct file_writer *writer, struct err *err);
// Removes the temporary file unless it was committed. Accepts NULL and closed writers.
void file_writer_finish(struct file_writer *writer);

// Returns whether `name`, without its folder, is that of a writer's temporary file.
bool file_is_temporary(const char *name);

// Opens a writer, writes the data and commits.
bool file_write_atomic(const char *path, const void *data, size_t size, struct err *err);
// As file_write_atomic(), but may replace an input of this run.
bool file_replace_atomic(const char *path, const void *data, size_t size, struct err *err);

// For tests: flips one bit of the n-th byte from now on, counted over all writers. 0 turns it off.
void file_corrupt_at(uint64_t n);

// Fails with ERR_OUTPUT when the file system of `path` has less than `bytes` free for this user.
// Returns true for devices and pipes, and if the free space is not known.
bool file_check_space(const char *path, uint64_t bytes, struct err *err);

// Checks before rendering whether `path` could be written: its folder exists and is writable, and
// `path` itself is not a folder. Leaves nothing behind. Fails with ERR_OUTPUT. For a device or pipe
// only the permission is checked; a full device such as /dev/full is only noticed when it is
// written.
bool file_check_writable(const char *path, struct err *err);

#endif
