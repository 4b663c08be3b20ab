#include "cli/completion.h"

#include <string.h>

static bool is_word(const char *text, size_t length)
{
    static const char characters[] = "abcdefghijklmnopqrstuvwxyz0123456789-_";
    return length > 0 && text[0] >= 'a' && text[0] <= 'z' && strspn(text, characters) >= length;
}

static bool is_file(const char *text, size_t length)
{
    return (length == 4 && memcmp(text, "FILE", 4) == 0) ||
           (length == 8 && memcmp(text, "OUT.json", 8) == 0);
}

static bool is_folder(const char *text, size_t length)
{
    return (length == 3 && memcmp(text, "DIR", 3) == 0) ||
           (length == 6 && memcmp(text, "FOLDER", 6) == 0);
}

// Parses the argument's text in the option table, such as "sobol|pcg", "FILE|auto|none",
// "METRES|off" or "part,bounce,emitter".
struct completion_value completion_value(const struct option_def *def)
{
    struct completion_value value = {0};
    char argument[OPTION_ARGUMENT_MAX];
    const char *text = option_argument(def, argument);
    if (!text)
        return value;
    size_t used = 0;
    for (const char *part = text; *part; part += *part != '\0') {
        size_t length = strcspn(part, "|,");
        if (is_word(part, length) && used + length + 2 <= sizeof value.words)
            used += (size_t)snprintf(value.words + used, sizeof value.words - used, "%s%.*s",
                                     used ? " " : "", (int)length, part);
        value.files |= is_file(part, length);
        value.folders |= is_folder(part, length);
        value.is_list |= part[length] == ',';
        part += length;
    }
    return value;
}

bool completion_has(const struct option_def *def, const struct command *command)
{
    const unsigned all = (1u << COMMAND_TOTAL) - 1;
    return !def->is_for_tests &&
           (command ? option_belongs(def, command) : (def->commands & all) == all);
}

const char *completion_line(const struct option_def *def, char out[COMPLETION_LINE_MAX])
{
    const char *brief = def->setting ? def->setting->brief : def->brief;
    const char *text = brief ? brief : def->help;
    // Copies only the first clause.
    size_t length = 0;
    while (text[length] &&
           !(strchr(".:;", text[length]) && (text[length + 1] == ' ' || !text[length + 1])))
        length++;
    snprintf(out, COMPLETION_LINE_MAX, "%.*s", (int)length, text);
    return out;
}

void completion_escaped(FILE *out, const char *text, const char *characters)
{
    for (; *text; text++) {
        if (strchr(characters, *text))
            fputc('\\', out);
        fputc(*text, out);
    }
}
