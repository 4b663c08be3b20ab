// What stands over the picture: notes, tables, scales of colours, progress.
extern "C" {
#include "gui_state.h"
}

#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <imgui.h>

#define PICTURE_TEXT IM_COL32(225, 228, 232, 255)
#define PICTURE_DIM IM_COL32(150, 154, 160, 255)
#define PICTURE_WARNING IM_COL32(242, 158, 98, 255)
#define PICTURE_GROUND IM_COL32(15, 16, 18, 205)

float gui_note(struct gui *gui, float x, float y, bool is_warning, const char *format, ...)
{
    (void)gui;
    char text[1280];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    const ImGuiStyle &style = ImGui::GetStyle();
    ImVec2 at(floorf(x), floorf(y)), pad(style.FramePadding.x, style.FramePadding.y);
    float wrap = fmaxf(ImGui::GetIO().DisplaySize.x - at.x - 4.0f * pad.x, 1.0f);
    ImVec2 size = ImGui::CalcTextSize(text, NULL, false, wrap);
    ImVec2 end(at.x + size.x + 2.0f * pad.x, at.y + size.y + 2.0f * pad.y);
    ImDrawList *list = ImGui::GetBackgroundDrawList();
    list->AddRectFilled(at, end, PICTURE_GROUND, style.FrameRounding);
    list->AddText(NULL, 0.0f, ImVec2(at.x + pad.x, at.y + pad.y),
                  is_warning ? PICTURE_WARNING : PICTURE_TEXT, text, NULL, wrap);
    return end.y - at.y;
}

void gui_table(struct gui *gui, const struct gui_pair *rows, uint32_t count)
{
    const ImGuiStyle &style = ImGui::GetStyle();
    const ImVec2 screen = ImGui::GetIO().DisplaySize;
    float left = 0.0f, right = 0.0f, line = ImGui::GetTextLineHeight() * 1.2f;
    for (uint32_t i = 0; i < count; i++) {
        left = fmaxf(left, ImGui::CalcTextSize(rows[i].left).x);
        right = fmaxf(right, ImGui::CalcTextSize(rows[i].right).x);
    }
    float gap = 2.0f * style.WindowPadding.x, pad = 2.0f * style.WindowPadding.x;
    ImVec2 size(left + gap + right + 2.0f * pad, (float)count * line + 2.0f * pad);
    // Over the panel, too, where there is no room beside it.
    float from = size.x <= screen.x - gui->width ? gui->width : 0.0f;
    ImVec2 at(floorf(from + fmaxf(0.5f * (screen.x - from - size.x), 0.0f)),
              floorf(fmaxf(0.5f * (screen.y - size.y), 0.0f)));
    ImDrawList *list = ImGui::GetForegroundDrawList();
    list->AddRectFilled(at, ImVec2(at.x + size.x, at.y + size.y), IM_COL32(15, 16, 18, 235),
                        style.FrameRounding);
    for (uint32_t i = 0; i < count; i++) {
        float y = floorf(at.y + pad + (float)i * line);
        list->AddText(ImVec2(at.x + pad, y), ImGui::GetColorU32(ImGuiCol_CheckMark), rows[i].left);
        list->AddText(ImVec2(at.x + pad + left + gap, y), PICTURE_TEXT, rows[i].right);
    }
}

void gui_legend(struct gui *gui, const uint32_t *colors, uint32_t count, const char *const texts[3])
{
    const struct gui_state *own = gui->own;
    const ImVec2 screen = ImGui::GetIO().DisplaySize;
    const ImGuiStyle &style = ImGui::GetStyle();
    float pad = style.WindowPadding.x, line = ImGui::GetTextLineHeight();
    float bar = floorf(9.0f * own->scale);
    float width = floorf(fminf(280.0f * own->scale, 0.9f * (screen.x - gui->width)) - 2.0f * pad);
    if (width < 1.0f)
        return;
    ImVec2 at(floorf(screen.x - width - 3.0f * pad), floorf(screen.y - line - bar - 4.0f * pad));
    ImDrawList *list = ImGui::GetBackgroundDrawList();
    list->AddRectFilled(at, ImVec2(at.x + width + 2.0f * pad, at.y + line + bar + 3.0f * pad),
                        PICTURE_GROUND, style.FrameRounding);
    float left = at.x + pad, top = at.y + pad;
    for (uint32_t i = 0; i + 1 < count; i++) {
        float from = left + width * (float)i / (float)(count - 1);
        float to = left + width * (float)(i + 1) / (float)(count - 1);
        list->AddRectFilledMultiColor(ImVec2(from, top), ImVec2(to, top + bar), colors[i],
                                      colors[i + 1], colors[i + 1], colors[i]);
    }
    for (int i = 0; i < 3; i++) {
        float part = 0.5f * (float)i;
        float x = left + part * (width - ImGui::CalcTextSize(texts[i]).x);
        list->AddText(ImVec2(floorf(x), top + bar + pad), PICTURE_TEXT, texts[i]);
    }
}

void gui_progress(struct gui *gui, const char *what, double fraction)
{
    const struct gui_state *own = gui->own;
    ImDrawList *list = ImGui::GetForegroundDrawList();
    const ImVec2 size = ImGui::GetIO().DisplaySize;
    const ImGuiStyle &style = ImGui::GetStyle();
    float width = fminf(320.0f * own->scale, 0.8f * (size.x - gui->width));
    float x = floorf(gui->width + 0.5f * (size.x - gui->width - width));
    float y = floorf(0.5f * size.y), bar = floorf(4.0f * own->scale);
    float pad = style.WindowPadding.x, line = ImGui::GetTextLineHeight();
    char percent[16];
    snprintf(percent, sizeof percent, "%.0f %%", 100.0 * fmin(fmax(fraction, 0.0), 1.0));
    list->AddRectFilled(ImVec2(x, y), ImVec2(x + width, y + line + bar + 3.0f * pad),
                        IM_COL32(20, 21, 24, 235), style.FrameRounding);
    float inner = width - 2.0f * pad;
    list->PushClipRect(ImVec2(x + pad, y), ImVec2(x + pad + 0.8f * inner, y + line + 2.0f * pad));
    list->AddText(ImVec2(x + pad, y + pad), PICTURE_TEXT, what);
    list->PopClipRect();
    list->AddText(ImVec2(x + pad + inner - ImGui::CalcTextSize(percent).x, y + pad), PICTURE_DIM,
                  percent);
    float top = y + line + 2.0f * pad;
    float part = inner * (float)fmin(fmax(fraction, 0.0), 1.0);
    list->AddRectFilled(ImVec2(x + pad, top), ImVec2(x + pad + inner, top + bar),
                        IM_COL32(50, 53, 58, 255), bar * 0.5f);
    list->AddRectFilled(ImVec2(x + pad, top), ImVec2(x + pad + part, top + bar),
                        ImGui::GetColorU32(ImGuiCol_CheckMark), bar * 0.5f);
}
