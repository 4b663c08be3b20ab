#include "cli/help.h"

#include "cli/commands.h"
#include "cli/completion.h"
#include "cli/help_writer.h"
#include "cli/options.h"
#include <string.h>

static const char program_summary[] = "physically based path tracer on Vulkan compute shaders";

// `command` is NULL for the program itself.
static void exit_status(const struct help_writer *writer, const struct command *command)
{
    static const struct {
        const char *code, *text;
    } rows[] = {
        {"0", "Success."},
        {"1", "A comparison exceeded a limit, or a check failed."},
        {"2", "The command line or an input file is wrong, or an output is an input."},
        {"3", "The device, its driver or the system's memory failed."},
        {"4", "A result could not be written."},
        {"69", "There is no Vulkan loader or no driver."},
        {"128+N",
         "Stopped by signal N: 130 by SIGINT, 143 by SIGTERM, 129 by SIGHUP, 138 by SIGUSR1, "
         "152 by SIGXCPU."},
    };
    help_section(writer, "EXIT STATUS");
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        const char *own = command && i <= EXIT_CODE_OUTPUT ? command->exits[i] : NULL;
        if (!own || *own)
            help_item(writer, rows[i].code, NULL, own ? own : rows[i].text);
    }
}

static void usage_line(const struct command *command, char *out, size_t size)
{
    snprintf(out, size, "lampyris %s [OPTIONS]%s%s", command->name, *command->arguments ? " " : "",
             command->arguments);
}

static bool has_range(const struct option_def *def)
{
    bool is_number = def->type == VALUE_COUNT || def->type == VALUE_REAL || def->type == VALUE_SIZE;
    return is_number && def->max > def->min;
}

static int append_setting(const struct setting *setting, char *out, size_t size)
{
    char range[SETTING_RANGE_MAX], fallback[SETTING_RANGE_MAX];
    setting_range(setting, range);
    setting_default_text(setting, fallback);
    return snprintf(out, size, "%s%s Default: the scene file's, else %s.", *range ? " " : "", range,
                    fallback);
}

static size_t append_takers(const struct option_def *def, char *out, size_t size)
{
    size_t used = 0;
    for (int i = 0; i < COMMAND_TOTAL; i++)
        if (option_belongs(def, &commands[i]) && used < size)
            used += (size_t)snprintf(out + used, size - used, "%s%s", used ? ", " : " For ",
                                     commands[i].name);
    if (used < size)
        used += (size_t)snprintf(out + used, size - used, ".");
    return used;
}

static void option_names(const struct option_def *def, char *out, size_t size)
{
    if (def->short_name)
        snprintf(out, size, "-%c, --%s", def->short_name, def->name);
    else
        snprintf(out, size, "--%s", def->name);
}

// Writes an option with its description. With name_takers, also names the commands that have the
// option.
static void option_item(const struct help_writer *writer, const struct option_def *def,
                        bool name_takers)
{
    char names[64], text[1024], argument[OPTION_ARGUMENT_MAX];
    option_names(def, names, sizeof names);
    int used = snprintf(text, sizeof text, "%s", def->help);
    if (has_range(def))
        used += snprintf(text + used, sizeof text - (size_t)used, " From %.15g to %.15g.", def->min,
                         def->max);
    if (def->setting)
        used += append_setting(def->setting, text + used, sizeof text - (size_t)used);
    if (def->fallback)
        used += snprintf(text + used, sizeof text - (size_t)used, " Default: %s.", def->fallback);
    if (name_takers)
        append_takers(def, text + used, sizeof text - (size_t)used);
    help_item(writer, names, option_argument(def, argument), text);
}

// Returns whether the help of the command (NULL: of the program) contains the option. Options for
// tests are only in manual pages.
static bool is_listed(const struct help_writer *writer, const struct option_def *def,
                      const struct command *command)
{
    return (!command || option_belongs(def, command)) && (writer->roff || !def->is_for_tests);
}

// Returns whether the option is the first one of its group among those that are listed.
static bool begins_group(const struct help_writer *writer, const struct option_def *def,
                         const struct command *command)
{
    for (const struct option_def *other = option_table; other < def; other++)
        if (is_listed(writer, other, command) && strcmp(other->group, def->group) == 0)
            return false;
    return true;
}

// Lists the options of a command (NULL: of all commands) by groups.
static void option_list(const struct help_writer *writer, const struct command *command)
{
    const unsigned for_all = (1u << COMMAND_TOTAL) - 1;
    for (int i = 0; i < OPTION_TOTAL; i++) {
        const struct option_def *first = &option_table[i];
        if (!is_listed(writer, first, command) || !begins_group(writer, first, command))
            continue;
        help_group(writer, first->group);
        for (int j = i; j < OPTION_TOTAL; j++) {
            const struct option_def *def = &option_table[j];
            if (is_listed(writer, def, command) && strcmp(def->group, first->group) == 0)
                option_item(writer, def, !command && def->commands != for_all);
        }
    }
}

static void options_section(const struct help_writer *writer, const struct command *command)
{
    help_section(writer, "OPTIONS");
    help_paragraph(
        writer,
        "A value follows after a blank or \"=\": --log-level note, --log-level=note. "
        "Counts may end in k, M or G, for factors of 2^10, 2^20 and 2^30: 16k is 16384. "
        "If an option that takes one value is given several times, the last one counts. After "
        "\"--\" all words are arguments.");
    option_list(writer, command);
}

// whatis(1) reads this section of a manual page: "lampyris-render \- render a scene to pictures".
static void name_section(const struct help_writer *writer, const struct command *command)
{
    const char *summary = command ? command->summary : program_summary;
    const char *name = command ? command->name : "";
    if (writer->roff)
        fprintf(writer->out, ".SH NAME\nlampyris%s%s \\- %s\n", command ? "\\-" : "", name,
                summary);
    else
        fprintf(writer->out, "lampyris%s%s - %s\n", command ? " " : "", name, summary);
}

static void command_page(const struct help_writer *writer, const struct command *command)
{
    char line[128];
    name_section(writer, command);
    help_section(writer, "SYNOPSIS");
    usage_line(command, line, sizeof line);
    help_literal(writer, line);
    help_section(writer, "DESCRIPTION");
    help_paragraph(writer, command->description);
    options_section(writer, command);
    help_section(writer, "EXAMPLES");
    help_literal(writer, command->examples);
    exit_status(writer, command);
}

static void program_head(const struct help_writer *writer)
{
    name_section(writer, NULL);
    help_section(writer, "SYNOPSIS");
    help_literal(writer, "lampyris COMMAND [OPTIONS] [ARGUMENTS]");
}

void help_program(FILE *out)
{
    const struct help_writer writer = {.out = out};
    program_head(&writer);
    help_section(&writer, "COMMANDS");
    for (int i = 0; i < COMMAND_TOTAL; i++)
        help_item(&writer, commands[i].name, *commands[i].arguments ? commands[i].arguments : NULL,
                  commands[i].summary);
    help_section(&writer, "OPTIONS OF EVERY COMMAND");
    for (int i = OPTION_JSON; i < OPTION_TOTAL; i++)
        option_item(&writer, &option_table[i], false);
    exit_status(&writer, NULL);
    fputs("\nSee \"lampyris COMMAND --help\" for a command and its options.\n", out);
}

void help_common(FILE *out, const struct command *command)
{
    const struct help_writer writer = {.out = out};
    char line[128], names[64], argument[OPTION_ARGUMENT_MAX];
    name_section(&writer, command);
    help_section(&writer, "SYNOPSIS");
    usage_line(command, line, sizeof line);
    help_literal(&writer, line);
    help_section(&writer, "COMMON OPTIONS");
    int listed = 0;
    for (int i = 0; i < OPTION_TOTAL; i++) {
        const struct option_def *def = &option_table[i];
        listed += is_listed(&writer, def, command);
        const char *brief = option_brief(def, command);
        if (!brief)
            continue;
        option_names(def, names, sizeof names);
        help_item(&writer, names, option_argument(def, argument), brief);
    }
    help_section(&writer, "EXAMPLES");
    help_literal(&writer, command->examples);
    if (command->exits[EXIT_CODE_OK])
        exit_status(&writer, command);
    fprintf(out, "\n\"lampyris %s --help-all\" explains all %d options.\n", command->name, listed);
}

void help_command(FILE *out, const struct command *command)
{
    const struct help_writer writer = {.out = out};
    command_page(&writer, command);
}

static void program_page(const struct help_writer *writer)
{
    program_head(writer);
    help_section(writer, "DESCRIPTION");
    help_paragraph(writer,
                   "Lampyris renders scenes by wavefront path tracing on any Vulkan 1.1 device "
                   "with compute shaders, from a driver that runs on the processor to a large "
                   "GPU, without ray-tracing extensions. A picture depends on the scene, its "
                   "settings and the seed alone, not on how the work was split.");
    help_section(writer, "COMMANDS");
    for (int i = 0; i < COMMAND_TOTAL; i++) {
        char line[128];
        usage_line(&commands[i], line, sizeof line);
        help_group(writer, commands[i].name);
        help_literal(writer, line);
        help_paragraph(writer, commands[i].description);
    }
    options_section(writer, NULL);
    help_section(writer, "EXAMPLES");
    for (int i = 0; i < COMMAND_TOTAL; i++)
        help_literal(writer, commands[i].examples);
    exit_status(writer, NULL);
}

void help_manual(FILE *out, const struct command *command)
{
    const struct help_writer writer = {.out = out, .roff = true};
    // The page has no date, so that the same source always gives the same page.
    fprintf(out, ".TH lampyris%s%s 1 \"\" \"lampyris %s\" \"User Commands\"\n",
            command ? "\\-" : "", command ? command->name : "", LAMPYRIS_VERSION);
    fputs(".nh\n.ad l\n", out); // names of options must not be hyphenated, nor blanks be widened
    if (command)
        command_page(&writer, command);
    else
        program_page(&writer);
}

void help_everything(FILE *out)
{
    const struct help_writer writer = {.out = out};
    program_page(&writer);
}

static bool complete(const struct options *options, const struct command *command, struct err *err)
{
    static void (*const writers[])(const struct completion *completion) = {
        [COMPLETION_BASH] = completion_bash,
        [COMPLETION_ZSH] = completion_zsh,
        [COMPLETION_FISH] = completion_fish,
    };
    if (command && command != &commands[COMMAND_VIEW])
        return err_set(err, ERR_USAGE,
                       "--completion: expected no command, or \"view\" for lampyris-view");
    writers[options->completion](&(struct completion){
        .out = stdout, .only = command, .program = command ? "lampyris-view" : "lampyris"});
    return true;
}

int cmd_help(const struct options *options)
{
    const struct command *command = NULL;
    struct err err = {0};
    if (options->argument_count > 0 && !(command = command_find(options->arguments[0], &err)))
        return command_fail(&err);
    if (options_given(options, OPTION_COMPLETION))
        return complete(options, command, &err) ? EXIT_CODE_OK : command_fail(&err);
    if (options->man)
        help_manual(stdout, command);
    else if (command)
        help_command(stdout, command);
    else
        help_program(stdout);
    return EXIT_CODE_OK;
}
