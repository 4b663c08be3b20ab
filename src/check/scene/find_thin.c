// Finds triangles with little or no area, and instances that their transforms flatten.
#include "check/scene/survey.h"

#include "base/maths.h"
#include "flatten/flatten_census.h"
#include "scene/core/affine.h"
#include <float.h>

// --- triangles without area ----------------------------------------------------------------------

static bool find_zero_areas(struct survey *survey, struct err *err)
{
    const struct scene *scene = survey->scene;
    const struct flat_scene *flat = survey->flat;
    uint32_t emissive = 0, first = SCENE_NONE, first_triangle = 0;
    for (uint32_t k = 0; k < flat->dropped_degenerate; k++) {
        uint32_t i, t;
        flat_dropped_source(flat, k, &i, &t);
        if (i == SCENE_NONE) // the triangle is in a shared mesh, which never emits
            continue;
        const struct instance *instance = &scene->instances[i];
        bool emits =
            flatten_emits(scene, instance_material(&scene->meshes[instance->mesh], instance, t));
        if (first == SCENE_NONE || (emits && emissive == 0)) {
            first = i;
            first_triangle = t;
        }
        emissive += emits;
    }
    if (flat->dropped_degenerate == 0)
        return true;
    struct arena *arena = survey->arena;
    const char *name = first == SCENE_NONE ? "a shared mesh" : survey_object_name(survey, first);
    uint64_t all = (uint64_t)flat->triangle_count + flat->dropped_degenerate;
    return survey_add(
        survey,
        &(struct scene_finding){
            .name = "zero-area",
            .level = emissive ? FINDING_WRONG : FINDING_REMARK,
            .place =
                name ? arena_printf(arena, "%s, first in triangle %u", name, first_triangle) : NULL,
            .figure =
                emissive ? arena_printf(arena, "%u of %llu triangles, %u of which should emit",
                                        flat->dropped_degenerate, (unsigned long long)all, emissive)
                         : arena_printf(arena, "%u of %llu triangles", flat->dropped_degenerate,
                                        (unsigned long long)all),
            .consequence = emissive
                               ? "They are omitted, so the light that they should emit is missing."
                               : "They are omitted, because no ray can hit them.",
            .remedy = emissive ? "Make these lamps larger, or replace them by a point light."
                               : "None is needed; the file is smaller without them.",
            .share = emissive ? NAN : 0.0,
        },
        err);
}

// --- triangles with little area ------------------------------------------------------------------

// If rounding rotates a triangle's normal by more than this angle (1 degree, in radians), shading
// and refraction show it.
#define TURN_MAX (M_PI / 180.0)

// Returns the angle, in radians, by which a triangle may rotate because its corners are rounded by
// half a step each. It is one step divided by the triangle's height.
static double turn_of(const struct flat_scene *flat, uint32_t id)
{
    double edges[2][3], third[3], normal[3], largest = 0.0;
    if (flat->small_count > 0 && flat_find_small(flat, id))
        return 0.0;
    flat_triangle_edges(flat, id, edges);
    vec3_subtract(edges[1], edges[0], third);
    vec3_cross(edges[0], edges[1], normal);
    double longest = fmax(fmax(vec3_norm(edges[0]), vec3_norm(edges[1])), vec3_norm(third));
    for (int i = 0; i < 9; i++)
        largest = fmax(largest, fabs((double)flat->triangles[id].v[i / 3][i % 3]));
    double height = vec3_norm(normal) / longest;
    return height > 0.0 ? 0.5 * (double)FLT_EPSILON * largest / height : INFINITY;
}

static bool is_sliver(const struct survey *survey, const struct sighting *at, const void *context)
{
    (void)context;
    return !(at->hit.primitive & PRIMITIVE_SHAPE) &&
           turn_of(survey->flat, at->hit.primitive) > TURN_MAX;
}

// Slivers cover little area, so they matter only if they cover this share of the image, or if there
// are very many.
#define SLIVERS_SHARE_MIN 1e-3
#define SLIVERS_PART_MIN 0.1

static bool find_slivers(struct survey *survey, struct err *err)
{
    const struct flat_scene *flat = survey->flat;
    uint32_t count = 0, worst = 0;
    double turn = 0.0;
    for (uint32_t i = 0; i < flat->triangle_count; i++) {
        double own = turn_of(flat, i);
        count += own > TURN_MAX;
        worst = own > turn ? i : worst;
        turn = fmax(turn, own);
    }
    const uint8_t *touched = count > 0 ? survey_touched(survey, is_sliver, NULL) : NULL;
    double share = survey_share(survey, touched);
    if (share < SLIVERS_SHARE_MIN && !(count > SLIVERS_PART_MIN * flat->triangle_count))
        return true;
    uint32_t instance, triangle;
    flat_triangle_source(flat, worst, &instance, &triangle);
    struct arena *arena = survey->arena;
    const char *name =
        instance == SCENE_NONE ? "a shared mesh" : survey_object_name(survey, instance);
    return survey_add(
        survey,
        &(struct scene_finding){
            .name = "sliver",
            .level = share > 0.0 ? FINDING_WRONG : FINDING_REMARK,
            .place = name ? arena_printf(arena, "%s, worst in triangle %u", name, triangle) : NULL,
            .figure = arena_printf(arena,
                                   "%u triangles so thin that rounding of their corners rotates "
                                   "them by more than 1 degree, the worst by %.2g degrees",
                                   count, fmin(turn * 180.0 / M_PI, 90.0)),
            .consequence = "Their normals are inaccurate, so they reflect and refract wrongly.",
            .remedy = "Merge their vertices, or triangulate the surface again.",
            .share = share,
            .pixels = touched,
        },
        err);
}

// --- flattened instances -------------------------------------------------------------------------

static bool find_singular(struct survey *survey, struct err *err)
{
    struct scene *scene = survey->scene;
    uint32_t count = 0, first = 0;
    for (uint32_t i = 0; i < scene->instance_count && survey->flat->skipped_instances > 0; i++) {
        double determinant = affine_determinant(scene->instances[i].transform);
        if (scene->instances[i].hidden || !(determinant == 0.0 || isnan(determinant)))
            continue;
        first = count++ > 0 ? first : i;
        scene->instances[i].hidden |= survey->params->fixes;
    }
    if (count == 0)
        return true;
    struct arena *arena = survey->arena;
    return survey_add(
        survey,
        &(struct scene_finding){
            .name = "singular-transform",
            .level = FINDING_REMARK,
            .place = survey_object_name(survey, first),
            .figure = arena_printf(arena, "%u of %u instances", count, scene->instance_count),
            .consequence = "Their transforms leave them no volume, so they are omitted.",
            .remedy = "Hide or remove them, or give them a scale that is not 0.",
            .share = 0.0,
            .change = "these instances are hidden",
        },
        err);
}

bool find_thin(struct survey *survey, struct err *err)
{
    return find_zero_areas(survey, err) && find_slivers(survey, err) && find_singular(survey, err);
}
