// Stiff and extreme cases without a known value (docs/verification.md, C). They test reports,
// bounds and termination.
#include "check/case_list.h"
#include "check/closed_form.h"
#include "check/embedded_scene.h"
#include "check/made_mesh.h"
#include "check/refused.h"
#include <inttypes.h>
#include <math.h>
#include <stdio.h>

// A scene to render, and a test of the result.
struct stiff {
    const char *scene;
    struct scene_override overrides[6]; // ends with the first entry without a key
    bool (*prepare)(struct scene *scene, struct err *err); // changes the scene; may be NULL
    uint64_t samples;
    uint32_t wave;
    bool (*judge)(const struct renderer *r, const struct film_image *film,
                  struct check_result *result);
};

static bool render(const struct check *check, const struct stiff *stiff, const struct scene *scene,
                   struct check_result *result, struct err *err)
{
    const struct renderer_params params = {
        .gpu = check->gpu, .scene = scene, .wave = stiff->wave, .progress = check->progress};
    const struct render_call call = {.samples = stiff->samples};
    struct arena arena = {0};
    struct film_image film;
    struct renderer renderer;
    if (!renderer_create(&params, &renderer, err))
        return false;
    bool ok =
        renderer_render(&renderer, &call, err) && renderer_read(&renderer, &arena, &film, err) &&
        stiff->judge(&renderer, &film, result) && check_keep_picture(check, &renderer, result, err);
    arena_finish(&arena);
    renderer_finish(&renderer);
    return ok;
}

static bool run_stiff(const struct check *check, const struct check_case *this_case,
                      struct check_result *result, struct err *err)
{
    const struct stiff *stiff = this_case->data;
    struct scene scene;
    if (!embedded_scene_load(stiff->scene, stiff->overrides, &scene, err))
        return false;
    bool ok = (!stiff->prepare || stiff->prepare(&scene, err)) &&
              render(check, stiff, &scene, result, err);
    scene_finish(&scene);
    return ok;
}

// --- tests of results ----------------------------------------------------------------------------

static double mean_of(const struct film_image *film, int c)
{
    double sum = 0.0;
    size_t pixels = (size_t)film->width * film->height;
    for (size_t i = 0; i < pixels; i++)
        sum += (double)film->mean[i][c];
    return sum / (double)pixels;
}

// Under a constant environment of (1, 2, 4), a surface must reflect some light but at most the
// light that it receives. A tolerance of 1e-3 is allowed, as for albedos (docs/verification.md,
// A9).
static bool judge_albedo(const struct renderer *r, const struct film_image *film,
                         struct check_result *result)
{
    double most = 0.0, least = INFINITY;
    (void)r;
    for (int c = 0; c < 3; c++) {
        double albedo = mean_of(film, c) / closed_form_emission[c];
        most = fmax(most, albedo);
        least = fmin(least, albedo);
    }
    return check_seen(result, film->dropped == 0 && least > 0.25 && most <= 1.001,
                      "%.5f to %.5f, %" PRIu64 " samples that are not finite", least, most,
                      film->dropped);
}

static bool judge_media(const struct renderer *r, const struct film_image *film,
                        struct check_result *result)
{
    return check_seen(result, r->stats.media_lost > 0 && film->dropped == 0,
                      "%" PRIu64 " times that a path left a medium that it had not entered",
                      r->stats.media_lost);
}

// An object covers 30 % of the pixel. A plain sum in single precision would stop growing at 2^24
// samples.
static bool judge_edge(const struct renderer *r, const struct film_image *film,
                       struct check_result *result)
{
    double error = fabs(mean_of(film, 0) / 0.3 - 1.0);
    (void)r;
    snprintf(result->expected, sizeof result->expected, "%g", 0.3);
    return check_seen(result, error <= 1e-6 && film->least_samples == UINT64_C(1) << 24,
                      "%.9f, off by %.1e", mean_of(film, 0), error);
}

static bool judge_floor(const struct film_image *film)
{
    double worst = 0.0;
    for (int c = 0; c < 3; c++)
        worst =
            fmax(worst,
                 fabs(mean_of(film, c) / (closed_form_albedo[c] * closed_form_emission[c]) - 1.0));
    return worst <= 1e-5;
}

// The floor must look as if the omitted objects did not exist.
static bool judge_dropped(const struct renderer *r, const struct film_image *film,
                          struct check_result *result)
{
    uint32_t count = r->flat.dropped_degenerate;
    return check_seen(result, count == 3 && judge_floor(film), "%u omitted, the floor shows %.6g",
                      count, mean_of(film, 0));
}

static bool judge_skipped(const struct renderer *r, const struct film_image *film,
                          struct check_result *result)
{
    uint32_t count = r->flat.skipped_instances;
    return check_seen(result, count == 2 && judge_floor(film), "%u omitted, the floor shows %.6g",
                      count, mean_of(film, 0));
}

// The longest permitted dispatch of a GPU (docs/verification.md, C42). Watchdogs end dispatches
// that take seconds.
#define LONGEST_MS 100.0

static bool judge_dispatches(const struct renderer *r, const struct film_image *film,
                             struct check_result *result)
{
    double longest = 0.0;
    for (int k = 0; k < KERNEL_COUNT; k++)
        longest = fmax(longest, r->stats.kernels[k].longest_ms);
    bool short_enough = r->gpu->info.is_cpu || longest <= LONGEST_MS;
    return check_seen(result, short_enough && film->dropped == 0,
                      "a wave of %u paths, dispatches of at most %.0f ms", r->plan.wave_slots,
                      longest);
}

// --- zero areas --------------------------------------------------------------------------------

// Adds black triangles above the floor: a point, a line with three different vertices and one with
// two.
static bool add_degenerate(struct scene *scene, struct err *err)
{
    struct mesh *mesh = made_mesh_add(scene, 3, err);
    if (!mesh)
        return false;
    for (uint32_t i = 0; i < 9; i++)
        made_mesh_set(mesh, i, i < 3 ? 0.0 : (double)(i % 3) - 1.0, 1e-4, 0);
    made_mesh_set(mesh, 8, -1, 1e-4, 0);
    return made_mesh_blacken(scene, mesh, 0, err);
}

// Adds instances of a black cube above the floor, flattened to a square and to a point.
static bool add_singular(struct scene *scene, struct err *err)
{
    struct mesh *mesh = made_mesh_add_cube(scene, 1, err);
    struct instance *point = scene_add_instance(scene, NULL);
    if (!mesh || !point)
        return err_memory(err, "an instance", sizeof *point);
    struct instance *square = &scene->instances[scene->instance_count - 2];
    *point = (struct instance){.mesh = square->mesh, .material = SCENE_NONE};
    square->transform[1][1] = 0.0;
    square->transform[1][3] = point->transform[1][3] = 1e-4;
    return made_mesh_blacken(scene, mesh, 0, err);
}

// --- normals -----------------------------------------------------------------------------------

// Adds a square of two triangles. The normals of its corners are tilted by 70 degrees, each in
// another direction.
static bool add_leaning(struct scene *scene, struct err *err)
{
    static const float corners[6][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, -1}, {1, 1}, {-1, 1}};
    struct mesh *mesh = made_mesh_add(scene, 2, err);
    if (!mesh)
        return false;
    mesh->normals = arena_alloc(&scene->arena, mesh->vertex_count, sizeof *mesh->normals);
    if (!mesh->normals)
        return err_memory(err, "normals", mesh->vertex_count);
    const float sine = sinf(1.22173f) * sqrtf(0.5f),
                cosine = cosf(1.22173f); // sine and cosine of 70 degrees
    for (uint32_t i = 0; i < mesh->vertex_count; i++) {
        for (int k = 0; k < 2; k++) {
            mesh->positions[i][k] = corners[i][k];
            mesh->normals[i][k] = sine * corners[i][k];
        }
        mesh->normals[i][2] = cosine;
    }
    return true;
}

// Adds a square with vertex normals in its plane, so that the normals of opposite corners cancel in
// the centre.
static bool add_cancelling(struct scene *scene, struct err *err)
{
    if (!add_leaning(scene, err))
        return false;
    struct mesh *mesh = &scene->meshes[scene->mesh_count - 1];
    for (uint32_t i = 0; i < mesh->vertex_count; i++) {
        mesh->normals[i][0] = mesh->positions[i][0] * sqrtf(0.5f);
        mesh->normals[i][1] = mesh->positions[i][1] * sqrtf(0.5f);
        mesh->normals[i][2] = 0.0f;
    }
    return true;
}

// --- the cases ---------------------------------------------------------------------------------

#define STIFF(...)                                                                                 \
    .run = run_stiff, .data = &(const struct stiff)                                                \
    {                                                                                              \
        __VA_ARGS__                                                                                \
    }

// clang-format off
#define COATED(roughness) {"plate", "{\"type\": \"principled\", \"base_color\": [1, 1, 1], "       \
    "\"clearcoat\": 1, \"clearcoat_roughness\": " roughness ", \"roughness\": 0.5}"}
#define WHITE {"plate", JSON({"base_color": [1, 1, 1]})}
// The square fills the image.
#define SQUARE {"shapes", "[]"}, {"camera", JSON({"position": [0, 0, 4], "target": [0, 0, 0],       \
    "fov_degrees": 25})}

// An image 5e-5 m wide of a floor under a constant environment.
#define FLOOR {"camera", JSON({"type": "orthographic", "position": [0, 0.0005, 0],                 \
    "target": [0, 0, 0], "up": [0, 0, 1], "height": 5e-5})},                                       \
    {"environment", JSON({"radiance": [1, 2, 4]})}
#define REFUSED(title, is, ...)                                                                    \
    {.name = title, .expected = "an error: " is, .run = refused_run,                               \
     .data = &(const struct refusal){__VA_ARGS__}}
#define VERTEX(title, value)                                                                       \
    REFUSED("C10 " title, "vertex 4", "plane.json", {{0}}, refused_vertex, value, "vertex 4 ")

static const struct check_case cases[] = {
    {"C6 triangles without area", "three are counted; the floor beneath shows rho Le",
     STIFF("plane.json", {FLOOR}, add_degenerate, 1, 0, judge_dropped)},
    VERTEX("a vertex that is NaN", NAN),
    VERTEX("an infinite vertex", INFINITY),
    VERTEX("a vertex at 1e38", 1e38),
    {"C18 reflectance 1 under a smooth coat", "finite, and at most all of the light",
     STIFF("plate.json", {COATED("0")}, NULL, 256, 0, judge_albedo)},
    {"C18 reflectance 1 under a rough coat", "finite, and at most all of the light",
     STIFF("plate.json", {COATED("0.3")}, NULL, 256, 0, judge_albedo)},
    {"C24 an open mesh bounds a medium", "it is counted",
     STIFF("media.json", {{"bodies", JSON([{"type": "disc", "material": "glass", "radius": 9,
           "normal": [0, 0, -1]}])}}, NULL, 16, 0, judge_media)},
    {"C25 normals that lean by 70 degrees", "finite, and at most all of the light",
     STIFF("plate.json", {WHITE, SQUARE}, add_leaning, 64, 0, judge_albedo)},
    {"C26 corners' normals that cancel", "finite, and at most all of the light",
     STIFF("plate.json", {WHITE, SQUARE}, add_cancelling, 64, 0, judge_albedo)},
    {"C30 singular and zero scales", "two are counted; the floor beneath shows rho Le",
     STIFF("plane.json", {FLOOR}, add_singular, 1, 0, judge_skipped)},
    REFUSED("C31 texture of 65536 x 1", "65536 x 1 pixels; expected at most 65535 on a side",
     "plane.json", {{0}}, refused_image, 65536, "65536 x 1 pixels; expected at most 65535"),
    {"C36 2^24 samples of one pixel", "within 1e-6", .is_long = true,
     STIFF("edge.json", {{"film", JSON({"width": 1, "height": 1})}}, NULL, UINT64_C(1) << 24, 0,
           judge_edge)},
    REFUSED("C41 field of view of 0", "camera.fov_degrees", "sky.json",
     {{"camera.fov_degrees", "0"}}, NULL, 0, "camera.fov_degrees"),
    REFUSED("C41 field of view of 180 degrees", "camera.fov_degrees", "sky.json",
     {{"camera.fov_degrees", "180"}}, NULL, 0, "camera.fov_degrees"),
    {"C42 a wave of 2^24 paths", "it fits or is lowered; dispatches of a GPU take 100 ms at most",
     .is_long = true, STIFF("cornell.json", {{0}}, NULL, 64, 1u << 24, judge_dispatches)},
    REFUSED("C43 a colour at distance 0", "absorption.distance", "media.json",
     {{"bodies", "[]"}, {"body", JSON({"type": "dielectric", "absorption": {"color": [0.5, 0.5, 0.5],
       "distance": 0}})}}, NULL, 0, "absorption.distance"),
};
// clang-format on

CHECK_GROUP(check_bounded, "bounded", "extreme cases: reports, bounds and termination", cases);
