// Bar charts and curves.
#include "viewer/gui/gui_state.h"
#include "viewer/gui/imgui_bridge.h"

#include <float.h>
#include <math.h>
#include <stdio.h>

#define CURVES_POINTS 120.0f // height of a chart

static const uint32_t series_colors[] = {
    IM_GLOW,
    IM_RGBA(104, 170, 224, 255),
    IM_RGBA(226, 149, 92, 255),
    IM_RGBA(190, 140, 220, 255),
};
#define BAR_COLOR IM_RGBA(128, 152, 66, 255)
#define SERIES_COLORS (sizeof series_colors / sizeof *series_colors)

// Draws a bar. `labels` is the width of the column of labels, `most` the value of the longest bar.
static void draw_bar(const struct gui_state *own, const struct gui_bar *bar, const char *unit,
                     float labels, double most)
{
    struct ImDrawList *list = im_layer(IM_WINDOW);
    const struct im_place now = im_now();
    const struct im_vec at = now.cursor;
    float width = now.room, line = now.line, number = im_text_width("000.00 ms");
    float least = 16.0f * own->scale; // width that the bar has at least
    float left = at.x + fmaxf(fminf(labels, width - number - least), 0.0f);
    float room = fmaxf(at.x + width - number - left, 1.0f);
    char text[64];
    snprintf(text, sizeof text, "%.2f %s", bar->value, unit);
    const struct im_rect clip = {at.x, at.y, left - now.inner_spacing, at.y + floorf(line * 1.15f)};
    im_draw_text(list, at.x, at.y, IM_TEXT, bar->label, &clip, 0.0f);
    float part = most > 0.0 ? room * (float)(bar->value / most) : 0.0f;
    float top = floorf(at.y + 0.22f * line), bottom = floorf(at.y + 0.92f * line);
    im_draw_rect(list, (struct im_rect){left, top, left + room, bottom}, IM_FRAME, 2.0f);
    im_draw_rect(list, (struct im_rect){left, top, left + fmaxf(part, 1.0f), bottom}, BAR_COLOR,
                 2.0f);
    im_draw_text(list, at.x + width - im_text_width(text), at.y, IM_TEXT, text, NULL, 0.0f);
}

void gui_bars(struct gui *gui, const struct gui_bar *bars, uint32_t count, const char *unit)
{
    const struct gui_state *own = gui->own;
    if (!gui_is_drawn(gui))
        return;
    const struct im_place now = im_now();
    double most = 0.0;
    float labels = own->label_width - now.window_padding.x;
    for (uint32_t i = 0; i < count; i++) {
        most = fmax(most, bars[i].value);
        if (bars[i].label)
            labels = fmaxf(labels, im_text_width(bars[i].label) + 6.0f * own->scale);
    }
    float height = floorf(now.line * 1.15f);
    for (uint32_t i = 0; i < count; i++) {
        if (bars[i].label)
            draw_bar(own, &bars[i], unit, labels, most);
        im_dummy(1.0f, height - now.spacing.y * 0.5f);
    }
}

// --- curves --------------------------------------------------------------------------------------

// The ranges of the axes, in decades, and the rectangle in which the curves are drawn.
struct axes {
    double x[2], y[2]; // log10
    struct im_vec min, max;
};

static bool is_good(double value)
{
    return value > 0.0 && isfinite(value);
}

static struct im_vec place(const struct axes *axes, double x, double y)
{
    double u = (log10(x) - axes->x[0]) / (axes->x[1] - axes->x[0]);
    double v = (log10(y) - axes->y[0]) / (axes->y[1] - axes->y[0]);
    return (struct im_vec){axes->min.x + (float)u * (axes->max.x - axes->min.x),
                           axes->max.y - (float)v * (axes->max.y - axes->min.y)};
}

static void widen(double range[2], double value)
{
    range[0] = fmin(range[0], log10(value));
    range[1] = fmax(range[1], log10(value));
}

// Adds a margin to a range, and makes it at least half a decade.
static void make_room(double range[2])
{
    double middle = 0.5 * (range[0] + range[1]);
    double half = fmax(0.5 * (range[1] - range[0]) * 1.06, 0.25);
    range[0] = middle - half;
    range[1] = middle + half;
}

static bool has_bound(const struct gui_curve *curve, uint32_t point)
{
    return curve->most && is_good(curve->most[point]);
}

// Computes the axes. Returns false if there is no point to show.
static bool find_axes(const struct gui_curve *curves, uint32_t count, struct axes *out)
{
    out->x[0] = out->y[0] = DBL_MAX;
    out->x[1] = out->y[1] = -DBL_MAX;
    for (uint32_t i = 0; i < count; i++)
        for (uint32_t p = 0; p < curves[i].count; p++) {
            bool is_bound = !is_good(curves[i].y[p]) && has_bound(&curves[i], p);
            double y = is_bound ? curves[i].most[p] : curves[i].y[p];
            if (!is_good(curves[i].x[p]) || !is_good(y))
                continue;
            widen(out->x, curves[i].x[p]);
            widen(out->y, y);
            if (curves[i].low && is_good(curves[i].low[p]) && is_good(curves[i].high[p])) {
                widen(out->y, curves[i].low[p]);
                widen(out->y, curves[i].high[p]);
            }
        }
    if (out->x[0] > out->x[1])
        return false;
    make_room(out->x);
    make_room(out->y);
    return true;
}

// Positions of grid lines in ascending order: powers of ten, and 2 and 5 times these if there are
// few.
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

// Draws the vertical grid lines. Labels that would touch the previous one are omitted.
static void draw_columns(struct ImDrawList *list, const struct axes *axes)
{
    struct ticks ticks;
    find_ticks(axes->x, &ticks);
    float free_from = -FLT_MAX;
    for (uint32_t i = 0; i < ticks.count; i++) {
        float x = floorf(place(axes, ticks.values[i], pow(10.0, axes->y[0])).x);
        im_draw_line(list, (struct im_vec){x, axes->min.y}, (struct im_vec){x, axes->max.y},
                     IM_LINE, 1.0f);
        char text[32];
        write_tick(ticks.values[i], text, sizeof text);
        float width = im_text_width(text);
        float left = fminf(floorf(x - 0.5f * width), axes->max.x - width);
        if (left < free_from)
            continue;
        im_draw_text(list, left, axes->max.y + 1.0f, IM_DIM, text, NULL, 0.0f);
        free_from = left + width * 1.5f;
    }
}

static void draw_rows(struct ImDrawList *list, const struct axes *axes)
{
    struct ticks ticks;
    find_ticks(axes->y, &ticks);
    float height = im_now().line, free_below = FLT_MAX;
    for (uint32_t i = 0; i < ticks.count; i++) {
        float y = floorf(place(axes, pow(10.0, axes->x[0]), ticks.values[i]).y);
        im_draw_line(list, (struct im_vec){axes->min.x, y}, (struct im_vec){axes->max.x, y},
                     IM_LINE, 1.0f);
        if (y + 0.5f * height > free_below)
            continue;
        char text[32];
        write_tick(ticks.values[i], text, sizeof text);
        im_draw_text(list, axes->min.x - im_text_width(text) - 4.0f, y - 0.5f * height, IM_DIM,
                     text, NULL, 0.0f);
        free_below = y - 0.6f * height;
    }
}

// Draws a downward arrow, which shows that the value is somewhere below the bound.
static void draw_bound(struct ImDrawList *list, struct im_vec at, uint32_t color, float scale)
{
    const float length = 8.0f * scale, barb = 3.0f * scale, width = 1.5f * scale;
    const struct im_vec tip = {at.x, at.y + length};
    im_draw_line(list, (struct im_vec){at.x - barb, at.y}, (struct im_vec){at.x + barb, at.y},
                 color, width);
    im_draw_line(list, at, tip, color, width);
    im_draw_line(list, (struct im_vec){tip.x - barb, tip.y - barb}, tip, color, width);
    im_draw_line(list, (struct im_vec){tip.x + barb, tip.y - barb}, tip, color, width);
}

static void draw_curve(struct ImDrawList *list, const struct axes *axes,
                       const struct gui_curve *curve, uint32_t color, float scale)
{
    struct im_vec last = {0}, last_low = {0}, last_high = {0};
    bool has_last = false, has_band = false;
    // The same colour with an alpha of 46/255.
    const uint32_t band = (color & 0xffffffu) | 46u << 24;
    for (uint32_t p = 0; p < curve->count; p++) {
        if (is_good(curve->x[p]) && !is_good(curve->y[p]) && has_bound(curve, p))
            draw_bound(list, place(axes, curve->x[p], curve->most[p]), color, scale);
        if (!is_good(curve->x[p]) || !is_good(curve->y[p]))
            continue;
        const struct im_vec at = place(axes, curve->x[p], curve->y[p]);
        bool is_band = curve->low && is_good(curve->low[p]) && is_good(curve->high[p]);
        if (is_band) {
            const struct im_vec low = place(axes, curve->x[p], curve->low[p]);
            const struct im_vec high = place(axes, curve->x[p], curve->high[p]);
            if (has_band)
                im_draw_quad(list, (const struct im_vec[4]){last_high, high, low, last_low}, band);
            last_low = low;
            last_high = high;
        }
        has_band = is_band;
        if (has_last)
            im_draw_line(list, last, at, color, 1.5f * scale);
        im_draw_circle(list, at, 2.0f * scale, color);
        last = at;
        has_last = true;
    }
}

static void draw_legend(struct ImDrawList *list, const struct axes *axes,
                        const struct gui_curve *curves, uint32_t count, float scale)
{
    float line = im_now().line, y = axes->min.y + 2.0f * scale;
    for (uint32_t i = 0; i < count; i++) {
        if (!curves[i].label)
            continue;
        float x = axes->max.x - im_text_width(curves[i].label) - 4.0f * scale;
        const struct im_rect sign = {x - 12.0f * scale, y + 0.3f * line, x - 4.0f * scale,
                                     y + 0.7f * line};
        im_draw_rect(list, sign, series_colors[i % SERIES_COLORS], 2.0f);
        im_draw_text(list, x, y, IM_TEXT, curves[i].label, NULL, 0.0f);
        y += line;
    }
}

void gui_curves(struct gui *gui, const struct gui_curve *curves, uint32_t count,
                const char *x_label, const char *y_label)
{
    const struct gui_state *own = gui->own;
    if (!gui_is_drawn(gui))
        return;
    struct ImDrawList *list = im_layer(IM_WINDOW);
    const struct im_place now = im_now();
    const struct im_vec at = now.cursor, size = {now.room, floorf(CURVES_POINTS * own->scale)};
    const float line = now.line;
    struct axes axes;
    bool is_some = find_axes(curves, count, &axes);
    axes.min = (struct im_vec){at.x + im_text_width("1e-00") + 5.0f, at.y + line + 2.0f};
    axes.max = (struct im_vec){at.x + size.x - 1.0f, at.y + size.y - line - 2.0f};
    im_draw_text(list, at.x, at.y, IM_DIM, y_label, NULL, 0.0f);
    im_draw_text(list, axes.max.x - im_text_width(x_label), at.y, IM_DIM, x_label, NULL, 0.0f);
    const struct im_rect box = {axes.min.x, axes.min.y, axes.max.x, axes.max.y};
    im_draw_rect(list, box, IM_POPUP, 0.0f);
    if (is_some) {
        draw_columns(list, &axes);
        draw_rows(list, &axes);
        im_clip_begin(list, box);
        for (uint32_t i = 0; i < count; i++)
            draw_curve(list, &axes, &curves[i], series_colors[i % SERIES_COLORS], own->scale);
        im_clip_end(list);
        if (count > 1)
            draw_legend(list, &axes, curves, count, own->scale);
    }
    im_dummy(size.x, size.y);
}
