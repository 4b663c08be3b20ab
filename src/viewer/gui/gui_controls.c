// Controls: each is entered into the registry, takes what a script wants of it, and is drawn.
#include "viewer/gui/gui_state.h"

#include <assert.h>
#include <stdio.h>
#include <string.h>

#define WHY_BYTES 512

bool gui_group_begin(struct gui *gui, const char *id, const char *label, const char *help,
                     bool open_at_first)
{
    struct gui_state *own = gui->own;
    own->is_enabled = true;
    own->same_line = false;
    struct gui_item *item = items_add(own, id, GUI_GROUP, label, help);
    uint32_t index = items_group(own, id, open_at_first);
    struct gui_group *group = index ? &own->groups[index - 1] : NULL;
    bool is_open = group ? group->is_open : true;
    const char *wish = items_wish(own, item);
    if (wish && strcmp(wish, "open") != 0 && strcmp(wish, "closed") != 0)
        items_refuse(own, "%s: \"%.60s\" is neither \"open\" nor \"closed\"", id, wish);
    else if (wish)
        is_open = wish[0] == 'o';
    if (own->is_drawn)
        is_open = widget_group(gui, item, is_open);
    if (group)
        group->is_open = is_open;
    snprintf(item->value, sizeof item->value, "%s", is_open ? "open" : "closed");
    assert(own->depth < GUI_DEPTH_MAX);
    own->stack[own->depth] = index;
    own->stack_drawn[own->depth++] = own->is_drawn;
    own->is_drawn = own->is_drawn && is_open;
    return is_open;
}

void gui_group_end(struct gui *gui)
{
    struct gui_state *own = gui->own;
    assert(own->depth > 0);
    if (own->is_drawn)
        widget_group_end(gui);
    own->is_drawn = own->stack_drawn[--own->depth];
    own->is_enabled = true;
    own->same_line = false;
}

void gui_enabled(struct gui *gui, bool enabled)
{
    gui->own->is_enabled = enabled;
}

bool gui_is_drawn(const struct gui *gui)
{
    return gui->own->is_drawn;
}

void gui_same_line(struct gui *gui)
{
    gui->own->same_line = true;
}

bool gui_button(struct gui *gui, const char *id, const char *label, const char *help)
{
    struct gui_state *own = gui->own;
    struct gui_item *item = items_add(own, id, GUI_BUTTON, label, help);
    bool pressed = items_wish(own, item) != NULL;
    if (own->is_drawn && widget_button(gui, item))
        pressed = true;
    return pressed;
}

bool gui_switch(struct gui *gui, const char *id, const char *label, const char *help, bool *value)
{
    struct gui_state *own = gui->own;
    struct gui_item *item = items_add(own, id, GUI_SWITCH, label, help);
    const char *wish = items_wish(own, item);
    bool before = *value;
    char why[WHY_BYTES];
    if (wish && !value_read_switch(wish, value, why))
        items_refuse(own, "%s: %s", id, why);
    bool changed = *value != before;
    if (own->is_drawn && widget_switch(gui, item, value))
        changed = true;
    snprintf(item->value, sizeof item->value, "%s", *value ? "on" : "off");
    return changed;
}

// Numbers are doubles inside; those of other types come and go as such without loss.
static bool number(struct gui *gui, const char *id, const char *label, const char *help,
                   const struct gui_range *range, bool is_float, double *value)
{
    struct gui_state *own = gui->own;
    struct gui_item *item = items_add(own, id, GUI_NUMBER, label, help);
    const char *wish = items_wish(own, item);
    double to = *value;
    char why[WHY_BYTES];
    if (wish && !value_read(wish, is_float, range, &to, why))
        items_refuse(own, "%s: %s", id, why);
    bool changed = wish && to != *value;
    if (changed)
        *value = to;
    if (own->is_drawn && widget_number(gui, item, range, is_float, value))
        changed = true;
    value_write(*value, is_float, range, item->value);
    return changed;
}

bool gui_number(struct gui *gui, const char *id, const char *label, const char *help,
                const struct gui_range *range, double *value)
{
    return number(gui, id, label, help, range, false, value);
}

bool gui_float(struct gui *gui, const char *id, const char *label, const char *help,
               const struct gui_range *range, float *value)
{
    double wide = (double)*value;
    if (!number(gui, id, label, help, range, true, &wide))
        return false;
    *value = (float)wide;
    return true;
}

bool gui_count(struct gui *gui, const char *id, const char *label, const char *help,
               const struct gui_range *range, uint32_t *value)
{
    double wide = (double)*value;
    if (!number(gui, id, label, help, range, false, &wide))
        return false;
    *value = (uint32_t)wide;
    return true;
}

bool gui_choice(struct gui *gui, const char *id, const char *label, const char *help,
                const char *const *names, uint32_t *value)
{
    struct gui_state *own = gui->own;
    struct gui_item *item = items_add(own, id, GUI_CHOICE, label, help);
    const char *wish = items_wish(own, item);
    uint32_t to = *value;
    char why[WHY_BYTES];
    if (wish && !value_read_choice(wish, names, &to, why))
        items_refuse(own, "%s: %s", id, why);
    bool changed = to != *value;
    *value = to;
    if (own->is_drawn && widget_choice(gui, item, names, value))
        changed = true;
    snprintf(item->value, sizeof item->value, "%s", names[*value]);
    return changed;
}

static void write_three(const double value[3], bool is_float, const struct gui_range *range,
                        char *out)
{
    size_t used = 0;
    for (int c = 0; c < 3; c++) {
        char one[GUI_VALUE_MAX];
        value_write(value[c], is_float, range, one);
        used += (size_t)snprintf(out + used, GUI_VALUE_MAX - used, "%s%.60s", c ? "," : "", one);
    }
}

// True: a script changed it.
static bool three_wish(struct gui_state *own, const struct gui_item *item, bool is_float,
                       const struct gui_range *range, double value[3])
{
    const char *wish = items_wish(own, item);
    double to[3] = {value[0], value[1], value[2]};
    char why[WHY_BYTES];
    if (wish && !value_read_three(wish, is_float, range, to, why))
        items_refuse(own, "%s: %s", item->id, why);
    bool changed = to[0] != value[0] || to[1] != value[1] || to[2] != value[2];
    if (changed)
        memcpy(value, to, sizeof to);
    return changed;
}

bool gui_color(struct gui *gui, const char *id, const char *label, const char *help,
               const struct gui_range *range, float value[3])
{
    struct gui_state *own = gui->own;
    struct gui_item *item = items_add(own, id, GUI_COLOR, label, help);
    double wide[3] = {(double)value[0], (double)value[1], (double)value[2]};
    bool changed = three_wish(own, item, true, range, wide);
    for (int c = 0; changed && c < 3; c++)
        value[c] = (float)wide[c];
    if (own->is_drawn && widget_color(gui, item, range, value))
        changed = true;
    for (int c = 0; c < 3; c++)
        wide[c] = (double)value[c];
    write_three(wide, true, range, item->value);
    return changed;
}

bool gui_vector(struct gui *gui, const char *id, const char *label, const char *help,
                const struct gui_range *range, double value[3])
{
    struct gui_state *own = gui->own;
    struct gui_item *item = items_add(own, id, GUI_VECTOR, label, help);
    bool changed = three_wish(own, item, false, range, value);
    if (own->is_drawn && widget_vector(gui, item, range, false, value))
        changed = true;
    write_three(value, false, range, item->value);
    return changed;
}

bool gui_text(struct gui *gui, const char *id, const char *label, const char *help, char *value,
              uint32_t size)
{
    struct gui_state *own = gui->own;
    struct gui_item *item = items_add(own, id, GUI_TEXT, label, help);
    const char *wish = items_wish(own, item);
    bool changed = false;
    if (wish && strlen(wish) >= size) {
        items_refuse(own, "%s: longer than %u bytes", id, size - 1);
    } else if (wish) {
        changed = strcmp(value, wish) != 0;
        snprintf(value, size, "%s", wish);
    }
    if (own->is_drawn && widget_text(gui, item, value, size))
        changed = true;
    snprintf(item->value, sizeof item->value, "%s", value);
    return changed;
}

bool gui_row(struct gui *gui, const char *id, const char *label, const char *help, bool is_chosen)
{
    struct gui_state *own = gui->own;
    struct gui_item *item = items_add(own, id, GUI_ROW, label, help);
    bool chosen = items_wish(own, item) != NULL;
    if (own->is_drawn && widget_row(gui, item, is_chosen))
        chosen = true;
    snprintf(item->value, sizeof item->value, "%s", is_chosen || chosen ? "on" : "off");
    return chosen;
}

// --- lists ---------------------------------------------------------------------------------------

void gui_list_begin(struct gui *gui, const char *id, struct gui_list *list)
{
    struct gui_state *own = gui->own;
    list->first = list->last = list->next = 0;
    list->was_drawn = own->is_drawn;
    own->reveal_hit = false;
    own->list_reveal = -1.0;
    if (own->is_drawn)
        widget_list_begin(gui, id, list);
}

// Of the rows from `row` on the first that is to be called for.
static uint32_t next_row(const struct gui_list *list, uint32_t row)
{
    if (row < GUI_LIST_IDS || (row >= list->first && row < list->last) || row == list->chosen)
        return row;
    uint32_t next = list->count;
    if (row < list->first)
        next = list->first;
    if (row < list->chosen && list->chosen < next)
        next = list->chosen;
    return next;
}

bool gui_list_next(struct gui *gui, struct gui_list *list, uint32_t *row)
{
    struct gui_state *own = gui->own;
    if (own->reveal_hit) {
        own->list_reveal = (double)list->next - 1.0;
        own->reveal_hit = false;
    }
    uint32_t next = next_row(list, list->next);
    if (next >= list->count)
        return false;
    *row = next;
    list->next = next + 1;
    own->is_drawn = list->was_drawn && next >= list->first && next < list->last;
    own->same_line = false;
    if (own->is_drawn)
        widget_list_row(gui, list, next);
    return true;
}

void gui_list_end(struct gui *gui, struct gui_list *list)
{
    gui->own->is_drawn = list->was_drawn;
    if (list->was_drawn)
        widget_list_end(gui, list);
}
