// Compares lights with photometric profiles above a floor, pixel by pixel, with the loaded profile
// in double precision.
#define _GNU_SOURCE // nftw
#include "../base/temporary_folder.h"
#include "base/maths.h"
#include "ies_reference.h"
#include "render_fixture.h"
#include <math.h>

#define RHO 0.5
// The error of the device's atan times the greatest slope of the profiles, plus other rounding
// errors.
#define ROUNDING_MAX 2e-5

struct trial {
    const char *name, *profile; // text of the file from the number of lamps on
    const char *light;          // other members of the light
    double direction[3], rotation, position[3], peak; // as in `light`; peak 0: that of the file
};

#define SIZES " 2 0.1 0.1 0 1 1 50\n"
#define QUARTER "1 1 683 4 3 1" SIZES "0 30 60 90\n0 20 90\n4 3 2 1\n4 2 1 1\n4 4 4 0\n"
#define ROUND                                                                                      \
    "1 1 683 3 5 1" SIZES "0 45 180\n0 10 100 200 350\n9 1 0\n9 5 1\n9 2 3\n9 9 2\n9 3 3\n"

static const struct trial trials[] = {
    {"even", "1 1 683 2 1 1" SIZES "0 180\n0\n2 2\n", "", {0, -1, 0}, 0, {0.3, 1, 0.2}, 0},
    {"quarter", QUARTER, "", {0, -1, 0}, 0, {0.3, 1, 0.2}, 0},
    {"quarter, turned",
     QUARTER,
     ",\"rotation_degrees\":30,\"intensity\":[3,3,3]",
     {0, -1, 0},
     30,
     {0, 1, 0},
     3},
    {"round, seam", ROUND, "", {0, -1, 0}, 0, {0, 1, 0}, 0},
    {"round, aslant",
     ROUND,
     ",\"direction\":[1,-2,0.5],\"rotation_degrees\":-75",
     {1, -2, 0.5},
     -75,
     {-0.5, 1.5, 0},
     0},
    {"along x", ROUND, ",\"direction\":[1,0,0]", {1, 0, 0}, 0, {-1, 0.7, 0}, 0},
    {"narrow beam",
     "1 1 683 4 1 1" SIZES "0 4 4.5 90\n0\n100 100 1 0\n",
     "",
     {0, -1, 0},
     0,
     {0.1, 2, 0.1},
     0},
    {"from below",
     "1 1 683 3 1 1" SIZES "90 135 180\n0\n1 2 3\n",
     ",\"direction\":[0,1,0]",
     {0, 1, 0},
     0,
     {0, 1, 0},
     0},
};

// Returns the relative intensity in a unit direction, as defined in scene-format.md.
static double relative(const struct trial *t, const struct light_profile *p, const double to[3])
{
    double down[3], up[3], x[3] = {1, 0, 0}, y[3];
    memcpy(down, t->direction, sizeof down);
    vec3_normalize(down);
    if (fabs(down[0]) == 1)
        x[0] = 0, x[2] = 1;
    for (int c = 0; c < 3; c++)
        up[c] = -down[c];
    vec3_cross(up, x, y);
    vec3_normalize(y);
    vec3_cross(y, up, x);
    double horizontal = atan2(vec3_dot(to, y), vec3_dot(to, x)) * 180 / M_PI - t->rotation;
    horizontal = fmod(horizontal + 720, 360);
    double off[3];
    vec3_cross(down, to, off);
    double vertical = atan2(sqrt(vec3_dot(off, off)), vec3_dot(to, down)) * 180 / M_PI;
    return ies_relative(p, vertical, horizontal);
}

static double expected(const struct trial *t, const struct light_profile *p, int x, int y)
{
    const double at[3] = {(x + 0.5) / 8 - 2, 0, (y + 0.5) / 8 - 2};
    double to[3] = {at[0] - t->position[0], at[1] - t->position[1], at[2] - t->position[2]};
    double distance2 = vec3_dot(to, to);
    vec3_normalize(to);
    double peak = t->peak > 0 ? t->peak : p->greatest;
    return RHO / M_PI * peak * relative(t, p, to) * -to[1] / distance2;
}

static void check_picture(const struct trial *t, const struct scene *scene,
                          const struct film_image *film)
{
    double worst = 0, brightest = 0;
    for (int y = 0; y < 32; y++) {
        for (int x = 0; x < 32; x++) {
            double value = expected(t, scene->profiles, x, y);
            worst = fmax(worst, fabs(film->mean[y * 32 + x][0] - value));
            brightest = fmax(brightest, value);
        }
    }
    printf("  %-18s off by %.1e of the brightest pixel\n", t->name, worst / brightest);
    CHECK(worst <= ROUNDING_MAX * brightest, "%s: off by %.3g of %.3g", t->name, worst, brightest);
}

static bool write_profile(const char *path, const char *numbers)
{
    FILE *file = fopen(path, "w");
    if (!file)
        return false;
    fprintf(file, "IESNA:LM-63-2002\n[TEST] own\nTILT=NONE\n%s", numbers);
    return fclose(file) == 0;
}

TEST(floor)
{
    char folder[256], path[300];
    struct gpu gpu;
    OPEN_GPU(&gpu, .validation = false);
    REQUIRE(temporary_enter(folder, sizeof folder));
    snprintf(path, sizeof path, "%s/own.ies", folder);
    for (size_t i = 0; i < sizeof trials / sizeof trials[0]; i++) {
        const struct trial *t = &trials[i];
        char light[768];
        REQUIRE(write_profile(path, t->profile), "cannot write %s", path);
        snprintf(light, sizeof light,
                 "{\"type\":\"point\",\"position\":[%g,%g,%g],\"profile\":\"%s\"%s}",
                 t->position[0], t->position[1], t->position[2], path, t->light);
        const struct scene_override overrides[] = {{"light", light}, {NULL, NULL}};
        struct scene scene;
        struct arena arena = {0};
        struct film_image film = {0};
        struct err err = {0};
        bool ok = load_scene("tests/render/scenes/floor_profile.json", overrides, &scene, &err);
        REQUIRE_OK(ok);
        const struct renderer_params params = {.gpu = &gpu, .scene = &scene};
        CHECK(render_film(&params, 1, &arena, &film, NULL, &err), "%s: %s", t->name, err.msg);
        if (film.mean)
            check_picture(t, &scene, &film);
        arena_finish(&arena);
        scene_finish(&scene);
    }
    temporary_leave(folder);
    gpu_close(&gpu);
}

TEST_MAIN(TEST_CASE(floor))
