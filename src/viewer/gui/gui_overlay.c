// Draws the overlays of the image: notes, tables, colour scales, progress.
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

float gui_note(struct gui *gui, float x, float y, bool is_warning, const char *format, ...)
{
    (void)gui;
    char text[1280];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    const struct im_place now = im_now();
    const struct im_vec pad = now.frame_padding;
    float left = floorf(x), top = floorf(y);
    float wrap = fmaxf(now.display.x - left - 4.0f * pad.x, 1.0f);
    struct im_vec size = im_text_size(text, wrap);
    const struct im_rect box = {left, top, left + size.x + 2.0f * pad.x,
                                top + size.y + 2.0f * pad.y};
    struct ImDrawList *list = im_layer(IM_BACKGROUND);
    im_draw_rect(list, box, PICTURE_GROUND, now.rounding);
    im_draw_text(list, left + pad.x, top + pad.y, is_warning ? PICTURE_WARNING : PICTURE_TEXT, text,
                 NULL, wrap);
    return box.bottom - box.top;
}

void gui_table(struct gui *gui, const struct gui_pair *rows, uint32_t count)
{
    const struct im_place now = im_now();
    float left = 0.0f, right = 0.0f, line = now.line * 1.2f;
    for (uint32_t i = 0; i < count; i++) {
        left = fmaxf(left, im_text_width(rows[i].left));
        right = fmaxf(right, im_text_width(rows[i].right));
    }
    float gap = 2.0f * now.window_padding.x, pad = 2.0f * now.window_padding.x;
    struct im_vec size = {left + gap + right + 2.0f * pad, (float)count * line + 2.0f * pad};
    // The table covers the panel if there is no space beside it.
    float from = size.x <= now.display.x - gui->width ? gui->width : 0.0f;
    float x = floorf(from + fmaxf(0.5f * (now.display.x - from - size.x), 0.0f));
    float y = floorf(fmaxf(0.5f * (now.display.y - size.y), 0.0f));
    struct ImDrawList *list = im_layer(IM_FOREGROUND);
    im_draw_rect(list, (struct im_rect){x, y, x + size.x, y + size.y}, TABLE_GROUND, now.rounding);
    for (uint32_t i = 0; i < count; i++) {
        float row = floorf(y + pad + (float)i * line);
        im_draw_text(list, x + pad, row, IM_GLOW, rows[i].left, NULL, 0.0f);
        im_draw_text(list, x + pad + left + gap, row, PICTURE_TEXT, rows[i].right, NULL, 0.0f);
    }
}

void gui_legend(struct gui *gui, const uint32_t *colors, uint32_t count, const char *const texts[3])
{
    const struct gui_state *own = gui->own;
    const struct im_place now = im_now();
    float pad = now.window_padding.x, line = now.line;
    float bar = floorf(9.0f * own->scale);
    float width =
        floorf(fminf(280.0f * own->scale, 0.9f * (now.display.x - gui->width)) - 2.0f * pad);
    if (width < 1.0f)
        return;
    float x = floorf(now.display.x - width - 3.0f * pad);
    float y = floorf(now.display.y - line - bar - 4.0f * pad);
    struct ImDrawList *list = im_layer(IM_BACKGROUND);
    im_draw_rect(list, (struct im_rect){x, y, x + width + 2.0f * pad, y + line + bar + 3.0f * pad},
                 PICTURE_GROUND, now.rounding);
    float left = x + pad, top = y + pad;
    for (uint32_t i = 0; i + 1 < count; i++) {
        float from = left + width * (float)i / (float)(count - 1);
        float to = left + width * (float)(i + 1) / (float)(count - 1);
        im_draw_gradient(list, (struct im_rect){from, top, to, top + bar}, colors[i],
                         colors[i + 1]);
    }
    for (int i = 0; i < 3; i++) {
        float part = 0.5f * (float)i;
        float at = left + part * (width - im_text_width(texts[i]));
        im_draw_text(list, floorf(at), top + bar + pad, PICTURE_TEXT, texts[i], NULL, 0.0f);
    }
}

void gui_stroke(struct gui *gui, const double from[2], const double to[2])
{
    const float scale = gui->own->scale;
    struct ImDrawList *list = im_layer(IM_BACKGROUND);
    const struct im_vec ends[2] = {{(float)from[0], (float)from[1]}, {(float)to[0], (float)to[1]}};
    im_draw_line(list, ends[0], ends[1], PICTURE_GROUND, 3.0f * scale);
    im_draw_line(list, ends[0], ends[1], IM_GLOW, 1.5f * scale);
}

void gui_progress(struct gui *gui, const char *what, double fraction)
{
    const struct gui_state *own = gui->own;
    struct ImDrawList *list = im_layer(IM_FOREGROUND);
    const struct im_place now = im_now();
    float width = fminf(320.0f * own->scale, 0.8f * (now.display.x - gui->width));
    float x = floorf(gui->width + 0.5f * (now.display.x - gui->width - width));
    float y = floorf(0.5f * now.display.y), bar = floorf(4.0f * own->scale);
    float pad = now.window_padding.x, line = now.line;
    double done = fmin(fmax(fraction, 0.0), 1.0);
    char percent[16];
    snprintf(percent, sizeof percent, "%.0f %%", 100.0 * done);
    im_draw_rect(list, (struct im_rect){x, y, x + width, y + line + bar + 3.0f * pad},
                 PROGRESS_GROUND, now.rounding);
    float inner = width - 2.0f * pad;
    const struct im_rect clip = {x + pad, y, x + pad + 0.8f * inner, y + line + 2.0f * pad};
    im_draw_text(list, x + pad, y + pad, PICTURE_TEXT, what, &clip, 0.0f);
    im_draw_text(list, x + pad + inner - im_text_width(percent), y + pad, PICTURE_DIM, percent,
                 NULL, 0.0f);
    float top = y + line + 2.0f * pad;
    im_draw_rect(list, (struct im_rect){x + pad, top, x + pad + inner, top + bar}, PROGRESS_TROUGH,
                 bar * 0.5f);
    im_draw_rect(list, (struct im_rect){x + pad, top, x + pad + inner * (float)done, top + bar},
                 IM_GLOW, bar * 0.5f);
}
