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
    const uint8_t *data; // in the arena, followed by one NUL byte that `size` does not count
    size_t size;
};

// Reads a regular file of at most max_bytes (0: 4 GiB), as long as it was when it was opened.
// FIFOs, devices and folders are ERR_INPUT, and are never opened in a way that blocks. The file is
// kept as an input of this run (base/file_inputs.h). Of a file that does not exist err->is_missing
// says so; file_resolve() does the same.
bool file_read(struct arena *arena, const char *path, size_t max_bytes, struct file_bytes *out,
               struct err *err);
// Reads a file that the program itself wrote and continues: it is not recorded as an input.
bool file_read_own(struct arena *arena, const char *path, size_t max_bytes, struct file_bytes *out,
                   struct err *err);

// How to interpret a path that is written inside a file.
struct file_reference {
    const char *folder;  // folder of the file that names the path
    bool percent_decode; // decode %XX first, as URIs want it; a malformed escape or %00 is refused
    bool allow_outside;  // the path may lead anywhere
};

// Resolves `path`, found inside a file, relative to the working directory. Unless allow_outside is
// set, the result is a regular file under the folder, with symbolic links resolved; absolute paths,
// "..", schemes such as "file:" (also written as escapes) and files that are not regular are then
// rejected. With allow_outside nothing is checked, and errors occur when the file is read. On
// failure sets ERR_INPUT or ERR_SYSTEM and returns NULL; the result lives in the arena.
char *file_resolve(struct arena *arena, const struct file_reference *reference, const char *path,
                   struct err *err);

// Creates a folder unless it is there; its parent must be. ERR_OUTPUT.
bool file_make_folder(const char *path, struct err *err);

bool path_is_absolute(const char *path);
char *path_folder(struct arena *arena, const char *path);         // "a/b.c" -> "a", "b.c" -> "."
const char *path_extension(const char *path);                     // "a.PNG" -> "PNG", else ""
bool path_has_extension(const char *path, const char *extension); // without regard to case
const char *path_name(const char *path);                          // "a/b.c" -> "b.c"
// Makes "a/b.0012.c" of "a/b.c" and 12. NULL when out of memory.
char *path_numbered(struct arena *arena, const char *path, uint32_t number);
// Returns the number with which path_numbered() makes the file name `name` of the name of `path`; 0
// if there is none. Folders do not matter.
uint32_t path_number_of(const char *name, const char *path);

// Returns the file that writing to `path` creates or replaces: symbolic links are followed, whether
// or not their target exists. Allocated with malloc; NULL when out of memory.
char *file_target(const char *path);

// Atomic writing: a temporary file in the same folder, fsync, reading it back, rename, fsync of the
// folder. Until commit succeeds, an older file of that name stays intact; its permissions pass to
// the new one. A symbolic link is followed and kept, also one that leads to no file yet. A file
// that the user may not write is not replaced either, nor one that this run reads
// (base/file_inputs.h; ERR_USAGE).
//
// What the file holds when all of it is written is compared with what was to be written, by a hash
// of 128 bits: a difference is ERR_OUTPUT, and nothing is replaced.
//
// Where the system allows it, the temporary file has no name until the rename, so that nothing is
// left behind when the process is killed.
//
// Character devices and pipes (/dev/null, /dev/full, a shell's >(command)) cannot be renamed over:
// they are written to directly, so a failure may come after part of the data. Block devices and
// sockets are refused.
struct file_writer {
    int handle;           // -1 when closed
    char *path;           // what the rename replaces, symbolic links resolved; NULL when closed
    char *temporary_path; // NULL when it has no name
    bool direct;          // a device or pipe: there is no temporary file
    uint8_t *block;       // bytes that wait to be written
    size_t block_bytes;
    struct hash128 sum; // hash of the blocks before it
};

// Creates the temporary file: so an unwritable folder is found out before any work is done.
bool file_writer_open(struct file_writer *writer, const char *path, struct err *err);
// Data, and so errors, may be delayed until commit.
bool file_writer_write(struct file_writer *writer, const void *data, size_t size, struct err *err);
// Syncs, reads back and renames. On failure the temporary file is removed and the old file kept.
bool file_writer_commit(struct file_writer *writer, struct err *err);
// Removes the temporary file unless committed. Accepts {0}-like closed writers and NULL.
void file_writer_finish(struct file_writer *writer);

// Opens, writes and commits.
bool file_write_atomic(const char *path, const void *data, size_t size, struct err *err);
// Does the same but may replace an input, because that is intended.
bool file_replace_atomic(const char *path, const void *data, size_t size, struct err *err);

// For tests: changes one bit of the n-th byte that all writers together write from now on. 0 turns
// it off.
void file_corrupt_at(uint64_t n);

// Fails with ERR_OUTPUT when the file system of `path` has less than `bytes` free for this user.
// Returns true for devices and pipes, and if the free space is not known.
bool file_check_space(const char *path, uint64_t bytes, struct err *err);

// Finds out before rendering whether `path` could be written: its folder exists and is writable,
// and path itself is not a folder. Leaves nothing behind. ERR_OUTPUT. Of a device or pipe only the
// permission is checked: that /dev/full is full shows when it is written.
bool file_check_writable(const char *path, struct err *err);

#endif
