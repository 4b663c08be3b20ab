// Tests generate_rays against the camera and pcg4d in C.
#include "kernel_fixture.h"

enum { WIDTH = 37, HEIGHT = 23, SLOTS = 1024 };

static void make_camera(struct scene *scene, struct camera camera)
{
    scene_start(scene, WIDTH, HEIGHT);
    scene->environment = (struct environment){.present = true, .radiance = {1, 1, 1}};
    scene->settings.seed = 0xfedcba98u;
    scene->cameras[0] = camera;
}

// Computes the unit direction through a point of the image; (0, 0) is its upper left corner and (1,
// 1) its lower right one.
static void camera_direction(const struct camera *camera, double x, double y, double out[3])
{
    double right[3], up[3];
    vec3_cross(camera->direction, camera->up, right);
    vec3_cross(right, camera->direction, up);
    double half_height = tan(camera->fov_y / 2), half_width = half_height * WIDTH / HEIGHT;
    double right_length = vec3_norm(right), up_length = vec3_norm(up);
    for (int c = 0; c < 3; c++)
        out[c] = camera->direction[c] + (2 * x - 1) * half_width * right[c] / right_length +
                 (1 - 2 * y) * half_height * up[c] / up_length;
    double norm = vec3_norm(out);
    for (int c = 0; c < 3; c++)
        out[c] /= norm;
}

struct expected {
    uint32_t pixel, sample;
    double inside[2]; // position inside the pixel
};

static struct expected expect(const struct renderer *r, uint32_t slot)
{
    const struct gpu_push *push = &r->push;
    struct expected out = {
        .pixel = push->first_pixel + (slot >> push->sample_shift),
        .sample = push->first_sample + (slot & ((1u << push->sample_shift) - 1)),
        .inside = {0.5, 0.5},
    };
    uint32_t bits[4] = {out.pixel, out.sample, 0, r->frame.seed};
    pcg4d(bits);
    for (int c = 0; c < 2 && (r->specialization.features & FEATURE_JITTER); c++)
        out.inside[c] = (bits[c] >> 8) * 0x1p-24;
    return out;
}

static struct gpu_path paths[SLOTS];
static float radiance[SLOTS][4];
static uint32_t queue[SLOTS];

// Runs the kernel over all slots of a wave, in parts of `part` items, on memory with arbitrary
// contents.
static bool generate(struct renderer *r, uint32_t part, struct err *err)
{
    uint32_t count = r->push.pixel_count << r->push.sample_shift;
    memset(paths, 0xa5, sizeof paths);
    memset(radiance, 0xa5, sizeof radiance);
    memset(queue, 0xa5, sizeof queue);
    memset(r->counters, 0xa5, sizeof *r->counters);
    struct gpu_buffer *buffers = r->buffers;
    uint64_t row = queue_offset(r, QUEUE_RAYS);
    bool ok =
        gpu_upload(r->gpu, &buffers[BINDING_PATHS], 0, paths, sizeof paths, err) &&
        gpu_upload(r->gpu, &buffers[BINDING_RADIANCE], 0, radiance, sizeof radiance, err) &&
        gpu_upload(r->gpu, &buffers[BINDING_QUEUES], row, queue, sizeof queue, err) &&
        gpu_upload(r->gpu, &buffers[BINDING_QUEUES], 0, r->counters, sizeof *r->counters, err);
    r->push.part_items = part;
    for (uint32_t first = 0; first < count && ok; first += part) {
        r->push.first_item = first;
        ok = run_kernel(r, &r->kernels[KERNEL_generate_rays],
                        count - first < part ? count - first : part, err);
    }
    return ok && gpu_download(r->gpu, &buffers[BINDING_PATHS], 0, paths, sizeof paths, err) &&
           gpu_download(r->gpu, &buffers[BINDING_RADIANCE], 0, radiance, sizeof radiance, err) &&
           gpu_download(r->gpu, &buffers[BINDING_QUEUES], row, queue, sizeof queue, err) &&
           gpu_download(r->gpu, &buffers[BINDING_QUEUES], 0, r->counters, sizeof *r->counters, err);
}

// Everything except the direction is exact. A coordinate in the image has about 13 rounding errors
// of 2^-24 (a division has 2.5 ulps, and the result is doubled), the vector and its normalisation
// about 7 more.
static void check_slots(const struct renderer *r, const struct camera *camera, double *worst)
{
    uint32_t count = r->push.pixel_count << r->push.sample_shift, wrong = 0;
    for (uint32_t slot = 0; slot < count; slot++) {
        const struct gpu_path *path = &paths[slot];
        struct expected e = expect(r, slot);
        double direction[3], error = 0;
        camera_direction(camera, (e.pixel % WIDTH + e.inside[0]) / WIDTH,
                         (e.pixel / WIDTH + e.inside[1]) / HEIGHT, direction);
        for (int c = 0; c < 3; c++) {
            double origin = camera->position[c] - r->flat.origin[c];
            error = fmax(error, fabs((double)path->direction[c] - direction[c]));
            wrong += path->origin[c] != (float)origin || path->throughput[c] != 1.0f ||
                     radiance[slot][c] != 0.0f;
        }
        *worst = fmax(*worst, error);
        wrong += !(error <= 20 * 0x1p-24) || path->ignore != NO_PRIMITIVE ||
                 path->bsdf_pdf != 0.0f || radiance[slot][3] != 0.0f || queue[slot] != slot;
    }
    uint32_t rubbish = 0xa5a5a5a5u, beyond = 0;
    for (uint32_t slot = count; slot < SLOTS; slot++)
        beyond += queue[slot] != rubbish || memcmp(&paths[slot].ignore, &rubbish, 4) != 0;
    CHECK(wrong == 0, "%u mistakes in %u slots", wrong, count);
    CHECK(beyond == 0, "%u slots past the end were touched", beyond);
    CHECK(r->counters->queue[QUEUE_RAYS].count == count, "queue of %u",
          r->counters->queue[QUEUE_RAYS].count);
}

static void check_camera(const char *name, struct camera camera, bool jitter)
{
    static const struct {
        uint32_t first_pixel, pixel_count, sample_shift, first_sample, part;
    } waves[] = {
        {0, WIDTH * HEIGHT, 0, 0, SLOTS}, {WIDTH * HEIGHT - 60, 60, 4, 16, SLOTS},
        {5, 1, 0, 0xffffffffu, SLOTS},    {100, 333, 1, 7 << 20, 96}, // in parts
        {0, SLOTS / 16, 4, 0, 64},
    };
    struct setup setup;
    struct err err = {0};
    double worst = 0;
    make_camera(&setup.scene, camera);
    setup.scene.settings.pixel_jitter = jitter;
    OPEN_SETUP(&setup, SLOTS);
    struct gpu_push *push = &setup.r.push;
    for (size_t i = 0; i < sizeof waves / sizeof waves[0]; i++) {
        push->first_pixel = waves[i].first_pixel;
        push->pixel_count = waves[i].pixel_count;
        push->sample_shift = waves[i].sample_shift;
        push->first_sample = waves[i].first_sample;
        bool ok = generate(&setup.r, waves[i].part, &err);
        CHECK(ok, "%s", err.msg);
        if (ok)
            check_slots(&setup.r, &setup.scene.cameras[0], &worst);
    }
    printf("  %s%s: directions within %.2g\n", name, jitter ? ", jitter" : "", worst);
    setup_close(&setup);
}

TEST(straight_camera)
{
    const struct camera camera = {
        .position = {0, 0, 4}, .direction = {0, 0, -1}, .up = {0, 1, 0}, .fov_y = 1, .name = ""};
    check_camera("straight", camera, false);
    check_camera("straight", camera, true);
}

TEST(oblique_camera)
{
    // The direction is a unit vector; `up` is neither a unit vector nor perpendicular to it.
    const struct camera camera = {.position = {-12.5, 3.25, 100.125},
                                  .direction = {2.0 / 7, -3.0 / 7, 6.0 / 7},
                                  .up = {0.5, 2, 0.25},
                                  .fov_y = 2.5,
                                  .name = ""};
    check_camera("oblique", camera, true);
}

// See docs/verification.md, C41.
TEST(narrow_camera)
{
    const struct camera camera = {.position = {0, 0, 0},
                                  .direction = {0.6, 0, -0.8},
                                  .up = {0, 1, 0},
                                  .fov_y = 0.001 * M_PI / 180,
                                  .name = ""};
    check_camera("narrow", camera, true);
}

// Computes the origins of rays from a lens, which two of a dimension's four numbers determine.
static void lens_origins(uint32_t pixel_sampling, float origins[SLOTS][3],
                         float directions[SLOTS][3])
{
    struct setup setup;
    struct err err = {0};
    make_camera(&setup.scene, (struct camera){.position = {0, 0, 4},
                                              .direction = {0, 0, -1},
                                              .up = {0, 1, 0},
                                              .fov_y = 1,
                                              .lens_radius = 0.1,
                                              .focus_distance = 2,
                                              .name = ""});
    setup.scene.settings.pixel_sampling = pixel_sampling;
    OPEN_SETUP(&setup, SLOTS);
    setup.r.push.pixel_count = SLOTS / 16;
    setup.r.push.sample_shift = 4;
    bool ok = generate(&setup.r, SLOTS, &err);
    CHECK(ok, "%s", err.msg);
    for (uint32_t i = 0; i < SLOTS; i++) {
        memcpy(origins[i], paths[i].origin, sizeof origins[i]);
        memcpy(directions[i], paths[i].direction, sizeof directions[i]);
    }
    setup_close(&setup);
}

TEST(pixel_sampling_leaves_the_lens_alone)
{
    static float origins[2][SLOTS][3], directions[2][SLOTS][3];
    lens_origins(PIXEL_SAMPLING_SAMPLER, origins[0], directions[0]);
    for (uint32_t kind = PIXEL_SAMPLING_SAMPLER + 1; pixel_sampling_names[kind]; kind++) {
        uint32_t same = 0;
        lens_origins(kind, origins[1], directions[1]);
        for (uint32_t i = 0; i < SLOTS; i++)
            same += memcmp(directions[0][i], directions[1][i], sizeof directions[0][i]) == 0;
        CHECK(memcmp(origins[0], origins[1], sizeof origins[0]) == 0, "%s: others on the lens",
              pixel_sampling_names[kind]);
        CHECK(same < SLOTS / 64, "%s: %u of %d directions are the sampler's",
              pixel_sampling_names[kind], same, SLOTS);
    }
}

TEST_MAIN(TEST_CASE(pixel_sampling_leaves_the_lens_alone), TEST_CASE(straight_camera),
          TEST_CASE(oblique_camera), TEST_CASE(narrow_camera))
