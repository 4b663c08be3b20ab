// Passes mouse and keyboard events to the panel.
//
// Dear ImGui only reads the state at each frame, so a second change of the same button or key
// within a frame (press and release) waits for the next frame.
#include "viewer/gui/gui_state.h"
#include "viewer/gui/imgui_bridge.h"

#include <GLFW/glfw3.h>

static bool is_over_panel(const struct gui *gui)
{
    const double *mouse = gui->own->mouse;
    const float *place = gui->place;
    return mouse[0] >= (double)place[0] && mouse[0] < (double)place[2] &&
           (!gui->is_floating || (mouse[1] >= (double)place[1] && mouse[1] < (double)place[3]));
}

// Decides which events the panel receives. If a button was pressed outside of the panel, the panel
// receives neither the movements nor the release.
void events_want(struct gui *gui)
{
    const struct gui_state *own = gui->own;
    gui->wants_mouse =
        !own->buttons_elsewhere && (is_over_panel(gui) || own->has_popup || gui->is_busy);
}

void gui_event(struct gui *gui, const struct event *event)
{
    struct gui_state *own = gui->own;
    if (event->kind == EVENT_MOVE) {
        own->mouse[0] = event->x;
        own->mouse[1] = event->y;
    } else if (event->kind == EVENT_BUTTON && event->code >= 0 && event->code < 32) {
        uint32_t bit = 1u << event->code;
        if (!event->down)
            own->buttons_elsewhere &= ~bit;
        else if (!gui->wants_mouse)
            own->buttons_elsewhere |= bit;
    } else if (event->kind == EVENT_FOCUS) {
        own->buttons_elsewhere = 0;
    }
    // The release of a button is sent to the place at which it was pressed.
    bool let_go_elsewhere = event->kind == EVENT_BUTTON && !event->down && !gui->wants_mouse;
    events_want(gui);
    if (let_go_elsewhere)
        gui->wants_mouse = false;
    if (own->event_count < GUI_EVENTS_MAX) {
        uint32_t place = (own->event_first + own->event_count++) % GUI_EVENTS_MAX;
        own->events[place] = *event;
        own->events[place].path = NULL;
    }
}

// Events that were already passed in this frame.
struct fed {
    uint32_t buttons;
    int keys[32];
    uint32_t key_count;
    bool special_key, text, moved;
};

static bool must_wait(const struct fed *fed, const struct event *event)
{
    switch (event->kind) {
    case EVENT_MOVE:
        return fed->buttons != 0; // a click belongs to the position that the mouse had at that time
    case EVENT_BUTTON:            // a drag must reach the position of the release before it ends
        return (fed->buttons >> event->code & 1u) || (fed->moved && !event->down);
    case EVENT_KEY:
        for (uint32_t i = 0; i < fed->key_count; i++)
            if (fed->keys[i] == event->code)
                return true;
        return fed->key_count == 32 || (fed->text && event->code >= GLFW_KEY_ESCAPE);
    case EVENT_TEXT:
        return fed->special_key;
    default:
        return false;
    }
}

static void note(struct fed *fed, const struct event *event)
{
    bool is_key = event->kind == EVENT_KEY;
    fed->moved |= event->kind == EVENT_MOVE;
    fed->text |= event->kind == EVENT_TEXT;
    if (event->kind == EVENT_BUTTON)
        fed->buttons |= 1u << event->code;
    if (is_key)
        fed->keys[fed->key_count++] = event->code;
    fed->special_key |=
        is_key && event->code >= GLFW_KEY_ESCAPE && event->code < GLFW_KEY_LEFT_SHIFT;
}

static bool is_known(const struct event *event)
{
    return event->kind == EVENT_BUTTON ? event->code >= 0 && event->code < (int)IM_MOUSE_BUTTONS
           : event->kind == EVENT_KEY  ? event->code >= 0 && event->code < IM_KEYS
                                       : true;
}

void events_feed(struct gui *gui)
{
    struct gui_state *own = gui->own;
    struct fed fed = {0};
    while (own->event_count) {
        const struct event *event = &own->events[own->event_first];
        if (is_known(event)) {
            if (must_wait(&fed, event))
                return;
            note(&fed, event);
            im_put(own->im, event);
        }
        own->event_first = (own->event_first + 1) % GUI_EVENTS_MAX;
        own->event_count--;
    }
}
