// Shows the sources of the image's error while it accumulates, as --error-by of `render` does.
#include "viewer/panel/panel_internal.h"

#include <stdio.h>

static void shares(struct gui *gui, const struct error_sources *sources, enum error_kind kind)
{
    const struct error_by *by = &sources->by[kind];
    struct gui_bar bars[ERROR_BY_CLASSES_MAX];
    for (uint32_t i = 0; i < by->count; i++)
        bars[i] = (struct gui_bar){error_class_name(kind, i), 100.0 * by->classes[i].share.value};
    gui_bars(gui, bars, by->count, "%");
    gui_fact(gui, "  together", "%.1f %%", 100.0 * by->together.share.value);
}

static void brightest(struct gui *gui, const struct error_sources *sources)
{
    gui_line(gui, "Brightest contributions: pixel and sample; share of the error, emitter, number "
                  "of scattering events.");
    for (uint32_t i = 0; i < sources->brightest_count; i++) {
        const struct bright_path *path = &sources->brightest[i];
        char label[48];
        snprintf(label, sizeof label, "%u,%u #%u", path->x, path->y, path->sample);
        gui_fact(gui, label, "%.2g %%, %s, %u", 100.0 * path->share,
                 error_class_name(ERROR_BY_EMITTER, path->emitter), path->scattering_events);
    }
    gui_line(
        gui,
        "To follow one, save the scene and run lampyris render SAVED.json --pixel X,Y --sample N.");
}

static void contents(struct gui *gui, const struct view *view, enum error_kind kind)
{
    const struct error_sources *sources = &view->sources;
    if (view->look_count == 0 || !(sources->kinds & error_kind_aov(kind)))
        gui_line(gui, "Not known yet.");
    else if (sources->reason)
        gui_line(gui, "Not known: %s.", sources->reason);
    else if (!(sources->by[kind].error > 0.0))
        gui_line(gui, "There is no error.");
    else {
        shares(gui, sources, kind);
        brightest(gui, sources);
    }
}

void panel_error_by(struct panel *panel, const struct stage *stage)
{
    const char *words[ERROR_KIND_COUNT + 2] = {"off"}; // the list ends with NULL
    struct gui *gui = panel->gui;
    for (int kind = 0; kind < ERROR_KIND_COUNT; kind++)
        words[1 + kind] = error_kind_names[kind];
    gui_group_begin(gui, "statistics.error", "Where the error comes from",
                    "Shares of the error by kind of light, and the greatest contributions.", false);
    struct shown to = stage->shown;
    if (gui_choice(gui, "statistics.error_by", "Error by",
                   "Splits the error by emission, direct and indirect light, by the number of "
                   "scattering events, or by the kind of emitter. Restarts the picture.",
                   words, &to.error_by))
        edit_shown(panel->viewer, &to, "statistics.error_by");
    if (gui_is_drawn(gui) && to.error_by)
        contents(gui, &stage->sides[stage->edited_side], (enum error_kind)(to.error_by - 1));
    gui_group_end(gui);
}
