#include "render/tables/emitters.h"

#include "base/clock.h"
#include "base/log.h"
#include "base/maths.h"
#include "flatten/flatten_shapes.h"
#include "render/tables/alias_table.h"
#include "render/tables/emitter_power.h"
#include "render/tables/light_tree.h"
#include "render/tables/shading_tables.h"
#include "scene/core/environment.h"
#include "scene/core/light.h"
#include <math.h>
#include <string.h>

bool shape_is_emitter(uint32_t kind)
{
    return kind != SHAPE_PLANE && kind != SHAPE_SDF;
}

struct emitter_counts emitters_count(const struct scene *scene, const struct flat_scene *flat)
{
    const struct environment *environment = &scene->environment;
    struct emitter_counts counts = {.environment = environment->present && environment->width > 0 &&
                                                   environment_luminance(environment) > 0.0};
    for (uint32_t i = 0; i < scene->light_count; i++) {
        bool is_sun = light_is_sun(&scene->lights[i]);
        counts.suns += is_sun;
        counts.lights += !is_sun && !scene->lights[i].hidden;
    }
    for (uint32_t i = 0; i < flat->triangle_count; i++)
        counts.triangles +=
            mean_radiance(scene, &scene->materials[flat->triangles[i].material]) > 0.0;
    for (uint32_t i = 0; i < flat->shape_count; i++) {
        uint32_t kind = flat->shapes[i].kind;
        if (shape_is_emitter(kind) &&
            mean_radiance(scene, &scene->materials[flat->shapes[i].material]) > 0.0)
            counts.shapes[kind]++;
    }
    return counts;
}

uint64_t emitters_total(const struct emitter_counts *counts)
{
    uint64_t total = (uint64_t)counts->triangles + counts->lights + counts->suns;
    for (uint32_t kind = 0; kind < SHAPE_KIND_COUNT; kind++)
        total += counts->shapes[kind];
    return total + counts->environment;
}

// --- the list of emitters ------------------------------------------------------------------------

struct emitter_list {
    uint32_t *primitives;
    double *powers; // see emitter_power.h
    uint32_t count, surface_count;
    double total;
};

static bool stopped(struct err *err)
{
    return err_set(err, ERR_STOPPED, "stopped while listing the emitters");
}

static void add_emitter(struct emitter_list *list, uint32_t primitive, double power)
{
    list->primitives[list->count] = primitive;
    list->powers[list->count++] = power;
    list->total += power;
}

// Lists triangles in the order of the flat scene, so that the BVH does not affect the number of an
// emitter, by which random numbers select it.
static bool list_triangles(const struct shading_tables_params *p, struct emitter_list *list,
                           struct err *err)
{
    const struct flat_scene *flat = p->flat;
    const struct bvh *bvh = p->bvh;
    bool ok = true;
    struct arena scratch = {0};
    uint32_t *places = ARENA_NEW(&scratch, uint32_t, flat->triangle_count); // places of triangles
                                                                            // in leaf order
    if (!places)
        return err_memory(err, "emitters", flat->triangle_count * sizeof *places);
    for (uint32_t i = 0; i < bvh->reference_count; i++)
        places[bvh->triangle_order[i]] = i;
    for (uint32_t i = 0; ok && i < flat->triangle_count; i++) {
        const struct flat_triangle *triangle = &flat->triangles[i];
        double radiance = mean_radiance(p->scene, &p->scene->materials[triangle->material]);
        if (radiance > 0.0)
            add_emitter(list, places[i], radiance * triangle_area(flat, i));
        if (progress_stops_at(p->progress, i))
            ok = stopped(err);
    }
    arena_finish(&scratch);
    return ok;
}

// Returns the luminance above which shadow rays sample the environment's image. Scattered rays find
// the rest. The luminance is the image's mean (MIS compensation: Karlik, Sik, Vevoda, Skrivan,
// Krivanek 2019) if MIS weights both strategies and scattered rays may find the image from every
// surface that reflects it. Otherwise it is 0.
static double environment_floor(const struct scene *scene)
{
    const struct settings *settings = &scene->settings;
    if (settings->environment_sampling != ENVIRONMENT_SAMPLING_COMPENSATED ||
        settings->mis == MIS_NONE || settings->directions != DIRECTIONS_BSDF ||
        settings->min_density > 0.0f || scene->environment.width == 0)
        return 0.0;
    double mean = environment_luminance(&scene->environment);
    // In a uniform image only rounding errors exceed the mean.
    bool is_even = environment_luminance_above(&scene->environment, mean) <= 0x1p-20 * mean;
    return is_even ? 0.0 : mean;
}

// Lists every primitive that emits. Primitives of zero area are listed, too, with weight 0.
static bool list_emitters(const struct shading_tables_params *p, double floor, struct arena *arena,
                          struct emitter_list *list, struct err *err)
{
    const struct scene *scene = p->scene;
    const struct flat_scene *flat = p->flat;
    struct emitter_counts counts = emitters_count(scene, flat);
    uint64_t count = emitters_total(&counts);
    *list = (struct emitter_list){.primitives = ARENA_NEW(arena, uint32_t, count),
                                  .powers = ARENA_NEW(arena, double, count)};
    if (!list->primitives || !list->powers)
        return err_memory(err, "emitters", count * 12);
    if (counts.triangles && !list_triangles(p, list, err))
        return false;
    for (uint32_t i = 0; i < flat->shape_count; i++) {
        const struct flat_shape *shape = &flat->shapes[i];
        double radiance = mean_radiance(scene, &scene->materials[shape->material]);
        if (shape_is_emitter(shape->kind) && radiance > 0.0)
            add_emitter(list, PRIMITIVE_SHAPE | i, radiance * shape_area(shape));
    }
    list->surface_count = list->count;
    for (uint32_t i = 0; i < scene->light_count; i++) {
        const struct light light = flat_light(flat, &scene->lights[i]);
        if (!light.hidden)
            add_emitter(list, PRIMITIVE_LIGHT | i, light_power(&light, flat));
    }
    if (counts.environment)
        add_emitter(list, PRIMITIVE_ENVIRONMENT,
                    environment_power(&scene->environment, floor, flat));
    return true;
}

// --- delta lights, and suns ----------------------------------------------------------------------

// Returns the record of a light, without its selection probability. `light` is a result of
// flat_light().
static struct gpu_light light_record(const struct light *light, float reach)
{
    struct gpu_light record = {
        .kind = light->kind,
        .inverse_range = (float)(1.0 / (double)light->range),
        .reach = reach,
    };
    for (int c = 0; c < 3; c++) {
        record.position[c] = (float)light->position[c];
        record.direction[c] = (float)light->direction[c];
        record.radiant[c] = light->radiant[c];
    }
    if (light->kind == LIGHT_SPOT) {
        double width = spot_width(light);
        record.spot_scale = (float)(1.0 / width);
        record.spot_offset = (float)(versine((double)light->outer_angle) / width);
    }
    if (light->kind == LIGHT_DIRECTIONAL)
        record.versine = (float)versine(light->angular_radius);
    return record;
}

// Reports a light that is so far from the scene that its contribution, divided by the squared
// distance, would not be finite.
static bool check_place(const struct scene *scene, const struct flat_scene *flat,
                        const struct light *light, const struct light *placed, struct err *err)
{
    for (int c = 0; c < 3; c++)
        if (light->kind != LIGHT_DIRECTIONAL && !(fabs(placed->position[c]) <= FLAT_COORDINATE_MAX))
            return err_set(err, ERR_INPUT,
                           "%s: light %td at (%g, %g, %g) is too far from a scene that is %g m "
                           "across; expected it within %g m",
                           scene->path ? scene->path : "scene", light - scene->lights,
                           light->position[0], light->position[1], light->position[2],
                           2.0 * bounding_radius(flat) / flat->scale,
                           FLAT_COORDINATE_MAX / flat->scale);
    return true;
}

static bool fill_lights(const struct scene *scene, const struct flat_scene *flat,
                        struct arena *arena, struct emitters *out, struct err *err)
{
    uint32_t count = scene->light_count;
    if (count == 0)
        return true;
    out->lights = ARENA_NEW(arena, struct gpu_light, count);
    if (!out->lights)
        return err_memory(err, "lights", count * sizeof *out->lights);
    uint32_t dark = 0;
    for (uint32_t i = 0; i < count; i++) {
        const struct light light = flat_light(flat, &scene->lights[i]);
        if (light.hidden)
            continue;
        if (!check_place(scene, flat, &scene->lights[i], &light, err))
            return false;
        out->lights[i] = light_record(&light, out->reach);
        dark += !(out->lights[i].versine > 0.0f);
    }
    if (!scene->settings.nee && dark > 0)
        log_warn(
            "%u delta lights are dark, because only next-event estimation finds them; expected "
            "--nee on",
            dark);
    return true;
}

// Adds `pick` to the selection probability of a light or of the environment; other emitters have
// theirs in their materials.
static void add_pick(struct emitters *out, uint32_t primitive, double pick)
{
    if (primitive == PRIMITIVE_ENVIRONMENT)
        out->environment_pick += (float)pick;
    else if (primitive & PRIMITIVE_LIGHT)
        out->lights[primitive & ~PRIMITIVE_LIGHT].pick_probability += (float)pick;
}

// --- light sampling strategies -------------------------------------------------------------------

// Fills bins[count], and adds the selection probabilities of lights and of the environment that
// follow from them, multiplied by `share`.
static bool fill_bins(const uint32_t *primitives, const double *powers, uint32_t count,
                      double share, struct arena *arena, struct gpu_emitter *bins,
                      struct emitters *out, struct err *err)
{
    struct alias_bin *table = ARENA_NEW(arena, struct alias_bin, count);
    double *sums = ARENA_NEW(arena, double, count);
    if (!table || !sums || !alias_table_build(powers, count, arena, table))
        return err_memory(err, "emitters", (uint64_t)count * sizeof *bins);
    for (uint32_t i = 0; i < count; i++) {
        bins[i] = (struct gpu_emitter){.threshold = table[i].threshold,
                                       .primitive = primitives[i],
                                       .alias_primitive = primitives[table[i].alias]};
        sums[i] += (double)table[i].threshold;
        sums[table[i].alias] += 1.0 - (double)table[i].threshold;
    }
    for (uint32_t i = 0; i < count; i++)
        add_pick(out, primitives[i], share * (sums[i] / count));
    return true;
}

static bool build_power(const struct emitter_list *list, struct arena *arena, struct emitters *out,
                        struct err *err)
{
    if (!(list->total > 0.0))
        return true;
    struct gpu_emitter *bins = ARENA_NEW(arena, struct gpu_emitter, list->count);
    if (!bins)
        return err_memory(err, "emitters", (uint64_t)list->count * sizeof *bins);
    out->data = bins;
    out->bytes = (uint64_t)list->count * sizeof *bins;
    out->count = list->count;
    out->total_power = list->total;
    return fill_bins(list->primitives, list->powers, list->count, 1.0, arena, bins, out, err);
}

// Builds a list of all emitters, as bins without aliases, which are selected with equal
// probability.
static bool build_list(const struct emitter_list *list, struct arena *arena, struct emitters *out,
                       struct err *err)
{
    struct gpu_emitter *bins = ARENA_NEW(arena, struct gpu_emitter, list->count);
    if (!bins)
        return err_memory(err, "emitters", (uint64_t)list->count * sizeof *bins);
    out->data = bins;
    out->bytes = (uint64_t)list->count * sizeof *bins;
    out->count = list->count;
    for (uint32_t i = 0; i < list->count; i++) {
        bins[i] = (struct gpu_emitter){.threshold = 1.0f,
                                       .primitive = list->primitives[i],
                                       .alias_primitive = list->primitives[i]};
        add_pick(out, list->primitives[i], 1.0 / list->count);
    }
    return true;
}

// --- the light tree ------------------------------------------------------------------------------

static void bound_triangle(const struct flat_scene *flat, uint32_t id, struct light_bounds *out)
{
    const struct flat_triangle *triangle = &flat->triangles[id];
    double e[2][3], n[3], center[3], radius = 0.0;
    vec3s corners[3];
    memcpy(corners, triangle->v, sizeof corners);
    out->min = glms_vec3_minv(glms_vec3_minv(corners[0], corners[1]), corners[2]);
    out->max = glms_vec3_maxv(glms_vec3_maxv(corners[0], corners[1]), corners[2]);
    out->center = light_bounds_middle(out);
    flat_triangle_edges(flat, id, e);
    vec3_cross(e[0], e[1], n);
    double length = vec3_norm(n);
    for (int c = 0; c < 3; c++)
        out->axis[c] = n[c] / length;
    vec3_widen(out->center.raw, center);
    for (int corner = 0; corner < 3; corner++) {
        double from[3];
        vec3_widen(triangle->v[corner], from);
        vec3_subtract(from, center, from);
        radius = fmax(radius, vec3_norm(from));
    }
    out->radius = (float)(radius * 1.000001);
    out->theta_e = 0.5 * M_PI;
    out->two_sided = true;
}

static bool is_flat_shape(const struct flat_shape *shape)
{
    return shape->kind == SHAPE_DISC || shape->kind == SHAPE_QUAD;
}

static void bound_sphere_or_disc(const struct flat_shape *shape, struct light_bounds *out)
{
    bool is_sphere = shape->kind == SHAPE_SPHERE;
    for (int c = 0; c < 3; c++) {
        float n = shape->normal[c];
        float extent = is_sphere ? shape->radius : shape->radius * sqrtf(fmaxf(0.0f, 1.0f - n * n));
        out->min.raw[c] = shape->center[c] - extent;
        out->max.raw[c] = shape->center[c] + extent;
        out->axis[c] = is_sphere ? c == 2 : (double)n;
    }
    out->radius = shape->radius * 1.000001f;
}

static void bound_quad(const struct flat_shape *shape, struct light_bounds *out)
{
    double u[3], v[3], n[3], diagonals[2][3];
    vec3_widen(shape->axes[0], u);
    vec3_widen(shape->axes[1], v);
    vec3_cross(u, v, n);
    double length = vec3_norm(n);
    for (int c = 0; c < 3; c++) {
        out->axis[c] = n[c] / length;
        diagonals[0][c] = u[c] + v[c];
        diagonals[1][c] = u[c] - v[c];
    }
    flat_shape_box(shape, out->min.raw, out->max.raw);
    out->radius = (float)(fmax(vec3_norm(diagonals[0]), vec3_norm(diagonals[1])) * 1.000001);
}

static void bound_solid(const struct flat_shape *shape, struct light_bounds *out)
{
    double square = (double)shape->radius * (double)shape->radius;
    for (int axis = 0; axis < (shape->kind == SHAPE_BOX ? 3 : 1); axis++)
        for (int c = 0; c < 3; c++)
            square += (double)shape->axes[axis][c] * (double)shape->axes[axis][c];
    out->axis[2] = 1.0;
    flat_shape_box(shape, out->min.raw, out->max.raw);
    out->radius = (float)(sqrt(square) * 1.000001);
}

// Bounds the positions and emission directions of a shape: flat shapes emit to both sides, others
// in all directions.
static void bound_shape(const struct flat_shape *shape, struct light_bounds *out)
{
    bool is_flat = is_flat_shape(shape);
    if (shape->kind == SHAPE_SPHERE || shape->kind == SHAPE_DISC)
        bound_sphere_or_disc(shape, out);
    else
        (is_flat ? bound_quad : bound_solid)(shape, out);
    memcpy(out->center.raw, shape->center, sizeof out->center.raw);
    out->theta_o = is_flat ? 0.0 : M_PI;
    out->theta_e = 0.5 * M_PI;
    out->two_sided = is_flat;
}

// Returns the angle in radians, widened by 1e-3 for rounding, by which a spot light's cone is wider
// than its full-intensity part.
static double spot_fall(const struct light *light)
{
    return fmin((double)light->outer_angle - (double)light->inner_angle + 1e-3, 0.5 * M_PI);
}

static void bound_light(const struct light *light, struct light_bounds *out)
{
    bool is_spot = light->kind == LIGHT_SPOT;
    for (int c = 0; c < 3; c++) {
        out->center.raw[c] = (float)light->position[c];
        out->axis[c] = is_spot ? light->direction[c] : c == 2;
    }
    out->min = out->max = out->center;
    out->theta_o = is_spot ? (double)light->inner_angle : M_PI;
    out->theta_e = is_spot ? spot_fall(light) : 0.5 * M_PI;
    out->power = luminance(light->radiant);
}

// Returns the bounds of an emitter at a finite distance; `power` is as in the list.
static struct light_bounds bound_emitter(const struct scene *scene, const struct flat_scene *flat,
                                         const struct bvh *bvh, uint32_t primitive, double power)
{
    struct light_bounds bounds = {.power = power};
    if (primitive & PRIMITIVE_LIGHT) {
        const struct light light = flat_light(flat, &scene->lights[primitive & ~PRIMITIVE_LIGHT]);
        bound_light(&light, &bounds);
    } else if (primitive & PRIMITIVE_SHAPE) {
        const struct flat_shape *shape = &flat->shapes[primitive & ~PRIMITIVE_SHAPE];
        bound_shape(shape, &bounds);
        // The mean projected area of a convex body is a quarter of its surface area (Cauchy 1841).
        bounds.power *= is_flat_shape(shape) ? 1.0 : 0.25;
    } else {
        bound_triangle(flat, bvh->triangle_order[primitive], &bounds);
    }
    return bounds;
}

static bool is_infinite(const struct scene *scene, uint32_t primitive)
{
    return primitive == PRIMITIVE_ENVIRONMENT ||
           ((primitive & PRIMITIVE_LIGHT) &&
            scene->lights[primitive & ~PRIMITIVE_LIGHT].kind == LIGHT_DIRECTIONAL);
}

// The emitters, divided into those in the tree and the infinitely far ones.
struct tree_parts {
    struct light_bounds *bounds; // bounds of the emitters in the tree
    uint32_t *primitives, *numbers, *lamps;
    uint32_t count;
    uint32_t *infinite, *infinite_lamps;
    double *infinite_powers;
    uint32_t infinite_count;
    uint32_t surface_count; // number of triangles and shapes among all emitters
    uint32_t lamp_count;    // number of lamps whose records the buffer has
};

static bool part_emitters(const struct shading_tables_params *p, const struct emitter_list *list,
                          struct arena *scratch, struct tree_parts *out, struct err *err)
{
    const struct scene *scene = p->scene;
    uint32_t infinite = scene->light_count + 1;
    *out = (struct tree_parts){
        .bounds = ARENA_NEW(scratch, struct light_bounds, list->count),
        .primitives = ARENA_NEW(scratch, uint32_t, list->count),
        .numbers = ARENA_NEW(scratch, uint32_t, list->count),
        .lamps = ARENA_NEW(scratch, uint32_t, list->count),
        .infinite = ARENA_NEW(scratch, uint32_t, infinite),
        .infinite_lamps = ARENA_NEW(scratch, uint32_t, infinite),
        .infinite_powers = ARENA_NEW(scratch, double, infinite),
        .surface_count = list->surface_count,
        .lamp_count = p->light_choice == LIGHT_CHOICE_ALL ? p->lamps->count : 0,
    };
    if (!out->bounds || !out->primitives || !out->numbers || !out->lamps || !out->infinite ||
        !out->infinite_lamps || !out->infinite_powers)
        return err_memory(err, "light tree", (uint64_t)list->count * sizeof *out->bounds);
    for (uint32_t i = 0; i < list->count; i++) {
        uint32_t primitive = list->primitives[i];
        if (progress_stops_at(p->progress, i))
            return stopped(err);
        if (!(list->powers[i] > 0.0))
            continue;
        if (is_infinite(scene, primitive)) {
            out->infinite[out->infinite_count] = primitive;
            out->infinite_lamps[out->infinite_count] = emitter_lamp_of(p->lamps, i);
            out->infinite_powers[out->infinite_count++] = list->powers[i];
        } else {
            out->bounds[out->count] =
                bound_emitter(scene, p->flat, p->bvh, primitive, list->powers[i]);
            out->primitives[out->count] = primitive;
            out->lamps[out->count] = emitter_lamp_of(p->lamps, i);
            out->numbers[out->count++] = i;
        }
    }
    return true;
}

// The probability of selecting an infinitely far emitter, if the scene also has emitters at finite
// distances. It is 1/2, because it is not known which of the two groups matters more.
#define INFINITE_SHARE 0.5

// Writes the buffer: header, pairs of nodes, trails, bins, lamps. If no emitter has power, the tree
// is one pair of dark nodes.
static bool lay_out_tree(const struct tree_parts *parts, struct arena *arena, struct emitters *out,
                         struct err *err)
{
    bool is_dark = parts->count + parts->infinite_count == 0;
    uint64_t pairs = is_dark ? 1 : parts->count > 0 ? parts->count - 1 : 0;
    struct gpu_light_tree header = {
        .root = is_dark ? 0 : LIGHT_LEAF,
        .trails = (uint32_t)(LIGHT_TREE_WORDS + pairs * LIGHT_PAIR_WORDS),
        .infinite_count = parts->infinite_count,
        .infinite_share = parts->infinite_count == 0 ? 0.0f
                          : parts->count == 0        ? 1.0f
                                                     : (float)INFINITE_SHARE,
    };
    header.infinite = header.trails + parts->surface_count;
    header.lamps = header.infinite + parts->infinite_count;
    out->bytes = ((uint64_t)header.lamps + parts->lamp_count) * 16;
    out->data = arena_alloc(arena, out->bytes / 16, 16);
    if (!out->data)
        return err_memory(err, "emitters", out->bytes);
    memcpy(out->data, &header, sizeof header);
    return true;
}

static bool fill_infinite(const struct tree_parts *parts, struct arena *scratch,
                          struct emitters *out, struct err *err)
{
    const struct gpu_light_tree *header = out->data;
    struct gpu_lamp *lamps = (struct gpu_lamp *)out->data + header->lamps;
    struct gpu_emitter *bins = (struct gpu_emitter *)out->data + header->infinite;
    for (uint32_t i = 0; i < parts->infinite_count && parts->lamp_count > 0; i++)
        lamps[parts->infinite_lamps[i]] =
            (struct gpu_lamp){.child = LIGHT_LEAF | parts->infinite[i]};
    return parts->infinite_count == 0 ||
           fill_bins(parts->infinite, parts->infinite_powers, parts->infinite_count,
                     (double)header->infinite_share, scratch, bins, out, err);
}

static bool fill_tree(const struct shading_tables_params *p, const struct tree_parts *parts,
                      struct arena *scratch, struct emitters *out, struct err *err)
{
    struct gpu_light_tree *header = out->data;
    struct gpu_light_trail *trails = (struct gpu_light_trail *)out->data + header->trails;
    struct gpu_lamp *lamps = (struct gpu_lamp *)out->data + header->lamps;
    for (uint32_t i = 0; i < parts->surface_count; i++)
        trails[i].depth = LIGHT_NOWHERE;
    for (uint32_t i = 0; i < parts->lamp_count; i++)
        lamps[i] = (struct gpu_lamp){.child = LIGHT_LEAF, .depth = LIGHT_NOWHERE};
    if (parts->count > 0) {
        struct light_tree tree;
        const struct light_tree_params params = {.bounds = parts->bounds,
                                                 .primitives = parts->primitives,
                                                 .lamps = parts->lamps,
                                                 .count = parts->count,
                                                 .lamp_count = p->lamps->count,
                                                 .progress = p->progress};
        if (!light_tree_build(&params, scratch, &tree, err))
            return false;
        header->root = tree.root;
        memcpy((char *)out->data + sizeof *header, tree.nodes,
               ((size_t)parts->count - 1) * 2 * sizeof *tree.nodes);
        memcpy(lamps, tree.lamps, parts->lamp_count * sizeof *lamps);
        for (uint32_t i = 0; i < parts->count; i++)
            if (parts->numbers[i] < parts->surface_count)
                trails[parts->numbers[i]] = tree.trails[i];
    }
    return fill_infinite(parts, scratch, out, err);
}

static bool build_tree(const struct shading_tables_params *p, const struct emitter_list *list,
                       struct arena *arena, struct emitters *out, struct err *err)
{
    struct arena scratch = {0};
    struct tree_parts parts;
    uint64_t start = clock_ns();
    bool ok =
        part_emitters(p, list, &scratch, &parts, err) && lay_out_tree(&parts, arena, out, err);
    out->count = ok ? parts.count + parts.infinite_count : 0;
    ok = ok && fill_tree(p, &parts, &scratch, out, err);
    arena_finish(&scratch);
    out->build_seconds = clock_seconds_since(start);
    return ok;
}

// The length of shadow rays to infinitely far emitters in scenes with infinite planes. It must be
// large, because the shadow of an object under a low sun extends far over a plane. It is the
// largest extent of a scene, see geometry_prepare(), so that products in kernels remain finite.
#define PLANES_REACH 4e9

static void note_unconnected(const struct scene *scene, const struct flat_scene *flat)
{
    uint32_t planes = 0, fields = 0;
    for (uint32_t i = 0; i < flat->shape_count; i++) {
        const struct flat_shape *shape = &flat->shapes[i];
        if (shape_is_emitter(shape->kind) ||
            !(mean_radiance(scene, &scene->materials[shape->material]) > 0.0))
            continue;
        planes += shape->kind == SHAPE_PLANE;
        fields += shape->kind == SHAPE_SDF;
    }
    if (planes + fields > 0)
        log_info(
            "%u infinite planes and %u distance fields emit, but shadow rays cannot be aimed at "
            "them: only scattered rays find their light",
            planes, fields);
}

bool emitters_build(const struct shading_tables_params *p, struct arena *arena,
                    struct emitters *out, struct err *err)
{
    const struct scene *scene = p->scene;
    const struct flat_scene *flat = p->flat;
    struct emitter_list list;
    // The reach is twice the diagonal of the bounds, which exceeds any distance between two points
    // within them.
    *out = (struct emitters){.reach = (float)(4.0 * bounding_radius(flat))};
    if (has_planes(flat))
        out->reach = fmaxf(out->reach, (float)PLANES_REACH);
    note_unconnected(scene, flat);
    out->environment_floor = (float)environment_floor(scene);
    double floor = (double)out->environment_floor;
    if (!fill_lights(scene, flat, arena, out, err) || !list_emitters(p, floor, arena, &list, err))
        return false;
    out->primitives = list.primitives;
    out->surface_count = list.surface_count;
    if (list.count == 0)
        return true;
    switch (p->light_choice) {
    case LIGHT_CHOICE_UNIFORM:
        return build_list(&list, arena, out, err);
    case LIGHT_CHOICE_ALL:
    case LIGHT_CHOICE_TREE:
        return build_tree(p, &list, arena, out, err);
    default:
        return build_power(&list, arena, out, err);
    }
}

float emitters_pick_density(const struct emitters *emitters, const struct scene *scene,
                            const struct material *material)
{
    double radiance = mean_radiance(scene, material);
    if (emitters->total_power > 0.0)
        return (float)(radiance / emitters->total_power);
    return emitters->count > 0 && radiance > 0.0 ? 1.0f : 0.0f;
}
