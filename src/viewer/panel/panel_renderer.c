// The rendering method and the display settings of a side.
#include "viewer/panel/panel_internal.h"

#include <string.h>

static const char *const side_names[] = {"A", "B", NULL};

static const struct gui_range samples_a_frame = {0, 4096, .logarithmic = true, .integer = true,
                                                 .least = "as time allows"};
static const struct gui_range spp = {1,
                                     (double)SETTINGS_SPP_MAX + 1,
                                     .logarithmic = true,
                                     .integer = true,
                                     .infinite = "unlimited",
                                     .greatest = (double)SETTINGS_SPP_MAX};

// --- the method ----------------------------------------------------------------------------------

static void accumulation(struct panel *panel, const struct stage *stage, struct method *to)
{
    struct gui *gui = panel->gui;
    static const char *const words[] = {"accumulate", "fresh frames", NULL};
    uint32_t fresh = to->fresh_frames;
    if (gui_choice(
            gui, "renderer.accumulation", "Frames",
            "Accumulates the samples of all frames, or makes each frame a picture of its own.",
            words, &fresh))
        to->fresh_frames = fresh;
    gui_count(gui, "renderer.samples_a_frame", "Per frame",
              "Samples per pixel and frame; 0: as many as the frame time permits.",
              &samples_a_frame, &to->samples_a_frame);
    const char *used = gui->used; // the limit is not a part of the method
    struct shown shown = stage->shown;
    double most = shown.spp_limit ? (double)shown.spp_limit : spp.max;
    if (gui_number(gui, "renderer.spp", "Samples",
                   "Samples per pixel at which rendering stops, on both sides.", &spp, &most)) {
        shown.spp_limit = most < spp.max ? (uint32_t)most : 0;
        edit_shown(panel->viewer, &shown, "renderer.spp");
    }
    gui->used = used;
}

// Draws a choice between the powers of two that the device supports; 0 is its default.
static void workgroup(const struct stage *stage, struct gui *gui, struct method *to)
{
    static const char *const words[] = {"device's", "8",   "16",  "32",   "64",
                                        "128",      "256", "512", "1024", NULL};
    const char *names[sizeof words / sizeof *words] = {words[0]};
    uint32_t chosen = 0, count = 1;
    for (uint32_t size = 8; words[count] && size <= stage->gpu.max_invocations; size *= 2) {
        if (to->workgroup == size)
            chosen = count;
        names[count] = words[count];
        count++;
    }
    if (gui_choice(gui, "renderer.workgroup", "Workgroup",
                   "Threads per workgroup; affects the speed but no bit of the picture.", names,
                   &chosen))
        to->workgroup = chosen ? 4u << chosen : 0;
}

static void device(const struct stage *stage, struct gui *gui, struct method *to)
{
    static const struct gui_range wave = {0, 16777216, .logarithmic = true, .integer = true,
                                          .least = "device's"};
    static const char *const features[] = {"needed", "all", NULL};
    static const char *const classes[] = {"separate", "merged", NULL};
    uint32_t everything = to->compile_all, merged = to->merge_classes;
    if (gui_count(
            gui, "renderer.wave", "Wave",
            "Paths in flight, at least 64; affects memory and speed but no bit of the picture.",
            &wave, &to->wave) &&
        to->wave > 0 && to->wave < 64)
        to->wave = 64;
    workgroup(stage, gui, to);
    if (gui_choice(gui, "renderer.features", "Features",
                   "Features that kernels are compiled with: those that the scene needs, or all, "
                   "to compare speeds.",
                   features, &everything))
        to->compile_all = everything;
    if (gui_choice(gui, "renderer.classes", "Classes",
                   "Uses a kernel for each class of materials, or a single kernel for all classes.",
                   classes, &merged))
        to->merge_classes = merged;
}

// Draws a switch that applies to all materials: off makes anisotropic materials isotropic, on
// restores the values of the file.
static void anisotropy(struct panel *panel, const struct document *document)
{
    struct gui *gui = panel->gui;
    const char *const id = "renderer.anisotropy", *used = gui->used;
    const struct scene *scene = &document->scene;
    const struct scene *before = &document->pristine;
    bool is_on = false, can = false;
    for (uint32_t i = 0; i < scene->material_count; i++)
        is_on = is_on || scene->materials[i].anisotropic > 0.0f;
    for (uint32_t i = 0; i < before->material_count; i++)
        can = can || before->materials[i].anisotropic > 0.0f;
    gui_applies(gui, can || is_on);
    bool is_changed = gui_switch(
        gui, id, "Anisotropy",
        "Off: all materials are isotropic; on: they have the anisotropy of the file.", &is_on);
    gui_enabled(gui, true);
    gui->used = used;
    if (!is_changed)
        return;
    edit_begin_group(panel->viewer);
    for (uint32_t i = 0; i < scene->material_count; i++) {
        struct material to = scene->materials[i];
        // True if the material was in the file. Its value is then restored; the values of added
        // materials become zero.
        bool was = is_on && i < before->material_count;
        to.anisotropic = was ? before->materials[i].anisotropic : 0.0f;
        edit_material(panel->viewer, i, &to, id);
    }
    edit_end_group(panel->viewer);
}

void panel_renderer(struct panel *panel, const struct document *document, struct stage *stage)
{
    struct gui *gui = panel->gui;
    gui_group_begin(gui, "renderer", "Renderer", "The settings with which the picture is rendered.",
                    true);
    gui_applies(gui, stage->side_count > 1);
    gui_choice(gui, "renderer.side", "Side",
               "The side whose settings are shown: A at the left, B at the right of a split view.",
               side_names, &stage->edited_side);
    gui_enabled(gui, true);
    uint32_t side = stage->edited_side;
    struct method to = stage->sides[side].method;
    gui->used = NULL;
    accumulation(panel, stage, &to);
    panel_settings(panel, document, &to.settings);
    anisotropy(panel, document);
    gui_space(gui);
    device(stage, gui, &to);
    if (gui->used)
        edit_method(panel->viewer, side, &to, gui->used);
    gui_group_end(gui);
}

// --- display settings ----------------------------------------------------------------------------

static void picture(const struct stage *stage, struct gui *gui, struct shown *to)
{
    static const struct gui_range exposure = {-SETTINGS_EXPOSURE_MAX, SETTINGS_EXPOSURE_MAX,
                                              .unit = "stops", .drag = 10};
    bool is_light = to->what == SHOWN_RADIANCE || to->what == SHOWN_EMISSION ||
                    to->what == SHOWN_DIRECT || to->what == SHOWN_INDIRECT;
    bool has_range = shown_has_range(to->what);
    gui_choice(gui, "view.aov", "Shown",
               "The layer to display: radiance, properties of surfaces, or the cost of each pixel.",
               shown_names, &to->what);
    gui_applies(gui, is_light);
    gui_float(gui, "view.exposure", "Exposure", "Exposure in stops; it affects only the display.",
              &exposure, &to->exposure);
    gui_flag(gui, "view.exposure_auto", "Find exposure",
             "Computes the exposure from the picture's luminance when a scene is opened or its "
             "environment changes, see docs/output.md.",
             &to->exposure_is_auto);
    gui_choice(gui, "view.tone", "Tone curve",
               "The tone curve, from linear radiance to display values.", tone_names, &to->tone);
    const struct gui_range values = {-1e30, 1e30, .unit = shown_unit(to->what)};
    gui_applies(gui, has_range);
    bool is_switched = gui_flag(
        gui, "view.automatic", "Find range",
        "Chooses the range of false colours from the least and greatest values in the picture.",
        &to->automatic);
    if (is_switched && !to->automatic && !(to->range[1] > to->range[0]))
        memcpy(to->range, stage->display.range, sizeof to->range);
    gui_applies(gui, has_range && !to->automatic);
    gui_number(gui, "view.range_low", "  from",
               "Value of the first false colour, in the unit that is shown.", &values,
               &to->range[0]);
    gui_number(gui, "view.range_high", "  to",
               "Value of the last false colour; if it is not above the first one, the range is "
               "computed from the picture.",
               &values, &to->range[1]);
    gui_enabled(gui, true);
    if (gui_is_drawn(gui) && has_range)
        gui_pair(gui, "  in use", "%.4g to %.4g %s", stage->display.range[0],
                 stage->display.range[1], shown_unit(to->what));
    gui_flag(gui, "view.nearest", "Show pixels",
             "Shows the pixels of a smaller picture as squares, without interpolation.",
             &to->nearest);
}

static void denoising(struct gui *gui, struct shown *to)
{
    static const struct gui_range iterations = {1, 5, .integer = true};
    gui_applies(gui, to->what == SHOWN_RADIANCE);
    gui_flag(gui, "view.denoise", "Denoise",
             "Shows a denoised preview (SVGF). It is biased; saved EXRs have the film.",
             &to->denoise);
    gui_applies(gui, to->what == SHOWN_RADIANCE && to->denoise);
    gui_flag(gui, "view.denoise_temporal", "  temporal",
             "Reuses earlier pictures, reprojected where the camera or objects have moved.",
             &to->denoise_temporal);
    gui_count(gui, "view.denoise_iterations", "  passes", "Iterations of the wavelet filter.",
              &iterations, &to->denoise_iterations);
    gui_enabled(gui, true);
}

static void split(struct panel *panel, const struct stage *stage, struct shown *to)
{
    struct gui *gui = panel->gui;
    gui_flag(gui, "view.split", "Split view",
             "Shows the scene with two settings side by side, each with its error.", &to->split);
    gui_applies(gui, to->split);
    gui_number(gui, "view.split_at", "  line at", "Fraction of the width that side A has.",
               &panel_unit, &to->split_at);
    bool swap =
        gui_button(gui, "view.swap", "Swap A and B", "Exchanges the settings of the two sides.");
    gui_enabled(gui, true);
    if (swap) {
        struct method a = stage->sides[0].method, b = stage->sides[1].method;
        edit_method(panel->viewer, 0, &b, "view.swap");
        edit_method(panel->viewer, 1, &a, "view.swap");
    }
}

// Draws settings of the viewer itself, which can neither be undone nor saved.
static void pace(struct panel *panel, struct stage *stage, struct viewpoint *view)
{
    static const struct gui_range target = {1, 1000, .logarithmic = true, .unit = "ms"};
    struct gui *gui = panel->gui;
    gui_number(gui, "view.frame_ms", "Frame time", "Target time of a frame, in milliseconds.",
               &target, &view->pace.target_ms);
    gui_applies(gui, stage->swapchain.handle != VK_NULL_HANDLE);
    gui_switch(gui, "view.vsync", "Vsync", "Synchronises frames with the display.",
               &stage->swapchain.vsync);
    gui_enabled(gui, true);
    gui_switch(gui, "view.undocked", "Undock panel",
               "Makes the panel a window over the picture, which can be moved by its bar and "
               "resized by its corner.",
               &gui->is_floating);
    gui_switch(gui, "view.pause", "Pause", "Pauses rendering; all other work continues.",
               &stage->is_paused);
}

void panel_view(struct panel *panel, struct stage *stage, struct viewpoint *view)
{
    struct gui *gui = panel->gui;
    gui_group_begin(gui, "view", "View", "The display of the picture.", true);
    struct shown to = stage->shown;
    gui->used = NULL;
    picture(stage, gui, &to);
    gui_space(gui);
    split(panel, stage, &to);
    gui_space(gui);
    denoising(gui, &to);
    if (gui->used)
        edit_shown(panel->viewer, &to, gui->used);
    gui_space(gui);
    pace(panel, stage, view);
    gui_group_end(gui);
}
