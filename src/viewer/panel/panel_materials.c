// The list of materials, and the parameters of the selected material's model.
#include "viewer/panel/panel_internal.h"

#include "scene/json/load_json.h"
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

static void material_name(void *context, uint32_t row, char out[PANEL_NAME_MAX])
{
    const struct scene *scene = context;
    const struct material *material = &scene->materials[row];
    snprintf(out, PANEL_NAME_MAX, "%u %.100s%s%s", row, material->name,
             material->name[0] ? ", " : "", material_model_names[material->model]);
}

// Makes the label "Base colour" of the name "base_color".
static const char *label_of(struct panel *panel, const char *name)
{
    char *label = arena_strdup(panel->frame_arena, name);
    if (!label)
        return name;
    for (char *c = label; *c; c++)
        if (*c == '_')
            *c = ' ';
    if (label[0] >= 'a' && label[0] <= 'z')
        label[0] = (char)(label[0] - 'a' + 'A');
    // Scene files use American spelling, the panel uses British spelling.
    const char *color = strstr(label, "color");
    if (color)
        color = arena_printf(panel->frame_arena, "%.*scolour%s", (int)(color - label), label,
                             color + strlen("color"));
    return color ? color : label;
}

static struct gui_range range_of(const struct material_parameter *p)
{
    return (struct gui_range){.min = (double)p->min,
                              .max = (double)p->max,
                              // Parameters with a wide range vary by factors.
                              .logarithmic = p->min >= 0 && p->max > 10};
}

static bool has_normal_map(const struct scene *scene, const struct material *m)
{
    for (uint32_t i = 0; i < m->texture_count; i++) {
        uint32_t flags = scene->textures[m->first_texture + i].flags;
        if ((flags >> TEXTURE_USE_SHIFT & 3u) == TEXTURE_USE_NORMAL)
            return true;
    }
    return false;
}

static bool is_black(const float color[3])
{
    return color[0] == 0 && color[1] == 0 && color[2] == 0;
}

// Returns whether a parameter has an effect with the present values of the other parameters.
static bool matters(const struct document *document, const struct material *m, uint32_t parameter)
{
    bool is_principled = m->model == MATERIAL_PRINCIPLED;
    switch (parameter) {
    case PARAMETER_OPACITY:
        return m->flags & (MATERIAL_ALPHA_MASK | MATERIAL_ALPHA_BLEND);
    case PARAMETER_ALPHA_CUTOFF:
        return m->flags & MATERIAL_ALPHA_MASK;
    case PARAMETER_NORMAL_SCALE:
        return has_normal_map(&document->scene, m);
    case PARAMETER_ANISOTROPIC_ROTATION:
        return m->anisotropic > 0;
    case PARAMETER_CLEARCOAT_ROUGHNESS:
        return m->clearcoat > 0 && (m->flags & MATERIAL_COAT_GGX);
    case PARAMETER_CLEARCOAT_GLOSS:
        return m->clearcoat > 0 && !(m->flags & MATERIAL_COAT_GGX);
    case PARAMETER_SHEEN_ROUGHNESS:
        return !is_black(m->sheen_color);
    case PARAMETER_SHEEN_TINT:
        return m->sheen > 0;
    case PARAMETER_DIFFUSE_TRANSMISSION:
        return m->flags & MATERIAL_THIN;
    case PARAMETER_FILM_THICKNESS:
    case PARAMETER_FILM_IOR:
        return m->iridescence > 0;
    case PARAMETER_DISPERSION:
        return !(m->flags & MATERIAL_THIN) && (!is_principled || m->transmission > 0);
    default:
        return true;
    }
}

// Ids must be valid until the end of the frame, because gui->used may refer to one.
static void parameter(struct panel *panel, const struct document *document,
                      const struct material_parameter *p, struct material *to)
{
    struct gui *gui = panel->gui;
    const char *id = arena_printf(panel->frame_arena, "material.%s", p->name);
    const struct gui_range range = range_of(p);
    if (!id)
        return;
    const char *label = label_of(panel, p->name);
    float *value = &to->parameters[p->first];
    gui_applies(gui, matters(document, to, p->first));
    if (p->count == 3)
        gui_color(gui, id, label, p->help, &range, value);
    else
        gui_float(gui, id, label, p->help, &range, value);
}

// --- flags ---------------------------------------------------------------------------------------

// Draws a switch for a flag. `id` is "material." followed by the flag's key.
static void flag(struct gui *gui, const char *id, const char *label, const char *help,
                 struct material *to)
{
    const struct field *field = material_flag(strchr(id, '.') + 1);
    uint32_t value = (uint32_t)field_get(field, to);
    bool on = value > 0;
    if (field->words ? gui_choice(gui, id, label, help, field->words, &value)
                     : gui_switch(gui, id, label, help, &on))
        field_set(field, to, field->words ? value : on);
}

static void phong_exponent(struct gui *gui, struct material *to)
{
    static const struct gui_range range = {0, INFINITY, .logarithmic = true, .infinite = "mirror",
                                           .greatest = 1e6};
    double exponent = material_phong_exponent((double)to->roughness);
    if (gui_number(gui, "material.phong_exponent", "Phong exponent",
                   "Exponent of Phong's distribution of normals, which corresponds to a roughness.",
                   &range, &exponent))
        to->roughness = (float)material_phong_roughness(exponent);
}

static void flags(struct gui *gui, struct material *to)
{
    bool is_principled = to->model == MATERIAL_PRINCIPLED;
    bool is_through = is_principled || to->model == MATERIAL_DIELECTRIC;
    bool is_microfacet = to->model == MATERIAL_MICROFACET;
    flag(gui, "material.alpha", "Alpha", "Meaning of opacity: none, a mask, or a probability.", to);
    gui_applies(gui, !is_black(to->emission));
    flag(gui, "material.unlit", "Unlit",
         "Rays that hit the surface get its emission, but no shadow rays are sent to it.", to);
    gui_applies(gui, is_through);
    flag(gui, "material.thin", "Thin", "The surface is a thin sheet, without a medium inside.", to);
    gui_applies(gui, is_principled && to->transmission > 0);
    flag(gui, "material.tint_each", "Tint each",
         "Each interface tints the light by the base colour (as in glTF), not by its square root.",
         to);
    gui_applies(gui, is_principled && to->clearcoat > 0);
    flag(gui, "material.coat", "Coat",
         "Burley's clearcoat, or that of glTF with a GGX distribution.", to);
    flag(gui, "material.coat_fresnel", "Coat Fresnel",
         "Schlick's approximation, or the exact equations, both of index 1.5.", to);
    gui_applies(gui, is_principled);
    flag(gui, "material.specular_fresnel", "Specular Fresnel",
         "The exact curve adapted to the given reflectance, or a mixture of the exact and "
         "Schlick's curve by metallic, times the specular colour.",
         to);
    flag(gui, "material.layers", "Layers",
         "Mixes lobes as in Burley's model, or as in glTF's specification, with a Lambert base "
         "below a coat.",
         to);
    gui_applies(gui, to->model != MATERIAL_LAMBERT && to->model != MATERIAL_MIRROR);
    flag(gui, "material.compensate", "Compensate",
         "Adds the energy of multiple scattering between microfacets.", to);
    flag(gui, "material.separable", "Separable",
         "Separable instead of height-correlated Smith masking.", to);
    gui_applies(gui, is_microfacet);
    flag(gui, "material.distribution", "Distribution", "Distribution of the microfacets' normals.",
         to);
    gui_applies(gui, is_microfacet &&
                         (to->flags >> MATERIAL_DISTRIBUTION_SHIFT & 3u) == DISTRIBUTION_PHONG);
    phong_exponent(gui, to);
    gui_applies(gui, is_microfacet);
    flag(gui, "material.masking", "Masking", "Masking and shadowing between microfacets.", to);
    flag(gui, "material.diffuse", "Diffuse",
         "Diffuse base below the microfacets: it gets the light that the surface does not reflect, "
         "on the way in and out (coupled), or is weighted by 1 - F of the microfacet (uncoupled; "
         "this gains energy).",
         to);
    flag(gui, "material.fresnel", "Fresnel", "Schlick's approximation, or the exact equations.",
         to);
    gui_enabled(gui, true);
}

static void inside(struct gui *gui, struct material *to)
{
    static const struct gui_range extinction = {0, INFINITY, .logarithmic = true,
                                                .infinite = "opaque", .greatest = FLT_MAX};
    static const struct gui_range priority = {1, 255, .integer = true};
    gui_applies(gui, material_has_inside(to));
    gui_color(gui, "material.extinction", "Extinction",
              "Extinction of the medium inside of closed surfaces, in 1/m: the transmittance is "
              "exp(-extinction x distance).",
              &extinction, to->extinction);
    gui_count(gui, "material.medium_priority", "Priority",
              "Where media overlap, the one with the highest priority applies.", &priority,
              &to->medium_priority);
    gui_enabled(gui, true);
}

// --- the selected material -----------------------------------------------------------------------

static void parameters(struct panel *panel, const struct document *document, uint32_t index)
{
    struct gui *gui = panel->gui;
    struct material to = document->scene.materials[index];
    gui->used = NULL;
    gui_choice(gui, "material.model", "Model", "The model of how the material scatters light.",
               material_model_names, &to.model);
    for (uint32_t i = 0; i < material_parameter_count; i++)
        if (material_parameters[i].models >> to.model & 1u)
            parameter(panel, document, &material_parameters[i], &to);
    gui_enabled(gui, true);
    flags(gui, &to);
    inside(gui, &to);
    if (gui->used)
        edit_material(panel->viewer, index, &to, gui->used);
}

void panel_materials(struct panel *panel, struct document *document)
{
    struct gui *gui = panel->gui;
    const struct scene *scene = &document->scene;
    gui_group_begin(gui, "materials", "Materials", "The materials of the surfaces.", true);
    const struct panel_list list = {
        .id = "materials",
        .help = "Selects the material whose parameters are shown below.",
        .count = scene->material_count,
        .height = 6,
        .name = material_name,
        .context = &document->scene,
        .of = scene->materials,
    };
    panel_list(panel, &panel->materials, &list, &document->chosen_material);
    if (document->chosen_material < scene->material_count)
        parameters(panel, document, document->chosen_material);
    gui_group_end(gui);
}
