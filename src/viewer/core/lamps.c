#include "viewer/core/lamps.h"

#include "scene/core/affine.h"
#include "scene/core/bounds.h"
#include "scene/core/emission.h"
#include "scene/core/environment.h"
#include "scene/core/light.h"
#include "viewer/core/messages.h"
#include "viewer/core/viewer.h"
#include <math.h>
#include <string.h>

// Fractions of the radius of the scene's bounding sphere: the distance of a new lamp from the
// sphere's centre, and half of the lamp's side.
#define LAMP_DISTANCE 0.75
#define LAMP_HALF_EDGE 0.1

static const struct material *material_of(const struct scene *scene, uint32_t object)
{
    uint32_t material;
    if (object < scene->instance_count) {
        const struct instance *instance = &scene->instances[object];
        material = instance->material;
        if (material == SCENE_NONE)
            material = scene->meshes[instance->mesh].material;
    } else {
        material = scene->shapes[object - scene->instance_count].material;
    }
    return material < scene->material_count ? &scene->materials[material] : NULL;
}

bool lamp_is(const struct scene *scene, uint32_t object)
{
    const struct material *material = material_of(scene, object);
    return material && mean_radiance(scene, material) * mean_opacity(scene, material) > 0;
}

// --- light sent to the centre of the scene -------------------------------------------------------

// Returns the radius of the scene's bounding sphere and computes its centre. The radius is 1 m if
// the scene is empty or infinite.
static double middle_of_scene(const struct document *document, double middle[3])
{
    double half[3];
    for (int c = 0; c < 3; c++) {
        half[c] = 0.5 * (document->bounds_max[c] - document->bounds_min[c]);
        middle[c] = document->bounds_min[c] + half[c];
    }
    double radius = vec3_length(half);
    if (radius > 0 && isfinite(radius))
        return radius;
    memset(middle, 0, 3 * sizeof *middle);
    return 1;
}

// Returns the area of a mesh projected along `way`. For an open surface all normals count; for a
// closed one half of them, because the other half faces away.
static double projected_mesh(const struct scene *scene, const struct instance *instance,
                             const double way[3])
{
    const struct mesh *mesh = &scene->meshes[instance->mesh];
    double sum = 0, all = 0;
    for (uint32_t t = 0; t < mesh->triangle_count; t++) {
        double corners[3][3], edges[2][3], normal[3];
        for (int i = 0; i < 3; i++) {
            mesh_vertex(mesh, mesh->indices[t][i], corners[i]);
            affine_point(instance->transform, corners[i], corners[i]);
        }
        vec3_subtract(corners[1], corners[0], edges[0]);
        vec3_subtract(corners[2], corners[0], edges[1]);
        vec3_cross(edges[0], edges[1], normal);
        sum += 0.5 * vec3_dot(normal, way);
        all += 0.5 * fabs(vec3_dot(normal, way));
    }
    return 0.5 * (all + fabs(sum));
}

static double projected_shape(const struct shape *shape, const double way[3])
{
    const double(*a)[3] = shape->axes;
    double normal[3], area = 0, length = vec3_length(a[0]);
    switch (shape->kind) {
    case SHAPE_SPHERE:
        return M_PI * shape->radius * shape->radius;
    case SHAPE_DISC:
        return M_PI * shape->radius * shape->radius * fabs(vec3_dot(shape->normal, way));
    case SHAPE_QUAD:
    case SHAPE_BOX:
        for (int i = 0; i < (shape->kind == SHAPE_BOX ? 3 : 1); i++) {
            vec3_cross(a[i], a[(i + 1) % 3], normal);
            area += 4 * fabs(vec3_dot(normal, way));
        }
        return area;
    case SHAPE_CYLINDER:
    case SHAPE_TUBE: {
        double along = fmin(fabs(vec3_dot(a[0], way)) / length, 1);
        return 4 * shape->radius * length * sqrt(1 - along * along) +
               M_PI * shape->radius * shape->radius * along;
    }
    case SHAPE_PLANE:
    case SHAPE_SDF:
    case SHAPE_KIND_COUNT:
        break;
    }
    return 0;
}

static double projected_area(const struct scene *scene, uint32_t object, const double way[3])
{
    return object < scene->instance_count
               ? projected_mesh(scene, &scene->instances[object], way)
               : projected_shape(&scene->shapes[object - scene->instance_count], way);
}

// --- new lamps -----------------------------------------------------------------------------------

// Sets the corner and edges of a square about `center` so that it faces the direction `way`.
static void aim_quad(struct shape *quad, const double center[3], const double way[3], double half)
{
    double across[3] = {fabs(way[0]) < 0.5, fabs(way[0]) >= 0.5, 0}, up[3];
    vec3_cross(way, across, up);
    vec3_normalize(up);
    vec3_cross(up, way, across); // the cross product of across and up is then `way`
    memcpy(quad->center, center, sizeof quad->center);
    for (int c = 0; c < 3; c++) {
        quad->axes[0][c] = half * across[c];
        quad->axes[1][c] = half * up[c];
    }
}

// Adds a square lamp. Its material and its shape become the last ones of their lists.
static bool add_quad(struct viewer *viewer, const struct shape *like, const double radiance[3],
                     const char *control)
{
    const struct scene *scene = &viewer->document.scene;
    struct list_counts counts = edit_counts(viewer);
    counts.materials++;
    counts.shapes++;
    if (!edit_lists(viewer, &counts, control))
        return false;
    uint32_t last = scene->shape_count - 1;
    struct material lamp = scene->materials[scene->material_count - 1];
    struct shape quad = scene->shapes[last];
    lamp.name = "lamp";
    for (int c = 0; c < 3; c++) {
        lamp.base_color[c] = 0;
        lamp.emission[c] = (float)fmin(radiance[c], SCENE_RADIANCE_MAX);
    }
    memcpy(quad.center, like->center, sizeof quad.center);
    memcpy(quad.axes, like->axes, sizeof quad.axes);
    quad.material = scene->material_count - 1;
    viewer->document.chosen_object = scene->instance_count + last;
    viewer->document.chosen_material = quad.material;
    return edit_material(viewer, quad.material, &lamp, control) &&
           edit_shape(viewer, last, &quad, control);
}

static bool add_directional(struct viewer *viewer, const double way[3], const double irradiance[3],
                            const char *control)
{
    const struct scene *scene = &viewer->document.scene;
    struct list_counts counts = edit_counts(viewer);
    uint32_t index = counts.lights++;
    if (!edit_lists(viewer, &counts, control))
        return false;
    struct light light = scene->lights[index];
    light.name = "light";
    light.kind = LIGHT_DIRECTIONAL;
    memcpy(light.direction, way, sizeof light.direction);
    for (int c = 0; c < 3; c++)
        light.radiant[c] = (float)fmin(irradiance[c], SCENE_RADIANCE_MAX);
    viewer->document.chosen_light = index;
    return edit_light(viewer, index, &light, control);
}

bool lamp_add(struct viewer *viewer, const char *control)
{
    const double down[3] = {0, -1, 0}, white[3] = {10, 10, 10};
    double middle[3], radius = middle_of_scene(&viewer->document, middle);
    struct shape quad;
    memset(&quad, 0, sizeof quad);
    middle[1] += fmin(LAMP_DISTANCE * radius,
                      // The lamp must be below the ceiling, if there is one.
                      0.9 * (viewer->document.bounds_max[1] - middle[1]));
    aim_quad(&quad, middle, down, LAMP_HALF_EDGE * radius);
    edit_begin_group(viewer);
    bool ok = add_quad(viewer, &quad, white, control);
    edit_end_group(viewer);
    return ok;
}

bool light_add(struct viewer *viewer, const char *control)
{
    const double white[3] = {1, 1, 1};
    double way[3] = {-0.5, -1, -0.5};
    vec3_normalize(way);
    edit_begin_group(viewer);
    bool ok = add_directional(viewer, way, white, control);
    edit_end_group(viewer);
    return ok;
}

// --- exchanging lamps and lights -----------------------------------------------------------------

bool lamp_exchange(struct viewer *viewer, uint32_t object, const char *control)
{
    const struct scene *scene = &viewer->document.scene;
    const struct material *material = material_of(scene, object);
    double middle[3], center[3], way[3], irradiance[3];
    float radiance[3];
    middle_of_scene(&viewer->document, middle);
    scene_object_middle(scene, object, center);
    vec3_subtract(middle, center, way);
    double distance = vec3_length(way);
    if (!lamp_is(scene, object) || !vec3_normalize(way)) {
        viewer_message(viewer, MESSAGE_WARNING,
                       "object %u sends no light to the scene's centre, so it is not replaced",
                       object);
        return false;
    }
    double solid_angle = projected_area(scene, object, way) / (distance * distance);
    mean_emission(scene, material, radiance);
    for (int c = 0; c < 3; c++)
        irradiance[c] = (double)radiance[c] * mean_opacity(scene, material) * solid_angle;
    edit_begin_group(viewer);
    bool ok = edit_visible(viewer, object, false, control) &&
              add_directional(viewer, way, irradiance, control);
    edit_end_group(viewer);
    return ok;
}

bool light_exchange(struct viewer *viewer, uint32_t index, const char *control)
{
    const struct scene *scene = &viewer->document.scene;
    struct light light = scene->lights[index];
    double middle[3], radiance[3], radius = middle_of_scene(&viewer->document, middle);
    double distance = LAMP_DISTANCE * radius, edge = 2 * LAMP_HALF_EDGE * radius;
    struct shape quad;
    memset(&quad, 0, sizeof quad);
    if (light.kind != LIGHT_DIRECTIONAL) {
        viewer_message(viewer, MESSAGE_WARNING,
                       "light %u is not directional, so it is not replaced", index);
        return false;
    }
    for (int c = 0; c < 3; c++) {
        middle[c] -= distance * light.direction[c];
        radiance[c] = (double)light.radiant[c] * (distance / edge) * (distance / edge);
    }
    aim_quad(&quad, middle, light.direction, 0.5 * edge);
    light.hidden = true;
    edit_begin_group(viewer);
    bool ok =
        edit_light(viewer, index, &light, control) && add_quad(viewer, &quad, radiance, control);
    edit_end_group(viewer);
    return ok;
}
