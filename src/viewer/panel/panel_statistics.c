// Shows statistics of the accumulating image.
#include "viewer/panel/panel_internal.h"

#include "base/memory.h"
#include "job/film_error.h"
#include "render/parts.h"
#include <math.h>
#include <stdio.h>
#include <string.h>

static const char *const side_names[] = {"A", "B", NULL};

// Formats a number such as "1.23 M".
static const char *short_number(struct panel *panel, double value)
{
    static const char *const letters[] = {"", " k", " M", " G", " T"};
    int i = 0;
    while (value >= 1e3 && i < 4) {
        value /= 1e3;
        i++;
    }
    const char *text = arena_printf(panel->frame_arena, "%.4g%s", value, letters[i]);
    return text ? text : "";
}

static const char *time_text(struct panel *panel, double seconds)
{
    const char *text = NULL;
    if (seconds < 100.0)
        text = arena_printf(panel->frame_arena, "%.4g s", seconds);
    else if (seconds < 6000.0)
        text = arena_printf(panel->frame_arena, "%.4g min", seconds / 60.0);
    else
        text = arena_printf(panel->frame_arena, "%.4g h", seconds / 3600.0);
    return text ? text : "";
}

// --- time ----------------------------------------------------------------------------------------

static void frame_bars(struct panel *panel, const struct stage *stage)
{
    const struct frame_stats *stats = &stage->stats;
    const struct gui_bar bars[] = {
        {"Render", stats->render_ms},   {"Denoise", stats->denoise_ms},
        {"Display", stats->display_ms}, {"Panel", stats->panel_ms},
        {"Present", stats->present_ms},
    };
    gui_bars(panel->gui, bars, sizeof bars / sizeof *bars, "ms");
}

// Least number of rows, so that the layout does not change when the number of kernels does.
#define KERNEL_ROWS 8u

// Draws a bar for each kernel in use, in the order in which they run.
static void kernel_bars(struct panel *panel, const struct stage *stage)
{
    struct gui_bar bars[KERNEL_COUNT + KERNEL_ROWS] = {0};
    uint32_t count = 0;
    for (int id = 0; id < KERNEL_COUNT; id++) {
        bool is_there = false;
        for (uint32_t side = 0; side < stage->side_count; side++)
            is_there = is_there || stage->sides[side].job.renderer.kernels[id].pipeline;
        if (is_there)
            bars[count++] = (struct gui_bar){kernel_code((enum kernel_id)id, true).name,
                                             stage->stats.kernel_ms[id]};
    }
    gui_bars(panel->gui, bars, count < KERNEL_ROWS ? KERNEL_ROWS : count, "ms");
}

// --- error ---------------------------------------------------------------------------------------

// Shows the time at which the error should reach the next lower power of ten. The error of
// independent samples is inversely proportional to their number, and so to the time.
static void forecast_line(struct panel *panel, const struct job_look *look)
{
    struct gui *gui = panel->gui;
    double error = look->error.local_relmse;
    if (!look->error.known || !(look->seconds > 0.0) || !(error > 0.0)) {
        gui_fact(gui, "  forecast", "-");
        return;
    }
    double target = pow(10.0, ceil(log10(error)) - 1.0);
    gui_fact(gui, "  forecast", "%.0e at ~%s", target,
             time_text(panel, look->seconds * error / target));
}

// Draws the error, always in three lines, so that the layout does not change.
static void error_lines(struct panel *panel, const struct stage *stage, uint32_t side)
{
    struct gui *gui = panel->gui;
    const char *label = stage->side_count > 1 ? side ? "Error B" : "Error A" : "Error";
    const struct job_look look = view_newest_look(&stage->sides[side]);
    const struct half_error *error = &look.error;
    if (error->known)
        gui_fact(gui, label, "local relMSE %.4g", error->local_relmse);
    else if (error->bounded)
        gui_fact(gui, label, "local relMSE at most %.4g", error->at_most);
    else if (film_error_is_plain(error))
        gui_fact(gui, label, "local relMSE about %.4g", error->local_relmse);
    else
        gui_fact(gui, label, "not known yet");
    if (error->known)
        gui_fact(gui, "  95 %", "%.4g to %.4g", error->ci_low, error->ci_high);
    else
        gui_fact(gui, error->bounded ? "  in 95 %, since" : "  since", "%s", error->reason);
    forecast_line(panel, &look);
}

struct points {
    double x[VIEW_LOOKS_MAX], y[VIEW_LOOKS_MAX], low[VIEW_LOOKS_MAX], high[VIEW_LOOKS_MAX],
        most[VIEW_LOOKS_MAX];
};

static struct gui_curve curve_of(const struct view *view, const char *label, struct points *points)
{
    for (uint32_t i = 0; i < view->look_count; i++) {
        const struct half_error *error = &view->looks[i].error;
        points->x[i] = view->looks[i].seconds;
        points->y[i] = error->local_relmse;
        points->low[i] = error->ci_low;
        points->high[i] = error->ci_high;
        points->most[i] = error->at_most;
    }
    return (struct gui_curve){.label = label,
                              .x = points->x,
                              .y = points->y,
                              .low = points->low,
                              .high = points->high,
                              .most = points->most,
                              .count = view->look_count};
}

static void error_curves(struct panel *panel, const struct stage *stage)
{
    struct points points[VIEWER_SIDES];
    struct gui_curve curves[VIEWER_SIDES];
    for (uint32_t side = 0; side < stage->side_count; side++)
        curves[side] = curve_of(&stage->sides[side], side_names[side], &points[side]);
    gui_curves(panel->gui, curves, stage->side_count, "seconds", "local relMSE");
}

// --- parts that were left out --------------------------------------------------------------------

struct left_out {
    struct arena *arena;
    const char *kind; // kind of the parts that are being listed
    const char *text;
    struct gui *gui;
    uint64_t bytes;
};

static void flush(struct left_out *list)
{
    if (list->kind)
        gui_pair(list->gui, list->kind, "%s", list->text ? list->text : "");
    list->kind = NULL;
    list->text = NULL;
}

static void add_left_out(void *context, const struct part *part)
{
    struct left_out *list = context;
    const char *kind = part_kind_name(part->kind);
    if (part->is_kept)
        return;
    if (!list->kind || strcmp(list->kind, kind) != 0)
        flush(list);
    list->kind = kind;
    list->bytes += part->bytes;
    list->text =
        list->text ? arena_printf(list->arena, "%s, %s", list->text, part->name) : part->name;
}

static void left_out(struct panel *panel, const struct stage *stage)
{
    struct gui *gui = panel->gui;
    gui_group_begin(gui, "statistics.left_out", "Left out",
                    "The features, lobes and kernels that this scene and these settings do not "
                    "need and that were left out.",
                    false);
    const struct view *view = &stage->sides[stage->edited_side];
    if (gui_is_drawn(gui) && view->is_ready) {
        struct left_out list = {.arena = panel->frame_arena, .gui = gui};
        parts_visit(&view->job.renderer, add_left_out, &list);
        flush(&list);
        gui_pair(gui, "saved", "%sB", short_number(panel, (double)list.bytes));
    }
    gui_group_end(gui);
}

// --- the whole group -----------------------------------------------------------------------------

static void memory(struct panel *panel, const struct document *document, const struct stage *stage)
{
    struct gui *gui = panel->gui;
    gui_group_begin(gui, "statistics.memory", "Memory",
                    "The memory that the renderer uses on the device and that the program uses.",
                    false);
    if (gui_is_drawn(gui)) {
        gui_fact(gui, "Device", "%sB (peak: %sB)",
                 short_number(panel, (double)stage->gpu.allocated_bytes),
                 short_number(panel, (double)stage->gpu.peak_bytes));
        gui_fact(gui, "Program", "%sB at most", short_number(panel, (double)memory_peak()));
        gui_fact(gui, "Triangles", "%s",
                 short_number(panel, (double)document->geometry.flat.triangle_count));
    }
    gui_group_end(gui);
}

static void side_lines(struct panel *panel, const struct stage *stage, uint32_t side)
{
    const struct view *view = &stage->sides[side];
    const char *label = stage->side_count > 1 ? side ? "Per pixel B" : "Per pixel A" : "Per pixel";
    gui_fact(panel->gui, label, "%llu samples in %s%s", (unsigned long long)view_samples(view),
             time_text(panel, view->seconds), view->is_preview ? ", preview" : "");
}

void panel_statistics(struct panel *panel, const struct document *document,
                      const struct stage *stage)
{
    struct gui *gui = panel->gui;
    const struct frame_stats *stats = &stage->stats;
    gui_group_begin(gui, "statistics", "Statistics", "The speed and the error of the picture.",
                    true);
    if (gui_is_drawn(gui) && document->has_scene) {
        gui_fact(gui, "Frames", "%.4g /s, %.4g ms each", stats->fps, stats->frame_ms);
        for (uint32_t side = 0; side < stage->side_count; side++)
            side_lines(panel, stage, side);
        gui_fact(gui, "Rays", "%s/s", short_number(panel, stats->rays_per_second));
        gui_fact(gui, "Samples", "%s/s, over all pixels",
                 short_number(panel, stats->samples_per_second));
        for (uint32_t side = 0; side < stage->side_count; side++)
            error_lines(panel, stage, side);
        error_curves(panel, stage);
    }
    panel_error_by(panel, stage);
    gui_group_begin(gui, "statistics.frame", "Frame", "How the time of the last frame was spent.",
                    true);
    if (gui_is_drawn(gui))
        frame_bars(panel, stage);
    gui_group_end(gui);
    gui_group_begin(gui, "statistics.kernels", "Kernels",
                    "Time of each kernel per frame on the device.", true);
    if (gui_is_drawn(gui))
        kernel_bars(panel, stage);
    gui_group_end(gui);
    left_out(panel, stage);
    memory(panel, document, stage);
    gui_group_end(gui);
}
