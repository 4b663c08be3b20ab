#include "cli/completion.h"

#include <string.h>

// Writes text inside a specification of _arguments, which is in single quotes.
static void put(FILE *out, const char *text)
{
    for (; *text; text++)
        if (*text == '\'')
            fputs("'\\''", out);
        else if (strchr("[]:\\", *text))
            fprintf(out, "\\%c", *text);
        else
            fputc(*text, out);
}

static bool may_repeat(const struct option_def *def)
{
    return def->type >= VALUE_OUTPUT && def->type <= VALUE_KINDS;
}

// Writes the action of _arguments that completes a value.
static void action(FILE *out, const struct completion_value *value)
{
    if (*value->words && (value->files || value->folders))
        fprintf(out, "{compadd %s; _files%s}", value->words, value->folders ? " -/" : "");
    else if (value->files)
        fputs("_files", out);
    else if (value->folders)
        fputs("_files -/", out);
    else if (*value->words && value->is_list)
        fprintf(out, "_values -s , value %s", value->words);
    else if (*value->words)
        fprintf(out, "(%s)", value->words);
    else
        fputc(' ', out);
}

// Writes a specification such as "'(-o --output)'{-o,--output=}'[what it does]:FILE:_files'".
static void option(FILE *out, const struct option_def *def)
{
    char line[COMPLETION_LINE_MAX], argument[OPTION_ARGUMENT_MAX];
    const struct completion_value value = completion_value(def);
    const bool takes_value = def->type != VALUE_FLAG;
    fputs(" \\\n    ", out);
    if (may_repeat(def))
        fputs("'*'", out);
    else if (def->short_name)
        fprintf(out, "'(-%c --%s)'", def->short_name, def->name);
    if (def->short_name)
        fprintf(out, "{-%c%s,--%s%s}'[", def->short_name, takes_value ? "+" : "", def->name,
                takes_value ? "=" : "");
    else
        fprintf(out, "'--%s%s[", def->name, takes_value ? "=" : "");
    put(out, completion_line(def, line));
    fputc(']', out);
    if (takes_value) {
        fputc(':', out);
        put(out, *value.words && !value.files ? def->name : option_argument(def, argument));
        fputc(':', out);
        action(out, &value);
    }
    fputc('\'', out);
}

static void options_of(const struct completion *c, const struct command *command)
{
    for (int i = 0; i < OPTION_TOTAL; i++)
        if (completion_has(&option_table[i], command))
            option(c->out, &option_table[i]);
}

// Writes the specifications of a command's arguments other than options.
static void command_arguments(const struct completion *c, const struct command *command)
{
    fputs("_arguments -s -S", c->out);
    options_of(c, command);
    if (command == &commands[COMMAND_HELP])
        fputs(" \\\n    '1:command:($commands)'", c->out);
    else if (command->max_arguments > 0) {
        fputs(" \\\n    '*:", c->out);
        put(c->out, command->arguments);
        fputs(":_files'", c->out);
    }
    fputc('\n', c->out);
}

void completion_zsh(const struct completion *c)
{
    fprintf(c->out,
            "#compdef %s\n"
            "# Completes the command line of %s in zsh.\n",
            c->program, c->program);
    if (c->only) {
        command_arguments(c, c->only);
        return;
    }
    fputs("local curcontext=$curcontext state line\n"
          "local -a commands=(",
          c->out);
    for (int i = 0; i < COMMAND_TOTAL; i++)
        fprintf(c->out, "%s%s", i ? " " : "", commands[i].name);
    fputs(")\n"
          "typeset -A opt_args\n"
          "_arguments -C -s -S",
          c->out);
    options_of(c, NULL);
    fputs(" \\\n    '1:command:((", c->out);
    for (int i = 0; i < COMMAND_TOTAL; i++) {
        fprintf(c->out, "%s%s\\:\"", i ? " " : "", commands[i].name);
        put(c->out, commands[i].summary);
        fputc('"', c->out);
    }
    fputs("))' \\\n    '*::argument:->arguments' && return\n"
          "case $line[1] in\n",
          c->out);
    for (int i = 0; i < COMMAND_TOTAL; i++) {
        fprintf(c->out, "%s)\n  ", commands[i].name);
        command_arguments(c, &commands[i]);
        fputs("  ;;\n", c->out);
    }
    fputs("esac\n", c->out);
}
