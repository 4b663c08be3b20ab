// Traces straight lines through the scene with the renderer's own kernel, to find what the camera
// sees and what is between two places.
#include "check/scene/survey.h"

#include "base/maths.h"
#include "render/projection.h"
#include "scene/core/affine.h"
#include "scene/sdf/sdf.h"
#include "scene/sdf/sdf_evaluate.h"
#include "shared/types.h"
#include <float.h>
#include <string.h>

bool material_lets_through(const struct material *material)
{
    return material->model == MATERIAL_DIELECTRIC ||
           (material->model == MATERIAL_PRINCIPLED && material->transmission > 0.0f);
}

// --- hits ----------------------------------------------------------------------------------------

// Computes the normal of a cylinder at a point of its cap or its side.
static void cylinder_normal(const struct flat_shape *shape, const double from[3], double normal[3])
{
    double axis[3], radius = (double)shape->radius;
    vec3_widen(shape->axes[0], axis);
    double half = vec3_norm(axis), along = vec3_dot(from, axis) / (half * half);
    for (int c = 0; c < 3; c++)
        normal[c] = from[c] - along * axis[c];
    // The point is on the surface to which it is closer, relative to the cylinder's size.
    if (shape->kind == SHAPE_CYLINDER &&
        fabs(fabs(along) - 1.0) * half < fabs(vec3_norm(normal) - radius))
        for (int c = 0; c < 3; c++)
            normal[c] = copysign(axis[c], axis[c] * along);
}

// Computes the normal of the face whose plane is nearest to the point.
static void box_normal(const struct flat_shape *shape, const double from[3], double normal[3])
{
    double nearest = INFINITY;
    for (int i = 0; i < 3; i++) {
        double axis[3];
        vec3_widen(shape->axes[i], axis);
        double half = vec3_norm(axis), along = vec3_dot(from, axis) / (half * half);
        double away = fabs(fabs(along) - 1.0) * half;
        if (away < nearest)
            for (int c = 0; c < 3; c++)
                normal[c] = along < 0.0 ? -axis[c] : axis[c];
        nearest = fmin(nearest, away);
    }
}

// Computes the normal from the gradient, by differences over a small part of the field's box.
static void field_normal(const struct survey *survey, const struct flat_shape *shape,
                         const double point[3], double normal[3])
{
    const struct sdf *sdf = &survey->scene->sdfs[shape->sdf];
    double to_world[3][4], to_field[3][4], world[3], p[3], gradient[3];
    sdf_to_world(sdf, &survey->scene->shapes[shape->source], to_world);
    flat_to_world(survey->flat, point, world);
    if (!affine_inverse(to_world, to_field))
        return;
    affine_point(to_field, world, p);
    for (int c = 0; c < 3; c++) {
        double step = 1e-4 * (sdf->max[c] - sdf->min[c]), at[3];
        memcpy(at, p, sizeof at);
        at[c] = p[c] + step;
        double above = sdf_evaluate(sdf, at);
        at[c] = p[c] - step;
        gradient[c] = (above - sdf_evaluate(sdf, at)) / step;
    }
    affine_vector(to_world, gradient, normal);
}

// Moves a point onto a sphere. Kernels decide by the position of a ray's origin, within a few
// rounding errors of the radius, whether the ray leaves the sphere; the point computed from the
// ray's distance is less accurate.
static void put_on_sphere(const struct flat_shape *shape, const double normal[3], double point[3])
{
    double length = vec3_length(normal);
    for (int c = 0; c < 3; c++)
        point[c] = (double)shape->center[c] + normal[c] * (double)shape->radius / length;
}

void sighting_shape_normal(const struct survey *survey, const struct flat_shape *shape,
                           const double point[3], double normal[3])
{
    double from[3], u[3], v[3];
    for (int c = 0; c < 3; c++)
        from[c] = point[c] - (double)shape->center[c];
    switch (shape->kind) {
    case SHAPE_SPHERE:
        memcpy(normal, from, sizeof from);
        break;
    case SHAPE_QUAD:
        vec3_widen(shape->axes[0], u);
        vec3_widen(shape->axes[1], v);
        vec3_cross(u, v, normal);
        break;
    case SHAPE_BOX:
        box_normal(shape, from, normal);
        break;
    case SHAPE_CYLINDER:
    case SHAPE_TUBE:
        cylinder_normal(shape, from, normal);
        break;
    case SHAPE_SDF:
        field_normal(survey, shape, point, normal);
        break;
    default:
        vec3_widen(shape->normal, normal);
    }
}

static void triangle_at(const struct survey *survey, const struct probe_hit *hit,
                        struct sighting *out)
{
    const struct flat_scene *flat = survey->flat;
    const struct flat_triangle *triangle = &flat->triangles[hit->primitive];
    const struct flat_instance *instance =
        hit->instance == NO_INSTANCE ? NULL : &flat->instances[hit->instance];
    double corners[3][3], edges[2][3], to_world[3][4];
    uint32_t source, number;
    for (int i = 0; i < 3; i++)
        vec3_widen(triangle->v[i], corners[i]);
    for (int i = 0; instance && i < 3; i++)
        for (int j = 0; j < 4; j++)
            to_world[i][j] = (double)instance->to_world[i][j];
    for (int i = 0; instance && i < 3; i++)
        affine_point((const double(*)[4])to_world, corners[i], corners[i]);
    vec3_subtract(corners[1], corners[0], edges[0]);
    vec3_subtract(corners[2], corners[0], edges[1]);
    double u = (double)hit->u, v = (double)hit->v;
    for (int c = 0; c < 3; c++)
        out->point[c] = corners[0][c] + u * edges[0][c] + v * edges[1][c];
    if (!instance)
        flat_triangle_edges(flat, hit->primitive, edges);
    vec3_cross(edges[0], edges[1], out->normal);
    for (int c = 0; instance && instance->is_mirrored && c < 3; c++)
        out->normal[c] = -out->normal[c];
    flat_triangle_source(flat, hit->primitive, &source, &number);
    out->object = instance ? instance->source : source;
    out->material =
        instance && instance->material != SCENE_NONE ? instance->material : triangle->material;
}

void sighting_find(const struct survey *survey, const struct probe_hit *hit, const double origin[3],
                   const double direction[3], struct sighting *out)
{
    *out = (struct sighting){.hit = *hit};
    if (hit->primitive & PRIMITIVE_SHAPE) {
        const struct flat_shape *shape = &survey->flat->shapes[hit->primitive & ~PRIMITIVE_SHAPE];
        for (int c = 0; c < 3; c++)
            out->point[c] = origin[c] + (double)hit->t * direction[c];
        sighting_shape_normal(survey, shape, out->point, out->normal);
        if (shape->kind == SHAPE_SPHERE)
            put_on_sphere(shape, out->normal, out->point);
        out->object = survey->scene->instance_count + shape->source;
        out->material = shape->material;
    } else {
        triangle_at(survey, hit, out);
    }
    vec3_normalize(out->normal);
    out->is_front = vec3_dot(out->normal, direction) <= 0.0;
}

double sighting_rounding(const double point[3])
{
    double largest = fmax(fmax(fabs(point[0]), fabs(point[1])), fabs(point[2]));
    return 8.0 * 0.5 * (double)FLT_EPSILON * largest;
}

struct probe_ray sighting_leave(const struct sighting *at, const double direction[3])
{
    struct probe_ray ray = {
        .leaves = true, .from = at->hit.primitive, .from_instance = at->hit.instance};
    double offset = copysign(sighting_rounding(at->point), vec3_dot(at->normal, direction));
    for (int c = 0; c < 3; c++) {
        ray.origin[c] = (float)(at->point[c] + offset * at->normal[c]);
        ray.direction[c] = (float)direction[c];
    }
    return ray;
}

void sighting_scatter(const double normal[3], uint32_t number, double out[3])
{
    double turn = 2.0 * M_PI * fmod(0.5 + number * 0.7548776662466927, 1.0);
    double height = 2.0 * fmod(0.5 + number * 0.5698402909980532, 1.0) - 1.0;
    double across = sqrt(1.0 - height * height);
    const double sphere[3] = {across * cos(turn), across * sin(turn), height};
    for (int c = 0; c < 3; c++)
        out[c] = sphere[c] + normal[c];
    if (!vec3_normalize(out))
        memcpy(out, normal, 3 * sizeof *out);
}

// --- lines ---------------------------------------------------------------------------------------

// A line whose end has not been found yet.
struct front {
    struct sightline *line;
    double way; // length traced so far, in the flat scene's unit
};

static struct probe_ray next_ray(const struct front *front)
{
    const struct sightline *line = front->line;
    struct probe_ray ray = {.from_instance = NO_INSTANCE};
    const struct sighting *from = line->count > 0 ? &line->steps[line->count - 1] : line->from;
    if (from)
        return sighting_leave(from, line->direction);
    for (int c = 0; c < 3; c++) {
        ray.origin[c] = (float)line->origin[c];
        ray.direction[c] = (float)line->direction[c];
    }
    return ray;
}

// Adds a hit to a line. Returns whether the line continues.
static bool take_step(const struct survey *survey, struct front *front, const struct probe_ray *ray,
                      const struct probe_hit *hit)
{
    struct sightline *line = front->line;
    double origin[3];
    bool misses = hit->primitive == NO_PRIMITIVE;
    if (misses || front->way + (double)hit->t > line->length) {
        line->is_open = true;
        return false;
    }
    front->way += (double)hit->t;
    vec3_widen(ray->origin, origin);
    struct sighting *step = &line->steps[line->count++];
    sighting_find(survey, hit, origin, line->direction, step);
    return line->count < SIGHTING_STEPS &&
           material_lets_through(&survey->scene->materials[step->material]);
}

// Continues all unfinished lines to their next surface; *count becomes the number of lines that
// continue.
static bool advance(struct survey *survey, struct front *fronts, uint32_t *count,
                    struct probe_ray *rays, struct probe_hit *hits, struct err *err)
{
    uint32_t most = survey->job.renderer.plan.wave_slots, left = 0;
    bool complete;
    for (uint32_t i = 0; i < *count; i++)
        rays[i] = next_ray(&fronts[i]);
    for (uint32_t first = 0; first < *count; first += most) {
        uint32_t part = *count - first < most ? *count - first : most;
        if (!job_trace_rays(&survey->job, &rays[first], part, &hits[first], &complete, err))
            return false;
    }
    for (uint32_t i = 0; i < *count; i++)
        if (take_step(survey, &fronts[i], &rays[i], &hits[i]))
            fronts[left++] = fronts[i];
    *count = left;
    return true;
}

bool sightlines_trace(struct survey *survey, struct sightline *lines, uint32_t count,
                      struct err *err)
{
    // Scenes without surfaces have no kernel to trace rays.
    bool is_empty = survey->flat->triangle_count + survey->flat->shape_count == 0;
    for (uint32_t i = 0; i < count && is_empty; i++)
        lines[i].is_open = true;
    if (is_empty)
        return true;
    struct arena scratch = {0};
    struct front *fronts = ARENA_NEW(&scratch, struct front, count);
    struct probe_ray *rays = ARENA_NEW(&scratch, struct probe_ray, count);
    struct probe_hit *hits = ARENA_NEW(&scratch, struct probe_hit, count);
    bool ok = fronts && rays && hits;
    if (!ok)
        err_memory(err, "sight lines", count * sizeof *rays);
    for (uint32_t i = 0; ok && i < count; i++)
        fronts[i].line = &lines[i];
    while (ok && count > 0)
        ok = advance(survey, fronts, &count, rays, hits, err);
    arena_finish(&scratch);
    return ok;
}

bool sightlines_take_view(struct survey *survey, struct err *err)
{
    const struct renderer *r = &survey->job.renderer;
    const struct gpu_material_header *header = r->tables.materials;
    uint32_t width = r->frame.width, height = r->frame.height;
    struct projection projection;
    projection_make(survey->camera, survey->flat, width, height, &projection);
    survey->line_count = width * height;
    survey->lines = ARENA_NEW(&survey->scratch, struct sightline, survey->line_count);
    if (!survey->lines)
        return err_memory(err, "sight lines", survey->line_count * sizeof *survey->lines);
    for (uint32_t i = 0; i < survey->line_count; i++) {
        struct sightline *line = &survey->lines[i];
        // The offsets in the pixel are points of Roberts's two-dimensional sequence (2018), so that
        // lines do not all follow an edge.
        double x = fmod(0.5 + i * 0.7548776662466927, 1.0);
        double y = fmod(0.5 + i * 0.5698402909980532, 1.0);
        projection_ray(&projection, i % width + x, i / width + y, line->origin, line->direction);
        line->length = INFINITY;
        line->media = header->camera_media;
    }
    return sightlines_trace(survey, survey->lines, survey->line_count, err);
}

const struct sighting *sightline_lit_place(const struct survey *survey,
                                           const struct sightline *seen)
{
    if (seen->count == 0 || seen->is_open)
        return NULL;
    const struct sighting *at = &seen->steps[seen->count - 1];
    const struct material *material = &survey->scene->materials[at->material];
    return material_lets_through(material) || material_emits(material) ? NULL : at;
}

// --- flags ---------------------------------------------------------------------------------------

uint8_t *survey_flags(struct survey *survey)
{
    uint8_t *flags = ARENA_NEW(survey->arena, uint8_t, survey->line_count);
    survey->lacks_memory |= !flags;
    return flags;
}

double survey_share(const struct survey *survey, const uint8_t *flags)
{
    uint32_t count = 0;
    for (uint32_t i = 0; flags && i < survey->line_count; i++)
        count += flags[i] != 0;
    return (double)count / survey->line_count;
}

const uint8_t *survey_touched(struct survey *survey, sighting_fn meets, const void *context)
{
    uint8_t *flags = survey_flags(survey);
    for (uint32_t i = 0; flags && i < survey->line_count; i++) {
        const struct sightline *line = &survey->lines[i];
        for (uint32_t k = 0; k < line->count && !flags[i]; k++)
            flags[i] = meets(survey, &line->steps[k], context);
    }
    return flags;
}

static bool is_object(const struct survey *survey, const struct sighting *at, const void *context)
{
    (void)survey;
    return at->object == *(const uint32_t *)context;
}

static bool is_marked(const struct survey *survey, const struct sighting *at, const void *context)
{
    (void)survey;
    return ((const bool *)context)[at->object];
}

static bool is_material(const struct survey *survey, const struct sighting *at, const void *context)
{
    (void)survey;
    return at->material == *(const uint32_t *)context;
}

const uint8_t *survey_touched_by_object(struct survey *survey, uint32_t object)
{
    return survey_touched(survey, is_object, &object);
}

const uint8_t *survey_touched_by_objects(struct survey *survey, const bool *marked)
{
    return survey_touched(survey, is_marked, marked);
}

const uint8_t *survey_touched_by_material(struct survey *survey, uint32_t material)
{
    return survey_touched(survey, is_material, &material);
}
