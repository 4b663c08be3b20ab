// Parses scripts. All commands and their arguments are checked before any command runs.
#ifndef LAMPYRIS_VIEWER_SCRIPT_SCRIPT_WORDS_H
#define LAMPYRIS_VIEWER_SCRIPT_SCRIPT_WORDS_H

#include "base/arena.h"
#include "base/err.h"
#include <stdbool.h>
#include <stdint.h>

enum verb {
    VERB_KEY,
    VERB_MOUSE,
    VERB_BUTTON,
    VERB_CLICK,
    VERB_DRAG,
    VERB_SCROLL,
    VERB_TEXT,
    VERB_SET,
    VERB_PRESS,
    VERB_DROP,
    VERB_RESIZE,
    VERB_MINIMISE,
    VERB_RESTORE,
    VERB_CLOSE,
    VERB_WAIT,
    VERB_SCREENSHOT,
    VERB_EXR,
    VERB_SCENE,
    VERB_HASH,
    VERB_STATE,
    VERB_CHECK,
    VERB_EXPECT,
    VERB_TOUCH,
    VERB_COPY,
    VERB_LOSE_DEVICE,
    VERB_TIMEOUT,
    VERB_QUIT,
    VERB_COUNT
};

enum press { PRESS_BOTH, PRESS_DOWN, PRESS_UP };
enum wait_unit { WAIT_FRAMES, WAIT_MS, WAIT_SAMPLES, WAIT_IDLE };
enum comparison {
    COMPARE_EQUAL,
    COMPARE_UNEQUAL,
    COMPARE_LESS,
    COMPARE_AT_MOST,
    COMPARE_GREATER,
    COMPARE_AT_LEAST,
    COMPARE_CONTAINS,
    COMPARE_LACKS
};
// The effect that a change of a control must have: see script_check.c.
enum effect { EFFECT_RESULT, EFFECT_PICTURE, EFFECT_STATE };

#define COMMAND_TEXTS 3
#define COMMAND_NUMBERS 2

// A command. The table of commands says which members each command uses.
struct command_line {
    enum verb verb;
    uint32_t line;
    const char *texts[COMMAND_TEXTS]; // paths, ids or values
    double numbers[COMMAND_NUMBERS];
    int code; // code of a key (as GLFW's) or of a button
    uint32_t modifiers;
    enum press press;
    enum wait_unit unit;
    enum comparison comparison;
    enum effect effect;
    uint32_t side;
    bool with_panel, denoised;
};

// Reads a script. Fails with ERR_INPUT and "FILE:LINE: what is wrong and what was expected".
bool script_read(const char *path, struct arena *arena, struct command_line **out, uint32_t *count,
                 struct err *err);
// Returns the comparison operator as it is written in scripts, such as "==".
const char *comparison_name(enum comparison comparison);

#endif
