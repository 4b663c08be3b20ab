// Finds surfaces, of different objects or of the same object, that coincide.
//
// Each point at which a line of sight hits a surface is tested by further rays: one onto the
// surface from a small height, and one along the line of sight from nearby. If the point is on a
// shape, the shape is also compared with all other shapes. So the time depends on the number of
// pixels. More triangles only make the traversal of the BVH longer, and the number of comparisons
// with shapes is limited (COMPARED_MOST).
#include "check/scene/survey.h"

#include "base/maths.h"
#include "shared/types.h"
#include <float.h>
#include <string.h>

// Returns the distance, in metres, within which surfaces count as coincident. The points of both
// surfaces are rounded.
static double tolerance_at(const double point[3])
{
    return 2.0 * sighting_rounding(point);
}

// Returns whether two unit normals are parallel enough to belong to the same plane, and not to two
// faces at an edge.
static bool is_parallel(const double a[3], const double b[3])
{
    return fabs(vec3_dot(a, b)) > 1.0 - 1e-6;
}

// --- records -------------------------------------------------------------------------------------

static bool lets_through(const struct survey *survey, const struct sighting *at)
{
    return material_lets_through(&survey->scene->materials[at->material]);
}

// Returns whether a coincidence is acceptable: find_twice() reports objects at the same place, and
// two surfaces with gaps are each visible through the other.
static bool is_no_finding(const struct survey *survey, const struct sighting *a,
                          const struct sighting *b)
{
    bool is_twin = a->object != b->object && survey->places[a->object] == survey->places[b->object];
    bool share_place = a->material != b->material && survey_has_gaps(survey, a->material) &&
                       survey_has_gaps(survey, b->material);
    return is_twin || share_place || !survey_differs_doubled(survey, a->material, b->material);
}

// Records that a line hits two surfaces. `apart` is their distance along the line; 0 if they
// coincide.
static void note_pair(const struct survey *survey, struct coincidences *out, uint32_t line,
                      const struct sighting *a, const struct sighting *b, double apart)
{
    out->through[line] |= lets_through(survey, a) || lets_through(survey, b);
    if (is_no_finding(survey, a, b))
        return;
    if (out->count == 0) {
        out->pair[0] = *a;
        out->pair[1] = *b;
        out->apart = apart;
    }
    out->count += !out->touched[line];
    out->touched[line] = 1;
}

// --- rays onto surfaces --------------------------------------------------------------------------

struct drop {
    const struct sighting *at;
    uint32_t line;
    bool is_on_line; // the ray is along the line of sight, otherwise along the normal
    double direction[3], height;
};

// Returns whether rays onto the surface should be traced. Only a flat surface can have more than a
// line in common with triangles; two curved shapes are compared directly.
static bool may_be_flat(const struct survey *survey, const struct sighting *at)
{
    if (!(at->hit.primitive & PRIMITIVE_SHAPE))
        return true;
    uint32_t kind = survey->flat->shapes[at->hit.primitive & ~PRIMITIVE_SHAPE].kind;
    return kind != SHAPE_SPHERE && kind != SHAPE_TUBE && kind != SHAPE_SDF;
}

// The height from which rays are traced, in units of the tolerance; rounding leaves six binary
// digits of it.
#define HEIGHT_IN_TOLERANCES 64.0

static struct drop drop_onto(const struct sighting *at, uint32_t line)
{
    struct drop drop = {
        .at = at, .line = line, .height = HEIGHT_IN_TOLERANCES * tolerance_at(at->point)};
    for (int c = 0; c < 3; c++)
        drop.direction[c] = at->is_front ? -at->normal[c] : at->normal[c];
    return drop;
}

// Returns the rounding error of the distance along the ray to this hit. If the ray starts this far
// before the hit, it hits close surfaces in their true order. A triangle's test rounds the distance
// about 16 times, each time relative to the ray's length (lib/intersect_triangle.glsl).
static double near_height(const struct sighting *at)
{
    return 16.0 * 0.5 * (double)FLT_EPSILON * (double)at->hit.t;
}

static struct drop drop_on_line(const struct sighting *at, const struct sightline *line,
                                uint32_t number)
{
    struct drop drop = {.at = at, .line = number, .is_on_line = true, .height = near_height(at)};
    memcpy(drop.direction, line->direction, sizeof drop.direction);
    return drop;
}

static struct probe_ray ray_of(const struct drop *drop)
{
    struct probe_ray ray = {.from_instance = NO_INSTANCE};
    if (!drop->is_on_line)
        ray = (struct probe_ray){.leaves = true,
                                 .from = drop->at->hit.primitive,
                                 .from_instance = drop->at->hit.instance};
    for (int c = 0; c < 3; c++) {
        ray.origin[c] = (float)(drop->at->point[c] - drop->height * drop->direction[c]);
        ray.direction[c] = (float)drop->direction[c];
    }
    return ray;
}

// Returns whether the surface that a ray hits coincides with its target. Kernels ignore the
// triangle or flat shape on which a ray starts. If the target is another kind of surface, the ray
// may hit either of the two surfaces first; of many rays, some hit the other one. For a ray along
// the line of sight, the other surface is in front of the target: the line missed it only because
// rounding moved it behind.
static bool lies_upon(const struct survey *survey, const struct drop *drop,
                      const struct probe_ray *ray, const struct probe_hit *hit,
                      struct sighting *other)
{
    double origin[3], above = drop->height - (double)hit->t;
    double tolerance = tolerance_at(drop->at->point);
    if (hit->primitive == NO_PRIMITIVE || hit->primitive == drop->at->hit.primitive ||
        (drop->is_on_line ? above <= tolerance : fabs(above) > tolerance))
        return false;
    vec3_widen(ray->origin, origin);
    sighting_find(survey, hit, origin, drop->direction, other);
    bool may_have_passed = drop->is_on_line && survey_has_gaps(survey, other->material);
    return is_parallel(other->normal, drop->at->normal) && !may_have_passed;
}

static bool drop_rays(struct survey *survey, const struct sightline *lines, uint32_t line_count,
                      struct coincidences *out, struct err *err)
{
    struct arena scratch = {0};
    uint32_t most = survey->job.renderer.plan.wave_slots, steps = 0, count = 0;
    for (uint32_t i = 0; i < line_count; i++)
        steps += lines[i].count;
    struct drop *drops = ARENA_NEW(&scratch, struct drop, 2 * (size_t)steps);
    struct probe_ray *rays = ARENA_NEW(&scratch, struct probe_ray, 2 * (size_t)steps);
    struct probe_hit *hits = ARENA_NEW(&scratch, struct probe_hit, 2 * (size_t)steps);
    bool complete, ok = drops && rays && hits;
    if (!ok)
        err_memory(err, "rays", 2 * steps * sizeof *rays);
    for (uint32_t i = 0; ok && i < line_count; i++)
        for (uint32_t k = 0; k < lines[i].count; k++) {
            const struct sighting *at = &lines[i].steps[k];
            if (may_be_flat(survey, at))
                drops[count++] = drop_onto(at, i);
            if (near_height(at) > tolerance_at(at->point))
                drops[count++] = drop_on_line(at, &lines[i], i);
        }
    for (uint32_t i = 0; ok && i < count; i++)
        rays[i] = ray_of(&drops[i]);
    for (uint32_t i = 0; ok && i < count; i += most)
        ok = job_trace_rays(&survey->job, &rays[i], count - i < most ? count - i : most, &hits[i],
                            &complete, err);
    for (uint32_t i = 0; ok && i < count; i++) {
        const struct drop *drop = &drops[i];
        struct sighting other;
        if (lies_upon(survey, drop, &rays[i], &hits[i], &other))
            note_pair(survey, out, drop->line, drop->at, &other,
                      drop->is_on_line ? drop->height - (double)hits[i].t : 0.0);
    }
    arena_finish(&scratch);
    return ok;
}

// --- comparisons of shapes -----------------------------------------------------------------------

// The part of a shape's surface that is nearest to a point.
struct patch {
    double normal[3]; // unit
    double away;      // signed distance of the point from the patch along the normal
    bool is_flat;
};

// Returns whether the point a is inside the parallelogram with half edges u and v centred at the
// origin; all vectors are in the plane of the unit normal.
static bool is_within(const double a[3], const double u[3], const double v[3],
                      const double normal[3])
{
    double whole[3], by_u[3], by_v[3];
    vec3_cross(u, v, whole);
    vec3_cross(a, v, by_u);
    vec3_cross(u, a, by_v);
    double area = fabs(vec3_dot(whole, normal));
    return fabs(vec3_dot(by_u, normal)) <= area && fabs(vec3_dot(by_v, normal)) <= area;
}

static bool find_patch_of_box(const double axes[3][3], const double from[3], struct patch *patch)
{
    int face = 0;
    for (int i = 1; i < 3; i++)
        if (fabs(vec3_dot(axes[i], patch->normal)) > fabs(vec3_dot(axes[face], patch->normal)))
            face = i;
    patch->away -= fabs(vec3_dot(axes[face], patch->normal));
    return is_within(from, axes[(face + 1) % 3], axes[(face + 2) % 3], patch->normal);
}

static bool find_patch_of_cylinder(const struct flat_shape *shape, const double axis[3],
                                   const double from[3], struct patch *patch)
{
    double along = vec3_dot(from, axis) / vec3_dot(axis, axis), cap = vec3_dot(axis, patch->normal);
    double square = vec3_dot(from, from) - along * along * vec3_dot(axis, axis);
    double radius = (double)shape->radius;
    patch->is_flat = fabs(cap) > 0.5 * vec3_norm(axis);
    patch->away -= patch->is_flat ? fabs(cap) : radius;
    return patch->is_flat ? square <= radius * radius : fabs(along) <= 1.0;
}

// Finds the patch of a shape nearest to a point. Returns false if the point is not above the patch,
// or if shapes of this kind cannot be compared.
static bool find_patch(const struct survey *survey, const struct flat_shape *shape,
                       const double point[3], struct patch *patch)
{
    double from[3], axes[3][3], radius = (double)shape->radius;
    for (int c = 0; c < 3; c++)
        from[c] = point[c] - (double)shape->center[c];
    for (int i = 0; i < 3; i++)
        vec3_widen(shape->axes[i], axes[i]);
    if (shape->kind == SHAPE_SDF)
        return false;
    sighting_shape_normal(survey, shape, point, patch->normal);
    vec3_normalize(patch->normal);
    patch->away = vec3_dot(from, patch->normal);
    patch->is_flat = shape->kind != SHAPE_SPHERE;
    switch (shape->kind) {
    case SHAPE_SPHERE:
        patch->away -= radius;
        return true;
    case SHAPE_CYLINDER:
    case SHAPE_TUBE:
        return find_patch_of_cylinder(shape, axes[0], from, patch);
    case SHAPE_BOX:
        return find_patch_of_box(axes, from, patch);
    case SHAPE_QUAD:
        return is_within(from, axes[0], axes[1], patch->normal);
    case SHAPE_DISC:
        return vec3_dot(from, from) - patch->away * patch->away <= radius * radius;
    default:
        return true;
    }
}

void shape_put_on(const struct survey *survey, const struct flat_shape *shape, double point[3])
{
    struct patch patch = {0};
    find_patch(survey, shape, point, &patch);
    for (int c = 0; c < 3; c++)
        point[c] -= patch.away * patch.normal[c];
}

// Returns whether two patches coincide. Flat patches may face each other, as those of two adjacent
// boxes do. Curved patches that face each other touch only in a point.
static bool is_one_patch(const struct patch *a, const struct patch *b, double tolerance)
{
    double turn = vec3_dot(a->normal, b->normal);
    double apart = turn < 0.0 ? a->away + b->away : a->away - b->away;
    return a->is_flat == b->is_flat && fabs(apart) <= tolerance && (a->is_flat || turn > 0.0) &&
           is_parallel(a->normal, b->normal);
}

// All shapes, with the radii of their bounding spheres.
struct shapes {
    const struct flat_shape *items;
    double *reach;
    uint32_t count;
};

static bool list_shapes(struct survey *survey, struct shapes *out, struct err *err)
{
    *out = (struct shapes){.items = survey->flat->shapes, .count = survey->flat->shape_count};
    out->reach = ARENA_NEW(&survey->scratch, double, out->count);
    if (!out->reach)
        return err_memory(err, "shapes", out->count * sizeof *out->reach);
    for (uint32_t i = 0; i < out->count; i++) {
        const struct flat_shape *shape = &out->items[i];
        out->reach[i] = shape->kind == SHAPE_PLANE ? INFINITY : (double)shape->radius;
        for (int k = 0; k < 3; k++) {
            double axis[3];
            vec3_widen(shape->axes[k], axis);
            out->reach[i] += vec3_norm(axis);
        }
    }
    return true;
}

static bool is_near(const struct shapes *shapes, uint32_t i, const double point[3],
                    double tolerance)
{
    double reach = shapes->reach[i] + tolerance, square = 0.0;
    for (int c = 0; c < 3; c++) {
        double away = point[c] - (double)shapes->items[i].center[c];
        square += away * away;
    }
    return square <= reach * reach;
}

static void compare_with_shapes(struct survey *survey, const struct shapes *shapes,
                                const struct sighting *at, uint32_t line, struct coincidences *out)
{
    uint32_t own = at->hit.primitive & ~PRIMITIVE_SHAPE;
    double tolerance = tolerance_at(at->point);
    struct patch patch, others;
    if (!find_patch(survey, &shapes->items[own], at->point, &patch))
        return;
    for (uint32_t i = 0; i < shapes->count; i++) {
        if (i == own || !is_near(shapes, i, at->point, tolerance) ||
            !find_patch(survey, &shapes->items[i], at->point, &others) ||
            !is_one_patch(&patch, &others, tolerance))
            continue;
        const struct sighting other = {.object =
                                           survey->scene->instance_count + shapes->items[i].source,
                                       .material = shapes->items[i].material};
        note_pair(survey, out, line, at, &other, 0.0);
    }
}

// The greatest number of comparisons, which take at most a second. If there are too many shapes,
// only some of the lines are tested.
#define COMPARED_MOST 1e8

static bool compare_shapes(struct survey *survey, const struct sightline *lines,
                           uint32_t line_count, struct coincidences *out, struct err *err)
{
    struct shapes shapes;
    double steps = 0.0;
    if (!list_shapes(survey, &shapes, err))
        return false;
    for (uint32_t i = 0; i < line_count; i++)
        steps += lines[i].count;
    uint32_t every = (uint32_t)(steps * shapes.count / COMPARED_MOST) + 1;
    for (uint32_t i = 0; i < line_count; i += every)
        for (uint32_t k = 0; k < lines[i].count; k++)
            if (lines[i].steps[k].hit.primitive & PRIMITIVE_SHAPE)
                compare_with_shapes(survey, &shapes, &lines[i].steps[k], i, out);
    return true;
}

// --- the finding ---------------------------------------------------------------------------------

bool coincidences_find(struct survey *survey, const struct sightline *lines, uint32_t count,
                       struct coincidences *out, struct err *err)
{
    *out = (struct coincidences){.through = ARENA_NEW(survey->arena, uint8_t, count),
                                 .touched = ARENA_NEW(survey->arena, uint8_t, count)};
    if (!out->through || !out->touched)
        return err_memory(err, "faces", count);
    return drop_rays(survey, lines, count, out, err) &&
           compare_shapes(survey, lines, count, out, err);
}

// Fewer lines may have hit only an edge that two surfaces share.
#define LINES_MIN 2

static const char *figure_of(struct survey *survey, const struct coincidences *coincidences)
{
    const struct sighting *at = &coincidences->pair[0];
    double world[3], scale = survey->flat->scale;
    flat_to_world(survey->flat, at->point, world);
    if (coincidences->apart <= 0.0)
        return arena_printf(survey->arena, "both at (%.4g, %.4g, %.4g)", world[0], world[1],
                            world[2]);
    return arena_printf(survey->arena, "%.2g m apart at (%.4g, %.4g, %.4g), seen from %.4g m away",
                        coincidences->apart / scale, world[0], world[1], world[2],
                        (double)at->hit.t / scale);
}

static bool add_finding(struct survey *survey, const struct coincidences *coincidences,
                        const char *figure, const uint8_t *pixels, struct err *err)
{
    struct arena *arena = survey->arena;
    const char *objects[2], *materials[2];
    for (int i = 0; i < 2; i++) {
        objects[i] = survey_object_name(survey, coincidences->pair[i].object);
        materials[i] = survey_material_name(survey, coincidences->pair[i].material);
        if (!objects[i] || !materials[i])
            return err_memory(err, "names", 0);
    }
    return survey_add(
        survey,
        &(struct scene_finding){
            .name = "coincident-faces",
            .level = FINDING_WRONG,
            .place = arena_printf(arena, "%s (%s) and %s (%s)", objects[0], materials[0],
                                  objects[1], materials[1]),
            .figure = figure,
            .consequence = "Rounding decides which one is visible, and lamps or glass there count "
                           "twice or not at all.",
            .remedy = "Move one of them by a visible distance, or remove it.",
            .share = survey_share(survey, pixels),
            .pixels = pixels,
        },
        err);
}

bool coincidences_add(struct survey *survey, const struct coincidences *coincidences,
                      const uint8_t *pixels, struct err *err)
{
    if (coincidences->count < LINES_MIN || survey->names_faces)
        return true;
    survey->names_faces = true;
    return add_finding(survey, coincidences, figure_of(survey, coincidences), pixels, err);
}

// --- lamps that light the image but are not visible in it ----------------------------------------

// The number of points on lamps that are tested, and the share of these points (that is, of the
// lamps' light) below which the lost light is not visible.
#define LAMP_PLACES 1024u
#define LIGHT_MIN 0.01
// The share of the image lit by these points below which the effect is not visible.
#define PICTURE_MIN 0.01

static bool is_same_pair(const struct coincidences *a, const struct coincidences *b)
{
    uint32_t first = b->pair[0].object, second = b->pair[1].object;
    return (a->pair[0].object == first && a->pair[1].object == second) ||
           (a->pair[0].object == second && a->pair[1].object == first);
}

// Adds the finding for lamps. The affected pixels are those that the lamps light. If `seen` is the
// same pair of surfaces, the pixels in which both are visible are added.
static bool add_lamps(struct survey *survey, const struct coincidences *lamps,
                      const struct sightline *lines, uint32_t count,
                      const struct coincidences *seen, struct err *err)
{
    struct sighting *places = ARENA_NEW(&survey->scratch, struct sighting, lamps->count);
    uint32_t upon = 0;
    uint8_t *pixels;
    if (!places)
        return err_memory(err, "places on lamps", lamps->count * sizeof *places);
    for (uint32_t i = 0; i < count; i++)
        if (lamps->touched[i])
            places[upon++] = lines[i].steps[0];
    if (!survey_lit_from(survey, places, upon, &pixels, err))
        return false;
    // Emissive surfaces between two touching bodies do not light anything.
    if (survey_share(survey, pixels) < PICTURE_MIN)
        return true;
    if (seen->count > 0 && is_same_pair(lamps, seen)) {
        survey->names_faces = true;
        for (uint32_t i = 0; i < survey->line_count; i++)
            pixels[i] |= seen->touched[i];
    }
    return add_finding(survey, lamps,
                       arena_printf(survey->arena,
                                    "%s, where %.3g %% of all lamps' light is emitted",
                                    figure_of(survey, lamps), 100.0 * lamps->count / count),
                       pixels, err);
}

static bool find_lamps(struct survey *survey, const struct coincidences *seen, struct err *err)
{
    struct coincidences lamps;
    struct sightline *lines = ARENA_NEW(&survey->scratch, struct sightline, LAMP_PLACES);
    if (!lines)
        return err_memory(err, "places on lamps", LAMP_PLACES * sizeof *lines);
    uint32_t count = lamp_places_take(survey, SCENE_NONE, LAMP_PLACES, lines);
    return count == 0 || (coincidences_find(survey, lines, count, &lamps, err) &&
                          (lamps.count < LIGHT_MIN * count ||
                           add_lamps(survey, &lamps, lines, count, seen, err)));
}

bool find_coincident(struct survey *survey, struct err *err)
{
    struct coincidences seen;
    if (!coincidences_find(survey, survey->lines, survey->line_count, &seen, err))
        return false;
    survey->through_faces = seen.through;
    return find_lamps(survey, &seen, err) && coincidences_add(survey, &seen, seen.touched, err);
}
