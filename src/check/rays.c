// Traces rays at edges and vertices of closed meshes (docs/verification.md, C4 and C12). No ray may
// escape.
#include "base/maths.h"
#include "check/case_list.h"
#include "check/driver.h"
#include "check/embedded_scene.h"
#include "check/made_mesh.h"
#include "render/probe/ray_probe.h"
#include "scene/generate/generate.h"
#include <math.h>

struct closed_mesh {
    uint32_t triangles; // number of triangles of a bumpy ball; 0: a cube
    double center[3], radius;
    // A second object on the opposite side of the origin makes the scene so large that flattening
    // does not move the scene's origin.
    bool is_wide;
    enum instancing instancing;
    uint32_t rays, may_leave;
};

struct traced {
    struct probe_ray *rays;
    struct probe_hit *hits;
    uint32_t count;
};

static bool create_rays(uint32_t count, struct arena *arena, struct traced *out, struct err *err)
{
    *out = (struct traced){.rays = ARENA_NEW(arena, struct probe_ray, count),
                           .hits = ARENA_NEW(arena, struct probe_hit, count),
                           .count = count};
    return (out->rays && out->hits) ||
           err_memory(err, "rays", count * (sizeof *out->rays + sizeof *out->hits));
}

static bool trace(struct renderer *r, struct traced *traced, uint32_t *missed, struct err *err)
{
    bool complete = true;
    double ms;
    for (uint32_t first = 0, part; first < traced->count; first += part) {
        part = traced->count - first;
        part = part < r->plan.wave_slots ? part : r->plan.wave_slots;
        if (!ray_probe_trace(r, KERNEL_intersect_closest, traced->rays + first, part,
                             traced->hits + first, &ms, &complete, err))
            return false;
        if (!complete)
            return err_set(err, ERR_BUG, "a ray ran out of its budget of steps");
    }
    for (uint32_t i = 0; i < traced->count; i++)
        *missed += traced->hits[i].primitive == NO_PRIMITIVE;
    return true;
}

static double unit(uint64_t *state)
{
    return driver_random(state) * 0x1p-32;
}

// Computes the position of a triangle's corner in the space of the flat scene.
static void find_corner(const struct flat_scene *flat, uint32_t triangle, uint32_t corner,
                        double out[3])
{
    const float *v = flat->triangles[triangle].v[corner % 3];
    for (int i = 0; i < 3; i++) {
        out[i] = (double)v[i];
        if (flat->placed_count > 0) {
            const float *row = flat->instances[0].to_world[i];
            out[i] = (double)row[0] * (double)v[0] + (double)row[1] * (double)v[1] +
                     (double)row[2] * (double)v[2] + (double)row[3];
        }
    }
}

static void aim(struct probe_ray *ray, const double target[3])
{
    double way[3];
    for (int c = 0; c < 3; c++)
        way[c] = target[c] - (double)ray->origin[c];
    double length = vec3_length(way);
    for (int c = 0; c < 3; c++)
        ray->direction[c] = (float)(way[c] / length);
}

// Sets up rays from near the centre: every other one towards a vertex, the others towards points of
// edges.
static void aim_at_edges(const struct flat_scene *flat, const struct closed_mesh *mesh,
                         struct traced *traced)
{
    uint64_t state = 91;
    for (uint32_t i = 0; i < traced->count; i++) {
        uint32_t triangle = (uint32_t)((uint64_t)i * flat->triangle_count / traced->count);
        uint32_t edge = driver_random(&state) % 3;
        double along = i % 2 == 0 ? 0.0 : unit(&state), ends[2][3], target[3];
        find_corner(flat, triangle, edge, ends[0]);
        find_corner(flat, triangle, edge + 1, ends[1]);
        traced->rays[i] = (struct probe_ray){0};
        for (int c = 0; c < 3; c++) {
            double aside = 0.3 * mesh->radius * (unit(&state) - 0.5);
            target[c] = (1.0 - along) * ends[0][c] + along * ends[1][c];
            traced->rays[i].origin[c] = (float)(mesh->center[c] - flat->origin[c] + aside);
        }
        aim(&traced->rays[i], target);
    }
}

// Sets up rays from the exact centre of a cube to all vertices and to the midpoints of edges and
// diagonals, so that some components of the directions are 0. The ray's number selects the signs of
// these zeros.
static void aim_along_axes(const struct flat_scene *flat, struct traced *traced)
{
    for (uint32_t i = 0; i < traced->count; i++) {
        uint32_t triangle = i / 48 % flat->triangle_count;
        double ends[2][3], target[3];
        find_corner(flat, triangle, i / 16, ends[0]);
        find_corner(flat, triangle, i / 16 + (i / 8 & 1u), ends[1]);
        for (int c = 0; c < 3; c++)
            target[c] = 0.5 * (ends[0][c] + ends[1][c]);
        traced->rays[i] = (struct probe_ray){0};
        aim(&traced->rays[i], target);
        for (uint32_t c = 0; c < 3; c++)
            if (target[c] == 0.0)
                traced->rays[i].direction[c] = i >> c & 1u ? -0.0f : 0.0f;
    }
}

// Adds the second object after the ball, so that the ball is the first instance.
static bool add_anchor(struct scene *scene, const double at[3], struct err *err)
{
    struct mesh *mesh = made_mesh_add(scene, 1, err);
    double size = 1e-6 * vec3_length(at);
    for (uint32_t i = 0; mesh && i < 3; i++)
        made_mesh_set(mesh, i, at[0] + (i == 0 ? size : 0.0), at[1] + (i == 1 ? size : 0.0),
                      at[2] + (i == 2 ? size : 0.0));
    return mesh != NULL;
}

static bool add_ball(struct scene *scene, const struct closed_mesh *mesh, struct err *err)
{
    uint32_t index;
    if (!generate_blob(scene, mesh->triangles, 0, &index, err))
        return false;
    struct instance *instance = scene_add_instance(scene, NULL);
    if (!instance)
        return err_memory(err, "an instance", sizeof *instance);
    *instance = (struct instance){.mesh = index, .material = SCENE_NONE};
    for (int i = 0; i < 3; i++) {
        instance->transform[i][i] = mesh->radius;
        instance->transform[i][3] = mesh->center[i];
    }
    return true;
}

static bool add_mesh(struct scene *scene, const struct closed_mesh *mesh, struct err *err)
{
    const double *m = mesh->center, across[3] = {-m[0], -m[1], -m[2]};
    if (mesh->triangles == 0)
        return made_mesh_add_cube(scene, 1, err) != NULL;
    return add_ball(scene, mesh, err) && (!mesh->is_wide || add_anchor(scene, across, err));
}

static bool try_mesh(const struct closed_mesh *mesh, struct renderer *r, struct arena *arena,
                     struct check_result *result, struct err *err)
{
    struct traced traced;
    uint32_t missed = 0;
    if (!create_rays(mesh->rays, arena, &traced, err))
        return false;
    if (mesh->triangles > 0)
        aim_at_edges(&r->flat, mesh, &traced);
    else
        aim_along_axes(&r->flat, &traced);
    bool as_asked = (r->flat.placed_count > 0) == (mesh->instancing == INSTANCING_ON);
    return trace(r, &traced, &missed, err) &&
           check_seen(result, as_asked && missed <= mesh->may_leave, "%u of %u rays escape%s",
                      missed, mesh->rays,
                      as_asked ? "" : ", and the instancing is not as requested");
}

static bool run_rays(const struct check *check, const struct check_case *this_case,
                     struct check_result *result, struct err *err)
{
    const struct closed_mesh *mesh = this_case->data;
    const struct scene_override overrides[] = {{"shapes", "[]"}, {0}};
    struct arena arena = {0};
    struct scene scene;
    if (!embedded_scene_load("plane.json", overrides, &scene, err))
        return false;
    const struct renderer_params params = {.gpu = check->gpu,
                                           .scene = &scene,
                                           .wave = 65536,
                                           .instancing = mesh->instancing,
                                           .progress = check->progress};
    struct renderer renderer = {0};
    bool ok = add_mesh(&scene, mesh, err) && renderer_create(&params, &renderer, err) &&
              try_mesh(mesh, &renderer, &arena, result, err);
    renderer_finish(&renderer);
    scene_finish(&scene);
    arena_finish(&arena);
    return ok;
}

// clang-format off
#define RAYS(title, words, ...)                                                                    \
    {.name = title, .expected = words, .run = run_rays,                                            \
     .data = &(const struct closed_mesh){__VA_ARGS__}}
#define LONG_RAYS(title, words, ...)                                                               \
    {.name = title, .expected = words, .run = run_rays, .is_long = true,                           \
     .data = &(const struct closed_mesh){__VA_ARGS__}}
#define NONE "no ray escapes"
#define FEW "at most 2e-5 of the rays escape"
#define EMBREE {148376, 1234, -223423}

static const struct check_case cases[] = {
    RAYS("C4 100000 triangles", NONE, 100000, {0}, 1, false, INSTANCING_OFF, 1u << 17, 0),
    LONG_RAYS("C4 100000 triangles of an instance", NONE, 100000, {0}, 1, false, INSTANCING_ON,
     1u << 17, 0),
    RAYS("C4 at Embree's offset", FEW, 100000, EMBREE, 1, false, INSTANCING_OFF, 1u << 17, 2),
    LONG_RAYS("C4 an instance at Embree's offset", FEW, 100000, EMBREE, 1, false, INSTANCING_ON,
     1u << 17, 2),
    LONG_RAYS("C4 at Embree's offset in a wide scene", FEW, 100000, EMBREE, 1000, true,
     INSTANCING_OFF, 1u << 17, 2),
    RAYS("C4 an instance at Embree's offset in a wide scene", FEW, 100000, EMBREE, 1000, true,
     INSTANCING_ON, 1u << 17, 2),
    RAYS("C12 corners, edges and zeros of both signs", NONE, 0, {0}, 1, false, INSTANCING_OFF,
     576, 0),
    RAYS("C12 the same with an instance", NONE, 0, {0}, 1, false, INSTANCING_ON, 576, 0),
};
// clang-format on

CHECK_GROUP(check_rays, "rays", "rays at edges and corners of closed meshes", cases);
