// Paths as text, and the file to which a path leads.
#include "base/file.h"

#include "base/ascii.h"
#include "base/file_system.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

bool path_is_absolute(const char *path)
{
    return *path && (strchr(PATH_SEPARATORS, *path) || PATH_BEGINS_WITH_DRIVE(path));
}

const char *path_name(const char *path)
{
    const char *name = path;
    for (const char *at = path; *at; at++)
        if (strchr(PATH_SEPARATORS, *at))
            name = at + 1;
    return name;
}

char *path_folder(struct arena *arena, const char *path)
{
    const size_t length = (size_t)(path_name(path) - path);
    if (length == 0)
        return arena_strdup(arena, ".");
    return arena_printf(arena, "%.*s", (int)(length > 1 ? length - 1 : length), path);
}

const char *path_extension(const char *path)
{
    const char *name = path_name(path);
    const char *dot = strrchr(name, '.');
    return dot && dot != name ? dot + 1 : "";
}

bool path_has_extension(const char *path, const char *extension)
{
    return ascii_equal(path_extension(path), extension);
}

char *path_numbered(struct arena *arena, const char *path, uint32_t number)
{
    const char *extension = path_extension(path);
    if (!*extension)
        return arena_printf(arena, "%s.%04u", path, number);
    int stem = (int)(extension - path);
    return arena_printf(arena, "%.*s%04u.%s", stem, path, number, extension);
}

uint32_t path_number_of(const char *name, const char *path)
{
    const char *extension = path_extension(path), *stem = path_name(path);
    const size_t stem_length = *extension ? (size_t)(extension - stem) - 1 : strlen(stem);
    name = path_name(name);
    if (strncmp(name, stem, stem_length) != 0 || name[stem_length] != '.')
        return 0;
    const char *digits = name + stem_length + 1;
    const size_t count = strspn(digits, "0123456789");
    const char *rest = digits + count;
    if (count < 4 || count > 10 || (count > 4 && *digits == '0') ||
        strcmp(rest, *extension ? extension - 1 : "") != 0)
        return 0;
    const unsigned long long number = strtoull(digits, NULL, 10);
    return number <= UINT32_MAX ? (uint32_t)number : 0;
}

// Returns the target of a link, relative to the working directory; NULL if the path is not a link.
static char *follow_link(const char *path)
{
    char *text = file_read_link(path);
    if (!text)
        return NULL;
    int folder = path_is_absolute(text) ? 0 : (int)(path_name(path) - path);
    size_t size = (size_t)folder + strlen(text) + 1;
    char *out = malloc(size);
    if (out)
        snprintf(out, size, "%.*s%s", folder, path, text);
    free(text);
    return out;
}

char *file_target(const char *path)
{
    const int links_max = 40; // as in Linux
    char *target = file_real_path(path);
    if (target)
        return target;
    target = strdup(path);
    for (int i = 0; target && i < links_max; i++) {
        char *next = follow_link(target);
        if (!next)
            break;
        free(target);
        target = next;
    }
    return target;
}
