#include "viewer/panel/panel.h"
#include "viewer/core/reload.h"
#include "viewer/core/report.h"
#include "viewer/core/save.h"

#include "viewer/core/viewer.h"
#include "viewer/panel/panel_internal.h"
#include <assert.h>
#include <stdlib.h>

#define TAB_RENDER "panel.render"
#define TAB_SCENE "panel.scene"
#define TAB_OBJECT "panel.object"
#define TAB_CAMERA "panel.camera"
#define TAB_MEASURE "panel.measure"

static const struct gui_tab tabs[] = {
    {TAB_RENDER, "Render", "How the picture is rendered, displayed and saved."},
    {TAB_SCENE, "Scene", "The scene's file, environment, lights and animation."},
    {TAB_OBJECT, "Object",
     "The surface that was clicked, the objects and the materials. A click on an object opens it."},
    {TAB_CAMERA, "Camera", "The camera and saved views."},
    {TAB_MEASURE, "Measure", "The speed and the error of the picture, and memory."},
    {NULL, NULL, NULL},
};

bool panel_create(struct panel **out, struct err *err)
{
    *out = calloc(1, sizeof **out);
    if (!*out)
        return err_memory(err, "a panel", sizeof **out);
    (*out)->slot = 1;
    (*out)->outlines = true;
    return true;
}

void panel_destroy(struct panel *panel)
{
    if (!panel)
        return;
    free(panel->materials.rows);
    free(panel->lights.rows);
    free(panel->objects.rows);
    arena_finish(&panel->files_arena);
    free(panel);
}

// --- files, shaders, history, keys ---------------------------------------------------------------

static void files(struct panel *panel, const struct document *document, const struct stage *stage)
{
    struct gui *gui = panel->gui;
    gui_group_begin(gui, "files", "Files", "Saves pictures and scenes.", false);
    gui_switch(gui, "files.with_panel", "With panel",
               "Includes the panel in screenshots; off: only the picture.", &panel->saves_panel);
    if (gui_button(gui, "files.screenshot", "Screenshot (F12)",
                   "Writes the displayed picture as a PNG into the working directory."))
        save_png(panel->viewer, NULL, panel->saves_panel);
    gui_enabled(gui, stage->shown.denoise);
    gui_switch(gui, "files.denoised", "Denoised",
               "Writes the denoised preview into EXRs; off: the film as rendered.",
               &panel->saves_denoised);
    gui_enabled(gui, document->has_scene);
    if (gui_button(gui, "files.exr", "EXR (F11)",
                   "Writes the selected side's film with all metadata into the working directory."))
        save_exr(panel->viewer, stage->edited_side, NULL,
                 panel->saves_denoised && stage->shown.denoise);
    gui_text(gui, "files.scene_path", "Scene file",
             "The file that \"Save scene\" writes; its name must end in .json.", panel->save_path,
             sizeof panel->save_path);
    gui_enabled(gui, document->has_scene && panel->save_path[0]);
    if (gui_button(gui, "files.save_scene", "Save scene",
                   "Writes the edits as a scene file that names the original as its base."))
        save_scene(panel->viewer, panel->save_path);
    gui_group_end(gui);
}

static void shaders(struct panel *panel, const struct shell *shell)
{
    struct gui *gui = panel->gui;
    const char *why_not = NULL;
    bool can = reload_can_compile(shell->reload, &why_not);
    gui_group_begin(gui, "shaders", "Shaders", "Recompiles kernels from their sources.", false);
    gui_enabled(gui, can);
    if (gui_button(gui, "shaders.reload", "Reload (F5)",
                   "Recompiles all kernels; if one fails, the old kernels remain in use."))
        reload_shaders(panel->viewer);
    if (gui_is_drawn(gui)) {
        if (can)
            gui_line(gui, "%s", reload_folder(shell->reload));
        else
            gui_warning(gui, "%s", why_not ? why_not : "not available");
        const char *errors = reload_errors(shell->reload);
        if (errors[0])
            gui_warning(gui, "%s", errors);
    }
    gui_group_end(gui);
}

static void history(struct panel *panel)
{
    struct gui *gui = panel->gui;
    gui_group_begin(gui, "history", "History", "Undoes and redoes changes.", false);
    gui_enabled(gui, edit_undo_count(panel->viewer) > 0);
    if (gui_button(gui, "history.undo", "Undo (Ctrl+Z)", "Undoes the last change."))
        edit_undo(panel->viewer);
    gui_same_line(gui);
    gui_enabled(gui, edit_redo_count(panel->viewer) > 0);
    if (gui_button(gui, "history.redo", "Redo (Ctrl+Y)", "Redoes the change that was undone last."))
        edit_redo(panel->viewer);
    if (gui_is_drawn(gui)) {
        const char *name = edit_undo_name(panel->viewer);
        gui_fact(gui, "Changes", "%u%s%s", edit_undo_count(panel->viewer),
                 name ? ", the last: " : "", name ? name : "");
    }
    gui_group_end(gui);
}

static void keys(struct panel *panel)
{
    struct gui *gui = panel->gui;
    gui_group_begin(gui, "keys", "Keys", "Shows the functions of keys and mouse over the picture.",
                    false);
    for (const struct key_help *key = viewer_keys; gui_is_drawn(gui) && key->keys; key++)
        gui_pair(gui, key->keys, "%s", key->help);
    gui_group_end(gui);
}

// In the first frame, reads the list of recent scenes, and opens its tab if no scene is open.
static void begin(struct panel *panel, const struct document *document)
{
    if (panel->has_begun)
        return;
    panel->has_begun = true;
    panel_recent_read(panel);
    if (!document->has_scene)
        gui_open_tab(panel->gui, TAB_SCENE);
}

void panel_draw(struct viewer *viewer)
{
    struct document *document = &viewer->document;
    struct stage *stage = &viewer->stage;
    struct shell *shell = &viewer->shell;
    struct gui *gui = &shell->gui;
    struct panel *panel = shell->panel;
    panel->viewer = viewer;
    panel->gui = gui;
    panel->window = &shell->window;
    panel->frame_arena = &shell->frame_arena;
    gui->is_hidden = !shell->is_panel_shown;
    begin(panel, document);
    char facts[VIEWER_HEADER_MAX] = "";
    if (document->has_scene)
        viewer_header(viewer, facts);
    gui_panel_begin(gui, "Lampyris", facts, tabs);
    gui_tab_begin(gui, TAB_RENDER);
    panel_view(panel, stage, &viewer->view);
    panel_renderer(panel, document, stage);
    files(panel, document, stage);
    history(panel);
    shaders(panel, shell);
    keys(panel);
    gui_tab_end(gui);
    gui_tab_begin(gui, TAB_SCENE);
    panel_scene(panel, document);
    gui_tab_end(gui);
    gui_tab_begin(gui, TAB_OBJECT);
    panel_objects(panel, document);
    gui_tab_end(gui);
    gui_tab_begin(gui, TAB_CAMERA);
    panel_camera(panel, document, &viewer->view);
    gui_tab_end(gui);
    gui_tab_begin(gui, TAB_MEASURE);
    panel_statistics(panel, document, stage);
    gui_tab_end(gui);
    gui_panel_end(gui);
    panel_overlay(panel, document, stage, &viewer->view, shell);
    assert(!gui_duplicate(gui)); // checks the last frame
}
