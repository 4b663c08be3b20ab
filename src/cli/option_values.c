#include "cli/options.h"

#include "base/file.h"
#include "base/suggest.h"
#include "image/image.h"
#include "render/aov_names.h"
#include "shared/bindings.h"
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

_Static_assert(sizeof(enum log_level) == sizeof(unsigned) &&
                   sizeof(enum bvh_split) == sizeof(unsigned) &&
                   sizeof(enum bvh_format) == sizeof(unsigned) &&
                   sizeof(enum bvh_optimize) == sizeof(unsigned) &&
                   sizeof(enum instancing) == sizeof(unsigned) &&
                   sizeof(enum shard_by) == sizeof(unsigned),
               "choices are stored as unsigned");

static bool check_range(double min, double max, double value, const char *text, struct err *err)
{
    return (value >= min && value <= max) ||
           err_set(err, ERR_USAGE, "\"%s\" is outside [%.15g, %.15g]", text, min, max);
}

// Parses digits, optionally followed by k, M or G for 2^10, 2^20 or 2^30, because waves, samples
// and bytes are often powers of two. Signs and blanks are errors. *rest is the remaining text.
// Returns false if there is no number or it is too large.
static bool parse_count(const char *text, uint64_t *out, const char **rest)
{
    if (*text < '0' || *text > '9')
        return false;
    char *end;
    errno = 0;
    uint64_t value = strtoull(text, &end, 10);
    if (errno != 0)
        return false;
    int shift = *end == 'k' || *end == 'K' ? 10 : *end == 'M' ? 20 : *end == 'G' ? 30 : 0;
    if (value > UINT64_MAX >> shift)
        return false;
    *out = value << shift;
    *rest = end + (shift > 0);
    return true;
}

// Parses a finite decimal number: strtod would also accept "nan", "inf", hexadecimal and leading
// blanks.
static bool parse_real(const char *text, double *out, const char **rest)
{
    size_t length = strspn(text, "+-.0123456789eE");
    if (length == 0 || strpbrk(text, "xX") == text + length)
        return false;
    char *end;
    *out = strtod(text, &end);
    *rest = end;
    return end != text && isfinite(*out);
}

static void store(struct options *options, const struct option_def *def, const void *value)
{
    memcpy((char *)options + def->offset, value, def->size);
}

static bool parse_switch(const char *text, bool *on, struct err *err)
{
    *on = strcmp(text, "on") == 0;
    return *on || strcmp(text, "off") == 0 ||
           err_set(err, ERR_USAGE, "\"%s\" is neither \"on\" nor \"off\"", text);
}

// Fails because a word is not among `words`, which are separated by bars, commas or blanks.
// Suggests the most similar one, or the only one that begins with it.
static bool fail_unknown_word(const char *text, size_t length, const char *words,
                              const char *expected, struct err *err)
{
    char wanted[64], list[256];
    snprintf(wanted, sizeof wanted, "%.*s", (int)length, text);
    snprintf(list, sizeof list, "%s", words);
    struct suggestion suggestion = {.wanted = wanted};
    const char *longer = NULL;
    int longer_count = 0;
    for (char *word = list, *end; *word; word = end) {
        end = word + strcspn(word, "|, ");
        char *next = end + strspn(end, "|, ");
        *end = '\0';
        end = next;
        suggest_offer(&suggestion, word);
        if (*wanted && strncmp(word, wanted, strlen(wanted)) == 0) {
            longer = word;
            longer_count++;
        }
    }
    const char *meant = suggestion.nearest ? suggestion.nearest : longer_count == 1 ? longer : NULL;
    return err_set(err, ERR_USAGE, "\"%.*s\" is unknown; %s%s%s%s%s", (int)length, text,
                   meant ? "did you mean \"" : "expected ", meant ? meant : "",
                   meant ? "\"? Expected " : "", expected, words);
}

// Finds the index of a word in a list separated by `|`.
static bool parse_choice(const char *words, const char *text, unsigned *index, struct err *err)
{
    size_t length = strlen(text);
    *index = 0;
    for (const char *word = words; word; (*index)++) {
        size_t word_length = strcspn(word, "|");
        if (length == word_length && memcmp(word, text, length) == 0)
            return true;
        word = word[word_length] ? word + word_length + 1 : NULL;
    }
    return fail_unknown_word(text, length, words, strchr(words, '|') ? "one of " : "", err);
}

// Parses a number, a switch or a choice, and stores it as the type of the option's field.
static bool parse_value(const struct option_def *def, const struct field *field, const char *text,
                        double *value, struct err *err)
{
    char words[OPTION_ARGUMENT_MAX];
    const char *rest;
    uint64_t count = 0;
    unsigned choice = 0;
    bool on = false, ok;
    switch (field->type) {
    case FIELD_SWITCH:
        ok = parse_switch(text, &on, err);
        *value = on;
        return ok;
    case FIELD_CHOICE:
        ok = parse_choice(option_argument(def, words), text, &choice, err);
        *value = choice;
        return ok;
    case FIELD_COUNT:
        if (!parse_count(text, &count, &rest) || *rest)
            return err_set(
                err, ERR_USAGE,
                "\"%s\" is not a number; expected digits, optionally followed by k, M or G", text);
        *value = (double)count;
        break;
    case FIELD_REAL:
        if (!parse_real(text, value, &rest) || *rest)
            return err_set(err, ERR_USAGE, "\"%s\" is not a finite number", text);
    }
    return check_range(field->min, field->max, *value, text, err);
}

static bool store_field(const struct option_def *def, const struct field *field, const char *text,
                        void *object, struct err *err)
{
    double value = 0;
    if (field->word && strcmp(text, field->word) == 0) {
        field_set_word(field, object);
        return true;
    }
    if (!parse_value(def, field, text, &value, err))
        return false;
    field_set(field, object, value);
    return true;
}

// Stores the value of an option whose type is one of enum field_type.
static bool store_member(const struct option_def *def, enum field_type type, const char *text,
                         struct options *options, struct err *err)
{
    const struct field field = {
        .type = type, .offset = def->offset, .size = def->size, .min = def->min, .max = def->max};
    return store_field(def, &field, text, options, err);
}

// Parses two counts with a separator: "640x480", "12,34".
static bool store_two(const struct option_def *def, char separator, const char *text,
                      struct options *options, struct err *err)
{
    uint64_t first, second;
    const char *rest;
    if (!parse_count(text, &first, &rest) || *rest != separator ||
        !parse_count(rest + 1, &second, &rest) || *rest)
        return err_set(err, ERR_USAGE, "\"%s\" is not of the form %s", text, def->argument);
    if (!check_range(def->min, def->max, (double)first, text, err) ||
        !check_range(def->min, def->max, (double)second, text, err))
        return false;
    uint32_t both[2] = {(uint32_t)first, (uint32_t)second};
    store(options, def, both);
    return true;
}

static bool store_window(const struct option_def *def, const char *text, struct options *options,
                         struct err *err)
{
    uint32_t all[4];
    const char *rest = text;
    for (int i = 0; i < 4; i++) {
        uint64_t value;
        if (!parse_count(rest, &value, &rest) || *rest != (i < 3 ? ',' : '\0'))
            return err_set(err, ERR_USAGE, "\"%s\" is not of the form %s", text, def->argument);
        if (!check_range(def->min, def->max, (double)value, text, err))
            return false;
        all[i] = (uint32_t)value;
        rest += i < 3;
    }
    if (all[0] >= all[2] || all[1] >= all[3])
        return err_set(err, ERR_USAGE, "\"%s\" has no pixel; expected X0 < X1 and Y0 < Y1", text);
    store(options, def, all);
    return true;
}

// In lists, whose words are separated by commas, a colon separates the two numbers.
static bool store_real_pair(const struct option_def *def, const char *text, struct options *options,
                            struct err *err)
{
    double both[2];
    const char *rest;
    if (!parse_real(text, &both[0], &rest) || (*rest != ',' && *rest != ':') ||
        !parse_real(rest + 1, &both[1], &rest) || *rest)
        return err_set(err, ERR_USAGE, "\"%s\" is not of the form %s", text, def->argument);
    if (!check_range(def->min, def->max, both[0], text, err) ||
        !check_range(def->min, def->max, both[1], text, err))
        return false;
    store(options, def, both);
    return true;
}

static bool store_size(const struct option_def *def, const char *text, struct options *options,
                       struct err *err)
{
    if (!store_two(def, 'x', text, options, err))
        return false;
    if ((uint64_t)options->scene.settings.width * options->scene.settings.height >
        SETTINGS_PIXELS_MAX)
        return err_set(err, ERR_USAGE, "\"%s\" is more than 2^31 pixels", text);
    return true;
}

static bool parse_color(const char *text, float out[3])
{
    for (int i = 0; i < 3; i++) {
        double value;
        const char *rest;
        if (!parse_real(text, &value, &rest) || *rest != (i < 2 ? ',' : '\0'))
            return false;
        out[i] = (float)value;
        text = rest + 1;
    }
    return true;
}

static bool store_environment(const char *text, struct options *options, struct err *err)
{
    struct environment_option *environment = &options->scene.environment;
    *environment = (struct environment_option){0};
    if (strncmp(text, "sky", 3) == 0 && (text[3] == '\0' || text[3] == ':')) {
        environment->is_sky = true;
        return sky_parse(text + (text[3] ? 4 : 3), &environment->sky, err);
    }
    // A text that consists of digits, signs and commas is a colour, even if it is not a valid one.
    bool is_color = strchr(text, ',') && text[strspn(text, "+-.0123456789eE,")] == '\0';
    if (!is_color) {
        environment->file = text;
        return *text ? true : err_set(err, ERR_USAGE, "the value is empty; expected FILE or R,G,B");
    }
    if (!parse_color(text, environment->radiance))
        return err_set(err, ERR_USAGE, "\"%s\" is not a colour; expected R,G,B as in 1,0.5,0",
                       text);
    for (int i = 0; i < 3; i++)
        if (!(environment->radiance[i] >= 0 && isfinite(environment->radiance[i])))
            return err_set(err, ERR_USAGE, "\"%s\" has a negative or too large component", text);
    environment->is_constant = true;
    return true;
}

// Parses ":END:FPS", the rest of a text "START:END:FPS". `whole` is the complete text, for
// messages.
static bool parse_range(const struct option_def *def, const char *text, const char *whole,
                        struct sequence_options *out, struct err *err)
{
    const char *rest;
    if (!parse_real(text + 1, &out->end, &rest) || *rest != ':' ||
        !parse_real(rest + 1, &out->frames_per_s, &rest) || *rest)
        return err_set(err, ERR_USAGE, "\"%s\" is not of the form START:END:FPS, as in 0:2:24",
                       whole);
    if (!check_range(def->min, def->max, out->end, whole, err))
        return false;
    if (!(out->end > out->start))
        return err_set(err, ERR_USAGE, "\"%s\" ends before it begins; expected START < END", whole);
    if (!(out->frames_per_s >= SEQUENCE_FPS_MIN && out->frames_per_s <= SEQUENCE_FPS_MAX))
        return err_set(err, ERR_USAGE, "\"%s\": FPS is outside [%g, %g]", whole, SEQUENCE_FPS_MIN,
                       SEQUENCE_FPS_MAX);
    return (out->end - out->start) * out->frames_per_s <= SEQUENCE_FRAMES_MAX ||
           err_set(err, ERR_USAGE, "\"%s\" is more than %u pictures", whole, SEQUENCE_FRAMES_MAX);
}

// For a range, the scene is loaded with its pose at START.
static bool store_at(const struct option_def *def, const char *text, struct options *options,
                     struct err *err)
{
    struct sequence_options *sequence = &options->render.sequence;
    const char *rest;
    double start;
    if (!parse_real(text, &start, &rest) || (*rest && *rest != ':'))
        return err_set(err, ERR_USAGE, "\"%s\" is not a finite number, nor START:END:FPS", text);
    if (!check_range(def->min, def->max, start, text, err))
        return false;
    options->scene.at_seconds = sequence->start = start;
    sequence->is_animation = *rest == ':';
    return !sequence->is_animation || parse_range(def, rest, text, sequence, err);
}

static bool store_output(const char *text, struct options *options, struct err *err)
{
    if (!output_is_video(text) && !image_check_format(text, err))
        return false;
    for (uint32_t i = 0; i < options->render.output_count; i++)
        if (strcmp(options->render.outputs[i], text) == 0)
            return err_set(err, ERR_USAGE, "\"%s\" is given twice", text);
    options->render.outputs[options->render.output_count++] = text;
    return true;
}

static bool store_define(const char *text, struct options *options, struct err *err)
{
    const char *equals = strchr(text, '=');
    if (!equals || equals == text)
        return err_set(err, ERR_USAGE, "\"%s\" is not of the form KEY=VALUE", text);
    char *key = arena_printf(&options->arena, "%.*s", (int)(equals - text), text);
    if (!key)
        return err_memory(err, "a key", strlen(text));
    options->scene.overrides[options->scene.override_count++] =
        (struct scene_override){key, equals + 1};
    return true;
}

static bool store_vary(const char *text, struct options *options, struct err *err)
{
    const char *equals = strchr(text, '=');
    if (!equals || equals == text || !equals[1])
        return err_set(err, ERR_USAGE, "\"%s\" is not of the form KEY=A,B,...", text);
    options->study.vary[options->study.vary_count++] = text;
    return true;
}

static bool store_times(const struct option_def *def, const char *text, struct options *options,
                        struct err *err)
{
    double *list = ARENA_NEW(&options->arena, double, strlen(text));
    uint32_t count = 0;
    if (!list)
        return err_memory(err, "times", strlen(text) * sizeof *list);
    for (const char *rest = text;; rest++) {
        double value;
        if (!parse_real(rest, &value, &rest) || (*rest && *rest != ','))
            return err_set(err, ERR_USAGE, "\"%s\" is not of the form %s", text, def->argument);
        if (!check_range(def->min, def->max, value, text, err))
            return false;
        if (count > 0 && value <= list[count - 1])
            return err_set(err, ERR_USAGE, "\"%s\": expected times in ascending order", text);
        list[count++] = value;
        if (!*rest)
            break;
    }
    options->converge.times = list;
    options->converge.time_count = count;
    return true;
}

static bool store_depths(const struct option_def *def, const char *text, struct options *options,
                         struct err *err)
{
    uint32_t *list = ARENA_NEW(&options->arena, uint32_t, strlen(text));
    uint32_t count = 0;
    if (!list)
        return err_memory(err, "depths", strlen(text) * sizeof *list);
    for (const char *rest = text;; rest++) {
        uint64_t value;
        if (!parse_count(rest, &value, &rest) || (*rest && *rest != ','))
            return err_set(err, ERR_USAGE, "\"%s\" is not of the form %s", text, def->argument);
        if (!check_range(def->min, def->max, (double)value, text, err))
            return false;
        list[count++] = (uint32_t)value;
        if (!*rest)
            break;
    }
    options->bench.depths = list;
    options->bench.depth_count = count;
    return true;
}

static bool store_rays(const char *text, struct options *options, struct err *err)
{
    static const char *const words[] = {
        [RAYS_PRIMARY] = "primary",
        [RAYS_DIFFUSE] = "diffuse",
        [RAYS_SHADOW] = "shadow",
    };
    const uint32_t count = sizeof words / sizeof words[0];
    options->bench.rays = 0;
    for (const char *word = text; word;) {
        size_t length = strcspn(word, ",");
        uint32_t i = 0;
        while (i < count && (strlen(words[i]) != length || memcmp(words[i], word, length) != 0))
            i++;
        if (i == count)
            return fail_unknown_word(word, length, "primary, diffuse, shadow", "some of ", err);
        options->bench.rays |= 1u << i;
        word = word[length] ? word + length + 1 : NULL;
    }
    return true;
}

static bool store_limit(const struct option_def *def, const char *text, struct options *options,
                        struct err *err)
{
    size_t length = strcspn(text, "=");
    int metric = compare_metric_find(text, length);
    if (length == 0 || !text[length])
        return err_set(err, ERR_USAGE, "\"%s\" is not of the form %s", text, def->argument);
    if (metric < 0)
        return fail_unknown_word(text, length,
                                 "mse, rmse, relmse, local-relmse, smape, psnr, ssim, flip, "
                                 "hdr-flip, max, nonfinite, differing",
                                 "one of ", err);
    bool is_minimum = def == &option_table[OPTION_MIN];
    if (is_minimum != compare_greater_is_better((enum compare_metric)metric))
        return err_set(err, ERR_USAGE, "\"%s\": a greater %s is %s; use --%s", text,
                       compare_metric_names[metric], is_minimum ? "worse" : "better",
                       option_table[is_minimum ? OPTION_MAX : OPTION_MIN].name);
    double value;
    const char *rest;
    if (!parse_real(text + length + 1, &value, &rest) || *rest || value < 0)
        return err_set(err, ERR_USAGE, "\"%s\": the limit is not a finite number >= 0", text);
    options->compare.limits[options->compare.limit_count++] =
        (struct compare_limit){(enum compare_metric)metric, is_minimum, value};
    return true;
}

static bool err_unknown_word(const char *word, size_t length, const struct aov_name *words,
                             struct err *err)
{
    char known[200] = "";
    for (size_t i = 0; words[i].name; i++)
        snprintf(known + strlen(known), sizeof known - strlen(known), "%s%s", i ? ", " : "",
                 words[i].name);
    return fail_unknown_word(word, length, known, "some of ", err);
}

// Parses words separated by commas, and adds the bits of all of them to the option's value.
static bool store_bits(const struct option_def *def, const struct aov_name *words, const char *text,
                       struct options *options, struct err *err)
{
    uint32_t bits;
    memcpy(&bits, (const char *)options + def->offset, sizeof bits);
    for (const char *word = text; word;) {
        size_t length = strcspn(word, ","), i = 0;
        while (words[i].name &&
               (strlen(words[i].name) != length || memcmp(words[i].name, word, length) != 0))
            i++;
        if (!words[i].name)
            return err_unknown_word(word, length, words, err);
        bits |= words[i].bits;
        word = word[length] ? word + length + 1 : NULL;
    }
    store(options, def, &bits);
    return true;
}

bool option_store(const struct option_def *def, const char *text, struct options *options,
                  struct err *err)
{
    switch (def->type) {
    case VALUE_FLAG:
        store(options, def, &(bool){true});
        return true;
    case VALUE_SWITCH:
        return store_member(def, FIELD_SWITCH, text, options, err);
    case VALUE_COUNT:
        return store_member(def, FIELD_COUNT, text, options, err);
    case VALUE_REAL:
        return store_member(def, FIELD_REAL, text, options, err);
    case VALUE_CHOICE:
        return store_member(def, FIELD_CHOICE, text, options, err);
    case VALUE_SETTING:
        return store_field(def, &def->setting->field, text, &options->scene.settings, err);
    case VALUE_TEXT:
        if (!*text)
            return err_set(err, ERR_USAGE, "the value is empty; expected %s", def->argument);
        store(options, def, &text);
        return true;
    case VALUE_SIZE:
        return store_size(def, text, options, err);
    case VALUE_PAIR:
        return store_two(def, ',', text, options, err);
    case VALUE_REAL_PAIR:
        return store_real_pair(def, text, options, err);
    case VALUE_ENVIRONMENT:
        return store_environment(text, options, err);
    case VALUE_WINDOW:
        return store_window(def, text, options, err);
    case VALUE_AT:
        return store_at(def, text, options, err);
    case VALUE_OUTPUT:
        return store_output(text, options, err);
    case VALUE_DEFINE:
        return store_define(text, options, err);
    case VALUE_LIMIT:
        return store_limit(def, text, options, err);
    case VALUE_VARY:
        return store_vary(text, options, err);
    case VALUE_CURVE:
        if (!strchr(text, '='))
            return err_set(err, ERR_USAGE, "\"%s\" is not of the form %s", text, def->argument);
        options->study.curves[options->study.curve_count++] = text;
        return true;
    case VALUE_TIMES:
        return store_times(def, text, options, err);
    case VALUE_DEPTHS:
        return store_depths(def, text, options, err);
    case VALUE_RAYS:
        return store_rays(text, options, err);
    case VALUE_AOVS:
        return store_bits(def, aov_names, text, options, err);
    case VALUE_KINDS:
        return store_bits(def, error_by_names, text, options, err);
    }
    return err_set(err, ERR_BUG, "an option of unknown type");
}
