// Finds spot lights that light an area far smaller than a pixel.
#include "check/scene/survey.h"

#include "base/maths.h"
#include "render/projection.h"
#include "scene/core/light.h"
#include "shared/types.h"

// If the scene has more spots than this, a part of them represents all.
#define SPOTS_MAX 4096u
// The number of lines into each cone, one for each of RAYS equal solid angles.
#define RAYS 16u
// The fraction of a pixel below which an area is reported; the finding tiny-lights uses the same
// fraction.
#define PART_MAX (1.0 / 16.0)

// The area that a spot lights.
struct patch {
    uint32_t light; // index in the scene
    double pixels;  // area in pixels, at its distance from the camera
    bool is_lit;    // at least one line of the cone hits a surface
    struct sighting at;
};

struct patches {
    struct patch *items;
    uint32_t count, every; // number of spots, and how many spots each of them represents
    struct sightline *lines;
};

static bool is_spot(const struct light *light)
{
    return light->kind == LIGHT_SPOT && !light->hidden && luminance(light->radiant) > 0.0;
}

static bool list_spots(struct survey *survey, struct patches *out, struct err *err)
{
    const struct scene *scene = survey->scene;
    uint32_t spots = 0, k = 0;
    for (uint32_t i = 0; i < scene->light_count; i++)
        spots += is_spot(&scene->lights[i]);
    uint32_t every = spots / SPOTS_MAX + 1;
    *out = (struct patches){
        .every = every,
        .items = ARENA_NEW(&survey->scratch, struct patch, spots + 1),
        .lines = ARENA_NEW(&survey->scratch, struct sightline, spots / every + 1),
    };
    if (!out->items || !out->lines)
        return err_memory(err, "spot lights", spots * sizeof *out->items);
    for (uint32_t i = 0; i < scene->light_count; i++)
        if (is_spot(&scene->lights[i]) && k++ % every == 0)
            out->items[out->count++].light = i;
    return true;
}

// Starts a line from a spot into its cone. The directions are points of a spiral by the golden
// angle (Vogel 1979), each of which represents an equal solid angle.
static void begin_line(const struct survey *survey, const struct light *light, uint32_t number,
                       struct sightline *line)
{
    // 1 - cos of the angle to the axis.
    double below = (number + 0.5) / RAYS * versine((double)light->outer_angle);
    double across = sqrt(below * (2.0 - below)), turn = number * M_PI * (3.0 - sqrt(5.0));
    double x[3], y[3];
    double upright[3] = {0.0, fabs(light->direction[1]) < 0.5, fabs(light->direction[1]) >= 0.5};
    vec3_cross(light->direction, upright, x);
    vec3_normalize(x);
    vec3_cross(light->direction, x, y);
    *line = (struct sightline){.length = (double)light->range * survey->flat->scale};
    flat_from_world(survey->flat, light->position, line->origin);
    for (int c = 0; c < 3; c++)
        line->direction[c] =
            (1.0 - below) * light->direction[c] + across * (cos(turn) * x[c] + sin(turn) * y[c]);
}

static bool is_in_picture(const struct projection *view, const struct projected *seen)
{
    return seen->x >= 0.0 && seen->x < view->width && seen->y >= 0.0 && seen->y < view->height;
}

// Returns the area, in square metres, of a pixel at a place. If the place is not in view, returns
// the area of the central pixel at the same distance.
static double pixel_area_at(const struct projection *view, const double place[3])
{
    struct projected seen;
    double way[3], ahead[3];
    if (projection_find(view, place, &seen) && is_in_picture(view, &seen))
        return seen.pixel_area;
    vec3_subtract(place, view->position, way);
    for (int c = 0; c < 3; c++)
        ahead[c] = view->position[c] + vec3_length(way) * view->forward[c];
    return projection_find(view, ahead, &seen) ? seen.pixel_area : 0.0;
}

// Adds the part of the lit area that a line represents.
static void add_part(const struct survey *survey, const struct projection *view,
                     const struct sightline *line, struct patch *patch)
{
    if (line->is_open || line->count == 0)
        return;
    const struct sighting *at = &line->steps[line->count - 1];
    const struct light *light = &survey->scene->lights[patch->light];
    double way[3], part = 2.0 * M_PI * versine((double)light->outer_angle) / RAYS;
    vec3_subtract(at->point, line->origin, way);
    patch->pixels += part * vec3_dot(way, way) / fabs(vec3_dot(line->direction, at->normal)) /
                     pixel_area_at(view, at->point);
    if (!patch->is_lit)
        patch->at = *at;
    patch->is_lit = true;
}

static bool measure_patches(struct survey *survey, const struct projection *view,
                            struct patches *patches, struct err *err)
{
    for (uint32_t k = 0; k < RAYS; k++) {
        for (uint32_t i = 0; i < patches->count; i++)
            begin_line(survey, &survey->scene->lights[patches->items[i].light], k,
                       &patches->lines[i]);
        if (!sightlines_trace(survey, patches->lines, patches->count, err))
            return false;
        for (uint32_t i = 0; i < patches->count; i++)
            add_part(survey, view, &patches->lines[i], &patches->items[i]);
    }
    return true;
}

// Flags the pixel that contains the lit area, unless another object is visible there.
static void touch(const struct survey *survey, const struct projection *view,
                  const struct patch *patch, uint8_t *flags)
{
    const struct gpu_frame *frame = &survey->job.renderer.frame;
    struct projected seen;
    if (!flags || !projection_find(view, patch->at.point, &seen) || !is_in_picture(view, &seen))
        return;
    uint32_t x = (uint32_t)(seen.x / view->width * frame->width);
    uint32_t y = (uint32_t)(seen.y / view->height * frame->height);
    const struct sightline *line = &survey->lines[y * frame->width + x];
    if (line->count > 0 && line->steps[line->count - 1].object == patch->at.object)
        flags[y * frame->width + x] = 1;
}

static const char *describe_place(const struct survey *survey, const struct patch *patch)
{
    const char *name = survey->scene->lights[patch->light].name;
    const char *object = survey_object_name(survey, patch->at.object);
    bool named = name && *name;
    if (!object)
        return NULL;
    return arena_printf(survey->arena, "light %u%s%s%s, on %s", patch->light, named ? ", \"" : "",
                        named ? name : "", named ? "\"" : "", object);
}

// Cones whose falloff spans less than 0.001 of the cosine are rendered with 0.001 (spot_width()),
// so that even their centre is darker than the intensity.
static const char *describe_consequence(const struct survey *survey, const struct light *light)
{
    static const char by_chance[] = "Samples hit the lit area by chance, if at all: isolated "
                                    "bright pixels appear late, or no light does.";
    double left = fmin(versine((double)light->outer_angle) / spot_width(light), 1.0);
    if (left == 1.0)
        return by_chance;
    return arena_printf(
        survey->arena,
        "%s In so narrow a cone, glTF's falloff leaves %.2g of the intensity at the centre.",
        by_chance, left * left);
}

static bool add_finding(struct survey *survey, const struct patch *smallest, uint32_t count,
                        const uint8_t *touched, struct err *err)
{
    struct arena *arena = survey->arena;
    return survey_add(
        survey,
        &(struct scene_finding){
            .name = "narrow-spot",
            .level = FINDING_REMARK,
            .place = describe_place(survey, smallest),
            .figure = count == 1
                          ? arena_printf(arena, "it lights an area of %.2g pixels at that distance",
                                         smallest->pixels)
                          : arena_printf(arena,
                                         "%u spot lights, the narrowest of which lights an area of "
                                         "%.2g pixels at that distance",
                                         count, smallest->pixels),
            .consequence = describe_consequence(survey, &survey->scene->lights[smallest->light]),
            .remedy = "Widen the cone (`outer_degrees` is half of its angle), or remove the light.",
            .share = survey_share(survey, touched),
            .pixels = touched,
        },
        err);
}

bool find_narrow_spots(struct survey *survey, struct err *err)
{
    const struct settings *settings = &survey->settings;
    const struct patch *smallest = NULL;
    uint8_t *touched = NULL;
    uint32_t count = 0;
    struct patches patches;
    struct projection view;
    if (!settings->nee || settings->max_bounces == 0 || settings->integrator == INTEGRATOR_AO)
        return true;
    if (!list_spots(survey, &patches, err))
        return false;
    projection_make(survey->camera, survey->flat, settings->width, settings->height, &view);
    if (patches.count > 0 && !measure_patches(survey, &view, &patches, err))
        return false;
    for (uint32_t i = 0; i < patches.count; i++) {
        const struct patch *patch = &patches.items[i];
        if (!patch->is_lit || !(patch->pixels < PART_MAX))
            continue;
        touched = touched ? touched : survey_flags(survey);
        touch(survey, &view, patch, touched);
        smallest = smallest && smallest->pixels <= patch->pixels ? smallest : patch;
        count += patches.every;
    }
    return !smallest || add_finding(survey, smallest, count, touched, err);
}
