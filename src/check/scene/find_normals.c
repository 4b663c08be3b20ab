// Shading normals that contradict the surface.
#include "check/scene/survey.h"

#include "base/maths.h"
#include "shared/types.h"

// The renderer turns shading normals to the side that is seen, so that normals which all point
// inwards do no harm. A triangle whose corners disagree about the side does: somewhere between them
// the normal turns over.
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

// Creases of scanned and decimated meshes have some, which nobody sees.
#define SHARE_MIN 0.01

bool find_normals(struct survey *survey, struct err *err)
{
    const struct flat_scene *flat = survey->flat;
    uint32_t count = 0, first = 0;
    for (uint32_t i = 0; i < flat->triangle_count && flat->normals; i++)
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
            .place = name ? arena_printf(arena, "%s, triangle %u first", name, triangle) : NULL,
            .figure = arena_printf(arena,
                                   "%u of %u triangles whose corners' normals point to both "
                                   "of its sides",
                                   count, flat->triangle_count),
            .consequence = "Shading turns over within them: dark and bright patches.",
            .remedy = "Compute the normals again, with an angle above which edges stay sharp.",
            .share = share,
            .pixels = touched,
        },
        err);
}
