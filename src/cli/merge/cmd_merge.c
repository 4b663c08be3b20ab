// lampyris merge: adds the films of parts. Then cmd_render() writes the picture as after a render.
#include "cli/commands.h"

#include "base/file.h"
#include "base/file_inputs.h"
#include "base/file_system.h"
#include "base/log.h"
#include "cli/merge/leftovers.h"
#include "cli/outputs.h"
#include "job/expected.h"
#include "job/merge.h"
#include "render/adaptive.h"
#include "report/json_out.h"
#include "report/text_out.h"
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

// Maximum number of printed commands of each kind; more would hide the other messages.
#define COMMANDS_MAX 64u

// --- what is missing -----------------------------------------------------------------------------

// Returns the unit in which the ranges of parts are given.
static const char *unit(const struct merge *merge)
{
    return merge->by_tiles ? "rows" : "samples per pixel";
}

// Returns the largest number of samples, or rows, of a part. Missing samples are split into pieces
// of that length, which can be rendered at the same time.
static uint64_t longest_part(const struct merge *merge)
{
    uint64_t longest = merge->by_tiles ? TILE_SIDE : 2;
    for (uint32_t i = 0; i < merge->count; i++)
        for (uint32_t k = 0; k < merge->parts[i].wanted.count; k++) {
            const struct sample_range *range = &merge->parts[i].wanted.list[k];
            longest = range->end - range->first > longest ? range->end - range->first : longest;
        }
    const uint64_t step = merge->by_tiles ? TILE_SIDE : 2;
    return (longest + step - 1) / step * step;
}

// Commands that render missing samples.
struct commands {
    const char **list;
    uint32_t count, capacity;
};

static bool add_command(struct commands *to, struct merge *merge, const char *command,
                        struct err *err)
{
    const char **added =
        arena_append(&merge->arena, &to->list, &to->count, &to->capacity, sizeof *added, NULL);
    if (!added || !command)
        return err_memory(err, "commands", sizeof *added);
    *added = command;
    return true;
}

// Adds the commands that render samples, or rows, that belong to no part.
static bool add_pieces(struct commands *out, struct merge *merge,
                       const struct sample_ranges *missing, struct err *err)
{
    const uint64_t piece = longest_part(merge);
    for (uint32_t i = 0; i < missing->count; i++)
        for (uint64_t at = missing->list[i].first, end; at < missing->list[i].end; at = end) {
            // A shard has at least two samples, so a single one at the end is added to the last
            // piece.
            end = at + piece + 1 < missing->list[i].end ? at + piece : missing->list[i].end;
            if (!add_command(out, merge,
                             arena_printf(&merge->arena, "%s%s --shard %" PRIu64 ":%" PRIu64,
                                          merge->command,
                                          merge->by_tiles ? " --shard-by tiles" : "", at, end),
                             err))
                return false;
        }
    return true;
}

static bool is_unfinished(const struct merge_part *part)
{
    return part->wanted.count == 1 && samples_count(&part->samples) < samples_count(&part->wanted);
}

// Adds the commands that finish the unfinished parts.
static bool add_resumes(struct commands *out, struct merge *merge, struct err *err)
{
    for (uint32_t i = 0; i < merge->count; i++) {
        const struct merge_part *part = &merge->parts[i];
        if (is_unfinished(part) &&
            !add_command(out, merge, merge_resuming_command(merge, part, &merge->arena), err))
            return false;
    }
    return true;
}

static void print_commands(FILE *out, const struct commands *all)
{
    for (uint32_t i = 0; i < all->count && i < COMMANDS_MAX; i++)
        fprintf(out, "%s\n", all->list[i]);
    if (all->count > COMMANDS_MAX)
        fprintf(out,
                "and %u more commands of this kind, all of which merge --status --json prints\n",
                all->count - COMMANDS_MAX);
}

// The samples, or rows, that no part has so far, and those that no part will have when all shards
// have finished.
struct lacking {
    struct sample_ranges samples, unclaimed;
    struct commands pieces, resumes; // render those of no part; finish the unfinished parts
    bool has_odd_begin;              // those of no part begin at an odd sample, as no shard can
};
#define ODD_BEGIN                                                                                  \
    "no shard can begin at an odd sample: parts of a render with an odd --spp cannot be "          \
    "continued; expected parts of an even --spp, or --partial"

static bool find_lacking(struct merge *merge, struct lacking *out, struct err *err)
{
    struct sample_ranges wanted = {0}, joined;
    for (uint32_t i = 0; i < merge->count; i++) {
        if (!samples_join(&wanted, &merge->parts[i].wanted, &merge->arena, &joined, err))
            return false;
        wanted = joined;
    }
    if (!samples_missing(&merge->samples, merge->all, &merge->arena, &out->samples, err) ||
        !samples_missing(&wanted, merge->all, &merge->arena, &out->unclaimed, err))
        return false;
    out->has_odd_begin =
        !merge->by_tiles && out->unclaimed.count > 0 && out->unclaimed.list[0].first % 2 != 0;
    return (out->has_odd_begin || add_pieces(&out->pieces, merge, &out->unclaimed, err)) &&
           add_resumes(&out->resumes, merge, err);
}

// Reports missing samples, and refuses to write a picture without them unless --partial is given.
static bool check_missing(struct merge *merge, const struct options *options, bool writes_picture,
                          struct err *err)
{
    struct lacking lacking = {0};
    if (!find_lacking(merge, &lacking, err))
        return false;
    if (lacking.samples.count == 0 || !writes_picture)
        return true;
    const char *text = samples_text(&lacking.samples, &merge->arena);
    if (!text)
        return err_memory(err, "ranges of samples", 64);
    const uint64_t count = samples_count(&lacking.samples);
    merge->merged.is_partial = true;
    if (options->merge.partial) {
        log_warn("%" PRIu64 " of %" PRIu64 " %s are missing (%s): the picture has only the others",
                 count, merge->all, unit(merge), text);
        return true;
    }
    progress_end(options->progress);
    if (lacking.has_odd_begin)
        return err_set(err, ERR_INPUT,
                       "%" PRIu64 " of %" PRIu64 " %s are missing (%s), and " ODD_BEGIN, count,
                       merge->all, unit(merge), text);
    print_commands(stderr, &lacking.resumes); // standard output is for results
    print_commands(stderr, &lacking.pieces);
    return err_set(err, ERR_INPUT,
                   "%" PRIu64 " of %" PRIu64 " %s are missing (%s): the commands above "
                   "render them; expected their parts, too, or --partial",
                   count, merge->all, unit(merge), text);
}

// --- devices -------------------------------------------------------------------------------------

// Compares the devices' mean luminances, with standard errors from the half-buffers.
static void compare_devices(const struct merge *merge)
{
    const struct merge_device *one = &merge->devices[0];
    log_warn(
        "the parts come from %u devices: the picture does not have the bits that one of them would "
        "make alone",
        merge->name_count);
    if (merge->by_tiles) {
        log_info(
            "the devices' means are not compared, because parts by tiles have different pixels of "
            "the picture");
        return;
    }
    for (uint32_t i = 1; i < merge->device_count; i++) {
        const struct merge_device *other = &merge->devices[i];
        if (!one->has_mean || !other->has_mean) {
            log_warn("the means of %s and %s cannot be compared, because %s has fewer than two "
                     "samples in some pixels; expected at least two samples per pixel of each "
                     "device",
                     one->name, other->name, one->has_mean ? other->name : one->name);
            continue;
        }
        double difference = other->mean - one->mean;
        double error = hypot(other->standard_error, one->standard_error);
        // A normal distribution exceeds 3.3 standard errors once in 1000 times.
        bool differs = fabs(difference) > 3.3 * error;
        log_message(
            differs ? LOG_WARN : LOG_INFO,
            "mean luminance %.7g +- %.2g by %s and %.7g +- %.2g by %s: %.2f standard errors "
            "apart%s",
            one->mean, one->standard_error, one->name, other->mean, other->standard_error,
            other->name, error > 0.0 ? fabs(difference) / error : 0.0,
            differs ? ", a difference that noise exceeds once in 1000 times" : "");
    }
}

// --- the picture ---------------------------------------------------------------------------------

// Reads the next word of a command line that options_quote() wrote; NULL at the end.
static char *next_word(const char **line, char *out)
{
    const char *c = *line + strspn(*line, " ");
    if (!*c)
        return NULL;
    char *end = out;
    for (bool quoted = false; *c && (quoted || *c != ' '); c++) {
        if (*c == '\'')
            quoted = !quoted;
        else if (*c == '\\' && !quoted && c[1])
            *end++ = *++c;
        else
            *end++ = *c;
    }
    *end = '\0';
    *line = c;
    return out;
}

// Returns the word after `name` in a command line, or `name` itself for an option without a value;
// NULL: the option is not given. The result is in `buffer`, which has the length of the line.
static const char *find_option(const char *line, const char *name, bool has_value, char *buffer)
{
    while (next_word(&line, buffer))
        if (strcmp(buffer, name) == 0)
            return has_value ? next_word(&line, buffer) : buffer;
    return NULL;
}

static const struct {
    const char *name;
    bool has_value;
} output_options[] = {
    {"--exposure", true}, {"--tone", true}, {"--half", false}, {"--png16", false}};

// Parts do not depend on options of display and encoding, so their commands may differ in these.
// The picture is written as by one of the commands. Warns if another part has other options.
static bool warn_of_outputs(struct merge *merge, struct err *err)
{
    for (uint32_t i = 0; i < merge->count; i++) {
        const char *other = merge->parts[i].command;
        if (strcmp(other, merge->command) == 0)
            continue;
        char *a = ARENA_NEW(&merge->arena, char, strlen(merge->command) + 1);
        char *b = ARENA_NEW(&merge->arena, char, strlen(other) + 1);
        if (!a || !b)
            return err_memory(err, "the command line of a part", strlen(other));
        for (size_t k = 0; k < sizeof output_options / sizeof *output_options; k++) {
            const char *name = output_options[k].name;
            const char *is = find_option(merge->command, name, output_options[k].has_value, a);
            const char *was = find_option(other, name, output_options[k].has_value, b);
            if ((is == NULL) == (was == NULL) && (!is || strcmp(is, was) == 0))
                continue;
            log_warn("%s: was rendered with another %s; the picture is written as by: %s",
                     merge->parts[i].path, name, merge->command);
            return true;
        }
    }
    return true;
}

// Makes the arguments of the render that these parts belong to, with the outputs given to merge.
struct arguments {
    char **list;
    int count;
};

static bool make_arguments(const struct merge *merge, const struct options *options,
                           struct arena *arena, struct arguments *out, struct err *err)
{
    const size_t length = strlen(merge->command);
    const uint32_t outputs = options->render.output_count;
    char *text = ARENA_NEW(arena, char, 2 * length + 2);
    out->list = ARENA_NEW(arena, char *, length / 2 + 3 + 2 * (size_t)outputs);
    if (!text || !out->list)
        return err_memory(err, "the command line of a part", length);
    const char *line = merge->command;
    for (char *word; (word = next_word(&line, text)); text += strlen(word) + 1) {
        out->list[out->count++] = word;
        // The outputs follow "lampyris render", because "--" may stand before the scene.
        for (uint32_t i = 0; out->count == 2 && i < outputs; i++) {
            out->list[out->count + 2 * (int)i] = arena_strdup(arena, "-o");
            out->list[out->count + 2 * (int)i + 1] =
                arena_strdup(arena, options->render.outputs[i]);
        }
        out->count += out->count == 2 ? 2 * (int)outputs : 0;
    }
    for (int i = 0; i < out->count; i++)
        if (!out->list[i])
            return err_memory(err, "the command line of a part", length);
    return true;
}

// Options given to merge take precedence over those stored in the part.
static bool make_options(const struct merge *merge, const struct options *options,
                         const struct arguments *arguments, struct options *out, struct err *err)
{
    if (!options_parse(arguments->count, arguments->list, out, err))
        return err_prepend(err, "%s: the command line stored in it", merge->parts[0].path);
    if (out->command != &commands[COMMAND_RENDER])
        return err_set(err, ERR_INPUT, "%s: stores the command line of another command: %s",
                       merge->parts[0].path, merge->command);
    if (!file_exists(out->scene.path))
        return err_set(
            err, ERR_INPUT,
            "%s: does not exist here; expected merge to run in the working directory of the "
            "shards, which were rendered by: %s",
            out->scene.path, merge->command);
    out->progress = options->progress;
    out->json = options->json;
    out->quiet = options->quiet;
    out->log_level = options->log_level;
    out->memory = options->memory;
    out->render.half_float |= options->render.half_float;
    out->render.png16 |= options->render.png16;
    if (options_given(options, OPTION_DEVICE))
        out->device.gpu.device = options->device.gpu.device;
    return true;
}

// Lets cmd_render() write the picture. No sample is rendered, because the merged film counts as
// complete.
static int write_picture(struct merge *merge, const struct options *options, struct err *err)
{
    struct arena arena = {0};
    struct arguments arguments = {0};
    struct options of_render = {0};
    int code = -1;
    if (warn_of_outputs(merge, err) && make_arguments(merge, options, &arena, &arguments, err) &&
        make_options(merge, options, &arguments, &of_render, err)) {
        of_render.render.merged = &merge->merged;
        of_render.render.shard.by_tiles = merge->by_tiles;
        code = cmd_render(&of_render);
    }
    options_finish(&of_render);
    arena_finish(&arena);
    return code >= 0 ? code : command_fail(err);
}

// --- the status ----------------------------------------------------------------------------------

static void print_status(struct merge *merge, const struct lacking *lacking)
{
    for (uint32_t i = 0; i < merge->count; i++) {
        const struct merge_part *part = &merge->parts[i];
        const uint64_t has = samples_count(&part->samples), wanted = samples_count(&part->wanted);
        const char *samples = samples_text(&part->wanted, &merge->arena);
        printf("part      ");
        print_words(part->path);
        printf(": %s %s, %s, %.0f %%\n", merge->by_tiles ? "rows" : "samples",
               samples ? samples : "", has == wanted ? "finished" : "unfinished",
               100.0 * (double)has / (double)wanted);
    }
    const uint64_t missing = samples_count(&lacking->samples);
    const char *text = samples_text(&lacking->samples, &merge->arena);
    if (missing == 0) {
        printf("complete  all %" PRIu64 " %s\n", merge->all, unit(merge));
        return;
    }
    printf("missing   %" PRIu64 " of %" PRIu64 " %s (%s)\n", missing, merge->all, unit(merge),
           text ? text : "");
    if (lacking->has_odd_begin)
        printf("some missing ones belong to none of these parts, and " ODD_BEGIN "\n");
    else if (lacking->pieces.count > 0)
        printf("some missing ones belong to none of these parts; these commands render them:\n");
    print_commands(stdout, &lacking->pieces);
    if (lacking->resumes.count > 0)
        printf("these commands finish the unfinished parts, unless their shards still run:\n");
    print_commands(stdout, &lacking->resumes);
}

static json_t *part_json(struct merge *merge, const struct merge_part *part)
{
    const char *wanted = samples_text(&part->wanted, &merge->arena);
    const char *has = samples_text(&part->samples, &merge->arena);
    return json_pack("{s:o, s:s, s:s, s:b}", "part", json_words(part->path), "wanted",
                     wanted ? wanted : "", "has", has ? has : "", "finished",
                     samples_count(&part->samples) == samples_count(&part->wanted));
}

static int print_status_json(struct merge *merge, const struct lacking *lacking)
{
    const char *missing = samples_text(&lacking->samples, &merge->arena);
    const char *unclaimed = samples_text(&lacking->unclaimed, &merge->arena);
    const struct commands *pieces = &lacking->pieces, *resumes = &lacking->resumes;
    json_t *parts = json_array();
    for (uint32_t i = 0; i < merge->count; i++)
        json_array_append_new(parts, part_json(merge, &merge->parts[i]));
    return command_print(json_pack(
        "{s:o, s:s, s:I, s:I, s:s, s:s, s:o, s:o, s:o}", "parts", parts, "by",
        merge->by_tiles ? "tiles" : "samples", "planned", (json_int_t)merge->planned, "all",
        (json_int_t)merge->all, "missing", missing ? missing : "", "unclaimed",
        unclaimed ? unclaimed : "", "commands", json_word_list(pieces->list, pieces->count),
        "resumes", json_word_list(resumes->list, resumes->count), "reason",
        lacking->has_odd_begin ? json_string(ODD_BEGIN) : json_null()));
}

static int show_status(const struct options *options)
{
    const struct merge_params params = {
        .paths = options->arguments,
        .count = options->argument_count,
        .mixed = true,
        .only_look_at = true,
    };
    struct merge merge = {0};
    struct lacking lacking = {0};
    struct err err = {0};
    int code = EXIT_CODE_OK;
    if (!merge_open(&params, &merge, &err) ||
        !expected_check_parts(&merge, options->merge.expected, &err) ||
        !find_lacking(&merge, &lacking, &err)) {
        code = command_fail(&err);
    } else {
        if (options->json)
            code = print_status_json(&merge, &lacking);
        else if (!options->quiet)
            print_status(&merge, &lacking);
        if (code == EXIT_CODE_OK && lacking.samples.count > 0)
            code = EXIT_CODE_CHECK_FAILED;
    }
    merge_finish(&merge);
    return code;
}

// --- the command ---------------------------------------------------------------------------------

static bool merge_parts(struct merge *merge, const struct options *options, bool writes_picture,
                        struct err *err)
{
    const char *kept = options->render.checkpoint;
    const struct merge_params params = {
        .paths = options->arguments,
        .count = options->argument_count,
        .mixed = options->merge.mixed,
        .partial = options->merge.partial,
    };
    if (kept && file_exists(kept))
        return err_set(err, ERR_INPUT, "--checkpoint %s: exists already; expected another name",
                       kept);
    if ((kept && !file_check_writable(kept, err)) || !merge_open(&params, merge, err) ||
        !expected_check_parts(merge, options->merge.expected, err))
        return false;
    for (uint32_t i = 0; i < options->render.output_count; i++)
        if (!outputs_check_one(options->render.outputs[i], err) ||
            !file_inputs_check(options->render.outputs[i], err) ||
            !file_check_distinct(options->render.outputs[i], kept, err))
            return false;
    if (!check_missing(merge, options, writes_picture, err) ||
        !merge_add_films(merge, options->progress, err))
        return false;
    if (merge->merged.devices)
        compare_devices(merge);
    return !kept || merge_write(merge, kept, err);
}

static void print_kept(struct merge *merge, const struct options *options)
{
    const char *samples = samples_text(&merge->samples, &merge->arena);
    fputs("kept      ", stdout);
    print_words(options->render.checkpoint);
    printf(merge->by_tiles ? ", rows %s of %" PRIu64 ", from %u parts\n"
                           : ", samples %s of %" PRIu64 " a pixel, from %u parts\n",
           samples ? samples : "", merge->all, merge->count);
}

static int print_kept_json(struct merge *merge, const struct options *options)
{
    const char *samples = samples_text(&merge->samples, &merge->arena);
    return command_print(
        json_pack("{s:o, s:s, s:s, s:I, s:I}", "checkpoint", json_words(options->render.checkpoint),
                  "by", merge->by_tiles ? "tiles" : "samples", "has", samples ? samples : "", "all",
                  (json_int_t)merge->all, "parts", (json_int_t)merge->count));
}

int cmd_merge(const struct options *options)
{
    const bool writes_picture = options->render.output_count > 0 || !options->render.checkpoint;
    struct merge merge = {0};
    struct err err = {0};
    int code = EXIT_CODE_OK;
    if (options->merge.status)
        return show_status(options);
    if (!merge_parts(&merge, options, writes_picture, &err)) {
        code = command_fail(&err);
    } else {
        progress_end(options->progress);
        if (options->render.checkpoint && !options->quiet && !options->json)
            print_kept(&merge, options);
        if (writes_picture)
            code = write_picture(&merge, options, &err);
        else if (options->json)
            code = print_kept_json(&merge, options);
    }
    if (code == EXIT_CODE_OK)
        leftovers_remove(options->arguments, options->argument_count);
    merge_finish(&merge);
    return code;
}
