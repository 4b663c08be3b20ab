// Takes a census before flattening: the number of triangles, the bounds of the world, the
// attributes, and which meshes are stored once for all their instances.
#include "flatten/flatten_census.h"

#include "base/log.h"
#include "base/memory.h"
#include "scene/core/affine.h"
#include <float.h>
#include <math.h>

// --- meshes --------------------------------------------------------------------------------------

// Single-precision coordinates in a file that are far from the file's origin have already lost
// digits. Above this ratio of distance from the origin to size, a mesh has fewer than 2^24 / 2^18 =
// 64 distinct coordinates across (docs/verification.md, C2).
#define COARSE_RATIO 262144

// Computes the largest extent along an axis, and the largest absolute coordinate.
static void bounds_size(const struct bounds *bounds, double *extent, double *farthest)
{
    *extent = *farthest = 0;
    for (int i = 0; i < 3; i++) {
        *extent = fmax(*extent, bounds->max[i] - bounds->min[i]);
        *farthest = fmax(*farthest, fmax(-bounds->min[i], bounds->max[i]));
    }
}

bool flatten_is_coarse(const struct bounds *bounds, double *extent, double *farthest)
{
    if (bounds_is_empty(bounds))
        return false;
    bounds_size(bounds, extent, farthest);
    return *farthest > COARSE_RATIO * *extent;
}

static void warn_if_coarse(const struct mesh *mesh, const struct bounds *bounds)
{
    double extent, farthest;
    if (!mesh->exact_positions && flatten_is_coarse(bounds, &extent, &farthest))
        log_warn(
            "mesh \"%s\" has size %g at distance %g from its origin: single precision resolves it "
            "in steps of %.2g",
            mesh->name, extent, farthest, farthest * (double)FLT_EPSILON);
}

// Coordinates of up to 16 times the scene's size cost four of the 24 bits; above that ratio the
// arrays get an origin of their own.
#define REBASE_RATIO 16

void flatten_choose_origin(const struct bounds *bounds, double origin[3])
{
    double extent, farthest;
    for (int i = 0; i < 3; i++)
        origin[i] = 0;
    if (bounds_is_empty(bounds))
        return;
    bounds_size(bounds, &extent, &farthest);
    if (farthest > REBASE_RATIO * extent)
        for (int i = 0; i < 3; i++)
            origin[i] = bounds->min[i] + (bounds->max[i] - bounds->min[i]) / 2;
}

// Extents from 2^-10 to 2^20 m are not scaled. A scene of 2^20 m in single precision may have
// details of 2^-30 m; the squares of their areas, 2^-120, are the first quantities to underflow. A
// scene of 2^-10 m may have details of that size, too. Larger scenes are scaled down to the upper
// end of the range, smaller ones up to 1 m, so that their details are far from underflow.
#define SCALED_EXTENT_MIN_EXPONENT (-10)
#define SCALED_EXTENT_MAX_EXPONENT 20

double flatten_choose_scale(const struct bounds *bounds)
{
    double extent, farthest;
    if (bounds_is_empty(bounds))
        return 1;
    bounds_size(bounds, &extent, &farthest);
    if (!(extent > 0))
        return 1;
    int exponent = ilogb(extent);
    if (exponent >= SCALED_EXTENT_MAX_EXPONENT)
        return ldexp(1, SCALED_EXTENT_MAX_EXPONENT - 1 - exponent);
    return exponent < SCALED_EXTENT_MIN_EXPONENT ? ldexp(1, -exponent) : 1;
}

bool flatten_check_extent(const struct scene *scene, const struct bounds *bounds, struct err *err)
{
    double extent, farthest;
    if (bounds_is_empty(bounds))
        return true;
    bounds_size(bounds, &extent, &farthest);
    if (extent == 0 || (extent >= SCENE_EXTENT_MIN && extent <= SCENE_EXTENT_MAX))
        return true;
    return err_set(err, ERR_INPUT,
                   "%s: the scene is %g m across; expected %g m to %g m; its lengths may be in "
                   "another unit than metres",
                   scene->path ? scene->path : "scene", extent, SCENE_EXTENT_MIN, SCENE_EXTENT_MAX);
}

bool flatten_in_range(const double point[3])
{
    for (int i = 0; i < 3; i++)
        if (!(fabs(point[i]) <= SCENE_COORDINATE_MAX))
            return false;
    return true;
}

// Each triangle of an emitter is an emitter of its own, in world space, so its mesh cannot be
// shared.
bool flatten_emits(const struct scene *scene, uint32_t material)
{
    const struct material *m = &scene->materials[material];
    return material_emits(m) && !(m->flags & MATERIAL_UNLIT);
}

bool flatten_is_lamp(const struct scene *scene, uint32_t kind, uint32_t material)
{
    return kind != SHAPE_PLANE && kind != SHAPE_SDF && flatten_emits(scene, material);
}

// Finds out whether a mesh's materials permit sharing it, and the set of texture coordinates for
// its tangents.
static void survey_materials(const struct scene *scene, const struct mesh *mesh,
                             struct mesh_use *use)
{
    const struct instance own = {.material = SCENE_NONE};
    uint32_t known = SCENE_NONE; // consecutive triangles often share a material
    for (uint32_t t = 0; t < mesh->triangle_count && use->may_be_shared; t++) {
        uint32_t index = instance_material(mesh, &own, t);
        if (index == known)
            continue;
        uint32_t set = attributes_tangent_set(scene, index);
        use->tangent_set = known == SCENE_NONE || use->tangent_set == set ? set : SCENE_NONE;
        known = index;
        use->may_be_shared = !flatten_emits(scene, index);
    }
}

bool flatten_goes_on(const struct flatten_params *params, double fraction, struct err *err)
{
    progress_report(params->progress, "Flattening", fraction);
    return !progress_should_stop(params->progress) ||
           err_set(err, ERR_STOPPED, "stopped while flattening the scene");
}

static bool survey_mesh(const struct flatten_params *params, const struct mesh *mesh,
                        struct mesh_use *use, struct err *err)
{
    *use = (struct mesh_use){.bounds = BOUNDS_EMPTY, .is_in_range = true};
    for (uint32_t t = 0; t < mesh->triangle_count; t++) {
        if (t % FLATTEN_POLL == 0 && !flatten_goes_on(params, 0, err))
            return false;
        for (int corner = 0; corner < 3; corner++) {
            double point[3];
            mesh_vertex(mesh, mesh->indices[t][corner], point);
            bounds_add_point(&use->bounds, point);
            use->is_in_range = use->is_in_range && flatten_in_range(point);
        }
    }
    use->may_be_shared = mesh->triangle_count > 0 && use->is_in_range;
    survey_materials(params->scene, mesh, use);
    warn_if_coarse(mesh, &use->bounds);
    return true;
}

// --- instances -----------------------------------------------------------------------------------

// Rays are transformed into a shared mesh's space by the inverse of its transform, in single
// precision. A transform that squashes or shears by more than about 1 : 4096 would cost 12 of the
// 24 bits.
#define SHARED_CONDITION_MAX (3.0 * 4096.0)
#define SHARED_SCALE_MIN 1e-15
#define SHARED_SCALE_MAX 1e15

static bool transform_is_gentle(const double m[3][4])
{
    double inverse[3][4], square = 0, inverse_square = 0;
    if (!affine_inverse(m, inverse))
        return false;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            square += m[i][j] * m[i][j];
            inverse_square += inverse[i][j] * inverse[i][j];
        }
    double scale = sqrt(square);
    return scale >= SHARED_SCALE_MIN && scale <= SHARED_SCALE_MAX &&
           scale * sqrt(inverse_square) <= SHARED_CONDITION_MAX;
}

static bool can_share(const struct scene *scene, const struct instance *instance,
                      const struct mesh_use *use)
{
    if (!use->may_be_shared || !transform_is_gentle(instance->transform))
        return false;
    if (instance->material == SCENE_NONE)
        return true;
    // Tangents that are computed from texture coordinates are stored once for all instances.
    bool tangents_agree = scene->meshes[instance->mesh].tangents ||
                          attributes_tangent_set(scene, instance->material) == use->tangent_set;
    return tangents_agree && !flatten_emits(scene, instance->material);
}

static bool check_transform(const struct scene *scene, uint32_t index, struct err *err)
{
    const struct instance *instance = &scene->instances[index];
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 4; j++)
            if (!isfinite(instance->transform[i][j]))
                return err_set(err, ERR_INPUT,
                               "%s: instance %u of mesh \"%s\": row %d, column %d of its transform "
                               "is %g; expected a finite number",
                               scene->path ? scene->path : "scene", index,
                               scene->meshes[instance->mesh].name, i, j, instance->transform[i][j]);
    return true;
}

static bool classify_instances(const struct flatten_params *params, struct census *census,
                               struct err *err)
{
    const struct scene *scene = params->scene;
    for (uint32_t i = 0; i < scene->instance_count; i++) {
        const struct instance *instance = &scene->instances[i];
        struct mesh_use *use = &census->meshes[instance->mesh];
        if (i % FLATTEN_POLL == 0 && !flatten_goes_on(params, 0, err))
            return false;
        if (instance->hidden) {
            census->instances[i] = INSTANCE_HIDDEN;
            continue;
        }
        if (!check_transform(scene, i, err))
            return false;
        double determinant = affine_determinant(instance->transform);
        if (determinant == 0 || isnan(determinant)) {
            census->instances[i] = INSTANCE_SKIPPED;
            use->first_skipped = use->skipped++ ? use->first_skipped : i;
            census->skipped_instances++;
            continue;
        }
        bool shares = can_share(scene, instance, use);
        census->instances[i] = shares ? INSTANCE_SHARES : INSTANCE_FLATTENED;
        use->sharing += shares;
    }
    return true;
}

static void warn_of_skipped(const struct scene *scene, const struct census *census)
{
    for (uint32_t i = 0; i < scene->mesh_count; i++) {
        const struct mesh_use *use = &census->meshes[i];
        if (use->skipped == 1)
            log_warn("instance %u of mesh \"%s\" is skipped: its transform is singular",
                     use->first_skipped, scene->meshes[i].name);
        else if (use->skipped > 1)
            log_warn("%u instances of mesh \"%s\" are skipped, instance %u first: their transforms "
                     "are singular",
                     use->skipped, scene->meshes[i].name, use->first_skipped);
    }
}

// --- sharing -------------------------------------------------------------------------------------

// The least number of triangles of a shared mesh. A smaller mesh takes less memory than the records
// of its instances.
#define SHARED_TRIANGLES_MIN 12
// The least number of triangles that sharing must save. Tracing two levels takes 1.3 times as long
// as tracing one (docs/performance.md), while this many triangles more in one level take some 80
// MiB on the device, and seconds to upload.
#define SAVED_TRIANGLES_MIN (1u << 20)

static bool would_save(const struct mesh *mesh, const struct mesh_use *use)
{
    return use->sharing > 1 && mesh->triangle_count >= SHARED_TRIANGLES_MIN;
}

static void choose_shared(const struct scene *scene, enum instancing instancing,
                          struct census *census)
{
    uint64_t saved = 0;
    for (uint32_t i = 0; i < scene->mesh_count; i++)
        if (would_save(&scene->meshes[i], &census->meshes[i]))
            saved += (census->meshes[i].sharing - 1) * (uint64_t)scene->meshes[i].triangle_count;
    bool pays = instancing == INSTANCING_AUTO && saved >= SAVED_TRIANGLES_MIN;
    for (uint32_t i = 0; i < scene->mesh_count; i++) {
        struct mesh_use *use = &census->meshes[i];
        use->is_shared = instancing == INSTANCING_ON ? use->sharing > 0
                                                     : pays && would_save(&scene->meshes[i], use);
        use->flat = use->is_shared ? census->shared_count++ : SCENE_NONE;
        if (use->is_shared)
            census->shared_triangle_count += scene->meshes[i].triangle_count;
    }
    for (uint32_t i = 0; i < scene->instance_count; i++) {
        uint32_t mesh = scene->instances[i].mesh;
        if (census->instances[i] == INSTANCE_SHARES && census->meshes[mesh].is_shared)
            census->placed_count++;
        else if (census->instances[i] == INSTANCE_SHARES)
            census->instances[i] = INSTANCE_FLATTENED;
        if (census->instances[i] == INSTANCE_FLATTENED)
            census->world_triangle_count += scene->meshes[mesh].triangle_count;
    }
}

bool flatten_check_memory(const struct scene *scene, const struct census *census, struct err *err)
{
    const struct flat_scene *flat = NULL;
    uint64_t triangles = census->world_triangle_count + census->shared_triangle_count;
    uint64_t bytes =
        triangles * (sizeof *flat->triangles + attributes_bytes(&census->needs)) +
        scene->shape_count * sizeof *flat->shapes +
        (scene->instance_count + (uint64_t)census->shared_count) * sizeof *flat->instance_first +
        census->shared_count * sizeof *flat->meshes +
        census->placed_count * sizeof *flat->instances;
    return memory_check(bytes, "the flattened scene with its vertex attributes", err);
}

// --- the world -----------------------------------------------------------------------------------

static bool fail_vertex(const struct scene *scene, const struct instance *instance, uint32_t vertex,
                        const double point[3], struct err *err)
{
    const char *name = scene->meshes[instance->mesh].name;
    return err_set(err, ERR_INPUT,
                   "%s: instance %td: mesh %u%s%s%s: vertex %u lies at (%g, %g, %g) in the world; "
                   "expected coordinates within +-%g",
                   scene->path ? scene->path : "scene", instance - scene->instances, instance->mesh,
                   *name ? " \"" : "", name, *name ? "\"" : "", vertex, point[0], point[1],
                   point[2], SCENE_COORDINATE_MAX);
}

// Adds an instance to the bounds. Returns false with *err set when a vertex is out of range.
static bool measure_vertices(const struct flatten_params *params, const struct instance *instance,
                             struct bounds *bounds, struct err *err)
{
    const struct scene *scene = params->scene;
    const struct mesh *mesh = &scene->meshes[instance->mesh];
    for (uint32_t t = 0; t < mesh->triangle_count; t++) {
        if (t % FLATTEN_POLL == FLATTEN_POLL - 1 &&
            !flatten_goes_on(params, FLATTEN_CENSUS_PART / 2, err))
            return false;
        for (int corner = 0; corner < 3; corner++) {
            uint32_t vertex = mesh->indices[t][corner];
            double point[3];
            mesh_vertex(mesh, vertex, point);
            affine_point(instance->transform, point, point);
            if (!flatten_in_range(point))
                return fail_vertex(scene, instance, vertex, point, err);
            bounds_add_point(bounds, point);
        }
    }
    return true;
}

// Adds an instance of a shared mesh to the bounds. Uses the mesh's bounding box, because there may
// be very many instances, or its vertices if the transformed box leaves the permitted range.
static bool measure_box(const struct flatten_params *params, const struct instance *instance,
                        const struct bounds *box, struct bounds *bounds, struct err *err)
{
    double low[3], high[3];
    affine_box(instance->transform, box->min, box->max, low, high);
    if (!flatten_in_range(low) || !flatten_in_range(high))
        return measure_vertices(params, instance, bounds, err);
    bounds_add_point(bounds, low);
    bounds_add_point(bounds, high);
    return true;
}

static bool measure_world(const struct flatten_params *params, struct census *census,
                          struct err *err)
{
    const struct scene *scene = params->scene;
    for (uint32_t i = 0; i < scene->instance_count; i++) {
        const struct instance *instance = &scene->instances[i];
        struct mesh_use *use = &census->meshes[instance->mesh];
        if (census->instances[i] == INSTANCE_SKIPPED || census->instances[i] == INSTANCE_HIDDEN)
            continue;
        if (i % FLATTEN_POLL == 0 && !flatten_goes_on(params, FLATTEN_CENSUS_PART / 2, err))
            return false;
        // The needs of the mesh's own materials are the same for every instance, so they are added
        // once.
        if (instance->material != SCENE_NONE || use->own_material++ == 0)
            attributes_census(scene, instance, &census->needs);
        if (census->instances[i] == INSTANCE_SHARES) {
            if (!measure_box(params, instance, &use->bounds, &census->bounds, err))
                return false;
            continue;
        }
        if (!measure_vertices(params, instance, &census->bounds, err))
            return false;
    }
    for (uint32_t i = 0; i < scene->shape_count; i++)
        if (!scene->shapes[i].hidden)
            bounds_add_shape(&census->bounds, &scene->shapes[i]);
    return true;
}

bool flatten_take_census(const struct flatten_params *params, struct arena *scratch,
                         struct census *out, struct err *err)
{
    const struct scene *scene = params->scene;
    *out = (struct census){.bounds = BOUNDS_EMPTY};
    out->meshes = ARENA_NEW(scratch, struct mesh_use, scene->mesh_count);
    out->instances = ARENA_NEW(scratch, uint8_t, scene->instance_count);
    if (!out->meshes || !out->instances)
        return err_memory(err, "the census of meshes",
                          scene->mesh_count * sizeof *out->meshes + scene->instance_count);
    for (uint32_t i = 0; i < scene->mesh_count; i++)
        if (!survey_mesh(params, &scene->meshes[i], &out->meshes[i], err))
            return false;
    if (!classify_instances(params, out, err))
        return false;
    warn_of_skipped(scene, out);
    choose_shared(scene, params->instancing, out);
    // The memory is checked before all vertices are visited, and again when the attributes are
    // known.
    return flatten_check_memory(scene, out, err) && measure_world(params, out, err) &&
           flatten_check_memory(scene, out, err);
}
