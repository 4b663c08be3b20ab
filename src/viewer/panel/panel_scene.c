// The scene's file, its environment, its objects, and the surface that was clicked.
#include "viewer/panel/panel_internal.h"

#include "base/file.h"
#include "base/file_system.h"
#include "viewer/core/load.h"
#include "viewer/core/messages.h"
#include "viewer/core/recent.h"
#include "viewer/core/watch.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// --- files ---------------------------------------------------------------------------------------

static bool is_scene_name(const char *name)
{
    static const char *const extensions[] = {"json", "gltf", "glb", "obj", "ply", "stl"};
    for (size_t i = 0; i < sizeof extensions / sizeof *extensions; i++)
        if (path_has_extension(name, extensions[i]))
            return true;
    return false;
}

static int by_name(const void *a, const void *b)
{
    return strcmp(*(const char *const *)a, *(const char *const *)b);
}

// Lists the scenes in a folder into panel->files. The list is empty when out of memory, or if the
// folder cannot be read.
static void list_folder(struct panel *panel)
{
    struct arena *arena = &panel->files_arena;
    uint32_t capacity = 0;
    arena_finish(arena);
    panel->file_count = 0;
    panel->files = NULL;
    const char *path = path_folder(arena, panel->scene_path);
    struct folder_reader *folder = path ? folder_open(path) : NULL;
    for (const char *name; folder && (name = folder_next(folder));) {
        if (name[0] == '.' || !is_scene_name(name))
            continue;
        const char **files = arena_reserve(arena, panel->files, panel->file_count, 1, &capacity,
                                           sizeof *panel->files);
        const char *file = arena_printf(arena, "%s/%s", path, name);
        if (!files || !file)
            break;
        panel->files = files;
        panel->files[panel->file_count++] = file;
    }
    folder_close(folder);
    if (panel->file_count > 0)
        qsort(panel->files, panel->file_count, sizeof *panel->files, by_name);
}

// Reads the list of recent scenes. A viewer without a window keeps its list to itself.
void panel_recent_read(struct panel *panel)
{
    struct err err = {0};
    panel->keeps_recent = panel->window->handle != NULL;
    if (panel->keeps_recent && !recent_read(&panel->recent, &err))
        viewer_message(panel->viewer, MESSAGE_WARNING,
                       "The list of recent scenes is ignored: %.700s. It will be replaced.",
                       err.msg);
}

// Adds a path to the recent scenes. Other viewers may have changed the file meanwhile, so that it
// is read again.
static void remember(struct panel *panel, const char *path)
{
    struct recent newer;
    struct err err = {0}, ignored = {0};
    if (panel->keeps_recent && recent_read(&newer, &ignored) && newer.count > 0)
        panel->recent = newer;
    recent_add(&panel->recent, path);
    if (!panel->keeps_recent || recent_write(&panel->recent, &err))
        return;
    panel->keeps_recent = false;
    viewer_message(panel->viewer, MESSAGE_WARNING, "The list of recent scenes is not kept: %.700s",
                   err.msg);
}

static void notice_scene(struct panel *panel, const struct document *document)
{
    if (!document->has_scene || strcmp(panel->scene_path, document->scene_path) == 0)
        return;
    snprintf(panel->scene_path, sizeof panel->scene_path, "%s", document->scene_path);
    snprintf(panel->open_path, sizeof panel->open_path, "%s", document->scene_path);
    const char *name = path_name(document->scene_path), *extension = path_extension(name);
    int stem = (int)(strlen(name) - strlen(extension) - (extension[0] ? 1 : 0));
    snprintf(panel->save_path, sizeof panel->save_path, "%.*s-edited.json", stem, name);
    remember(panel, panel->scene_path);
    list_folder(panel);
}

static void file_rows(struct panel *panel)
{
    struct gui *gui = panel->gui;
    struct gui_list list = {.count = panel->file_count, .chosen = UINT32_MAX, .height = 6};
    const char *wanted = NULL;
    gui_list_begin(gui, "scene.file", &list);
    for (uint32_t row; gui_list_next(gui, &list, &row);) {
        char id[GUI_ID_MAX];
        snprintf(id, sizeof id, "scene.file.%u", row);
        bool is_this = strcmp(panel->files[row], panel->scene_path) == 0;
        if (gui_row(gui, id, path_name(panel->files[row]),
                    "Opens this scene, which is in the same folder.", is_this) &&
            !is_this)
            wanted = panel->files[row];
    }
    gui_list_end(gui, &list);
    if (wanted)
        viewer_open_scene(panel->viewer, wanted, false);
}

// Lists the scenes that were opened last, but not the one that is open.
static void recent_rows(struct panel *panel, bool has_scene)
{
    struct gui *gui = panel->gui;
    gui_group_begin(gui, "scene.recent", "Recent scenes",
                    "The scenes that were opened last, the newest first.", true);
    for (uint32_t i = has_scene; i < panel->recent.count; i++) {
        const char *path = panel->recent.paths[i];
        char id[GUI_ID_MAX], label[GUI_LABEL_MAX];
        int name = (int)(path_name(path) - path);
        snprintf(id, sizeof id, "scene.recent.%u", i);
        // The name comes first, because long lines are cut off.
        snprintf(label, sizeof label, "%s   %.*s", path + name, name, path);
        if (gui_row(gui, id, label, "Opens this scene again.", false))
            viewer_open_scene(panel->viewer, path, false);
    }
    gui_group_end(gui);
}

static void file(struct panel *panel, const struct document *document)
{
    struct gui *gui = panel->gui;
    bool watches = viewer_watches(panel->viewer);
    notice_scene(panel, document);
    if (gui_text(gui, "scene.path", "Path", "Path of a scene or model; Enter opens it.",
                 panel->open_path, sizeof panel->open_path))
        viewer_open_scene(panel->viewer, panel->open_path, false);
    gui_enabled(gui, document->has_scene);
    if (gui_button(gui, "scene.reload", "Reload",
                   "Reads the scene's file again and keeps the view."))
        viewer_open_scene(panel->viewer, panel->scene_path, true);
    gui_same_line(gui);
    if (gui_switch(gui, "scene.watch", "Watch", "Reloads the scene when its file changes.",
                   &watches))
        viewer_watch(panel->viewer, watches);
    gui_enabled(gui, true);
    file_rows(panel);
    recent_rows(panel, document->has_scene);
}

// --- the environment -----------------------------------------------------------------------------

static void sky(struct gui *gui, struct surroundings *to)
{
    static const struct gui_range turbidity = {SKY_TURBIDITY_MIN, SKY_TURBIDITY_MAX};
    static const struct gui_range elevation = {0, 90, .unit = "°"};
    gui_applies(gui, to->kind == SURROUNDINGS_SKY);
    gui_number(gui, "surroundings.turbidity", "Turbidity", "Turbidity: the haziness of the sky.",
               &turbidity, &to->turbidity);
    gui_number(gui, "surroundings.elevation", "Sun height",
               "Elevation above the horizon, in degrees.", &elevation, &to->elevation_degrees);
    gui_number(gui, "surroundings.azimuth", "Sun direction",
               "Azimuth from +X towards +Z, in degrees.", &panel_turn, &to->azimuth_degrees);
    gui_flag(gui, "surroundings.sun", "Sun", "Adds the disc of the sun to the sky.", &to->has_sun);
}

void panel_surroundings(struct panel *panel, const struct document *document)
{
    static const struct gui_range turn = {-SCENE_TURN_MAX, SCENE_TURN_MAX, .unit = "°",
                                          .drag = 180};
    struct gui *gui = panel->gui;
    gui_group_begin(gui, "surroundings", "Surroundings", "The light from infinitely far away.",
                    true);
    struct surroundings to = document->surroundings;
    gui->used = NULL;
    // An image can be selected only after its path has been entered.
    bool has_image = to.image[0] != '\0';
    uint32_t kind = to.kind;
    if (gui_choice(
            gui, "surroundings.kind", "Kind",
            "The environment: that of the file, black, one colour, a clear sky, or an image.",
            surroundings_names, &kind)) {
        if (kind == SURROUNDINGS_IMAGE && !has_image)
            viewer_message(panel->viewer, MESSAGE_WARNING,
                           "Enter the path of an image below first.");
        else
            to.kind = kind;
        gui->used = to.kind == kind ? gui->used : NULL;
    }
    const struct environment *around = &document->scene.environment;
    bool is_lit = to.kind != SURROUNDINGS_NONE && around->present;
    gui_enabled(gui, is_lit);
    gui_number(gui, "surroundings.strength", "Strength",
               "Factor for the radiance of the environment.", &panel_radiance, &to.strength);
    gui_enabled(gui, is_lit && around->width > 0); // rotating a constant environment has no effect
    gui_number(gui, "surroundings.rotation", "Rotation",
               "Rotation about +Y in degrees, added to that of the file.", &turn,
               &to.rotation_degrees);
    gui_applies(gui, to.kind == SURROUNDINGS_CONSTANT);
    gui_color(gui, "surroundings.color", "Radiance",
              "Constant radiance from all directions, W/(sr m^2).", &panel_radiance, to.radiance);
    sky(gui, &to);
    gui_enabled(gui, true);
    if (gui_text(gui, "surroundings.image", "Image",
                 "Path of an image in latitude and longitude (.hdr, .exr, …); Enter uses it.",
                 to.image, sizeof to.image)) {
        // Unused bytes are 0, because states are compared byte by byte.
        size_t length = strlen(to.image);
        memset(to.image + length, 0, sizeof to.image - length);
        to.kind = length ? SURROUNDINGS_IMAGE : SURROUNDINGS_ORIGINAL;
    }
    if (gui->used)
        edit_surroundings(panel->viewer, &to, gui->used);
    gui_group_end(gui);
}

// --- objects -------------------------------------------------------------------------------------

struct object_rows {
    struct panel *panel;
    const struct document *document;
};

static void object_name(void *context, uint32_t row, char out[PANEL_NAME_MAX])
{
    static const char *const kinds[SHAPE_KIND_COUNT] = {
        [SHAPE_SPHERE] = "sphere", [SHAPE_DISC] = "disc",         [SHAPE_PLANE] = "plane",
        [SHAPE_QUAD] = "quad",     [SHAPE_BOX] = "box",           [SHAPE_CYLINDER] = "cylinder",
        [SHAPE_TUBE] = "tube",     [SHAPE_SDF] = "distance field"};
    const struct object_rows *rows = context;
    const struct scene *scene = &rows->document->scene;
    if (row < scene->instance_count) {
        const char *name = scene->meshes[scene->instances[row].mesh].name;
        snprintf(out, PANEL_NAME_MAX, "%u %.140s", row, name && name[0] ? name : "mesh");
    } else {
        snprintf(out, PANEL_NAME_MAX, "%u %s", row,
                 kinds[scene->shapes[row - scene->instance_count].kind]);
    }
}

static bool is_visible(const struct scene *scene, uint32_t object)
{
    return object < scene->instance_count ? !scene->instances[object].hidden
                                          : !scene->shapes[object - scene->instance_count].hidden;
}

static void object_switch(void *context, uint32_t row)
{
    const struct object_rows *rows = context;
    struct panel *panel = rows->panel;
    char id[GUI_ID_MAX];
    bool visible = is_visible(&rows->document->scene, row);
    snprintf(id, sizeof id, "object.%u.visible", row);
    if (gui_switch(panel->gui, id, "", "Off: the object is removed from the scene.", &visible))
        edit_visible(panel->viewer, row, visible, id);
    gui_same_line(panel->gui);
}

static void objects(struct panel *panel, struct document *document)
{
    struct gui *gui = panel->gui;
    const struct scene *scene = &document->scene;
    gui_group_begin(gui, "objects", "Objects",
                    "The objects of the scene, and which of them are visible.", true);
    const struct panel_list list = {
        .id = "object",
        .help = "Selects the object, as does a click on it in the picture.",
        .count = scene->instance_count + scene->shape_count,
        .height = 8,
        .name = object_name,
        .before = object_switch,
        .context = &(struct object_rows){panel, document},
        .of = scene->instances ? (const void *)scene->instances : scene->shapes,
    };
    if (panel_list(panel, &panel->objects, &list, &document->chosen_object))
        document->has_choice = true;
    gui_switch(gui, "objects.outline", "Outline",
               "Outlines the selected object in the window, but not in saved pictures.",
               &panel->outlines);
    panel_place(panel, document);
    gui_group_end(gui);
}

// --- animation -----------------------------------------------------------------------------------

static void animation(struct panel *panel, struct document *document)
{
    static const struct gui_range speed = {-100, 100};
    struct gui *gui = panel->gui;
    struct pose *pose = &document->pose;
    struct scene_pose to = pose->wanted;
    double length = document->scene.animation_seconds;
    const struct gui_range seconds = {0, length > 0 ? length : 1e6, .unit = "s"};
    gui_group_begin(gui, "animation", "Animation", "The animation of a glTF file.", true);
    if (!pose_has_animation(panel->viewer))
        gui_line(gui, "This scene has none.");
    gui_applies(gui, pose_has_animation(panel->viewer));
    gui_switch(gui, "animation.plays", "Play", "Plays the animation repeatedly.", &pose->plays);
    if (gui_number(gui, "animation.time", "Time",
                   "Time of the displayed pose in seconds, as for --at.", &seconds, &to.seconds)) {
        to.is_posed = 1;
        edit_pose(panel->viewer, &to, "animation.time");
    }
    gui_number(gui, "animation.speed", "Speed", "Speed: seconds of the animation per second.",
               &speed, &pose->speed);
    gui_enabled(gui, true);
    gui_group_end(gui);
}

// --- the surface that was clicked ----------------------------------------------------------------

static uint32_t object_count(const struct scene *scene)
{
    return scene->instance_count + scene->shape_count;
}

static void picked(struct panel *panel, struct document *document)
{
    struct gui *gui = panel->gui;
    const struct picked *picked = &document->picked;
    bool has_object = picked->is_some && picked->object < object_count(&document->scene);
    bool has_material = picked->is_some && picked->material < document->scene.material_count;
    gui_group_begin(gui, "picked", "Picked", "The surface that was clicked in the picture.", true);
    if (gui_is_drawn(gui)) {
        char name[PANEL_NAME_MAX] = "none: environment";
        if (has_object)
            object_name(&(struct object_rows){panel, document}, picked->object, name);
        if (!picked->is_some)
            gui_line(gui, "Click on a surface in the picture.");
        else
            gui_pair(gui, "Object", "%s", name);
        if (has_material)
            gui_pair(gui, "Material", "%u %s", picked->material,
                     document->scene.materials[picked->material].name);
        if (has_object)
            gui_pair(gui, "Position", "%.4g, %.4g, %.4g m", picked->position[0],
                     picked->position[1], picked->position[2]);
        if (has_object)
            gui_pair(gui, "Distance", "%.4g m", picked->distance);
    }
    gui_enabled(gui, has_material);
    if (gui_button(
            gui, "picked.edit_material", "Edit material",
            "Selects the material of the surface that was clicked, and shows its parameters.")) {
        document->chosen_material = picked->material;
        gui_reveal(gui, "material.model");
    }
    gui_same_line(gui);
    gui_enabled(gui, has_object);
    if (gui_button(gui, "picked.hide", "Hide", "Hides the object that was clicked."))
        edit_visible(panel->viewer, picked->object, false, "picked.hide");
    gui_group_end(gui);
}

void panel_scene(struct panel *panel, struct document *document)
{
    struct gui *gui = panel->gui;
    gui_group_begin(gui, "scene", "Scene", "The scene that is rendered.", true);
    file(panel, document);
    gui_group_end(gui);
    if (!document->has_scene)
        return;
    panel_surroundings(panel, document);
    panel_lights(panel, document);
    animation(panel, document);
}

void panel_objects(struct panel *panel, struct document *document)
{
    if (!document->has_scene) {
        gui_line(panel->gui, "No scene is open.");
        return;
    }
    picked(panel, document);
    objects(panel, document);
    panel_materials(panel, document);
}
