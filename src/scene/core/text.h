// Reading text formats (OBJ, MTL, PLY) by hand: words, numbers, lines, and messages that name the
// line. Numbers are independent of the process's locale.
#ifndef LAMPYRIS_SCENE_CORE_TEXT_H
#define LAMPYRIS_SCENE_CORE_TEXT_H

#include "base/err.h"
#include "base/file.h"
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

// A position in a text that ends with a NUL byte (file_read appends one).
struct text_reader {
    const char *at;   // the next character
    const char *end;  // the NUL byte after the last character
    const char *path; // for messages
    uint64_t line;    // of `at`, from 1
    bool joins_lines; // a backslash right before the end of a line continues it (OBJ, MTL)
};

// A piece of the text; not NUL-terminated.
struct text_span {
    const char *data;
    size_t size;
};

struct text_reader text_open(const char *path, const struct file_bytes *bytes);
size_t text_remaining(const struct text_reader *text); // bytes up to the end

// Skips spaces, tabs and continuations of the line.
void text_skip_blanks(struct text_reader *text);
// Skips blanks and ends of lines.
void text_skip_space(struct text_reader *text);
// Skips blanks; true at the end of the line or text, or where a comment (#) begins.
bool text_line_ended(struct text_reader *text);
// Moves behind the end of the line, over continuations too unless the line is a comment. Lines end
// with LF, CR LF or CR.
void text_next_line(struct text_reader *text);

// The next word of the line after blanks; empty at its end. A # is an ordinary character in it.
struct text_span text_word(struct text_reader *text);
// The rest of the line without blanks around it, as names with spaces in them need it; does not
// move.
struct text_span text_rest_of_line(const struct text_reader *text);
bool text_equals(struct text_span span, const char *word);
char *text_copy(struct arena *arena, struct text_span span); // NUL-terminated; NULL: no memory
// As much of the span as fits, NUL-terminated, what no terminal should see replaced by '?'.
void text_printable(struct text_span span, char *out, size_t size);

// The number after blanks, rounded correctly to single precision like strtof; "nan" and "inf" are
// numbers, and what is too large is infinite. False, and no move, where a word is anything else.
bool text_take_float(struct text_reader *text, float *out);
// The same rounded to double precision.
bool text_take_double(struct text_reader *text, double *out);
// The same for a decimal integer; values beyond int64_t saturate. Stops behind the last digit,
// whatever follows: see text_word_ended.
bool text_take_integer(struct text_reader *text, int64_t *out);
// True where a blank, the end of the line or of the text follows.
bool text_word_ended(const struct text_reader *text);
// The same three, with ERR_INPUT naming the place, what was found and `what` was expected.
bool text_float(struct text_reader *text, const char *what, float *out, struct err *err);
bool text_double(struct text_reader *text, const char *what, double *out, struct err *err);
bool text_integer(struct text_reader *text, const char *what, int64_t *out, struct err *err);

// The number at `at` in NUL-terminated text; returns its end, or NULL when there is none.
const char *text_parse_float(const char *at, float *out);

// "PATH:LINE: MESSAGE" as ERR_INPUT; returns false.
bool text_fail(const struct text_reader *text, struct err *err, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
// "PATH:LINE: expected WHAT, found 'NEXT WORD'", shortened and made printable; returns false.
bool text_unexpected(const struct text_reader *text, const char *what, struct err *err);

#endif
