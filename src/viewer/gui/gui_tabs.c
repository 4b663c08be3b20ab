// The panel's tabs, and the search for controls in all of them.
#include "viewer/gui/gui_state.h"
#include "viewer/gui/imgui_bridge.h"

#include <assert.h>
#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#define SEARCH_ID "panel.search"
#define BLANKS " \t"

// --- search --------------------------------------------------------------------------------------

// Returns whether a text contains a word of this length. The case of ASCII letters does not matter.
static bool contains(const char *text, const char *word, size_t length)
{
    for (; *text; text++) {
        size_t i = 0;
        while (i < length && text[i] &&
               tolower((unsigned char)text[i]) == tolower((unsigned char)word[i]))
            i++;
        if (i == length)
            return true;
    }
    return false;
}

// The rows of a list have ids and helps that differ in no word, so only their labels count.
static bool has_word(const struct gui_item *item, const char *word, size_t length)
{
    bool is_row = item->kind == GUI_ROW;
    return contains(item->label, word, length) ||
           (!is_row && (contains(item->id, word, length) || contains(item->help, word, length)));
}

bool search_finds(const struct gui_state *own, const struct gui_item *item)
{
    const char *word = own->sought;
    if (!item->label[0]) // it belongs to another control
        return false;
    while (*(word += strspn(word, BLANKS))) {
        size_t length = strcspn(word, BLANKS);
        if (!has_word(item, word, length))
            return false;
        word += length;
    }
    return true;
}

static bool has_words(const struct gui_state *own)
{
    return own->sought[strspn(own->sought, BLANKS)] != '\0';
}

void search_heading(struct gui_state *own)
{
    char text[GUI_DEPTH_MAX * (GUI_LABEL_MAX + 3)] = "";
    size_t length = 0;
    uint32_t group = own->depth ? own->stack[own->depth - 1] : 0;
    own->found_count++;
    if (group == own->found_in)
        return;
    own->found_in = group;
    for (uint32_t i = 0; i < own->depth; i++)
        if (own->stack[i])
            length += (size_t)snprintf(text + length, sizeof text - length, "%s%s",
                                       length ? " / " : "", own->groups[own->stack[i] - 1].label);
    const struct im_place now = im_now();
    const struct im_rect clip = {now.cursor.x, now.cursor.y, now.cursor.x + now.room,
                                 now.cursor.y + now.line};
    im_draw_text(im_layer(IM_WINDOW), now.cursor.x, now.cursor.y, IM_DIM, text, &clip, 0.0f);
    im_dummy(now.room, now.line);
}

// Draws the search box. The words take effect while they are typed.
static void search(struct gui *gui)
{
    struct gui_state *own = gui->own;
    own->is_searching = false; // the box itself is always drawn
    gui_text(gui, SEARCH_ID, "Search",
             "Shows the controls of all tabs whose label, id or help contain these words. Empty: "
             "the open tab.",
             own->search, sizeof own->search);
    bool is_typed = strcmp(own->edit_id, SEARCH_ID) == 0;
    snprintf(own->sought, sizeof own->sought, "%s", is_typed ? own->edit_text : own->search);
}

// --- tabs ----------------------------------------------------------------------------------------

static void draw_tab(struct gui *gui, const struct gui_tab *tab, float width)
{
    struct gui_state *own = gui->own;
    struct gui_item *item = items_add(own, tab->id, GUI_TAB, tab->label, tab->help);
    uint32_t index = items_group(own, tab->id, tab->label, true);
    const char *wish = items_wish(own, item);
    bool is_pressed = wish && (!wish[0] || strcmp(wish, "on") == 0);
    if (wish && !is_pressed)
        items_refuse(own, "%s: \"%.60s\" is not \"on\"; another tab closes this one", tab->id,
                     wish);
    if (index)
        own->groups[index - 1].is_tab = true;
    if (!own->tab)
        own->tab = index;
    if (own->is_drawn) {
        bool is_on = own->tab == index && !has_words(own);
        im_item_begin(item->id, false);
        if (im_tab(item->label, (struct im_vec){width, im_now().frame}, is_on))
            is_pressed = true;
        controls_note_drawn(gui, item);
        im_item_end();
    }
    if (is_pressed) {
        own->tab = index;
        own->search[0] = own->sought[0] = '\0';
    }
}

// Draws the tabs in one line. Each has the width of its label and an equal part of the rest.
static void draw_tabs(struct gui *gui, const struct gui_tab *tabs)
{
    const struct im_place now = im_now();
    uint32_t count = 0;
    float labels = 0.0f, gap = 0.5f * now.inner_spacing;
    for (; tabs[count].id; count++)
        labels += gui->own->is_drawn ? im_text_width(tabs[count].label) : 0.0f;
    float room = fmaxf(now.room - gap * (float)(count - 1), (float)count);
    for (uint32_t i = 0; i < count; i++) {
        float width = 0.0f;
        if (gui->own->is_drawn) {
            float label = im_text_width(tabs[i].label);
            width = labels <= room ? label + (room - labels) / (float)count : room * label / labels;
            if (i)
                im_same_line(0.0f, gap);
        }
        draw_tab(gui, &tabs[i], fmaxf(floorf(width), 1.0f));
    }
}

void tabs_begin(struct gui *gui, const struct gui_tab *tabs)
{
    struct gui_state *own = gui->own;
    search(gui);
    draw_tabs(gui, tabs);
    // The values are those after all tabs have been drawn.
    for (uint32_t i = 0; i < own->item_count; i++)
        if (own->items[i].kind == GUI_TAB)
            snprintf(own->items[i].value, sizeof own->items[i].value, "%s",
                     own->tab && strcmp(own->groups[own->tab - 1].id, own->items[i].id) == 0
                         ? "on"
                         : "off");
    own->is_searching = has_words(own);
}

void gui_open_tab(struct gui *gui, const char *id)
{
    gui->own->tab = items_group(gui->own, id, "", true);
}

void gui_tab_begin(struct gui *gui, const char *id)
{
    struct gui_state *own = gui->own;
    assert(own->depth == 0);
    uint32_t index = items_group(own, id, "", true);
    own->stack[0] = index;
    own->stack_drawn[0] = own->is_drawn;
    own->depth = own->outer = 1;
    own->is_drawn = own->is_drawn && (own->is_searching || own->tab == index);
    own->same_line = false;
    gui_enabled(gui, true);
}

void gui_tab_end(struct gui *gui)
{
    struct gui_state *own = gui->own;
    assert(own->depth == 1 && own->outer == 1);
    own->is_drawn = own->stack_drawn[0];
    own->depth = own->outer = 0;
    gui_enabled(gui, true);
}
