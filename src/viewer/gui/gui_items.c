// The registry of controls: the controls of the current frame, and the values that scripts have
// set.
#include "viewer/gui/gui_state.h"

#include "base/suggest.h"
#include <assert.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

static uint32_t slot_of(const char *id)
{
    uint32_t hash = 2166136261u; // Fowler, Noll and Vo: FNV-1a, 32 bits
    for (const char *c = id; *c; c++)
        hash = (hash ^ (uint8_t)*c) * 16777619u;
    return hash & (GUI_SLOTS - 1u);
}

// Returns the slot that contains the id, or a free slot for it.
static uint32_t slot_find(const struct gui_state *own, const char *id)
{
    uint32_t slot = slot_of(id);
    while (own->slots[slot] && strcmp(own->items[own->slots[slot] - 1].id, id) != 0)
        slot = (slot + 1u) & (GUI_SLOTS - 1u);
    return slot;
}

void items_begin(struct gui_state *own)
{
    own->item_count = 0;
    own->depth = 0;
    own->outer = 0;
    own->is_enabled = true;
    own->is_useless = false;
    own->is_drawn = false;
    own->is_left_out = false;
    own->is_searching = false;
    own->found_count = own->found_in = 0;
    own->same_line = false;
    own->reveal_hit = false;
    own->list_reveal = -1.0;
    own->duplicate[0] = '\0';
    memset(own->slots, 0, sizeof own->slots);
    for (uint32_t i = 0; i < own->wish_count; i++)
        own->wishes[i].is_due = true;
    if (own->wish_count)
        own->result[0] = '\0';
}

// Enters an id. Returns false if it was there already.
static bool enter(struct gui_state *own, const char *id)
{
    uint32_t slot = slot_find(own, id);
    if (own->slots[slot]) {
        if (!own->duplicate[0])
            snprintf(own->duplicate, sizeof own->duplicate, "%s", id);
        return false;
    }
    own->slots[slot] = (uint16_t)(own->item_count + 1u);
    return true;
}

struct gui_item *items_add(struct gui_state *own, const char *id, enum gui_kind kind,
                           const char *label, const char *help)
{
    assert(strlen(id) < GUI_ID_MAX);
    bool fits = own->item_count < GUI_ITEMS_MAX && enter(own, id);
    struct gui_item *item = fits ? &own->items[own->item_count++] : &own->spare;
    snprintf(item->id, sizeof item->id, "%s", id);
    item->value[0] = '\0';
    item->kind = kind;
    memset(item->rect, 0, sizeof item->rect);
    item->is_shown = false;
    item->is_enabled = own->is_enabled;
    snprintf(item->label, sizeof item->label, "%s", label);
    item->help = help;
    item->range[0] = item->range[1] = 0.0;
    item->group = own->depth ? own->stack[own->depth - 1] : 0;
    own->reveal_hit = own->reveal_hit || (own->reveal_frames && strcmp(own->reveal, id) == 0);
    return item;
}

const char *items_wish(struct gui_state *own, const struct gui_item *item)
{
    const char *value = NULL;
    for (uint32_t i = 0; i < own->wish_count; i++) {
        struct gui_wish *wish = &own->wishes[i];
        if (!wish->is_due || wish->is_seen || strcmp(wish->id, item->id) != 0)
            continue;
        wish->is_seen = true;
        if (item->is_enabled)
            value = wish->value;
        else
            items_refuse(own, "%s is disabled at present", item->id);
    }
    return value;
}

void items_refuse(struct gui_state *own, const char *format, ...)
{
    if (own->result[0])
        return; // if several calls fail, the first reason is kept
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(own->result, sizeof own->result, format, arguments);
    va_end(arguments);
}

static void refuse_unknown(struct gui_state *own, const char *id)
{
    struct suggestion suggestion = {.wanted = id};
    for (uint32_t i = 0; i < own->item_count; i++)
        suggest_offer(&suggestion, own->items[i].id);
    if (suggestion.nearest)
        items_refuse(own, "no control %s; did you mean %s?", id, suggestion.nearest);
    else
        items_refuse(own, "no control %s", id);
}

void items_end(struct gui *gui)
{
    struct gui_state *own = gui->own;
    assert(own->depth == 0);
    uint32_t left = 0;
    for (uint32_t i = 0; i < own->wish_count; i++) {
        if (!own->wishes[i].is_due)
            own->wishes[left++] = own->wishes[i];
        else if (!own->wishes[i].is_seen)
            refuse_unknown(own, own->wishes[i].id);
    }
    own->wish_count = left;
    if (own->reveal_frames)
        own->reveal_frames--;
    memcpy(gui->items, own->items, own->item_count * sizeof *own->items);
    gui->item_count = own->item_count;
    memcpy(own->last_duplicate, own->duplicate, sizeof own->last_duplicate);
}

uint32_t items_group(struct gui_state *own, const char *id, const char *label, bool open_at_first)
{
    for (uint32_t i = 0; i < own->group_count; i++)
        if (strcmp(own->groups[i].id, id) == 0) {
            if (label[0])
                snprintf(own->groups[i].label, sizeof own->groups[i].label, "%s", label);
            return i + 1;
        }
    if (own->group_count == GUI_GROUPS_MAX)
        return 0;
    struct gui_group *group = &own->groups[own->group_count++];
    snprintf(group->id, sizeof group->id, "%s", id);
    snprintf(group->label, sizeof group->label, "%s", label);
    group->is_open = open_at_first;
    group->parent = own->depth ? own->stack[own->depth - 1] : 0;
    return own->group_count;
}

// --- for scripts ---------------------------------------------------------------------------------

void gui_set(struct gui *gui, const char *id, const char *value)
{
    struct gui_state *own = gui->own;
    if (own->wish_count == GUI_WISHES_MAX || strlen(id) >= GUI_ID_MAX ||
        strlen(value) >= GUI_TEXT_MAX) {
        own->result[0] = '\0';
        if (own->wish_count == GUI_WISHES_MAX)
            items_refuse(own, "%s: more than %d controls are set at once", id, GUI_WISHES_MAX);
        else
            items_refuse(own, "%.60s: the id or the value is too long", id);
        return;
    }
    struct gui_wish *wish = &own->wishes[own->wish_count++];
    *wish = (struct gui_wish){0};
    snprintf(wish->id, sizeof wish->id, "%s", id);
    snprintf(wish->value, sizeof wish->value, "%s", value);
}

const char *gui_set_result(const struct gui *gui)
{
    const struct gui_state *own = gui->own;
    if (own->wish_count)
        return "not set yet: no frame has been drawn since";
    return own->result[0] ? own->result : NULL;
}

void gui_reveal(struct gui *gui, const char *id)
{
    struct gui_state *own = gui->own;
    const struct gui_item *item = gui_find(gui, id);
    snprintf(own->reveal, sizeof own->reveal, "%s", id);
    // The first frame opens the groups; in the second one their sizes are known.
    own->reveal_frames = 2;
    own->search[0] = '\0';
    for (uint32_t group = item ? item->group : 0; group; group = own->groups[group - 1].parent) {
        own->groups[group - 1].is_open = true;
        if (own->groups[group - 1].is_tab)
            own->tab = group;
    }
}

const struct gui_item *gui_find(const struct gui *gui, const char *id)
{
    for (uint32_t i = 0; i < gui->item_count; i++)
        if (strcmp(gui->items[i].id, id) == 0)
            return &gui->items[i];
    return NULL;
}

const char *gui_duplicate(const struct gui *gui)
{
    return gui->own->last_duplicate[0] ? gui->own->last_duplicate : NULL;
}
