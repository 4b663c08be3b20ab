// docs/verification.md, C8: 10^6 identical triangles. No box separates them, so a ray that enters
// their box tests them all, which takes many more steps than one dispatch has.
#include "base/maths.h"
#include "bvh_trace.h"
#include "render_fixture.h"

#define PILE 1000000u
// Several times the steps of a dispatch on the CPU driver.
#define SMALL_PILE 20000u
#define PILE_SAMPLES 2u

// Returns the number of triangles that the device supports, if its limits are lowered.
static uint32_t pile_size(const struct gpu *gpu)
{
    uint64_t fits = gpu->max_storage_range / sizeof(struct gpu_triangle) - 16;
    return fits < PILE ? (uint32_t)fits : PILE;
}

// Adds the triangles: the first one with the scene's first material, the others with the second.
static bool add_pile(struct scene *scene, uint32_t count)
{
    static const float corners[3][3] = {
        {-1.1f, -0.3f, 0.1f}, {1.3f, -0.1f, -0.2f}, {-0.2f, 1.8f, 0}};
    struct arena *arena = &scene->arena;
    uint32_t index;
    struct mesh *mesh = scene_add_mesh(scene, &index);
    if (!mesh)
        return false;
    mesh->vertex_count = 3;
    mesh->triangle_count = count;
    mesh->positions = arena_alloc(arena, 3, sizeof *mesh->positions);
    mesh->indices = arena_alloc(arena, count, sizeof *mesh->indices);
    mesh->triangle_material = ARENA_NEW(arena, uint32_t, count);
    if (!mesh->positions || !mesh->indices || !mesh->triangle_material)
        return false;
    memcpy(mesh->positions, corners, sizeof corners);
    for (uint32_t i = 0; i < count; i++) {
        for (uint32_t corner = 0; corner < 3; corner++)
            mesh->indices[i][corner] = corner;
        mesh->triangle_material[i] = i == 0 ? 0 : 1;
    }
    return scene_place_meshes(scene, index, 1, NULL);
}

static bool load_pile(const struct scene_override *overrides, uint32_t count, struct scene *scene,
                      struct err *err)
{
    return load_scene("tests/render/scenes/pile.json", overrides, scene, err) &&
           (add_pile(scene, count) || err_memory(err, "the pile", count));
}

// --- the CPU reference ---------------------------------------------------------------------------

// Returns the ray through a pixel's centre.
static struct bvh_ray camera_ray(const struct scene *scene, uint32_t x, uint32_t y)
{
    const struct camera *camera = &scene->cameras[0];
    double right[3], up[3], half = tan(0.5 * camera->fov_y);
    double across = (2.0 * x + 1.0) / scene->settings.width - 1.0;
    double upwards = 1.0 - (2.0 * y + 1.0) / scene->settings.height;
    vec3_cross(camera->direction, camera->up, right);
    double length = sqrt(right[0] * right[0] + right[1] * right[1] + right[2] * right[2]);
    for (int c = 0; c < 3; c++)
        right[c] /= length;
    vec3_cross(right, camera->direction, up);
    struct bvh_ray ray = {.t_max = INFINITY, .ignore = {UINT32_MAX, UINT32_MAX}};
    for (int c = 0; c < 3; c++) {
        ray.origin[c] = camera->position[c];
        ray.direction[c] = camera->direction[c] + half * (across * right[c] + upwards * up[c]);
    }
    return ray;
}

// Intersects a disc; see shaders/lib/intersect_shape.glsl.
static double intersect_disc(const void *context, uint32_t index, const struct bvh_ray *ray)
{
    const struct flat_scene *flat = context;
    const struct flat_shape *shape = &flat->shapes[index];
    double height = 0.0, slope = 0.0, distance2 = 0.0;
    for (int c = 0; c < 3; c++) {
        height += (shape->center[c] - ray->origin[c]) * shape->normal[c];
        slope += ray->direction[c] * shape->normal[c];
    }
    double t = height / slope;
    for (int c = 0; c < 3; c++) {
        double from_center = ray->origin[c] + t * ray->direction[c] - shape->center[c];
        distance2 += from_center * from_center;
    }
    return distance2 <= (double)shape->radius * shape->radius && t < ray->t_max ? t : -1.0;
}

// Returns the emission of the first surface on the ray.
static void trace_emission(const struct scene *scene, const struct flat_scene *flat,
                           const struct bvh *bvh, uint32_t x, uint32_t y, float emission[3])
{
    const void *vertices = flat->triangles;
    const struct bvh_params geometry = {.triangle_vertices = vertices,
                                        .triangle_stride = sizeof *flat->triangles,
                                        .triangle_count = flat->triangle_count};
    const struct bvh_trace_scene trace = {.bvh = bvh,
                                          .geometry = &geometry,
                                          .intersect_shape = intersect_disc,
                                          .shape_context = flat};
    const struct bvh_ray ray = camera_ray(scene, x, y);
    struct bvh_hit hit;
    bvh_trace_closest(&trace, &ray, &hit);
    memset(emission, 0, 3 * sizeof *emission);
    if (hit.primitive == UINT32_MAX)
        return;
    uint32_t material = hit.primitive & BVH_LEAF_SHAPE
                            ? flat->shapes[hit.primitive & ~BVH_LEAF_SHAPE].material
                            : flat->triangles[hit.primitive].material;
    memcpy(emission, scene->materials[material].emission, 3 * sizeof *emission);
}

// --- tests ---------------------------------------------------------------------------------------

// Each material emits a colour of its own, so the picture shows what the camera's rays hit.
TEST(hits_equal_the_reference)
{
    const struct scene_override glowing[] = {{"settings.max_bounces", "0"},
                                             {"materials.lowest.emission", "[1, 0, 0]"},
                                             {"materials.others.emission", "[0, 1, 0]"},
                                             {"materials.floor.emission", "[0, 0, 1]"},
                                             {"materials.wall.emission", "[1, 1, 0]"},
                                             {0}};
    struct scene scene;
    struct gpu gpu;
    struct renderer r;
    struct arena arena = {0};
    struct film_image film;
    struct err err = {0};
    OPEN_GPU(&gpu, 0);
    uint32_t count = pile_size(&gpu);
    REQUIRE_OK(load_pile(glowing, count, &scene, &err));
    const struct renderer_params params = {.gpu = &gpu, .scene = &scene};
    const struct render_call call = {.samples = 1};
    REQUIRE_OK(renderer_create(&params, &r, &err));
    CHECK(r.flat.triangle_count == count + 4, "%u triangles", r.flat.triangle_count);
    REQUIRE_OK(renderer_render(&r, &call, &err) && renderer_read(&r, &arena, &film, &err));
    CHECK(r.stats.suspended > 0, "no traversal was continued");
    uint32_t of_the_pile = 0;
    for (uint32_t y = 0; y < film.height; y++) {
        for (uint32_t x = 0; x < film.width; x++) {
            float expected[3], *seen = film.mean[y * film.width + x];
            trace_emission(&scene, &r.flat, &r.bvh, x, y, expected);
            CHECK(memcmp(seen, expected, sizeof expected) == 0,
                  "pixel %u, %u: %g %g %g, expected %g %g %g", x, y, seen[0], seen[1], seen[2],
                  expected[0], expected[1], expected[2]);
            of_the_pile += memcmp(expected, scene.materials[0].emission, sizeof expected) == 0;
        }
    }
    CHECK(of_the_pile >= 20 && of_the_pile <= 200, "%u pixels show the pile", of_the_pile);
    arena_finish(&arena);
    renderer_finish(&r);
    scene_finish(&scene);
    gpu_close(&gpu);
}

// With shadow rays and bounces through the triangles, the picture has the same bits as with the
// lowest triangle alone.
TEST(looks_like_its_lowest_triangle)
{
    struct gpu gpu;
    struct arena arena = {0};
    struct film_image films[2];
    struct err err = {0};
    OPEN_GPU(&gpu, 0);
    const uint32_t counts[2] = {1, pile_size(&gpu)};
    for (int i = 0; i < 2; i++) {
        struct scene scene;
        struct render_stats stats;
        REQUIRE_OK(load_pile(NULL, counts[i], &scene, &err));
        const struct renderer_params params = {.gpu = &gpu, .scene = &scene};
        REQUIRE_OK(render_film(&params, PILE_SAMPLES, &arena, &films[i], &stats, &err));
        CHECK((stats.suspended > 0) == (counts[i] > 1), "%u triangles: %u continuations", counts[i],
              (unsigned)stats.suspended);
        CHECK(stats.shadow_rays > 0, "no shadow rays");
        scene_finish(&scene);
    }
    size_t bytes = (size_t)films[0].width * films[0].height * sizeof *films[0].mean;
    CHECK(memcmp(films[0].mean, films[1].mean, bytes) == 0, "the pictures differ");
    arena_finish(&arena);
    gpu_close(&gpu);
}

// The number of triangles just exceeds the steps of one dispatch.
TEST(validation_is_silent)
{
    struct scene scene;
    struct gpu gpu;
    struct arena arena = {0};
    struct film_image film;
    struct render_stats stats;
    struct err err = {0};
    OPEN_GPU(&gpu, .validation = true);
    REQUIRE_OK(load_pile(NULL, SMALL_PILE, &scene, &err));
    const struct renderer_params params = {.gpu = &gpu, .scene = &scene};
    REQUIRE_OK(render_film(&params, 1, &arena, &film, &stats, &err));
    CHECK(!gpu.info.is_cpu || stats.suspended > 0, "no traversal was continued");
    CHECK(gpu.validation_messages == 0, "%u messages", gpu.validation_messages);
    arena_finish(&arena);
    scene_finish(&scene);
    gpu_close(&gpu);
}

TEST_MAIN(TEST_CASE(hits_equal_the_reference), TEST_CASE(looks_like_its_lowest_triangle),
          TEST_CASE(validation_is_silent))
