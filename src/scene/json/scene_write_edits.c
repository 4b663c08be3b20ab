#include "scene/json/scene_write_edits.h"

#include "base/maths.h"
#include "scene/json/load_json.h"
#include <math.h>
#include <string.h>

#define FLAGS_AT_UPLOAD (MATERIAL_NORMAL_MAP | MATERIAL_MEDIUM | MATERIAL_EMITS)

uint32_t scene_sun_light(const struct scene *scene)
{
    uint32_t light = scene->environment.present ? scene->environment.sun.light : 0;
    return light > 0 ? light - 1 : SCENE_NONE;
}

// --- what is the same ----------------------------------------------------------------------------

// memcmp, not ==: two zeros differ, and a NaN is itself.
static bool same(const void *a, const void *b, size_t size)
{
    return memcmp(a, b, size) == 0;
}
#define SAME(a, b, member) same(&(a)->member, &(b)->member, sizeof(a)->member)

static bool same_material(const struct material *a, const struct material *b)
{
    float pick = a->pick_density;
    struct material other = *b;
    other.pick_density = pick; // set at upload
    return a->model == b->model && ((a->flags ^ b->flags) & ~FLAGS_AT_UPLOAD) == 0 &&
           same(a->parameters, other.parameters, sizeof a->parameters) &&
           a->first_texture == b->first_texture && a->texture_count == b->texture_count &&
           SAME(a, b, extinction) && a->medium_priority == b->medium_priority;
}

static bool same_light(const struct light *a, const struct light *b)
{
    return a->kind == b->kind && SAME(a, b, position) && SAME(a, b, direction) &&
           SAME(a, b, radiant) && SAME(a, b, range) && SAME(a, b, inner_angle) &&
           SAME(a, b, outer_angle) && SAME(a, b, angular_radius) && a->profile == b->profile &&
           SAME(a, b, profile_x);
}

bool scene_same_camera(const struct camera *a, const struct camera *b)
{
    bool ok = a->kind == b->kind && SAME(a, b, position) && SAME(a, b, direction) && SAME(a, b, up);
    if (ok && a->kind == CAMERA_ORTHOGRAPHIC)
        return SAME(a, b, height);
    if (!ok || a->kind != CAMERA_PERSPECTIVE)
        return ok;
    bool has_lens = a->lens_radius > 0;
    return SAME(a, b, fov_y) && SAME(a, b, lens_radius) &&
           (!has_lens || (SAME(a, b, focus_distance) && a->lens_blades == b->lens_blades &&
                          SAME(a, b, lens_rotation)));
}

static bool differ(struct err *err, const char *what, uint32_t index)
{
    return err_set(err, ERR_INPUT, "%s %u: is not what the format can say", what, index);
}

bool scene_compare_edits(const struct scene *a, const struct scene *b, struct err *err)
{
    if (a->material_count != b->material_count || a->light_count != b->light_count ||
        a->instance_count != b->instance_count || a->shape_count != b->shape_count)
        return err_set(
            err, ERR_INPUT,
            "materials, lights or objects were added or taken away; expected edits only");
    for (uint32_t i = 0; i < a->material_count; i++)
        if (!same_material(&a->materials[i], &b->materials[i]))
            return differ(err, "material", i);
    for (uint32_t i = 0; i < a->light_count; i++)
        if (!same_light(&a->lights[i], &b->lights[i]))
            return differ(err, "light", i);
    for (uint32_t i = 0; i < a->instance_count; i++)
        if (a->instances[i].hidden != b->instances[i].hidden ||
            a->instances[i].material != b->instances[i].material ||
            a->instances[i].mesh != b->instances[i].mesh)
            return differ(err, "object", i);
    for (uint32_t i = 0; i < a->shape_count; i++)
        if (a->shapes[i].hidden != b->shapes[i].hidden ||
            a->shapes[i].material != b->shapes[i].material)
            return differ(err, "object", a->instance_count + i);
    const struct environment *e = &a->environment, *f = &b->environment;
    if (e->present != f->present ||
        (e->present && (!SAME(e, f, radiance) || !SAME(e, f, rotation) || e->width != f->width ||
                        e->height != f->height)))
        return err_set(err, ERR_INPUT, "the environment: is not what the format can say");
    return true;
}

// --- materials -----------------------------------------------------------------------------------

struct names {
    const char *(*name)(const struct scene *scene, uint32_t index);
    uint32_t count;
};

static const char *material_name(const struct scene *scene, uint32_t index)
{
    return scene->materials[index].name;
}

static const char *light_name(const struct scene *scene, uint32_t index)
{
    return scene->lights[index].name;
}

// By its name, which is there when the base has changed somewhat; by its index where that is not
// the only one of that name.
static void address(struct json_text *t, const struct scene *scene, const struct names *names,
                    uint32_t index)
{
    const char *name = names->name(scene, index);
    bool is_only = name && *name && json_text_can_hold(name);
    for (uint32_t i = 0; i < names->count && is_only; i++)
        is_only = i == index || !names->name(scene, i) || strcmp(names->name(scene, i), name) != 0;
    json_text_key(t, is_only ? "name" : "index");
    if (is_only)
        json_text_string(t, name);
    else
        json_text_uint(t, index);
}

static void put_choice(struct json_text *t, const char *key, const char *name)
{
    json_text_key(t, key);
    json_text_string(t, name);
}

// Of a flag's bits, in the order of edit_..._names.
static const struct choice {
    const char *key;
    const char *const *names;
    uint32_t shift, bits;
} choices[] = {
    {"alpha", edit_alpha_names, 4, 2},
    {"coat", edit_coat_names, 7, 1},
    {"layers", edit_layers_names, 15, 1},
    {"distribution", edit_distribution_names, MATERIAL_DISTRIBUTION_SHIFT, 2},
    {"masking", edit_masking_names, MATERIAL_MASKING_SHIFT, 3},
    {"fresnel", edit_fresnel_names, 21, 1},
};

static uint32_t choice_of(uint32_t flags, const struct choice *choice)
{
    return flags >> choice->shift & ((1u << choice->bits) - 1u);
}

// "all" is what is said whether it differs or not; of what does not, nothing that the format does
// not allow: that can only be the base's own.
static void put_flags(struct json_text *t, const struct material *now, uint32_t differing, bool all)
{
    for (size_t i = 0; i < edit_switch_count; i++) {
        if (!all && !(differing & edit_switches[i].flag))
            continue;
        json_text_key(t, edit_switches[i].key);
        json_text_bool(t, now->flags & edit_switches[i].flag);
    }
    for (size_t i = 0; i < sizeof choices / sizeof *choices; i++) {
        const struct choice *choice = &choices[i];
        uint32_t value = choice_of(now->flags, choice), count = 0;
        while (choice->names[count])
            count++;
        if ((all || choice_of(differing, choice) != 0) && value < count)
            put_choice(t, choice->key, choice->names[value]);
    }
}

static bool in_range(const struct material_parameter *p, const float *values)
{
    for (uint32_t c = 0; c < p->count; c++)
        if (!(values[c] >= p->min && values[c] <= p->max))
            return false;
    return true;
}

static void put_parameters(struct json_text *t, const struct material *now,
                           const struct material *before, bool all)
{
    for (uint32_t i = 0; i < material_parameter_count; i++) {
        const struct material_parameter *p = &material_parameters[i];
        const float *values = &now->parameters[p->first];
        bool differs = !same(values, &before->parameters[p->first], p->count * sizeof *values);
        if (!differs && !(all && in_range(p, values)))
            continue;
        if (p->count == 3) {
            json_text_floats(t, p->name, values, 3);
        } else {
            json_text_key(t, p->name);
            json_text_float(t, values[0]);
        }
    }
}

static void put_extinction(struct json_text *t, const struct material *now,
                           const struct material *before, bool all)
{
    bool is_allowed = true;
    for (int c = 0; c < 3; c++)
        is_allowed =
            is_allowed && now->extinction[c] >= 0 &&
            (isinf(now->extinction[c]) || (double)now->extinction[c] <= RANGE_RADIANCE.max);
    if (SAME(now, before, extinction) && !(all && is_allowed))
        return;
    json_text_key(t, "extinction");
    json_text_open(t, '[', true);
    for (int c = 0; c < 3; c++) {
        json_text_next(t);
        if (isinf(now->extinction[c]) && now->extinction[c] > 0)
            json_text_string(t, "infinite");
        else
            json_text_float(t, now->extinction[c]);
    }
    json_text_close(t);
}

static void put_material(struct json_text *t, const struct scene_difference *d, uint32_t index,
                         bool all)
{
    const struct material *now = &d->scene->materials[index];
    const struct material *before = &d->before->materials[index];
    const struct names names = {material_name, d->before->material_count};
    json_text_next(t);
    json_text_open(t, '{', true);
    address(t, d->before, &names, index);
    if (all || now->model != before->model)
        put_choice(t, "type",
                   now->model < MATERIAL_MODEL_COUNT ? material_model_names[now->model]
                                                     : "unknown");
    put_parameters(t, now, before, all);
    put_flags(t, now, now->flags ^ before->flags, all);
    put_extinction(t, now, before, all);
    if (all || now->medium_priority != before->medium_priority) {
        json_text_key(t, "priority");
        json_text_uint(t, now->medium_priority);
    }
    json_text_close(t);
}

// --- lights --------------------------------------------------------------------------------------

static bool is_zero(const double v[3])
{
    return v[0] == 0 && v[1] == 0 && v[2] == 0;
}

static void put_light_range(struct json_text *t, float range)
{
    json_text_key(t, "range");
    if (isinf(range) && range > 0)
        json_text_string(t, "off");
    else
        json_text_float(t, range);
}

// Degrees whose angle, rounded to single precision, is this one: doubles lie densely enough.
static void put_angle(struct json_text *t, const char *key, float radians)
{
    char digits[32];
    double degrees = (double)radians / DEGREE;
    for (int count = 1; count <= 17; count++) {
        snprintf(digits, sizeof digits, "%.*g", count, degrees);
        double shorter = strtod(digits, NULL);
        if ((float)(shorter * DEGREE) == radians) {
            degrees = shorter;
            break;
        }
    }
    json_text_key(t, key);
    json_text_double(t, degrees);
}

static void put_profile(struct json_text *t, const struct light *now, const struct light *before,
                        bool all)
{
    if (!now->profile && (all || before->profile)) {
        json_text_key(t, "profile");
        json_text_bool(t, false);
    }
    if (!SAME(now, before, profile_x) || (all && !is_zero(now->profile_x)))
        json_text_doubles(t, "profile_x", now->profile_x, 3);
}

static void put_light(struct json_text *t, const struct scene_difference *d, uint32_t index,
                      const struct light *before, bool all)
{
    const struct light *now = &d->scene->lights[index];
    const struct names names = {light_name, d->scene->light_count};
    json_text_next(t);
    json_text_open(t, '{', true);
    address(t, d->scene, &names, index);
    if (all || now->kind != before->kind)
        put_choice(t, "type",
                   now->kind <= LIGHT_DIRECTIONAL ? edit_light_names[now->kind] : "unknown");
    if (all || !SAME(now, before, position))
        json_text_doubles(t, "position", now->position, 3);
    if (!SAME(now, before, direction) || (all && !is_zero(now->direction)))
        json_text_doubles(t, "direction", now->direction, 3);
    if (all || !SAME(now, before, radiant))
        json_text_floats(t, now->kind == LIGHT_DIRECTIONAL ? "irradiance" : "intensity",
                         now->radiant, 3);
    if (all || !SAME(now, before, range))
        put_light_range(t, now->range);
    if (all || !SAME(now, before, inner_angle))
        put_angle(t, "inner_degrees", now->inner_angle);
    if (all || !SAME(now, before, outer_angle))
        put_angle(t, "outer_degrees", now->outer_angle);
    if (all || !SAME(now, before, angular_radius))
        json_text_product(t, "angular_diameter_degrees", DEGREE, "angular_diameter_radians",
                          2 * now->angular_radius);
    put_profile(t, now, before, all);
    json_text_close(t);
}

// --- lists ---------------------------------------------------------------------------------------

// Opens the list `key` before its first element.
static void begin_list(struct json_text *t, const char *key, bool *is_open)
{
    if (*is_open)
        return;
    json_text_key(t, key);
    json_text_open(t, '[', false);
    *is_open = true;
}

static void put_materials(struct json_text *t, const struct scene_difference *d)
{
    bool is_open = false;
    for (uint32_t i = 0; i < d->scene->material_count; i++) {
        bool all = d->base && d->base->materials && d->base->materials[i];
        if (!all && same_material(&d->scene->materials[i], &d->before->materials[i]))
            continue;
        begin_list(t, "materials", &is_open);
        put_material(t, d, i, all);
    }
    if (is_open)
        json_text_close(t);
}

// The sun is the last light, so the others keep their places whether there is one or not.
static void put_lights(struct json_text *t, const struct scene_difference *d)
{
    bool is_open = false, is_other_sun = d->has_other_environment || d->has_other_adjustment;
    uint32_t sun = is_other_sun ? scene_sun_light(d->scene) : SCENE_NONE;
    for (uint32_t i = 0; i < d->scene->light_count; i++) {
        bool is_named =
            d->base && d->base->lights && i < d->base->light_count && d->base->lights[i];
        bool all = is_named || i == sun;
        const struct light *before =
            i < d->before->light_count ? &d->before->lights[i] : &d->scene->lights[i];
        if (!all && same_light(&d->scene->lights[i], before))
            continue;
        begin_list(t, "lights", &is_open);
        put_light(t, d, i, before, all);
    }
    if (is_open)
        json_text_close(t);
}

// What there is to say of an object.
struct object_edit {
    bool says_visible, says_material, visible, is_instance;
    uint32_t material;
};

static bool same_edit(const struct object_edit *a, const struct object_edit *b)
{
    return a->says_visible == b->says_visible && a->says_material == b->says_material &&
           a->is_instance == b->is_instance && (!a->says_visible || a->visible == b->visible) &&
           (!a->says_material || a->material == b->material);
}

static struct object_edit edit_of(const struct scene_difference *d, uint32_t index)
{
    const struct scene *now = d->scene, *before = d->before;
    bool all = d->base && d->base->objects && d->base->objects[index];
    if (index < now->instance_count) {
        const struct instance *a = &now->instances[index], *b = &before->instances[index];
        return (struct object_edit){all || a->hidden != b->hidden,
                                    all || a->material != b->material, !a->hidden, true,
                                    a->material};
    }
    const struct shape *a = &now->shapes[index - now->instance_count];
    const struct shape *b = &before->shapes[index - now->instance_count];
    return (struct object_edit){all || a->hidden != b->hidden, all || a->material != b->material,
                                !a->hidden, false, a->material};
}

static void put_objects_of(struct json_text *t, uint32_t first, uint32_t count,
                           const struct object_edit *edit)
{
    json_text_next(t);
    json_text_open(t, '{', true);
    json_text_key(t, "index");
    json_text_uint(t, first);
    if (count > 1) {
        json_text_key(t, "count");
        json_text_uint(t, count);
    }
    if (edit->says_visible) {
        json_text_key(t, "visible");
        json_text_bool(t, edit->visible);
    }
    if (edit->says_material) {
        json_text_key(t, "material");
        if (edit->material == SCENE_NONE)
            json_text_raw(t, "null");
        else
            json_text_uint(t, edit->material);
    }
    json_text_close(t);
}

// Runs of the same edit take one line.
static void put_objects(struct json_text *t, const struct scene_difference *d)
{
    uint32_t total = d->scene->instance_count + d->scene->shape_count, count;
    bool is_open = false;
    for (uint32_t i = 0; i < total; i += count) {
        const struct object_edit edit = edit_of(d, i);
        for (count = 1; i + count < total; count++) {
            const struct object_edit next = edit_of(d, i + count);
            if (!same_edit(&edit, &next))
                break;
        }
        if (!edit.says_visible && !edit.says_material)
            continue;
        begin_list(t, "objects", &is_open);
        put_objects_of(t, i, count, &edit);
    }
    if (is_open)
        json_text_close(t);
}

static void put_environment(struct json_text *t, const struct scene_difference *d)
{
    const struct environment *now = &d->scene->environment, *before = &d->before->environment;
    bool all =
        d->has_other_environment || d->has_other_adjustment || (d->base && d->base->environment);
    bool has_radiance = all || !SAME(now, before, radiance);
    bool has_rotation = all || !SAME(now, before, rotation);
    if (!now->present || (!has_radiance && !has_rotation))
        return;
    json_text_key(t, "environment");
    json_text_open(t, '{', true);
    if (has_radiance)
        json_text_floats(t, "radiance", now->radiance, 3);
    if (has_rotation)
        json_text_product(t, "rotation_degrees", DEGREE, "rotation_radians", now->rotation);
    json_text_close(t);
}

void scene_write_edits(struct json_text *t, const struct scene_difference *difference)
{
    json_text_key(t, "edits");
    json_text_open(t, '{', false);
    put_environment(t, difference);
    put_materials(t, difference);
    put_lights(t, difference);
    put_objects(t, difference);
    json_text_close(t);
}
