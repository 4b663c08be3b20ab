// Tests the rays of the other cameras against a computation in C, and lenses: which points are in
// focus, the size of circles of confusion, and the distribution over apertures.
#include "bsdf_statistics.h"
#include "kernel_fixture.h"

enum { WIDTH = 36, HEIGHT = 18, SLOTS = 1024 };

static struct gpu_path paths[SLOTS];

static void make_scene(struct scene *scene, const struct camera *camera, bool jitter)
{
    scene_start(scene, WIDTH, HEIGHT);
    scene->environment = (struct environment){.present = true, .radiance = {1, 1, 1}};
    scene->settings.sampler = SAMPLER_PCG;
    scene->settings.pixel_jitter = jitter;
    scene->cameras[0] = *camera;
    scene->cameras[0].name = "";
}

// Generates 2^shift samples, from `sample` on, of each pixel.
static bool generate(struct renderer *r, uint32_t first_pixel, uint32_t pixels, uint32_t shift,
                     uint32_t sample, struct err *err)
{
    r->push.first_pixel = first_pixel;
    r->push.pixel_count = pixels;
    r->push.sample_shift = shift;
    r->push.first_sample = sample;
    r->push.first_item = 0;
    r->push.part_items = SLOTS;
    bool ok = run_kernel(r, &r->kernels[KERNEL_generate_rays], pixels << shift, err) &&
              gpu_download(r->gpu, &r->buffers[BINDING_PATHS], 0, paths, sizeof paths, err);
    CHECK(ok, "%s", err->msg);
    return ok;
}

struct basis {
    double forward[3], right[3], up[3];
};

static struct basis basis_of(const struct camera *camera)
{
    struct basis b;
    memcpy(b.forward, camera->direction, sizeof b.forward);
    vec3_cross(camera->direction, camera->up, b.right);
    double scale = vec3_norm(b.right);
    for (int c = 0; c < 3; c++)
        b.right[c] /= scale;
    vec3_cross(b.right, b.forward, b.up);
    return b;
}

static double distance(const double a[3], const float b[3])
{
    double square = 0;
    for (int c = 0; c < 3; c++)
        square += (a[c] - (double)b[c]) * (a[c] - (double)b[c]);
    return sqrt(square);
}

// Computes the ray through the centre of a pixel; x, y are (-1, 1) at the upper left corner of the
// image.
static void expect_ray(const struct camera *camera, double x, double y, double origin[3],
                       double direction[3])
{
    struct basis b = basis_of(camera);
    double aspect = (double)WIDTH / HEIGHT, half = camera->height / 2;
    double tangent = tan(camera->fov_y / 2), longitude = x * M_PI, latitude = y * M_PI / 2;
    for (int c = 0; c < 3; c++) {
        origin[c] = camera->position[c];
        direction[c] = b.forward[c];
        if (camera->kind == CAMERA_ORTHOGRAPHIC)
            origin[c] += x * half * aspect * b.right[c] + y * half * b.up[c];
        else if (camera->kind == CAMERA_PANORAMIC)
            direction[c] =
                cos(latitude) * (cos(longitude) * b.forward[c] + sin(longitude) * b.right[c]) +
                sin(latitude) * b.up[c];
        else
            direction[c] += x * tangent * aspect * b.right[c] + y * tangent * b.up[c];
    }
    double norm = vec3_norm(direction);
    for (int c = 0; c < 3; c++)
        direction[c] /= norm;
}

// Checks the ray through every pixel's centre. Directions are accurate to `tolerance`, and origins
// to a few rounding errors of their terms.
static void check_camera(const char *name, const struct camera *camera, double tolerance)
{
    struct setup setup;
    struct err err = {0};
    double worst[2] = {0, 0};
    make_scene(&setup.scene, camera, false);
    OPEN_SETUP(&setup, SLOTS);
    double size = vec3_norm(camera->position) + camera->height * WIDTH / HEIGHT;
    if (generate(&setup.r, 0, WIDTH * HEIGHT, 0, 0, &err))
        for (uint32_t i = 0; i < WIDTH * HEIGHT; i++) {
            double origin[3], direction[3];
            expect_ray(camera, (i % WIDTH + 0.5) / WIDTH * 2 - 1,
                       1 - (i / WIDTH + 0.5) / HEIGHT * 2, origin, direction);
            worst[0] = fmax(worst[0], distance(origin, paths[i].origin));
            worst[1] = fmax(worst[1], distance(direction, paths[i].direction));
        }
    CHECK(worst[0] <= 16 * 0x1p-24 * size, "%s: origins within %g of %g", name, worst[0], size);
    CHECK(worst[1] <= tolerance, "%s: directions within %g", name, worst[1]);
    printf("  %s: origins within %.2g m, directions %.2g\n", name, worst[0], worst[1]);
    setup_close(&setup);
}

// Heights and fields of view include extreme ones (docs/verification.md, C41).
TEST(rays)
{
    struct camera camera = {.position = {-1.5, 3.25, 10.125},
                            .direction = {2.0 / 7, -3.0 / 7, 6.0 / 7},
                            .up = {0.5, 2, 0.25}};
    static const double heights[] = {1e-6, 0.3, 1e6}, angles[] = {0.001, 179.9};
    char name[40];
    camera.kind = CAMERA_ORTHOGRAPHIC;
    for (int i = 0; i < 3; i++) {
        snprintf(name, sizeof name, "orthographic, height %g", heights[i]);
        camera.height = heights[i];
        check_camera(name, &camera, 2 * 0x1p-24);
    }
    camera.height = 0;
    camera.kind = CAMERA_PANORAMIC;
    // Sines and cosines are accurate to 2^-11 as Vulkan requires, in practice to 2^-21.
    check_camera("panoramic", &camera, 0x1p-20);
    camera.kind = CAMERA_PERSPECTIVE;
    for (int i = 0; i < 2; i++) {
        snprintf(name, sizeof name, "perspective, %g degrees", angles[i]);
        camera.fov_y = angles[i] * M_PI / 180;
        check_camera(name, &camera, 32 * 0x1p-24);
    }
}

// --- lenses --------------------------------------------------------------------------------------

struct lens {
    const char *name;
    double radius, focus;
    uint32_t blades;
    double rotation;
};

static struct camera lens_camera(const struct lens *lens)
{
    return (struct camera){.position = {0.5, 0.25, 0},
                           .direction = {0, 0, -1},
                           .up = {0, 1, 0},
                           .fov_y = 0.8,
                           .lens_radius = lens->radius,
                           .focus_distance = lens->focus,
                           .lens_blades = lens->blades,
                           .lens_rotation = lens->rotation};
}

// Computes the point at which a ray meets the plane at this depth, relative to the camera's
// position.
static void at_depth(const struct gpu_path *path, const struct camera *camera, double depth,
                     double out[2])
{
    double begin = camera->position[2] - (double)path->origin[2];
    double t = (depth - begin) / -(double)path->direction[2];
    for (int c = 0; c < 2; c++)
        out[c] = (double)path->origin[c] + t * (double)path->direction[c] - camera->position[c];
}

// All rays of a pixel's centre meet in one point of the focal plane, within rounding errors. In a
// plane at depth z they fill the image of the aperture, scaled by |z - s| / s, about a point of the
// pinhole's ray (similar triangles).
static void check_confusion(const struct lens *lens)
{
    struct setup setup;
    struct err err = {0};
    struct camera camera = lens_camera(lens);
    make_scene(&setup.scene, &camera, false);
    OPEN_SETUP(&setup, SLOTS);
    const uint32_t pixel = 5 * WIDTH + 30;
    double x = (30.5 / WIDTH * 2 - 1) * tan(0.4) * WIDTH / HEIGHT;
    double y = (1 - 5.5 / HEIGHT * 2) * tan(0.4);
    double s = lens->focus, z[3] = {0.4 * s, s, 3 * s}, farthest[3] = {0, 0, 0};
    bool ok = generate(&setup.r, pixel, 1, 10, 0, &err);
    for (uint32_t i = 0; i < SLOTS && ok; i++)
        for (int p = 0; p < 3; p++) {
            double at[2];
            at_depth(&paths[i], &camera, z[p], at);
            farthest[p] = fmax(farthest[p], hypot(at[0] - z[p] * x, at[1] - z[p] * y));
        }
    // Rounding errors of the origin, of the direction, and of its division by the focal distance.
    double rounding = 64 * 0x1p-24 * (1 + lens->radius + s);
    CHECK(farthest[1] <= rounding, "%s: %g m from the point in focus", lens->name, farthest[1]);
    for (int p = 0; p < 3; p += 2) {
        double radius = lens->radius * fabs(z[p] - s) / s;
        // The farthest of 1024 uniform points of a disc is beyond 0.99 R with a probability of 1 -
        // 2e-9; the corners of polygons are reached less often.
        double least = lens->blades ? 0.85 : 0.99;
        CHECK(farthest[p] <= radius + 3 * rounding && farthest[p] >= least * radius - 3 * rounding,
              "%s: confusion of %g m at depth %g, expected %g", lens->name, farthest[p], z[p],
              radius);
    }
    printf("  %s: in focus within %.2g m, confusion %.4g and %.4g m\n", lens->name, farthest[1],
           farthest[0], farthest[2]);
    setup_close(&setup);
}

TEST(confusion)
{
    static const struct lens lenses[] = {
        {"round", 0.05, 2, 0, 0},
        {"round, wide", 5, 2, 0, 0},
        {"triangle", 0.05, 2, 3, 0.3},
        {"six blades", 0.05, 2, 6, -2},
        {"focus at 1 mm", 1e-4, 1e-3, 0, 0},
        {"focus at 1000 km", 0.1, 1e6, 7, 1},
    };
    for (size_t i = 0; i < sizeof lenses / sizeof lenses[0]; i++)
        check_confusion(&lenses[i]);
}

// Returns the cell, of `cells` with equal area, of a point of an aperture of radius 1: by the
// angle, and by the area of the similar polygon, or disc, inside of it. Returns -1 if the point is
// outside.
enum { RINGS = 8, SECTORS = 24 };

static int aperture_cell(const struct lens *lens, const double at[2])
{
    double angle = atan2(at[1], at[0]) - lens->rotation, part = hypot(at[0], at[1]);
    angle -= 2 * M_PI * floor(angle / (2 * M_PI));
    double blade = 0, share = angle / (2 * M_PI); // as a fraction of the whole area
    if (lens->blades) {
        double step = 2 * M_PI / lens->blades;
        blade = fmin(floor(angle / step), lens->blades - 1);
        double within = angle - blade * step - step / 2; // from the middle of the blade
        part *= cos(within) / cos(step / 2);
        share = (blade + 0.5 + 0.5 * tan(within) / tan(step / 2)) / lens->blades;
    }
    if (part > 1 + 1e-5)
        return -1;
    int ring = (int)fmin(part * part * RINGS, RINGS - 1);
    return ring * SECTORS + (int)fmin(share * SECTORS, SECTORS - 1);
}

// The distribution over the aperture must be uniform: Pearson's test of 2^17 points over 192 cells
// of equal area.
static void check_filling(const struct lens *lens)
{
    struct setup setup;
    struct err err = {0};
    struct camera camera = lens_camera(lens);
    make_scene(&setup.scene, &camera, true);
    OPEN_SETUP(&setup, SLOTS);
    enum { CELLS = RINGS * SECTORS, WAVES = 128 };
    static uint32_t count[CELLS];
    static double expected[CELLS];
    uint32_t outside = 0;
    memset(count, 0, sizeof count);
    for (int i = 0; i < CELLS; i++)
        expected[i] = (double)WAVES * SLOTS / CELLS;
    for (uint32_t wave = 0; wave < WAVES && generate(&setup.r, 77, 1, 10, wave * SLOTS, &err);
         wave++)
        for (uint32_t i = 0; i < SLOTS; i++) {
            double at[2];
            at_depth(&paths[i], &camera, 0, at);
            int cell =
                aperture_cell(lens, (const double[]){at[0] / lens->radius, at[1] / lens->radius});
            outside += cell < 0;
            count[cell < 0 ? 0 : cell]++;
        }
    struct pearson test = pearson_test(expected, count, CELLS);
    CHECK(outside == 0, "%s: %u points outside", lens->name, outside);
    CHECK(test.p > 1e-6, "%s: p = %g", lens->name, test.p);
    printf("  %s: chi-square %.1f of %u degrees, p = %.3g\n", lens->name, test.statistic,
           test.degrees, test.p);
    setup_close(&setup);
}

TEST(apertures)
{
    static const struct lens lenses[] = {
        {"round", 0.5, 2, 0, 0},
        {"triangle", 0.5, 2, 3, 0.3},
        {"six blades", 0.5, 2, 6, -2},
    };
    for (size_t i = 0; i < sizeof lenses / sizeof lenses[0]; i++)
        check_filling(&lenses[i]);
}

// --- pictures ------------------------------------------------------------------------------------

static bool take_picture(struct renderer *r, uint64_t samples, struct arena *arena,
                         struct film_image *film)
{
    struct err err = {0};
    bool ok = renderer_render(r, &(struct render_call){.samples = samples}, &err) &&
              renderer_read(r, arena, film, &err);
    CHECK(ok, "%s", err.msg);
    return ok;
}

// A panoramic image of an environment must equal the environment's image.
TEST(panorama_of_an_environment)
{
    const struct camera camera = {
        .kind = CAMERA_PANORAMIC, .position = {5, -3, 2}, .direction = {1, 0, 0}, .up = {0, 1, 0}};
    struct setup setup;
    struct arena arena = {0};
    struct film_image film;
    make_scene(&setup.scene, &camera, false);
    add_environment_image(&setup.scene, WIDTH, HEIGHT);
    // so that each texel is constant
    setup.scene.settings.environment_filter = ENVIRONMENT_FILTER_NEAREST;
    OPEN_SETUP(&setup, SLOTS);
    uint32_t wrong = 0;
    if (take_picture(&setup.r, 1, &arena, &film))
        for (uint32_t i = 0; i < WIDTH * HEIGHT; i++)
            for (int c = 0; c < 3; c++)
                wrong += film.mean[i][c] !=
                         setup.scene.environment.texels[i][c] * setup.scene.environment.radiance[c];
    CHECK(wrong == 0, "%u values are not those of their texels", wrong);
    arena_finish(&arena);
    setup_close(&setup);
}

// Returns the fraction of an aperture of radius 1 with x below u: of a disc, or of the square with
// level sides.
static double part_below(const struct lens *lens, double u)
{
    if (lens->blades)
        return fmin(fmax(0.5 + u * M_SQRT1_2, 0), 1);
    u = fmin(fmax(u, -1), 1);
    return 0.5 + (u * sqrt(1 - u * u) + asin(u)) / M_PI;
}

// A light has a vertical edge at depth z. A pixel receives light from the part of the aperture from
// which rays to the pinhole ray's point in the focal plane hit the light.
static void check_edge(const struct lens *lens)
{
    enum { SPP = 256 };
    const double z = 3, s = lens->focus, edge = 0.05;
    const float far_left = -40, right = (float)(0.5 + edge), depth = (float)-z;
    const float light[2][3][3] = {
        {{far_left, -40, depth}, {right, -40, depth}, {right, 40, depth}},
        {{far_left, -40, depth}, {right, 40, depth}, {far_left, 40, depth}}};
    struct setup setup;
    struct arena arena = {0};
    struct film_image film;
    struct camera camera = lens_camera(lens);
    make_scene(&setup.scene, &camera, false);
    setup.scene.environment.present = false;
    struct material material = {.name = "light", .model = MATERIAL_LAMBERT};
    for (int c = 0; c < 3; c++)
        material.parameters[PARAMETER_EMISSION + c] = 1;
    material.flags |= MATERIAL_EMITS;
    add_triangles(&setup.scene, light, 2, add_material(&setup.scene, &material));
    OPEN_SETUP(&setup, SLOTS);
    double worst = 0;
    if (take_picture(&setup.r, SPP, &arena, &film))
        for (uint32_t x = 0; x < WIDTH; x++) {
            double aimed = ((x + 0.5) / WIDTH * 2 - 1) * tan(0.4) * WIDTH / HEIGHT * z;
            // At depth z, a point u R of the aperture is mapped to aimed + u R (1 - z / s).
            double blur = lens->radius * (1 - z / s);
            double expected = part_below(lens, (edge - aimed) / fabs(blur)), mean = 0;
            for (uint32_t y = 0; y < HEIGHT; y++)
                mean += (double)film.mean[y * WIDTH + x][0] / HEIGHT;
            double sigma = sqrt(expected * (1 - expected) / (SPP * HEIGHT));
            worst = fmax(worst, fabs(mean - expected) / fmax(sigma, 1e-9));
            // The difference exceeds 5 sigma once in 1.7 million tests.
            CHECK(fabs(mean - expected) <= 5 * sigma + 1e-6, "%s: column %u: %g, expected %g",
                  lens->name, x, mean, expected);
        }
    printf("  %s: edge within %.2f sigma\n", lens->name, worst);
    arena_finish(&arena);
    setup_close(&setup);
}

TEST(edges_out_of_focus)
{
    static const struct lens lenses[] = {
        {"round, focus in front", 0.4, 1.5, 0, 0},
        {"round, focus behind", 1.5, 8, 0, 0},
        {"square", 0.4, 1.5, 4, M_PI / 4},
    };
    for (size_t i = 0; i < sizeof lenses / sizeof lenses[0]; i++)
        check_edge(&lenses[i]);
}

// A Lambertian sphere is lit from the viewing direction. The mean over its disc is (2/3) rho E /
// pi, and the disc is pi of the picture's 4.4 x 2.2 square metres.
TEST(orthographic_full_moon)
{
    const struct camera camera = {.kind = CAMERA_ORTHOGRAPHIC,
                                  .position = {0, 0, 10},
                                  .direction = {0, 0, -1},
                                  .up = {0, 1, 0},
                                  .height = 2.2};
    struct setup setup;
    struct arena arena = {0};
    struct film_image film;
    make_scene(&setup.scene, &camera, true);
    setup.scene.environment.present = false;
    struct material material = {.name = "moon", .model = MATERIAL_LAMBERT};
    for (int c = 0; c < 3; c++)
        material.parameters[PARAMETER_BASE_COLOR + c] = 0.6f;
    material.parameters[PARAMETER_OPACITY] = 1;
    add_sphere(&setup.scene, (const double[]){0, 0, 0}, 1, add_material(&setup.scene, &material));
    struct light *sun = scene_add_light(&setup.scene, NULL);
    REQUIRE(sun);
    *sun = (struct light){.name = "sun",
                          .kind = LIGHT_DIRECTIONAL,
                          .direction = {0, 0, -1},
                          .radiant = {5, 5, 5},
                          .range = INFINITY};
    OPEN_SETUP(&setup, SLOTS);
    double mean = 0, variance = 0;
    const double pixels = WIDTH * HEIGHT, expected = 2.0 / 3 * 0.6 * 5 / (4.4 * 2.2);
    if (take_picture(&setup.r, 256, &arena, &film))
        for (uint32_t i = 0; i < WIDTH * HEIGHT; i++) {
            double difference = (double)film.half_a[i][0] - (double)film.half_b[i][0];
            mean += (double)film.mean[i][0] / pixels;
            variance += difference * difference / 4 / (pixels * pixels);
        }
    CHECK(fabs(mean - expected) <= 5 * sqrt(variance), "%g, expected %g within %g", mean, expected,
          5 * sqrt(variance));
    CHECK(sqrt(variance) < 1e-3 * expected, "relative error of %g", sqrt(variance) / expected);
    printf("  mean %.6f, expected %.6f, sigma %.2g\n", mean, expected, sqrt(variance));
    arena_finish(&arena);
    setup_close(&setup);
}

TEST_MAIN(TEST_CASE(rays), TEST_CASE(confusion), TEST_CASE(apertures),
          TEST_CASE(panorama_of_an_environment), TEST_CASE(edges_out_of_focus),
          TEST_CASE(orthographic_full_moon))
