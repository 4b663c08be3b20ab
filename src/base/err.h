// The only error type. The function that detects a problem fills it in, callers prepend context,
// and only the program prints it and exits.
#ifndef LAMPYRIS_BASE_ERR_H
#define LAMPYRIS_BASE_ERR_H

#include <stdbool.h>

// The cause of an error. cli/exit_code.c maps a code to the exit code in brackets.
enum err_code {
    ERR_NONE = 0,
    ERR_USAGE,     // the command line is wrong [2]
    ERR_INPUT,     // a file that the user gave is wrong or unreadable [2]
    ERR_BUDGET,    // the memory budget is too small, see memory.h [2]
    ERR_SYSTEM,    // memory, threads or the operating system failed [3]
    ERR_GPU,       // the device or its driver failed [3]
    ERR_NO_VULKAN, // there is no Vulkan loader or no driver [69]
    ERR_OUTPUT,    // a file could not be written [4]
    ERR_STOPPED,   // struct progress.should_stop asked to stop [128 + signal]
    ERR_BUG,       // an error in this program [3]
};

struct err {
    enum err_code code;
    bool is_missing; // the file of an ERR_INPUT does not exist
    char msg[512];
    // The document that is wrong, and the place in it as a JSON pointer (RFC 6901) such as
    // "/materials/white/roughness", for programs that read errors; `msg` says the same to people.
    // "" if there is none.
    char file[256], place[128];
};

// Fills in *err (if not NULL) and returns false, so that `return err_set(err, …);` reads well. A
// message names the thing, the value and what was expected: "cornell.json: materials[3].roughness:
// 1.7 is outside [0, 1]". The arguments may include err->msg. Invisible and direction-changing
// characters (base/printable.h), which may come from a file's name or content, become '?', so that
// a message is one line and cannot manipulate a terminal or mislead its reader.
bool err_set(struct err *err, enum err_code code, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

// Prepends context to the message, "CONTEXT: MESSAGE", and keeps the code; returns false.
bool err_prepend(struct err *err, const char *format, ...) __attribute__((format(printf, 2, 3)));

// Sets the file and the place unless they are already set. If documents refer to each other, the
// one in which the problem was found is thus kept. Sets nothing if `file` is too long, and omits a
// `place` that is too long.
void err_locate(struct err *err, const char *file, const char *place);

// Reports that memory for `what` could not be allocated. Sets ERR_BUDGET, with the bytes that are
// needed and left, if the budget refused it; otherwise sets ERR_SYSTEM. Returns false.
bool err_memory(struct err *err, const char *what, unsigned long long bytes);

// Shows compilers and analysers, in every file, that the value is always false. Otherwise they
// would assume that a failure may return true, and warn of uninitialised variables. (git's error()
// does the same.)
static inline bool err_false(void)
{
    return false;
}
#define err_set(...) (err_set(__VA_ARGS__), err_false())
#define err_prepend(...) (err_prepend(__VA_ARGS__), err_false())
#define err_memory(...) (err_memory(__VA_ARGS__), err_false())

#endif
