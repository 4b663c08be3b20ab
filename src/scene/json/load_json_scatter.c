// Scattered spheres on a disc, with materials chosen at random by weight.
#include "scene/generate/phong_spheres.h"
#include "scene/generate/scatter.h"
#include "scene/json/load_json.h"

#include <math.h>
#include <string.h>

#define KINDS_MAX 64
#define SHADES_MAX 64

// One of the materials, with copies whose varying parameters range from their minimum to their
// maximum.
struct kind {
    double weight;
    uint32_t first, shades;
};

struct strewn {
    struct scatter scatter;
    struct kind kinds[KINDS_MAX];
    uint32_t kind_count;
    bool triangles;
    uint64_t subdivision;
};

static bool has_roughness(uint32_t model)
{
    return model == MATERIAL_PRINCIPLED || model == MATERIAL_DIELECTRIC ||
           model == MATERIAL_CONDUCTOR || model == MATERIAL_MICROFACET;
}

static bool has_exponent(uint32_t model)
{
    return model == MATERIAL_PHONG || model == MATERIAL_BLINN_PHONG;
}

// The parameters that vary between the copies of a material, each with a range of two numbers, or
// NULL.
struct variety {
    const double *roughness, *smoothness, *emission;
};

static double between(const double range[2], double part)
{
    return range[0] + part * (range[1] - range[0]);
}

// Appends copies of a material, with the varying parameters evenly spaced over their ranges.
static bool add_shades(struct scene *scene, uint32_t original, const struct kind *kind,
                       const struct variety *variety, struct err *err)
{
    for (uint32_t i = 0; i < kind->shades; i++) {
        uint32_t index;
        struct material *copy = scene_add_material(scene, &index);
        if (!copy)
            return err_memory(err, "a material", sizeof *copy);
        double part = kind->shades > 1 ? (double)i / (kind->shades - 1) : 0.5;
        *copy = scene->materials[original];
        if (variety->roughness)
            copy->roughness = (float)between(variety->roughness, part);
        if (variety->smoothness)
            copy->exponent = (float)phong_exponent(between(variety->smoothness, part));
        for (int c = 0; variety->emission && c < 3; c++)
            copy->emission[c] *= (float)between(variety->emission, part);
    }
    return true;
}

static bool read_kind(struct json_loader *loader, const struct json_node *node, struct kind *kind,
                      struct err *err)
{
    static const char *const required[] = {"material", NULL};
    static const char *const optional[] = {"weight",   "roughness", "smoothness",
                                           "emission", "shades",    NULL};
    const struct range weights = {0, 1e6, false}, factors = {0, 1e6, false};
    const struct json_node rough = node_member(node, "roughness");
    const struct json_node smooth = node_member(node, "smoothness");
    const struct json_node bright = node_member(node, "emission");
    bool varies = rough.value || smooth.value || bright.value;
    double roughness[2], smoothness[2], emission[2];
    uint64_t shades = varies ? 8 : 1;
    uint32_t material;
    kind->weight = 1;
    if (!node_check_object(node, required, optional, err) ||
        !load_json_material_name(loader, node, &material, err) ||
        !node_read_number(node, "weight", weights, &kind->weight, err) ||
        !node_read_pair(node, "roughness", RANGE_UNIT, roughness, err) ||
        !node_read_pair(node, "smoothness", RANGE_UNIT, smoothness, err) ||
        !node_read_pair(node, "emission", factors, emission, err) ||
        !node_read_integer(node, "shades", 1, SHADES_MAX, &shades, err))
        return false;
    if (rough.value && !has_roughness(loader->scene->materials[material].model))
        return node_fail(&rough, err, "the material's model has no roughness");
    if (smooth.value && !has_exponent(loader->scene->materials[material].model))
        return node_fail(&smooth, err, "the material's model has no exponent");
    kind->first = material;
    kind->shades = (uint32_t)shades;
    if (!varies) {
        kind->shades = 1;
        return true;
    }
    kind->first = loader->scene->material_count;
    const struct variety variety = {rough.value ? roughness : NULL,
                                    smooth.value ? smoothness : NULL,
                                    bright.value ? emission : NULL};
    return add_shades(loader->scene, material, kind, &variety, err);
}

static bool read_kinds(struct json_loader *loader, const struct json_node *list,
                       struct strewn *strewn, struct err *err)
{
    double sum = 0;
    if (!node_check_array(list, 1, KINDS_MAX, err))
        return false;
    strewn->kind_count = (uint32_t)json_array_size(list->value);
    for (uint32_t i = 0; i < strewn->kind_count; i++) {
        const struct json_node element = node_element(list, i);
        if (!read_kind(loader, &element, &strewn->kinds[i], err))
            return false;
        sum += strewn->kinds[i].weight;
    }
    return sum > 0 || node_fail(list, err, "all weights are zero; expected a positive weight");
}

static bool read_scatter(struct json_loader *loader, const struct json_node *node,
                         struct strewn *strewn, struct err *err)
{
    static const char *const forms[] = {"spheres", "triangles", NULL};
    struct scatter *scatter = &strewn->scatter;
    const struct json_node radius = node_member(node, "radius");
    const struct json_node kinds = node_member(node, "materials");
    uint64_t count = 0, seed = 1;
    uint32_t form = 0;
    double radii[2];
    strewn->subdivision = SCATTER_SUBDIVISION;
    if (!node_read_integer(node, "count", 1, SCATTER_COUNT_MAX, &count, err) ||
        !node_read_integer(node, "seed", 0, UINT32_MAX, &seed, err) ||
        !node_read_number(node, "disc_radius", RANGE_RADIUS, &scatter->disc_radius, err) ||
        !node_read_pair(node, "radius", RANGE_RADIUS, radii, err) ||
        !node_read_choice(node, "as", forms, &form, err) ||
        !node_read_integer(node, "subdivision", 0, SCATTER_SUBDIVISION_MAX, &strewn->subdivision,
                           err))
        return false;
    scatter->progress = loader->scene->progress;
    scatter->count = (uint32_t)count;
    scatter->seed = (uint32_t)seed;
    scatter->min_radius = radii[0];
    scatter->max_radius = radii[1];
    strewn->triangles = form == 1;
    if (radii[1] > scatter->disc_radius)
        return node_fail(&radius, err, "%.9g is above disc_radius, %.9g; expected at most that",
                         radii[1], scatter->disc_radius);
    return read_kinds(loader, &kinds, strewn, err);
}

// Chooses the material of a sphere. The random number `choice` falls into one kind's share of the
// weights, and its position in that share selects the copy.
static uint32_t choose_material(const struct strewn *strewn, uint32_t choice)
{
    double sum = 0, at;
    const struct kind *kind = strewn->kinds;
    for (uint32_t i = 0; i < strewn->kind_count; i++)
        sum += strewn->kinds[i].weight;
    at = choice * 0x1p-32 * sum;
    while (at >= kind->weight && kind < strewn->kinds + strewn->kind_count - 1)
        at -= kind++->weight;
    uint32_t shade = kind->weight > 0 ? (uint32_t)(at / kind->weight * kind->shades) : 0;
    return kind->first + (shade < kind->shades ? shade : kind->shades - 1);
}

static bool add_sphere(struct scene *scene, const struct scattered_sphere *sphere, bool triangles,
                       uint32_t mesh, uint32_t material)
{
    if (triangles) {
        struct instance *instance = scene_add_instance(scene, NULL);
        if (!instance)
            return false;
        *instance = (struct instance){.mesh = mesh, .material = material};
        for (int c = 0; c < 3; c++) {
            instance->transform[c][c] = sphere->radius;
            instance->transform[c][3] = sphere->center[c];
        }
        return true;
    }
    struct shape *shape = scene_add_shape(scene, NULL);
    if (!shape)
        return false;
    *shape = (struct shape){.kind = SHAPE_SPHERE, .material = material, .radius = sphere->radius};
    memcpy(shape->center, sphere->center, sizeof shape->center);
    return true;
}

static bool add_spheres(struct scene *scene, const struct strewn *strewn, struct arena *scratch,
                        struct err *err)
{
    const struct scatter *scatter = &strewn->scatter;
    struct scattered_sphere *spheres = ARENA_NEW(scratch, struct scattered_sphere, scatter->count);
    uint32_t placed, mesh = 0;
    if (!spheres)
        return err_memory(err, "scattered spheres", scatter->count * sizeof *spheres);
    if (!scatter_spheres(scatter, scratch, spheres, &placed, err) ||
        (strewn->triangles &&
         !generate_icosphere(scene, (uint32_t)strewn->subdivision, &mesh, err)))
        return false;
    for (uint32_t i = 0; i < placed; i++)
        if (!add_sphere(scene, &spheres[i], strewn->triangles, mesh,
                        choose_material(strewn, spheres[i].choice)))
            return err_memory(err, "a scattered sphere", sizeof *spheres);
    return placed == scatter->count ||
           scene_note(scene, "scatter: %u of %u spheres found a place on the disc", placed,
                      scatter->count) ||
           err_memory(err, "a note", 64);
}

bool load_json_scatter(struct json_loader *loader, const struct json_node *node, struct err *err)
{
    struct strewn strewn = {0};
    struct arena scratch = {0};
    bool ok = read_scatter(loader, node, &strewn, err) &&
              (add_spheres(loader->scene, &strewn, &scratch, err) || node_prepend(node, err));
    arena_finish(&scratch);
    return ok;
}
