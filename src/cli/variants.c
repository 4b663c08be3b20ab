#include "cli/variants.h"

#include "base/suggest.h"
#include "cli/commands.h"
#include <stdio.h>
#include <string.h>

// Returns the n-th word of a list separated by commas; NULL after the last one.
static const char *nth_word(const char *words, uint32_t n, size_t *length)
{
    for (; n > 0; n--) {
        words = strchr(words, ',');
        if (!words)
            return NULL;
        words++;
    }
    *length = strcspn(words, ",");
    return words;
}

static uint32_t count_words(const char *words)
{
    uint32_t count = 1;
    for (; *words; words++)
        count += *words == ',';
    return count;
}

// Returns whether all values of the option give the same image, bit for bit.
static bool keeps_picture(const struct option_def *def)
{
    static const enum option_id those[] = {OPTION_WAVE,         OPTION_WORKGROUP, OPTION_FEATURES,
                                           OPTION_CLASSES,      OPTION_BVH,       OPTION_NODE,
                                           OPTION_BVH_OPTIMIZE, OPTION_BVH_LEAF,  OPTION_BVH_COSTS};
    for (size_t i = 0; i < sizeof those / sizeof those[0]; i++)
        if (def == &option_table[those[i]])
            return true;
    return false;
}

// Joins two lists of "KEY=VALUE", either of which may be empty, by a blank.
static const char *join(struct arena *arena, const char *first, const char *second)
{
    return arena_printf(arena, "%s%s%s", first, *first && *second ? " " : "", second);
}

// Returns whether the option may differ between renders of the command.
static bool may_vary(const struct option_def *def, const struct command *command)
{
    return option_belongs(def, command) && option_is_setting(def, command);
}

static bool fail_no_setting(const char *whole, const char *key, size_t length,
                            const struct command *command, struct err *err)
{
    char wanted[64];
    snprintf(wanted, sizeof wanted, "%.*s", (int)length, key);
    struct suggestion suggestion = {.wanted = wanted};
    for (int i = 0; i < OPTION_TOTAL; i++)
        if (may_vary(&option_table[i], command))
            suggest_offer(&suggestion, option_table[i].name);
    if (suggestion.nearest)
        return err_set(err, ERR_USAGE, "\"%s\": \"%.*s\" is not a setting; did you mean \"%s\"?",
                       whole, (int)length, key, suggestion.nearest);
    return err_set(err, ERR_USAGE,
                   "\"%s\": \"%.*s\" is not a setting; expected an option of the groups Method "
                   "and Kernels, or max-bounces, seed or wave%s",
                   whole, (int)length, key,
                   command == &commands[COMMAND_BENCH] ? ", spp or size" : "");
}

// Sets an option of the variant from "KEY=VALUE". `whole` is the text on the command line, for
// messages.
static bool set(struct variant *variant, struct arena *arena, const char *whole, const char *pair,
                struct err *err)
{
    struct options *options = &variant->options;
    size_t key_length = strcspn(pair, "=");
    const struct option_def *def = option_find(pair, key_length);
    if (!def || !may_vary(def, options->command))
        return fail_no_setting(whole, pair, key_length, options->command, err);
    if (!option_store(def, pair + key_length + 1, options, err))
        return err_prepend(err, "\"%s\"", whole);
    option_mark(def, options);
    if (!keeps_picture(def))
        variant->picture = join(arena, variant->picture, pair);
    return variant->picture || err_memory(err, "a label", strlen(pair));
}

// Applies combination number `index` of the values; the last list varies fastest.
static bool vary(struct variant *variant, struct arena *arena, uint32_t index, struct err *err)
{
    const struct options *options = &variant->options;
    uint32_t divisor = 1;
    for (uint32_t v = 1; v < options->study.vary_count; v++)
        divisor *= count_words(strchr(options->study.vary[v], '=') + 1);
    for (uint32_t v = 0; v < options->study.vary_count; v++) {
        const char *text = options->study.vary[v], *words = strchr(text, '=') + 1;
        size_t length = 0;
        const char *word = nth_word(words, index / divisor % count_words(words), &length);
        const char *pair =
            arena_printf(arena, "%.*s%.*s", (int)(words - text), text, (int)length, word);
        if (pair)
            variant->label = join(arena, variant->label, pair);
        if (!pair || !variant->label)
            return err_memory(err, "a label", length);
        if (!set(variant, arena, text, pair, err))
            return false;
        if (v + 1 < options->study.vary_count)
            divisor /= count_words(strchr(options->study.vary[v + 1], '=') + 1);
    }
    return true;
}

// Applies all words of a text "KEY=VALUE KEY=VALUE".
static bool spell(struct variant *variant, struct arena *arena, const char *text, struct err *err)
{
    variant->label = text;
    for (const char *word = text + strspn(text, " "); *word; word += strspn(word, " ")) {
        size_t length = strcspn(word, " "), key_length = strcspn(word, "= ");
        if (word[key_length] != '=' || key_length == 0 || key_length + 1 == length)
            return err_set(err, ERR_USAGE, "\"%s\" is not of the form \"KEY=VALUE KEY=VALUE\"",
                           text);
        const char *pair = arena_printf(arena, "%.*s", (int)length, word);
        if (!pair)
            return err_memory(err, "a label", length);
        if (!set(variant, arena, text, pair, err))
            return false;
        word += length;
    }
    return true;
}

bool variants_share_picture(const struct variant *a, const struct variant *b)
{
    return a->scene == b->scene && strcmp(a->picture, b->picture) == 0;
}

bool variants_make(const struct options *options, struct arena *arena, struct variant **out,
                   uint32_t *count, struct err *err)
{
    uint64_t combinations = options->study.vary_count || !options->study.curve_count;
    for (uint32_t v = 0; v < options->study.vary_count && combinations <= VARIANTS_MAX; v++)
        combinations *= count_words(strchr(options->study.vary[v], '=') + 1);
    uint64_t of_a_scene = combinations + options->study.curve_count;
    uint64_t all = of_a_scene * options->argument_count;
    if (all > VARIANTS_MAX)
        return err_set(err, ERR_USAGE, "%s%llu variants; expected at most %d",
                       combinations > VARIANTS_MAX ? "at least " : "", (unsigned long long)all,
                       VARIANTS_MAX);
    struct variant *list = ARENA_NEW(arena, struct variant, all);
    if (!list)
        return err_memory(err, "variants", all * sizeof *list);
    for (uint32_t i = 0; i < all; i++) {
        uint32_t number = i % (uint32_t)of_a_scene;
        list[i] = (struct variant){
            .label = "",
            .scene = i / (uint32_t)of_a_scene,
            .picture = "",
            .options = *options,
        };
        list[i].options.scene.path = options->arguments[list[i].scene];
        if (!(number < options->study.curve_count
                  ? spell(&list[i], arena, options->study.curves[number], err)
                  : vary(&list[i], arena, number - options->study.curve_count, err)))
            return false;
    }
    *out = list;
    *count = (uint32_t)all;
    return true;
}
