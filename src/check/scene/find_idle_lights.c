// Finds lights that get shadow rays but contribute no light, because all surfaces are outside of
// their range, or because an opaque object encloses them. The other lights then get fewer shadow
// rays and have more noise.
#include "check/scene/survey.h"

#include "base/maths.h"
#include "render/tables/emitter_lamps.h"
#include "render/tables/emitter_power.h"
#include "render/tables/emitters.h"
#include "render/tables/light_choice.h"
#include "shared/bindings.h"
#include <string.h>

// A light that contributes less than this share of the image's light counts as contributing
// nothing.
#define LIGHT_MIN 1e-3
// Idle lights that get less than this share of all shadow rays have little effect.
#define RAYS_MIN 0.25
// The finding is reported only if the image needs fewer samples, by this factor, without these
// lights.
#define GAIN_MIN 2.0
// If not all suspected lights are idle, at most this many are tested separately, those with most
// shadow rays first.
#define ALONE_MOST 4u

// The distribution of shadow rays over the sources of light.
struct rays {
    // Fraction of all shadow rays that each source gets; for a light tree, which also uses
    // distances, the fraction of the power.
    double *parts;
    bool *idle; // a flag for each source that contributes no light
    // A light tree selects lights. It is used at all vertices, or only after the first vertices,
    // which connect to every lamp.
    bool by_tree;
};

static void add_weight(struct rays *rays, uint32_t choice, uint32_t source, double power)
{
    rays->parts[source] += choice == LIGHT_CHOICE_UNIFORM && power > 0.0 ? 1.0 : power;
}

static void weigh_sources(const struct survey *survey, uint32_t choice, struct rays *rays)
{
    const struct scene *scene = survey->scene;
    const struct flat_scene *flat = survey->flat;
    double sum = 0.0;
    for (uint32_t i = 0; i < scene->light_count; i++) {
        const struct light light = flat_light(flat, &scene->lights[i]);
        if (!light.hidden)
            add_weight(rays, choice, i, light_power(&light, flat));
    }
    for (uint32_t i = 0; i < flat->shape_count; i++) {
        uint32_t material = flat->shapes[i].material;
        if (shape_is_emitter(flat->shapes[i].kind))
            add_weight(rays, choice, survey_lamp_source(survey, material),
                       mean_radiance(scene, &scene->materials[material]) *
                           shape_area(&flat->shapes[i]));
    }
    for (uint32_t i = 0; i < flat->world_triangle_count; i++) {
        uint32_t material = flat->triangles[i].material;
        double radiance = mean_radiance(scene, &scene->materials[material]);
        if (radiance > 0.0)
            add_weight(rays, choice, survey_lamp_source(survey, material),
                       radiance * triangle_area(flat, i));
    }
    if (emitters_count(scene, flat).environment > 0)
        add_weight(rays, choice, survey_sky_source(survey),
                   environment_power(&scene->environment, survey->sky_floor, flat));
    for (uint32_t i = 0; i < survey_source_count(survey); i++)
        sum += rays->parts[i];
    for (uint32_t i = 0; i < survey_source_count(survey) && sum > 0.0; i++)
        rays->parts[i] /= sum;
}

// Returns the fraction of the shadow rays that idle lights get.
static double idle_part(const struct survey *survey, const struct rays *rays)
{
    double part = 0.0;
    for (uint32_t i = 0; i < survey_source_count(survey); i++)
        part += rays->idle[i] ? rays->parts[i] : 0.0;
    return part;
}

// Returns the idle light that gets most shadow rays, or the number of sources if there is none.
static uint32_t find_busiest(const struct survey *survey, const struct rays *rays)
{
    uint32_t count = survey_source_count(survey), busiest = count;
    for (uint32_t i = 0; i < count; i++)
        if (rays->idle[i] && (busiest == count || rays->parts[i] > rays->parts[busiest]))
            busiest = i;
    return busiest;
}

// --- renders with some of the lights -------------------------------------------------------------

// Copies the scene without the `marked` sources of light, or, if `others` is set, without the
// sources that are not marked. survey->scratch owns the arrays that differ.
static bool put_out(struct survey *survey, const bool *marked, bool others, struct scene *out,
                    struct err *err)
{
    const struct scene *scene = survey->scene;
    *out = *scene;
    out->lights = ARENA_NEW(&survey->scratch, struct light, scene->light_count + 1);
    out->materials = ARENA_NEW(&survey->scratch, struct material, scene->material_count + 1);
    if (!out->lights || !out->materials)
        return err_memory(err, "lights and materials",
                          scene->material_count * sizeof *out->materials);
    for (uint32_t i = 0; i < scene->light_count; i++) {
        out->lights[i] = scene->lights[i];
        out->lights[i].hidden |= marked[i] != others;
    }
    for (uint32_t i = 0; i < scene->material_count; i++) {
        out->materials[i] = scene->materials[i];
        if (marked[survey_lamp_source(survey, i)] != others)
            memset(out->materials[i].emission, 0, sizeof out->materials[i].emission);
    }
    out->environment.present &= marked[survey_sky_source(survey)] == others;
    return true;
}

// Results of rendering the small image with some of the lights.
struct partly_lit {
    double light;   // mean luminance of the image
    double samples; // samples per pixel to the desired error, see outlook_samples()
};

static bool render_partly(struct survey *survey, const bool *marked, bool others,
                          struct partly_lit *out, struct err *err)
{
    struct scene scene;
    struct job job;
    struct job_estimate estimate;
    double seconds;
    struct job_params params = survey->small;
    if (!put_out(survey, marked, others, &scene, err))
        return false;
    params.scene = &scene;
    params.renderer.scene = &scene;
    if (!job_start(&params, &job, err))
        return false;
    bool ok = outlook_render(survey, &job, &estimate, &seconds, err);
    *out = (struct partly_lit){0};
    if (ok)
        *out = (struct partly_lit){survey_mean_light(survey, estimate.film.mean),
                                   outlook_samples(survey, &estimate.error)};
    arena_finish(&estimate.arena);
    job_finish(&job);
    return ok;
}

// Sets *idle to whether the image is almost black with only the marked lights.
static bool are_idle(struct survey *survey, const bool *marked, bool *idle, struct err *err)
{
    struct partly_lit lit;
    double all = survey_mean_light(survey, survey->out->picture.pixels);
    if (!render_partly(survey, marked, true, &lit, err))
        return false;
    *idle = lit.light < LIGHT_MIN * all;
    return true;
}

// Keeps the suspected lights that contribute no light: all of them if together they contribute
// none, otherwise those that are found idle one by one.
static bool confirm(struct survey *survey, struct rays *rays, struct err *err)
{
    uint32_t count = survey_source_count(survey);
    bool *suspects = rays->idle, are_all, *alone = ARENA_NEW(&survey->scratch, bool, count);
    bool *found = ARENA_NEW(&survey->scratch, bool, count);
    if (!alone || !found)
        return err_memory(err, "lights", count);
    if (!are_idle(survey, suspects, &are_all, err))
        return false;
    for (uint32_t k = 0; k < ALONE_MOST && !are_all; k++) {
        uint32_t source = find_busiest(survey, rays);
        if (source == count)
            break;
        alone[source] = true;
        if (!are_idle(survey, alone, &found[source], err))
            return false;
        alone[source] = suspects[source] = false;
    }
    rays->idle = are_all ? suspects : found;
    return true;
}

// --- the finding ---------------------------------------------------------------------------------

static const char *describe_sources(const struct survey *survey, const struct rays *rays)
{
    const struct scene *scene = survey->scene;
    uint32_t first = find_busiest(survey, rays), more = 0;
    const char *name = "the environment's image";
    for (uint32_t i = 0; i < survey_source_count(survey); i++)
        more += rays->idle[i] && i != first;
    if (first < scene->light_count) {
        const char *own = scene->lights[first].name;
        bool is_named = own && *own;
        name = arena_printf(survey->arena, "light %u%s%s%s", first, is_named ? ", \"" : "",
                            is_named ? own : "", is_named ? "\"" : "");
    } else if (first < survey_sky_source(survey)) {
        const char *own = survey_material_name(survey, first - scene->light_count);
        name = own ? arena_printf(survey->arena, "lamps of %s", own) : NULL;
    }
    return name && more > 0 ? arena_printf(survey->arena, "%s, and %u more", name, more) : name;
}

static bool add_finding(struct survey *survey, const struct rays *rays, double samples,
                        struct err *err)
{
    struct arena *arena = survey->arena;
    const struct scene_outlook *outlook = &survey->out->outlook;
    double percent = 100.0 * idle_part(survey, rays);
    return survey_add(
        survey,
        &(struct scene_finding){
            .name = "idle-light",
            .level = FINDING_SLOW,
            .place = describe_sources(survey, rays),
            .figure = arena_printf(
                arena,
                rays->by_tree ? "%.4g %% of the lights' power, but less than %g %% of the light; "
                                "power and distance decide which lights get shadow rays"
                              : "%.4g %% of all shadow rays, but less than %g %% of the light",
                percent, 100.0 * LIGHT_MIN),
            .consequence = arena_printf(arena,
                                        "The other lights get few shadow rays: local relMSE %g "
                                        "takes %.0f spp, but %.0f spp without these lights.",
                                        outlook->error, ceil(outlook->samples), ceil(samples)),
            .remedy = "Remove it, or let its light reach a surface: its `range` may be too short, "
                      "or an object may enclose it.",
            .share = 1.0,
        },
        err);
}

bool find_idle_lights(struct survey *survey, struct err *err)
{
    const struct emitter_counts counts = emitters_count(survey->scene, survey->flat);
    struct emitter_lamps lamps;
    if (!emitter_lamps_find(survey->scene, survey->flat, &survey->scratch, &lamps, err))
        return false;
    const struct light_choice choice =
        light_choice_of(survey->settings.light_choice, emitters_total(&counts), &lamps);
    // If each vertex connects to every light, no light gets rays at the cost of another.
    bool are_shared = choice.way != LIGHT_CHOICE_ALL || choice.vertices != ALL_VERTICES;
    uint32_t count = survey_source_count(survey);
    struct rays rays = {
        .parts = ARENA_NEW(&survey->scratch, double, count),
        .idle = ARENA_NEW(&survey->scratch, bool, count),
        .by_tree = choice.way == LIGHT_CHOICE_TREE || choice.way == LIGHT_CHOICE_ALL,
    };
    struct partly_lit lit;
    if (!survey->is_reached || !are_shared)
        return true;
    if (!rays.parts || !rays.idle)
        return err_memory(err, "lights", count * sizeof *rays.parts);
    weigh_sources(survey, choice.way, &rays);
    for (uint32_t i = 0; i < count; i++)
        rays.idle[i] = rays.parts[i] > 0.0 && !survey->is_reached[i];
    if (idle_part(survey, &rays) < RAYS_MIN)
        return true;
    if (!confirm(survey, &rays, err))
        return false;
    if (idle_part(survey, &rays) < RAYS_MIN)
        return true;
    if (!render_partly(survey, rays.idle, false, &lit, err))
        return false;
    return !(lit.samples * GAIN_MIN <= survey->out->outlook.samples) ||
           add_finding(survey, &rays, lit.samples, err);
}
