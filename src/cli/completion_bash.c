#include "cli/completion.h"

#include <string.h>

static void names(FILE *out, const struct option_def *def, const char *separator)
{
    if (def->short_name)
        fprintf(out, "-%c%s", def->short_name, separator);
    fprintf(out, "--%s", def->name);
}

// Writes all option names of a command, for use in single quotes.
static void option_names(const struct completion *c, const struct command *command)
{
    const char *separator = "";
    for (int i = 0; i < OPTION_TOTAL; i++)
        if (completion_has(&option_table[i], command)) {
            fputs(separator, c->out);
            names(c->out, &option_table[i], " ");
            separator = " ";
        }
}

static bool is_used(const struct completion *c, const struct option_def *def)
{
    for (int i = 0; !c->only && i < COMMAND_TOTAL; i++)
        if (completion_has(def, &commands[i]))
            return true;
    return c->only && completion_has(def, c->only);
}

// Writes a branch for each option that takes a value. The branch defines how the value is
// completed; it defines nothing if only the user can know the value.
static void values(const struct completion *c)
{
    const char *separator = "    ";
    fputs("    case $previous in\n", c->out);
    for (int i = 0; i < OPTION_TOTAL; i++) {
        const struct option_def *def = &option_table[i];
        const struct completion_value value = completion_value(def);
        if (!is_used(c, def) || !(*value.words || value.files || value.folders))
            continue;
        fputs("    ", c->out);
        names(c->out, def, "|");
        fprintf(c->out, ") has_value=1 words='%s' files=%s ;;\n", value.words,
                value.files     ? "-f"
                : value.folders ? "-d"
                                : "");
    }
    for (int i = 0; i < OPTION_TOTAL; i++) {
        const struct option_def *def = &option_table[i];
        const struct completion_value value = completion_value(def);
        if (!is_used(c, def) || def->type == VALUE_FLAG || *value.words || value.files ||
            value.folders)
            continue;
        fputs(separator, c->out);
        names(c->out, def, "|");
        separator = "|";
    }
    fputs(") return ;;\n    esac\n", c->out);
}

static void find_command(const struct completion *c)
{
    fputs("    local commands='", c->out);
    for (int i = 0; i < COMMAND_TOTAL; i++)
        fprintf(c->out, "%s%s", i ? " " : "", commands[i].name);
    fputs("' command= i\n"
          "    for ((i = 1; i < COMP_CWORD; i++)); do\n"
          "        case \" $commands \" in\n"
          "        *\" ${COMP_WORDS[i]} \"*) command=${COMP_WORDS[i]}; break ;;\n"
          "        esac\n"
          "    done\n"
          "    case $command in\n"
          "    '') words=$commands options='",
          c->out);
    option_names(c, NULL);
    fputs("' ;;\n", c->out);
    for (int i = 0; i < COMMAND_TOTAL; i++) {
        const bool is_help = i == COMMAND_HELP;
        fprintf(c->out, "    %s) %s options='", commands[i].name,
                is_help ? "words=$commands" : "files=-f");
        option_names(c, &commands[i]);
        fputs("' ;;\n", c->out);
    }
    fputs("    esac\n", c->out);
}

void completion_bash(const struct completion *c)
{
    const char *function = c->only ? "_lampyris_view" : "_lampyris";
    fprintf(c->out,
            "# Completes the command line of %s in bash.\n"
            "%s()\n"
            "{\n"
            "    local current=${COMP_WORDS[COMP_CWORD]} previous=${COMP_WORDS[COMP_CWORD - 1]}\n"
            "    local has_value= words= files= options= before=\n"
            "    # \"--option=value\" comes as three words.\n"
            "    if [[ $current == = ]]; then\n"
            "        current=\n"
            "    elif [[ $previous == = && $COMP_CWORD -gt 2 ]]; then\n"
            "        previous=${COMP_WORDS[COMP_CWORD - 2]}\n"
            "    fi\n",
            c->program, function);
    values(c);
    fputs("    if [[ -z $has_value ]]; then\n", c->out);
    if (c->only) {
        fputs("    files=-f options='", c->out);
        option_names(c, c->only);
        fputs("'\n", c->out);
    } else {
        find_command(c);
    }
    fprintf(c->out,
            "    [[ $current != -* ]] || words=$options files=\n"
            "    fi\n"
            "    # The last word of a list with commas is completed.\n"
            "    [[ $current != *,* || -n $files ]] || before=${current%%,*},\n"
            "    local found=$(\n"
            "        compgen -P \"$before\" -W \"$words\" -- \"${current#\"$before\"}\"\n"
            "        [[ -z $files ]] || compgen $files -- \"$current\")\n"
            "    COMPREPLY=()\n"
            "    [[ -z $found ]] || mapfile -t COMPREPLY <<<\"$found\"\n"
            "    [[ -z $files ]] || compopt -o filenames 2>/dev/null\n"
            "}\n"
            "complete -F %s %s\n",
            function, c->program);
}
