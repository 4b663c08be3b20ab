// Finds objects that exist twice: with the same form, at the same place.
#include "check/scene/survey.h"

#include "base/hash.h"
#include <stdlib.h>
#include <string.h>

// --- objects -------------------------------------------------------------------------------------

// The form and the place of an object; compared byte by byte.
struct identity {
    uint64_t kind; // kind of the shape plus 1; 0 for an instance
    uint64_t form; // hash of the mesh, or the index of a distance field
    double numbers[18];
    uint32_t object;
};

// Returns a hash of the mesh's triangles. Comparing files would not be enough: a file that is named
// twice is loaded twice.
static uint64_t form_of_mesh(const struct mesh *mesh)
{
    struct hash128 parts[] = {
        mesh->exact_positions
            ? hash128_bytes(mesh->exact_positions,
                            mesh->vertex_count * sizeof *mesh->exact_positions)
            : hash128_bytes(mesh->positions, mesh->vertex_count * sizeof *mesh->positions),
        hash128_bytes(mesh->indices, mesh->triangle_count * sizeof *mesh->indices)};
    return hash_bytes(HASH_INIT, parts, sizeof parts);
}

// Returns the identity of an object. `forms` has the forms of all meshes.
static struct identity identity_of(const struct scene *scene, const uint64_t *forms,
                                   uint32_t object)
{
    struct identity identity = {.object = object};
    if (object < scene->instance_count) {
        const struct instance *instance = &scene->instances[object];
        identity.form = forms[instance->mesh];
        memcpy(identity.numbers, instance->transform, sizeof instance->transform);
        return identity;
    }
    const struct shape *shape = &scene->shapes[object - scene->instance_count];
    identity.kind = (uint64_t)shape->kind + 1;
    identity.form = shape->kind == SHAPE_SDF ? shape->sdf : 0;
    memcpy(&identity.numbers[0], shape->center, sizeof shape->center);
    memcpy(&identity.numbers[3], shape->normal, sizeof shape->normal);
    memcpy(&identity.numbers[6], shape->axes, sizeof shape->axes);
    identity.numbers[15] = shape->radius;
    return identity;
}

static const struct mesh *mesh_of(const struct scene *scene, uint32_t object)
{
    return object < scene->instance_count ? &scene->meshes[scene->instances[object].mesh] : NULL;
}

// Returns the material of a triangle of an object; a shape has only one material.
static uint32_t material_of(const struct scene *scene, uint32_t object, uint32_t triangle)
{
    if (object >= scene->instance_count)
        return scene->shapes[object - scene->instance_count].material;
    const struct mesh *mesh = mesh_of(scene, object);
    uint32_t material = scene->instances[object].material;
    return material != SCENE_NONE    ? material
           : mesh->triangle_material ? mesh->triangle_material[triangle]
                                     : mesh->material;
}

#define IDENTITY_BYTES offsetof(struct identity, object)

static int compare(const void *a, const void *b)
{
    const struct identity *x = a, *y = b;
    int order = memcmp(x, y, IDENTITY_BYTES);
    return order ? order : (x->object > y->object) - (x->object < y->object);
}

// The effects of two objects at the same place, in ascending order of severity.
enum twins {
    TWINS_IDLE,    // no effect, and one of them can be hidden
    TWINS_ALIKE,   // no effect, because they look the same
    TWINS_SHARE,   // no effect, because each is visible in the gaps of the other
    TWINS_DOUBLED, // both contribute
    TWINS_CLASH,   // they look different, and one hides the other
    TWINS_COUNT
};

static bool is_same(const void *a, const void *b, size_t bytes)
{
    return a == b || (a && b && memcmp(a, b, bytes) == 0);
}

// Returns whether two meshes with the same triangles are shaded alike.
static bool looks_alike(const struct mesh *a, const struct mesh *b)
{
    size_t count = a->vertex_count;
    return a == b || (a->vertex_count == b->vertex_count &&
                      is_same(a->normals, b->normals, count * sizeof *a->normals) &&
                      is_same(a->tangents, b->tangents, count * sizeof *a->tangents) &&
                      is_same(a->uvs[0], b->uvs[0], count * sizeof *a->uvs[0]) &&
                      is_same(a->uvs[1], b->uvs[1], count * sizeof *a->uvs[1]) &&
                      is_same(a->colors, b->colors, count * sizeof *a->colors));
}

// Returns whether two materials are equal except for their names.
static bool is_one_material(const struct scene *scene, uint32_t first, uint32_t second)
{
    const struct material *a = &scene->materials[first], *b = &scene->materials[second];
    return first == second ||
           (a->model == b->model && a->flags == b->flags &&
            is_same(a->parameters, b->parameters, sizeof a->parameters) &&
            is_same(a->extinction, b->extinction, sizeof a->extinction) &&
            a->medium_priority == b->medium_priority && a->texture_count == b->texture_count &&
            is_same(&scene->textures[a->first_texture], &scene->textures[b->first_texture],
                    a->texture_count * sizeof *scene->textures));
}

// Returns the effect of two coincident surfaces with this material. Two surfaces of glass, or two
// thin panes, look like one: transmitted rays start beyond the rounding error of the surface, and
// so behind both.
static enum twins twins_of_material(const struct survey *survey, uint32_t material)
{
    const struct material *m = &survey->scene->materials[material];
    bool is_opaque = !material_lets_through(m) && !survey_has_gaps(survey, material) &&
                     m->diffuse_transmission <= 0.0f;
    if (survey_counts_twice(survey, material))
        return TWINS_DOUBLED;
    return is_opaque && !material_emits(m) ? TWINS_IDLE : TWINS_ALIKE;
}

static enum twins twins_of(const struct survey *survey, uint32_t a, uint32_t b)
{
    const struct scene *scene = survey->scene;
    const struct mesh *of_a = mesh_of(scene, a), *of_b = mesh_of(scene, b);
    bool alike = !of_a || looks_alike(of_a, of_b);
    enum twins most = TWINS_IDLE;
    for (uint32_t i = 0; i < (of_a ? of_a->triangle_count : 1); i++) {
        uint32_t first = material_of(scene, a, i), second = material_of(scene, b, i);
        bool gaps = survey_has_gaps(survey, first) && survey_has_gaps(survey, second);
        enum twins twins = alike && is_one_material(scene, first, second)
                               ? twins_of_material(survey, first)
                           : gaps ? TWINS_SHARE
                                  : TWINS_CLASH;
        most = twins > most ? twins : most;
    }
    return most;
}

// The objects that have one kind of effect.
struct twin_list {
    uint32_t count, first, second; // number of superfluous objects, and the first pair
    bool *marked;                  // a flag for each object that is part of a pair
    bool *firsts, *again;          // flags for the first object of each pair, and for the second
};

// Evaluates the objects at one place. If fixes are requested and all objects are equal, hides all
// but the first. Unequal objects are kept, because otherwise the visible object might change.
static void take_place(struct survey *survey, const struct identity *list, uint32_t count,
                       struct twin_list *lists)
{
    bool is_idle = true;
    for (uint32_t i = 1; i < count && is_idle; i++)
        is_idle = twins_of(survey, list[0].object, list[i].object) == TWINS_IDLE;
    for (uint32_t i = 1; i < count; i++) {
        enum twins twins = TWINS_SHARE;
        uint32_t at = 0, object = list[i].object;
        for (; at < i && twins == TWINS_SHARE; at++)
            twins = is_idle ? TWINS_IDLE : twins_of(survey, list[at].object, object);
        if (twins == TWINS_SHARE)
            continue;
        struct twin_list *out = &lists[twins == TWINS_IDLE && !is_idle ? TWINS_ALIKE : twins];
        uint32_t twin = list[at - 1].object;
        if (out->count++ == 0) {
            out->first = twin;
            out->second = object;
        }
        out->marked[twin] = out->marked[object] = true;
        out->firsts[twin] = out->again[object] = true;
        if (is_idle)
            *survey_hidden(survey, object) |= survey->params->fixes;
    }
}

static bool find_twins(struct survey *survey, struct twin_list *lists, struct err *err)
{
    struct scene *scene = survey->scene;
    uint32_t all = survey_object_count(survey), count = 0;
    struct identity *list = ARENA_NEW(&survey->scratch, struct identity, all);
    bool *marked = ARENA_NEW(&survey->scratch, bool, (size_t)all * 3 * TWINS_COUNT);
    survey->places = ARENA_NEW(&survey->scratch, uint32_t, all);
    uint64_t *forms = ARENA_NEW(&survey->scratch, uint64_t, scene->mesh_count);
    if (!list || !marked || !survey->places || !forms)
        return err_memory(err, "objects", all * sizeof *list);
    for (uint32_t i = 0; i < TWINS_COUNT; i++) {
        lists[i].marked = &marked[(size_t)i * 3 * all];
        lists[i].firsts = lists[i].marked + all;
        lists[i].again = lists[i].firsts + all;
    }
    for (uint32_t i = 0; i < scene->mesh_count; i++)
        forms[i] = form_of_mesh(&scene->meshes[i]);
    for (uint32_t i = 0; i < all; i++)
        if (!*survey_hidden(survey, i))
            list[count++] = identity_of(scene, forms, i);
    qsort(list, count, sizeof *list, compare);
    for (uint32_t first = 0, end; first < count; first = end) {
        for (end = first; end < count && !memcmp(&list[first], &list[end], IDENTITY_BYTES); end++)
            survey->places[list[end].object] = first;
        take_place(survey, &list[first], end - first, lists);
    }
    return true;
}

// --- the findings --------------------------------------------------------------------------------

static const struct {
    enum finding_level level;
    const char *consequence, *remedy;
} words[TWINS_COUNT] = {
    [TWINS_IDLE] = {FINDING_REMARK, "They cost memory and time without any effect on the image.",
                    "Remove or hide the second one."},
    [TWINS_ALIKE] = {FINDING_REMARK, "They cost memory and time without any effect on the image.",
                     "Remove or hide one of them."},
    [TWINS_DOUBLED] = {FINDING_WRONG, "Emissive or blended surfaces count twice there.",
                       "Remove or hide one of them; this changes the image."},
    [TWINS_CLASH] = {FINDING_WRONG,
                     "The order of the objects decides which of the two materials is visible; "
                     "light that the other one emits still counts.",
                     "Remove or hide the one that should not be visible, or move one of them by a "
                     "visible distance."},
};

// Returns the text of what --fix does: if it hides several objects, the first one is named. Returns
// NULL when out of memory.
static const char *change_of(struct survey *survey, const struct twin_list *list)
{
    uint32_t material = material_of(survey->scene, list->second, 0);
    const char *object = survey_object_name(survey, list->second);
    const char *name = survey_material_name(survey, material);
    if (!object || !name)
        return NULL;
    return list->count == 1
               ? arena_printf(survey->arena, "%s (%s) is hidden", object, name)
               : arena_printf(survey->arena,
                              "%u objects are hidden, the first one of them is %s (%s)",
                              list->count, object, name);
}

// Sets *touched to the pixels that show the objects and to those that differ between the images
// that may have been intended. For doubled objects these are the images with all objects and with
// one at each place; for objects that clash, the images without the first ones and without the
// others. Lamps and panes also change pixels in which they are not visible. *touched is NULL if
// there are no such pixels.
static bool find_touched(struct survey *survey, enum twins twins, const struct twin_list *list,
                         const uint8_t **touched, struct err *err)
{
    double *one, *other;
    const uint8_t *different, *seen = survey_touched_by_objects(survey, list->marked);
    uint8_t *flags = survey_flags(survey);
    *touched = seen;
    if (twins != TWINS_DOUBLED && twins != TWINS_CLASH)
        return true;
    if (!flags)
        return err_memory(err, "flags", survey->line_count);
    if (!(twins == TWINS_DOUBLED ? survey_render_again(survey, &one, err)
                                 : survey_render_without(survey, list->firsts, &one, err)) ||
        !survey_render_without(survey, list->again, &other, err))
        return false;
    bool differs = survey_difference(survey, one, other, &different) >= DIFFERENCE_MIN;
    for (uint32_t i = 0; seen && different && i < survey->line_count; i++)
        flags[i] = seen[i] | (differs ? different[i] : 0u);
    *touched = differs || survey_share(survey, seen) > 0.0 ? flags : NULL;
    return true;
}

static bool add_list(struct survey *survey, enum twins twins, const struct twin_list *list,
                     struct err *err)
{
    struct arena *arena = survey->arena;
    const uint8_t *touched;
    const char *a = survey_object_name(survey, list->first);
    const char *b = survey_object_name(survey, list->second);
    const char *change = twins == TWINS_IDLE ? change_of(survey, list) : NULL;
    if (twins == TWINS_IDLE && !change)
        return err_memory(err, "names", 0);
    if (!find_touched(survey, twins, list, &touched, err))
        return false;
    return survey_add(
        survey,
        &(struct scene_finding){
            .name = "object-twice",
            .level = touched ? words[twins].level : FINDING_REMARK,
            .place = a && b ? arena_printf(arena, "%s, and %s", a, b) : NULL,
            .figure = arena_printf(arena, "%u object%s at exactly the same place as another",
                                   list->count, list->count == 1 ? "" : "s"),
            .consequence = touched ? words[twins].consequence
                                   : "They cost memory and time; renders show that the image is "
                                     "the same without them.",
            .remedy = words[twins].remedy,
            .share = survey_share(survey, touched),
            .pixels = touched,
            .change = change,
        },
        err);
}

bool find_twice(struct survey *survey, struct err *err)
{
    survey->twins = ARENA_NEW(&survey->scratch, struct twin_list, TWINS_COUNT);
    return survey->twins ? find_twins(survey, survey->twins, err)
                         : err_memory(err, "objects", TWINS_COUNT * sizeof *survey->twins);
}

bool name_twice(struct survey *survey, struct err *err)
{
    for (enum twins twins = TWINS_IDLE; twins < TWINS_COUNT; twins++)
        if (survey->twins[twins].count > 0 && !add_list(survey, twins, &survey->twins[twins], err))
            return false;
    return true;
}
