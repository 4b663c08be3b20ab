// Commands that simulate keyboard and mouse, and that set the panel's controls.
#include "viewer/core/viewer.h"
#include "viewer/script/script_run.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <string.h>

static void push(struct script *script, struct viewer *viewer, struct event event)
{
    if (event.kind == EVENT_BUTTON) {
        event.x = script->mouse[0];
        event.y = script->mouse[1];
    }
    window_push(&viewer->shell.window, &event);
}

static void push_mouse(struct script *script, struct viewer *viewer, double x, double y)
{
    script->mouse[0] = x;
    script->mouse[1] = y;
    push(script, viewer, (struct event){.kind = EVENT_MOVE, .x = x, .y = y});
}

// Presses or releases the modifiers, which are keys, too: they are pressed before the key and
// released after it.
static void push_modifiers(struct script *script, struct viewer *viewer, uint32_t modifiers,
                           bool down)
{
    static const struct {
        uint32_t modifier;
        int code;
    } keys[] = {{EVENT_SHIFT, GLFW_KEY_LEFT_SHIFT},
                {EVENT_CONTROL, GLFW_KEY_LEFT_CONTROL},
                {EVENT_ALT, GLFW_KEY_LEFT_ALT}};
    for (size_t i = 0; i < 3; i++)
        if (modifiers & keys[i].modifier)
            push(script, viewer,
                 (struct event){.kind = EVENT_KEY,
                                .code = keys[i].code,
                                .down = down,
                                .modifiers = down ? modifiers : 0});
}

static void push_key(struct script *script, struct viewer *viewer,
                     const struct command_line *command, bool down)
{
    if (down)
        push_modifiers(script, viewer, command->modifiers, true);
    push(script, viewer,
         (struct event){.kind = EVENT_KEY,
                        .code = command->code,
                        .down = down,
                        .modifiers = command->modifiers});
    if (!down)
        push_modifiers(script, viewer, command->modifiers, false);
}

enum step step_key(struct script *script, struct viewer *viewer, const struct command_line *command,
                   struct err *err)
{
    (void)err;
    if (script->now.phase == 0) {
        if (command->press != PRESS_UP)
            push_key(script, viewer, command, true);
        return next_phase(script);
    }
    if (script->now.phase == 1) {
        if (command->press != PRESS_DOWN)
            push_key(script, viewer, command, false);
        return next_phase(script);
    }
    return rest_frames(script, FRAMES_TO_SEE - 1);
}

enum step step_mouse(struct script *script, struct viewer *viewer,
                     const struct command_line *command, struct err *err)
{
    (void)err;
    if (script->now.phase > 0)
        return rest_frames(script, FRAMES_TO_SEE - 1);
    push_mouse(script, viewer, command->numbers[0], command->numbers[1]);
    return next_phase(script);
}

static void push_button(struct script *script, struct viewer *viewer, int code, bool down)
{
    push(script, viewer, (struct event){.kind = EVENT_BUTTON, .code = code, .down = down});
}

enum step step_button(struct script *script, struct viewer *viewer,
                      const struct command_line *command, struct err *err)
{
    (void)err;
    if (script->now.phase == 0) {
        if (command->press != PRESS_UP)
            push_button(script, viewer, command->code, true);
        return next_phase(script);
    }
    if (script->now.phase == 1) {
        if (command->press != PRESS_DOWN)
            push_button(script, viewer, command->code, false);
        return next_phase(script);
    }
    return rest_frames(script, FRAMES_TO_SEE - 1);
}

enum step step_scroll(struct script *script, struct viewer *viewer,
                      const struct command_line *command, struct err *err)
{
    (void)err;
    if (script->now.phase > 0)
        return rest_frames(script, FRAMES_TO_SEE - 1);
    push(script, viewer,
         (struct event){.kind = EVENT_SCROLL, .x = command->numbers[0], .y = command->numbers[1]});
    return next_phase(script);
}

// Returns the next character of a UTF-8 text. Invalid bytes are returned one by one.
static int take_character(const char **text)
{
    const unsigned char *at = (const unsigned char *)*text;
    int length = at[0] < 0x80 ? 1 : at[0] >= 0xf0 ? 4 : at[0] >= 0xe0 ? 3 : at[0] >= 0xc0 ? 2 : 1;
    int code = length == 1 ? at[0] : at[0] & (0x7f >> length);
    int taken = 1;
    for (; taken < length && (at[taken] & 0xc0) == 0x80; taken++)
        code = code << 6 | (at[taken] & 0x3f);
    *text += taken;
    return code;
}

enum step step_text(struct script *script, struct viewer *viewer,
                    const struct command_line *command, struct err *err)
{
    (void)err;
    if (script->now.phase > 0)
        return rest_frames(script, FRAMES_TO_SEE - 1);
    for (const char *at = command->texts[0]; *at;)
        push(script, viewer, (struct event){.kind = EVENT_TEXT, .code = take_character(&at)});
    return next_phase(script);
}

enum step step_drop(struct script *script, struct viewer *viewer,
                    const struct command_line *command, struct err *err)
{
    (void)err;
    if (script->now.phase > 0)
        return rest_frames(script, FRAMES_TO_SEE);
    push(script, viewer, (struct event){.kind = EVENT_DROP, .path = command->texts[0]});
    return next_phase(script);
}

enum step step_resize(struct script *script, struct viewer *viewer,
                      const struct command_line *command, struct err *err)
{
    (void)err;
    uint32_t width = (uint32_t)command->numbers[0], height = (uint32_t)command->numbers[1];
    if (script->now.phase == 0) {
        window_resize(&viewer->shell.window, width, height);
        return next_phase(script);
    }
    if (viewer->shell.window.width != width || viewer->shell.window.height != height)
        return STEP_AGAIN;
    return script->now.phase == 1 ? next_phase(script) : rest_frames(script, 1);
}

enum step step_minimise(struct script *script, struct viewer *viewer,
                        const struct command_line *command, struct err *err)
{
    (void)err;
    bool minimised = command->verb == VERB_MINIMISE;
    if (script->now.phase == 0) {
        window_minimise(&viewer->shell.window, minimised);
        return next_phase(script);
    }
    return viewer->shell.window.is_minimised == minimised ? STEP_DONE : STEP_AGAIN;
}

enum step step_close(struct script *script, struct viewer *viewer,
                     const struct command_line *command, struct err *err)
{
    (void)command, (void)err;
    push(script, viewer, (struct event){.kind = EVENT_CLOSE});
    return STEP_DONE;
}

// --- controls ------------------------------------------------------------------------------------

enum step step_set(struct script *script, struct viewer *viewer, const struct command_line *command,
                   struct err *err)
{
    if (script->now.phase == 0) {
        gui_set(&viewer->shell.gui, command->texts[0], command->texts[1] ? command->texts[1] : "");
        return next_phase(script);
    }
    const char *why_not = gui_set_result(&viewer->shell.gui);
    if (script->now.phase == 1 && why_not) {
        err_set(err, ERR_INPUT, "%s", why_not);
        return STEP_FAILED;
    }
    script->now.phase = 2;
    return rest_frames(script, FRAMES_TO_SEE);
}

#define REVEAL_FRAMES 3u  // a control has its final place this many frames after scrolling
#define REVEAL_TRIALS 10u // greatest number of frames to try

// Moves the mouse to a control. The next phase begins when the mouse is there.
static enum step aim(struct script *script, struct viewer *viewer, const char *id, struct err *err)
{
    const struct gui_item *item = gui_find(&viewer->shell.gui, id);
    bool is_there =
        item && item->is_shown && item->rect[2] > item->rect[0] && item->rect[3] > item->rect[1];
    if (script->now.frame == 0 && (!item || !item->is_shown))
        gui_reveal(&viewer->shell.gui, id);
    if (script->now.frame++ < REVEAL_FRAMES || (!is_there && script->now.frame < REVEAL_TRIALS))
        return STEP_AGAIN;
    if (item && !item->is_enabled) { // it may not be drawn either
        err_set(err, ERR_INPUT, "%s is disabled at present", id);
        return STEP_FAILED;
    }
    if (!is_there) {
        err_set(err, ERR_INPUT, item ? "%s is not visible" : "there is no control %s", id);
        return STEP_FAILED;
    }
    push_mouse(script, viewer, 0.5 * (item->rect[0] + item->rect[2]),
               0.5 * (item->rect[1] + item->rect[3]));
    return next_phase(script);
}

enum step step_click(struct script *script, struct viewer *viewer,
                     const struct command_line *command, struct err *err)
{
    switch (script->now.phase) {
    case 0:
        return aim(script, viewer, command->texts[0], err);
    case 1: // the control has received the mouse's position
        return script->now.frame++ == 0 ? STEP_AGAIN : next_phase(script);
    case 2:
        push_button(script, viewer, 0, true);
        return next_phase(script);
    case 3:
        return script->now.frame++ == 0 ? STEP_AGAIN : next_phase(script);
    case 4:
        push_button(script, viewer, 0, false);
        return next_phase(script);
    default:
        return rest_frames(script, FRAMES_TO_SEE);
    }
}

#define DRAG_STEPS 4u

enum step step_drag(struct script *script, struct viewer *viewer,
                    const struct command_line *command, struct err *err)
{
    switch (script->now.phase) {
    case 0:
        return aim(script, viewer, command->texts[0], err);
    case 1:
        return script->now.frame++ == 0 ? STEP_AGAIN : next_phase(script);
    case 2:
        push_button(script, viewer, 0, true);
        return next_phase(script);
    case 3:
        if (script->now.frame++ == DRAG_STEPS)
            return next_phase(script);
        push_mouse(script, viewer, script->mouse[0] + command->numbers[0] / DRAG_STEPS,
                   script->mouse[1] + command->numbers[1] / DRAG_STEPS);
        return STEP_AGAIN;
    case 4:
        push_button(script, viewer, 0, false);
        return next_phase(script);
    default:
        return rest_frames(script, FRAMES_TO_SEE);
    }
}
