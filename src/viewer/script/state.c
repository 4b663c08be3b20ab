#include "viewer/script/state.h"

#include "base/hash.h"
#include "base/memory.h"
#include "cli/error_sources_out.h"
#include "render/parts.h"
#include "viewer/core/frame.h"
#include "viewer/core/messages.h"
#include "viewer/core/reload.h"
#include "viewer/core/report.h"
#include "viewer/core/viewer.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static json_t *vector_json(const double v[3])
{
    return json_pack("[o, o, o]", json_number(v[0]), json_number(v[1]), json_number(v[2]));
}

static json_t *camera_json(const struct camera *c)
{
    const double degrees = 180.0 / M_PI;
    return json_pack("{s:s, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:i, s:o}", "kind",
                     camera_names[c->kind], "position", vector_json(c->position), "direction",
                     vector_json(c->direction), "up", vector_json(c->up), "fov_degrees",
                     json_number(c->fov_y * degrees), "height", json_number(c->height),
                     "lens_radius_mm", json_number(c->lens_radius * 1e3), "focus_distance",
                     json_number(c->focus_distance), "lens_blades", (int)c->lens_blades,
                     "lens_rotation_degrees", json_number(c->lens_rotation * degrees));
}

// --- controls ------------------------------------------------------------------------------------

static json_t *item_json(const struct gui_item *item)
{
    static const char *const kinds[] = {
        [GUI_GROUP] = "group",   [GUI_BUTTON] = "button", [GUI_SWITCH] = "switch",
        [GUI_NUMBER] = "number", [GUI_CHOICE] = "choice", [GUI_COLOR] = "color",
        [GUI_VECTOR] = "vector", [GUI_TEXT] = "text",     [GUI_ROW] = "row",
        [GUI_TAB] = "tab",
    };
    char help[GUI_HELP_MAX];
    gui_item_help(item, help);
    return json_pack("{s:o, s:s, s:o, s:o, s:o, s:b, s:b}", "id", json_words(item->id), "kind",
                     kinds[item->kind], "value", json_words(item->value), "label",
                     json_words(item->label), "help", json_words(help), "enabled", item->is_enabled,
                     "shown", item->is_shown);
}

static json_t *items_json(const struct gui *gui)
{
    json_t *array = json_array();
    for (uint32_t i = 0; i < gui->item_count; i++)
        json_array_append_new(array, item_json(&gui->items[i]));
    return array;
}

// --- images --------------------------------------------------------------------------------------

static void list_kept(void *context, const struct part *part)
{
    char text[128];
    snprintf(text, sizeof text, "%s:%s", part_kind_name(part->kind), part->name);
    if (part->is_kept)
        json_array_append_new(context, json_string(text));
}

static json_t *side_json(const struct view *view)
{
    const struct job_look look = view_newest_look(view);
    json_t *kept = json_array();
    if (view->is_ready)
        parts_visit(&view->job.renderer, list_kept, kept);
    const struct renderer *r = &view->job.renderer;
    return json_pack("{s:b, s:i, s:i, s:I, s:o, s:o, s:o, s:i, s:i, s:b, s:o, s:o}", "ready",
                     view->is_ready, "width", r->frame.width, "height", r->frame.height, "samples",
                     (json_int_t)(view->is_ready ? view_samples(view) : 0), "local_relmse",
                     json_number(look.error.local_relmse), "at_most",
                     json_number(look.error.at_most), "error_samples",
                     json_number(view->look_count > 0 ? look.samples : NAN), "wave",
                     r->plan.wave_slots, "workgroup", r->specialization.workgroup, "denoised",
                     view->denoiser.gpu != NULL, "kept", kept, "error_by",
                     error_sources_json(&view->sources, NULL));
}

static json_t *sides_json(const struct viewer *viewer)
{
    json_t *array = json_array();
    for (uint32_t i = 0; i < viewer->stage.side_count; i++)
        json_array_append_new(array, side_json(&viewer->stage.sides[i]));
    return array;
}

static json_t *picked_json(const struct picked *picked)
{
    bool is_object = picked->is_some && picked->object != VIEWER_NO_OBJECT;
    if (!is_object)
        return picked->is_some ? json_string("surroundings") : json_null();
    return json_pack("{s:i, s:i, s:o, s:o}", "object", picked->object, "material", picked->material,
                     "position", vector_json(picked->position), "distance",
                     json_number(picked->distance));
}

// --- the whole state -----------------------------------------------------------------------------

static json_t *counts_json(const struct viewer *viewer)
{
    const struct scene *s = &viewer->document.scene;
    return json_pack("{s:i, s:i, s:i, s:i, s:i, s:i, s:i, s:i}", "undo", edit_undo_count(viewer),
                     "redo", edit_redo_count(viewer), "cameras", s->camera_count, "materials",
                     s->material_count, "lights", s->light_count, "objects",
                     s->instance_count + s->shape_count, "recoveries", viewer->stage.recoveries,
                     "validation_messages", viewer->stage.gpu.validation_messages);
}

static json_t *kernels_json(const struct viewer *viewer)
{
    json_t *object = json_object();
    for (int id = 0; id < KERNEL_COUNT; id++)
        json_object_set_new(object, kernel_code((enum kernel_id)id, true).name,
                            json_number(viewer->stage.stats.kernel_ms[id]));
    return object;
}

static json_t *times_json(const struct viewer *viewer)
{
    const struct frame_stats *s = &viewer->stage.stats;
    const struct view *view = &viewer->stage.sides[viewer->stage.edited_side];
    char header[VIEWER_HEADER_MAX];
    viewer_header(viewer, header);
    return json_pack(
        "{s:b, s:s, s:I, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:I, s:I, s:o, s:I, s:b, "
        "s:o}",
        "rebuilding", rebuild_is_pending(viewer), "header", header, "frames", (json_int_t)s->frames,
        "seconds", json_number(viewer_seconds(viewer)), "fps", json_number(s->fps), "frame_ms",
        json_number(s->frame_ms), "render_ms", json_number(s->render_ms), "denoise_ms",
        json_number(s->denoise_ms), "display_ms", json_number(s->display_ms), "panel_ms",
        json_number(s->panel_ms), "present_ms", json_number(s->present_ms), "render_seconds",
        json_number(view->seconds), "swapchains", (json_int_t)viewer->stage.swapchain.recreated,
        "shrink", (json_int_t)viewer->view.pace.shrink, "resident_bytes",
        json_number((double)memory_resident()), "device_bytes",
        (json_int_t)viewer->stage.gpu.allocated_bytes, "working",
        !worker_is_idle(viewer->shell.worker), "kernel_ms", kernels_json(viewer));
}

static json_t *window_json(const struct viewer *viewer)
{
    static const char *const modes[] = {"immediate", "mailbox", "fifo", "fifo_relaxed"};
    uint32_t mode = (uint32_t)viewer->stage.swapchain.present_mode;
    bool has_mode = viewer->stage.swapchain.handle != VK_NULL_HANDLE && mode < 4;
    const float *panel = viewer->shell.gui.place;
    uint32_t place[4];
    viewer_picture_place(viewer, place);
    return json_pack("{s:[f, f, f, f], s:i, s:i, s:b, s:b, s:b, s:s, s:[i, i, i, i]}",
                     "panel_place", (double)panel[0], (double)panel[1], (double)panel[2],
                     (double)panel[3], "width", viewer->shell.window.width, "height",
                     viewer->shell.window.height, "minimised", viewer->shell.window.is_minimised,
                     "headless", viewer->shell.window.handle == NULL, "panel",
                     viewer->shell.is_panel_shown, "present_mode", has_mode ? modes[mode] : "none",
                     "picture", place[0], place[1], place[2], place[3]);
}

static json_t *camera_rig_json(const struct camera_rig *rig)
{
    return json_pack("{s:s, s:o, s:o, s:b, s:o}", "mode", camera_rig_mode_names[rig->mode],
                     "target", vector_json(rig->target), "speed", json_number(rig->speed),
                     "revolves", rig->revolves, "revolve_speed", json_number(rig->revolve_speed));
}

static json_t *views_json(const struct viewer *viewer)
{
    json_t *array = json_array();
    for (uint32_t i = 0; i < VIEWER_SAVED_VIEWS; i++)
        json_array_append_new(array, viewer->view.saved[i].is_used
                                         ? camera_json(&viewer->view.saved[i].camera)
                                         : json_null());
    return array;
}

json_t *state_json(const struct viewer *viewer)
{
    static const char *const kinds[] = {"note", "warning", "error"};
    return json_pack(
        "{s:o, s:b, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:{s:s, s:o}, s:o, s:b, s:b, s:o, s:o, s:o}",
        "scene", json_words(viewer->document.scene_path), "has_scene", viewer->document.has_scene,
        "window", window_json(viewer), "camera", camera_json(&viewer->view.camera), "rig",
        camera_rig_json(&viewer->view.rig), "views", views_json(viewer), "sides",
        sides_json(viewer), "picked", picked_json(&viewer->document.picked), "counts",
        counts_json(viewer), "message", "kind", kinds[viewer->shell.message_kind], "text",
        json_words(viewer->shell.message), "target_ms", json_number(viewer->view.pace.target_ms),
        "paused", viewer->stage.is_paused, "watching", viewer->shell.watch != NULL, "times",
        times_json(viewer), "shader_errors",
        json_words(viewer->shell.reload ? reload_errors(viewer->shell.reload) : ""), "items",
        items_json(&viewer->shell.gui));
}

// --- finding values ------------------------------------------------------------------------------

static const json_t *find_item(const json_t *state, const char *id, const char *what)
{
    const json_t *items = json_object_get(state, "items");
    for (size_t i = 0; i < json_array_size(items); i++) {
        const json_t *item = json_array_get(items, i);
        const char *name = json_string_value(json_object_get(item, "id"));
        if (name && strcmp(name, id) == 0)
            return json_object_get(item, what);
    }
    return NULL;
}

const json_t *state_find(const json_t *state, const char *key)
{
    static const char item[] = "item.", enabled[] = "enabled.";
    if (strncmp(key, item, sizeof item - 1) == 0)
        return find_item(state, key + sizeof item - 1, "value");
    if (strncmp(key, enabled, sizeof enabled - 1) == 0)
        return find_item(state, key + sizeof enabled - 1, "enabled");
    const json_t *at = state;
    while (at && *key) {
        char word[64];
        size_t length = strcspn(key, ".");
        snprintf(word, sizeof word, "%.*s", (int)length, key);
        at = json_is_array(at) ? json_array_get(at, strtoul(word, NULL, 10))
                               : json_object_get(at, word);
        key += length + (key[length] == '.');
    }
    return at;
}

bool state_hash_picture(struct viewer *viewer, uint64_t *hash, struct err *err)
{
    const struct gpu_screen *screen = &viewer->stage.screen;
    uint64_t bytes = (uint64_t)screen->width * screen->height * 4;
    *hash = HASH_INIT;
    if (bytes == 0 || viewer->stage.display.pixels.bytes < bytes)
        return true; // no image has been displayed yet
    uint8_t *pixels = malloc(bytes);
    if (!pixels)
        return err_memory(err, "the picture", bytes);
    bool ok =
        gpu_download(&viewer->stage.gpu, &viewer->stage.display.pixels, 0, pixels, bytes, err);
    if (ok)
        *hash = hash_bytes(*hash, pixels, bytes);
    free(pixels);
    return ok;
}
