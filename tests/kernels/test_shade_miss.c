// Tests shade_miss: which texel is in a direction, what is added, and how numbers that are not
// finite are handled.
#include "environment_texel.h"
#include "kernel_fixture.h"

enum { SLOTS = 8192 };

static struct gpu_path paths[SLOTS];
static float radiance[SLOTS][4];
static uint32_t queue[SLOTS];

// Runs the kernel over the first `count` slots, which the queue lists in reverse order.
static bool shade(struct renderer *r, uint32_t count, struct err *err)
{
    struct gpu_buffer *buffers = r->buffers;
    for (uint32_t i = 0; i < count; i++)
        queue[i] = count - 1 - i;
    memset(r->counters, 0, sizeof *r->counters);
    r->counters->queue[QUEUE_MISS].count = count;
    r->push.queue = QUEUE_MISS;
    r->push.first_item = 0;
    r->push.part_items = SLOTS;
    uint64_t row = queue_offset(r, QUEUE_MISS);
    return gpu_upload(r->gpu, &buffers[BINDING_PATHS], 0, paths, sizeof paths, err) &&
           gpu_upload(r->gpu, &buffers[BINDING_RADIANCE], 0, radiance, sizeof radiance, err) &&
           gpu_upload(r->gpu, &buffers[BINDING_QUEUES], row, queue, count * sizeof *queue, err) &&
           gpu_upload(r->gpu, &buffers[BINDING_QUEUES], 0, r->counters, sizeof *r->counters, err) &&
           run_kernel(r, &r->kernels[KERNEL_shade_miss], SLOTS, err) &&
           gpu_download(r->gpu, &buffers[BINDING_RADIANCE], 0, radiance, sizeof radiance, err) &&
           gpu_download(r->gpu, &buffers[BINDING_QUEUES], 0, r->counters, sizeof *r->counters, err);
}

static void clear(void)
{
    memset(paths, 0, sizeof paths);
    memset(radiance, 0, sizeof radiance);
}

static void set_throughput(struct gpu_path *path, float value)
{
    for (int c = 0; c < 3; c++)
        path->throughput[c] = value;
}

// --- radiance ------------------------------------------------------------------------------------

TEST(constant_environment)
{
    struct setup setup;
    struct err err = {0};
    struct random random = {71};
    scene_start(&setup.scene, 16, 16);
    setup.scene.environment = (struct environment){.present = true, .radiance = {0.25f, 3, 1000}};
    OPEN_SETUP(&setup, SLOTS);
    static float before[SLOTS][4];
    enum { COUNT = 5000 };
    clear();
    for (uint32_t i = 0; i < SLOTS; i++) {
        random_direction(&random, paths[i].direction);
        for (int c = 0; c < 3; c++) {
            paths[i].throughput[c] = (float)random_between(&random, 0, 2);
            radiance[i][c] = (float)random_between(&random, 0, 100);
        }
    }
    memcpy(before, radiance, sizeof before);
    bool ok = shade(&setup.r, COUNT, &err);
    REQUIRE(ok, "%s", err.msg);
    uint32_t wrong = 0, touched = 0;
    for (uint32_t i = 0; i < SLOTS; i++) {
        for (int c = 0; c < 3; c++) {
            // A product and a sum, which the device may contract.
            double exact = (double)before[i][c] + (double)paths[i].throughput[c] *
                                                      (double)setup.scene.environment.radiance[c];
            wrong += i < COUNT && !(fabs((double)radiance[i][c] - exact) <= 0x1p-23 * exact);
        }
        touched += i >= COUNT && memcmp(radiance[i], before[i], sizeof before[i]) != 0;
    }
    CHECK(wrong == 0, "%u values", wrong);
    CHECK(touched == 0, "%u slots that were not queued", touched);
    setup_close(&setup);
}

// --- texels --------------------------------------------------------------------------------------

// Returns the texel that was found: add_environment_image() gives texel i the red value 3 i + 1.
static uint32_t seen_texel(uint32_t slot)
{
    return (uint32_t)lrintf((radiance[slot][0] - 1) / 3);
}

// Tests the directions that scene/core/environment.h names.
TEST(axes_see_their_texels)
{
    static const struct {
        float direction[3];
        uint32_t texel; // index in an image of 8 x 4 texels
    } axes[] = {
        // The horizon is the upper edge of row 2. Directions are off by half a pixel, to stay away
        // from the edges.
        {{1, -0.1f, 0.1f}, 2 * 8 + 4},  {{0.1f, -0.1f, 1}, 2 * 8 + 5},
        {{-0.1f, -0.1f, 1}, 2 * 8 + 6}, {{-1, 0.1f, 0.1f}, 1 * 8 + 7},
        {{-1, 0.1f, -0.1f}, 1 * 8 + 0}, {{-0.1f, 0.1f, -1}, 1 * 8 + 1},
        {{0.1f, 0.1f, -1}, 1 * 8 + 2},  {{1, 0.1f, -0.1f}, 1 * 8 + 3},
        {{0.1f, 1, 0.05f}, 0 * 8 + 4},  {{-0.1f, -1, -0.05f}, 3 * 8 + 0},
    };
    enum { AXES = sizeof axes / sizeof axes[0] };
    struct setup setup;
    struct err err = {0};
    scene_start(&setup.scene, 16, 16);
    add_environment_image(&setup.scene, 8, 4);
    setup.scene.settings.environment_filter = ENVIRONMENT_FILTER_NEAREST;
    OPEN_SETUP(&setup, SLOTS);
    clear();
    for (uint32_t i = 0; i < AXES; i++) {
        double d[3] = {(double)axes[i].direction[0], (double)axes[i].direction[1],
                       (double)axes[i].direction[2]};
        for (int c = 0; c < 3; c++)
            paths[i].direction[c] = (float)(d[c] / vec3_norm(d));
        set_throughput(&paths[i], 1);
    }
    bool ok = shade(&setup.r, AXES, &err);
    REQUIRE(ok, "%s", err.msg);
    for (uint32_t i = 0; i < AXES; i++)
        CHECK(seen_texel(i) == axes[i].texel, "direction %u sees texel %u, not %u", i,
              seen_texel(i), axes[i].texel);
    setup_close(&setup);
}

// Compares random directions with environment_texel() in double precision, except if an edge
// between texels is too near for single precision.
TEST(directions_see_the_reference_texels)
{
    enum { IMAGE_WIDTH = 61, IMAGE_HEIGHT = 31 };
    struct setup setup;
    struct err err = {0};
    struct random random = {72};
    scene_start(&setup.scene, 16, 16);
    add_environment_image(&setup.scene, IMAGE_WIDTH, IMAGE_HEIGHT);
    setup.scene.settings.environment_filter = ENVIRONMENT_FILTER_NEAREST;
    OPEN_SETUP(&setup, SLOTS);
    clear();
    for (uint32_t i = 0; i < SLOTS; i++) {
        random_direction(&random, paths[i].direction);
        if (i < 6) { // the axes: the correct texel or a neighbour, never one outside
            memset(paths[i].direction, 0, sizeof paths[i].direction);
            paths[i].direction[i / 2] = i % 2 ? -1.0f : 1.0f;
        }
        set_throughput(&paths[i], 1);
    }
    bool ok = shade(&setup.r, SLOTS, &err);
    REQUIRE(ok, "%s", err.msg);
    uint32_t wrong = 0, at_edges = 0;
    for (uint32_t i = 0; i < SLOTS; i++) {
        double d[3] = {(double)paths[i].direction[0], (double)paths[i].direction[1],
                       (double)paths[i].direction[2]};
        double column = (0.5 + atan2(d[2], d[0]) / (2 * M_PI)) * IMAGE_WIDTH;
        double row = acos(d[1] / vec3_norm(d)) / M_PI * IMAGE_HEIGHT;
        bool near_edge = fabs(column - round(column)) < 1e-3 || fabs(row - round(row)) < 1e-3;
        bool same = seen_texel(i) == environment_texel(&setup.scene.environment, d);
        CHECK(seen_texel(i) < IMAGE_WIDTH * IMAGE_HEIGHT, "texel %u", seen_texel(i));
        at_edges += near_edge;
        wrong += !same && !near_edge;
    }
    CHECK(wrong == 0, "%u of %u", wrong, SLOTS);
    CHECK(at_edges < SLOTS / 50, "%u at edges", at_edges);
    setup_close(&setup);
}

// --- not finite ----------------------------------------------------------------------------------

TEST(nonfinite_contributions_are_dropped_and_reported)
{
    enum { BAD = NONFINITE_RECORDS + 8, COUNT = 4 * BAD };
    static const uint32_t patterns[4] = {0x7f800000u, 0xff800000u, 0x7fc00000u, 0x7f800001u};
    struct setup setup;
    struct err err = {0};
    scene_start(&setup.scene, 64, 64);
    setup.scene.environment = (struct environment){.present = true, .radiance = {1, 1, 1}};
    OPEN_SETUP(&setup, SLOTS);
    struct gpu_push *push = &setup.r.push;
    push->first_pixel = 1000;
    push->sample_shift = 2;
    push->first_sample = 80;
    push->bounce = 3;
    clear();
    for (uint32_t i = 0; i < COUNT; i++) {
        set_throughput(&paths[i], 1);
        if (i % 4 == 1)
            memcpy(&paths[i].throughput[i % 3], &patterns[i / 4 % 4], 4);
    }
    bool ok = shade(&setup.r, COUNT, &err);
    REQUIRE(ok, "%s", err.msg);
    for (uint32_t i = 0; i < COUNT; i++) {
        float value = i % 4 == 1 ? 0.0f : 1.0f;
        CHECK(radiance[i][0] == value && radiance[i][1] == value && radiance[i][2] == value &&
                  radiance[i][3] == 1.0f - value,
              "slot %u: %g %g %g, mark %g", i, (double)radiance[i][0], (double)radiance[i][1],
              (double)radiance[i][2], (double)radiance[i][3]);
    }
    const struct gpu_counters *counters = setup.r.counters;
    for (int site = 0; site < SITE_COUNT; site++)
        CHECK(counters->nonfinite[site] == (site == SITE_MISS ? BAD : 0u), "site %d: %u", site,
              counters->nonfinite[site]);
    CHECK(counters->nonfinite_records == BAD, "%u records", counters->nonfinite_records);
    bool seen[COUNT] = {false};
    for (int i = 0; i < NONFINITE_RECORDS; i++) {
        const uint32_t *record = &counters->nonfinite_record[4 * i];
        uint32_t slot = (record[0] - 1000) * 4 + (record[1] - 80);
        bool right = slot < COUNT && slot % 4 == 1 && record[2] == SITE_MISS && record[3] == 3;
        CHECK(right && !seen[slot], "pixel %u, sample %u, site %u, bounce %u", record[0], record[1],
              record[2], record[3]);
        if (right)
            seen[slot] = true;
    }
    setup_close(&setup);
}

// A finite contribution that would make the sum infinite is dropped, too.
TEST(sums_stay_finite)
{
    struct setup setup;
    struct err err = {0};
    scene_start(&setup.scene, 16, 16);
    setup.scene.environment = (struct environment){.present = true, .radiance = {1e30f, 1, 1}};
    OPEN_SETUP(&setup, SLOTS);
    clear();
    set_throughput(&paths[0], 3e8f);
    radiance[0][0] = 3e38f;
    radiance[0][1] = 2;
    bool ok = shade(&setup.r, 1, &err);
    REQUIRE(ok, "%s", err.msg);
    CHECK(radiance[0][0] == 3e38f && radiance[0][1] == 2.0f && radiance[0][3] == 1.0f,
          "%g %g, mark %g", (double)radiance[0][0], (double)radiance[0][1], (double)radiance[0][3]);
    CHECK(setup.r.counters->nonfinite[SITE_MISS] == 1, "%u reported",
          setup.r.counters->nonfinite[SITE_MISS]);
    setup_close(&setup);
}

TEST_MAIN(TEST_CASE(constant_environment), TEST_CASE(axes_see_their_texels),
          TEST_CASE(directions_see_the_reference_texels),
          TEST_CASE(nonfinite_contributions_are_dropped_and_reported), TEST_CASE(sums_stay_finite))
