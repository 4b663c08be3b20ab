// Lights that shadow rays do not reach though nothing opaque is in between, and lights that they
// are not sent to.
#include "check/scene/survey.h"

#include "base/hash.h"
#include "base/maths.h"
#include "flatten/flatten_census.h"
#include "render/probe/emitter_shape.h"
#include "scene/core/light.h"
#include "shared/types.h"

// What may be aimed at.
struct target {
    bool is_delta; // a light of the scene, without extent
    uint32_t light;
    struct emitter_part part;
};

struct targets {
    struct target *items;
    uint32_t count;
};

// Lamps of meshes are many triangles: some of them stand for all.
#define TRIANGLES_MAX 4096u

static bool list_targets(struct survey *survey, bool delta, struct targets *out, struct err *err)
{
    const struct scene *scene = survey->scene;
    const struct flat_scene *flat = survey->flat;
    uint32_t most = scene->light_count + flat->shape_count + TRIANGLES_MAX, emissive = 0, k = 0;
    out->items = ARENA_NEW(&survey->scratch, struct target, most);
    if (!out->items)
        return err_memory(err, "lights", most * sizeof *out->items);
    for (uint32_t i = 0; i < scene->light_count; i++) {
        bool is_sun = light_is_sun(&scene->lights[i]);
        if (!scene->lights[i].hidden && is_sun != delta && luminance(scene->lights[i].radiant) > 0)
            out->items[out->count++] = (struct target){!is_sun, i, {EMITTER_SUN, i}};
    }
    if (delta)
        return true;
    for (uint32_t i = 0; i < flat->shape_count; i++)
        if (flatten_emits(scene, flat->shapes[i].material) &&
            shape_is_emitter(flat->shapes[i].kind))
            out->items[out->count++] = (struct target){.part = {EMITTER_SHAPE, i}};
    for (uint32_t i = 0; i < flat->world_triangle_count; i++)
        emissive += flatten_emits(scene, flat->triangles[i].material);
    uint32_t every = emissive / TRIANGLES_MAX + 1;
    for (uint32_t i = 0; i < flat->world_triangle_count && emissive > 0; i++)
        if (flatten_emits(scene, flat->triangles[i].material) && k++ % every == 0)
            out->items[out->count++] = (struct target){.part = {EMITTER_TRIANGLE, i}};
    return true;
}

// --- lines to them -------------------------------------------------------------------------------

// Points are aimed at, but not what is behind them.
#define SHORT_OF (1.0 - 0x1p-12)

static void aim(const struct survey *survey, const struct target *target, const double from[3],
                uint32_t seed, struct sightline *line)
{
    const struct light *light = target->is_delta ? &survey->scene->lights[target->light] : NULL;
    double place[3], way[3], center[3];
    line->length = INFINITY;
    if (light && light->kind == LIGHT_DIRECTIONAL) {
        for (int c = 0; c < 3; c++)
            line->direction[c] = -light->direction[c];
        return;
    }
    if (light) {
        flat_from_world(survey->flat, light->position, place);
    } else {
        emitter_center(&survey->job.renderer, target->part, center);
        vec3_subtract(center, from, way);
        vec3_normalize(way);
        emitter_place(&survey->job.renderer, target->part, way, seed % 16, 16, place);
        if (emitter_is_far(target->part)) {
            for (int c = 0; c < 3; c++)
                line->direction[c] = place[c];
            return;
        }
    }
    vec3_subtract(place, from, way);
    line->length = vec3_length(way) * SHORT_OF;
    vec3_normalize(way);
    for (int c = 0; c < 3; c++)
        line->direction[c] = way[c];
}

// A line from what a line of the camera ends on to one of the targets; false where none can light
// it.
static bool begin_line(const struct survey *survey, const struct sightline *seen, uint32_t number,
                       const struct targets *targets, struct sightline *line)
{
    if (seen->count == 0 || seen->is_open)
        return false;
    const struct sighting *at = &seen->steps[seen->count - 1];
    const struct material *material = &survey->scene->materials[at->material];
    uint32_t seed = (uint32_t)(hash_bytes(HASH_INIT, &number, sizeof number) >> 16);
    if (material_lets_through(material) || material_emits(material))
        return false;
    *line = (struct sightline){.from = at};
    aim(survey, &targets->items[seed % targets->count], at->point, seed / 16, line);
    // Both sides reflect, that which is seen does.
    double side = at->is_front ? 1.0 : -1.0;
    return side * vec3_dot(line->direction, at->normal) > 0.0;
}

// Whether a line reaches what it was sent to by way of glass. Points on spheres are aimed at
// where they are seen, so that the lamp itself may be met before.
static bool is_behind_glass(const struct survey *survey, const struct sightline *line)
{
    if (line->is_open)
        return line->count > 0;
    const struct sighting *last = &line->steps[line->count - 1];
    return line->count > 1 && material_emits(&survey->scene->materials[last->material]);
}

static bool share_behind_glass(struct survey *survey, const struct targets *targets, double *share,
                               struct sighting *glass, struct err *err)
{
    uint32_t count = 0, behind = 0;
    struct sightline *lines = ARENA_NEW(&survey->scratch, struct sightline, survey->line_count);
    if (!lines)
        return err_memory(err, "lines to lights", survey->line_count * sizeof *lines);
    for (uint32_t i = 0; i < survey->line_count; i++)
        count += begin_line(survey, &survey->lines[i], i, targets, &lines[count]);
    if (!sightlines_trace(survey, lines, count, err))
        return false;
    for (uint32_t i = 0; i < count; i++)
        if (is_behind_glass(survey, &lines[i]) && behind++ == 0)
            *glass = lines[i].steps[0];
    *share = (double)behind / survey->line_count;
    return true;
}

// Less of the picture is the shadow of some small thing.
#define SHARE_MIN 0.01

static bool find_behind_glass(struct survey *survey, bool delta, struct err *err)
{
    struct targets targets = {0};
    struct sighting glass = {0};
    double share;
    if (!list_targets(survey, delta, &targets, err))
        return false;
    if (targets.count == 0)
        return true;
    if (!share_behind_glass(survey, &targets, &share, &glass, err))
        return false;
    if (share < SHARE_MIN)
        return true;
    const char *object = survey_object_name(survey, glass.object);
    const char *material = survey_material_name(survey, glass.material);
    return survey_add(
        survey,
        &(struct scene_finding){
            .name = delta ? "light-lost" : "light-by-chance",
            .level = delta ? FINDING_WRONG : FINDING_SLOW,
            .place = object && material
                         ? arena_printf(survey->arena, "behind %s, %s", object, material)
                         : NULL,
            .figure = arena_printf(
                survey->arena, delta ? "%u light%s without extent" : "%u lamp%s, or parts of such",
                targets.count, targets.count == 1 ? "" : "s"),
            .consequence = delta ? "Nothing but shadow rays finds these lights, and glass stops "
                                   "shadow rays: their light is missing there."
                                 : "Glass stops shadow rays: only paths that meet these lamps by "
                                   "chance bring their light there.",
            .remedy = delta ? "Give the lights an extent: small spheres, or an angular diameter."
                            : "Make the lamps larger, or take the glass away.",
            .share = share,
        },
        err);
}

// --- lights that nothing is sent to --------------------------------------------------------------

static bool find_unaimed(struct survey *survey, struct err *err)
{
    const struct scene *scene = survey->scene;
    const struct flat_scene *flat = survey->flat;
    for (uint32_t i = 0; i < flat->shape_count; i++) {
        const struct flat_shape *shape = &flat->shapes[i];
        uint32_t object = scene->instance_count + shape->source;
        if (!flatten_emits(scene, shape->material) || shape_is_emitter(shape->kind))
            continue;
        return survey_add(survey,
                          &(struct scene_finding){
                              .name = "lamp-unaimed",
                              .level = FINDING_SLOW,
                              .place = survey_object_name(survey, object),
                              .figure = "an emitter of a kind that shadow rays are not sent to",
                              .consequence = "Paths find its light by chance alone.",
                              .remedy = "Use a quad, a disc, a sphere or a mesh in its place.",
                              .share = NAN,
                          },
                          err);
    }
    return true;
}

bool find_hidden_lights(struct survey *survey, struct err *err)
{
    const struct settings *settings = &survey->settings;
    bool aims = settings->nee && (settings->integrator == INTEGRATOR_PATH ||
                                  settings->integrator == INTEGRATOR_DIRECT);
    return !aims || (find_behind_glass(survey, true, err) &&
                     find_behind_glass(survey, false, err) && find_unaimed(survey, err));
}
