// How a side is rendered, and what is shown of it.
#include "viewer/panel/panel_internal.h"

#include <float.h>
#include <math.h>
#include <string.h>

static const char *const side_names[] = {"A", "B", NULL};

static const struct gui_range samples_a_frame = {0, 4096, .logarithmic = true, .integer = true,
                                                 .least = "as time allows"};
static const struct gui_range spp = {1, (double)UINT32_MAX, .logarithmic = true, .integer = true,
                                     .infinite = "unlimited"};
static const struct gui_range seed = {0, (double)UINT32_MAX, .logarithmic = true, .integer = true};
static const struct gui_range bounces = {0, SETTINGS_BOUNCES_MAX, .logarithmic = true,
                                         .integer = true};
static const struct gui_range first_bounces = {0, (double)UINT32_MAX, .logarithmic = true,
                                               .integer = true, .infinite = "all"};
static const struct gui_range never = {0, (double)UINT32_MAX, .logarithmic = true, .integer = true,
                                       .infinite = "never"};
static const struct gui_range any = {0, (double)UINT32_MAX, .logarithmic = true, .integer = true,
                                     .infinite = "any"};
static const struct gui_range survival = {0.01, 1};
static const struct gui_range radius = {0, SETTINGS_FILTER_RADIUS_MAX, .unit = "px",
                                        .least = "its own", .drag = 4};
static const struct gui_range exponent = {0, SETTINGS_EXPONENT_MAX, .logarithmic = true};
static const struct gui_range limit = {0, 1e30, .logarithmic = true, .least = "off"};
static const struct gui_range falloff = {0, 1e30, .logarithmic = true, .least = "off"};
static const struct gui_range distance = {1e-30, INFINITY, .logarithmic = true, .unit = "m",
                                          .infinite = "any"};

// --- the method ----------------------------------------------------------------------------------

static void accumulation(struct viewer *viewer, struct form *form, struct method *to)
{
    struct gui *gui = form->gui;
    static const char *const words[] = {"accumulate", "fresh frames", NULL};
    uint32_t fresh = to->fresh_frames;
    if (form_choice(form, "renderer.accumulation", "Frames",
                    "Whether samples of all frames add up, or each frame is a picture of its own.",
                    words, &fresh))
        to->fresh_frames = fresh;
    form_count(form, "renderer.samples_a_frame", "Per frame",
               "Samples of every pixel in a frame, 0 to 4096; 0: as many as the time allows.",
               &samples_a_frame, &to->samples_a_frame);
    struct shown shown = viewer->shown;
    uint32_t most = shown.spp_limit ? shown.spp_limit : UINT32_MAX;
    if (gui_count(gui, "renderer.spp", "Samples",
                  "Samples of a pixel after which the picture rests, 1 to 4294967294, of all "
                  "sides.",
                  &spp, &most)) {
        shown.spp_limit = most == UINT32_MAX ? 0 : most;
        edit_shown(viewer, &shown, "renderer.spp");
    }
    form_count(form, "renderer.seed", "Seed", "Of all random numbers, 0 to 4294967295.", &seed,
               &to->settings.seed);
}

static void paths(struct form *form, struct settings *to)
{
    struct gui *gui = form->gui;
    form_choice(form, "renderer.integrator", "Integrator",
                "What a picture is of: all paths, direct light alone, ambient occlusion, or "
                "Whitted's rays.",
                integrator_names, &to->integrator);
    form_count(form, "renderer.max_bounces", "Bounces",
               "Scattering events on a path at most, 0 to 1048576; 0: what emits alone.", &bounces,
               &to->max_bounces);
    gui_enabled(gui, to->integrator == INTEGRATOR_AO);
    form_float(form, "renderer.ao_distance", "Occlusion",
               "How far away a surface still occludes, metres, with the integrator \"ao\".",
               &distance, &to->ao_distance);
    gui_enabled(gui, true);
    form_float(form, "renderer.falloff", "Falloff",
               "k of fading into the background by 1 - exp(-k t^3), 1/m^3, 0 to 1e30; 0: off. Not "
               "physical.",
               &falloff, &to->falloff);
    form_choice(form, "renderer.directions", "Directions",
                "How a path goes on from a surface that is not perfectly specular.",
                directions_names, &to->directions);
    gui_enabled(gui, to->directions == DIRECTIONS_POWER_COSINE);
    form_float(form, "renderer.direction_exponent", "Exponent",
               "Of the directions \"power-cosine\", 0 to 1e6.", &exponent, &to->direction_exponent);
    gui_enabled(gui, true);
    form_float(form, "renderer.clamp", "Clamp",
               "Largest component of a contribution, W/(sr m^2), 0 to 1e30; 0: off. It biases.",
               &limit, &to->clamp_limit);
}

static void roulette(struct form *form, struct settings *to)
{
    struct gui *gui = form->gui;
    bool is_on = to->roulette != ROULETTE_OFF;
    form_choice(form, "renderer.roulette", "Roulette",
                "How paths that matter little are ended at random.", roulette_names, &to->roulette);
    gui_enabled(gui, is_on);
    form_count(form, "renderer.roulette_min", "  from",
               "Scattering events before it starts, 0 to 4294967295.", &never,
               &to->roulette_min_bounces);
    gui_enabled(gui, to->roulette == ROULETTE_FRAME);
    form_count(form, "renderer.roulette_max", "  to",
               "Greatest depth, of roulette \"frame\", 0 to 4294967295. It biases.", &any,
               &to->roulette_max_bounces);
    gui_enabled(gui, to->roulette == ROULETTE_CONSTANT || to->roulette == ROULETTE_FRAME);
    form_float(form, "renderer.roulette_survival", "  survival",
               "Probability to go on, of roulette \"constant\" and \"frame\", 0.01 to 1.",
               &survival, &to->roulette_survival);
    gui_enabled(gui, true);
}

static void lights(struct form *form, struct settings *to)
{
    struct gui *gui = form->gui;
    form_switch(form, "renderer.nee", "Aim at lights",
                "Next-event estimation: shadow rays to emitters. Off: found by chance alone.",
                &to->nee);
    gui_enabled(gui, to->nee);
    form_count(form, "renderer.nee_depth", "  first",
               "So many vertices of a path send shadow rays, 0 to 4294967295.", &first_bounces,
               &to->nee_depth);
    form_choice(form, "renderer.light_choice", "  choice",
                "Which emitters a vertex sends shadow rays to.", light_choice_names,
                &to->light_choice);
    form_choice(form, "renderer.mis", "  weights",
                "How the two ways to find an emitter share what they find.", mis_names, &to->mis);
    gui_enabled(gui, true);
}

static void samples(struct form *form, struct settings *to, bool has_image)
{
    form_choice(form, "renderer.sampler", "Sampler", "Where random numbers come from.",
                sampler_names, &to->sampler);
    form_choice(form, "renderer.halves", "Halves",
                "How the two half-buffers, which tell the error, share the samples.", halves_names,
                &to->halves);
    form_switch(form, "renderer.pixel_jitter", "Pixel jitter",
                "Samples spread over the pixel's filter; off: all through its centre.",
                &to->pixel_jitter);
    gui_enabled(form->gui, to->pixel_jitter);
    form_choice(form, "renderer.filter", "Filter", "The pixel's filter.", filter_names,
                &to->filter);
    form_float(form, "renderer.filter_radius", "  radius",
               "Half the filter's width, pixels, 0 to 16; 0: the filter's own.", &radius,
               &to->filter_radius);
    gui_enabled(form->gui, has_image);
    form_choice(form, "renderer.environment_filter", "Surroundings",
                "Between the texels of what is around: interpolated, or a patch around each.",
                environment_filter_names, &to->environment_filter);
    gui_enabled(form->gui, true);
}

// Powers of two that the device takes; 0 for its own choice.
static void workgroup(struct viewer *viewer, struct form *form, struct method *to)
{
    static const char *const words[] = {"device's", "8",   "16",  "32",   "64",
                                        "128",      "256", "512", "1024", NULL};
    const char *names[sizeof words / sizeof *words] = {words[0]};
    uint32_t chosen = 0, count = 1;
    for (uint32_t size = 8; words[count] && size <= viewer->gpu.max_invocations; size *= 2) {
        if (to->workgroup == size)
            chosen = count;
        names[count] = words[count];
        count++;
    }
    if (form_choice(form, "renderer.workgroup", "Workgroup",
                    "Threads of a workgroup: changes speed, and no bit of the picture.", names,
                    &chosen))
        to->workgroup = chosen ? 4u << chosen : 0;
}

static void device(struct viewer *viewer, struct form *form, struct method *to)
{
    static const struct gui_range wave = {0, 16777216, .logarithmic = true, .integer = true,
                                          .least = "device's"};
    static const char *const features[] = {"needed", "all", NULL};
    static const char *const classes[] = {"separate", "merged", NULL};
    uint32_t everything = to->everything, merged = to->merge_classes;
    if (form_count(form, "renderer.wave", "Wave",
                   "Paths in flight, 64 to 16777216: changes memory and speed, and no bit of the "
                   "picture.",
                   &wave, &to->wave) &&
        to->wave > 0 && to->wave < 64)
        to->wave = 64;
    workgroup(viewer, form, to);
    if (form_choice(form, "renderer.features", "Features",
                    "What kernels can do: what the scene needs, or everything, to compare speeds.",
                    features, &everything))
        to->everything = everything;
    if (form_choice(form, "renderer.classes", "Classes",
                    "A kernel for each class of surfaces, or one for all of them.", classes,
                    &merged))
        to->merge_classes = merged;
}

// All materials at once: what is anisotropic becomes isotropic, and what was so in the file becomes
// it again.
static void anisotropy(struct viewer *viewer)
{
    const char *const id = "renderer.anisotropy";
    struct scene *scene = &viewer->scene;
    const struct scene *before = &viewer->pristine;
    bool is_on = false, can = false;
    for (uint32_t i = 0; i < scene->material_count; i++) {
        is_on = is_on || scene->materials[i].anisotropic > 0.0f;
        can = can || scene->materials[i].anisotropic > 0.0f ||
              before->materials[i].anisotropic > 0.0f;
    }
    gui_enabled(&viewer->gui, can);
    bool used =
        gui_switch(&viewer->gui, id, "Anisotropy",
                   "Off: all materials are isotropic; on: as anisotropic as in the file.", &is_on);
    gui_enabled(&viewer->gui, true);
    for (uint32_t i = 0; used && i < scene->material_count; i++) {
        struct material to = scene->materials[i];
        to.anisotropic = is_on ? before->materials[i].anisotropic : 0.0f;
        edit_material(viewer, i, &to, id);
    }
}

void panel_renderer(struct viewer *viewer)
{
    struct gui *gui = &viewer->gui;
    gui_group_begin(gui, "renderer", "Renderer", "How the picture is made.", false);
    gui_enabled(gui, viewer->side_count > 1);
    gui_choice(gui, "renderer.side", "Side",
               "Whose settings these are: A at the left, B at the right of the split view.",
               side_names, &viewer->edited_side);
    gui_enabled(gui, true);
    uint32_t side = viewer->edited_side;
    struct method to = viewer->sides[side].method;
    struct form form = {.gui = gui};
    accumulation(viewer, &form, &to);
    gui_space(gui);
    paths(&form, &to.settings);
    roulette(&form, &to.settings);
    gui_space(gui);
    lights(&form, &to.settings);
    anisotropy(viewer);
    gui_space(gui);
    samples(&form, &to.settings, viewer->scene.environment.width > 0);
    gui_space(gui);
    device(viewer, &form, &to);
    if (form.used)
        edit_method(viewer, side, &to, form.used);
    gui_group_end(gui);
}

// --- what is shown -------------------------------------------------------------------------------

static void picture(struct viewer *viewer, struct form *form, struct shown *to)
{
    static const struct gui_range exposure = {-SETTINGS_EXPOSURE_MAX, SETTINGS_EXPOSURE_MAX,
                                              .unit = "stops", .drag = 10};
    struct gui *gui = form->gui;
    bool is_light = to->what == SHOWN_RADIANCE || to->what == SHOWN_EMISSION ||
                    to->what == SHOWN_DIRECT || to->what == SHOWN_INDIRECT;
    bool has_range = shown_has_range(to->what);
    form_choice(form, "view.aov", "Shown",
                "The picture, or what surfaces are, or how hard each pixel was.", shown_names,
                &to->what);
    gui_enabled(gui, is_light);
    form_float(form, "view.exposure", "Exposure",
               "Stops that the picture is brightened, -100 to "
               "100; what is accumulated stays.",
               &exposure, &to->exposure);
    form_flag(form, "view.exposure_auto", "Find exposure",
              "Found from the picture's luminances when a scene is opened or its surroundings "
              "change, see docs/output.md.",
              &to->exposure_is_auto);
    form_choice(form, "view.tone", "Tone curve", "How light becomes what a screen shows.",
                tone_names, &to->tone);
    const struct gui_range values = {-1e30, 1e30, .unit = shown_unit(to->what)};
    gui_enabled(gui, has_range);
    bool is_switched =
        form_flag(form, "view.automatic", "Find range",
                  "False colours reach from the lowest to the highest of the picture's values.",
                  &to->automatic);
    if (is_switched && !to->automatic && !(to->range[1] > to->range[0]))
        memcpy(to->range, viewer->display.range, sizeof to->range);
    gui_enabled(gui, has_range && !to->automatic);
    form_number(form, "view.range_low", "  from",
                "What the first false colour stands for, in the unit that is shown.", &values,
                &to->range[0]);
    form_number(form, "view.range_high", "  to",
                "What the last one stands for; not above the first: found from the picture.",
                &values, &to->range[1]);
    gui_enabled(gui, true);
    if (gui_is_drawn(gui) && has_range)
        gui_pair(gui, "  in use", "%.4g to %.4g %s", viewer->display.range[0],
                 viewer->display.range[1], shown_unit(to->what));
    form_flag(form, "view.nearest", "Show pixels",
              "Pixels of a smaller picture as squares, not interpolated.", &to->nearest);
}

static void denoising(struct form *form, struct shown *to)
{
    static const struct gui_range iterations = {1, 5, .integer = true};
    struct gui *gui = form->gui;
    gui_enabled(gui, to->what == SHOWN_RADIANCE);
    form_flag(form, "view.denoise", "Denoise",
              "A preview without noise, by SVGF's filter. It biases; saved EXRs keep the film.",
              &to->denoise);
    gui_enabled(gui, to->what == SHOWN_RADIANCE && to->denoise);
    form_flag(form, "view.denoise_temporal", "  temporal",
              "Takes earlier pictures along where the camera moved.", &to->denoise_temporal);
    form_count(form, "view.denoise_iterations", "  passes", "Of the wavelet, 1 to 5.", &iterations,
               &to->denoise_iterations);
    gui_enabled(gui, true);
}

static void split(struct viewer *viewer, struct form *form, struct shown *to)
{
    struct gui *gui = form->gui;
    form_flag(form, "view.split", "Split view",
              "Two settings side by side over one scene, each with its error.", &to->split);
    gui_enabled(gui, to->split);
    form_number(form, "view.split_at", "  line at", "Part of the width that is side A's, 0 to 1.",
                &panel_unit, &to->split_at);
    bool swap =
        gui_button(gui, "view.swap", "Swap A and B", "Each side gets the other's settings.");
    gui_enabled(gui, true);
    if (swap) {
        struct method a = viewer->sides[0].method, b = viewer->sides[1].method;
        edit_method(viewer, 0, &b, "view.swap");
        edit_method(viewer, 1, &a, "view.swap");
    }
}

// Of the viewer alone: not undone, and not saved.
static void pace(struct viewer *viewer)
{
    static const struct gui_range target = {1, 1000, .logarithmic = true, .unit = "ms"};
    struct gui *gui = &viewer->gui;
    gui_number(gui, "view.frame_ms", "Frame time",
               "Aim of a frame's time, milliseconds, 1 to 1000.", &target, &viewer->pace.target_ms);
    gui_enabled(gui, viewer->swapchain.handle != VK_NULL_HANDLE);
    gui_switch(gui, "view.vsync", "Vsync", "Frames wait for the display.",
               &viewer->swapchain.vsync);
    gui_enabled(gui, true);
    gui_switch(gui, "view.pause", "Pause", "The picture rests; all else goes on.",
               &viewer->is_paused);
}

void panel_view(struct viewer *viewer)
{
    struct gui *gui = &viewer->gui;
    gui_group_begin(gui, "view", "View", "What is seen of the picture.", true);
    struct shown to = viewer->shown;
    struct form form = {.gui = gui};
    picture(viewer, &form, &to);
    gui_space(gui);
    split(viewer, &form, &to);
    gui_space(gui);
    denoising(&form, &to);
    if (form.used)
        edit_shown(viewer, &to, form.used);
    gui_space(gui);
    pace(viewer);
    gui_group_end(gui);
}
