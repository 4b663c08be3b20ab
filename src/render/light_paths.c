#include "render/light_paths.h"

#include "flatten/flatten_shapes.h"
#include "render/tables/emitter_power.h"
#include "render/tables/emitters.h"
#include "scene/core/settings.h"
#include "shared/aov.h"
#include "shared/methods.h"
#include <math.h>

// --- settings ------------------------------------------------------------------------------------

struct limit {
    bool is_broken;
    const char *has, *why, *wants;
};

static bool check_limits(const struct limit *limits, size_t count, struct err *err)
{
    for (size_t i = 0; i < count; i++)
        if (limits[i].is_broken)
            return err_set(err, ERR_INPUT,
                           "--integrator bidir cannot have %s, because %s; expected %s, or "
                           "--integrator path",
                           limits[i].has, limits[i].why, limits[i].wants);
    return true;
}

static bool check_settings(const struct light_paths_params *p, struct err *err)
{
    const struct settings *s = &p->scene->settings;
    bool is_chosen = s->light_choice != LIGHT_CHOICE_AUTO && s->light_choice != LIGHT_CHOICE_POWER;
    bool is_panorama = p->camera->kind == CAMERA_PANORAMIC;
    const struct limit limits[] = {
        {!s->nee || s->nee_depth < s->max_bounces, "vertices without shadow rays",
         "its weights assume shadow rays at every vertex", "--nee on and no --nee-depth"},
        {s->mis == MIS_NONE, "--mis none", "its three ways to find light need weights",
         "--mis power or --mis balance"},
        {is_chosen, "this --light-choice", "light paths choose emitters by power",
         "--light-choice auto or power"},
        {s->directions != DIRECTIONS_BSDF, "these --directions",
         "light paths are scattered by sampling the BSDF", "--directions bsdf"},
        {s->clamp_limit > 0.0f, "--clamp",
         "the light that a light path adds to a pixel is no sample of that pixel", "--clamp off"},
        {s->min_density > 0.0f, "--min-density",
         "light paths would continue where camera paths end", "--min-density 0"},
        {s->split_lobes > 0, "--split-lobes", "light paths do not split", "--split-lobes 0"},
        {s->accumulation != ACCUMULATION_BINNED, "this --accumulation",
         "light paths reach pixels in any order", "--accumulation binned"},
        {!settings_spread_over_pixel(s) || s->pixel_sampling == PIXEL_SAMPLING_GRID,
         "samples at fixed points of pixels", "no light path reaches exactly these points",
         "--pixel-jitter on and another --pixel-sampling"},
        {settings_filter_radius(s) < 0.5f, "a filter narrower than a pixel",
         "light paths would seldom meet the area that the filter covers",
         "--filter-radius 0.5 or more"},
        {is_panorama && settings_filter_radius(s) > 0.5f,
         "a panoramic camera with a filter that is wider than a pixel",
         "light paths do not continue the filter across the picture's edges", "--filter box"},
        {p->tiles, "--adaptive",
         "all pixels share the light paths, so they need the same number of samples",
         "--adaptive off"},
        {p->has_window, "--crop", "a light path may reach any pixel of the whole picture",
         "the whole picture"},
        {(p->aovs & (AOVS_OF_PARTS | AOVS_BY)) != 0,
         "the layers emission, direct and indirect, or --error-by",
         "the light that light paths find is not split by source", "a render without these"},
    };
    return check_limits(limits, sizeof limits / sizeof *limits, err);
}

// --- media ---------------------------------------------------------------------------------------

struct box {
    float min[3], max[3]; // min > max: empty
};

static const struct box empty_box = {{INFINITY, INFINITY, INFINITY},
                                     {-INFINITY, -INFINITY, -INFINITY}};

static void box_add(struct box *box, const float point[3])
{
    for (int c = 0; c < 3; c++) {
        box->min[c] = fminf(box->min[c], point[c]);
        box->max[c] = fmaxf(box->max[c], point[c]);
    }
}

static bool boxes_meet(const struct box *a, const struct box *b)
{
    for (int c = 0; c < 3; c++)
        if (!(a->min[c] <= b->max[c] && b->min[c] <= a->max[c]))
            return false;
    return true;
}

static struct box box_of_triangle(const struct flat_triangle *triangle)
{
    struct box box = empty_box;
    for (int corner = 0; corner < 3; corner++)
        box_add(&box, triangle->v[corner]);
    return box;
}

// Returns whether a box meets an emitter on which light paths begin. Emitters at infinity do not
// count.
static bool has_emitter_in(const struct light_paths_params *p, const struct box *box)
{
    const struct scene *scene = p->scene;
    const struct flat_scene *flat = p->flat;
    for (uint32_t i = 0; i < flat->world_triangle_count; i++) {
        struct box own = box_of_triangle(&flat->triangles[i]);
        if (boxes_meet(&own, box) &&
            mean_radiance(scene, &scene->materials[flat->triangles[i].material]) > 0.0)
            return true;
    }
    for (uint32_t i = 0; i < flat->shape_count; i++) {
        const struct flat_shape *shape = &flat->shapes[i];
        struct box own;
        if (!shape_is_emitter(shape->kind) ||
            !(mean_radiance(scene, &scene->materials[shape->material]) > 0.0))
            continue;
        flat_shape_box(shape, own.min, own.max);
        if (boxes_meet(&own, box))
            return true;
    }
    for (uint32_t i = 0; i < scene->light_count; i++) {
        struct light light = flat_light(flat, &scene->lights[i]);
        struct box own = empty_box;
        if (light.hidden || light.kind == LIGHT_DIRECTIONAL)
            continue;
        box_add(&own, (const float[3]){(float)light.position[0], (float)light.position[1],
                                       (float)light.position[2]});
        if (boxes_meet(&own, box))
            return true;
    }
    return false;
}

static bool is_medium(const struct light_paths_params *p, uint32_t material)
{
    return material_has_inside(&p->scene->materials[material]);
}

// Returns the box of those triangles of a range that bound media. `material` replaces the
// triangles' own materials unless it is SCENE_NONE.
static struct box box_of_media(const struct light_paths_params *p, uint32_t first, uint32_t count,
                               uint32_t material)
{
    struct box box = empty_box;
    for (uint32_t i = first; i < first + count; i++) {
        const struct flat_triangle *triangle = &p->flat->triangles[i];
        if (is_medium(p, material == SCENE_NONE ? triangle->material : material))
            for (int corner = 0; corner < 3; corner++)
                box_add(&box, triangle->v[corner]);
    }
    return box;
}

// Returns the box in world space of a placed mesh.
static struct box place_box(const struct box *box, const float to_world[3][4])
{
    struct box placed = empty_box;
    for (int corner = 0; corner < 8 && box->min[0] <= box->max[0]; corner++) {
        float point[3];
        for (int row = 0; row < 3; row++) {
            point[row] = to_world[row][3];
            for (int c = 0; c < 3; c++)
                point[row] += to_world[row][c] * (corner >> c & 1 ? box->max[c] : box->min[c]);
        }
        box_add(&placed, point);
    }
    return placed;
}

static bool refuse_lamp(const char *kind, uint32_t number, struct err *err)
{
    return err_set(
        err, ERR_INPUT,
        "--integrator bidir: a lamp intersects the bounding box of %s %u, which has a medium "
        "inside; expected lamps outside of such boxes, because light paths begin in air, or "
        "--integrator path",
        kind, number);
}

// Refuses emitters that may be inside a medium, because light paths begin in air.
static bool check_media(const struct light_paths_params *p, struct err *err)
{
    const struct flat_scene *flat = p->flat;
    for (uint32_t i = 0; i < p->scene->instance_count; i++) {
        uint32_t first, count;
        flat_instance_triangles(flat, i, &first, &count);
        struct box box = box_of_media(p, first, count, SCENE_NONE);
        if (has_emitter_in(p, &box))
            return refuse_lamp("instance", i, err);
    }
    for (uint32_t i = 0; i < flat->placed_count; i++) {
        const struct flat_instance *instance = &flat->instances[i];
        const struct flat_mesh *mesh = &flat->meshes[instance->mesh];
        struct box own =
            box_of_media(p, mesh->first_triangle, mesh->triangle_count, instance->material);
        struct box box = place_box(&own, instance->to_world);
        if (has_emitter_in(p, &box))
            return refuse_lamp("instance", instance->source, err);
    }
    for (uint32_t i = 0; i < flat->shape_count; i++) {
        const struct flat_shape *shape = &flat->shapes[i];
        struct box box;
        if (!is_medium(p, shape->material))
            continue;
        flat_shape_box(shape, box.min, box.max);
        if (has_emitter_in(p, &box))
            return refuse_lamp("shape", shape->source, err);
    }
    return true;
}

// --- emitters ------------------------------------------------------------------------------------

static bool check_emitters(const struct light_paths_params *p, struct err *err)
{
    // Paths of light that comes from infinitely far begin near the scene's bounds, which planes
    // exceed: they would begin behind a plane.
    for (uint32_t i = 0; i < p->flat->shape_count; i++)
        if (p->flat->shapes[i].kind == SHAPE_PLANE)
            return err_set(err, ERR_INPUT,
                           "--integrator bidir: shape %u is an infinite plane, behind which light "
                           "paths could begin; expected a quad, or --integrator path",
                           p->flat->shapes[i].source);
    for (uint32_t i = 0; i < p->scene->light_count; i++) {
        const struct light *light = &p->scene->lights[i];
        if (!light->hidden && light->kind != LIGHT_DIRECTIONAL && isfinite(light->range))
            return err_set(err, ERR_INPUT,
                           "--integrator bidir: light %u has a range of %g m, but light paths "
                           "do not end at a distance; expected no range, or "
                           "--integrator path",
                           i, (double)light->range);
    }
    return p->flat->small_count == 0 ||
           err_set(err, ERR_INPUT,
                   "--integrator bidir: %u emissive triangles are too small relative to their "
                   "coordinates for light paths to begin on them; expected larger lamps, or "
                   "--integrator path",
                   p->flat->small_count);
}

bool light_paths_support(const struct light_paths_params *p, struct err *err)
{
    return check_settings(p, err) && check_emitters(p, err) && check_media(p, err);
}

bool light_paths_check(const struct light_paths_params *p, struct err *err)
{
    return p->scene->settings.integrator != INTEGRATOR_BIDIR || light_paths_support(p, err);
}
