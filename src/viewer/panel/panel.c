#include "viewer/panel/panel.h"
#include "viewer/core/reload.h"
#include "viewer/core/save.h"

#include "viewer/panel/panel_internal.h"
#include <assert.h>
#include <stdlib.h>

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

// --- files, shaders, history, keys ---------------------------------------------------------------

static void files(struct viewer *viewer)
{
    struct gui *gui = &viewer->shell.gui;
    struct panel *panel = viewer->shell.panel;
    gui_group_begin(gui, "files", "Files", "Pictures and scenes are written here.", false);
    gui_switch(gui, "files.with_panel", "With panel",
               "Screenshots show the panel, too; off: the picture alone.", &panel->saves_panel);
    if (gui_button(gui, "files.screenshot", "Screenshot (F12)",
                   "Writes what is shown as a PNG into the working directory."))
        save_png(viewer, NULL, panel->saves_panel);
    gui_enabled(gui, viewer->stage.shown.denoise);
    gui_switch(gui, "files.denoised", "Denoised",
               "EXRs get the denoised preview instead of the film; off: what was rendered.",
               &panel->saves_denoised);
    gui_enabled(gui, viewer->document.has_scene);
    if (gui_button(gui, "files.exr", "EXR (F11)",
                   "Writes the chosen side's film with all metadata into the working directory."))
        save_exr(viewer, viewer->stage.edited_side, NULL,
                 panel->saves_denoised && viewer->stage.shown.denoise);
    gui_text(gui, "files.scene_path", "Scene file",
             "Where \"Save scene\" writes to; it must end in .json.", panel->save_path,
             sizeof panel->save_path);
    gui_enabled(gui, viewer->document.has_scene && panel->save_path[0]);
    if (gui_button(gui, "files.save_scene", "Save scene",
                   "Writes what was edited as a scene file that names the original as its base."))
        save_scene(viewer, panel->save_path);
    gui_group_end(gui);
}

static void shaders(struct viewer *viewer)
{
    struct gui *gui = &viewer->shell.gui;
    const char *why_not = NULL;
    bool can = reload_can_compile(viewer->shell.reload, &why_not);
    gui_group_begin(gui, "shaders", "Shaders", "Kernels compiled anew from their sources.", false);
    gui_enabled(gui, can);
    if (gui_button(gui, "shaders.reload", "Reload (F5)",
                   "Compiles all kernels anew; where one fails, the old ones stay."))
        reload_shaders(viewer);
    if (gui_is_drawn(gui)) {
        if (can)
            gui_line(gui, "%s", reload_folder(viewer->shell.reload));
        else
            gui_warning(gui, "%s", why_not ? why_not : "not possible here");
        const char *errors = reload_errors(viewer->shell.reload);
        if (errors[0])
            gui_warning(gui, "%s", errors);
    }
    gui_group_end(gui);
}

static void history(struct viewer *viewer)
{
    struct gui *gui = &viewer->shell.gui;
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
    struct gui *gui = &viewer->shell.gui;
    gui_group_begin(gui, "keys", "Keys", "What keys and mouse do over the picture.", false);
    for (const struct key_help *key = viewer_keys; gui_is_drawn(gui) && key->keys; key++)
        gui_pair(gui, key->keys, "%s", key->help);
    gui_group_end(gui);
}

void panel_draw(struct viewer *viewer)
{
    struct gui *gui = &viewer->shell.gui;
    gui->is_hidden = !viewer->shell.is_panel_shown;
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
