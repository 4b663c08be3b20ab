// Files: reading whole, writing atomically, and confining paths that come from inside files. Any
// thread may call, one at a time for one arena or writer.
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
// The same for a file that the program writes itself and goes on from: it is not kept as an input.
bool file_read_own(struct arena *arena, const char *path, size_t max_bytes, struct file_bytes *out,
                   struct err *err);

// How a path that stands inside a file is to be understood.
struct file_reference {
    const char *folder;  // of the file that names the path
    bool percent_decode; // decode %XX first, as URIs want it; a malformed escape or %00 is refused
    bool allow_outside;  // the path may lead anywhere
};

// The path that `path`, found inside a file, names as seen from the working directory. Unless
// allow_outside, that is a regular file under the folder, symbolic links resolved; refused are then
// absolute paths, "..", schemes such as "file:" (all of them written as escapes, too), and whatever
// is no regular file. With allow_outside nothing is looked up: reading the file will tell.
// ERR_INPUT or ERR_SYSTEM and NULL on failure; the result lives in the arena.
char *file_resolve(struct arena *arena, const struct file_reference *reference, const char *path,
                   struct err *err);

// Creates a folder unless it is there; its parent must be. ERR_OUTPUT.
bool file_make_folder(const char *path, struct err *err);

bool path_is_absolute(const char *path);
char *path_folder(struct arena *arena, const char *path);         // "a/b.c" -> "a", "b.c" -> "."
const char *path_extension(const char *path);                     // "a.PNG" -> "PNG", else ""
bool path_has_extension(const char *path, const char *extension); // without regard to case
const char *path_name(const char *path);                          // "a/b.c" -> "b.c"
// "a/b.c", 12 -> "a/b.0012.c". NULL when out of memory.
char *path_numbered(struct arena *arena, const char *path, uint32_t number);
// The number with which path_numbered() makes a file's name of the name of `path`; 0 where none
// does. Their folders do not matter.
uint32_t path_number_of(const char *name, const char *path);

// The file that writing to `path` makes or replaces: symbolic links are followed, whether or not
// there is a file at their end. From malloc; NULL when out of memory.
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
    uint8_t *block;       // what waits to be written
    size_t block_bytes;
    struct hash128 sum; // of the blocks before it
};

// Creates the temporary file: so an unwritable folder is found out before any work is done.
bool file_writer_open(struct file_writer *writer, const char *path, struct err *err);
// What is written may wait in memory until commit, and with it what goes wrong.
bool file_writer_write(struct file_writer *writer, const void *data, size_t size, struct err *err);
// Syncs, reads back and renames; on failure the temporary file is removed and the old one kept.
bool file_writer_commit(struct file_writer *writer, struct err *err);
// Removes the temporary file unless committed. Accepts {0}-like closed writers and NULL.
void file_writer_finish(struct file_writer *writer);

// Opens, writes, commits.
bool file_write_atomic(const char *path, const void *data, size_t size, struct err *err);
// The same where replacing an input is what is asked for.
bool file_replace_atomic(const char *path, const void *data, size_t size, struct err *err);

// For tests: one bit of the n-th byte that all writers together write from now on changes on its
// way to the file. 0 turns it off.
void file_corrupt_at(uint64_t n);

// ERR_OUTPUT when the file system on which `path` is to be written has less than `bytes` left for
// this user. True of devices and pipes, and where it cannot be known.
bool file_check_space(const char *path, uint64_t bytes, struct err *err);

// Finds out before rendering whether `path` could be written: its folder exists and is writable,
// and path itself is not a folder. Leaves nothing behind. ERR_OUTPUT. Of a device or pipe only the
// permission is checked: that /dev/full is full shows when it is written.
bool file_check_writable(const char *path, struct err *err);

#endif
