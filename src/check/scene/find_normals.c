// Finds shading normals that contradict the surface.
#include "check/scene/survey.h"

#include "base/maths.h"
#include "shared/types.h"
#include <string.h>

// Returns whether the normals of a triangle's corners point to different sides of it: then the
// shading normal flips somewhere inside. The renderer turns shading normals to the visible side, so
// normals that all point inwards do no harm.
static bool straddles(const struct flat_scene *flat, uint32_t id)
{
    double edges[2][3], geometric[3], least = INFINITY, most = -INFINITY;
    flat_triangle_edges(flat, id, edges);
    vec3_cross(edges[0], edges[1], geometric);
    for (int i = 0; i < 3; i++) {
        double normal[3];
        vec3_widen(flat->normals[id][i], normal);
        double cosine = vec3_dot(normal, geometric);
        least = fmin(least, cosine);
        most = fmax(most, cosine);
    }
    return least < 0.0 && most > 0.0;
}

static bool meets(const struct survey *survey, const struct sighting *at, const void *context)
{
    (void)context;
    return !(at->hit.primitive & PRIMITIVE_SHAPE) && straddles(survey->flat, at->hit.primitive);
}

// --- normals of another surface ------------------------------------------------------------------

// Smooth normals deviate from a triangle towards its neighbours, but the deviations at the corners
// almost cancel in its centre. There, 2 % of the surface of Suzanne with 500 vertices deviate by
// more than 60 degrees, and half of a surface with random normals does. So if a quarter of an
// object's surface deviates that much, its normals are those of another surface.
#define FAR_COSINE 0.5
#define FAR_PART 0.25

static bool is_far(const struct flat_scene *flat, uint32_t id)
{
    double edges[2][3], geometric[3], middle[3] = {0};
    flat_triangle_edges(flat, id, edges);
    vec3_cross(edges[0], edges[1], geometric);
    for (int i = 0; i < 3; i++)
        for (int c = 0; c < 3; c++)
            middle[c] += (double)flat->normals[id][i][c];
    return vec3_normalize(geometric) && vec3_normalize(middle) &&
           fabs(vec3_dot(geometric, middle)) < FAR_COSINE;
}

// Marks the objects whose normals deviate that much on a quarter of their visible surface. Objects
// with gaps, such as leaves, are left out, because they intentionally have the normals of the whole
// crown.
static bool mark_far(struct survey *survey, bool *marked, struct err *err)
{
    uint32_t objects = survey_object_count(survey);
    uint32_t(*counts)[2] = arena_alloc(&survey->scratch, objects, sizeof *counts);
    if (!counts)
        return err_memory(err, "objects", objects * sizeof *counts);
    memset(counts, 0, objects * sizeof *counts);
    for (uint32_t i = 0; i < survey->line_count; i++)
        for (uint32_t k = 0; k < survey->lines[i].count; k++) {
            const struct sighting *at = &survey->lines[i].steps[k];
            if (at->hit.primitive & PRIMITIVE_SHAPE || survey_has_gaps(survey, at->material))
                continue;
            counts[at->object][0]++;
            counts[at->object][1] += is_far(survey->flat, at->hit.primitive);
        }
    for (uint32_t i = 0; i < objects; i++)
        marked[i] = counts[i][1] > 0 && counts[i][1] >= FAR_PART * counts[i][0];
    return true;
}

// --- the findings --------------------------------------------------------------------------------

// Scanned and decimated meshes have some contradictory normals in creases, where they are not
// visible.
#define SHARE_MIN 0.01

// Adds the finding about objects with the normals of another surface. Sets *found to whether there
// are any.
static bool find_far(struct survey *survey, bool *found, struct err *err)
{
    uint32_t first = 0, count = 0;
    bool *marked = ARENA_NEW(&survey->scratch, bool, survey_object_count(survey));
    if (!marked || !mark_far(survey, marked, err))
        return err_memory(err, "objects", survey_object_count(survey));
    for (uint32_t i = survey_object_count(survey); i-- > 0;)
        if (marked[i]) {
            first = i;
            count++;
        }
    const uint8_t *touched = count > 0 ? survey_touched_by_objects(survey, marked) : NULL;
    double share = survey_share(survey, touched);
    *found = share >= SHARE_MIN;
    if (!*found)
        return true;
    return survey_add(
        survey,
        &(struct scene_finding){
            .name = "normals",
            .level = FINDING_WRONG,
            .place = survey_object_name(survey, first),
            .figure =
                arena_printf(survey->arena,
                             "%u object%s with normals more than 60 degrees off the surface's "
                             "own on a quarter or more of the visible surface",
                             count, count == 1 ? "" : "s"),
            .consequence = "The normals are those of another surface, and the object is shaded "
                           "like that surface.",
            .remedy = "Compute the normals again, and check whether axes were swapped on export.",
            .share = share,
            .pixels = touched,
        },
        err);
}

static bool find_straddling(struct survey *survey, struct err *err)
{
    const struct flat_scene *flat = survey->flat;
    uint32_t count = 0, first = 0;
    for (uint32_t i = 0; i < flat->triangle_count; i++)
        if (straddles(flat, i))
            first = count++ > 0 ? first : i;
    const uint8_t *touched = count > 0 ? survey_touched(survey, meets, NULL) : NULL;
    double share = survey_share(survey, touched);
    if (share < SHARE_MIN)
        return true;
    uint32_t instance, triangle;
    flat_triangle_source(flat, first, &instance, &triangle);
    struct arena *arena = survey->arena;
    const char *name =
        instance == SCENE_NONE ? "a shared mesh" : survey_object_name(survey, instance);
    return survey_add(
        survey,
        &(struct scene_finding){
            .name = "normals",
            .level = FINDING_WRONG,
            .place = name ? arena_printf(arena, "%s, first in triangle %u", name, triangle) : NULL,
            .figure =
                arena_printf(arena, "%u of %u triangles have corner normals on both of their sides",
                             count, flat->triangle_count),
            .consequence = "The shading normal flips inside of these triangles, which causes dark "
                           "and bright patches.",
            .remedy = "Compute the normals again, with an angle above which edges stay sharp.",
            .share = share,
            .pixels = touched,
        },
        err);
}

bool find_normals(struct survey *survey, struct err *err)
{
    bool is_named = false;
    if (!survey->flat->normals)
        return true;
    return find_far(survey, &is_named, err) && (is_named || find_straddling(survey, err));
}
