#include "cli/render/frame_name.h"

#include "base/file.h"
#include <stdio.h>
#include <string.h>

#define DEFAULT_DIGITS 4 // as in path_numbered()

static bool fail(const char *path, const char *why, struct err *err)
{
    return err_set(err, ERR_USAGE,
                   "--output: \"%s\" %s; expected one placeholder, as in name_####.png or "
                   "name_%%04d.png",
                   path, why);
}

// Parses "%d" or "%04d". Returns the length, or 0 if the text begins with neither.
static int parse_percent(const char *text, int *digits)
{
    int length = 1;
    *digits = 1;
    if (text[1] == '0' && text[2] >= '1' && text[2] <= '9') {
        *digits = text[2] - '0';
        length = 3;
    }
    return text[length] == 'd' ? length + 1 : 0;
}

bool frame_name_parse(const char *path, struct frame_name *out, struct err *err)
{
    const char *name = path_name(path), *extension = path_extension(path);
    *out = (struct frame_name){.path = path};
    for (const char *at = name; *at;) {
        int length = (int)strspn(at, "#"), digits = length;
        if (*at == '%' && (length = parse_percent(at, &digits)) == 0)
            return fail(path, "has a % that is not part of a placeholder", err);
        if (length > 0 && out->taken > 0)
            return fail(path, "has two placeholders for the number", err);
        if (length > 0) {
            out->before = (int)(at - path);
            out->taken = length;
            out->digits = digits;
        }
        at += length > 0 ? length : 1;
    }
    if (out->taken == 0) {
        out->before = (int)(*extension ? extension - path - 1 : (long)strlen(path));
        out->digits = DEFAULT_DIGITS;
        out->needs_dot = true;
    }
    return true;
}

char *frame_name_make(const struct frame_name *name, uint32_t number, struct arena *arena)
{
    return arena_printf(arena, "%.*s%s%0*u%s", name->before, name->path, name->needs_dot ? "." : "",
                        name->digits, number, name->path + name->before + name->taken);
}

char *frame_name_pattern(const struct frame_name *name, struct arena *arena)
{
    const char *folder_end = path_name(name->path);
    char *doubled = ARENA_NEW(arena, char, 2 * strlen(name->path) + 1), *to = doubled;
    if (!doubled)
        return NULL;
    for (const char *from = name->path; from < folder_end; from++) {
        if (*from == '%')
            *to++ = '%';
        *to++ = *from;
    }
    *to = '\0';
    int own = (int)(folder_end - name->path);
    return arena_printf(arena, "%s%.*s%s%%0%dd%s", doubled, name->before - own, folder_end,
                        name->needs_dot ? "." : "", name->digits,
                        name->path + name->before + name->taken);
}
