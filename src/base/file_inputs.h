// The files that a run reads, so that it refuses to write over them.
#ifndef LAMPYRIS_BASE_FILE_INPUTS_H
#define LAMPYRIS_BASE_FILE_INPUTS_H

#include "base/err.h"
#include "base/thread.h"
#include <stddef.h>
#include <stdint.h>

// A set of paths. The caller's memory; to be zeroed, except for the mutex, which
// file_inputs_begin() makes.
struct file_inputs {
    struct mutex mutex;
    struct file_input *list;
    size_t count, capacity;
};

// From here on every file that file_read() opens is kept in `inputs`, and file_writer_open()
// refuses to replace one of them. One run at a time: the set is known to all of the program, as the
// log's sink is. Not thread-safe, in contrast to the functions below, which do nothing while there
// is no run.
void file_inputs_begin(struct file_inputs *inputs);
// Ends the run and frees the set. Accepts one that was never begun.
void file_inputs_end(struct file_inputs *inputs);

// Adds a file that will be read, so that the outputs can be checked before it is. Nothing happens
// for what is no regular file, or is not there.
bool file_inputs_add(const char *path, struct err *err);

// The same for a file that the run goes on with and replaces itself, under this path alone.
bool file_inputs_add_own(const char *path, struct err *err);

// This file is no input any more: nothing that the run may do needs what it held when it was read.
void file_inputs_forget(const char *path);

// ERR_USAGE where `output` is one of the inputs: under any name, for device and inode decide, and
// where there is a symbolic link, what it leads to.
bool file_inputs_check(const char *output, struct err *err);

// Whether two paths lead to the same regular file, which need not be there yet.
bool file_is_same(const char *a, const char *b);
// ERR_USAGE where two outputs do; NULL is none.
bool file_check_distinct(const char *a, const char *b, struct err *err);

#endif
