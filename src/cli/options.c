#include "cli/options.h"

#include "base/file.h"
#include "base/printable.h"
#include "base/suggest.h"
#include "cli/commands.h"
#include "cli/shard.h"
#include <math.h>
#include <stdio.h>
#include <string.h>

struct parser {
    char **arguments;
    int count, next;
    bool only_arguments; // "--" was seen
    struct options *options;
};

const struct option_def *option_find(const char *name, size_t length)
{
    for (int i = 0; i < OPTION_TOTAL; i++)
        if (strlen(option_table[i].name) == length &&
            memcmp(option_table[i].name, name, length) == 0)
            return &option_table[i];
    return NULL;
}

static const struct option_def *find_short(char name)
{
    for (int i = 0; i < OPTION_TOTAL; i++)
        if (option_table[i].short_name == name)
            return &option_table[i];
    return NULL;
}

// Before the command, only options that every command has are accepted.
static bool is_available(const struct option_def *def, const struct command *command)
{
    for (int i = 0; !command && i < COMMAND_TOTAL; i++)
        if (!option_belongs(def, &commands[i]))
            return false;
    return !command || option_belongs(def, command);
}

static bool fail_unknown_option(const struct parser *parser, const char *name, size_t length,
                                struct err *err)
{
    char wanted[64];
    snprintf(wanted, sizeof wanted, "%.*s", (int)(length < 63 ? length : 63), name);
    struct suggestion suggestion = {.wanted = wanted};
    for (int i = 0; i < OPTION_TOTAL; i++)
        if (is_available(&option_table[i], parser->options->command))
            suggest_offer(&suggestion, option_table[i].name);
    if (suggestion.nearest)
        return err_set(err, ERR_USAGE, "unknown option --%s; did you mean --%s?", wanted,
                       suggestion.nearest);
    return err_set(err, ERR_USAGE, "unknown option --%s", wanted);
}

static bool fail_wrong_place(const struct parser *parser, const struct option_def *def,
                             struct err *err)
{
    const struct command *command = parser->options->command;
    if (!command)
        return err_set(err, ERR_USAGE, "--%s must be given after the command", def->name);
    char takers[128] = "";
    for (int i = 0; i < COMMAND_TOTAL; i++)
        if (option_belongs(def, &commands[i])) {
            size_t used = strlen(takers);
            snprintf(takers + used, sizeof takers - used, "%s\"%s\"", used ? ", " : "",
                     commands[i].name);
        }
    return err_set(err, ERR_USAGE, "\"%s\" has no option --%s: it belongs to %s", command->name,
                   def->name, takers);
}

void option_mark(const struct option_def *def, struct options *options)
{
    bool *is_set = options->scene.is_set;
    options->given[def - option_table] = true;
    if (def->setting)
        is_set[def->setting - settings_table] = true;
    if (def == &option_table[OPTION_SIZE])
        is_set[SETTING_WIDTH] = is_set[SETTING_HEIGHT] = true;
}

// Applies an option. `attached` is the text after '=' (or after a short name), or NULL.
static bool apply(struct parser *parser, const struct option_def *def, const char *attached,
                  struct err *err)
{
    if (!is_available(def, parser->options->command))
        return fail_wrong_place(parser, def, err);
    if (def->type == VALUE_FLAG && attached)
        return err_set(err, ERR_USAGE, "--%s takes no value, but got \"%s\"", def->name, attached);
    const char *value = attached;
    if (def->type != VALUE_FLAG && !value) {
        // In "--output --half" the file name is missing: "--half" is not taken as a value. For a
        // file with such a name write --output=--half. The value of --slurm is excepted, because it
        // consists of options.
        const bool takes_dashes = def == &option_table[OPTION_SLURM];
        value = parser->next < parser->count ? parser->arguments[parser->next] : NULL;
        char argument[OPTION_ARGUMENT_MAX];
        if (!value || (!takes_dashes && strncmp(value, "--", 2) == 0))
            return err_set(err, ERR_USAGE, "--%s needs a value: --%s %s", def->name, def->name,
                           option_argument(def, argument));
        parser->next++;
    }
    if (!option_store(def, value, parser->options, err))
        return err_prepend(err, "--%s", def->name);
    option_mark(def, parser->options);
    return true;
}

static bool parse_long(struct parser *parser, const char *text, struct err *err)
{
    size_t length = strcspn(text, "=");
    const struct option_def *def = option_find(text, length);
    if (!def)
        return fail_unknown_option(parser, text, length, err);
    return apply(parser, def, text[length] ? text + length + 1 : NULL, err);
}

// Parses "-o FILE", "-oFILE", "-q".
static bool parse_short(struct parser *parser, const char *text, struct err *err)
{
    const struct option_def *def = find_short(text[0]);
    if (!def)
        return err_set(err, ERR_USAGE, "unknown option -%s; long options have two dashes", text);
    return apply(parser, def, text[1] ? text + 1 : NULL, err);
}

static bool parse_argument(struct parser *parser, const char *text, struct err *err)
{
    struct options *options = parser->options;
    if (!*text)
        return err_set(err, ERR_USAGE, "an argument is empty; expected %s",
                       options->command ? options->command->arguments : "COMMAND");
    if (!options->command) {
        options->command = command_find(text, err);
        options->command_index = parser->next - 1;
        return options->command != NULL;
    }
    if (options->argument_count >= options->command->max_arguments)
        return err_set(err, ERR_USAGE, "unexpected argument \"%s\"; expected %s%s%s", text,
                       options->command->name, *options->command->arguments ? " " : "",
                       options->command->arguments);
    options->arguments[options->argument_count++] = text;
    options->scene.path = options->arguments[0];
    return true;
}

static bool parse_all(struct parser *parser, struct err *err)
{
    while (parser->next < parser->count) {
        const char *text = parser->arguments[parser->next++];
        bool ok;
        if (parser->only_arguments || text[0] != '-' || text[1] == '\0')
            ok = parse_argument(parser, text, err);
        else if (text[1] != '-')
            ok = parse_short(parser, text + 1, err);
        else if (text[2] != '\0')
            ok = parse_long(parser, text + 2, err);
        else
            ok = parser->only_arguments = true;
        if (!ok)
            return false;
    }
    return true;
}

// Checks options that need, or exclude, another option.
static bool check_combinations(const struct options *options, struct err *err)
{
    if (options_given(options, OPTION_SHARD_BY) && !options_given(options, OPTION_SHARD) &&
        options->command == &commands[COMMAND_RENDER])
        return err_set(err, ERR_USAGE, "--shard-by needs --shard");
    static const struct {
        enum option_id id, other;
        bool together;
    } rules[] = {
        {OPTION_SPP_PER_FRAME, OPTION_FRAMES, true},
        {OPTION_EVERY, OPTION_FRAMES, true},
        {OPTION_ACCUMULATE, OPTION_FRAMES, true},
        {OPTION_SAMPLE, OPTION_PIXEL, true},
        {OPTION_SPP, OPTION_FRAMES, false},
        {OPTION_ERROR, OPTION_FRAMES, false},
        {OPTION_ADAPTIVE, OPTION_FRAMES, false},
        {OPTION_CHECKPOINT_EVERY, OPTION_CHECKPOINT, true},
        {OPTION_FPS, OPTION_TURNTABLE, true},
        {OPTION_SHARD, OPTION_PIXEL, false},
        {OPTION_SHARD, OPTION_TRACE, false},
        {OPTION_STATUS, OPTION_OUTPUT, false},
        {OPTION_STATUS, OPTION_CHECKPOINT, false},
        {OPTION_RAYS, OPTION_KERNEL, true},
        {OPTION_DEPTH, OPTION_KERNEL, true},
        {OPTION_TIMES, OPTION_SPP_FROM, false},
        {OPTION_TIMES, OPTION_SPP, false},
        {OPTION_IMAGES, OPTION_REPORT, true},
        {OPTION_MAP, OPTION_DIFFERENCE, true},
        {OPTION_REPRODUCIBLE, OPTION_ONLY, false},
        {OPTION_TRACE, OPTION_PIXEL, false},
        {OPTION_EXPLAIN, OPTION_PIXEL, false},
        {OPTION_TEV, OPTION_PIXEL, false},
        {OPTION_REFERENCE, OPTION_PIXEL, false},
        {OPTION_REFERENCE, OPTION_REFERENCE_FROM, false},
    };
    for (size_t i = 0; i < sizeof rules / sizeof rules[0]; i++) {
        const char *name = option_table[rules[i].id].name;
        const char *other = option_table[rules[i].other].name;
        if (!options_given(options, rules[i].id) ||
            options_given(options, rules[i].other) == rules[i].together)
            continue;
        return err_set(err, ERR_USAGE,
                       rules[i].together ? "--%s needs --%s" : "--%s and --%s exclude each other",
                       name, other);
    }
    return true;
}

bool options_have_sequence(const struct options *options)
{
    const struct sequence_options *sequence = &options->render.sequence;
    return sequence->views > 0 || sequence->is_animation;
}

bool output_is_video(const char *path)
{
    return path_has_extension(path, "mp4") || path_has_extension(path, "webm");
}

// Refuses options that cannot be combined with --crop.
static bool check_crop(const struct options *options, struct err *err)
{
    const struct {
        bool is_given;
        const char *option, *why;
    } others[] = {
        {options->render.adaptive, "--adaptive on",
         "tiles would get other numbers of samples than in the whole picture"},
        {options_given(options, OPTION_SHARD), "--shard", "shards divide the whole picture"},
        {options_given(options, OPTION_REFERENCE), "--reference",
         "the reference has the size of the whole picture"},
        {options_given(options, OPTION_PIXEL), "--pixel",
         "--pixel follows one path and renders no window"},
    };
    for (size_t i = 0; options_given(options, OPTION_CROP) && i < sizeof others / sizeof others[0];
         i++)
        if (others[i].is_given)
            return err_set(err, ERR_USAGE, "--crop and %s exclude each other: %s", others[i].option,
                           others[i].why);
    return true;
}

// Refuses options that apply to a single picture.
static bool check_sequence(const struct options *options, struct err *err)
{
    static const enum option_id of_one_picture[] = {
        OPTION_FRAMES, OPTION_CHECKPOINT, OPTION_REFERENCE, OPTION_TRACE,
        OPTION_TEV,    OPTION_EXPLAIN,    OPTION_PIXEL};
    const struct sequence_options *sequence = &options->render.sequence;
    const char *name = sequence->views > 0 ? "--turntable" : "--at START:END:FPS";
    if (sequence->is_animation && options->command != &commands[COMMAND_RENDER])
        return err_set(err, ERR_USAGE,
                       "--at START:END:FPS: only render makes several pictures; expected --at "
                       "SECONDS");
    if (sequence->is_animation && sequence->views > 0)
        return err_set(err, ERR_USAGE,
                       "--turntable and --at START:END:FPS exclude each other; expected --at "
                       "SECONDS, the time that the turntable shows");
    if (options_given(options, OPTION_SHARD))
        return err_set(err, ERR_USAGE,
                       "%s and --shard exclude each other: a shard is a part of one picture, but "
                       "%s renders several; expected %s",
                       name, name,
                       sequence->views > 0 ? "no --shard, or no --turntable"
                                           : "no --shard, but a range of times for each process");
    for (size_t i = 0; i < sizeof of_one_picture / sizeof of_one_picture[0]; i++)
        if (options_given(options, of_one_picture[i]))
            return err_set(err, ERR_USAGE,
                           "%s and --%s exclude each other: --%s applies to one picture, but %s "
                           "renders several",
                           name, option_table[of_one_picture[i]].name,
                           option_table[of_one_picture[i]].name, name);
    return true;
}

// Checks options that have another meaning, or none, if no sequence is rendered.
static bool check_without_sequence(const struct options *options, struct err *err)
{
    if (options_given(options, OPTION_RESUME) && !options_given(options, OPTION_CHECKPOINT))
        return err_set(err, ERR_USAGE,
                       "--resume needs --checkpoint, or the pictures of --turntable or --at "
                       "START:END:FPS");
    for (uint32_t i = 0; i < options->render.output_count; i++)
        if (output_is_video(options->render.outputs[i]))
            return err_set(err, ERR_USAGE,
                           "--output: \"%s\" is a video; expected --turntable or --at "
                           "START:END:FPS, whose pictures it shows",
                           options->render.outputs[i]);
    return true;
}

// Returns whether an option can only be used with `check SCENE`.
static bool needs_scene(const struct option_def *def)
{
    switch ((enum option_id)(def - option_table)) {
    case OPTION_DEVICE:
    case OPTION_MEMORY:
    case OPTION_VALIDATION:
        return false;
    case OPTION_ERROR:
    case OPTION_FIX:
        return true;
    default:
        return option_belongs(def, &commands[COMMAND_INFO]) &&
               !option_belongs(def, &commands[COMMAND_DEVICES]);
    }
}

// Checks that options of check for devices and for scenes are used accordingly.
static bool check_check(const struct options *options, struct err *err)
{
    static const enum option_id of_devices[] = {OPTION_ONLY, OPTION_LIST, OPTION_LONG,
                                                OPTION_REPRODUCIBLE};
    for (int i = 0; i < OPTION_TOTAL; i++)
        if (options_given(options, i) && options->argument_count == 0 &&
            needs_scene(&option_table[i]))
            return err_set(err, ERR_USAGE, "--%s needs a scene: check SCENE", option_table[i].name);
    for (size_t i = 0; i < sizeof of_devices / sizeof of_devices[0]; i++)
        if (options_given(options, of_devices[i]) && options->argument_count > 0)
            return err_set(err, ERR_USAGE, "--%s is for devices; expected no SCENE",
                           option_table[of_devices[i]].name);
    return true;
}

static bool check(const struct options *options, struct err *err)
{
    if (options->help || options->help_all || options->version)
        return true;
    const struct command *command = options->command;
    if (!command)
        return err_set(err, ERR_USAGE, "no command given");
    if (options->argument_count < command->min_arguments)
        return err_set(err, ERR_USAGE, "too few arguments; expected %s %s", command->name,
                       command->arguments);
    if (!check_combinations(options, err) || !check_crop(options, err) ||
        !(options_have_sequence(options) ? check_sequence(options, err)
                                         : check_without_sequence(options, err)))
        return false;
    if (command == &commands[COMMAND_COMPARE] && options->scene.settings.exposure_is_auto)
        return err_set(err, ERR_USAGE,
                       "--exposure auto: compare exposes all pictures equally; "
                       "expected a number of stops");
    if (command == &commands[COMMAND_CHECK] && !check_check(options, err))
        return false;
    uint64_t samples = (uint64_t)options->render.frames * options->render.spp_per_frame;
    if (samples > SETTINGS_SPP_MAX)
        return err_set(err, ERR_USAGE,
                       "--frames x --spp-per-frame is %llu samples; expected at most %llu",
                       (unsigned long long)samples, (unsigned long long)SETTINGS_SPP_MAX);
    return true;
}

// A list has at most as many entries as the command line has arguments.
static bool allocate_lists(struct options *options, int argc, struct err *err)
{
    size_t most = (size_t)argc;
    options->arguments = ARENA_NEW(&options->arena, const char *, most + 1);
    options->render.outputs = ARENA_NEW(&options->arena, const char *, most);
    options->scene.overrides = ARENA_NEW(&options->arena, struct scene_override, most);
    options->study.vary = ARENA_NEW(&options->arena, const char *, most);
    options->study.curves = ARENA_NEW(&options->arena, const char *, most);
    options->compare.limits = ARENA_NEW(&options->arena, struct compare_limit, most);
    if (options->arguments && options->render.outputs && options->scene.overrides &&
        options->study.vary && options->study.curves && options->compare.limits)
        return true;
    return err_memory(err, "the command line", most * sizeof(struct scene_override));
}

char *options_quote(const char *word, char *out)
{
    return printable_quote(word, out);
}

const char *options_folder_of(const char *name)
{
    return name[0] == '-' && name[1] != '\0' ? "./" : "";
}

// Options that belong to a single run. They end the run, or report something in addition to the
// image. A command that follows a path of the run keeps only the first option of this list
// (--error). A command that repeats the image keeps only --crop and the options after --crop.
static const enum option_id passing[] = {OPTION_ERROR,  OPTION_CHECKPOINT, OPTION_CHECKPOINT_EVERY,
                                         OPTION_RESUME, OPTION_TRACE,      OPTION_REFERENCE,
                                         OPTION_TEV,    OPTION_EXPLAIN,    OPTION_ERROR_BY,
                                         OPTION_CROP,   OPTION_SHARD,      OPTION_SHARD_BY,
                                         OPTION_OUTPUT};
enum { PASSING_COUNT = sizeof passing / sizeof passing[0], UNREPEATED_COUNT = 9 };
// Options that belong to one shard of a picture.
static const enum option_id of_shards[] = {
    OPTION_OUTPUT, OPTION_SHARD, OPTION_SHARD_BY,  OPTION_CHECKPOINT, OPTION_CHECKPOINT_EVERY,
    OPTION_RESUME, OPTION_TRACE, OPTION_REFERENCE, OPTION_TEV,        OPTION_EXPLAIN,
    OPTION_JSON,   OPTION_QUIET, OPTION_LOG_LEVEL, OPTION_PARTS,      OPTION_SLURM,
    OPTION_DRY_RUN};

// A list of options.
struct option_list {
    const enum option_id *ids;
    size_t count;
};

static const struct option_def *find_written(const char *argument)
{
    if (argument[0] != '-' || argument[1] == '\0')
        return NULL;
    return argument[1] == '-' ? option_find(argument + 2, strcspn(argument + 2, "="))
                              : find_short(argument[1]);
}

static bool is_listed(const struct option_def *def, const struct option_list *list)
{
    bool is = false;
    for (size_t i = 0; i < list->count; i++)
        is |= def == &option_table[list->ids[i]];
    return is;
}

// Returns the number of arguments, starting with this one, in which an option is written.
static int written_arguments(const struct option_def *def, const char *argument)
{
    bool has_value = argument[1] == '-' ? strchr(argument, '=') != NULL : argument[2] != '\0';
    return def->type == VALUE_FLAG || has_value ? 1 : 2;
}

// Makes the command line without the options of the list. Options can be added at its end, because
// "--" is left out. Files after "--" whose names begin with '-' are therefore named with their
// folder, as "./-x.json".
static const char *make_line(struct arena *arena, size_t size, int argc, char **argv,
                             struct option_list left_out)
{
    char *line = ARENA_NEW(arena, char, size);
    if (!line)
        return NULL;
    char *end = options_quote("lampyris", line);
    bool only_arguments = false;
    for (int i = 1, next; i < argc; i = next) {
        const struct option_def *def = only_arguments ? NULL : find_written(argv[i]);
        next = i + (def ? written_arguments(def, argv[i]) : 1);
        if (!only_arguments && strcmp(argv[i], "--") == 0) {
            only_arguments = true;
            continue;
        }
        if (def && is_listed(def, &left_out))
            continue;
        for (int word = i; word < next && word < argc; word++) {
            const char *folder = only_arguments ? options_folder_of(argv[word]) : "";
            *end++ = ' ';
            memcpy(end, folder, strlen(folder));
            end = options_quote(argv[word], end + strlen(folder));
        }
    }
    return line;
}

static bool keep_command_line(struct options *options, int argc, char **argv, struct err *err)
{
    struct arena *arena = &options->arena;
    struct render_options *render = &options->render;
    size_t size = 16;
    for (int i = 1; i < argc; i++)
        size += 4 * strlen(argv[i]) + 6;
    options->command_line = make_line(arena, size, argc, argv, (struct option_list){0});
    render->repeatable_line =
        make_line(arena, size, argc, argv, (struct option_list){passing, UNREPEATED_COUNT});
    render->following_line =
        make_line(arena, size, argc, argv, (struct option_list){passing + 1, PASSING_COUNT - 1});
    render->shared_line =
        make_line(arena, size, argc, argv,
                  (struct option_list){of_shards, sizeof of_shards / sizeof of_shards[0]});
    return (options->command_line && render->repeatable_line && render->following_line &&
            render->shared_line) ||
           err_memory(err, "the command line", size);
}

bool options_parse(int argc, char **argv, struct options *out, struct err *err)
{
    *out = (struct options){.argc = argc,
                            .argv = argv,
                            .log_level = LOG_WARN,
                            .render.accumulate = true,
                            .scene = {.studio = SCENE_STUDIO_AUTO,
                                      .aperture_mm = NAN,
                                      .focus_distance = NAN,
                                      .at_seconds = NAN,
                                      .environment_strength = NAN,
                                      .anisotropy = true},
                            .render.spp_per_frame = 1,
                            .render.sequence.frames_per_s = 24.0,
                            .render.checkpoint_seconds = OPTION_CHECKPOINT_SECONDS,
                            .render.reopens = 2,
                            .converge.replicates = 16,
                            .converge.spp_from = 16,
                            .bench.repeats = 7,
                            .view.vsync = true,
                            .view.frame_ms = 33.0};
    if (!keep_command_line(out, argc, argv, err) || !allocate_lists(out, argc, err))
        return false;
    struct parser parser = {.arguments = argv, .count = argc, .next = 1, .options = out};
    return parse_all(&parser, err) && shard_settle(out, err) && check(out, err);
}

void options_finish(struct options *options)
{
    if (options)
        arena_finish(&options->arena);
}

bool option_is_setting(const struct option_def *def, const struct command *command)
{
    switch ((enum option_id)(def - option_table)) {
    case OPTION_SIZE:
    case OPTION_SPP:
        return command == &commands[COMMAND_BENCH];
    case OPTION_WAVE:
    case OPTION_WORKGROUP:
    case OPTION_FEATURES:
    case OPTION_CLASSES:
    case OPTION_BVH:
    case OPTION_NODE:
    case OPTION_BVH_OPTIMIZE:
    case OPTION_BVH_LEAF:
    case OPTION_BVH_COSTS:
    case OPTION_BVH_CACHE:
    case OPTION_INSTANCES:
        return true;
    default:
        return def->setting && def->setting->changes_samples;
    }
}

void options_apply_settings(const struct scene_options *options, struct settings *settings)
{
    for (int i = 0; i < SETTING_TOTAL; i++)
        if (options->is_set[i])
            field_copy(&settings_table[i].field, settings, &options->settings);
}
