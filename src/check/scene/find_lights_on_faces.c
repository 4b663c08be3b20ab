// Finds delta lights that lie on a surface.
#include "check/scene/survey.h"

#include "base/maths.h"
#include <string.h>

// If the scene has more lights than this, a part of them represents all.
#define LIGHTS_MAX 4096u
// One line along each axis is traced, because no plane is parallel to all three.
#define AXES 3u

// A light, and the surface on which it lies if there is one.
struct placed_light {
    uint32_t light; // index in the scene
    bool is_upon;
    double point[3]; // position in the space of the flat scene
    // Rounding error of that position, or of the camera's hits near it, whichever is larger.
    double rounding;
    struct sighting on;
};

static bool has_place(const struct light *light)
{
    return light->kind != LIGHT_DIRECTIONAL && !light->hidden && luminance(light->radiant) > 0.0;
}

static struct probe_ray ray_to(const struct placed_light *light, uint32_t axis)
{
    struct probe_ray ray = {.from_instance = NO_INSTANCE};
    double height = SIGHTING_HEIGHT * light->rounding;
    for (uint32_t c = 0; c < 3; c++)
        ray.origin[c] = (float)(light->point[c] - (c == axis ? height : 0.0));
    ray.direction[axis] = 1.0f;
    return ray;
}

// Records a hit if the light is in the plane of the surface, within the rounding error of both
// points.
static void look_at_hit(const struct survey *survey, const struct probe_ray *ray,
                        const struct probe_hit *hit, struct placed_light *light)
{
    double origin[3], direction[3], way[3];
    struct sighting on;
    if (light->is_upon || hit->primitive == NO_PRIMITIVE)
        return;
    vec3_widen(ray->origin, origin);
    vec3_widen(ray->direction, direction);
    sighting_find(survey, hit, origin, direction, &on);
    vec3_subtract(on.point, light->point, way);
    light->is_upon = vec3_length(way) <= 2.0 * SIGHTING_HEIGHT * light->rounding &&
                     fabs(vec3_dot(way, on.normal)) <= 2.0 * light->rounding;
    light->on = on;
}

static bool look_along(struct survey *survey, uint32_t axis, struct placed_light *lights,
                       uint32_t count, struct probe_ray *rays, struct probe_hit *hits,
                       struct err *err)
{
    uint32_t most = survey->job.renderer.plan.wave_slots;
    bool complete;
    for (uint32_t i = 0; i < count; i++)
        rays[i] = ray_to(&lights[i], axis);
    for (uint32_t i = 0; i < count; i += most)
        if (!job_trace_rays(&survey->job, &rays[i], count - i < most ? count - i : most, &hits[i],
                            &complete, err))
            return false;
    for (uint32_t i = 0; i < count; i++)
        look_at_hit(survey, &rays[i], &hits[i], &lights[i]);
    return true;
}

static uint32_t list_lights(const struct survey *survey, struct placed_light *out)
{
    const struct scene *scene = survey->scene;
    uint32_t count = 0, every = scene->light_count / LIGHTS_MAX + 1;
    double camera[3], way[3];
    flat_from_world(survey->flat, survey->camera->position, camera);
    for (uint32_t i = 0; i < scene->light_count; i += every) {
        struct placed_light *light = &out[count];
        if (!has_place(&scene->lights[i]))
            continue;
        *light = (struct placed_light){.light = i};
        flat_from_world(survey->flat, scene->lights[i].position, light->point);
        vec3_subtract(light->point, camera, way);
        light->rounding = fmax(sighting_rounding(light->point), sighting_rounding(way));
        count++;
    }
    return count;
}

static const char *place_of(const struct survey *survey, const struct placed_light *light)
{
    const char *name = survey->scene->lights[light->light].name;
    const char *object = survey_object_name(survey, light->on.object);
    bool named = name && *name;
    return object ? arena_printf(survey->arena, "light %u%s%s%s, on %s", light->light,
                                 named ? ", \"" : "", named ? name : "", named ? "\"" : "", object)
                  : NULL;
}

static bool add_finding(struct survey *survey, const struct placed_light *lights, uint32_t count,
                        struct err *err)
{
    struct sighting *places = ARENA_NEW(&survey->scratch, struct sighting, count);
    uint32_t upon = 0, first = count;
    uint8_t *lit;
    if (!places)
        return err_memory(err, "lights", count * sizeof *places);
    for (uint32_t i = 0; i < count; i++) {
        if (!lights[i].is_upon)
            continue;
        first = upon == 0 ? i : first;
        places[upon] = lights[i].on;
        memcpy(places[upon++].point, lights[i].point, sizeof lights[i].point);
    }
    return upon == 0 ||
           (survey_lit_from(survey, places, upon, &lit, err) &&
            survey_add(survey,
                       &(struct scene_finding){
                           .name = "light-on-surface",
                           .level = FINDING_REMARK,
                           .place = place_of(survey, &lights[first]),
                           .figure = arena_printf(survey->arena,
                                                  "%u delta light%s in the plane of a surface",
                                                  upon, upon == 1 ? "" : "s"),
                           .consequence = "The surface receives none of this light, and rounding "
                                          "decides on which side of the surface the light is.",
                           .remedy = "Move the light to the side that it should illuminate.",
                           .share = survey_share(survey, lit),
                           .pixels = lit,
                       },
                       err));
}

bool find_lights_on_faces(struct survey *survey, struct err *err)
{
    const struct settings *settings = &survey->settings;
    uint32_t all = survey->scene->light_count, most = all < LIGHTS_MAX ? all : LIGHTS_MAX;
    bool has_surfaces = survey->flat->triangle_count + survey->flat->shape_count > 0;
    if (most == 0 || !has_surfaces || !settings->nee || settings->max_bounces == 0 ||
        settings->integrator == INTEGRATOR_AO)
        return true;
    struct placed_light *lights = ARENA_NEW(&survey->scratch, struct placed_light, most);
    struct probe_ray *rays = ARENA_NEW(&survey->scratch, struct probe_ray, most);
    struct probe_hit *hits = ARENA_NEW(&survey->scratch, struct probe_hit, most);
    if (!lights || !rays || !hits)
        return err_memory(err, "lights", most * sizeof *lights);
    uint32_t count = list_lights(survey, lights);
    for (uint32_t axis = 0; axis < AXES; axis++)
        if (!look_along(survey, axis, lights, count, rays, hits, err))
            return false;
    return add_finding(survey, lights, count, err);
}
