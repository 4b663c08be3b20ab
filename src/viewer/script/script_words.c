#include "viewer/script/script_words.h"

#include "base/file.h"
#include "base/suggest.h"
#include "viewer/script/script_keys.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define WORDS_MAX 8u

// The words of a line while it is parsed.
struct words {
    const char *list[WORDS_MAX];
    uint32_t count, next;
};

typedef bool (*parse_fn)(struct words *words, struct command_line *out, struct err *err);

static const char *take(struct words *words)
{
    return words->next < words->count ? words->list[words->next++] : NULL;
}

// --- arguments -----------------------------------------------------------------------------------

static bool take_text(struct words *words, const char *what, const char **out, struct err *err)
{
    *out = take(words);
    return *out || err_set(err, ERR_INPUT, "%s is missing", what);
}

static bool take_number(struct words *words, const char *what, double *out, struct err *err)
{
    const char *text;
    char *end;
    if (!take_text(words, what, &text, err))
        return false;
    *out = strtod(text, &end);
    return (end != text && *end == '\0' && isfinite(*out)) ||
           err_set(err, ERR_INPUT, "%s: \"%s\" is not a number", what, text);
}

static bool take_count(struct words *words, const char *what, double most, double *out,
                       struct err *err)
{
    return take_number(words, what, out, err) &&
           ((*out >= 0 && *out <= most && *out == floor(*out)) ||
            err_set(err, ERR_INPUT, "%s: %g is not a whole number from 0 to %.0f", what, *out,
                    most));
}

// Takes a word that is in a NULL-terminated list, and returns its index in *out. Returns false
// without taking the word if it is not in the list.
static bool take_one_of(struct words *words, const char *const *names, int *out)
{
    for (int i = 0; words->next < words->count && names[i]; i++)
        if (strcmp(words->list[words->next], names[i]) == 0) {
            words->next++;
            *out = i;
            return true;
        }
    return false;
}

static void take_press(struct words *words, enum press *out)
{
    static const char *const names[] = {"down", "up", NULL};
    int index;
    *out = PRESS_BOTH;
    if (take_one_of(words, names, &index))
        *out = index == 0 ? PRESS_DOWN : PRESS_UP;
}

static void take_side(struct words *words, uint32_t *out)
{
    static const char *const names[] = {"a", "b", NULL};
    int index = 0;
    take_one_of(words, names, &index);
    *out = (uint32_t)index;
}

static bool take_flag(struct words *words, const char *name)
{
    const char *const names[] = {name, NULL};
    int index;
    return take_one_of(words, names, &index);
}

// --- commands ------------------------------------------------------------------------------------

static bool parse_nothing(struct words *words, struct command_line *out, struct err *err)
{
    (void)words, (void)out, (void)err;
    return true;
}

static bool parse_key(struct words *words, struct command_line *out, struct err *err)
{
    const char *name;
    if (!take_text(words, "the key's name", &name, err) ||
        !script_key(name, &out->code, &out->modifiers, err))
        return false;
    take_press(words, &out->press);
    return true;
}

static bool parse_pair(struct words *words, struct command_line *out, struct err *err)
{
    return take_number(words, "X", &out->numbers[0], err) &&
           take_number(words, "Y", &out->numbers[1], err);
}

static bool parse_button(struct words *words, struct command_line *out, struct err *err)
{
    static const char *const names[] = {"left", "right", "middle", NULL};
    if (!take_one_of(words, names, &out->code))
        return err_set(err, ERR_INPUT, "expected left, right or middle");
    take_press(words, &out->press);
    return true;
}

static bool parse_id(struct words *words, struct command_line *out, struct err *err)
{
    return take_text(words, "the control's id", &out->texts[0], err);
}

static bool parse_drag(struct words *words, struct command_line *out, struct err *err)
{
    return parse_id(words, out, err) && parse_pair(words, out, err);
}

static bool parse_words(struct words *words, struct command_line *out, struct err *err)
{
    return take_text(words, "the text", &out->texts[0], err);
}

static bool parse_set(struct words *words, struct command_line *out, struct err *err)
{
    return parse_id(words, out, err) && take_text(words, "the value", &out->texts[1], err);
}

static bool parse_file(struct words *words, struct command_line *out, struct err *err)
{
    return take_text(words, "the file's name", &out->texts[0], err);
}

static bool parse_resize(struct words *words, struct command_line *out, struct err *err)
{
    return take_count(words, "the width", 16384, &out->numbers[0], err) &&
           take_count(words, "the height", 16384, &out->numbers[1], err) &&
           ((out->numbers[0] >= 1 && out->numbers[1] >= 1) ||
            err_set(err, ERR_INPUT, "the size of a window is at least 1 x 1 pixels"));
}

static bool parse_wait(struct words *words, struct command_line *out, struct err *err)
{
    static const char *const units[] = {
        [WAIT_FRAMES] = "frames", [WAIT_MS] = "ms", [WAIT_SAMPLES] = "samples", NULL};
    int unit;
    if (take_flag(words, "idle")) {
        out->unit = WAIT_IDLE;
        return true;
    }
    if (!take_count(words, "the time to wait", 1e9, &out->numbers[0], err))
        return false;
    if (!take_one_of(words, units, &unit))
        return err_set(err, ERR_INPUT, "expected frames, ms or samples after the number");
    out->unit = (enum wait_unit)unit;
    return true;
}

static bool parse_screenshot(struct words *words, struct command_line *out, struct err *err)
{
    if (!parse_file(words, out, err))
        return false;
    out->with_panel = take_flag(words, "panel");
    return true;
}

static bool parse_exr(struct words *words, struct command_line *out, struct err *err)
{
    if (!parse_file(words, out, err))
        return false;
    take_side(words, &out->side);
    out->denoised = take_flag(words, "denoised");
    return true;
}

static bool parse_hash(struct words *words, struct command_line *out, struct err *err)
{
    if (!parse_file(words, out, err))
        return false;
    take_side(words, &out->side);
    return true;
}

static bool parse_check(struct words *words, struct command_line *out, struct err *err)
{
    static const char *const effects[] = {
        [EFFECT_RESULT] = "result", [EFFECT_PICTURE] = "picture", [EFFECT_STATE] = "state", NULL};
    int effect = EFFECT_RESULT;
    if (!parse_set(words, out, err))
        return false;
    take_one_of(words, effects, &effect);
    out->effect = (enum effect)effect;
    return true;
}

static const char *const comparisons[] = {
    [COMPARE_EQUAL] = "==",   [COMPARE_UNEQUAL] = "!=", [COMPARE_LESS] = "<",
    [COMPARE_AT_MOST] = "<=", [COMPARE_GREATER] = ">",  [COMPARE_AT_LEAST] = ">=",
    [COMPARE_CONTAINS] = "~", [COMPARE_LACKS] = "!~",   NULL};

const char *comparison_name(enum comparison comparison)
{
    return comparisons[comparison];
}

static bool parse_expect(struct words *words, struct command_line *out, struct err *err)
{
    int comparison;
    if (!take_text(words, "the key of a value in the state", &out->texts[0], err))
        return false;
    if (!take_one_of(words, comparisons, &comparison))
        return err_set(err, ERR_INPUT, "expected one of == != < <= > >= ~ !~ after \"%s\"",
                       out->texts[0]);
    out->comparison = (enum comparison)comparison;
    return take_text(words, "the value", &out->texts[1], err);
}

static bool parse_copy(struct words *words, struct command_line *out, struct err *err)
{
    return parse_file(words, out, err) && take_text(words, "the copy's name", &out->texts[1], err);
}

static bool parse_timeout(struct words *words, struct command_line *out, struct err *err)
{
    return take_number(words, "the seconds", &out->numbers[0], err) &&
           (out->numbers[0] > 0 || err_set(err, ERR_INPUT, "expected more than 0 seconds"));
}

static const struct {
    const char *name, *usage;
    parse_fn parse;
} verbs[VERB_COUNT] = {
    [VERB_KEY] = {"key", "key NAME [down|up]", parse_key},
    [VERB_MOUSE] = {"mouse", "mouse X Y", parse_pair},
    [VERB_BUTTON] = {"button", "button left|right|middle [down|up]", parse_button},
    [VERB_CLICK] = {"click", "click ID", parse_id},
    [VERB_DRAG] = {"drag", "drag ID DX DY", parse_drag},
    [VERB_SCROLL] = {"scroll", "scroll DX DY", parse_pair},
    [VERB_TEXT] = {"text", "text \"WORDS\"", parse_words},
    [VERB_SET] = {"set", "set ID VALUE", parse_set},
    [VERB_PRESS] = {"press", "press ID", parse_id},
    [VERB_DROP] = {"drop", "drop FILE", parse_file},
    [VERB_RESIZE] = {"resize", "resize WIDTH HEIGHT", parse_resize},
    [VERB_MINIMISE] = {"minimise", "minimise", parse_nothing},
    [VERB_RESTORE] = {"restore", "restore", parse_nothing},
    [VERB_CLOSE] = {"close", "close", parse_nothing},
    [VERB_WAIT] = {"wait", "wait N frames|ms|samples, or wait idle", parse_wait},
    [VERB_SCREENSHOT] = {"screenshot", "screenshot FILE [panel]", parse_screenshot},
    [VERB_EXR] = {"exr", "exr FILE [a|b] [denoised]", parse_exr},
    [VERB_SCENE] = {"scene", "scene FILE", parse_file},
    [VERB_HASH] = {"hash", "hash FILE [a|b]", parse_hash},
    [VERB_STATE] = {"state", "state FILE", parse_file},
    [VERB_CHECK] = {"check", "check ID VALUE [result|picture|state]", parse_check},
    [VERB_EXPECT] = {"expect", "expect KEY OPERATOR VALUE", parse_expect},
    [VERB_TOUCH] = {"touch", "touch FILE", parse_file},
    [VERB_COPY] = {"copy", "copy FROM TO", parse_copy},
    [VERB_LOSE_DEVICE] = {"lose-device", "lose-device", parse_nothing},
    [VERB_TIMEOUT] = {"timeout", "timeout SECONDS", parse_timeout},
    [VERB_QUIT] = {"quit", "quit", parse_nothing},
};

static bool parse_line(struct words *words, struct command_line *out, struct err *err)
{
    const char *name = take(words);
    struct suggestion suggestion = {.wanted = name};
    for (int i = 0; i < VERB_COUNT; i++) {
        suggest_offer(&suggestion, verbs[i].name);
        if (strcmp(verbs[i].name, name) != 0)
            continue;
        out->verb = (enum verb)i;
        if (!verbs[i].parse(words, out, err))
            return err_set(err, ERR_INPUT, "%s; expected: %s", err->msg, verbs[i].usage);
        return words->next == words->count ||
               err_set(err, ERR_INPUT, "\"%s\" is unexpected; expected: %s",
                       words->list[words->next], verbs[i].usage);
    }
    return err_set(err, ERR_INPUT, "there is no command %s%s%s%s", name,
                   suggestion.nearest ? "; did you mean " : "",
                   suggestion.nearest ? suggestion.nearest : "", suggestion.nearest ? "?" : "");
}

// --- lines ---------------------------------------------------------------------------------------

// Splits a line into words, in place. Words are separated by blanks, or are quoted; in quotes, a
// backslash escapes the next character. Text after a # outside of quotes is a comment.
static bool split(char *line, struct words *out, struct err *err)
{
    *out = (struct words){0};
    for (char *at = line;;) {
        at += strspn(at, " \t\r");
        if (*at == '\0' || *at == '#')
            return true;
        if (out->count == WORDS_MAX)
            return err_set(err, ERR_INPUT, "the line has more than %u words", WORDS_MAX);
        bool is_quoted = *at == '"';
        char *to = at, *from = at + is_quoted;
        out->list[out->count++] = at;
        while (*from && (is_quoted ? *from != '"' : !strchr(" \t\r", *from))) {
            from += is_quoted && *from == '\\' && from[1];
            *to++ = *from++;
        }
        if (is_quoted && *from != '"')
            return err_set(err, ERR_INPUT, "a quotation mark is missing at the end");
        at = from + (*from != '\0');
        *to = '\0';
    }
}

bool script_read(const char *path, struct arena *arena, struct command_line **out, uint32_t *count,
                 struct err *err)
{
    struct file_bytes bytes;
    if (!file_read(arena, path, 16u << 20, &bytes, err))
        return false;
    uint32_t lines = 1;
    for (size_t i = 0; i < bytes.size; i++)
        lines += bytes.data[i] == '\n';
    char *text = arena_alloc(arena, bytes.size + 1, 1);
    *out = ARENA_NEW(arena, struct command_line, lines);
    *count = 0;
    if (!text || !*out)
        return err_memory(err, path, bytes.size);
    memcpy(text, bytes.data, bytes.size);

    uint32_t number = 0;
    for (char *line = text; line;) {
        char *end = strchr(line, '\n');
        struct command_line *command = &(*out)[*count];
        struct words words;
        if (end)
            *end = '\0';
        number++;
        *command = (struct command_line){.line = number};
        if (!split(line, &words, err) || (words.count > 0 && !parse_line(&words, command, err)))
            return err_prepend(err, "%s:%u", path, number);
        *count += words.count > 0;
        line = end ? end + 1 : NULL;
    }
    return true;
}
