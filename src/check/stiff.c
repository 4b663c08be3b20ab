// Stiff and extreme cases (docs/verification.md, C) without a value of their own: what is told,
// what is bounded, and what ends in time.
#include "check/case_list.h"
#include "check/closed_form.h"
#include "check/embedded_scene.h"
#include <inttypes.h>
#include <math.h>
#include <stdio.h>

// A render of a scene, and what is looked at when it is done.
struct stiff {
    const char *scene;
    struct scene_override overrides[6];                    // to the first without a key
    bool (*prepare)(struct scene *scene, struct err *err); // NULL: nothing
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

// --- what is looked at
// ----------------------------------------------------------------------------

static double mean_of(const struct film_image *film, int c)
{
    double sum = 0.0;
    size_t pixels = (size_t)film->width * film->height;
    for (size_t i = 0; i < pixels; i++)
        sum += (double)film->mean[i][c];
    return sum / (double)pixels;
}

// A surface under an even sky of (1, 2, 4) sends back no more than falls on it, and something; 1e-3
// are allowed as for albedos (docs/verification.md, A9).
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
                      "%" PRIu64 " times that a path left what it had not entered",
                      r->stats.media_lost);
}

// 30 % of the pixel are covered. A sum of single precision alone would stop growing at 2^24.
static bool judge_edge(const struct renderer *r, const struct film_image *film,
                       struct check_result *result)
{
    double error = fabs(mean_of(film, 0) / 0.3 - 1.0);
    (void)r;
    snprintf(result->expected, sizeof result->expected, "%g", 0.3);
    return check_seen(result, error <= 1e-6 && film->least_samples == UINT64_C(1) << 24,
                      "%.9f, off by %.1e", mean_of(film, 0), error);
}

// Watchdogs end dispatches of seconds; those of a GPU are to be as short as design.md says.
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

// --- normals
// ---------------------------------------------------------------------------------------

// A square of two triangles; its corners' normals lean by 70 degrees, each another way.
static bool add_leaning(struct scene *scene, struct err *err)
{
    static const float corners[4][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
    uint32_t index;
    struct mesh *mesh = scene_add_mesh(scene, &index);
    struct instance *instance = scene_add_instance(scene, NULL);
    if (!mesh || !instance)
        return err_memory(err, "a mesh", sizeof *mesh);
    *instance = (struct instance){
        .mesh = index, .material = SCENE_NONE, .transform = {{1}, {0, 1}, {0, 0, 1}}};
    *mesh = (struct mesh){.name = "", .vertex_count = 4, .triangle_count = 2};
    mesh->positions = arena_alloc(&scene->arena, 4, sizeof *mesh->positions);
    mesh->normals = arena_alloc(&scene->arena, 4, sizeof *mesh->normals);
    mesh->indices = arena_alloc(&scene->arena, 2, sizeof *mesh->indices);
    if (!mesh->positions || !mesh->normals || !mesh->indices)
        return err_memory(err, "a mesh", 4 * sizeof *mesh->positions);
    const float sine = sinf(1.22173f) * sqrtf(0.5f), cosine = cosf(1.22173f); // of 70 degrees
    for (uint32_t i = 0; i < 4; i++) {
        for (int k = 0; k < 2; k++) {
            mesh->positions[i][k] = corners[i][k];
            mesh->normals[i][k] = sine * corners[i][k];
        }
        mesh->normals[i][2] = cosine;
    }
    for (uint32_t i = 0; i < 3; i++) {
        mesh->indices[0][i] = i;
        mesh->indices[1][i] = i == 0 ? 0 : i + 1;
    }
    return true;
}

// The same with normals in the plane, so that those of opposite corners cancel in the middle.
static bool add_cancelling(struct scene *scene, struct err *err)
{
    if (!add_leaning(scene, err))
        return false;
    struct mesh *mesh = &scene->meshes[scene->mesh_count - 1];
    for (uint32_t i = 0; i < 4; i++) {
        mesh->normals[i][0] = mesh->positions[i][0] * sqrtf(0.5f);
        mesh->normals[i][1] = mesh->positions[i][1] * sqrtf(0.5f);
        mesh->normals[i][2] = 0.0f;
    }
    return true;
}

// --- the cases
// --------------------------------------------------------------------------------------

#define STIFF(...)                                                                                 \
    .run = run_stiff, .data = &(const struct stiff)                                                \
    {                                                                                              \
        __VA_ARGS__                                                                                \
    }

// clang-format off
#define COATED(roughness) {"plate", "{\"type\": \"principled\", \"base_color\": [1, 1, 1], "       \
    "\"clearcoat\": 1, \"clearcoat_roughness\": " roughness ", \"roughness\": 0.5}"}
#define WHITE {"plate", JSON({"base_color": [1, 1, 1]})}
// A picture that the square of a mesh fills.
#define SQUARE {"shapes", "[]"}, {"camera", JSON({"position": [0, 0, 4], "target": [0, 0, 0],       \
    "fov_degrees": 25})}

static const struct check_case cases[] = {
    {"C18 reflectance 1 under a smooth coat", "finite, and at most 1 of the light",
     STIFF("plate.json", {COATED("0")}, NULL, 256, 0, judge_albedo)},
    {"C18 reflectance 1 under a rough coat", "finite, and at most 1 of the light",
     STIFF("plate.json", {COATED("0.3")}, NULL, 256, 0, judge_albedo)},
    {"C24 an open mesh bounds a medium", "it is counted",
     STIFF("media.json", {{"bodies", JSON([{"type": "disc", "material": "glass", "radius": 9,
           "normal": [0, 0, -1]}])}}, NULL, 16, 0, judge_media)},
    {"C25 normals that lean by 70 degrees", "finite, and at most 1 of the light",
     STIFF("plate.json", {WHITE, SQUARE}, add_leaning, 64, 0, judge_albedo)},
    {"C26 corners' normals that cancel", "finite, and at most 1 of the light",
     STIFF("plate.json", {WHITE, SQUARE}, add_cancelling, 64, 0, judge_albedo)},
    {"C36 2^24 samples of one pixel", "within 1e-6", .is_long = true,
     STIFF("edge.json", {{"film", JSON({"width": 1, "height": 1})}}, NULL, UINT64_C(1) << 24, 0,
           judge_edge)},
    {"C42 a wave of 2^24 paths", "it fits or is lowered; dispatches of a GPU take 100 ms at most",
     .is_long = true, STIFF("cornell.json", {{0}}, NULL, 64, 1u << 24, judge_dispatches)},
};
// clang-format on

CHECK_GROUP(check_bounded, "bounded",
            "extreme cases: what is told, what is bounded, what ends in time", cases);
