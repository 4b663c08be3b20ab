// White rough glass under a constant sky is as bright as the sky: balls and boxes, dense,
// anisotropic and with films.
#include "render_fixture.h"

struct body {
    const char *name, *material, *shape;
};

#define JSON(...) #__VA_ARGS__
#define GLASS(...)                                                                                 \
    JSON({"type" : "principled", "base_color" : [ 1, 1, 1 ], "transmission" : 1, __VA_ARGS__})
#define BALL JSON([ {"type" : "sphere", "material" : "body", "radius" : 1} ])
#define BOX                                                                                        \
    JSON([ {"type" : "box", "material" : "body", "min" : [ -4, -4, -1 ], "max" : [ 4, 4, 0 ]} ])

// clang-format off
static const struct body bodies[] = {
    {"dense ball", JSON({"type": "dielectric", "ior": 4, "roughness": 1}), BALL},
    {"dense ball, principled", GLASS("ior": 4, "roughness": 1), BALL},
    {"ball of diamond", JSON({"type": "dielectric", "ior": 2.42, "roughness": 1}), BALL},
    {"dense box", JSON({"type": "dielectric", "ior": 4, "roughness": 0.7}), BOX},
    {"anisotropic ball", GLASS("ior": 1.5, "roughness": 0.5, "anisotropic": 0.9), BALL},
    {"anisotropic ball, rough", GLASS("ior": 1.5, "roughness": 0.8, "anisotropic": 1), BALL},
    {"anisotropic box",
     GLASS("ior": 1.5, "roughness": 0.5, "anisotropic": 0.9, "anisotropic_rotation": 0.1), BOX},
    {"filmed ball", GLASS("ior": 1.5, "roughness": 0.5, "iridescence": 1, "film_ior": 1.33,
                          "film_thickness": 400), BALL},
    {"filmed box", GLASS("ior": 1.5, "roughness": 0.7, "iridescence": 1, "film_ior": 1.8,
                         "film_thickness": 300), BOX},
    {"anisotropic filmed ball", GLASS("ior": 1.5, "roughness": 0.7, "anisotropic": 0.6,
                                      "iridescence": 0.5, "film_thickness": 500), BALL},
};
// clang-format on

static bool render_body(struct gpu *gpu, const struct body *body, struct arena *arena,
                        struct film_image *film, struct err *err)
{
    const struct scene_override overrides[] = {
        {"body", body->material}, {"bodies", body->shape}, {"fov", "20"}, {NULL, NULL}};
    struct scene scene = {0};
    bool ok = load_scene("src/check/scenes/media.json", overrides, &scene, err);
    const struct renderer_params params = {.gpu = gpu, .scene = &scene};
    ok = ok && render_film(&params, 16, arena, film, NULL, err);
    scene_finish(&scene);
    return ok;
}

TEST(white_bodies)
{
    static const double sky[3] = {1, 2, 4};
    struct gpu gpu;
    OPEN_GPU(&gpu, 0);
    for (size_t i = 0; i < sizeof bodies / sizeof *bodies; i++) {
        struct arena arena = {0};
        struct film_image film;
        struct err err = {0};
        REQUIRE_OK(render_body(&gpu, &bodies[i], &arena, &film, &err));
        uint32_t pixels = film.width * film.height;
        printf("  %-24s", bodies[i].name);
        for (int c = 0; c < 3; c++) {
            double sum = 0, squares = 0;
            for (uint32_t p = 0; p < pixels; p++) {
                double value = (double)film.mean[p][c] / sky[c];
                sum += value / pixels;
                squares += value * value / pixels;
            }
            double error = sqrt((squares - sum * sum) / pixels);
            printf(" %.4f +- %.4f", sum, error);
            CHECK(fabs(sum - 1) <= 0.01 && error <= 0.004, "%s, channel %d: %.4f +- %.4f",
                  bodies[i].name, c, sum, error);
        }
        printf("\n");
        arena_finish(&arena);
    }
    gpu_close(&gpu);
}

TEST_MAIN(TEST_CASE(white_bodies))
