// Lays out help, either as text for a terminal of 80 columns or as a manual page in roff (man(7)).
// All text is ASCII.
#ifndef LAMPYRIS_CLI_HELP_WRITER_H
#define LAMPYRIS_CLI_HELP_WRITER_H

#include <stdbool.h>
#include <stdio.h>

struct help_writer {
    FILE *out;
    bool roff;
};

void help_section(const struct help_writer *writer, const char *title); // such as "OPTIONS"
void help_group(const struct help_writer *writer, const char *title);   // a part of a section
void help_paragraph(const struct help_writer *writer, const char *text);
// Writes a term and its description. `names` is bold, `argument` (NULL: none) in italics.
void help_item(const struct help_writer *writer, const char *names, const char *argument,
               const char *text);
// Writes lines verbatim.
void help_literal(const struct help_writer *writer, const char *lines);

#endif
