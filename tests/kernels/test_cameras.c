// Rays of the other cameras: where they begin and where they go, against the same in C; and lenses:
// what is in focus, how large circles of confusion are, and how apertures are filled.
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

// 2^shift samples from `sample` on of each of so many pixels.
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
    cross(camera->direction, camera->up, b.right);
    double scale = length(b.right);
    for (int c = 0; c < 3; c++)
        b.right[c] /= scale;
    cross(b.right, b.forward, b.up);
    return b;
}

static double distance(const double a[3], const float b[3])
{
    double square = 0;
    for (int c = 0; c < 3; c++)
        square += (a[c] - (double)b[c]) * (a[c] - (double)b[c]);
    return sqrt(square);
}

// Through the middle of a pixel: x, y from (-1, 1) at the upper left corner of the picture.
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
    double norm = length(direction);
    for (int c = 0; c < 3; c++)
        direction[c] /= norm;
}

// Every pixel's middle. Directions are good to `tolerance`; origins to a few roundings of what they
// are made of.
static void check_camera(const char *name, const struct camera *camera, double tolerance)
{
    struct setup setup;
    struct err err = {0};
    double worst[2] = {0, 0};
    make_scene(&setup.scene, camera, false);
    OPEN_SETUP(&setup, SLOTS);
    double size = length(camera->position) + camera->height * WIDTH / HEIGHT;
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

// Heights and fields of view are the stiff case C41, too.
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
    // Sines and cosines are good to 2^-11 where Vulkan asks for no more, to 2^-21 in practice.
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

// Where a ray meets the plane at this depth, relative to the camera's position.
static void at_depth(const struct gpu_path *path, const struct camera *camera, double depth,
                     double out[2])
{
    double begin = camera->position[2] - (double)path->origin[2];
    double t = (depth - begin) / -(double)path->direction[2];
    for (int c = 0; c < 2; c++)
        out[c] = (double)path->origin[c] + t * (double)path->direction[c] - camera->position[c];
}

// All rays of a pixel's middle meet in one point of the plane in focus, up to roundings; in a plane
// at depth z they fill the aperture's image, |z - s| / s times as large, about a point of the
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
    // Roundings of the origin, of the direction and of its division by the focal distance.
    double rounding = 64 * 0x1p-24 * (1 + lens->radius + s);
    CHECK(farthest[1] <= rounding, "%s: %g m from the point in focus", lens->name, farthest[1]);
    for (int p = 0; p < 3; p += 2) {
        double radius = lens->radius * fabs(z[p] - s) / s;
        // Of 1024 uniform points of a disc the farthest is beyond 0.99 R but for 2e-9; corners of
        // polygons are reached less.
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

// The cell of a point of an aperture of radius 1, of `cells` of equal area: by the angle, and by
// the area of the similar polygon, or disc, inside; -1 outside.
enum { RINGS = 8, SECTORS = 24 };

static int aperture_cell(const struct lens *lens, const double at[2])
{
    double angle = atan2(at[1], at[0]) - lens->rotation, part = hypot(at[0], at[1]);
    angle -= 2 * M_PI * floor(angle / (2 * M_PI));
    double blade = 0, share = angle / (2 * M_PI); // of the whole turn's area
    if (lens->blades) {
        double step = 2 * M_PI / lens->blades;
        blade = fmin(floor(angle / step), lens->blades - 1);
        double within = angle - blade * step - step / 2; // from the blade's middle
        part *= cos(within) / cos(step / 2);
        share = (blade + 0.5 + 0.5 * tan(within) / tan(step / 2)) / lens->blades;
    }
    if (part > 1 + 1e-5)
        return -1;
    int ring = (int)fmin(part * part * RINGS, RINGS - 1);
    return ring * SECTORS + (int)fmin(share * SECTORS, SECTORS - 1);
}

// Uniform over the aperture: Pearson's test of 2^17 points over 192 cells of equal area.
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

TEST_MAIN(TEST_CASE(rays), TEST_CASE(confusion), TEST_CASE(apertures))
