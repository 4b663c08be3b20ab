#include "scene/json/scene_write_edits.h"

#include "json/field_json.h"
#include "scene/core/environment.h"
#include "scene/core/placement.h"
#include "scene/json/scene_fields.h"
#include <string.h>

// --- comparisons ---------------------------------------------------------------------------------

static bool same_material(const struct scene_fields *fields, const struct material *a,
                          const struct material *b)
{
    return fields_same(fields->list, fields->count, a, b) && a->first_texture == b->first_texture &&
           a->texture_count == b->texture_count;
}

static bool same_light(const struct light *a, const struct light *b)
{
    struct scene_fields fields;
    scene_light_fields(a->kind, &fields);
    return fields_same(fields.list, fields.count, a, b) && a->profile == b->profile &&
           a->hidden == b->hidden;
}

bool scene_same_camera(const struct camera *a, const struct camera *b)
{
    struct scene_fields fields;
    scene_camera_fields(a, &fields);
    return a->kind == b->kind && fields_same(fields.list, fields.count, a, b);
}

// The members of an instance or a shape that may be edited.
struct object {
    bool is_instance, is_hidden;
    uint32_t material;
    struct placement placement;
};

static struct object object_of(const struct scene *scene, uint32_t index)
{
    if (index < scene->instance_count) {
        const struct instance *instance = &scene->instances[index];
        return (struct object){true, instance->hidden, instance->material,
                               scene_placement(scene, index)};
    }
    const struct shape *shape = &scene->shapes[index - scene->instance_count];
    return (struct object){false, shape->hidden, shape->material, scene_placement(scene, index)};
}

// Returns whether an object's geometry or transform, without its placement, is bitwise equal in
// both scenes.
static bool same_place(const struct scene *a, const struct scene *b, uint32_t object)
{
    if (object < a->instance_count)
        return memcmp(a->instances[object].transform, b->instances[object].transform,
                      sizeof a->instances[object].transform) == 0;
    const struct shape *x = &a->shapes[object - a->instance_count];
    const struct shape *y = &b->shapes[object - a->instance_count];
    return x->kind == y->kind && memcmp(x->center, y->center, sizeof x->center) == 0 &&
           memcmp(x->normal, y->normal, sizeof x->normal) == 0 &&
           memcmp(&x->radius, &y->radius, sizeof x->radius) == 0 &&
           memcmp(x->axes, y->axes, sizeof x->axes) == 0;
}

static bool differ(struct err *err, const char *what, uint32_t index)
{
    return err_set(err, ERR_INPUT, "%s %u: cannot be represented in the scene format", what, index);
}

bool scene_compare_edits(const struct scene *a, const struct scene *b, struct err *err)
{
    const struct environment *e = &a->environment, *f = &b->environment;
    struct scene_fields fields;
    scene_material_fields(&fields);
    if (a->material_count != b->material_count || a->light_count != b->light_count ||
        a->instance_count != b->instance_count || a->shape_count != b->shape_count)
        return err_set(
            err, ERR_INPUT,
            "materials, lights or objects were removed; expected edits and additions only");
    for (uint32_t i = 0; i < a->material_count; i++)
        if (!same_material(&fields, &a->materials[i], &b->materials[i]))
            return differ(err, "material", i);
    for (uint32_t i = 0; i < a->light_count; i++)
        if (!same_light(&a->lights[i], &b->lights[i]))
            return differ(err, "light", i);
    for (uint32_t i = 0; i < a->instance_count + a->shape_count; i++) {
        const struct object x = object_of(a, i), y = object_of(b, i);
        if (x.is_hidden != y.is_hidden || x.material != y.material || !same_place(a, b, i))
            return differ(err, "object", i);
    }
    if (e->present != f->present ||
        (e->present && (!fields_same(scene_environment_fields, 2, e, f) || e->width != f->width ||
                        e->height != f->height)))
        return err_set(err, ERR_INPUT,
                       "the environment: cannot be represented in the scene format");
    return true;
}

// --- lists ---------------------------------------------------------------------------------------

// Begins an element; before the first element also begins the list `key`.
static void begin_element(struct json_text *t, const char *key, bool *is_open)
{
    if (!*is_open) {
        json_text_key(t, key);
        json_text_open(t, '[', false);
    }
    *is_open = true;
    json_text_next(t);
    json_text_open(t, '{', true);
}

// Writes the name, which stays valid if the base changes, or the index if the name is not unique.
static void address(struct json_text *t, const struct scene *scene, uint32_t count, uint32_t index,
                    const char *(*name_of)(const struct scene *scene, uint32_t index))
{
    const char *name = name_of(scene, index);
    bool is_only = name && *name && json_text_can_hold(name);
    for (uint32_t i = 0; i < count && is_only; i++)
        is_only = i == index || !name_of(scene, i) || strcmp(name_of(scene, i), name) != 0;
    json_text_key(t, is_only ? "name" : "index");
    if (is_only)
        json_text_string(t, name);
    else
        json_text_uint(t, index);
}

// Marks an element as an addition to the base.
static void put_new(struct json_text *t, const char *name)
{
    json_text_key(t, "added");
    json_text_bool(t, true);
    if (name && *name && json_text_can_hold(name)) {
        json_text_key(t, "name");
        json_text_string(t, name);
    }
}

static void put_materials(struct json_text *t, const struct scene_difference *d)
{
    const struct scene *now = d->scene, *before = d->before;
    struct scene_fields fields;
    bool is_open = false;
    scene_material_fields(&fields);
    for (uint32_t i = 0; i < now->material_count; i++) {
        const struct material *to = &now->materials[i], *from = &before->materials[i];
        if (i >= before->material_count) {
            begin_element(t, "materials", &is_open);
            put_new(t, to->name);
            fields_write(fields.list, fields.count, to, t);
            json_text_close(t);
            continue;
        }
        if (same_material(&fields, to, from))
            continue;
        begin_element(t, "materials", &is_open);
        address(t, before, before->material_count, i, scene_material_name);
        fields_write_changed(fields.list, fields.count, to, from, t);
        json_text_close(t);
    }
    if (is_open)
        json_text_close(t);
}

// Writes a light's fields that differ from `before`; NULL: all fields.
static void put_light(struct json_text *t, const struct light *now, const struct light *before)
{
    struct scene_fields fields;
    scene_light_fields(now->kind, &fields);
    if (now->hidden != (before && before->hidden)) {
        json_text_key(t, "visible");
        json_text_bool(t, !now->hidden);
    }
    if (!before) {
        fields_write(fields.list, fields.count, now, t);
        return;
    }
    fields_write_changed(fields.list, fields.count, now, before, t);
    if (!now->profile && before->profile) {
        json_text_key(t, "profile");
        json_text_bool(t, false);
    }
}

// Returns light i of the base, or NULL if the base has no such light. The sun is the last light of
// both scenes, and added lights precede it, so the other lights keep their indices.
static const struct light *former_light(const struct scene_difference *d, uint32_t i)
{
    uint32_t sun = scene_sun_light(d->scene), former_sun = scene_sun_light(d->before);
    uint32_t others = d->before->light_count - (former_sun != SCENE_NONE);
    bool is_other_sun = d->has_other_environment || d->has_other_adjustment;
    if (i == sun)
        return is_other_sun || former_sun == SCENE_NONE ? NULL : &d->before->lights[former_sun];
    return i < others ? &d->before->lights[i] : NULL;
}

static void put_lights(struct json_text *t, const struct scene_difference *d)
{
    const struct scene *now = d->scene;
    uint32_t sun = scene_sun_light(now);
    bool is_open = false;
    for (uint32_t i = 0; i < now->light_count; i++) {
        const struct light *from = former_light(d, i);
        if (from && same_light(&now->lights[i], from))
            continue;
        begin_element(t, "lights", &is_open);
        if (from || i == sun)
            address(t, now, now->light_count, i, scene_light_name);
        else
            put_new(t, now->lights[i].name);
        put_light(t, &now->lights[i], from);
        json_text_close(t);
    }
    if (is_open)
        json_text_close(t);
}

// The edits of an object that must be written.
struct object_edit {
    bool is_new, says_visible, says_material, says_place;
    struct object to;
};

// Finds the edits of an object. `before` lacks shapes that were added.
static struct object_edit edit_of(const struct scene_difference *d, uint32_t index)
{
    const struct object to = object_of(d->scene, index);
    bool says_place = !placement_is_none(&to.placement);
    if (index >= d->before->instance_count + d->before->shape_count)
        return (struct object_edit){true, to.is_hidden, true, says_place, to};
    const struct object from = object_of(d->before, index);
    return (struct object_edit){false, to.is_hidden != from.is_hidden, to.material != from.material,
                                says_place, to};
}

// Returns whether two edits can share a line. Edits with a placement cannot.
static bool same_edit(const struct object_edit *a, const struct object_edit *b)
{
    return !a->is_new && !b->is_new && !a->says_place && !b->says_place &&
           a->says_visible == b->says_visible && a->says_material == b->says_material &&
           a->to.is_instance == b->to.is_instance &&
           (!a->says_visible || a->to.is_hidden == b->to.is_hidden) &&
           (!a->says_material || a->to.material == b->to.material);
}

// Writes a shape as it was when it was added; a placement may have moved it since.
static void put_new_shape(struct json_text *t, const struct scene *scene, uint32_t object)
{
    const struct shape *shape = &scene->shapes[object - scene->instance_count];
    const struct placed_object *placed = scene_find_placed(scene, object);
    if (placed)
        shape = &placed->shape;
    json_text_key(t, "added");
    json_text_string(t, "quad");
    fields_write(scene_quad_fields, 3, shape, t);
}

static void put_object_edit(struct json_text *t, const struct object_edit *edit)
{
    if (edit->says_visible) {
        json_text_key(t, "visible");
        json_text_bool(t, !edit->to.is_hidden);
    }
    if (edit->says_material) {
        json_text_key(t, "material");
        if (edit->to.material == SCENE_NONE)
            json_text_raw(t, "null");
        else
            json_text_uint(t, edit->to.material);
    }
    if (edit->says_place)
        fields_write(scene_placement_fields, 4, &edit->to.placement, t);
}

// Writes the edits of objects, one line for each run of objects with the same edit.
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
        if (!edit.is_new && !edit.says_visible && !edit.says_material && !edit.says_place)
            continue;
        begin_element(t, "objects", &is_open);
        if (edit.is_new) {
            put_new_shape(t, d->scene, i);
        } else {
            json_text_key(t, "index");
            json_text_uint(t, i);
        }
        if (count > 1) {
            json_text_key(t, "count");
            json_text_uint(t, count);
        }
        put_object_edit(t, &edit);
        json_text_close(t);
    }
    if (is_open)
        json_text_close(t);
}

static void put_environment(struct json_text *t, const struct scene_difference *d)
{
    const struct environment *now = &d->scene->environment, *before = &d->before->environment;
    bool all = d->has_other_environment || d->has_other_adjustment;
    if (!now->present || (!all && fields_same(scene_environment_fields, 2, now, before)))
        return;
    json_text_key(t, "environment");
    json_text_open(t, '{', true);
    if (all)
        fields_write(scene_environment_fields, 2, now, t);
    else
        fields_write_changed(scene_environment_fields, 2, now, before, t);
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
