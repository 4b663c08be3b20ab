// Bars and curves.
extern "C" {
#include "gui_state.h"
}

#include <cfloat>
#include <cmath>
#include <cstdio>
#include <imgui.h>
#include <initializer_list>

#define CURVES_POINTS 120.0f // height

static const ImU32 series_colors[] = {
    IM_COL32(168, 201, 84, 255), // the glow-worm's
    IM_COL32(104, 170, 224, 255),
    IM_COL32(226, 149, 92, 255),
    IM_COL32(190, 140, 220, 255),
};
#define SERIES_COLORS (sizeof series_colors / sizeof *series_colors)

void gui_bars(struct gui *gui, const struct gui_bar *bars, uint32_t count, const char *unit)
{
    const struct gui_state *own = gui->own;
    if (!own->is_drawn)
        return;
    double most = 0.0;
    float labels = own->label_width - ImGui::GetStyle().WindowPadding.x;
    for (uint32_t i = 0; i < count; i++) {
        most = fmax(most, bars[i].value);
        if (bars[i].label)
            labels = fmaxf(labels, ImGui::CalcTextSize(bars[i].label).x + 6.0f * own->scale);
    }
    ImDrawList *list = ImGui::GetWindowDrawList();
    const ImGuiStyle &style = ImGui::GetStyle();
    float line = ImGui::GetTextLineHeight(), height = floorf(line * 1.15f);
    for (uint32_t i = 0; i < count; i++) {
        ImVec2 at = ImGui::GetCursorScreenPos();
        float width = ImGui::GetContentRegionAvail().x;
        float number = ImGui::CalcTextSize("000.00 ms").x;
        float least = 16.0f * own->scale; // of the bar
        float left = at.x + fmaxf(fminf(labels, width - number - least), 0.0f);
        float room = fmaxf(at.x + width - number - left, 1.0f);
        if (!bars[i].label) {
            ImGui::Dummy(ImVec2(1.0f, height - style.ItemSpacing.y * 0.5f));
            continue;
        }
        char text[64];
        snprintf(text, sizeof text, "%.2f %s", bars[i].value, unit);
        list->PushClipRect(at, ImVec2(left - style.ItemInnerSpacing.x, at.y + height), true);
        list->AddText(at, ImGui::GetColorU32(ImGuiCol_Text), bars[i].label);
        list->PopClipRect();
        float part = most > 0.0 ? room * (float)(bars[i].value / most) : 0.0f;
        float top = floorf(at.y + 0.22f * line), bottom = floorf(at.y + 0.92f * line);
        list->AddRectFilled(ImVec2(left, top), ImVec2(left + room, bottom),
                            ImGui::GetColorU32(ImGuiCol_FrameBg), 2.0f);
        list->AddRectFilled(ImVec2(left, top), ImVec2(left + fmaxf(part, 1.0f), bottom),
                            IM_COL32(128, 152, 66, 255), 2.0f);
        list->AddText(ImVec2(at.x + width - ImGui::CalcTextSize(text).x, at.y),
                      ImGui::GetColorU32(ImGuiCol_Text), text);
        ImGui::Dummy(ImVec2(1.0f, height - style.ItemSpacing.y * 0.5f));
    }
}

// --- curves --------------------------------------------------------------------------------------

// Decades, and the rectangle that shows them.
struct axes {
    double x[2], y[2]; // log10
    ImVec2 min, max;
};

static bool is_good(double value)
{
    return value > 0.0 && std::isfinite(value);
}

static ImVec2 place(const struct axes *axes, double x, double y)
{
    double u = (log10(x) - axes->x[0]) / (axes->x[1] - axes->x[0]);
    double v = (log10(y) - axes->y[0]) / (axes->y[1] - axes->y[0]);
    return ImVec2(axes->min.x + (float)u * (axes->max.x - axes->min.x),
                  axes->max.y - (float)v * (axes->max.y - axes->min.y));
}

static void widen(double range[2], double value)
{
    range[0] = fmin(range[0], log10(value));
    range[1] = fmax(range[1], log10(value));
}

// False: there is no point to show.
static bool find_axes(const struct gui_curve *curves, uint32_t count, struct axes *out)
{
    out->x[0] = out->y[0] = DBL_MAX;
    out->x[1] = out->y[1] = -DBL_MAX;
    for (uint32_t i = 0; i < count; i++)
        for (uint32_t p = 0; p < curves[i].count; p++) {
            if (!is_good(curves[i].x[p]) || !is_good(curves[i].y[p]))
                continue;
            widen(out->x, curves[i].x[p]);
            widen(out->y, curves[i].y[p]);
            if (curves[i].low && is_good(curves[i].low[p]) && is_good(curves[i].high[p])) {
                widen(out->y, curves[i].low[p]);
                widen(out->y, curves[i].high[p]);
            }
        }
    if (out->x[0] > out->x[1])
        return false;
    // A bit of room around, and no less than half a decade.
    for (double *range : {out->x, out->y}) {
        double middle = 0.5 * (range[0] + range[1]);
        double half = fmax(0.5 * (range[1] - range[0]) * 1.06, 0.25);
        range[0] = middle - half;
        range[1] = middle + half;
    }
    return true;
}

// Values with lines of their own, ascending: 10^n, and where these are few 2 and 5 times them.
struct ticks {
    double values[64];
    uint32_t count;
};

static void find_ticks(const double range[2], struct ticks *out)
{
    static const double factors[] = {1.0, 2.0, 5.0};
    int each = range[1] - range[0] < 1.7 ? 3 : 1;
    out->count = 0;
    for (int d = (int)floor(range[0]); d <= (int)ceil(range[1]); d++)
        for (int f = 0; f < each && out->count < 64; f++) {
            double value = pow(10.0, d) * factors[f];
            if (log10(value) >= range[0] && log10(value) <= range[1])
                out->values[out->count++] = value;
        }
}

static void write_tick(double value, char *out, size_t size)
{
    if (value >= 0.00999 && value < 99999.0)
        snprintf(out, size, "%g", value);
    else
        snprintf(out, size, "%.0e", value);
}

// Labels that would touch the one before are left out.
static void draw_grid(ImDrawList *list, const struct axes *axes)
{
    ImU32 line = ImGui::GetColorU32(ImGuiCol_Separator);
    ImU32 letters = ImGui::GetColorU32(ImGuiCol_TextDisabled);
    float height = ImGui::GetTextLineHeight(), free_from = -FLT_MAX, free_below = FLT_MAX;
    struct ticks ticks;
    char text[32];
    find_ticks(axes->x, &ticks);
    for (uint32_t i = 0; i < ticks.count; i++) {
        float x = floorf(place(axes, ticks.values[i], pow(10.0, axes->y[0])).x);
        list->AddLine(ImVec2(x, axes->min.y), ImVec2(x, axes->max.y), line);
        write_tick(ticks.values[i], text, sizeof text);
        float width = ImGui::CalcTextSize(text).x;
        float left = fminf(floorf(x - 0.5f * width), axes->max.x - width);
        if (left < free_from)
            continue;
        list->AddText(ImVec2(left, axes->max.y + 1.0f), letters, text);
        free_from = left + width * 1.5f;
    }
    find_ticks(axes->y, &ticks);
    for (uint32_t i = 0; i < ticks.count; i++) {
        float y = floorf(place(axes, pow(10.0, axes->x[0]), ticks.values[i]).y);
        list->AddLine(ImVec2(axes->min.x, y), ImVec2(axes->max.x, y), line);
        if (y + 0.5f * height > free_below)
            continue;
        write_tick(ticks.values[i], text, sizeof text);
        list->AddText(ImVec2(axes->min.x - ImGui::CalcTextSize(text).x - 4.0f, y - 0.5f * height),
                      letters, text);
        free_below = y - 0.6f * height;
    }
}

static void draw_curve(ImDrawList *list, const struct axes *axes, const struct gui_curve *curve,
                       ImU32 color, float scale)
{
    ImVec2 last, last_low, last_high;
    bool has_last = false, has_band = false;
    ImU32 band = (color & ~IM_COL32_A_MASK) | (46u << IM_COL32_A_SHIFT);
    for (uint32_t p = 0; p < curve->count; p++) {
        if (!is_good(curve->x[p]) || !is_good(curve->y[p]))
            continue;
        ImVec2 at = place(axes, curve->x[p], curve->y[p]);
        bool is_band = curve->low && is_good(curve->low[p]) && is_good(curve->high[p]);
        if (is_band) {
            ImVec2 low = place(axes, curve->x[p], curve->low[p]);
            ImVec2 high = place(axes, curve->x[p], curve->high[p]);
            if (has_band)
                list->AddQuadFilled(last_high, high, low, last_low, band);
            last_low = low;
            last_high = high;
        }
        has_band = is_band;
        if (has_last)
            list->AddLine(last, at, color, 1.5f * scale);
        list->AddCircleFilled(at, 2.0f * scale, color);
        last = at;
        has_last = true;
    }
}

static void draw_legend(ImDrawList *list, const struct axes *axes, const struct gui_curve *curves,
                        uint32_t count, float scale)
{
    float line = ImGui::GetTextLineHeight(), y = axes->min.y + 2.0f * scale;
    for (uint32_t i = 0; i < count; i++) {
        if (!curves[i].label)
            continue;
        ImVec2 size = ImGui::CalcTextSize(curves[i].label);
        float x = axes->max.x - size.x - 4.0f * scale;
        list->AddRectFilled(ImVec2(x - 12.0f * scale, y + 0.3f * line),
                            ImVec2(x - 4.0f * scale, y + 0.7f * line),
                            series_colors[i % SERIES_COLORS], 2.0f);
        list->AddText(ImVec2(x, y), ImGui::GetColorU32(ImGuiCol_Text), curves[i].label);
        y += line;
    }
}

void gui_curves(struct gui *gui, const struct gui_curve *curves, uint32_t count,
                const char *x_label, const char *y_label)
{
    const struct gui_state *own = gui->own;
    if (!own->is_drawn)
        return;
    ImDrawList *list = ImGui::GetWindowDrawList();
    float line = ImGui::GetTextLineHeight();
    ImVec2 at = ImGui::GetCursorScreenPos();
    ImVec2 size(ImGui::GetContentRegionAvail().x, floorf(CURVES_POINTS * own->scale));
    struct axes axes;
    bool is_some = find_axes(curves, count, &axes);
    axes.min = ImVec2(at.x + ImGui::CalcTextSize("1e-00").x + 5.0f, at.y + line + 2.0f);
    axes.max = ImVec2(at.x + size.x - 1.0f, at.y + size.y - line - 2.0f);
    list->AddText(at, ImGui::GetColorU32(ImGuiCol_TextDisabled), y_label);
    list->AddText(ImVec2(axes.max.x - ImGui::CalcTextSize(x_label).x, at.y),
                  ImGui::GetColorU32(ImGuiCol_TextDisabled), x_label);
    list->AddRectFilled(axes.min, axes.max, ImGui::GetColorU32(ImGuiCol_PopupBg));
    if (is_some) {
        draw_grid(list, &axes);
        list->PushClipRect(axes.min, axes.max, true);
        for (uint32_t i = 0; i < count; i++)
            draw_curve(list, &axes, &curves[i], series_colors[i % SERIES_COLORS], own->scale);
        list->PopClipRect();
        if (count > 1)
            draw_legend(list, &axes, curves, count, own->scale);
    }
    ImGui::Dummy(size);
}
