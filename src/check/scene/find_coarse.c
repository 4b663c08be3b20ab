// Finds details that single precision does not resolve: objects that are small relative to their
// coordinates, meshes whose file has lost digits, and cameras that are too far away.
#include "check/scene/survey.h"

#include "base/maths.h"
#include "flatten/flatten_census.h"
#include "render/far_camera.h"
#include "scene/core/affine.h"
#include "scene/core/bounds.h"
#include <float.h>

// Returns the bounds of each mesh in its own space, from the vertices that triangles use, or NULL
// when out of memory.
static struct bounds *list_mesh_bounds(struct survey *survey, struct err *err)
{
    const struct scene *scene = survey->scene;
    struct bounds *list = ARENA_NEW(&survey->scratch, struct bounds, scene->mesh_count);
    if (!list)
        err_memory(err, "bounds", scene->mesh_count * sizeof *list);
    for (uint32_t m = 0; list && m < scene->mesh_count; m++) {
        const struct mesh *mesh = &scene->meshes[m];
        list[m] = BOUNDS_EMPTY;
        for (uint32_t t = 0; t < mesh->triangle_count; t++)
            for (int corner = 0; corner < 3; corner++) {
                double point[3];
                mesh_vertex(mesh, mesh->indices[t][corner], point);
                bounds_add_point(&list[m], point);
            }
    }
    return list;
}

static struct bounds object_bounds(const struct survey *survey, const struct bounds *meshes,
                                   uint32_t object)
{
    const struct scene *scene = survey->scene;
    struct bounds bounds = BOUNDS_EMPTY;
    if (!survey_is_instance(survey, object)) {
        bounds_add_shape(&bounds, &scene->shapes[object - scene->instance_count]);
        return bounds;
    }
    const struct instance *instance = &scene->instances[object];
    const struct bounds *mesh = &meshes[instance->mesh];
    if (!bounds_is_empty(mesh))
        affine_box(instance->transform, mesh->min, mesh->max, bounds.min, bounds.max);
    return bounds;
}

// Returns whether a line of sight passes through the bounding sphere of an object. If it does, the
// object should be visible there, even if rounding leaves nothing of it.
static bool comes_by(const struct survey *survey, const struct sightline *line,
                     const struct bounds *bounds)
{
    double middle[3], size[3], from[3];
    for (int c = 0; c < 3; c++)
        middle[c] = 0.5 * (bounds->min[c] + bounds->max[c]);
    vec3_subtract(bounds->max, bounds->min, size);
    flat_from_world(survey->flat, middle, middle);
    vec3_subtract(middle, line->origin, from);
    double radius = 0.5 * vec3_norm(size) * survey->flat->scale;
    double along = vec3_dot(from, line->direction);
    double end = INFINITY;
    if (!line->is_open && line->count > 0) {
        double way[3];
        vec3_subtract(line->steps[line->count - 1].point, line->origin, way);
        end = vec3_dot(way, line->direction);
    }
    return along > 0.0 && along - radius < end &&
           vec3_dot(from, from) - along * along < radius * radius;
}

// Returns whether an object is a lamp whose light is correct although it is small: triangles that
// keep their exact form (flatten_lamps.h), or a shape that is not in view.
static bool is_small_lamp(const struct survey *survey, uint32_t object, const struct bounds *bounds)
{
    const struct flat_scene *flat = survey->flat;
    const struct scene *scene = survey->scene;
    if (!survey_is_instance(survey, object)) {
        const struct shape *shape = &scene->shapes[object - scene->instance_count];
        bool is_lamp = flatten_is_lamp(scene, shape->kind, shape->material);
        for (uint32_t i = 0; i < survey->line_count && is_lamp; i++)
            is_lamp = !comes_by(survey, &survey->lines[i], bounds);
        return is_lamp;
    }
    for (uint32_t i = 0; i < flat->small_count; i++) {
        uint32_t instance, triangle;
        flat_triangle_source(flat, flat->small[i].triangle, &instance, &triangle);
        if (instance == object)
            return true;
    }
    return false;
}

struct coarse {
    uint32_t count, first;
    double extent, farthest; // extent and distance from the origin, in metres, of the first object
    bool *marked;            // for each object of the scene: whether it is coarse
};

static void look_at_object(const struct survey *survey, const struct bounds *meshes,
                           uint32_t object, struct coarse *coarse)
{
    double extent, farthest;
    struct bounds bounds = object_bounds(survey, meshes, object), place = bounds;
    if (bounds_is_empty(&bounds))
        return;
    vec3_subtract(bounds.min, survey->flat->origin, bounds.min);
    vec3_subtract(bounds.max, survey->flat->origin, bounds.max);
    if (!flatten_is_coarse(&bounds, &extent, &farthest) || is_small_lamp(survey, object, &place))
        return;
    coarse->marked[object] = true;
    if (coarse->count++ > 0)
        return;
    coarse->first = object;
    coarse->extent = extent;
    coarse->farthest = farthest;
}

static const uint8_t *touched_by_bounds(struct survey *survey, const struct bounds *meshes,
                                        const bool *marked)
{
    uint8_t *flags = survey_flags(survey);
    for (uint32_t i = 0; flags && i < survey_object_count(survey); i++) {
        if (!marked[i])
            continue;
        const struct bounds bounds = object_bounds(survey, meshes, i);
        for (uint32_t k = 0; k < survey->line_count && !bounds_is_empty(&bounds); k++)
            flags[k] |= comes_by(survey, &survey->lines[k], &bounds);
    }
    return flags;
}

// Finds the pixels that show the objects or should show them. If there are none, finds the pixels
// that change through the objects' shadows, reflections or light. Sets *touched to NULL if the
// image is the same without the objects.
static bool find_touched(struct survey *survey, const struct bounds *meshes, const bool *marked,
                         const uint8_t **touched, struct err *err)
{
    double *with, *without;
    *touched = survey_touched_by_objects(survey, marked);
    if (survey_share(survey, *touched) > 0.0)
        return true;
    *touched = touched_by_bounds(survey, meshes, marked);
    if (survey_share(survey, *touched) > 0.0)
        return true;
    if (!survey_render_again(survey, &with, err) ||
        !survey_render_without(survey, marked, &without, err))
        return false;
    if (survey_difference(survey, with, without, touched) < DIFFERENCE_MIN)
        *touched = NULL;
    return true;
}

static bool add_objects(struct survey *survey, const struct bounds *meshes,
                        const struct coarse *coarse, struct err *err)
{
    struct arena *arena = survey->arena;
    const uint8_t *touched;
    double step = coarse->farthest * (double)FLT_EPSILON;
    if (coarse->count == 0)
        return true;
    const char *place = survey_object_name(survey, coarse->first);
    if (!find_touched(survey, meshes, coarse->marked, &touched, err))
        return false;
    return survey_add(
        survey,
        &(struct scene_finding){
            .name = "coarse-object",
            .level = touched ? FINDING_WRONG : FINDING_REMARK,
            .place = coarse->count == 1 || !place
                         ? place
                         : arena_printf(arena, "%s, and %u more", place, coarse->count - 1),
            .figure =
                arena_printf(arena,
                             "%g m across and up to %g m from the origin, where coordinates have "
                             "steps of %.2g m, %.2g %% of its size",
                             coarse->extent, coarse->farthest, step, 100.0 * step / coarse->extent),
            .consequence = touched
                               ? "Its form, its shadows and the light that it emits are wrong."
                               : "Its form is wrong, but a render without it gives the same image.",
            .remedy = "Move the scene so that its important parts are near the origin or near the "
                      "camera, or make the object larger.",
            .share = survey_share(survey, touched),
            .pixels = touched,
        },
        err);
}

// Finds a mesh whose vertices have lost digits in its file, which stores single precision.
static bool look_at_mesh(struct survey *survey, uint32_t index, const struct bounds *meshes,
                         struct err *err)
{
    const struct scene *scene = survey->scene;
    double extent, farthest;
    uint32_t object = SCENE_NONE;
    const uint8_t *touched;
    if (scene->meshes[index].exact_positions ||
        !flatten_is_coarse(&meshes[index], &extent, &farthest))
        return true;
    bool *marked = ARENA_NEW(&survey->scratch, bool, survey_object_count(survey));
    if (!marked)
        return err_memory(err, "marks of objects", survey_object_count(survey));
    for (uint32_t i = scene->instance_count; i-- > 0;)
        if (scene->instances[i].mesh == index && !scene->instances[i].hidden) {
            marked[i] = true;
            object = i;
        }
    if (object == SCENE_NONE)
        return true;
    if (!find_touched(survey, meshes, marked, &touched, err))
        return false;
    return survey_add(
        survey,
        &(struct scene_finding){
            .name = "coarse-mesh",
            .level = touched ? FINDING_WRONG : FINDING_REMARK,
            .place = survey_object_name(survey, object),
            .figure = arena_printf(survey->arena,
                                   "%g in size and %g from its own origin, where the coordinates "
                                   "in its file have steps of %.2g",
                                   extent, farthest, farthest * (double)FLT_EPSILON),
            .consequence = touched ? "Its vertices were rounded in the file, so its form is wrong."
                                   : "Its vertices were rounded in the file, so its form is wrong, "
                                     "but a render without it gives the same image.",
            .remedy = "Export the mesh with its own centre as origin, and place it by a transform.",
            .share = survey_share(survey, touched),
            .pixels = touched,
        },
        err);
}

static bool look_at_camera(struct survey *survey, struct err *err)
{
    struct arena *arena = survey->arena;
    const struct far_fault fault =
        far_camera_judge(survey->flat, survey->camera, survey->settings.height);
    if (fault.kind == FAR_FAULT_NONE)
        return true;
    bool is_lost = fault.kind == FAR_FAULT_SCENE;
    const char *name = survey->camera->name;
    return survey_add(
        survey,
        &(struct scene_finding){
            .name = "far-camera",
            .level = is_lost ? FINDING_SLOW : FINDING_WRONG,
            .place = name && *name ? arena_printf(arena, "camera \"%s\"", name) : "the camera",
            .figure =
                is_lost
                    ? arena_printf(arena,
                                   "the scene is %g m across and %g m away, which is %.2g "
                                   "of a pixel",
                                   fault.extent, fault.distance, fault.pixels)
                    : arena_printf(
                          arena, "a pixel is %.2g radians wide, but directions have steps of %.2g",
                          fault.pixel, fault.direction),
            .consequence = is_lost ? "Samples hardly ever hit the scene."
                                   : "Single precision cannot distinguish the pixels.",
            .remedy =
                is_lost
                    ? "Move the camera nearer, or make its field of view narrower."
                    : "Make the field of view wider, or move the camera away from the whole scene.",
            .share = 1.0,
        },
        err);
}

bool find_coarse(struct survey *survey, struct err *err)
{
    const struct scene *scene = survey->scene;
    uint32_t objects = survey_object_count(survey);
    struct coarse coarse = {.marked = ARENA_NEW(&survey->scratch, bool, objects)};
    const struct bounds *meshes = list_mesh_bounds(survey, err);
    if (!meshes || !coarse.marked)
        return err_memory(err, "bounds", objects);
    for (uint32_t i = 0; i < objects; i++)
        if (!*survey_hidden(survey, i))
            look_at_object(survey, meshes, i, &coarse);
    if (!add_objects(survey, meshes, &coarse, err))
        return false;
    for (uint32_t i = 0; i < scene->mesh_count; i++)
        if (!look_at_mesh(survey, i, meshes, err))
            return false;
    return look_at_camera(survey, err);
}
