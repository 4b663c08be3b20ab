// Tests geometry that several renderers share, that follows changes of the scene, and that leaves
// out hidden objects.
#include "flatten/geometry.h"
#include "render/tables/camera_media.h"
#include "render_fixture.h"

#define SAMPLES 2u

static const struct scene_override small[] = {
    {"film.width", "40"}, {"film.height", "30"}, {"settings.max_bounces", "4"}, {0}};

static bool same_picture(const struct film_image *a, const struct film_image *b)
{
    size_t pixels = (size_t)a->width * a->height;
    return a->width == b->width && a->height == b->height &&
           memcmp(a->mean, b->mean, pixels * sizeof *a->mean) == 0 &&
           memcmp(a->samples, b->samples, pixels * sizeof *a->samples) == 0;
}

static bool is_lit(const struct film_image *film)
{
    size_t lit = 0, pixels = (size_t)film->width * film->height;
    for (size_t i = 0; i < pixels; i++)
        lit += film->mean[i][0] + film->mean[i][1] + film->mean[i][2] > 0.0f;
    return lit > pixels / 4;
}

// --- what is hidden ------------------------------------------------------------------------------

struct hiding {
    const char *path;
    enum instancing instancing;
    uint32_t one_of; // number of instances, and of shapes, that one hides
    uint32_t from;   // index of the first one
};

static const struct hiding hidings[] = {
    {"scenes/all_classes.json", INSTANCING_AUTO, 3, 2},
    {"scenes/glow_worms.json", INSTANCING_AUTO, 2, 1},
    {"scenes/teapots.json", INSTANCING_ON, 3, 0},
    {"scenes/teapots.json", INSTANCING_OFF, 3, 2},
    {"scenes/sdf_csg.json", INSTANCING_AUTO, 4, 3},
};

static bool is_hidden(const struct hiding *h, uint32_t i)
{
    return i % h->one_of == h->from;
}

static void hide(const struct hiding *h, struct scene *scene)
{
    for (uint32_t i = 0; i < scene->instance_count; i++)
        scene->instances[i].hidden = is_hidden(h, i);
    for (uint32_t i = 0; i < scene->shape_count; i++)
        scene->shapes[i].hidden = is_hidden(h, i);
}

// Returns the scene without the objects that hide() hides. *objects maps its objects plus 1, and 0,
// to those of the whole scene.
static struct scene remove_hidden(const struct hiding *h, const struct scene *scene,
                                  struct arena *arena, uint32_t **objects)
{
    struct scene out = *scene;
    out.instances = ARENA_NEW(arena, struct instance, scene->instance_count);
    out.shapes = ARENA_NEW(arena, struct shape, scene->shape_count);
    *objects = ARENA_NEW(arena, uint32_t, 1 + (size_t)scene->instance_count + scene->shape_count);
    out.instance_count = out.shape_count = 0;
    uint32_t *object = *objects + 1;
    for (uint32_t i = 0; i < scene->instance_count; i++)
        if (!is_hidden(h, i)) {
            out.instances[out.instance_count] = scene->instances[i];
            out.instances[out.instance_count++].hidden = false;
            *object++ = i + 1;
        }
    for (uint32_t i = 0; i < scene->shape_count; i++)
        if (!is_hidden(h, i)) {
            out.shapes[out.shape_count] = scene->shapes[i];
            out.shapes[out.shape_count++].hidden = false;
            *object++ = scene->instance_count + i + 1;
        }
    return out;
}

static void check_ids(const struct film_image *hidden, const struct film_image *removed,
                      const uint32_t *objects, const char *path)
{
    size_t pixels = (size_t)hidden->width * hidden->height, wrong = 0, seen = 0;
    for (size_t i = 0; i < pixels; i++) {
        const uint32_t *have = hidden->aovs.ids[i], *want = removed->aovs.ids[i];
        seen += want[0] > 0;
        wrong += have[0] != objects[want[0]] || have[1] != want[1] || have[2] != want[2];
    }
    CHECK(wrong == 0 && seen > 0, "%s: %zu of %zu pixels have wrong numbers", path, wrong, pixels);
}

static void check_hiding(struct gpu *gpu, const struct hiding *h)
{
    struct arena arena = {0};
    struct scene scene;
    struct film_image whole, hidden, removed;
    uint32_t *objects;
    struct err err = {0};
    struct renderer_params params = {
        .gpu = gpu, .scene = &scene, .instancing = h->instancing, .aovs = AOV_IDS};
    REQUIRE_OK(load_scene(h->path, small, &scene, &err));
    REQUIRE_OK(render_film(&params, SAMPLES, &arena, &whole, NULL, &err));
    hide(h, &scene);
    REQUIRE_OK(render_film(&params, SAMPLES, &arena, &hidden, NULL, &err));
    const struct scene less = remove_hidden(h, &scene, &arena, &objects);
    params.scene = &less;
    REQUIRE_OK(render_film(&params, SAMPLES, &arena, &removed, NULL, &err));
    CHECK(less.instance_count + less.shape_count < scene.instance_count + scene.shape_count,
          "%s: nothing is hidden", h->path);
    CHECK(same_picture(&hidden, &removed), "%s: hiding is not removing", h->path);
    CHECK(!same_picture(&whole, &hidden) && is_lit(&hidden), "%s: hiding shows nothing", h->path);
    check_ids(&hidden, &removed, objects, h->path);
    arena_finish(&arena);
    scene_finish(&scene);
}

TEST(hiding_is_removing)
{
    struct gpu gpu;
    OPEN_GPU(&gpu, .validation = true);
    for (size_t i = 0; i < sizeof hidings / sizeof *hidings; i++)
        check_hiding(&gpu, &hidings[i]);
    CHECK(gpu.validation_messages == 0, "%u messages", gpu.validation_messages);
    gpu_close(&gpu);
}

// Only the environment is left.
TEST(all_can_be_hidden)
{
    const struct hiding all = {.one_of = 1};
    struct arena arena = {0};
    struct scene scene;
    struct gpu gpu;
    struct film_image film;
    struct err err = {0};
    OPEN_GPU(&gpu, .validation = true);
    REQUIRE_OK(load_scene("scenes/all_classes.json", small, &scene, &err));
    hide(&all, &scene);
    const struct renderer_params params = {.gpu = &gpu, .scene = &scene, .aovs = AOV_IDS};
    REQUIRE_OK(render_film(&params, SAMPLES, &arena, &film, NULL, &err));
    size_t wrong = 0;
    for (size_t i = 0; i < (size_t)film.width * film.height; i++)
        for (int c = 0; c < 3; c++)
            wrong += film.mean[i][c] != scene.environment.radiance[c] || film.aovs.ids[i][c] != 0;
    CHECK(wrong == 0, "%zu values are not the surroundings'", wrong);
    CHECK(gpu.validation_messages == 0, "%u messages", gpu.validation_messages);
    arena_finish(&arena);
    scene_finish(&scene);
    gpu_close(&gpu);
}

// --- what is shared ------------------------------------------------------------------------------

// Two renderers exist at the same time. The first is finished before the second continues.
TEST(sharing_changes_no_bit)
{
    struct arena arena = {0};
    struct scene scene;
    struct gpu gpu;
    struct geometry geometry = {0};
    struct renderer first, second;
    struct film_image own, shared[2];
    struct err err = {0};
    const struct render_call call = {.samples = SAMPLES};
    OPEN_GPU(&gpu, .validation = true);
    REQUIRE_OK(load_scene("scenes/teapots.json", small, &scene, &err));
    struct renderer_params params = {.gpu = &gpu, .scene = &scene, .instancing = INSTANCING_ON};
    REQUIRE_OK(render_film(&params, SAMPLES, &arena, &own, NULL, &err));
    REQUIRE_OK(geometry_create(
        &(struct geometry_params){.scene = &scene, .instancing = INSTANCING_ON}, &geometry, &err));
    params.geometry = &geometry;
    params.instancing = INSTANCING_OFF; // this has no effect
    REQUIRE_OK(renderer_create(&params, &first, &err));
    REQUIRE_OK(renderer_create(&params, &second, &err));
    CHECK(first.flat.triangles == second.flat.triangles && first.bvh.nodes == geometry.bvh.nodes,
          "geometry was copied");
    REQUIRE_OK(renderer_render(&first, &call, &err) &&
               renderer_read(&first, &arena, &shared[0], &err));
    renderer_finish(&first);
    REQUIRE_OK(renderer_render(&second, &call, &err) &&
               renderer_read(&second, &arena, &shared[1], &err));
    renderer_finish(&second);
    CHECK(same_picture(&own, &shared[0]) && same_picture(&own, &shared[1]), "pictures differ");
    CHECK(is_lit(&own), "the picture is dark");
    CHECK(gpu.validation_messages == 0, "%u messages", gpu.validation_messages);
    geometry_finish(&geometry);
    geometry_finish(NULL);
    arena_finish(&arena);
    scene_finish(&scene);
    gpu_close(&gpu);
}

// --- what changes --------------------------------------------------------------------------------

// The part of the geometry that a change makes new.
enum renewed { NOTHING, ARRAYS, HIERARCHY };
struct change {
    const char *name;
    void (*make)(struct scene *scene);
    enum renewed renewed;
    bool is_rendered;
};

static struct material *material_of(struct scene *scene, const char *name)
{
    for (uint32_t i = 0; i < scene->material_count; i++)
        if (strcmp(scene->materials[i].name, name) == 0)
            return &scene->materials[i];
    return NULL;
}

// The instance of the first pot; the room's walls and lamps precede it.
#define POT 4

static struct material *material_of_pot(struct scene *scene)
{
    const struct instance *instance = &scene->instances[POT];
    uint32_t index = instance->material != SCENE_NONE ? instance->material
                                                      : scene->meshes[instance->mesh].material;
    return &scene->materials[index];
}

static void change_nothing(struct scene *scene)
{
    (void)scene;
}

static void change_color(struct scene *scene)
{
    material_of_pot(scene)->parameters[PARAMETER_BASE_COLOR] *= 0.5f;
}

static void change_class(struct scene *scene)
{
    material_of_pot(scene)->model = MATERIAL_MIRROR;
}

static void change_light(struct scene *scene)
{
    material_of(scene, "key")->parameters[PARAMETER_EMISSION] *= 3.0f;
}

static void change_assignment(struct scene *scene)
{
    scene->instances[0].material = (uint32_t)(material_of(scene, "floor") - scene->materials);
    scene->shapes[0].material = (uint32_t)(material_of(scene, "pot-1") - scene->materials);
}

static void change_tangents(struct scene *scene)
{
    material_of(scene, "pot-2")->anisotropic = 0.5f;
}

static void change_visibility(struct scene *scene)
{
    scene->shapes[1].hidden = !scene->shapes[1].hidden;
}

static void change_mesh_visibility(struct scene *scene)
{
    scene->instances[POT].hidden = !scene->instances[POT].hidden;
}

static void change_place(struct scene *scene)
{
    scene->instances[POT].transform[1][3] += 0.05;
}

static void change_shape(struct scene *scene)
{
    scene->shapes[scene->shape_count - 1].center[0] += 0.05;
}

// The mesh is then no longer shared.
static void change_to_emitter(struct scene *scene)
{
    material_of_pot(scene)->model = MATERIAL_LAMBERT;
    for (int c = 0; c < 3; c++)
        material_of_pot(scene)->parameters[PARAMETER_EMISSION + c] = 2.0f;
}

static const struct change changes[] = {
    {"nothing", change_nothing, NOTHING},
    {"a colour", change_color, NOTHING},
    {"a model", change_class, NOTHING, true},
    {"a lamp", change_light, NOTHING, true},
    {"materials", change_assignment, ARRAYS},
    {"tangents", change_tangents, ARRAYS, true},
    {"hidden", change_visibility, HIERARCHY},
    {"shown", change_visibility, HIERARCHY},
    {"a hidden mesh", change_mesh_visibility, HIERARCHY, true},
    {"a shown mesh", change_mesh_visibility, HIERARCHY},
    {"a transform", change_place, HIERARCHY},
    {"a shape", change_shape, HIERARCHY},
    {"a mesh that emits", change_to_emitter, HIERARCHY, true},
    {"a mesh that has emitted", change_color, NOTHING},
};

// Renders before the change, then with the refreshed geometry, and with newly built geometry.
static void check_change(struct gpu *gpu, struct scene *scene, const struct change *change,
                         const struct geometry_params *shape, struct geometry *geometry)
{
    struct arena arena = {0};
    struct film_image followed, anew;
    struct err err = {0};
    struct renderer_params params = {
        .gpu = gpu, .scene = scene, .geometry = geometry, .instancing = shape->instancing};
    // The nodes' address is compared, because rebuilt nodes may have the same content.
    const struct bvh_node *nodes = geometry->bvh.nodes;
    const struct flat_triangle *triangles = geometry->flat.triangles;
    change->make(scene);
    REQUIRE_OK(geometry_refresh(shape, geometry, &err));
    enum renewed renewed = geometry->bvh.nodes != nodes            ? HIERARCHY
                           : geometry->flat.triangles != triangles ? ARRAYS
                                                                   : NOTHING;
    CHECK(renewed == change->renewed, "%s: %d was made anew", change->name, renewed);
    if (!change->is_rendered)
        return;
    REQUIRE_OK(render_film(&params, SAMPLES, &arena, &followed, NULL, &err));
    params.geometry = NULL;
    REQUIRE_OK(render_film(&params, SAMPLES, &arena, &anew, NULL, &err));
    CHECK(same_picture(&followed, &anew) && is_lit(&anew), "%s: the picture is another",
          change->name);
    arena_finish(&arena);
}

// Adds two spheres on the floor.
static void add_spheres(struct scene *scene)
{
    for (int i = 0; i < 2; i++) {
        struct shape *sphere = scene_add_shape(scene, NULL);
        if (sphere)
            *sphere = (struct shape){
                .kind = SHAPE_SPHERE, .center = {2.0 * i - 1.0, 0.1, 1.0}, .radius = 0.1};
    }
}

static void check_changes(enum instancing instancing)
{
    struct scene scene;
    struct gpu gpu;
    struct geometry geometry;
    struct err err = {0};
    OPEN_GPU(&gpu, .validation = instancing == INSTANCING_ON);
    REQUIRE_OK(load_scene("scenes/teapots.json", small, &scene, &err));
    add_spheres(&scene);
    const struct geometry_params params = {.scene = &scene, .instancing = instancing};
    REQUIRE_OK(geometry_create(&params, &geometry, &err));
    CHECK((geometry.flat.placed_count > 0) == (instancing == INSTANCING_ON), "wrong levels");
    for (size_t i = 0; i < sizeof changes / sizeof *changes; i++) {
        struct change change = changes[i];
        // A mesh that is not shared stays in place when it begins to emit.
        if (change.make == change_to_emitter && instancing == INSTANCING_OFF)
            change.renewed = ARRAYS;
        change.is_rendered &= instancing == INSTANCING_ON;
        check_change(&gpu, &scene, &change, &params, &geometry);
    }
    CHECK(gpu.validation_messages == 0, "%u messages", gpu.validation_messages);
    geometry_finish(&geometry);
    scene_finish(&scene);
    gpu_close(&gpu);
}

TEST(follows_changes)
{
    check_changes(INSTANCING_ON);
}

TEST(follows_changes_of_one_level)
{
    check_changes(INSTANCING_OFF);
}

TEST(another_method_builds_anew)
{
    struct scene scene;
    struct geometry geometry;
    struct err err = {0};
    REQUIRE_OK(load_scene("scenes/cornell.json", small, &scene, &err));
    struct geometry_params params = {.scene = &scene};
    REQUIRE_OK(geometry_create(&params, &geometry, &err));
    params.bvh.format = BVH_FLOAT;
    REQUIRE_OK(geometry_refresh(&params, &geometry, &err));
    CHECK(geometry.bvh.format == BVH_FLOAT && geometry.bvh.nodes_float, "the hierarchy was kept");
    geometry_finish(&geometry);
    scene_finish(&scene);
}

TEST(a_failure_leaves_nothing)
{
    struct scene scene;
    struct geometry geometry;
    struct err err = {0};
    REQUIRE_OK(load_scene("scenes/cornell.json", small, &scene, &err));
    struct geometry_params params = {.scene = &scene};
    REQUIRE_OK(geometry_create(&params, &geometry, &err));
    scene.instances[0].transform[0][3] = 1e30;
    CHECK(!geometry_refresh(&params, &geometry, &err) && err.code == ERR_INPUT, "it was taken");
    CHECK(!geometry.bvh.nodes && !geometry.flat.triangles && geometry.flat_arena.used_bytes == 0,
          "something is left");
    geometry_finish(&geometry);
    scene_finish(&scene);
}

// --- what the camera is in -----------------------------------------------------------------------

#define MEDIA 2u // the glass of the pots, and that of other objects
#define POINTS 160

// Compares media found by the hierarchy, and with every triangle, as for places that are ambiguous.
static void compare_media(const struct scene *scene, enum instancing instancing, bool *found)
{
    struct geometry geometry;
    struct err err = {0};
    struct gpu_material materials[16] = {{0}};
    REQUIRE(scene->material_count <= 16, "%u materials", scene->material_count);
    for (uint32_t i = 0; i < scene->material_count; i++)
        materials[i].medium = strncmp(scene->materials[i].name, "pot", 3) == 0 ? 1 : MEDIA;
    const struct geometry_params params = {.scene = scene, .instancing = instancing};
    REQUIRE_OK(geometry_create(&params, &geometry, &err));
    struct bvh split = geometry.bvh;
    split.reference_count++;
    struct camera camera = scene->cameras[0];
    struct shading_tables_params tables = {
        .scene = scene, .flat = &geometry.flat, .camera = &camera};
    uint32_t wrong = 0;
    for (int i = 0; i < POINTS; i++) {
        // Places around the first and the second pot.
        camera.position[0] = -2.8 + 1.6 * (i % 20) / 20.0;
        camera.position[1] = 0.02 + 0.5 * (i / 20 % 4) / 4.0;
        camera.position[2] = i < POINTS / 2 ? -0.3 : 0.0;
        camera.direction[0] = 0.1 * (i % 7 - 3);
        tables.bvh = &geometry.bvh;
        uint32_t quick = camera_media_find(&tables, materials);
        tables.bvh = &split;
        wrong += quick != camera_media_find(&tables, materials);
        found[quick != 0] = true;
    }
    CHECK(wrong == 0, "%u of %d points differ", wrong, POINTS);
    geometry_finish(&geometry);
}

TEST(media_around_the_camera)
{
    struct scene scene;
    struct err err = {0};
    bool found[2] = {false, false};
    REQUIRE_OK(load_scene("scenes/teapots.json", small, &scene, &err));
    compare_media(&scene, INSTANCING_OFF, found);
    compare_media(&scene, INSTANCING_ON, found);
    CHECK(found[0] && found[1], "all points are in the same");
    scene_finish(&scene);
}

TEST_MAIN(TEST_CASE(hiding_is_removing), TEST_CASE(all_can_be_hidden),
          TEST_CASE(sharing_changes_no_bit), TEST_CASE(follows_changes),
          TEST_CASE(follows_changes_of_one_level), TEST_CASE(another_method_builds_anew),
          TEST_CASE(a_failure_leaves_nothing), TEST_CASE(media_around_the_camera))
