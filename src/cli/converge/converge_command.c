// Makes the command that renders the image of a curve again.
#include "cli/converge/converge.h"

#include "base/memory_stream.h"
#include "cli/commands.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// Returns whether an option is copied to the command. Options of `render` that affect how the image
// is computed are copied. Options that differ between curves or replicates are appended separately.
static bool is_kept(const struct option_def *def)
{
    switch ((enum option_id)(def - option_table)) {
    case OPTION_SPP:
    case OPTION_SEED:
    case OPTION_REFERENCE:
    case OPTION_ERROR_BY:
    case OPTION_JSON:
    case OPTION_QUIET:
    case OPTION_LOG_LEVEL:
        return false;
    default:
        return option_belongs(def, &commands[COMMAND_RENDER]);
    }
}

static const struct option_def *find(const char *argument, bool *is_attached)
{
    bool is_long = argument[1] == '-';
    size_t length = is_long ? strcspn(argument + 2, "=") : 1;
    for (int i = 0; i < OPTION_TOTAL; i++) {
        const struct option_def *def = &option_table[i];
        if (is_long ? strlen(def->name) != length || memcmp(def->name, argument + 2, length) != 0
                    : def->short_name != argument[1])
            continue;
        *is_attached = argument[is_long ? 2 + length : 2] != '\0';
        return def;
    }
    return NULL;
}

// Returns whether the curve has a value of its own for this option; put_varied() appends it.
static bool is_varied(const struct converge_curve *curve, const struct option_def *def)
{
    size_t length = strlen(def->name);
    for (const char *word = curve->variant.label; *word;) {
        if (strncmp(word, def->name, length) == 0 && word[length] == '=')
            return true;
        word += strcspn(word, " ");
        word += strspn(word, " ");
    }
    return false;
}

static bool put_word(FILE *out, const char *word)
{
    char *quoted = malloc(4 * strlen(word) + 4);
    if (!quoted)
        return false;
    options_quote(word, quoted);
    fprintf(out, " %s", quoted);
    free(quoted);
    return true;
}

static bool put_given(FILE *out, const struct options *options, const struct converge_curve *curve)
{
    bool ok = true;
    for (int i = 1; i < options->argc && ok; i++) {
        const char *argument = options->argv[i];
        bool is_attached = false;
        if (strcmp(argument, "--") == 0)
            break;
        if (argument[0] != '-' || argument[1] == '\0')
            continue; // the name of the command, or a scene
        const struct option_def *def = find(argument, &is_attached);
        bool has_value = def && def->type != VALUE_FLAG && !is_attached && i + 1 < options->argc;
        if (def && is_kept(def) && !is_varied(curve, def))
            ok = put_word(out, argument) && (!has_value || put_word(out, options->argv[i + 1]));
        i += has_value;
    }
    return ok;
}

static bool put_varied(FILE *out, struct arena *arena, const struct converge_curve *curve)
{
    const char *word = curve->variant.label;
    while (*word) {
        size_t length = strcspn(word, " ");
        if (strncmp(word, "seed=", 5) != 0) {
            const char *option = arena_printf(arena, "--%.*s", (int)length, word);
            if (!option || !put_word(out, option))
                return false;
        }
        word += length;
        word += strspn(word, " ");
    }
    return true;
}

bool converge_command(struct converge *c, const struct converge_curve *curve, const char **out,
                      struct err *err)
{
    struct memory_stream stream;
    if (!memory_stream_open(&stream))
        return err_memory(err, "a command", 0);
    FILE *file = stream.file;
    const char *scene = c->options->arguments[curve->variant.scene];
    // "--" separates a scene whose name begins with '-' from the options.
    bool is_last = scene[0] == '-';
    fputs("lampyris render", file);
    bool ok = (is_last || put_word(file, scene)) && put_given(file, c->options, curve) &&
              put_varied(file, &c->arena, curve);
    fprintf(file, " --seed %u --spp %llu%s", curve->scene_data.settings.seed,
            (unsigned long long)converge_at(c, curve, 0, c->point_count - 1)->spp,
            is_last ? " --" : "");
    ok = ok && (!is_last || put_word(file, scene));
    ok = memory_stream_close(&stream) && ok;
    *out = ok ? arena_strdup(&c->arena, stream.text) : NULL;
    memory_stream_finish(&stream);
    return *out || err_memory(err, "a command", 0);
}
