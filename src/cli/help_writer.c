#include "cli/help_writer.h"

#include <string.h>

enum { COLUMNS = 80, INDENT = 2, ITEM_COLUMN = 27 };

// Escapes characters that roff interprets (groff_char(7)): a hyphen would become a dash that cannot
// be pasted into a shell, and a line beginning with a point would be a request.
static void put_roff(FILE *out, const char *text)
{
    if (*text == '.' || *text == '\'')
        fputs("\\&", out);
    for (; *text; text++) {
        switch (*text) {
        case '-':
            fputs("\\-", out);
            break;
        case '\\':
            fputs("\\e", out);
            break;
        case '^':
            fputs("\\(ha", out);
            break;
        case '\'':
            fputs("\\(aq", out);
            break;
        default:
            fputc(*text, out);
        }
    }
}

// Writes text wrapped into lines that start at column `indent`. The first line starts at the
// cursor.
static void put_wrapped(FILE *out, const char *text, int indent)
{
    int column = indent;
    for (const char *word = text; *word;) {
        int length = (int)strcspn(word, " ");
        if (column > indent && column + 1 + length > COLUMNS) {
            fprintf(out, "\n%*s", indent, "");
            column = indent;
        } else if (column > indent) {
            fputc(' ', out);
            column++;
        }
        fprintf(out, "%.*s", length, word);
        column += length;
        word += length;
        word += strspn(word, " ");
    }
    fputc('\n', out);
}

void help_section(const struct help_writer *writer, const char *title)
{
    fprintf(writer->out, writer->roff ? ".SH %s\n" : "\n%s\n", title);
}

void help_group(const struct help_writer *writer, const char *title)
{
    fprintf(writer->out, writer->roff ? ".SS %s\n" : "\n %s\n", title);
}

void help_paragraph(const struct help_writer *writer, const char *text)
{
    if (writer->roff) {
        fputs(".PP\n", writer->out);
        put_roff(writer->out, text);
        fputc('\n', writer->out);
    } else {
        fprintf(writer->out, "%*s", INDENT, "");
        put_wrapped(writer->out, text, INDENT);
    }
}

static void item_roff(FILE *out, const char *names, const char *argument, const char *text)
{
    fputs(".TP\n\\fB", out);
    put_roff(out, names);
    fputs("\\fR", out);
    if (argument) {
        fputs(" \\fI", out);
        put_roff(out, argument);
        fputs("\\fR", out);
    }
    fputc('\n', out);
    put_roff(out, text);
    fputc('\n', out);
}

void help_item(const struct help_writer *writer, const char *names, const char *argument,
               const char *text)
{
    if (writer->roff) {
        item_roff(writer->out, names, argument, text);
        return;
    }
    int used = fprintf(writer->out, "%*s%s%s%s", INDENT, "", names, argument ? " " : "",
                       argument ? argument : "");
    if (used + 1 < ITEM_COLUMN)
        fprintf(writer->out, "%*s", ITEM_COLUMN - used, "");
    else
        fprintf(writer->out, "\n%*s", ITEM_COLUMN, "");
    put_wrapped(writer->out, text, ITEM_COLUMN);
}

void help_literal(const struct help_writer *writer, const char *lines)
{
    if (writer->roff)
        fputs(".PP\n.nf\n.RS\n", writer->out);
    while (*lines) {
        int length = (int)strcspn(lines, "\n");
        char line[COLUMNS + 1];
        snprintf(line, sizeof line, "%.*s", length, lines);
        if (writer->roff)
            put_roff(writer->out, line);
        else
            fprintf(writer->out, "%*s%s", INDENT, "", line);
        fputc('\n', writer->out);
        lines += length;
        lines += *lines == '\n';
    }
    if (writer->roff)
        fputs(".RE\n.fi\n", writer->out);
}
