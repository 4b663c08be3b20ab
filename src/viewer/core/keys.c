#include "viewer/core/keys.h"

#include "scene/json/scene_write.h"
#include "viewer/core/frame.h"
#include "viewer/core/load.h"
#include "viewer/core/messages.h"
#include "viewer/core/pick.h"
#include "viewer/core/reload.h"
#include "viewer/core/save.h"
#include "viewer/core/viewer.h"
#include <GLFW/glfw3.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

// The greatest distance, in points, that the mouse may move while its button is held for a click.
#define CLICK_POINTS 4.0
#define DOUBLE_CLICK_SECONDS 0.5
// The distance from the dividing line of a split view, in points, within which the line can be
// dragged.
#define SPLIT_POINTS 6.0
#define SPEED_FACTOR 1.25 // change of the flying speed per notch of the wheel
#define EXPOSURE_STEP 0.5 // stops

// --- functions of keys ---------------------------------------------------------------------------

static void do_undo(struct viewer *viewer)
{
    if (!edit_undo(viewer))
        viewer_message(viewer, MESSAGE_NOTE, "there is nothing to undo");
}

static void do_redo(struct viewer *viewer)
{
    if (!edit_redo(viewer))
        viewer_message(viewer, MESSAGE_NOTE, "there is nothing to redo");
}

static void do_save_scene(struct viewer *viewer)
{
    save_scene(viewer, NULL);
}

static void do_copy_camera(struct viewer *viewer)
{
    char *text = viewer->document.has_scene
                     ? camera_to_json(&viewer->shell.frame_arena, &viewer->view.camera)
                     : NULL;
    if (!text)
        return;
    window_set_clipboard(&viewer->shell.window, text);
    viewer_message(viewer, MESSAGE_NOTE, "the camera was copied as JSON");
}

static void do_panel(struct viewer *viewer)
{
    viewer->shell.is_panel_shown = !viewer->shell.is_panel_shown;
}

static void do_reload(struct viewer *viewer)
{
    reload_shaders(viewer);
    if (viewer->document.has_scene)
        viewer_open_scene(viewer, viewer->document.scene_path, true);
}

static void do_exr(struct viewer *viewer)
{
    save_exr(viewer, viewer->stage.edited_side, NULL, false);
}

static void do_png(struct viewer *viewer)
{
    save_png(viewer, NULL, false);
}

static void do_pause(struct viewer *viewer)
{
    viewer->stage.is_paused = !viewer->stage.is_paused;
    viewer->stage.is_resting = false;
    viewer_message(viewer, MESSAGE_NOTE,
                   viewer->stage.is_paused ? "paused" : "rendering continues");
}

static void do_split(struct viewer *viewer)
{
    struct shown shown = viewer->stage.shown;
    shown.split = !shown.split;
    edit_shown(viewer, &shown, "view.split");
}

static void do_denoise(struct viewer *viewer)
{
    struct shown shown = viewer->stage.shown;
    shown.denoise = !shown.denoise;
    edit_shown(viewer, &shown, "view.denoise");
}

static void show_next(struct viewer *viewer, uint32_t steps)
{
    struct shown shown = viewer->stage.shown;
    shown.what = (shown.what + steps) % SHOWN_COUNT;
    if (edit_shown(viewer, &shown, "view.aov"))
        viewer_message(viewer, MESSAGE_NOTE, "%s", shown_names[shown.what]);
}

static void do_next_aov(struct viewer *viewer)
{
    show_next(viewer, 1);
}

static void do_last_aov(struct viewer *viewer)
{
    show_next(viewer, SHOWN_COUNT - 1);
}

static void expose(struct viewer *viewer, float stops)
{
    struct shown shown = viewer->stage.shown;
    float most = (float)SETTINGS_EXPOSURE_MAX;
    shown.exposure = fmaxf(-most, fminf(shown.exposure + stops, most));
    edit_shown(viewer, &shown, "view.exposure");
    viewer_message(viewer, MESSAGE_NOTE, "exposure %+.1f stops", (double)shown.exposure);
}

static void do_darker(struct viewer *viewer)
{
    expose(viewer, -(float)EXPOSURE_STEP);
}

static void do_brighter(struct viewer *viewer)
{
    expose(viewer, (float)EXPOSURE_STEP);
}

static void do_rig_mode(struct viewer *viewer)
{
    viewer->view.rig.mode = (viewer->view.rig.mode + 1) % CAMERA_RIG_MODE_COUNT;
    viewer_message(viewer, MESSAGE_NOTE, "camera: %s",
                   camera_rig_mode_names[viewer->view.rig.mode]);
}

static void do_revolve(struct viewer *viewer)
{
    viewer->view.rig.revolves = !viewer->view.rig.revolves;
    if (viewer->view.rig.revolves)
        viewer->view.rig.mode = CAMERA_RIG_ORBIT;
    viewer->stage.is_resting = false;
}

static void do_home(struct viewer *viewer)
{
    if (viewer->document.has_scene)
        viewer_go_home(viewer);
}

static void do_frame(struct viewer *viewer)
{
    struct camera camera = viewer->view.camera;
    double aspect = (double)viewer->shell.window.width / viewer->shell.window.height;
    if (!viewer->document.has_scene)
        return;
    camera_rig_frame(&viewer->view.rig, viewer->document.bounds_min, viewer->document.bounds_max,
                     aspect, &camera);
    edit_camera(viewer, &camera, "camera.frame");
}

static void do_help(struct viewer *viewer)
{
    viewer->view.keys.shows_help = !viewer->view.keys.shows_help;
}

static void do_quit(struct viewer *viewer)
{
    viewer->shell.wants_quit = true;
}

struct binding {
    int key;
    uint32_t modifiers; // required modifiers: Shift, Ctrl
    void (*act)(struct viewer *viewer);
    bool repeats;
};

static const struct binding bindings[] = {
    {GLFW_KEY_Z, EVENT_CONTROL, do_undo, true},
    {GLFW_KEY_Y, EVENT_CONTROL, do_redo, true},
    {GLFW_KEY_Z, EVENT_CONTROL | EVENT_SHIFT, do_redo, true},
    {GLFW_KEY_S, EVENT_CONTROL, do_save_scene, false},
    {GLFW_KEY_C, EVENT_CONTROL, do_copy_camera, false},
    {GLFW_KEY_C, 0, do_rig_mode, false},
    {GLFW_KEY_R, 0, do_revolve, false},
    {GLFW_KEY_F, 0, do_frame, false},
    {GLFW_KEY_HOME, 0, do_home, false},
    {GLFW_KEY_SPACE, 0, do_pause, false},
    {GLFW_KEY_V, 0, do_split, false},
    {GLFW_KEY_N, 0, do_denoise, false},
    {GLFW_KEY_TAB, 0, do_next_aov, false},
    {GLFW_KEY_TAB, EVENT_SHIFT, do_last_aov, false},
    {GLFW_KEY_LEFT_BRACKET, 0, do_darker, true},
    {GLFW_KEY_RIGHT_BRACKET, 0, do_brighter, true},
    {GLFW_KEY_F1, 0, do_panel, false},
    {GLFW_KEY_F5, 0, do_reload, false},
    {GLFW_KEY_F11, 0, do_exr, false},
    {GLFW_KEY_F12, 0, do_png, false},
    {GLFW_KEY_H, 0, do_help, false},
    {GLFW_KEY_ESCAPE, 0, do_quit, false},
};

const struct key_help viewer_keys[] = {
    {"W A S D", "fly forwards, left, backwards, right"},
    {"A D", "while the camera revolves (R): slower, faster; below 0 the direction is reversed"},
    {"E Q", "fly up, down"},
    {"Shift", "fly at a tenth of the speed"},
    {"Right drag", "look around; in orbit mode: turn about the surface under the mouse"},
    {"Left drag", "same as Right drag; on the dividing line of a split view: move the line"},
    {"Middle drag", "pan"},
    {"Wheel", "fly mode: change the speed; orbit mode: move closer, farther away"},
    {"Click", "select the object under the mouse, and open its tab in the panel"},
    {"Double click", "make this point the centre of orbits and the focus of the lens"},
    {"C", "fly or orbit"},
    {"R", "start or stop revolving about the target"},
    {"F", "frame the whole scene"},
    {"Home", "return to the scene's camera; if it has none, frame the whole scene"},
    {"1 to 9", "restore a saved view"},
    {"Ctrl+1 to Ctrl+9", "save the view"},
    {"Ctrl+Z", "undo"},
    {"Ctrl+Y, Ctrl+Shift+Z", "redo"},
    {"Ctrl+S", "save the scene as JSON"},
    {"Ctrl+C", "copy the camera as JSON"},
    {"Space", "pause or continue rendering"},
    {"V", "turn the split view of two settings on or off"},
    {"N", "turn denoising of the display on or off"},
    {"Tab, Shift+Tab", "show the next or previous layer: radiance, albedo, normals ..."},
    {"[ ]", "make the display darker or brighter by half a stop"},
    {"F1", "show or hide the panel"},
    {"F5", "reload shaders and scene"},
    {"F11", "save the film as EXR"},
    {"F12", "save the displayed picture as PNG"},
    {"H", "show or hide this list"},
    {"Esc", "quit"},
    {NULL, NULL},
};

static bool act(struct viewer *viewer, const struct event *event)
{
    uint32_t modifiers = event->modifiers & (EVENT_CONTROL | EVENT_SHIFT);
    for (size_t i = 0; i < sizeof bindings / sizeof *bindings; i++) {
        const struct binding *binding = &bindings[i];
        if (binding->key != event->code || binding->modifiers != modifiers)
            continue;
        if (!event->repeated || binding->repeats)
            binding->act(viewer);
        return true;
    }
    return false;
}

static bool saved_view(struct viewer *viewer, const struct event *event)
{
    if (event->code < GLFW_KEY_1 || event->code > GLFW_KEY_9 || !viewer->document.has_scene)
        return false;
    int number = event->code - GLFW_KEY_0;
    struct saved_view *view = &viewer->view.saved[number - 1];
    if (event->modifiers & EVENT_CONTROL) {
        *view = (struct saved_view){true, viewer->view.camera};
        viewer_message(viewer, MESSAGE_NOTE, "view %d saved", number);
    } else if (view->is_used) {
        edit_camera(viewer, &view->camera, "camera.restore");
    } else {
        viewer_message(viewer, MESSAGE_NOTE,
                       "view %d is empty: Ctrl+%d saves the current camera there", number, number);
    }
    return true;
}

// --- held keys -----------------------------------------------------------------------------------

static void hold(struct keys *keys, const struct event *event)
{
    static const struct {
        int code;
        enum held_key held;
    } table[] = {
        {GLFW_KEY_W, HELD_FORWARD},
        {GLFW_KEY_S, HELD_BACK},
        {GLFW_KEY_A, HELD_LEFT},
        {GLFW_KEY_D, HELD_RIGHT},
        {GLFW_KEY_E, HELD_UP},
        {GLFW_KEY_Q, HELD_DOWN},
        {GLFW_KEY_LEFT_SHIFT, HELD_SLOW},
        {GLFW_KEY_RIGHT_SHIFT, HELD_SLOW},
    };
    for (size_t i = 0; i < sizeof table / sizeof *table; i++)
        if (table[i].code == event->code && (!event->down || !(event->modifiers & EVENT_CONTROL)))
            keys->held[table[i].held] = event->down;
}

static void take_key(struct viewer *viewer, const struct event *event)
{
    if (!event->down) {
        hold(&viewer->view.keys, event);
        return;
    }
    if (!saved_view(viewer, event) && !act(viewer, event))
        hold(&viewer->view.keys, event);
}

static void let_go(struct viewer *viewer)
{
    struct keys *keys = &viewer->view.keys;
    if (viewer->shell.window.is_captured)
        window_capture(&viewer->shell.window, false);
    memset(keys->held, 0, sizeof keys->held);
    memset(keys->buttons, 0, sizeof keys->buttons);
    keys->drag = DRAG_NONE;
}

bool viewer_holds_nothing(const struct viewer *viewer)
{
    const struct keys *keys = &viewer->view.keys;
    for (int i = 0; i < HELD_COUNT; i++)
        if (keys->held[i] && i != HELD_SLOW)
            return false;
    return !keys->buttons[0] && !keys->buttons[1] && !keys->buttons[2] && keys->look[0] == 0.0 &&
           keys->look[1] == 0.0 && keys->dolly == 0.0 && !viewer->document.pose.plays &&
           !(viewer->view.rig.revolves && viewer->view.rig.mode == CAMERA_RIG_ORBIT);
}

// --- mouse ---------------------------------------------------------------------------------------

static bool is_on_split(const struct viewer *viewer, double x)
{
    double line = viewer_split_x(viewer);
    return viewer->stage.shown.split &&
           fabs(x - line) <= SPLIT_POINTS * (double)viewer->shell.window.scale;
}

// Begins to look around. An orbit turns about the surface that is under the mouse at this time.
static void begin_look(struct viewer *viewer)
{
    struct keys *keys = &viewer->view.keys;
    keys->drag = DRAG_LOOK;
    keys->wants_pivot = viewer->view.rig.mode == CAMERA_RIG_ORBIT;
}

static void press(struct viewer *viewer, int button)
{
    struct keys *keys = &viewer->view.keys;
    if (keys->drag != DRAG_NONE)
        return;
    keys->drag_button = button;
    keys->pressed_x = keys->x;
    keys->pressed_y = keys->y;
    if (button == 0)
        keys->drag = is_on_split(viewer, keys->x) ? DRAG_SPLIT : DRAG_PENDING;
    else
        keys->drag = DRAG_PAN;
    if (button == 1) {
        window_capture(&viewer->shell.window, true);
        begin_look(viewer);
    }
}

static void click(struct viewer *viewer)
{
    struct keys *keys = &viewer->view.keys;
    double now = viewer_seconds(viewer), points = CLICK_POINTS * (double)viewer->shell.window.scale;
    bool is_near = hypot(keys->x - keys->clicked_x, keys->y - keys->clicked_y) <= points;
    keys->wants_focus = is_near && now - keys->clicked_seconds < DOUBLE_CLICK_SECONDS;
    keys->wants_pick = true;
    keys->pick_x = keys->x;
    keys->pick_y = keys->y;
    keys->clicked_seconds = keys->wants_focus ? -DOUBLE_CLICK_SECONDS : now;
    keys->clicked_x = keys->x;
    keys->clicked_y = keys->y;
}

static void release(struct viewer *viewer, int button)
{
    struct keys *keys = &viewer->view.keys;
    if (keys->drag == DRAG_NONE || keys->drag_button != button)
        return;
    if (keys->drag == DRAG_PENDING)
        click(viewer);
    if (button == 1)
        window_capture(&viewer->shell.window, false);
    keys->drag = DRAG_NONE;
}

static void move_split(struct viewer *viewer, double x)
{
    struct shown shown = viewer->stage.shown;
    uint32_t place[4];
    viewer_picture_place(viewer, place);
    shown.split_at = fmax(0.0, fmin((x - place[0]) / place[2], 1.0));
    edit_shown(viewer, &shown, "view.split_at");
}

static void take_move(struct viewer *viewer, double x, double y)
{
    struct keys *keys = &viewer->view.keys;
    double dx = x - keys->x, dy = y - keys->y;
    double points = CLICK_POINTS * (double)viewer->shell.window.scale;
    keys->x = x;
    keys->y = y;
    if (keys->drag == DRAG_PENDING && hypot(x - keys->pressed_x, y - keys->pressed_y) > points) {
        begin_look(viewer);
        dx = x - keys->pressed_x;
        dy = y - keys->pressed_y;
    }
    if (keys->drag == DRAG_LOOK) {
        keys->look[0] += dx;
        keys->look[1] += dy;
    } else if (keys->drag == DRAG_PAN) {
        keys->pan[0] += dx;
        keys->pan[1] += dy;
    } else if (keys->drag == DRAG_SPLIT) {
        move_split(viewer, x);
    }
}

static void take_wheel(struct viewer *viewer, double notches)
{
    struct camera_rig *rig = &viewer->view.rig;
    if (rig->mode == CAMERA_RIG_ORBIT) {
        viewer->view.keys.dolly += notches;
        return;
    }
    double speed = rig->speed * pow(SPEED_FACTOR, notches);
    if (!(speed > 0.0) || !isfinite(speed))
        return;
    rig->speed = speed;
    viewer_message(viewer, MESSAGE_NOTE, "speed %.3g m/s", rig->speed);
}

void viewer_event(struct viewer *viewer, const struct event *event)
{
    struct keys *keys = &viewer->view.keys;
    switch (event->kind) {
    case EVENT_KEY:
        take_key(viewer, event);
        break;
    case EVENT_BUTTON:
        if (event->code < 0 || event->code > 2)
            break;
        keys->buttons[event->code] = event->down;
        if (event->down)
            press(viewer, event->code);
        else
            release(viewer, event->code);
        break;
    case EVENT_MOVE:
        take_move(viewer, event->x, event->y);
        break;
    case EVENT_SCROLL:
        take_wheel(viewer, event->y);
        break;
    case EVENT_FOCUS:
        if (!event->down)
            let_go(viewer);
        break;
    case EVENT_TEXT:
    case EVENT_DROP:
    case EVENT_RESIZE:
    case EVENT_CLOSE:
        break;
    }
}

// --- camera movement and clicks ------------------------------------------------------------------

void viewer_move_camera(struct viewer *viewer, double seconds)
{
    struct keys *keys = &viewer->view.keys;
    const bool *held = keys->held;
    struct camera camera = viewer->view.camera;
    uint32_t place[4];
    viewer_picture_place(viewer, place);
    const struct camera_rig_input input = {
        .forward = held[HELD_FORWARD] - held[HELD_BACK],
        .right = held[HELD_RIGHT] - held[HELD_LEFT],
        .up = held[HELD_UP] - held[HELD_DOWN],
        .slow = held[HELD_SLOW],
        .look = {keys->look[0], keys->look[1]},
        .pan = {keys->pan[0], keys->pan[1]},
        .dolly = keys->dolly,
        .window_width = viewer->shell.window.width,
        .picture_height = place[3],
        .seconds = seconds,
    };
    if (keys->wants_pivot) // viewer_answer_click() finds it in the image before the camera turns
        return;
    if (viewer->document.has_scene && camera_rig_step(&viewer->view.rig, &input, &camera))
        edit_camera(viewer, &camera, "keys.camera");
    keys->look[0] = keys->look[1] = keys->pan[0] = keys->pan[1] = keys->dolly = 0.0;
}

// Opens the panel's tab of objects, and scrolls its list to the selected one.
static void show_choice(struct viewer *viewer)
{
    char id[GUI_ID_MAX];
    snprintf(id, sizeof id, "object.%u", viewer->document.chosen_object);
    // The row may have no control yet, because lists draw few of their rows.
    gui_reveal(&viewer->shell.gui, "objects");
    gui_reveal(&viewer->shell.gui, id);
}

static void choose(struct viewer *viewer, const struct picked *picked)
{
    viewer->document.picked = *picked;
    viewer->document.has_choice = picked->object != VIEWER_NO_OBJECT;
    if (picked->object == VIEWER_NO_OBJECT)
        return;
    viewer->document.chosen_object = picked->object;
    viewer->document.chosen_material = picked->material;
    show_choice(viewer);
}

// Makes the surface under the mouse, if there is one, the target of the orbit that has begun.
static bool find_pivot(struct viewer *viewer, struct err *err)
{
    struct keys *keys = &viewer->view.keys;
    struct picked picked;
    if (!keys->wants_pivot)
        return true;
    keys->wants_pivot = false;
    if (!viewer_pick(viewer, keys->pressed_x, keys->pressed_y, &picked, err))
        return false;
    if (picked.object != VIEWER_NO_OBJECT)
        memcpy(viewer->view.rig.target, picked.position, sizeof viewer->view.rig.target);
    return true;
}

bool viewer_answer_click(struct viewer *viewer, struct err *err)
{
    struct keys *keys = &viewer->view.keys;
    struct picked picked;
    if (!find_pivot(viewer, err))
        return false;
    if (!keys->wants_pick)
        return true;
    keys->wants_pick = false;
    if (!viewer_pick(viewer, keys->pick_x, keys->pick_y, &picked, err))
        return false;
    choose(viewer, &picked);
    if (!keys->wants_focus || picked.object == VIEWER_NO_OBJECT)
        return true;
    struct camera camera = viewer->view.camera;
    camera_rig_focus(&viewer->view.rig, picked.position, &camera);
    edit_camera(viewer, &camera, "camera.focus");
    viewer_message(viewer, MESSAGE_NOTE, "the focus is %.4g m away", picked.distance);
    return true;
}
