// Surfaces that lie upon each other: objects that are there twice, and faces of others in the same
// plane, as a ray that starts just above finds them.
#include "check/scene/survey.h"

#include "base/hash.h"
#include "base/maths.h"
#include "shared/types.h"
#include <float.h>
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

// Of one of its triangles; shapes have one material.
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
    bool *marked;                  // of all objects, those that are there twice
    uint32_t *places;              // a number for each object, the same for those at one place
    bool matter;                   // what is there twice counts twice, or is of two materials
};

static bool has_gaps(const struct survey *survey, uint32_t material)
{
    return survey->scene->materials[material].flags & (MATERIAL_ALPHA_MASK | MATERIAL_ALPHA_BLEND);
}

// Whether two surfaces at one place differ from one. Lamps do where light is looked for twice.
static bool matters(const struct survey *survey, uint32_t a, uint32_t b)
{
    const struct material *m = &survey->scene->materials[a];
    bool lights = survey->settings.nee && survey->settings.max_bounces > 0;
    return a != b || (lights && material_emits(m)) || material_lets_through(m) ||
           (m->flags & MATERIAL_ALPHA_BLEND);
}

static bool is_same(const void *a, const void *b, size_t bytes)
{
    return a == b || (a && b && memcmp(a, b, bytes) == 0);
}

// Whether textures and colours lie alike on two meshes of the same triangles.
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
        gaps |= has_gaps(survey, first) || has_gaps(survey, second);
        pair.matters |= matters(survey, first, second);
    }
    pair.shares_place = differs && gaps;
    return pair;
}

// Of those in front of `at` that are at its place, the one that it repeats; `at`: none.
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
    twins->places = ARENA_NEW(&survey->scratch, uint32_t, all);
    uint64_t *forms = ARENA_NEW(&survey->scratch, uint64_t, scene->mesh_count);
    if (!list || !twins->marked || !twins->places || !forms)
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
        twins->places[list[i].object] = first;
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

static bool find_same_objects(struct survey *survey, struct twins *twins, struct err *err)
{
    if (!find_twins(survey, twins, err))
        return false;
    if (twins->count == 0)
        return true;
    struct arena *arena = survey->arena;
    const char *a = survey_object_name(survey, twins->first);
    const char *b = survey_object_name(survey, twins->second);
    const uint8_t *touched = survey_touched_by_objects(survey, twins->marked);
    return survey_add(
        survey,
        &(struct scene_finding){
            .name = "object-twice",
            .level = twins->matter ? FINDING_WRONG : FINDING_REMARK,
            .place = a && b ? arena_printf(arena, "%s, and %s", a, b) : NULL,
            .figure = arena_printf(arena, "%u object%s at the very place of another", twins->count,
                                   twins->count == 1 ? "" : "s"),
            .consequence = twins->matter ? "What emits or lets light through counts twice there, "
                                           "and of two materials the first one is seen."
                                         : "They cost memory and time, and change nothing.",
            .remedy = "Remove or hide the second one.",
            .share = survey_share(survey, touched),
            .pixels = touched,
            .change = "the second one is hidden",
        },
        err);
}

// --- faces ---------------------------------------------------------------------------------------

// A ray that falls onto a surface from a small height above it.
struct drop {
    const struct sighting *at;
    uint32_t line; // of the camera, that leads there
    double direction[3], height, tolerance;
};

// Heights of which rounding leaves 6 digits in binary: faces count as upon each other where they
// are nearer than twice the kernels' own bound of where they are.
#define HEIGHT_IN_TOLERANCES 64.0

static struct drop drop_onto(const struct sighting *at, uint32_t line)
{
    struct drop drop = {.at = at, .line = line};
    for (int c = 0; c < 3; c++) {
        drop.direction[c] = at->is_front ? -at->normal[c] : at->normal[c];
        drop.tolerance = fmax(drop.tolerance, fabs(at->point[c]));
    }
    drop.tolerance *= 8.0 * (double)FLT_EPSILON;
    drop.height = HEIGHT_IN_TOLERANCES * drop.tolerance;
    return drop;
}

// Kernels ignore planar surfaces that a ray starts on, and no others.
static bool is_planar(const struct survey *survey, const struct sighting *at)
{
    if (!(at->hit.primitive & PRIMITIVE_SHAPE))
        return true;
    enum shape_kind kind = survey->flat->shapes[at->hit.primitive & ~PRIMITIVE_SHAPE].kind;
    return kind == SHAPE_DISC || kind == SHAPE_PLANE || kind == SHAPE_QUAD;
}

static struct probe_ray ray_of(const struct drop *drop)
{
    struct probe_ray ray = {
        .leaves = true, .from = drop->at->hit.primitive, .from_instance = drop->at->hit.instance};
    for (int c = 0; c < 3; c++) {
        ray.origin[c] = (float)(drop->at->point[c] - drop->height * drop->direction[c]);
        ray.direction[c] = (float)drop->direction[c];
    }
    return ray;
}

struct pairs {
    uint32_t count; // of lines
    uint8_t *touched;
    struct sighting first[2];
};

static void note_pair(struct pairs *pairs, uint32_t line, const struct sighting *a,
                      const struct sighting *b)
{
    if (pairs->count == 0) {
        pairs->first[0] = *a;
        pairs->first[1] = *b;
    }
    pairs->count += !pairs->touched[line];
    pairs->touched[line] = 1;
}

// Whether one has gaps for the other to be seen through: both, or one of two objects at one place,
// of which rounding finds the first one first. Of one material all is alike.
static bool is_seen_through(const struct survey *survey, const struct twins *twins,
                            const struct sighting *a, const struct sighting *b)
{
    bool gaps_of_a = has_gaps(survey, a->material), gaps_of_b = has_gaps(survey, b->material);
    bool is_one_place = twins->places[a->object] == twins->places[b->object];
    return a->material != b->material &&
           ((gaps_of_a && gaps_of_b) || (is_one_place && (gaps_of_a || gaps_of_b)));
}

// Whether what is met lies upon what the ray was dropped onto.
static bool lies_upon(const struct survey *survey, const struct twins *twins,
                      const struct drop *drop, const struct probe_ray *ray,
                      const struct probe_hit *hit, struct sighting *other)
{
    double origin[3];
    if (hit->primitive == NO_PRIMITIVE || fabs((double)hit->t - drop->height) > drop->tolerance ||
        hit->primitive == drop->at->hit.primitive)
        return false;
    vec3_widen(ray->origin, origin);
    sighting_find(survey, hit, origin, drop->direction, other);
    // Not a neighbour at an edge: the same plane.
    return fabs(vec3_dot(other->normal, drop->at->normal)) > 1.0 - 1e-6 &&
           matters(survey, drop->at->material, other->material) &&
           !is_seen_through(survey, twins, drop->at, other);
}

static bool drop_rays(struct survey *survey, const struct twins *twins, struct pairs *pairs,
                      struct err *err)
{
    struct arena scratch = {0};
    uint32_t most = survey->job.renderer.plan.wave_slots, count = 0, steps = 0;
    for (uint32_t i = 0; i < survey->line_count; i++)
        steps += survey->lines[i].count;
    struct drop *drops = ARENA_NEW(&scratch, struct drop, steps);
    struct probe_ray *rays = ARENA_NEW(&scratch, struct probe_ray, steps);
    struct probe_hit *hits = ARENA_NEW(&scratch, struct probe_hit, steps);
    pairs->touched = survey_flags(survey);
    bool complete, ok = drops && rays && hits && pairs->touched;
    if (!ok)
        err_memory(err, "rays", steps * sizeof *rays);
    for (uint32_t i = 0; ok && i < survey->line_count; i++)
        for (uint32_t k = 0; k < survey->lines[i].count; k++) {
            if (!is_planar(survey, &survey->lines[i].steps[k]))
                continue;
            drops[count] = drop_onto(&survey->lines[i].steps[k], i);
            rays[count] = ray_of(&drops[count]);
            count++;
        }
    for (uint32_t i = 0; ok && i < count; i += most)
        ok = job_trace_rays(&survey->job, &rays[i], count - i < most ? count - i : most, &hits[i],
                            &complete, err);
    for (uint32_t i = 0; ok && i < count; i++) {
        struct sighting other;
        if (!lies_upon(survey, twins, &drops[i], &rays[i], &hits[i], &other))
            continue;
        note_pair(pairs, drops[i].line, drops[i].at, &other);
    }
    arena_finish(&scratch);
    return ok;
}

// Curved ones are compared with each other by what they are, as no ray ignores them: where the
// point of a line lies on both.
static bool is_curved(const struct flat_shape *shape)
{
    return shape->kind == SHAPE_SPHERE || shape->kind == SHAPE_CYLINDER ||
           shape->kind == SHAPE_TUBE;
}

// From a sphere's surface, or a cylinder's side; *normal points away from its middle. INFINITY: the
// point is beside the cylinder.
static double distance_from(const struct flat_shape *shape, const double point[3], double normal[3])
{
    double axis[3];
    for (int c = 0; c < 3; c++)
        normal[c] = point[c] - (double)shape->center[c];
    if (shape->kind != SHAPE_SPHERE) {
        vec3_widen(shape->axes[0], axis);
        double along = vec3_dot(normal, axis) / vec3_dot(axis, axis);
        if (fabs(along) > 1.0)
            return INFINITY;
        for (int c = 0; c < 3; c++)
            normal[c] -= along * axis[c];
    }
    double length = vec3_length(normal);
    vec3_normalize(normal);
    return length - (double)shape->radius;
}

// Whether the point lies on another shape, too, to the tolerance of dropped rays.
static bool lies_on(const struct survey *survey, const struct twins *twins,
                    const struct sighting *at, const struct flat_shape *own,
                    const struct flat_shape *shape, struct sighting *other)
{
    double normals[2][3], tolerance = drop_onto(at, 0).tolerance;
    double away = distance_from(own, at->point, normals[0]);
    *other = (struct sighting){.object = survey->scene->instance_count + shape->source,
                               .material = shape->material};
    return shape != own && twins->places[at->object] != twins->places[other->object] &&
           fabs(distance_from(shape, at->point, normals[1]) - away) <= tolerance &&
           vec3_dot(normals[0], normals[1]) > 1.0 - 1e-6 &&
           fabs(vec3_dot(normals[0], at->normal)) > 1.0 - 1e-6 && // no cap of a cylinder
           matters(survey, at->material, other->material) &&
           !is_seen_through(survey, twins, at, other);
}

// So many comparisons take a second: of very many shapes some lines stand for all.
#define COMPARED_MOST 1e8

static void compare_curved(struct survey *survey, const struct twins *twins, struct pairs *pairs)
{
    const struct flat_scene *flat = survey->flat;
    double compared = (double)survey->line_count * flat->shape_count;
    uint32_t every = (uint32_t)(compared / COMPARED_MOST) + 1;
    for (uint32_t i = 0; i < survey->line_count; i += every)
        for (uint32_t k = 0; k < survey->lines[i].count; k++) {
            const struct sighting *at = &survey->lines[i].steps[k];
            uint32_t primitive = at->hit.primitive;
            if (!(primitive & PRIMITIVE_SHAPE) ||
                !is_curved(&flat->shapes[primitive & ~PRIMITIVE_SHAPE]))
                continue;
            struct sighting other;
            for (uint32_t s = 0; s < flat->shape_count; s++)
                if (is_curved(&flat->shapes[s]) &&
                    lies_on(survey, twins, at, &flat->shapes[primitive & ~PRIMITIVE_SHAPE],
                            &flat->shapes[s], &other))
                    note_pair(pairs, i, at, &other);
        }
}

// Of lines that a shared edge happens to be hit by there are fewer.
#define PAIRS_MIN 2

static bool find_same_faces(struct survey *survey, const struct twins *twins, struct err *err)
{
    struct pairs pairs = {0};
    if (!drop_rays(survey, twins, &pairs, err))
        return false;
    compare_curved(survey, twins, &pairs);
    if (pairs.count < PAIRS_MIN)
        return true;
    struct arena *arena = survey->arena;
    const char *objects[2], *materials[2];
    double world[3];
    flat_to_world(survey->flat, pairs.first[0].point, world);
    for (int i = 0; i < 2; i++) {
        objects[i] = survey_object_name(survey, pairs.first[i].object);
        materials[i] = survey_material_name(survey, pairs.first[i].material);
        if (!objects[i] || !materials[i])
            return err_memory(err, "names", 0);
    }
    return survey_add(survey,
                      &(struct scene_finding){
                          .name = "coincident-faces",
                          .level = FINDING_WRONG,
                          .place = arena_printf(arena, "%s (%s) and %s (%s)", objects[0],
                                                materials[0], objects[1], materials[1]),
                          .figure = arena_printf(arena, "upon each other at (%.4g, %.4g, %.4g)",
                                                 world[0], world[1], world[2]),
                          .consequence =
                              "Rounding decides which one is seen, and lamps or glass there count "
                              "twice or not at all.",
                          .remedy = "Move one of them by a visible distance, or remove it.",
                          .share = survey_share(survey, pairs.touched),
                          .pixels = pairs.touched,
                      },
                      err);
}

bool find_twice(struct survey *survey, struct err *err)
{
    struct twins twins = {0};
    return find_same_objects(survey, &twins, err) && find_same_faces(survey, &twins, err);
}
