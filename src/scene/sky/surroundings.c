#include "scene/sky/surroundings.h"

#include "base/maths.h"
#include <math.h>
#include <string.h>

const char *const surroundings_names[SURROUNDINGS_COUNT + 1] = {
    [SURROUNDINGS_ORIGINAL] = "original", [SURROUNDINGS_NONE] = "none",
    [SURROUNDINGS_CONSTANT] = "constant", [SURROUNDINGS_SKY] = "sky",
    [SURROUNDINGS_IMAGE] = "image",
};

struct surroundings surroundings_default(void)
{
    struct surroundings s;
    memset(&s, 0, sizeof s); // clears padding: the struct is compared byte by byte
    for (int c = 0; c < 3; c++)
        s.radiance[c] = 1.0f;
    s.turbidity = sky_default().turbidity;
    s.elevation_degrees = 45.0;
    s.has_sun = 1;
    s.strength = 1.0;
    return s;
}

struct surroundings_original surroundings_keep(const struct scene *scene)
{
    uint32_t sun = scene_sun_light(scene);
    return (struct surroundings_original){
        .environment = scene->environment,
        .light_count = scene->light_count - (sun != SCENE_NONE),
        .sky_sun = sun,
        .hash = scene->hash,
    };
}

static bool check(const struct surroundings *to, struct err *err)
{
    if (to->kind >= SURROUNDINGS_COUNT)
        return err_set(err, ERR_BUG, "environment of kind %u; expected less than %d", to->kind,
                       SURROUNDINGS_COUNT);
    if (to->kind == SURROUNDINGS_IMAGE && !to->image[0])
        return err_set(err, ERR_INPUT, "environment: no image is given; expected its path");
    if (!isfinite(to->rotation_degrees))
        return err_set(err, ERR_INPUT,
                       "environment: the rotation is %g degrees; expected a finite number",
                       to->rotation_degrees);
    return true;
}

bool scene_replace_environment(struct scene *scene, const struct environment_source *source,
                               struct err *err)
{
    const struct environment former = scene->environment;
    uint32_t light_count = scene->light_count;
    bool ok = source->sky ? scene_set_sky(scene, source->sky, err)
              : source->gradient
                  ? scene_set_gradient(scene, source->gradient, err)
                  : scene_set_environment(scene, source->file, source->radiance, err);
    if (!ok)
        return false;
    scene_remove_sun(scene, &former);
    if (scene_add_sky_sun(scene, err))
        return true;
    scene->environment = former;
    scene->light_count = light_count;
    return false;
}

static bool replace(struct scene *scene, const struct surroundings *to, struct err *err)
{
    struct sky sky = sky_default();
    struct environment_source source = {.radiance = {1, 1, 1}};
    if (to->kind == SURROUNDINGS_SKY) {
        sky.turbidity = to->turbidity;
        sky.has_sun = to->has_sun;
        sky_place_sun(&sky, to->elevation_degrees, to->azimuth_degrees);
        source.sky = &sky;
    } else if (to->kind == SURROUNDINGS_IMAGE) {
        source.file = to->image;
    } else if (to->kind == SURROUNDINGS_CONSTANT) {
        memcpy(source.radiance, to->radiance, sizeof source.radiance);
    }
    if (to->kind == SURROUNDINGS_NONE) {
        scene->environment = (struct environment){0};
        return true;
    }
    return scene_replace_environment(scene, &source, err);
}

static bool set(struct scene *scene, const struct surroundings_original *original,
                const struct surroundings *to, struct err *err)
{
    scene->hash = original->hash;
    scene->environment = original->environment;
    scene->environment.sun.light = 0;
    if (to->kind != SURROUNDINGS_ORIGINAL && !replace(scene, to, err))
        return false;
    scene->light_count = original->light_count;
    scene->environment.sun.light = 0; // set below, when the sun's light is added
    return scene_adjust_environment(scene, to->rotation_degrees * DEGREE, to->strength, err) &&
           scene_add_sky_sun(scene, err);
}

bool scene_set_surroundings(struct scene *scene, const struct surroundings_original *original,
                            const struct surroundings *to, struct arena *arena, struct err *err)
{
    if (!check(to, err))
        return false;
    struct scene before = *scene;
    struct light sun = {0};
    bool had_sun = scene->light_count > original->light_count;
    // The array of lights stays in the scene's own arena; it grows by one element at most.
    if (!had_sun && !scene_add_light(scene, NULL))
        return err_memory(err, "a sun", sizeof sun);
    before.lights = scene->lights;
    before.light_capacity = scene->light_capacity;
    if (had_sun)
        sun = scene->lights[original->light_count];

    const struct arena own = scene->arena;
    scene->arena = *arena;
    bool ok = set(scene, original, to, err);
    *arena = scene->arena;
    scene->arena = own;
    scene->notes = before.notes; // the texts of new notes are in the other arena
    scene->note_count = before.note_count;
    scene->note_capacity = before.note_capacity;
    if (ok)
        return true;
    *scene = before;
    scene->arena = own;
    if (had_sun)
        scene->lights[original->light_count] = sun;
    return false;
}
