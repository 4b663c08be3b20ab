// Keyboard and mouse input for the image; the panel has input of its own.
#ifndef LAMPYRIS_VIEWER_CORE_KEYS_H
#define LAMPYRIS_VIEWER_CORE_KEYS_H

#include "base/err.h"
#include <stdbool.h>

struct event;
struct viewer;

enum held_key {
    HELD_FORWARD,
    HELD_BACK,
    HELD_LEFT,
    HELD_RIGHT,
    HELD_UP,
    HELD_DOWN,
    HELD_SLOW,
    HELD_COUNT
};

enum drag { DRAG_NONE, DRAG_PENDING, DRAG_LOOK, DRAG_PAN, DRAG_SPLIT };

// The keys that are held, and the movement of the mouse since the last frame.
struct keys {
    bool held[HELD_COUNT];
    bool buttons[3];
    enum drag drag;
    int drag_button;
    double x, y; // position of the mouse, pixels
    double pressed_x, pressed_y;
    double look[2], pan[2], dolly; // movement since the last frame
    double clicked_seconds;        // time of the last click, to detect double clicks
    double clicked_x, clicked_y;
    bool shows_help;
    // wants_pick is set until a click has been evaluated, which requires an image; wants_focus is
    // set for a double click.
    bool wants_pick, wants_focus;
    double pick_x, pick_y;
    // Set from the start of an orbit until its centre is known; the camera does not move meanwhile.
    bool wants_pivot;
};

void viewer_event(struct viewer *viewer, const struct event *event);
// Moves the camera by held keys, mouse movement and the automatic revolution.
void viewer_move_camera(struct viewer *viewer, double seconds);
// Evaluates the last click and the start of an orbit. Returns false if the device failed.
bool viewer_answer_click(struct viewer *viewer, struct err *err);
// Returns whether no key or button is held and no movement is in progress that could change the
// scene.
bool viewer_holds_nothing(const struct viewer *viewer);

struct key_help {
    const char *keys, *help;
};
extern const struct key_help viewer_keys[]; // ends with {NULL}; shown by the panel and the manual

#endif
