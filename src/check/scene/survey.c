#include "check/scene/survey.h"

#include "base/maths.h"
#include "shared/types.h"
#include <string.h>

const char *const finding_level_names[] = {"remark", "slow", "wrong", NULL};

bool survey_add(struct survey *survey, const struct scene_finding *finding, struct err *err)
{
    struct scene_findings *out = survey->out;
    struct scene_finding *added =
        arena_append(survey->arena, &out->items, &out->count, &out->capacity, sizeof *added, NULL);
    if (!added || !finding->place || !finding->figure || !finding->consequence || !finding->remedy)
        return err_memory(err, "what is found in the scene", sizeof *added);
    *added = *finding;
    return true;
}

static const char *const kind_names[SHAPE_KIND_COUNT] = {
    "a sphere", "a disc",     "a plane",          "a quad",
    "a box",    "a cylinder", "an open cylinder", "a distance field",
};

const char *survey_object_name(const struct survey *survey, uint32_t object)
{
    const struct scene *scene = survey->scene;
    uint32_t shape = object - scene->instance_count;
    if (!survey_is_instance(survey, object))
        return arena_printf(survey->arena, "shape %u, %s", shape,
                            kind_names[scene->shapes[shape].kind]);
    uint32_t mesh = scene->instances[object].mesh;
    const char *name = scene->meshes[mesh].name;
    return name && *name ? arena_printf(survey->arena, "instance %u of mesh \"%s\"", object, name)
                         : arena_printf(survey->arena, "instance %u of mesh %u", object, mesh);
}

const char *survey_material_name(const struct survey *survey, uint32_t material)
{
    const char *name = survey->scene->materials[material].name;
    return *name ? arena_printf(survey->arena, "material \"%s\"", name)
                 : arena_printf(survey->arena, "material %u", material);
}

const struct gpu_material *survey_gpu_materials(const struct survey *survey)
{
    const char *tables = survey->job.renderer.tables.materials;
    return (const void *)(tables + sizeof(struct gpu_material_header));
}

bool *survey_hidden(const struct survey *survey, uint32_t object)
{
    struct scene *scene = survey->scene;
    return survey_is_instance(survey, object)
               ? &scene->instances[object].hidden
               : &scene->shapes[object - scene->instance_count].hidden;
}

bool survey_has_gaps(const struct survey *survey, uint32_t material)
{
    return survey->scene->materials[material].flags & (MATERIAL_ALPHA_MASK | MATERIAL_ALPHA_BLEND);
}

bool survey_counts_twice(const struct survey *survey, uint32_t material)
{
    const struct material *m = &survey->scene->materials[material];
    bool lights = survey->settings.nee && survey->settings.max_bounces > 0;
    return (lights && material_emits(m)) || (m->flags & MATERIAL_ALPHA_BLEND);
}

bool survey_differs_doubled(const struct survey *survey, uint32_t a, uint32_t b)
{
    return a != b || survey_counts_twice(survey, a) ||
           material_lets_through(&survey->scene->materials[a]);
}

double survey_mean_light(const struct survey *survey, float (*pixels)[3])
{
    double sum = 0.0;
    for (uint32_t i = 0; i < survey->line_count; i++)
        sum += luminance(pixels[i]);
    return sum / survey->line_count;
}
