// Draws over the image: messages, the labels of the split view's sides, and the list of keys.
#include "viewer/panel/panel_internal.h"

#include "base/false_color.h"
#include "image/image.h"
#include "job/film_error.h"
#include "viewer/core/frame.h"
#include "viewer/core/messages.h"
#include "viewer/core/outline.h"
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#define MARGIN 8.0f
#define ROWS_MAX 64

static double message_lasts(enum message_kind kind)
{
    static const double seconds[] = {
        [MESSAGE_NOTE] = 4.0, [MESSAGE_WARNING] = 8.0, [MESSAGE_ERROR] = 15.0};
    return seconds[kind];
}

// Returns the x coordinate of the left end of the space beside the panel.
static float free_x(struct panel *panel)
{
    return panel->gui->width + MARGIN * panel->window->scale;
}

// Writes those settings of the second side that differ from the first side's, such as ", sampler
// pcg, mis none", as far as they fit.
static void write_difference(const struct stage *stage, char *out, size_t size)
{
    const struct settings *a = &stage->sides[0].method.settings;
    const struct settings *b = &stage->sides[1].method.settings;
    size_t used = 0;
    *out = '\0';
    for (int i = 0; i < SETTING_TOTAL && used < size; i++) {
        const struct field *field = &settings_table[i].field;
        char value[FIELD_TEXT_MAX];
        if (field_same(field, a, b))
            continue;
        field_text(field, b, value);
        used += (size_t)snprintf(out + used, size - used, ", %s %s", field->key, value);
    }
}

static void side_note(struct panel *panel, const struct stage *stage, uint32_t side, float x,
                      float y)
{
    const struct view *view = &stage->sides[side];
    unsigned long long samples = (unsigned long long)view_samples(view);
    const struct half_error error = view_newest_look(view).error;
    char other[64] = "";
    if (side > 0)
        write_difference(stage, other, sizeof other);
    if (error.known)
        gui_note(panel->gui, x, y, false, "%c  local relMSE %.2g (%.2g to %.2g), %llu samples%s",
                 'A' + (int)side, error.local_relmse, error.ci_low, error.ci_high, samples, other);
    else if (error.bounded)
        gui_note(panel->gui, x, y, false, "%c  local relMSE at most %.2g, %llu samples%s",
                 'A' + (int)side, error.at_most, samples, other);
    else if (film_error_is_plain(&error))
        gui_note(panel->gui, x, y, false, "%c  local relMSE about %.2g, %llu samples%s",
                 'A' + (int)side, error.local_relmse, samples, other);
    else
        gui_note(panel->gui, x, y, false, "%c  %llu samples%s", 'A' + (int)side, samples, other);
}

// Draws the labels of both sides. One is drawn below the other if the dividing line leaves no space
// for both.
static float sides(struct panel *panel, const struct stage *stage, float y)
{
    float line = 22.0f * panel->window->scale;
    float left = free_x(panel);
    float right = (float)viewer_split_x(panel->viewer) + MARGIN * panel->window->scale;
    side_note(panel, stage, 0, left, y);
    // 330 points is the width of a line of about forty letters.
    if (right < left + 330.0f * panel->window->scale) {
        side_note(panel, stage, 1, fmaxf(right, left), y + line);
        return y + 2.0f * line;
    }
    side_note(panel, stage, 1, fminf(right, (float)panel->window->width - 100.0f), y);
    return y + line;
}

static void keys(struct panel *panel)
{
    struct gui_pair rows[ROWS_MAX];
    uint32_t count = 0;
    while (count < ROWS_MAX && viewer_keys[count].keys) {
        rows[count] = (struct gui_pair){viewer_keys[count].keys, viewer_keys[count].help};
        count++;
    }
    gui_table(panel->gui, rows, count);
}

static uint32_t encoded(double linear)
{
    return image_quantize(image_srgb_from_linear(fminf(fmaxf((float)linear, 0.0f), 1.0f)));
}

// Draws the legend of false colours, with the values at both ends and in the centre of the range.
static void legend(struct panel *panel, const struct document *document, const struct stage *stage)
{
    enum { COLORS = 33 };
    uint32_t colors[COLORS];
    const double *range = stage->display.range;
    const uint32_t what = stage->shown.what;
    if (!document->has_scene || !shown_has_range(what) || !(range[1] > range[0]))
        return;
    for (uint32_t i = 0; i < COLORS; i++) {
        double rgb[3];
        false_color((double)i / (COLORS - 1), rgb);
        colors[i] = encoded(rgb[0]) | encoded(rgb[1]) << 8 | encoded(rgb[2]) << 16 | 0xff000000u;
    }
    double middle = 0.5 * (range[0] + range[1]);
    if (shown_is_logarithmic(what)) // 0 stands for values close to it
        middle = sqrt(fmax(range[0], (double)FLT_MIN) * range[1]);
    char texts[3][64];
    snprintf(texts[0], sizeof texts[0], "%.3g", range[0]);
    snprintf(texts[1], sizeof texts[1], "%.3g", middle);
    snprintf(texts[2], sizeof texts[2], "%.3g %s", range[1], shown_unit(what));
    gui_legend(panel->gui, colors, COLORS, (const char *const[3]){texts[0], texts[1], texts[2]});
}

// --- the selected object -------------------------------------------------------------------------

// Returns the bounds of an object's mesh, which are computed only when it changes.
static const struct bounds *bounds_of(struct panel *panel, const struct document *document,
                                      uint32_t object)
{
    const struct scene *scene = &document->scene;
    struct panel_bounds *known = &panel->bounds;
    if (object >= scene->instance_count)
        return &BOUNDS_EMPTY;
    const struct panel_bounds wanted = {.hash = scene->hash,
                                        .mesh = scene->instances[object].mesh,
                                        .deformations = document->pose.deformations};
    if (known->hash != wanted.hash || known->mesh != wanted.mesh ||
        known->deformations != wanted.deformations) {
        *known = wanted;
        known->bounds = outline_mesh_bounds(&scene->meshes[wanted.mesh]);
    }
    return &known->bounds;
}

static bool is_hidden(const struct scene *scene, uint32_t object)
{
    return object < scene->instance_count ? scene->instances[object].hidden
                                          : scene->shapes[object - scene->instance_count].hidden;
}

static void outline(struct panel *panel, const struct document *document,
                    const struct viewpoint *view)
{
    const struct scene *scene = &document->scene;
    const uint32_t object = document->chosen_object;
    struct outline outline;
    uint32_t place[4];
    if (!document->has_scene || !panel->outlines || !document->has_choice ||
        panel->gui->is_hidden || object >= scene->instance_count + scene->shape_count ||
        is_hidden(scene, object))
        return;
    viewer_picture_place(panel->viewer, place);
    outline_of_object(scene, object, bounds_of(panel, document, object), &view->camera,
                      (double)place[2] / place[3], &outline);
    const double rect[4] = {place[0], place[1], (double)place[0] + place[2],
                            (double)place[1] + place[3]};
    for (uint32_t i = 0; i < outline.count; i++) {
        double ends[2][2];
        for (int end = 0; end < 2; end++)
            for (int c = 0; c < 2; c++)
                ends[end][c] = place[c] + outline.points[(i + (uint32_t)end) % outline.count][c] *
                                              place[2 + c];
        if (outline_clip(rect, ends[0], ends[1]))
            gui_stroke(panel->gui, ends[0], ends[1]);
    }
}

void panel_overlay(struct panel *panel, const struct document *document, const struct stage *stage,
                   const struct viewpoint *view, const struct shell *shell)
{
    struct gui *gui = panel->gui;
    float x = free_x(panel), y = MARGIN * panel->window->scale;
    double age = viewer_seconds(panel->viewer) - shell->message_seconds;
    outline(panel, document, view);
    if (document->has_scene && stage->side_count > 1)
        y = sides(panel, stage, y);
    if (!document->has_scene)
        y += gui_note(gui, x, y, false,
                      "No scene is open: drop a file here, or enter its path in the panel (F1).");
    if (stage->is_paused)
        y += gui_note(gui, x, y, false, "paused");
    if (shell->message[0] && age < message_lasts(shell->message_kind))
        gui_note(gui, x, y, shell->message_kind != MESSAGE_NOTE, "%s", shell->message);
    legend(panel, document, stage);
    if (view->keys.shows_help)
        keys(panel);
}
