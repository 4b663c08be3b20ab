// Reads text formats (OBJ, MTL, PLY): words, numbers, lines, and messages that name the line.
// Numbers do not depend on the locale of the process.
#ifndef LAMPYRIS_SCENE_CORE_TEXT_H
#define LAMPYRIS_SCENE_CORE_TEXT_H

#include "base/err.h"
#include "base/file.h"
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

// A position in a text that ends with a NUL byte, which file_read appends.
struct text_reader {
    const char *at;   // the next character
    const char *end;  // the NUL byte after the last character
    const char *path; // for messages
    uint64_t line;    // line number of `at`, from 1
    bool joins_lines; // a backslash at the end of a line continues it (OBJ, MTL)
};

// A piece of the text; not NUL-terminated.
struct text_span {
    const char *data;
    size_t size;
};

struct text_reader text_open(const char *path, const struct file_bytes *bytes);
size_t text_remaining(const struct text_reader *text); // number of bytes up to the end

// Skips spaces, tabs and line continuations.
void text_skip_blanks(struct text_reader *text);
// Skips blanks and line ends.
void text_skip_space(struct text_reader *text);
// Skips blanks. Returns whether the line or the text ends there, or a comment (#) begins.
bool text_line_ended(struct text_reader *text);
// Moves to the next line. Skips continuations, too, unless the line is a comment. Lines end with
// LF, CR LF or CR.
void text_next_line(struct text_reader *text);

// Skips blanks and returns the next word of the line; empty at the line's end. A # inside a word is
// an ordinary character.
struct text_span text_word(struct text_reader *text);
// Returns the rest of the line without blanks around it, for names that may contain spaces. Does
// not advance.
struct text_span text_rest_of_line(const struct text_reader *text);
bool text_equals(struct text_span span, const char *word);
char *text_copy(struct arena *arena, struct text_span span); // NUL-terminated, or NULL
// Copies as much of the span as fits, NUL-terminated. Characters that are not printable become '?'.
void text_printable(struct text_span span, char *out, size_t size);

// Skips blanks and reads a number, correctly rounded to single precision like strtof(). "nan" and
// "inf" are numbers; a number that is too large becomes infinite. Returns false, without advancing,
// if the word is not a number.
bool text_take_float(struct text_reader *text, float *out);
// As text_take_float(), but rounds to double precision.
bool text_take_double(struct text_reader *text, double *out);
// As text_take_float(), but reads a decimal integer; values beyond int64_t saturate. Stops after
// the last digit, whatever follows; text_word_ended() checks what follows.
bool text_take_integer(struct text_reader *text, int64_t *out);
// Returns whether a blank, the end of the line or the end of the text follows.
bool text_word_ended(const struct text_reader *text);
// As the functions above, but fail with ERR_INPUT. The message names the place, the word found, and
// `what` as the expected one.
bool text_float(struct text_reader *text, const char *what, float *out, struct err *err);
bool text_double(struct text_reader *text, const char *what, double *out, struct err *err);
bool text_integer(struct text_reader *text, const char *what, int64_t *out, struct err *err);

// Parses the number at `at` in NUL-terminated text. Returns its end, or NULL if there is none.
const char *text_parse_float(const char *at, float *out);

// Sets "PATH:LINE: MESSAGE" as ERR_INPUT and returns false.
bool text_fail(const struct text_reader *text, struct err *err, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
// Sets "PATH:LINE: expected WHAT, found 'NEXT WORD'", with the word shortened and made printable.
// Returns false.
bool text_unexpected(const struct text_reader *text, const char *what, struct err *err);

#endif
