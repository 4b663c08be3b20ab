// Records the files that a run reads, so that it does not overwrite them.
#ifndef LAMPYRIS_BASE_FILE_INPUTS_H
#define LAMPYRIS_BASE_FILE_INPUTS_H

#include "base/err.h"
#include "base/thread.h"
#include <stddef.h>
#include <stdint.h>

// A set of paths in the caller's memory, which must be zeroed before file_inputs_begin(); that
// function initialises the mutex.
struct file_inputs {
    struct mutex mutex;
    struct file_input *list;
    size_t count, capacity;
};

// Starts recording every file that file_read() opens; file_writer_open() then refuses to replace
// any of them. There is one run at a time, because the current set is global, like the log's sink.
// This function and file_inputs_end() are not thread-safe; the functions below are, and do nothing
// without a run.
void file_inputs_begin(struct file_inputs *inputs);
// Ends the run and frees the set. Accepts a run that was never begun.
void file_inputs_end(struct file_inputs *inputs);

// Adds a file that will be read, so that outputs can be checked before it is read. Does nothing if
// there is no regular file at the path.
bool file_inputs_add(const char *path, struct err *err);

// Records a file that the run itself continues and replaces. Only this path may be used to replace
// it.
bool file_inputs_add_own(const char *path, struct err *err);

// Removes a file from the inputs once the run no longer needs its former contents.
void file_inputs_forget(const char *path);

// Fails with ERR_USAGE if `output` is one of the inputs, under any name: device and inode are
// compared, and symbolic links are followed.
bool file_inputs_check(const char *output, struct err *err);

// Returns whether two paths lead to the same regular file. The file need not exist yet.
bool file_is_same(const char *a, const char *b);
// Fails with ERR_USAGE if two outputs are the same file. A path may be NULL: no file.
bool file_check_distinct(const char *a, const char *b, struct err *err);

#endif
