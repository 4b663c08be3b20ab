// Finds delta lights whose light mirrors reflect. Shadow rays end at a mirror, and no path from a
// mirror hits a point, so this light is missing. It is estimated as if the lights were visible
// within a small cone about the mirror direction (the regularization of Kaplanyan and Dachsbacher
// 2013, section 4).
#include "check/scene/survey.h"

#include "base/maths.h"
#include "scene/core/light.h"
#include "shared/types.h"

// Half the angle of the cone in radians, and its solid angle. This blurs reflected light by 7 % of
// its distance: the edges of lit regions move, but the total light hardly changes.
#define CONE 0.07
#define CONE_SOLID_ANGLE (2.0 * M_PI * versine(CONE))
// A smaller share of the image, or of its light, is not reported. The limit is that of
// find_hidden_lights.c.
#define SHARE_MIN 0.01
// If fewer lines arrive, the standard error of their light is at least a third of it.
#define LINES_MIN 10u
// The number of lines, in rounds of one line from each place. If a single light is visible in a
// mirror at 60 degrees from the normal, a line is in the cone with the probability 0.5
// CONE_SOLID_ANGLE / pi, 1 in 400. From a share SHARE_MIN of the image 13 such lines arrive, just
// more than LINES_MIN.
#define LINES (1u << 19)
// Places within this many pixels of a place whose line arrived count as lit by the mirror. In an
// image of 4096 pixels, 128 lines start at a place, of which 0.3 are in the cone; so 15 lines
// arrive from the 49 places around a lit one, and 3 if five lights share the lines.
#define NEAR_PIXELS 3u

// Returns the reflectance, as a luminance, of a material that is a perfect mirror; 0 for other
// materials.
static double mirror_reflectance(const struct material *material)
{
    double sum = 0.0;
    bool is_smooth = material->roughness == 0.0f && material->texture_count == 0;
    switch (material->model) {
    case MATERIAL_MIRROR:
        return luminance(material->base_color);
    case MATERIAL_CONDUCTOR:
        // The Fresnel equations at normal incidence (Born and Wolf, "Principles of Optics", 14.2).
        for (int c = 0; c < 3; c++) {
            double eta = (double)material->conductor_eta[c], k = (double)material->conductor_k[c];
            sum += ((eta - 1.0) * (eta - 1.0) + k * k) / ((eta + 1.0) * (eta + 1.0) + k * k);
        }
        return is_smooth ? sum / 3.0 : 0.0;
    case MATERIAL_PRINCIPLED:
        return is_smooth ? (double)material->metallic * luminance(material->base_color) : 0.0;
    default:
        return 0.0;
    }
}

struct mirrored {
    const struct light **lights; // delta lights
    uint32_t count;
    struct sightline *scattered,
        *onwards;     // lines of one round from places, and lines from mirrors to lights
    uint32_t *places; // the place from which each line of the current list, directly or through a
                      // mirror, started
    double *sent;     // light that each line of `onwards` carries
    double light;     // sum over all lines that arrive
    uint32_t arrived;
    struct sighting mirror; // the first mirror that a line hit
    uint8_t *touched;
};

static bool has_mirrors(const struct survey *survey)
{
    for (uint32_t i = 0; i < survey->scene->material_count; i++)
        if (mirror_reflectance(&survey->scene->materials[i]) > 0.0)
            return true;
    return false;
}

static bool begin(struct survey *survey, struct mirrored *out, struct err *err)
{
    const struct scene *scene = survey->scene;
    uint32_t lines = survey->line_count;
    *out = (struct mirrored){
        .lights = ARENA_NEW(&survey->scratch, const struct light *, scene->light_count + 1),
        .scattered = ARENA_NEW(&survey->scratch, struct sightline, lines),
        .onwards = ARENA_NEW(&survey->scratch, struct sightline, lines),
        .places = ARENA_NEW(&survey->scratch, uint32_t, lines),
        .sent = ARENA_NEW(&survey->scratch, double, lines),
        .touched = survey_flags(survey),
    };
    if (!out->lights || !out->scattered || !out->onwards || !out->places || !out->sent ||
        !out->touched)
        return err_memory(err, "lines by way of mirrors", lines * sizeof *out->onwards);
    for (uint32_t i = 0; i < scene->light_count; i++)
        if (!scene->lights[i].hidden && !light_is_sun(&scene->lights[i]))
            out->lights[out->count++] = &scene->lights[i];
    return true;
}

// Returns the surface that the camera sees in pixel i, or NULL if it does not scatter light.
static const struct sighting *scattering_place(const struct survey *survey, uint32_t i)
{
    const struct sighting *at = sightline_lit_place(survey, &survey->lines[i]);
    return at && mirror_reflectance(&survey->scene->materials[at->material]) == 0.0 ? at : NULL;
}

static uint32_t scatter(const struct survey *survey, uint32_t round, struct mirrored *m)
{
    uint32_t count = 0;
    for (uint32_t i = 0; i < survey->line_count; i++) {
        const struct sighting *at = scattering_place(survey, i);
        double normal[3];
        if (!at)
            continue;
        for (int c = 0; c < 3; c++)
            normal[c] = at->is_front ? at->normal[c] : -at->normal[c];
        struct sightline *line = &m->scattered[count];
        *line = (struct sightline){.from = at, .length = INFINITY};
        sighting_scatter(normal, round * survey->line_count + i, line->direction);
        m->places[count++] = i;
    }
    return count;
}

// Starts a line from the mirror at the end of another line to one of the lights, if the light is
// inside the cone about the mirror direction.
static bool send_on(const struct survey *survey, const struct mirrored *m,
                    const struct sightline *line, uint32_t number, struct sightline *onwards,
                    double *sent)
{
    if (line->count == 0 || line->is_open)
        return false;
    const struct sighting *at = &line->steps[line->count - 1];
    const struct light *light = m->lights[number % m->count];
    double reflectance = mirror_reflectance(&survey->scene->materials[at->material]);
    double place[3], towards[3], position[3], way[3];
    double along = vec3_dot(line->direction, at->normal);
    if (!(reflectance > 0.0))
        return false;
    flat_to_world(survey->flat, at->point, place);
    *sent = reflectance * m->count * light_sent(light, place, towards);
    if (!(*sent > 0.0))
        return false;
    *onwards = (struct sightline){.from = at, .length = INFINITY};
    for (int c = 0; c < 3; c++)
        way[c] = line->direction[c] - 2.0 * along * at->normal[c];
    if (vec3_dot(way, towards) < cos(CONE))
        return false;
    for (int c = 0; c < 3; c++)
        onwards->direction[c] = towards[c];
    if (light->kind == LIGHT_DIRECTIONAL)
        return true;
    flat_from_world(survey->flat, light->position, position);
    vec3_subtract(position, at->point, way);
    onwards->length = vec3_length(way) * SIGHTLINE_SHORT_OF;
    return true;
}

static void touch(const struct survey *survey, uint32_t place, uint8_t *touched)
{
    uint32_t width = survey->job.renderer.frame.width, height = survey->job.renderer.frame.height;
    uint32_t column = place % width, row = place / width;
    for (uint32_t y = row - (row < NEAR_PIXELS ? row : NEAR_PIXELS);
         y <= row + NEAR_PIXELS && y < height; y++)
        for (uint32_t x = column - (column < NEAR_PIXELS ? column : NEAR_PIXELS);
             x <= column + NEAR_PIXELS && x < width; x++)
            touched[y * width + x] |= scattering_place(survey, y * width + x) != NULL;
}

// Returns the diffuse reflectance of a place, without textures.
static double reflectance_at(const struct survey *survey, uint32_t place)
{
    const struct sighting *at = scattering_place(survey, place);
    return luminance(survey->scene->materials[at->material].base_color);
}

static bool trace_round(struct survey *survey, uint32_t round, struct mirrored *m, struct err *err)
{
    uint32_t onwards = 0, count = scatter(survey, round, m);
    if (!sightlines_trace(survey, m->scattered, count, err))
        return false;
    for (uint32_t i = 0; i < count; i++)
        if (send_on(survey, m, &m->scattered[i], round * count + i, &m->onwards[onwards],
                    &m->sent[onwards]))
            m->places[onwards++] = m->places[i];
    if (!sightlines_trace(survey, m->onwards, onwards, err))
        return false;
    for (uint32_t i = 0; i < onwards; i++) {
        if (!m->onwards[i].is_open)
            continue;
        if (m->arrived++ == 0)
            m->mirror = *m->onwards[i].from;
        // The pdf of the directions is the cosine over pi.
        m->light += M_PI * m->sent[i] / CONE_SOLID_ANGLE * reflectance_at(survey, m->places[i]);
        touch(survey, m->places[i], m->touched);
    }
    return true;
}

// Returns the sum, over all places that scatter light, of the irradiance that would give a white
// surface the radiance of the place.
static double seen_light(const struct survey *survey)
{
    double sum = 0.0;
    for (uint32_t i = 0; i < survey->line_count; i++)
        if (scattering_place(survey, i))
            sum += M_PI * luminance(survey->job.film.mean[i]);
    return sum;
}

bool find_mirrored_lights(struct survey *survey, struct err *err)
{
    struct mirrored m;
    if (!has_mirrors(survey))
        return true;
    if (!begin(survey, &m, err))
        return false;
    uint32_t rounds = m.count > 0 ? LINES / survey->line_count + 1 : 0;
    for (uint32_t i = 0; i < rounds; i++)
        if (!trace_round(survey, i, &m, err))
            return false;
    if (m.arrived < LINES_MIN)
        return true;
    double lost = m.light / rounds, part = lost / (lost + seen_light(survey));
    double share = survey_share(survey, m.touched);
    if (!(part >= SHARE_MIN) || share < SHARE_MIN)
        return true;
    const char *object = survey_object_name(survey, m.mirror.object);
    const char *material = survey_material_name(survey, m.mirror.material);
    return survey_add(
        survey,
        &(struct scene_finding){
            .name = "light-lost",
            .level = FINDING_WRONG,
            .place = object && material
                         ? arena_printf(survey->arena, "reflected by %s, %s", object, material)
                         : NULL,
            .figure = arena_printf(survey->arena,
                                   "%u delta light%s; a perfect mirror would add about %.2g %% of "
                                   "the light on visible surfaces",
                                   m.count, m.count == 1 ? "" : "s", 100.0 * part),
            .consequence = "Only shadow rays find delta lights, and a mirror blocks shadow rays, "
                           "so the reflected light is missing.",
            .remedy = "Replace the lights by small spheres, or give them an angular diameter.",
            .share = share,
            .pixels = m.touched,
        },
        err);
}
