// Lists of any length with a filter that shows only the rows whose names contain a text.
#include "viewer/panel/panel_internal.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static bool contains(const char *name, const char *text)
{
    size_t length = strlen(text);
    for (; strlen(name) >= length; name++) {
        size_t i = 0;
        while (i < length && tolower((unsigned char)name[i]) == tolower((unsigned char)text[i]))
            i++;
        if (i == length)
            return true;
        if (!*name)
            break;
    }
    return false;
}

// Applies the filter to all names, if the filter or the list has changed since the last frame.
static void update(struct panel_filter *filter, const struct panel_list *list)
{
    bool is_same = filter->of == list->of && filter->of_count == list->count &&
                   strcmp(filter->text, filter->done) == 0;
    if (is_same)
        return;
    free(filter->rows);
    filter->rows = NULL;
    filter->count = list->count;
    filter->of = list->of;
    filter->of_count = list->count;
    memcpy(filter->done, filter->text, sizeof filter->done);
    if (!filter->text[0] || !list->count)
        return;
    filter->rows = malloc(list->count * sizeof *filter->rows);
    if (!filter->rows)
        return; // when out of memory, all rows are shown
    filter->count = 0;
    char name[PANEL_NAME_MAX];
    for (uint32_t row = 0; row < list->count; row++) {
        list->name(list->context, row, name);
        if (contains(name, filter->text))
            filter->rows[filter->count++] = row;
    }
}

static uint32_t find_shown(const struct panel_filter *filter, uint32_t chosen)
{
    for (uint32_t i = 0; filter->rows && i < filter->count; i++)
        if (filter->rows[i] == chosen)
            return i;
    return filter->rows ? UINT32_MAX : chosen;
}

bool panel_list(struct panel *panel, struct panel_filter *filter, const struct panel_list *list,
                uint32_t *chosen)
{
    struct gui *gui = panel->gui;
    char id[GUI_ID_MAX];
    uint32_t before = *chosen;
    snprintf(id, sizeof id, "%s.filter", list->id);
    gui_applies(gui, list->count > 1);
    gui_text(gui, id, "Filter", "Shows only entries whose names contain this text.", filter->text,
             sizeof filter->text);
    gui_enabled(gui, true);
    update(filter, list);
    struct gui_list rows = {
        .count = filter->count,
        .chosen = find_shown(filter, *chosen),
        .height = list->height,
    };
    gui_list_begin(gui, list->id, &rows);
    for (uint32_t i; gui_list_next(gui, &rows, &i);) {
        uint32_t row = filter->rows ? filter->rows[i] : i;
        if (list->before)
            list->before(list->context, row);
        snprintf(id, sizeof id, "%s.%u", list->id, row);
        char name[PANEL_NAME_MAX];
        list->name(list->context, row, name);
        if (gui_row(gui, id, name, list->help, row == *chosen))
            *chosen = row;
    }
    gui_list_end(gui, &rows);
    if (filter->count == 0 && list->count > 0)
        gui_line(gui, "No name contains \"%s\".", filter->text);
    return *chosen != before;
}
