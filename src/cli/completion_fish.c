#include "cli/completion.h"

#include <string.h>

// Writes the condition that one of the option's commands was given.
static void condition(const struct completion *c, const struct option_def *def)
{
    if (c->only || completion_has(def, NULL))
        return;
    fputs(" -n '__fish_seen_subcommand_from", c->out);
    for (int i = 0; i < COMMAND_TOTAL; i++)
        if (completion_has(def, &commands[i]))
            fprintf(c->out, " %s", commands[i].name);
    fputc('\'', c->out);
}

static void option(const struct completion *c, const struct option_def *def)
{
    char line[COMPLETION_LINE_MAX];
    const struct completion_value value = completion_value(def);
    fprintf(c->out, "complete -c %s", c->program);
    condition(c, def);
    if (def->short_name)
        fprintf(c->out, " -s %c", def->short_name);
    fprintf(c->out, " -l %s", def->name);
    if (def->type != VALUE_FLAG)
        fputs(value.files ? " -r -F" : " -x", c->out);
    if (value.folders)
        fprintf(c->out, " -a '(__fish_complete_directories) %s'", value.words);
    else if (*value.words && value.is_list)
        fprintf(c->out, " -a '(__fish_append , %s)'", value.words);
    else if (*value.words)
        fprintf(c->out, " -a '%s'", value.words);
    fputs(" -d '", c->out);
    completion_escaped(c->out, completion_line(def, line), "'\\");
    fputs("'\n", c->out);
}

void completion_fish(const struct completion *c)
{
    fprintf(c->out, "# Completes the command line of %s in fish.\n", c->program);
    for (int i = 0; !c->only && i < COMMAND_TOTAL; i++) {
        // Names of commands complete the first word, and the word after "help".
        fprintf(c->out,
                "complete -c %s -f -n '__fish_use_subcommand; or __fish_seen_subcommand_from help' "
                "-a %s -d '",
                c->program, commands[i].name);
        completion_escaped(c->out, commands[i].summary, "'\\");
        fputs("'\n", c->out);
    }
    for (int i = 0; i < OPTION_TOTAL; i++) {
        bool has = false;
        for (int j = 0; j < COMMAND_TOTAL; j++)
            has |= (!c->only || c->only == &commands[j]) &&
                   completion_has(&option_table[i], &commands[j]);
        if (has)
            option(c, &option_table[i]);
    }
}
