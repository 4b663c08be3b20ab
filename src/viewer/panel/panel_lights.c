// Punctual and directional lights: a list, and the parameters of the selected one.
#include "viewer/panel/panel_internal.h"

#include "scene/core/affine.h"
#include "scene/core/environment.h"
#include "scene/core/light.h"
#include "scene/json/load_json.h"
#include "viewer/core/lamps.h"
#include "viewer/core/messages.h"
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

static const struct gui_range right_angle = {0, 90, .unit = "°"};
static const struct gui_range reach = {SCENE_LENGTH_MIN,        INFINITY,
                                       .logarithmic = true,     .unit = "m",
                                       .infinite = "unlimited", .greatest = DBL_MAX};

static void light_name(void *context, uint32_t row, char out[PANEL_NAME_MAX])
{
    const struct scene *scene = context;
    const struct light *light = &scene->lights[row];
    snprintf(out, PANEL_NAME_MAX, "%u %.100s (%s%s)", row, light->name ? light->name : "",
             light_kind_names[light->kind], light->hidden ? ", hidden" : "");
}

// Gives useful values to the parameters that a light's new type uses.
static void change_kind(struct light *to, uint32_t kind)
{
    to->kind = kind;
    if (vec3_length(to->direction) == 0)
        memcpy(to->direction, (double[3]){0, -1, 0}, sizeof to->direction);
    if (!(to->outer_angle > to->inner_angle) || !(to->outer_angle <= (float)(M_PI / 2))) {
        to->inner_angle = 0; // default of KHR_lights_punctual
        to->outer_angle = (float)(M_PI / 4);
    }
    if (!(to->range > 0))
        to->range = INFINITY;
    if (kind != LIGHT_DIRECTIONAL)
        to->angular_radius = 0;
    else
        to->profile = NULL;
}

static void place(struct panel *panel, const struct document *document, struct light *to)
{
    struct gui *gui = panel->gui;
    double direction[3] = {to->direction[0], to->direction[1], to->direction[2]};
    gui_applies(gui, to->kind != LIGHT_DIRECTIONAL);
    panel_position(panel, document, "light.position", "Position in world space, in metres.",
                   to->position);
    gui_applies(gui, to->kind != LIGHT_POINT || to->profile);
    if (panel_direction(panel, "light.direction",
                        "Direction in which the light travels; it is normalised.", NULL, direction))
        light_aim(to, direction);
    gui_enabled(gui, true);
}

// Edits intensity and colour separately: the intensity is the greatest component, the colour the
// ratios to it.
static void radiant(struct gui *gui, struct light *to)
{
    struct gui_range strength = panel_radiance;
    float most = fmaxf(fmaxf(to->radiant[0], to->radiant[1]), to->radiant[2]);
    float color[3] = {1, 1, 1}, intensity = most;
    for (int c = 0; most > 0 && c < 3; c++)
        color[c] = to->radiant[c] / most;
    strength.unit = to->kind == LIGHT_DIRECTIONAL ? "W/m²" : "W/sr";
    bool changed = gui_float(gui, "light.intensity", "Intensity",
                             "Greatest component of the intensity, in W/sr, or of a directional "
                             "light's irradiance, in W/m^2.",
                             &strength, &intensity);
    if (gui_color(gui, "light.color", "Colour",
                  "Factors by which the intensity is multiplied; linear Rec. 709.", &panel_unit,
                  color))
        changed = true;
    for (int c = 0; changed && c < 3; c++)
        to->radiant[c] = color[c] * intensity;
}

// The inner angle must be less than the outer one. Editing one of them changes the other if
// necessary.
static void cone(struct gui *gui, struct light *to)
{
    double inner = (double)to->inner_angle, outer = (double)to->outer_angle;
    const float least = 1e-3f; // least difference of the two angles, radians
    gui_applies(gui, to->kind == LIGHT_SPOT);
    if (gui_angle(gui, "light.inner_angle", "Inner angle",
                  "Angle from the axis at which the light begins to fade, in degrees.",
                  &right_angle, &inner)) {
        to->inner_angle = fminf((float)inner, (float)(M_PI / 2) - least);
        to->outer_angle = fmaxf(to->outer_angle, to->inner_angle + least);
    }
    if (gui_angle(gui, "light.outer_angle", "Outer angle",
                  "Angle from the axis at which the light ends, in degrees.", &right_angle,
                  &outer)) {
        to->outer_angle = fmaxf(fminf((float)outer, (float)(M_PI / 2)), least);
        to->inner_angle = fminf(to->inner_angle, to->outer_angle - least);
    }
    gui_enabled(gui, true);
}

static void parameters(struct panel *panel, const struct document *document, uint32_t index)
{
    static const struct gui_range diameter = {0, ENVIRONMENT_SUN_DIAMETER_MAX, .unit = "°"};
    struct gui *gui = panel->gui;
    struct light to = document->scene.lights[index];
    gui->used = NULL;
    uint32_t kind = to.kind;
    bool visible = !to.hidden;
    if (gui_switch(gui, "light.visible", "Visible", "Off: the light is removed from the scene.",
                   &visible))
        to.hidden = !visible;
    if (gui_choice(gui, "light.kind", "Kind", "Point light, spot light, or directional light.",
                   light_kind_names, &kind))
        change_kind(&to, kind);
    radiant(gui, &to);
    place(panel, document, &to);
    cone(gui, &to);
    double across = 2 * to.angular_radius;
    gui_applies(gui, to.kind == LIGHT_DIRECTIONAL);
    if (gui_angle(gui, "light.diameter", "Size",
                  "Angular diameter, in degrees, of the sun that a directional light stands for.",
                  &diameter, &across))
        to.angular_radius = across / 2;
    gui_applies(gui, to.kind != LIGHT_DIRECTIONAL);
    gui_float(gui, "light.range", "Range",
              "Distance in metres beyond which the light has no effect.", &reach, &to.range);
    gui_applies(gui, to.profile != NULL);
    if (gui_button(gui, "light.profile_off", "Remove profile",
                   "Replaces the IES profile by the same intensity in all directions.")) {
        to.profile = NULL;
        gui->used = "light.profile_off";
    }
    gui_same_line(gui);
    gui_applies(gui, to.kind == LIGHT_DIRECTIONAL);
    bool exchanges = gui_button(gui, "light.exchange", "Replace by area light",
                                "Hides this light and adds a square in its place that faces the "
                                "scene's centre and is as bright there.");
    gui_enabled(gui, true);
    if (exchanges)
        light_exchange(panel->viewer, index, "light.exchange");
    else if (gui->used)
        edit_light(panel->viewer, index, &to, gui->used);
}

static void additions(struct panel *panel)
{
    if (gui_button(panel->gui, "lights.add", "Add light",
                   "Adds a directional light, whose kind can be changed afterwards."))
        light_add(panel->viewer, "lights.add");
    gui_same_line(panel->gui);
    if (gui_button(panel->gui, "lights.add_area", "Add area light",
                   "Adds an emissive square with a material of its own, which is listed among the "
                   "objects."))
        lamp_add(panel->viewer, "lights.add_area");
}

void panel_lights(struct panel *panel, struct document *document)
{
    struct gui *gui = panel->gui;
    const struct scene *scene = &document->scene;
    gui_group_begin(gui, "lights", "Lights",
                    "Delta lights and suns; emissive surfaces are listed among the materials.",
                    true);
    const struct panel_list list = {
        .id = "lights",
        .help = "Selects the light whose parameters are shown below.",
        .count = scene->light_count,
        .height = 5,
        .name = light_name,
        .context = &document->scene,
        .of = scene->lights,
    };
    if (scene->light_count) {
        panel_list(panel, &panel->lights, &list, &document->chosen_light);
        if (document->chosen_light < scene->light_count)
            parameters(panel, document, document->chosen_light);
    } else {
        gui_line(gui, "There are none: emissive surfaces or the environment light this scene.");
    }
    additions(panel);
    gui_group_end(gui);
}
