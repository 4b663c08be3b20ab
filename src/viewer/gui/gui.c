// The panel: its creation, input, layout and conversion to triangles. Only the core of Dear ImGui
// is used; windows and devices are this program's own.
#include "viewer/gui/gui.h"

#include "base/file_system.h"
#include "viewer/gui/gui_state.h"
#include "viewer/gui/imgui_bridge.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// The size of the font in points. With it, about forty letters fit into a panel of 320 points.
#define FONT_POINTS 13.0f
#define PANEL_POINTS 340.0f
#define PANEL_PART 0.4f // greatest fraction of the window's width
#define HELP_LINES 3.0f

// --- creation and end ----------------------------------------------------------------------------

// Uses the distribution's font if it is installed, because it has the letters of most names;
// otherwise the font that is embedded in Dear ImGui.
static void add_font(float pixels)
{
    static const char *const paths[] = {
        "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf",
        "/usr/share/fonts/dejavu-sans-fonts/DejaVuSans.ttf",
        "/usr/share/fonts/TTF/DejaVuSans.ttf",
    };
    // The Unicode ranges of Latin, Greek, Cyrillic, dashes, quotation marks, arrows and some
    // mathematical symbols.
    static const uint16_t ranges[] = {0x20,   0x24f,  0x370,  0x3ff,  0x400,  0x45f,
                                      0x2010, 0x2026, 0x2070, 0x209c, 0x2190, 0x2193,
                                      0x2202, 0x2265, 0x25b4, 0x25c3, 0};
    for (size_t i = 0; i < sizeof paths / sizeof *paths; i++)
        if (file_is_regular(paths[i]) && im_font(paths[i], pixels, ranges))
            return;
    im_font(NULL, pixels, NULL);
}

bool gui_create(float scale, struct gui *out, struct err *err)
{
    memset(out, 0, sizeof *out);
    struct gui_state *own = calloc(1, sizeof *own);
    if (!own)
        return err_memory(err, "panel", sizeof *own);
    out->own = own;
    own->scale = scale;
    own->mouse[0] = own->mouse[1] = -1.0;
    own->im = im_create(scale);
    add_font(floorf(FONT_POINTS * scale + 0.5f));
    if (im_atlas(&own->atlas))
        return true;
    err_memory(err, "letters", (unsigned long long)own->atlas.width * own->atlas.height);
    gui_finish(out);
    return false;
}

void gui_finish(struct gui *gui)
{
    struct gui_state *own = gui ? gui->own : NULL;
    if (!own)
        return;
    im_destroy(own->im);
    free(own);
    memset(gui, 0, sizeof *gui);
}

void gui_atlas(struct gui *gui, struct gpu_atlas *out)
{
    *out = gui->own->atlas;
}

// --- frames --------------------------------------------------------------------------------------

void gui_begin(struct gui *gui, uint32_t width, uint32_t height, double seconds)
{
    struct gui_state *own = gui->own;
    // ImGui requires a time above 0. The time is limited because a frame may follow one that waited
    // for seconds.
    float step = (float)fmin(fmax(seconds, 1e-4), 1.0);
    own->clock += (double)step;
    events_feed(gui);
    im_begin(own->im, (float)width, (float)height, step);
    items_begin(own);
    gui->used = NULL;
    gui->hovered_help = NULL;
    gui->width = 0.0f;
    own->has_popup = false;
}

void gui_end(struct gui *gui, struct gpu_drawing *out)
{
    struct gui_state *own = gui->own;
    items_end(gui);
    // If the control into which text is typed is no longer shown, typing ends.
    if (own->edit_id[0] && ++own->edit_idle > 1)
        own->edit_id[0] = '\0';
    im_end(own->im, out, &gui->is_busy, &gui->wants_keys);
    gui->wants_keys = gui->wants_keys || own->edit_id[0];
    events_want(gui);
}

// --- layout --------------------------------------------------------------------------------------

__attribute__((format(printf, 3, 4))) static void put_text(uint32_t rgba, float wrap,
                                                           const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    im_text(rgba, wrap, format, arguments);
    va_end(arguments);
}

static float usual_width(const struct gui *gui, float window_width)
{
    return floorf(fminf(PANEL_POINTS * gui->own->scale, PANEL_PART * window_width));
}

float gui_panel_width(const struct gui *gui, uint32_t window_width)
{
    return gui->is_floating ? 0.0f : usual_width(gui, (float)window_width);
}

// The panel is either beside the image, or a window over it that the user can move.
static void begin_window(struct gui *gui, const char *title, struct im_vec size)
{
    struct im_rect place = {0.0f, 0.0f, gui->width, size.y};
    if (!gui->is_floating) {
        im_panel_begin(gui->width, size.y);
        put_text(IM_GLOW, -1.0f, "%s", title);
    } else {
        float edge = 24.0f * gui->own->scale, width = usual_width(gui, size.x);
        const struct im_rect first = {edge, edge, edge + width, 0.8f * size.y};
        place = im_panel_begin_floating(title, first);
    }
    memcpy(gui->place, (float[4]){place.left, place.top, place.right, place.bottom},
           sizeof gui->place);
}

static float label_width(void)
{
    return floorf(im_now().room * 0.40f);
}

bool gui_panel_begin(struct gui *gui, const char *title, const char *facts,
                     const struct gui_tab *tabs)
{
    struct gui_state *own = gui->own;
    const struct im_place now = im_now();
    own->is_drawn = !gui->is_hidden && now.display.x > 0.0f && now.display.y > 0.0f;
    memset(gui->place, 0, sizeof gui->place);
    if (own->is_drawn) {
        gui->width = gui_panel_width(gui, (uint32_t)now.display.x);
        begin_window(gui, title, now.display);
        if (facts[0])
            put_text(IM_DIM, -1.0f, "%s", facts);
        own->label_width = label_width();
    }
    if (tabs)
        tabs_begin(gui, tabs);
    if (!own->is_drawn)
        return false;
    im_child_begin("controls", -(HELP_LINES * now.line + 2.0f * now.spacing.y), false);
    own->label_width = label_width();
    return true;
}

static void draw_help(const struct gui *gui)
{
    const struct gui_state *own = gui->own;
    char help[GUI_HELP_MAX];
    im_separator();
    if (own->clock < own->refusal_until) {
        put_text(IM_WARNING, 0.0f, "%s", own->refusal);
    } else if (gui->hovered_help) {
        gui_item_help(own->hovered, help);
        put_text(IM_DIM, 0.0f, "%s", own->hovered->id);
        put_text(IM_TEXT, 0.0f, "%s", help);
    } else {
        put_text(IM_DIM, 0.0f,
                 "Help for the control under the mouse. Drag numbers, or Ctrl+click to type them.");
    }
}

void gui_panel_end(struct gui *gui)
{
    struct gui_state *own = gui->own;
    if (!own->is_drawn)
        return;
    if (own->is_searching && own->found_count == 0)
        put_text(IM_DIM, 0.0f, "No control has the words \"%s\" in its name or help.", own->sought);
    im_child_end(false);
    draw_help(gui);
    im_panel_end();
    own->is_drawn = false;
}

void gui_space(struct gui *gui)
{
    if (gui_is_drawn(gui))
        im_dummy(0.0f, im_now().spacing.y);
}

// --- texts ---------------------------------------------------------------------------------------

// Draws a line of text. `label` is drawn in the column of labels; NULL for none.
__attribute__((format(printf, 5, 0))) static void line(struct gui *gui, const char *label,
                                                       uint32_t rgba, float wrap,
                                                       const char *format, va_list arguments)
{
    const float width = gui->own->label_width;
    if (!gui_is_drawn(gui))
        return;
    if (label) {
        put_text(IM_DIM, wrap < 0.0f ? wrap : width - im_now().inner_spacing, "%s", label);
        im_same_line(width, -1.0f);
    }
    im_text(rgba, wrap, format, arguments);
}

void gui_line(struct gui *gui, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    line(gui, NULL, IM_TEXT, 0.0f, format, arguments);
    va_end(arguments);
}

void gui_warning(struct gui *gui, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    line(gui, NULL, IM_WARNING, 0.0f, format, arguments);
    va_end(arguments);
}

void gui_pair(struct gui *gui, const char *label, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    line(gui, label, IM_TEXT, 0.0f, format, arguments);
    va_end(arguments);
}

void gui_fact(struct gui *gui, const char *label, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    line(gui, label, IM_TEXT, -1.0f, format, arguments);
    va_end(arguments);
}
