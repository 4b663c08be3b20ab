#include "viewer/script/script_keys.h"

#include "base/ascii.h"
#include "base/suggest.h"
#include "viewer/window/window.h"
#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <stdlib.h>
#include <string.h>

static const struct {
    const char *name;
    int code;
} names[] = {
    {"Space", GLFW_KEY_SPACE},
    {"Escape", GLFW_KEY_ESCAPE},
    {"Enter", GLFW_KEY_ENTER},
    {"Tab", GLFW_KEY_TAB},
    {"Backspace", GLFW_KEY_BACKSPACE},
    {"Insert", GLFW_KEY_INSERT},
    {"Delete", GLFW_KEY_DELETE},
    {"Right", GLFW_KEY_RIGHT},
    {"Left", GLFW_KEY_LEFT},
    {"Down", GLFW_KEY_DOWN},
    {"Up", GLFW_KEY_UP},
    {"PageUp", GLFW_KEY_PAGE_UP},
    {"PageDown", GLFW_KEY_PAGE_DOWN},
    {"Home", GLFW_KEY_HOME},
    {"End", GLFW_KEY_END},
    {"Shift", GLFW_KEY_LEFT_SHIFT},
    {"Ctrl", GLFW_KEY_LEFT_CONTROL},
    {"Alt", GLFW_KEY_LEFT_ALT},
};

// Returns the code of a printable key. GLFW uses the character that the key has in the US layout.
static int code_of(const char *name)
{
    static const char printable[] = "0123456789ABCDEFGHIJKLMNOPQRSTUVWXYZ'-,./;=[]\\`";
    if (name[0] && !name[1]) {
        char upper = name[0] >= 'a' && name[0] <= 'z' ? (char)(name[0] - 'a' + 'A') : name[0];
        return strchr(printable, upper) ? upper : GLFW_KEY_UNKNOWN;
    }
    char *end;
    long number = strtol(name + 1, &end, 10);
    if ((name[0] == 'F' || name[0] == 'f') && name[1] && *end == '\0' && number >= 1 &&
        number <= 12)
        return GLFW_KEY_F1 + (int)number - 1;
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        if (ascii_equal(names[i].name, name))
            return names[i].code;
    return GLFW_KEY_UNKNOWN;
}

bool script_key(const char *name, int *code, uint32_t *modifiers, struct err *err)
{
    static const struct {
        const char *prefix;
        uint32_t modifier;
    } prefixes[] = {{"Shift+", EVENT_SHIFT}, {"Ctrl+", EVENT_CONTROL}, {"Alt+", EVENT_ALT}};
    const char *key = name;
    *modifiers = 0;
    for (size_t i = 0; i < 3; i++) {
        size_t length = strlen(prefixes[i].prefix);
        if (!ascii_begins(key, prefixes[i].prefix) || !key[length])
            continue;
        *modifiers |= prefixes[i].modifier;
        key += length;
        i = (size_t)-1; // starts again, because modifiers may be in any order
    }
    *code = code_of(key);
    if (*code != GLFW_KEY_UNKNOWN)
        return true;
    struct suggestion suggestion = {.wanted = key};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        suggest_offer(&suggestion, names[i].name);
    return err_set(err, ERR_INPUT,
                   "there is no key %s%s%s%s; expected a letter, a digit, F1 to F12, Space, Escape "
                   "…, perhaps after Ctrl+, Shift+ or Alt+",
                   key, suggestion.nearest ? " (did you mean " : "",
                   suggestion.nearest ? suggestion.nearest : "", suggestion.nearest ? "?)" : "");
}
