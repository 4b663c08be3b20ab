// The camera, its movement, and saved views.
#include "viewer/panel/panel_internal.h"

#include "scene/core/affine.h"
#include "scene/json/scene_write.h"
#include "viewer/core/frame.h"
#include "viewer/core/load.h"
#include "viewer/core/messages.h"
#include <math.h>
#include <stdio.h>
#include <string.h>

static const struct gui_range angle = {1e-3, 179.999, .unit = "°", .drag = 90};
static const struct gui_range metres = {SCENE_LENGTH_MIN, SCENE_COORDINATE_MAX, .logarithmic = true,
                                        .unit = "m"};
static const struct gui_range millimetres = {0, SCENE_LENS_MAX_MM, .logarithmic = true,
                                             .unit = "mm", .least = "pinhole"};
static const struct gui_range blades = {0, SCENE_LENS_BLADES_MAX, .integer = true,
                                        .least = "round"};
static const struct gui_range speed = {SCENE_LENGTH_MIN, SCENE_COORDINATE_MAX, .logarithmic = true,
                                       .unit = "m/s"};
static const struct gui_range turning = {-360, 360, .unit = "°/s", .drag = 90};
static const struct gui_range slot = {1, VIEWER_SAVED_VIEWS, .integer = true};

// --- moving the camera ---------------------------------------------------------------------------

static void moving(struct panel *panel, struct viewpoint *view)
{
    struct gui *gui = panel->gui;
    struct camera_rig *rig = &view->rig;
    gui_choice(gui, "camera.mode", "Moves",
               "Fly freely, or orbit the surface under the mouse (C changes it).",
               camera_rig_mode_names, &rig->mode);
    gui_number(gui, "camera.speed", "Speed", "Flying speed in metres per second.", &speed,
               &rig->speed);
    if (gui_switch(gui, "camera.revolves", "Revolve", "Revolves continuously about the target.",
                   &rig->revolves) &&
        rig->revolves)
        rig->mode = CAMERA_RIG_ORBIT;
    gui_number(gui, "camera.revolve_speed", "  speed",
               "Speed of revolving in degrees per second; negative values reverse the direction.",
               &turning, &rig->revolve_speed);
    if (gui_button(gui, "camera.stop", "Stop", "Stops revolving.")) {
        rig->revolves = false;
        edit_close(panel->viewer);
    }
}

// --- the camera itself ---------------------------------------------------------------------------

static double target_distance(const struct viewpoint *view)
{
    double away[3];
    for (int c = 0; c < 3; c++)
        away[c] = view->rig.target[c] - view->camera.position[c];
    double distance = vec3_length(away);
    return distance > 0 && isfinite(distance) ? distance : 1;
}

// Converts a camera to another kind that shows about as much of the target. Only a perspective
// camera has a lens.
static void change_kind(const struct viewpoint *view, struct camera *to)
{
    if (!(to->fov_y > 0 && to->fov_y < M_PI))
        to->fov_y = M_PI / 4;
    if (!(to->height > 0))
        to->height = 2 * target_distance(view) * tan(to->fov_y / 2);
    if (to->kind != CAMERA_PERSPECTIVE)
        to->lens_radius = 0;
}

static void lens(const struct viewpoint *view, struct gui *gui, struct camera *to)
{
    bool is_perspective = to->kind == CAMERA_PERSPECTIVE;
    double radius = to->lens_radius * 1e3;
    gui_applies(gui, is_perspective);
    gui_angle(gui, "camera.fov", "Field of view",
              "Angle between the lower and the upper edge of the picture, in degrees.", &angle,
              &to->fov_y);
    gui_applies(gui, to->kind == CAMERA_ORTHOGRAPHIC);
    gui_number(gui, "camera.height", "Height",
               "Height, in metres, of the region that an orthographic camera sees.", &metres,
               &to->height);
    gui_applies(gui, is_perspective);
    if (gui_number(gui, "camera.lens_radius", "Lens radius",
                   "Radius in millimetres; 0: a pinhole camera, with which everything is in focus.",
                   &millimetres, &radius))
        to->lens_radius = radius * 1e-3;
    if (to->lens_radius > 0 && !(to->focus_distance > 0))
        to->focus_distance = target_distance(view);
    gui_applies(gui, is_perspective && to->lens_radius > 0);
    gui_number(gui, "camera.focus", "Focus", "Distance of the plane in focus, in metres.", &metres,
               &to->focus_distance);
    uint32_t corners = to->lens_blades;
    if (gui_count(gui, "camera.blades", "Blades",
                  "Number of blades of the aperture; 0: it is round. 1 and 2 become 3.", &blades,
                  &corners)) {
        // Numbers of blades between 0 (a round aperture) and 3 are invalid, so dragging skips them.
        bool is_falling = corners < to->lens_blades;
        to->lens_blades = corners == 1 || corners == 2 ? (is_falling ? 0 : 3) : corners;
    }
    gui_applies(gui, is_perspective && to->lens_radius > 0 && to->lens_blades > 0);
    gui_angle(gui, "camera.blade_rotation", "  rotation", "Rotation of the blades in degrees.",
              &panel_turn, &to->lens_rotation);
    gui_enabled(gui, true);
}

static void camera_of_scene(struct panel *panel, const struct document *document,
                            struct viewpoint *view)
{
    const struct scene *scene = &document->scene;
    uint32_t count = scene->camera_count;
    const char **names = ARENA_NEW(panel->frame_arena, const char *, count + 1u);
    uint32_t chosen = view->camera_index;
    if (!names || !count || chosen >= count)
        return;
    for (uint32_t i = 0; i < count; i++) {
        const char *name = scene->cameras[i].name;
        names[i] = arena_printf(panel->frame_arena, "%u%s%s", i, name && name[0] ? " " : "",
                                name ? name : "");
        if (!names[i])
            return;
    }
    gui_applies(panel->gui, count > 1);
    if (gui_choice(panel->gui, "camera.of_scene", "Of the scene", "A camera of the scene file.",
                   names, &chosen)) {
        view->camera_index = chosen;
        edit_camera(panel->viewer, &scene->cameras[chosen], "camera.of_scene");
    }
    gui_enabled(panel->gui, true);
}

// --- buttons -------------------------------------------------------------------------------------

static void copy_as_json(struct panel *panel, const struct viewpoint *view)
{
    const char *json = camera_to_json(panel->frame_arena, &view->camera);
    if (!json) {
        viewer_message(panel->viewer, MESSAGE_ERROR, "out of memory: the camera was not copied");
        return;
    }
    window_set_clipboard(panel->window, json);
    viewer_message(panel->viewer, MESSAGE_NOTE, "The camera was copied to the clipboard as JSON.");
}

static void frame_all(struct panel *panel, const struct document *document, struct viewpoint *view)
{
    struct camera to = view->camera;
    uint32_t width, height;
    if (!(document->bounds_min[0] <= document->bounds_max[0])) {
        viewer_message(panel->viewer, MESSAGE_WARNING,
                       "There is nothing to frame: the scene is empty.");
        return;
    }
    viewer_picture_size(panel->viewer, &width, &height);
    camera_rig_frame(&view->rig, document->bounds_min, document->bounds_max,
                     (double)width / (double)height, &to);
    edit_camera(panel->viewer, &to, "camera.frame");
}

static void buttons(struct panel *panel, const struct document *document, struct viewpoint *view)
{
    struct gui *gui = panel->gui;
    if (gui_button(
            gui, "camera.reset", "Reset",
            "Returns to the camera of the scene file; if it has none, frames the whole scene."))
        viewer_go_home(panel->viewer);
    gui_same_line(gui);
    if (gui_button(gui, "camera.frame", "Frame all",
                   "Moves the camera so that the whole scene is in the picture."))
        frame_all(panel, document, view);
    gui_same_line(gui);
    if (gui_button(gui, "camera.copy", "Copy as JSON",
                   "Copies the camera to the clipboard in the form that scene files have."))
        copy_as_json(panel, view);
}

static void saved_views(struct panel *panel, struct viewpoint *view)
{
    struct gui *gui = panel->gui;
    gui_count(gui, "camera.slot", "Saved view",
              "The saved view to which the buttons apply; keys 1 to 9 restore views, and save them "
              "with Ctrl.",
              &slot, &panel->slot);
    struct saved_view *saved = &view->saved[panel->slot - 1];
    if (gui_button(gui, "camera.save", "Save", "Saves the current camera in this view."))
        *saved = (struct saved_view){.is_used = true, .camera = view->camera};
    gui_enabled(gui, saved->is_used);
    gui_same_line(gui);
    if (gui_button(gui, "camera.restore", "Restore", "Restores the camera from this view."))
        edit_camera(panel->viewer, &saved->camera, "camera.restore");
    gui_same_line(gui);
    if (gui_button(gui, "camera.clear", "Clear", "Deletes this view."))
        saved->is_used = false;
    gui_enabled(gui, true);
    if (!gui_is_drawn(gui))
        return;
    char used[4 * VIEWER_SAVED_VIEWS] = "none";
    size_t length = 0;
    for (uint32_t i = 0; i < VIEWER_SAVED_VIEWS; i++)
        if (view->saved[i].is_used)
            length += (size_t)snprintf(used + length, sizeof used - length, "%u ", i + 1);
    gui_pair(gui, "  in use", "%s", used);
}

void panel_camera(struct panel *panel, const struct document *document, struct viewpoint *view)
{
    struct gui *gui = panel->gui;
    gui_group_begin(gui, "camera", "Camera", "The position and the kind of the camera.", true);
    if (document->has_scene) {
        moving(panel, view);
        gui_space(gui);
        camera_of_scene(panel, document, view);
        struct camera to = view->camera;
        gui->used = NULL;
        if (gui_choice(gui, "camera.kind", "Kind", "The projection of the camera.", camera_names,
                       &to.kind))
            change_kind(view, &to);
        panel_position(panel, document, "camera.position", "Position in world space, in metres.",
                       to.position);
        panel_direction(panel, "camera.direction", "Viewing direction; it is normalised.", to.up,
                        to.direction);
        lens(view, gui, &to);
        if (gui->used)
            edit_camera(panel->viewer, &to, gui->used);
        gui_space(gui);
        buttons(panel, document, view);
        saved_views(panel, view);
    }
    gui_group_end(gui);
}
