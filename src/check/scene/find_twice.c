// Objects that are there twice: of one form, at one place.
#include "check/scene/survey.h"

#include "base/hash.h"
#include <stdlib.h>
#include <string.h>

// --- objects -------------------------------------------------------------------------------------

// What an object is and where, for comparing bytes.
struct identity {
    uint64_t kind; // of shapes, plus 1; 0: an instance
    uint64_t form; // of the mesh, or the number of a distance field
    double numbers[18];
    uint32_t object;
};

// The form is the same for meshes of the same triangles: a file that is named twice is loaded
// twice.
static uint64_t form_of_mesh(const struct mesh *mesh)
{
    struct hash128 parts[] = {
        hash128_bytes(mesh->positions, mesh->vertex_count * sizeof *mesh->positions),
        hash128_bytes(mesh->indices, mesh->triangle_count * sizeof *mesh->indices)};
    return hash_bytes(HASH_INIT, parts, sizeof parts);
}

// forms: of all meshes
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

static bool is_hidden(const struct scene *scene, uint32_t object)
{
    return object < scene->instance_count ? scene->instances[object].hidden
                                          : scene->shapes[object - scene->instance_count].hidden;
}

static bool *hidden_of(struct scene *scene, uint32_t object)
{
    return object < scene->instance_count ? &scene->instances[object].hidden
                                          : &scene->shapes[object - scene->instance_count].hidden;
}

static const struct mesh *mesh_of(const struct scene *scene, uint32_t object)
{
    return object < scene->instance_count ? &scene->meshes[scene->instances[object].mesh] : NULL;
}

// Returns the material of one of an object's triangles; shapes have a single one.
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

struct twins {
    uint32_t count, first, second; // objects that are there again; the first pair
    bool *marked;                  // flags of all objects: those that are there twice
    bool matter;                   // what is there twice counts twice, or is of two materials
};

static bool is_same(const void *a, const void *b, size_t bytes)
{
    return a == b || (a && b && memcmp(a, b, bytes) == 0);
}

// Returns whether textures and colours lie alike on two meshes of the same triangles.
static bool looks_alike(const struct mesh *a, const struct mesh *b)
{
    size_t count = a->vertex_count;
    return a == b || (a->vertex_count == b->vertex_count &&
                      is_same(a->uvs[0], b->uvs[0], count * sizeof *a->uvs[0]) &&
                      is_same(a->uvs[1], b->uvs[1], count * sizeof *a->uvs[1]) &&
                      is_same(a->colors, b->colors, count * sizeof *a->colors));
}

// Two objects at one place.
struct twin_pair {
    bool shares_place; // one of them has gaps, through which the other, which differs, is seen
    bool matters;
};

static struct twin_pair pair_of(const struct survey *survey, uint32_t a, uint32_t b)
{
    const struct scene *scene = survey->scene;
    const struct mesh *of_a = mesh_of(scene, a), *of_b = mesh_of(scene, b);
    bool differs = of_a && !looks_alike(of_a, of_b), gaps = false;
    struct twin_pair pair = {0};
    for (uint32_t i = 0; i < (of_a ? of_a->triangle_count : 1); i++) {
        uint32_t first = material_of(scene, a, i), second = material_of(scene, b, i);
        differs |= first != second;
        gaps |= survey_has_gaps(survey, first) || survey_has_gaps(survey, second);
        pair.matters |= survey_differs_doubled(survey, first, second);
    }
    pair.shares_place = differs && gaps;
    return pair;
}

// Returns the object that the one at `at` repeats, among those at its place, which begin at
// `first`; or `at` where it repeats none.
static uint32_t find_twin(const struct survey *survey, const struct identity *list, uint32_t first,
                          uint32_t at, struct twin_pair *pair)
{
    for (uint32_t i = first; i < at; i++) {
        *pair = pair_of(survey, list[i].object, list[at].object);
        if (!pair->shares_place)
            return i;
    }
    return at;
}

static bool find_twins(struct survey *survey, struct twins *twins, struct err *err)
{
    struct scene *scene = survey->scene;
    uint32_t all = survey_object_count(survey), count = 0;
    struct identity *list = ARENA_NEW(&survey->scratch, struct identity, all);
    twins->marked = ARENA_NEW(&survey->scratch, bool, all);
    survey->places = ARENA_NEW(&survey->scratch, uint32_t, all);
    uint64_t *forms = ARENA_NEW(&survey->scratch, uint64_t, scene->mesh_count);
    if (!list || !twins->marked || !survey->places || !forms)
        return err_memory(err, "objects", all * sizeof *list);
    for (uint32_t i = 0; i < scene->mesh_count; i++)
        forms[i] = form_of_mesh(&scene->meshes[i]);
    for (uint32_t i = 0; i < all; i++)
        if (!is_hidden(scene, i))
            list[count++] = identity_of(scene, forms, i);
    qsort(list, count, sizeof *list, compare);
    for (uint32_t i = 0, first = 0; i < count; i++) {
        if (memcmp(&list[first], &list[i], IDENTITY_BYTES) != 0)
            first = i;
        survey->places[list[i].object] = first;
        struct twin_pair pair;
        uint32_t twin = find_twin(survey, list, first, i, &pair);
        if (twin == i)
            continue;
        uint32_t a = list[twin].object, b = list[i].object;
        if (twins->count++ == 0 || (pair.matters && !twins->matter)) {
            twins->first = a;
            twins->second = b;
        }
        twins->matter |= pair.matters;
        twins->marked[a] = twins->marked[b] = true;
        *hidden_of(scene, b) |= survey->params->fixes;
    }
    return true;
}

bool find_twice(struct survey *survey, struct err *err)
{
    struct twins twins = {0};
    if (!find_twins(survey, &twins, err))
        return false;
    if (twins.count == 0)
        return true;
    struct arena *arena = survey->arena;
    const char *a = survey_object_name(survey, twins.first);
    const char *b = survey_object_name(survey, twins.second);
    const uint8_t *touched = survey_touched_by_objects(survey, twins.marked);
    return survey_add(
        survey,
        &(struct scene_finding){
            .name = "object-twice",
            .level = twins.matter ? FINDING_WRONG : FINDING_REMARK,
            .place = a && b ? arena_printf(arena, "%s, and %s", a, b) : NULL,
            .figure = arena_printf(arena, "%u object%s at the very place of another", twins.count,
                                   twins.count == 1 ? "" : "s"),
            .consequence = twins.matter ? "What emits or lets light through counts twice there, "
                                          "and of two materials the first one is seen."
                                        : "They cost memory and time, and change nothing.",
            .remedy = "Remove or hide the second one.",
            .share = survey_share(survey, touched),
            .pixels = touched,
            .change = "the second one is hidden",
        },
        err);
}
