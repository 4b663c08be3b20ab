#include "scene_edit_fixture.h"

#include "scene/core/affine.h"
#include "scene/core/environment.h"
#include "scene/core/light.h"
#include "scene/core/placement.h"
#include "scene/json/scene_write_edits.h"
#include "test.h"

double random_unit(struct random *random)
{
    // Knuth's linear congruential generator (MMIX), of which the upper bits are used.
    random->state = random->state * 6364136223846793005u + 1442695040888963407u;
    return (double)(random->state >> 11) * 0x1p-53;
}

uint32_t random_below(struct random *random, uint32_t count)
{
    return (uint32_t)(random_unit(random) * count);
}

static bool often(struct random *random)
{
    return random_below(random, 4) > 0;
}

static void random_direction(struct random *random, double out[3])
{
    do {
        for (int c = 0; c < 3; c++)
            out[c] = 2 * random_unit(random) - 1;
    } while (!vec3_normalize(out));
}

// Also returns the ends of the range, and values with seven and nine digits.
static float random_float(struct random *random, float min, float max)
{
    switch (random_below(random, 6)) {
    case 0:
        return min;
    case 1:
        return max;
    case 2:
        return min + (float)random_unit(random) * 1e-6f * (max - min);
    default:
        return fminf(fmaxf(min + (float)random_unit(random) * (max - min), min), max);
    }
}

static void edit_material(struct material *material, struct random *random)
{
    static const uint32_t switches[] = {
        MATERIAL_THIN,      MATERIAL_UNLIT,         MATERIAL_COMPENSATE,    MATERIAL_TINT_EACH,
        MATERIAL_SEPARABLE, MATERIAL_COAT_GGX,      MATERIAL_EXACT_FRESNEL, MATERIAL_GLTF_LAYERS,
        MATERIAL_UNCOUPLED, MATERIAL_MIXED_FRESNEL, MATERIAL_EXACT_COAT};
    if (often(random))
        material->model = random_below(random, MATERIAL_MODEL_COUNT);
    for (uint32_t i = 0; i < material_parameter_count; i++) {
        const struct material_parameter *p = &material_parameters[i];
        if (!often(random))
            continue;
        for (uint32_t c = 0; c < p->count; c++)
            material->parameters[p->first + c] = random_float(random, p->min, p->max);
    }
    for (size_t i = 0; i < sizeof switches / sizeof *switches; i++)
        if (often(random))
            material->flags ^= switches[i];
    if (often(random)) {
        const uint32_t chosen = MATERIAL_ALPHA_MASK | MATERIAL_ALPHA_BLEND |
                                3u << MATERIAL_DISTRIBUTION_SHIFT | 7u << MATERIAL_MASKING_SHIFT;
        material->flags = (material->flags & ~chosen) | random_below(random, 3) << 4 |
                          random_below(random, DISTRIBUTION_COUNT) << MATERIAL_DISTRIBUTION_SHIFT |
                          random_below(random, MASKING_COUNT) << MATERIAL_MASKING_SHIFT;
    }
    for (int c = 0; c < 3 && often(random); c++)
        material->extinction[c] =
            random_below(random, 3) == 0 ? INFINITY : (float)(random_unit(random) * 1e4);
    material->medium_priority = 1 + random_below(random, 255);
}

static void edit_light(struct light *light, struct random *random)
{
    if (often(random))
        light->kind = random_below(random, 3);
    if (light->kind == LIGHT_DIRECTIONAL || !often(random))
        light->profile = NULL;
    for (int c = 0; c < 3; c++) {
        light->position[c] = 100 * random_unit(random) - 50;
        light->radiant[c] = (float)(random_unit(random) * 1e3);
    }
    random_direction(random, light->direction);
    if (light->profile) {
        double other[3];
        do
            random_direction(random, other);
        while (fabs(vec3_dot(other, light->direction)) > 0.9);
        vec3_cross(light->direction, other, light->profile_x);
        vec3_normalize(light->profile_x);
    }
    light->range = often(random) ? (float)(1e-3 + random_unit(random)) : INFINITY;
    light->inner_angle = (float)(random_unit(random) * 0.7);
    light->outer_angle = light->inner_angle + (float)(1e-3 + random_unit(random) * 0.7);
    light->angular_radius = often(random) ? 1e-3 + random_unit(random) : 0;
}

static void edit_camera(struct camera *camera, struct random *random)
{
    *camera = (struct camera){.name = random_below(random, 2) ? "chosen" : "",
                              .kind = random_below(random, 3)};
    random_direction(random, camera->direction);
    do
        random_direction(random, camera->up);
    while (fabs(vec3_dot(camera->up, camera->direction)) > 0.99);
    for (int c = 0; c < 3; c++)
        camera->position[c] = 20 * random_unit(random) - 10;
    camera->fov_y = 0.01 + 3 * random_unit(random);
    camera->height = 1e-3 + random_unit(random);
    camera->lens_radius = often(random) ? random_unit(random) * 0.1 : 0;
    camera->focus_distance = 1e-3 + random_unit(random) * 10;
    camera->lens_blades = often(random) ? 3 + random_below(random, 60) : 0;
    camera->lens_rotation = random_unit(random) * 6;
}

static void edit_settings(struct settings *s, struct random *random)
{
    for (int i = 0; i < SETTING_TOTAL; i++) {
        const struct field *field = &settings_table[i].field;
        uint32_t count = 2;
        while (field->type == FIELD_CHOICE && field->words[count])
            count++;
        if (field->word && !often(random))
            field_set_word(field, s);
        else if (field->type == FIELD_REAL)
            field_set(field, s, (double)random_float(random, (float)field->min, (float)field->max));
        else if (field->type == FIELD_COUNT)
            field_set(field, s, field->min + rint(random_unit(random) * (field->max - field->min)));
        else
            field_set(field, s, random_below(random, count));
    }
    // A picture cannot have both the greatest width and the greatest height.
    s->height = 1 + s->height % (uint32_t)(SETTINGS_PIXELS_MAX / s->width);
}

// Also tries places that are impossible for a shape; it then stays.
static void place_at_random(struct scene *scene, struct random *random)
{
    uint32_t count = scene->instance_count + scene->shape_count;
    for (uint32_t i = 0; i < count; i++) {
        double middle[3];
        struct err err = {0};
        if (random_below(random, count > 40 ? count / 10 : 4) > 0)
            continue;
        scene_object_middle(scene, i, middle);
        struct placement to = placement_none(middle);
        double scale = exp(2 * random_unit(random) - 1);
        for (int c = 0; c < 3; c++) {
            to.move[c] = random_below(random, 2) ? random_unit(random) - 0.5 : 0;
            to.turn_degrees[c] = random_below(random, 2) ? 720 * random_unit(random) - 360 : 0;
            to.scale[c] = place_axes_are_free(scene, i) ? exp(random_unit(random)) : scale;
        }
        CHECK(scene_place(scene, i, &to, &err) || strstr(err.msg, "singular"), "%s", err.msg);
    }
}

static void add_at_random(struct scene *scene, struct random *random)
{
    uint32_t material, light;
    struct material *paint = scene_add_material(scene, &material);
    REQUIRE(paint);
    paint->name = random_below(random, 2) ? "lamp" : "";
    edit_material(paint, random);
    struct shape *quad = scene_add_shape(scene, NULL);
    REQUIRE(quad);
    *quad = (struct shape){.kind = SHAPE_QUAD, .material = material};
    for (int c = 0; c < 3; c++)
        quad->center[c] = random_unit(random);
    random_direction(random, quad->axes[0]);
    random_direction(random, quad->axes[1]);
    REQUIRE(scene_insert_light(scene, &light));
    light_init(&scene->lights[light]);
    edit_light(&scene->lights[light], random);
}

void edit_at_random(struct scene *scene, struct random *random)
{
    if (scene->material_count > 0 && random_below(random, 2))
        add_at_random(scene, random);
    place_at_random(scene, random);
    for (uint32_t i = 0; i < scene->material_count; i++)
        if (often(random))
            edit_material(&scene->materials[i], random);
    for (uint32_t i = 0; i < scene->light_count; i++) {
        if (often(random))
            edit_light(&scene->lights[i], random);
        scene->lights[i].hidden ^= random_below(random, 4) == 0;
    }
    for (uint32_t i = 0; i < scene->instance_count; i++) {
        struct instance *instance = &scene->instances[i];
        if (random_below(random, 2))
            instance->hidden = !instance->hidden;
        if (random_below(random, 4) == 0)
            instance->material =
                random_below(random, 2) ? random_below(random, scene->material_count) : SCENE_NONE;
    }
    for (uint32_t i = 0; i < scene->shape_count; i++) {
        scene->shapes[i].hidden ^= random_below(random, 2) > 0;
        if (random_below(random, 4) == 0)
            scene->shapes[i].material = random_below(random, scene->material_count);
    }
    if (scene->environment.present && often(random)) {
        for (int c = 0; c < 3; c++)
            scene->environment.radiance[c] = (float)random_unit(random);
        scene->environment.rotation = 10 * random_unit(random) - 5;
    }
    edit_camera(&scene->cameras[0], random);
    edit_settings(&scene->settings, random);
}

// --- comparison ----------------------------------------------------------------------------------

static bool same_bytes(const void *a, const void *b, size_t size)
{
    return (!a && !b) || (a && b && (size == 0 || memcmp(a, b, size) == 0));
}

static void check_same_meshes(const struct scene *a, const struct scene *b, const char *what)
{
    REQUIRE(a->mesh_count == b->mesh_count, "%s", what);
    for (uint32_t i = 0; i < a->mesh_count; i++) {
        const struct mesh *m = &a->meshes[i], *n = &b->meshes[i];
        REQUIRE(m->vertex_count == n->vertex_count && m->triangle_count == n->triangle_count,
                "%s: mesh %u", what, i);
        CHECK(same_bytes(m->positions, n->positions, m->vertex_count * sizeof *m->positions) &&
                  same_bytes(m->normals, n->normals, m->vertex_count * sizeof *m->normals) &&
                  same_bytes(m->tangents, n->tangents, m->vertex_count * sizeof *m->tangents) &&
                  same_bytes(m->indices, n->indices, m->triangle_count * sizeof *m->indices) &&
                  same_bytes(m->triangle_material, n->triangle_material,
                             m->triangle_count * sizeof *m->triangle_material) &&
                  m->material == n->material,
              "%s: mesh %u", what, i);
    }
}

void check_same_scene(struct scene *a, struct scene *b, const char *what)
{
    struct err err = {0};
    // Profiles are separate copies with the same content.
    for (uint32_t i = 0; i < a->light_count && i < b->light_count; i++)
        if (a->lights[i].profile && b->lights[i].profile)
            b->lights[i].profile = a->lights[i].profile;
    CHECK(scene_compare_edits(a, b, &err), "%s: %s", what, err.msg);
    CHECK(settings_same(&a->settings, &b->settings), "%s: settings", what);
    CHECK(scene_same_camera(&a->cameras[0], &b->cameras[0]), "%s: camera", what);
    check_same_meshes(a, b, what);
    for (uint32_t i = 0; i < a->instance_count && i < b->instance_count; i++)
        CHECK(same_bytes(a->instances[i].transform, b->instances[i].transform,
                         sizeof a->instances[i].transform),
              "%s: instance %u", what, i);
    const struct environment *e = &a->environment, *f = &b->environment;
    CHECK(same_bytes(e->texels, f->texels, (size_t)e->width * e->height * sizeof *e->texels),
          "%s: texels", what);
    REQUIRE(a->image_count == b->image_count && a->texture_count == b->texture_count, "%s", what);
    for (uint32_t i = 0; i < a->image_count; i++)
        CHECK(a->images[i].hash == b->images[i].hash, "%s: image %u", what, i);
}
