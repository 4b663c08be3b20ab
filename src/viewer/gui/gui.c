// The panel: created, fed with events, laid out, and turned into triangles. Of Dear ImGui it uses
// the core alone: windows and devices are this program's own.
#include "viewer/gui/gui.h"

#include "viewer/gui/gui_state.h"
#include "viewer/gui/imgui_bridge.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// Letters, points: what fits a column of some forty letters into a panel of 320 points.
#define FONT_POINTS 13.0f
#define PANEL_POINTS 340.0f
#define PANEL_PART 0.4f // of the window's width, at most
#define HELP_LINES 3.0f
#define WARNING IM_RGBA(242, 153, 89, 255)

// --- looks ---------------------------------------------------------------------------------------

static void set_grays(void)
{
    static const struct {
        enum im_color color;
        float value, alpha;
    } grays[] = {
        {IM_COLOR_TEXT, 0.86f, 1.0f},
        {IM_COLOR_TEXT_DISABLED, 0.53f, 1.0f},
        {IM_COLOR_WINDOW, 0.095f, 0.97f},
        {IM_COLOR_POPUP, 0.12f, 0.99f},
        {IM_COLOR_BORDER, 0.25f, 0.6f},
        {IM_COLOR_FRAME, 0.17f, 1.0f},
        {IM_COLOR_FRAME_HOVERED, 0.23f, 1.0f},
        {IM_COLOR_FRAME_ACTIVE, 0.27f, 1.0f},
        {IM_COLOR_HEADER, 0.15f, 1.0f},
        {IM_COLOR_HEADER_HOVERED, 0.22f, 1.0f},
        {IM_COLOR_HEADER_ACTIVE, 0.26f, 1.0f},
        {IM_COLOR_BUTTON, 0.21f, 1.0f},
        {IM_COLOR_BUTTON_HOVERED, 0.28f, 1.0f},
        {IM_COLOR_BUTTON_ACTIVE, 0.33f, 1.0f},
        {IM_COLOR_SEPARATOR, 0.22f, 1.0f},
        {IM_COLOR_SCROLLBAR_GRAB, 0.24f, 1.0f},
        {IM_COLOR_SCROLLBAR_GRAB_HOVERED, 0.30f, 1.0f},
        {IM_COLOR_SCROLLBAR_GRAB_ACTIVE, 0.36f, 1.0f},
    };
    for (size_t i = 0; i < sizeof grays / sizeof *grays; i++) {
        float value = grays[i].value;
        im_style_color(grays[i].color, value * 0.97f, value, value * 1.04f, grays[i].alpha);
    }
}

static void set_colors(void)
{
    static const enum im_color clear[] = {IM_COLOR_CHILD, IM_COLOR_SCROLLBAR};
    static const enum im_color glowing[] = {IM_COLOR_CHECK_MARK, IM_COLOR_GRAB_ACTIVE,
                                            IM_COLOR_PLOT_LINES};
    static const enum im_color dim[] = {IM_COLOR_GRAB, IM_COLOR_SELECTED_TEXT, IM_COLOR_PLOT_BARS};
    set_grays();
    for (size_t i = 0; i < sizeof clear / sizeof *clear; i++)
        im_style_color(clear[i], 0.0f, 0.0f, 0.0f, 0.0f);
    for (size_t i = 0; i < sizeof glowing / sizeof *glowing; i++) // a glow-worm's
        im_style_color(glowing[i], 0.66f, 0.79f, 0.33f, 1.0f);
    for (size_t i = 0; i < sizeof dim / sizeof *dim; i++)
        im_style_color(dim[i], 0.45f, 0.55f, 0.22f, 0.55f);
}

static void set_style(float scale)
{
    static const struct im_style style = {
        .window_padding = {8.0f, 8.0f},
        .frame_padding = {6.0f, 3.0f},
        .item_spacing = {6.0f, 4.0f},
        .item_inner_spacing = {4.0f, 4.0f},
        .indent = 8.0f,
        .scrollbar = 9.0f,
        .frame_rounding = 3.0f,
        .grab_rounding = 3.0f,
        .popup_rounding = 3.0f,
        .scrollbar_rounding = 4.0f,
        .disabled_alpha = 0.42f,
    };
    im_style_set(&style, scale);
    set_colors();
}

// The distribution's font where it is, with the letters of most names; else the one that Dear ImGui
// has within itself.
static void add_font(float pixels)
{
    static const char *const paths[] = {
        "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf",
        "/usr/share/fonts/dejavu-sans-fonts/DejaVuSans.ttf",
        "/usr/share/fonts/TTF/DejaVuSans.ttf",
    };
    // Latin, Greek, Cyrillic; dashes and quotation marks, arrows, a few signs of mathematics.
    static const uint16_t ranges[] = {0x20,   0x24f,  0x370,  0x3ff,  0x400,  0x45f,
                                      0x2010, 0x2026, 0x2070, 0x209c, 0x2190, 0x2193,
                                      0x2202, 0x2265, 0x25b4, 0x25c3, 0};
    for (size_t i = 0; i < sizeof paths / sizeof *paths; i++) {
        FILE *file = fopen(paths[i], "rb");
        if (!file)
            continue;
        fclose(file);
        if (im_font_file(paths[i], pixels, ranges))
            return;
    }
    im_font_default(pixels);
}

static bool make_atlas(struct gui_state *own, struct err *err)
{
    add_font(floorf(FONT_POINTS * own->scale + 0.5f));
    own->coverage = im_font_coverage(&own->atlas_width, &own->atlas_height);
    if (!own->coverage)
        return err_memory(err, "letters", (unsigned long long)own->atlas_width * own->atlas_height);
    return true;
}

// --- life ----------------------------------------------------------------------------------------

static const char *get_clipboard(void *user)
{
    const struct gui_state *own = user;
    return own->clipboard ? own->clipboard : "";
}

static void set_clipboard(void *user, const char *text)
{
    struct gui_state *own = user;
    char *copy = strdup(text);
    if (!copy)
        return; // the old text stays
    free(own->clipboard);
    own->clipboard = copy;
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
    own->context = im_create(get_clipboard, set_clipboard, own);
    set_style(scale);
    if (!make_atlas(own, err)) {
        gui_finish(out);
        return false;
    }
    return true;
}

void gui_finish(struct gui *gui)
{
    struct gui_state *own = gui ? gui->own : NULL;
    if (!own)
        return;
    im_destroy(own->context);
    free(own->clipboard);
    free(own->vertices);
    free(own->indices);
    free(own->draws);
    free(own);
    memset(gui, 0, sizeof *gui);
}

void gui_atlas(struct gui *gui, struct gpu_atlas *out)
{
    out->coverage = gui->own->coverage;
    out->width = gui->own->atlas_width;
    out->height = gui->own->atlas_height;
}

// --- frames --------------------------------------------------------------------------------------

void gui_begin(struct gui *gui, uint32_t width, uint32_t height, double seconds)
{
    struct gui_state *own = gui->own;
    // ImGui asks for a time above 0; a frame that waited for seconds is no reason to jump.
    float step = (float)fmin(fmax(seconds, 1e-4), 1.0);
    im_use(own->context);
    im_frame_setup((float)width, (float)height, step);
    own->clock += (double)step;
    events_feed(gui);
    im_frame_begin();
    items_begin(own);
    gui->hovered_help = NULL;
    own->hovered_id[0] = '\0';
    gui->width = 0.0f;
    own->has_popup = false;
}

// Room for at least `count` things of `each` bytes. False: out of memory, and `array`, where their
// address is, keeps what there was.
static bool reserve(void *array, uint32_t *capacity, uint32_t count, size_t each)
{
    if (count <= *capacity)
        return true;
    uint32_t more = count + count / 2;
    void *at;
    memcpy(&at, array, sizeof at);
    at = realloc(at, more * each);
    if (!at)
        return false;
    memcpy(array, &at, sizeof at);
    *capacity = more;
    return true;
}

// Adds list number `index`.
static void copy_list(struct gui_state *own, uint32_t index, struct gpu_drawing *out)
{
    const struct im_list list = im_list_at(index);
    const struct im_vec size = im_display();
    memcpy(own->vertices + out->vertex_count, list.vertices,
           list.vertex_count * sizeof *list.vertices);
    memcpy(own->indices + out->index_count, list.indices, list.index_count * sizeof *list.indices);
    for (uint32_t i = 0; i < list.command_count; i++) {
        struct gpu_draw draw = im_list_command(index, i);
        draw.first_index += out->index_count;
        draw.first_vertex += out->vertex_count;
        draw.clip[0] = fmaxf(draw.clip[0], 0.0f);
        draw.clip[1] = fmaxf(draw.clip[1], 0.0f);
        draw.clip[2] = fminf(draw.clip[2], size.x);
        draw.clip[3] = fminf(draw.clip[3], size.y);
        if (draw.index_count && draw.clip[0] < draw.clip[2] && draw.clip[1] < draw.clip[3])
            own->draws[out->draw_count++] = draw;
    }
    out->vertex_count += list.vertex_count;
    out->index_count += list.index_count;
}

static void copy_drawing(struct gui_state *own, struct gpu_drawing *out)
{
    const uint32_t lists = im_list_count();
    uint32_t vertices = 0, indices = 0, draws = 0;
    memset(out, 0, sizeof *out);
    for (uint32_t i = 0; i < lists; i++) {
        const struct im_list list = im_list_at(i);
        vertices += list.vertex_count;
        indices += list.index_count;
        draws += list.command_count;
    }
    // Without memory a frame has no panel; the next one may.
    if (!reserve(&own->vertices, &own->vertex_capacity, vertices, sizeof *own->vertices) ||
        !reserve(&own->indices, &own->index_capacity, indices, sizeof *own->indices) ||
        !reserve(&own->draws, &own->draw_capacity, draws, sizeof *own->draws))
        return;
    for (uint32_t i = 0; i < lists; i++)
        copy_list(own, i, out);
    out->vertices = own->vertices;
    out->indices = own->indices;
    out->draws = own->draws;
}

void gui_end(struct gui *gui, struct gpu_drawing *out)
{
    struct gui_state *own = gui->own;
    items_end(gui);
    im_frame_end();
    // A text whose control went away is not being typed any more.
    if (own->edit_id[0] && ++own->edit_idle > 1)
        own->edit_id[0] = '\0';
    copy_drawing(own, out);
    gui->is_busy = im_is_any_active();
    gui->wants_keys = im_wants_text() || own->edit_id[0];
    events_want(gui);
}

// --- layout --------------------------------------------------------------------------------------

static float help_height(void)
{
    return HELP_LINES * im_line_height() + 2.0f * im_style_now().item_spacing.y;
}

static float usual_width(const struct gui *gui, float window_width)
{
    return floorf(fminf(PANEL_POINTS * gui->own->scale, PANEL_PART * window_width));
}

float gui_panel_width(const struct gui *gui, uint32_t window_width)
{
    return gui->is_floating ? 0.0f : usual_width(gui, (float)window_width);
}

// Beside the picture, or over it where its user has moved it to.
static void begin_window(struct gui *gui, const char *title, struct im_vec size)
{
    struct gui_state *own = gui->own;
    struct im_rect place = {{0.0f, 0.0f}, {gui->width, size.y}};
    if (!gui->is_floating) {
        im_panel_begin(gui->width, size.y);
        im_push_color_of(IM_COLOR_TEXT, IM_COLOR_CHECK_MARK);
        im_text(title);
        im_pop_color();
    } else {
        float edge = 24.0f * own->scale, width = usual_width(gui, size.x);
        const struct im_rect first = {{edge, edge}, {edge + width, 0.8f * size.y}};
        place = im_panel_begin_floating(title, first);
    }
    memcpy(gui->place, (float[4]){place.min.x, place.min.y, place.max.x, place.max.y},
           sizeof gui->place);
}

bool gui_panel_begin(struct gui *gui, const char *title, const char *facts)
{
    struct gui_state *own = gui->own;
    const struct im_vec size = im_display();
    own->is_drawn = !gui->is_hidden && size.x > 0.0f && size.y > 0.0f;
    memset(gui->place, 0, sizeof gui->place);
    if (!own->is_drawn)
        return false;
    gui->width = gui_panel_width(gui, (uint32_t)size.x);
    begin_window(gui, title, size);
    if (facts[0])
        im_text_dim(facts);
    im_child_begin("controls", -help_height(), false);
    own->label_width = floorf(im_room() * 0.40f);
    return true;
}

static void draw_help(struct gui *gui)
{
    struct gui_state *own = gui->own;
    im_separator();
    im_push_wrap(0.0f);
    if (own->clock < own->refusal_until) {
        im_push_color(IM_COLOR_TEXT, WARNING);
        im_text(own->refusal);
        im_pop_color();
    } else if (gui->hovered_help) {
        im_text_dim(own->hovered_id);
        im_text(gui->hovered_help);
    } else {
        im_text_dim("Help on what the mouse is over. Numbers: drag, or Ctrl+click to type.");
    }
    im_pop_wrap();
}

void gui_panel_end(struct gui *gui)
{
    struct gui_state *own = gui->own;
    if (!own->is_drawn)
        return;
    im_child_end();
    draw_help(gui);
    im_panel_end();
    own->is_drawn = false;
}

void gui_space(struct gui *gui)
{
    if (gui->own->is_drawn)
        im_dummy(0.0f, im_style_now().item_spacing.y);
}

// --- texts ---------------------------------------------------------------------------------------

__attribute__((format(printf, 1, 0))) static void wrapped(const char *format, va_list arguments)
{
    im_push_wrap(0.0f);
    im_text_v(format, arguments);
    im_pop_wrap();
}

void gui_line(struct gui *gui, const char *format, ...)
{
    if (!gui->own->is_drawn)
        return;
    va_list arguments;
    va_start(arguments, format);
    wrapped(format, arguments);
    va_end(arguments);
}

void gui_warning(struct gui *gui, const char *format, ...)
{
    if (!gui->own->is_drawn)
        return;
    va_list arguments;
    va_start(arguments, format);
    im_push_color(IM_COLOR_TEXT, WARNING);
    wrapped(format, arguments);
    im_pop_color();
    va_end(arguments);
}

void gui_pair(struct gui *gui, const char *label, const char *format, ...)
{
    const struct gui_state *own = gui->own;
    if (!own->is_drawn)
        return;
    va_list arguments;
    va_start(arguments, format);
    im_push_wrap(own->label_width - im_style_now().item_inner_spacing.x);
    im_text_dim(label);
    im_pop_wrap();
    im_same_line_at(own->label_width);
    wrapped(format, arguments);
    va_end(arguments);
}

void gui_fact(struct gui *gui, const char *label, const char *format, ...)
{
    if (!gui->own->is_drawn)
        return;
    va_list arguments;
    va_start(arguments, format);
    im_text_dim(label);
    im_same_line_at(gui->own->label_width);
    im_text_v(format, arguments);
    va_end(arguments);
}
