// What stands over the picture: notes, tables, scales of colours, progress.
#include "viewer/gui/gui_state.h"
#include "viewer/gui/imgui_bridge.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>

#define PICTURE_TEXT IM_RGBA(225, 228, 232, 255)
#define PICTURE_DIM IM_RGBA(150, 154, 160, 255)
#define PICTURE_WARNING IM_RGBA(242, 158, 98, 255)
#define PICTURE_GROUND IM_RGBA(15, 16, 18, 205)
#define TABLE_GROUND IM_RGBA(15, 16, 18, 235)
#define PROGRESS_GROUND IM_RGBA(20, 21, 24, 235)
#define PROGRESS_TROUGH IM_RGBA(50, 53, 58, 255)

// Rectangles and letters by their edges.
static void fill(struct ImDrawList *list, float left, float top, float right, float bottom,
                 uint32_t rgba, float rounding)
{
    im_draw_rect(list, (struct im_vec){left, top}, (struct im_vec){right, bottom}, rgba, rounding);
}

static void write(struct ImDrawList *list, float x, float y, uint32_t rgba, const char *text)
{
    im_draw_text(list, (struct im_vec){x, y}, rgba, text);
}

static float width_of(const char *text)
{
    return im_text_size(text, -1.0f).x;
}

float gui_note(struct gui *gui, float x, float y, bool is_warning, const char *format, ...)
{
    (void)gui;
    char text[1280];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    const struct im_style style = im_style_now();
    const struct im_vec pad = style.frame_padding;
    float left = floorf(x), top = floorf(y);
    float wrap = fmaxf(im_display().x - left - 4.0f * pad.x, 1.0f);
    struct im_vec size = im_text_size(text, wrap);
    float bottom = top + size.y + 2.0f * pad.y;
    struct ImDrawList *list = im_draw_background();
    fill(list, left, top, left + size.x + 2.0f * pad.x, bottom, PICTURE_GROUND,
         style.frame_rounding);
    im_draw_text_wrapped(list, (struct im_vec){left + pad.x, top + pad.y},
                         is_warning ? PICTURE_WARNING : PICTURE_TEXT, text, wrap);
    return bottom - top;
}

void gui_table(struct gui *gui, const struct gui_pair *rows, uint32_t count)
{
    const struct im_style style = im_style_now();
    const struct im_vec screen = im_display();
    float left = 0.0f, right = 0.0f, line = im_line_height() * 1.2f;
    for (uint32_t i = 0; i < count; i++) {
        left = fmaxf(left, width_of(rows[i].left));
        right = fmaxf(right, width_of(rows[i].right));
    }
    float gap = 2.0f * style.window_padding.x, pad = 2.0f * style.window_padding.x;
    struct im_vec size = {left + gap + right + 2.0f * pad, (float)count * line + 2.0f * pad};
    // Over the panel, too, where there is no room beside it.
    float from = size.x <= screen.x - gui->width ? gui->width : 0.0f;
    float x = floorf(from + fmaxf(0.5f * (screen.x - from - size.x), 0.0f));
    float y = floorf(fmaxf(0.5f * (screen.y - size.y), 0.0f));
    struct ImDrawList *list = im_draw_foreground();
    fill(list, x, y, x + size.x, y + size.y, TABLE_GROUND, style.frame_rounding);
    for (uint32_t i = 0; i < count; i++) {
        float row = floorf(y + pad + (float)i * line);
        write(list, x + pad, row, im_rgba(IM_COLOR_CHECK_MARK), rows[i].left);
        write(list, x + pad + left + gap, row, PICTURE_TEXT, rows[i].right);
    }
}

void gui_legend(struct gui *gui, const uint32_t *colors, uint32_t count, const char *const texts[3])
{
    const struct gui_state *own = gui->own;
    const struct im_vec screen = im_display();
    const struct im_style style = im_style_now();
    float pad = style.window_padding.x, line = im_line_height();
    float bar = floorf(9.0f * own->scale);
    float width = floorf(fminf(280.0f * own->scale, 0.9f * (screen.x - gui->width)) - 2.0f * pad);
    if (width < 1.0f)
        return;
    float x = floorf(screen.x - width - 3.0f * pad);
    float y = floorf(screen.y - line - bar - 4.0f * pad);
    struct ImDrawList *list = im_draw_background();
    fill(list, x, y, x + width + 2.0f * pad, y + line + bar + 3.0f * pad, PICTURE_GROUND,
         style.frame_rounding);
    float left = x + pad, top = y + pad;
    for (uint32_t i = 0; i + 1 < count; i++) {
        float from = left + width * (float)i / (float)(count - 1);
        float to = left + width * (float)(i + 1) / (float)(count - 1);
        im_draw_gradient(list, (struct im_vec){from, top}, (struct im_vec){to, top + bar},
                         colors[i], colors[i + 1]);
    }
    for (int i = 0; i < 3; i++) {
        float part = 0.5f * (float)i;
        float at = left + part * (width - width_of(texts[i]));
        write(list, floorf(at), top + bar + pad, PICTURE_TEXT, texts[i]);
    }
}

void gui_progress(struct gui *gui, const char *what, double fraction)
{
    const struct gui_state *own = gui->own;
    struct ImDrawList *list = im_draw_foreground();
    const struct im_vec size = im_display();
    const struct im_style style = im_style_now();
    float width = fminf(320.0f * own->scale, 0.8f * (size.x - gui->width));
    float x = floorf(gui->width + 0.5f * (size.x - gui->width - width));
    float y = floorf(0.5f * size.y), bar = floorf(4.0f * own->scale);
    float pad = style.window_padding.x, line = im_line_height();
    double done = fmin(fmax(fraction, 0.0), 1.0);
    char percent[16];
    snprintf(percent, sizeof percent, "%.0f %%", 100.0 * done);
    fill(list, x, y, x + width, y + line + bar + 3.0f * pad, PROGRESS_GROUND, style.frame_rounding);
    float inner = width - 2.0f * pad;
    im_push_clip(list, (struct im_vec){x + pad, y},
                 (struct im_vec){x + pad + 0.8f * inner, y + line + 2.0f * pad}, false);
    write(list, x + pad, y + pad, PICTURE_TEXT, what);
    im_pop_clip(list);
    write(list, x + pad + inner - width_of(percent), y + pad, PICTURE_DIM, percent);
    float top = y + line + 2.0f * pad;
    fill(list, x + pad, top, x + pad + inner, top + bar, PROGRESS_TROUGH, bar * 0.5f);
    fill(list, x + pad, top, x + pad + inner * (float)done, top + bar, im_rgba(IM_COLOR_CHECK_MARK),
         bar * 0.5f);
}
