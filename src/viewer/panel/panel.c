#include "viewer/panel/panel.h"

#include "base/maths.h"
#include "viewer/panel/panel_internal.h"
#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const struct gui_range panel_unit = {0, 1};
const struct gui_range panel_radiance = {0, SCENE_RADIANCE_MAX, .logarithmic = true};
const struct gui_range panel_turn = {-360, 360, .unit = "°"};

struct gui_range panel_coordinate(const struct viewer *viewer)
{
    double diagonal = 0;
    for (int c = 0; c < 3; c++) {
        double side = viewer->bounds_max[c] - viewer->bounds_min[c];
        diagonal += side * side;
    }
    bool is_some = viewer->bounds_min[0] <= viewer->bounds_max[0] && isfinite(diagonal);
    return (struct gui_range){-SCENE_COORDINATE_MAX, SCENE_COORDINATE_MAX,
                              .drag = is_some ? sqrt(diagonal) : 0};
}

bool panel_create(struct panel **out, struct err *err)
{
    *out = calloc(1, sizeof **out);
    if (!*out)
        return err_memory(err, "a panel", sizeof **out);
    (*out)->slot = 1;
    return panel_settings_create(*out, err);
}

void panel_destroy(struct panel *panel)
{
    if (!panel)
        return;
    free(panel->materials.rows);
    free(panel->lights.rows);
    free(panel->objects.rows);
    arena_finish(&panel->files_arena);
    arena_finish(&panel->arena);
    free(panel);
}

// --- forms ---------------------------------------------------------------------------------------

static bool used(struct form *form, const char *id, bool is_used)
{
    if (is_used)
        form->used = id;
    return is_used;
}

bool form_switch(struct form *form, const char *id, const char *label, const char *help,
                 bool *value)
{
    return used(form, id, gui_switch(form->gui, id, label, help, value));
}

bool form_flag(struct form *form, const char *id, const char *label, const char *help,
               uint32_t *value)
{
    bool on = *value != 0;
    if (!form_switch(form, id, label, help, &on))
        return false;
    *value = on;
    return true;
}

bool form_number(struct form *form, const char *id, const char *label, const char *help,
                 const struct gui_range *range, double *value)
{
    return used(form, id, gui_number(form->gui, id, label, help, range, value));
}

bool form_float(struct form *form, const char *id, const char *label, const char *help,
                const struct gui_range *range, float *value)
{
    return used(form, id, gui_float(form->gui, id, label, help, range, value));
}

bool form_count(struct form *form, const char *id, const char *label, const char *help,
                const struct gui_range *range, uint32_t *value)
{
    return used(form, id, gui_count(form->gui, id, label, help, range, value));
}

bool form_angle(struct form *form, const char *id, const char *label, const char *help,
                const struct gui_range *range, double *radians)
{
    double degrees = *radians * (180.0 / M_PI);
    if (!form_number(form, id, label, help, range, &degrees))
        return false;
    *radians = degrees * DEGREE;
    return true;
}

bool form_choice(struct form *form, const char *id, const char *label, const char *help,
                 const char *const *names, uint32_t *value)
{
    return used(form, id, gui_choice(form->gui, id, label, help, names, value));
}

bool form_color(struct form *form, const char *id, const char *label, const char *help,
                const struct gui_range *range, float value[3])
{
    return used(form, id, gui_color(form->gui, id, label, help, range, value));
}

bool form_vector(struct form *form, const char *id, const char *label, const char *help,
                 const struct gui_range *range, double value[3])
{
    return used(form, id, gui_vector(form->gui, id, label, help, range, value));
}

// --- files, shaders, history, keys ---------------------------------------------------------------

static void files(struct viewer *viewer)
{
    struct gui *gui = &viewer->gui;
    struct panel *panel = viewer->panel;
    gui_group_begin(gui, "files", "Files", "Pictures and scenes are written here.", false);
    gui_switch(gui, "files.with_panel", "With panel",
               "Screenshots show the panel, too; off: the picture alone.", &panel->saves_panel);
    if (gui_button(gui, "files.screenshot", "Screenshot (F12)",
                   "Writes what is shown as a PNG into the working directory."))
        save_png(viewer, NULL, panel->saves_panel);
    gui_enabled(gui, viewer->shown.denoise);
    gui_switch(gui, "files.denoised", "Denoised",
               "EXRs get the denoised preview instead of the film; off: what was rendered.",
               &panel->saves_denoised);
    gui_enabled(gui, viewer->has_scene);
    if (gui_button(gui, "files.exr", "EXR (F11)",
                   "Writes the chosen side's film with all metadata into the working directory."))
        save_exr(viewer, viewer->edited_side, NULL, panel->saves_denoised && viewer->shown.denoise);
    gui_text(gui, "files.scene_path", "Scene file",
             "Where \"Save scene\" writes to; it must end in .json.", panel->save_path,
             sizeof panel->save_path);
    gui_enabled(gui, viewer->has_scene && panel->save_path[0]);
    if (gui_button(gui, "files.save_scene", "Save scene",
                   "Writes what was edited as a scene file that names the original as its base."))
        save_scene(viewer, panel->save_path);
    gui_group_end(gui);
}

static void shaders(struct viewer *viewer)
{
    struct gui *gui = &viewer->gui;
    const char *why_not = NULL;
    bool can = reload_can_compile(viewer->reload, &why_not);
    gui_group_begin(gui, "shaders", "Shaders", "Kernels compiled anew from their sources.", false);
    gui_enabled(gui, can);
    if (gui_button(gui, "shaders.reload", "Reload (F5)",
                   "Compiles all kernels anew; where one fails, the old ones stay."))
        reload_shaders(viewer);
    if (gui_is_drawn(gui)) {
        if (can)
            gui_line(gui, "%s", reload_folder(viewer->reload));
        else
            gui_warning(gui, "%s", why_not ? why_not : "not possible here");
        const char *errors = reload_errors(viewer->reload);
        if (errors[0])
            gui_warning(gui, "%s", errors);
    }
    gui_group_end(gui);
}

static void history(struct viewer *viewer)
{
    struct gui *gui = &viewer->gui;
    gui_group_begin(gui, "history", "History", "Changes taken back and made again.", false);
    gui_enabled(gui, edit_undo_count(viewer) > 0);
    if (gui_button(gui, "history.undo", "Undo (Ctrl+Z)", "Takes back the last change."))
        edit_undo(viewer);
    gui_same_line(gui);
    gui_enabled(gui, edit_redo_count(viewer) > 0);
    if (gui_button(gui, "history.redo", "Redo (Ctrl+Y)", "Makes what was taken back again."))
        edit_redo(viewer);
    if (gui_is_drawn(gui)) {
        const char *name = edit_undo_name(viewer);
        gui_fact(gui, "Changes", "%u%s%s", edit_undo_count(viewer), name ? ", the last: " : "",
                 name ? name : "");
    }
    gui_group_end(gui);
}

static void keys(struct viewer *viewer)
{
    struct gui *gui = &viewer->gui;
    gui_group_begin(gui, "keys", "Keys", "What keys and mouse do over the picture.", false);
    for (const struct key_help *key = viewer_keys; gui_is_drawn(gui) && key->keys; key++)
        gui_pair(gui, key->keys, "%s", key->help);
    gui_group_end(gui);
}

void panel_draw(struct viewer *viewer)
{
    struct gui *gui = &viewer->gui;
    gui->is_hidden = !viewer->is_panel_shown;
    gui_panel_begin(gui, "Lampyris");
    panel_statistics(viewer);
    panel_view(viewer);
    panel_renderer(viewer);
    panel_camera(viewer);
    panel_scene(viewer);
    files(viewer);
    shaders(viewer);
    history(viewer);
    keys(viewer);
    gui_panel_end(gui);
    panel_overlay(viewer);
    assert(!gui_duplicate(gui)); // of the last frame
}
