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
    if (gui_choice(gui, "renderer.accumulation", "Frames",
                   "Whether samples of all frames add up, or each frame is a picture of its own.",
                   words, &fresh))
        to->fresh_frames = fresh;
    gui_count(gui, "renderer.samples_a_frame", "Per frame",
              "Samples of every pixel in a frame; 0: as many as the time allows.", &samples_a_frame,
              &to->samples_a_frame);
    const char *used = gui->used; // the limit is not a part of the method
    struct shown shown = stage->shown;
    double most = shown.spp_limit ? (double)shown.spp_limit : spp.max;
    if (gui_number(gui, "renderer.spp", "Samples",
                   "Samples of a pixel after which the picture rests, of all sides.", &spp,
                   &most)) {
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
                   "Threads of a workgroup: changes speed, and no bit of the picture.", names,
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
    if (gui_count(gui, "renderer.wave", "Wave",
                  "Paths in flight, at least 64: changes memory and speed, and no bit of the "
                  "picture.",
                  &wave, &to->wave) &&
        to->wave > 0 && to->wave < 64)
        to->wave = 64;
    workgroup(stage, gui, to);
    if (gui_choice(gui, "renderer.features", "Features",
                   "What kernels can do: what the scene needs, or everything, to compare speeds.",
                   features, &everything))
        to->compile_all = everything;
    if (gui_choice(gui, "renderer.classes", "Classes",
                   "A kernel for each class of surfaces, or one for all of them.", classes,
                   &merged))
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
    gui_enabled(gui, can || is_on);
    bool is_changed =
        gui_switch(gui, id, "Anisotropy",
                   "Off: all materials are isotropic; on: as anisotropic as in the file.", &is_on);
    gui_enabled(gui, true);
    gui->used = used;
    if (!is_changed)
        return;
    edit_begin_group(panel->viewer);
    for (uint32_t i = 0; i < scene->material_count; i++) {
        struct material to = scene->materials[i];
        // The material was in the file; otherwise it was added.
        bool was = is_on && i < before->material_count;
        to.anisotropic = was ? before->materials[i].anisotropic : 0.0f;
        edit_material(panel->viewer, i, &to, id);
    }
    edit_end_group(panel->viewer);
}

void panel_renderer(struct panel *panel, const struct document *document, struct stage *stage)
{
    struct gui *gui = panel->gui;
    gui_group_begin(gui, "renderer", "Renderer", "How the picture is made.", false);
    gui_enabled(gui, stage->side_count > 1);
    gui_choice(gui, "renderer.side", "Side",
               "Whose settings these are: A at the left, B at the right of the split view.",
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
               "The picture, or what surfaces are, or how hard each pixel was.", shown_names,
               &to->what);
    gui_enabled(gui, is_light);
    gui_float(gui, "view.exposure", "Exposure",
              "Stops that the picture is brightened; what is accumulated stays.", &exposure,
              &to->exposure);
    gui_flag(gui, "view.exposure_auto", "Find exposure",
             "Found from the picture's luminances when a scene is opened or its surroundings "
             "change, see docs/output.md.",
             &to->exposure_is_auto);
    gui_choice(gui, "view.tone", "Tone curve", "How light becomes what a screen shows.", tone_names,
               &to->tone);
    const struct gui_range values = {-1e30, 1e30, .unit = shown_unit(to->what)};
    gui_enabled(gui, has_range);
    bool is_switched =
        gui_flag(gui, "view.automatic", "Find range",
                 "False colours reach from the lowest to the highest of the picture's values.",
                 &to->automatic);
    if (is_switched && !to->automatic && !(to->range[1] > to->range[0]))
        memcpy(to->range, stage->display.range, sizeof to->range);
    gui_enabled(gui, has_range && !to->automatic);
    gui_number(gui, "view.range_low", "  from",
               "What the first false colour stands for, in the unit that is shown.", &values,
               &to->range[0]);
    gui_number(gui, "view.range_high", "  to",
               "What the last one stands for; not above the first: found from the picture.",
               &values, &to->range[1]);
    gui_enabled(gui, true);
    if (gui_is_drawn(gui) && has_range)
        gui_pair(gui, "  in use", "%.4g to %.4g %s", stage->display.range[0],
                 stage->display.range[1], shown_unit(to->what));
    gui_flag(gui, "view.nearest", "Show pixels",
             "Pixels of a smaller picture as squares, not interpolated.", &to->nearest);
}

static void denoising(struct gui *gui, struct shown *to)
{
    static const struct gui_range iterations = {1, 5, .integer = true};
    gui_enabled(gui, to->what == SHOWN_RADIANCE);
    gui_flag(gui, "view.denoise", "Denoise",
             "A preview without noise, by SVGF's filter. It biases; saved EXRs keep the film.",
             &to->denoise);
    gui_enabled(gui, to->what == SHOWN_RADIANCE && to->denoise);
    gui_flag(gui, "view.denoise_temporal", "  temporal",
             "Takes earlier pictures along where the camera or objects moved.",
             &to->denoise_temporal);
    gui_count(gui, "view.denoise_iterations", "  passes", "Of the wavelet.", &iterations,
              &to->denoise_iterations);
    gui_enabled(gui, true);
}

static void split(struct panel *panel, const struct stage *stage, struct shown *to)
{
    struct gui *gui = panel->gui;
    gui_flag(gui, "view.split", "Split view",
             "Two settings side by side over one scene, each with its error.", &to->split);
    gui_enabled(gui, to->split);
    gui_number(gui, "view.split_at", "  line at", "Part of the width that is side A's.",
               &panel_unit, &to->split_at);
    bool swap =
        gui_button(gui, "view.swap", "Swap A and B", "Each side gets the other's settings.");
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
    gui_number(gui, "view.frame_ms", "Frame time", "Aim of a frame's time, milliseconds.", &target,
               &view->pace.target_ms);
    gui_enabled(gui, stage->swapchain.handle != VK_NULL_HANDLE);
    gui_switch(gui, "view.vsync", "Vsync", "Frames wait for the display.", &stage->swapchain.vsync);
    gui_enabled(gui, true);
    gui_switch(gui, "view.undocked", "Undock panel",
               "The panel is a window over the picture, moved by its bar and sized by its corner.",
               &gui->is_floating);
    gui_switch(gui, "view.pause", "Pause", "The picture rests; all else goes on.",
               &stage->is_paused);
}

void panel_view(struct panel *panel, struct stage *stage, struct viewpoint *view)
{
    struct gui *gui = panel->gui;
    gui_group_begin(gui, "view", "View", "What is seen of the picture.", true);
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
