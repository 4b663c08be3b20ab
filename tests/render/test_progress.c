// Tests the phases that a renderer reports to a listener: each has its own name, one after the
// other.
#include "render_fixture.h"

struct heard {
    const char *phases[16];
    double last;
    uint32_t count;
    bool went_back;
};

static void hear(void *context, const char *phase, double fraction)
{
    struct heard *heard = context;
    if (heard->count == 0 || strcmp(heard->phases[heard->count - 1], phase) != 0) {
        heard->phases[heard->count++ % 16] = phase;
        heard->last = 0.0;
    }
    heard->went_back |= fraction < heard->last || fraction > 1.0;
    heard->last = fraction;
}

TEST(each_phase_has_its_name)
{
    static const char *const expected[] = {"Loading",   "Flattening", "Building BVH",
                                           "Uploading", "Compiling",  "Rendering"};
    struct heard heard = {0};
    const struct progress progress = {.report = hear, .context = &heard};
    struct scene scene;
    struct gpu gpu;
    struct renderer r;
    struct err err = {0};
    bool stopped = false;
    OPEN_GPU(&gpu, .validation = false);
    REQUIRE_OK(load_scene("scenes/cornell.json", NULL, &scene, &err));
    scene.settings.width = scene.settings.height = 16;
    const struct renderer_params params = {.gpu = &gpu, .scene = &scene, .progress = &progress};
    hear(&heard, "Loading", 0);
    REQUIRE_OK(renderer_create(&params, &r, &err));
    const struct render_call call = {.samples = 4, .progress_to = 1.0, .stopped = &stopped};
    REQUIRE_OK(renderer_render(&r, &call, &err));
    CHECK(!heard.went_back);
    CHECK(heard.count == 6, "%u phases", heard.count);
    for (uint32_t i = 0; i < heard.count && i < 6; i++)
        CHECK(strcmp(heard.phases[i], expected[i]) == 0, "%u: %s, not %s", i, heard.phases[i],
              expected[i]);
    renderer_finish(&r);
    scene_finish(&scene);
    gpu_close(&gpu);
}

TEST_MAIN(TEST_CASE(each_phase_has_its_name))
