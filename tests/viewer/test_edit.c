#include "scene/core/affine.h"
#include "scene/core/environment.h"
#include "test.h"
#include "viewer/core/edit.h"
#include "viewer/core/lamps.h"
#include "viewer/core/viewer.h"

// --- a viewer with a scene of everything ---------------------------------------------------------

static struct viewer viewer;

static bool set_up(void)
{
    struct err err = {0};
    memset(&viewer, 0, sizeof viewer);
    struct scene *scene = &viewer.document.scene;
    bool ok = history_create(&viewer.document.history, &err) && scene_add_material(scene, NULL) &&
              scene_add_material(scene, NULL) && scene_add_light(scene, NULL) &&
              scene_add_instance(scene, NULL) && scene_add_shape(scene, NULL);
    if (!ok)
        return false;
    material_init(&scene->materials[0]);
    material_init(&scene->materials[1]);
    scene->shapes[0] = (struct shape){.kind = SHAPE_SPHERE, .radius = 1};
    scene->environment = (struct environment){.present = true, .radiance = {1, 1, 1}};
    viewer.document.original = surroundings_keep(scene);
    viewer.document.surroundings = surroundings_default();
    for (uint32_t side = 0; side < VIEWER_SIDES; side++)
        viewer.stage.sides[side].method.settings = settings_default();
    viewer.view.camera = (struct camera){.direction = {0, 0, -1}, .up = {0, 1, 0}, .fov_y = 1};
    return true;
}

static void tear_down(void)
{
    history_destroy(viewer.document.history);
    arena_finish(&viewer.document.surroundings_arena);
    scene_finish(&viewer.document.scene);
}

// Returns the change that was requested since the last call.
static enum change asked(uint32_t side)
{
    enum change change = viewer.stage.changes[side];
    viewer.stage.changes[side] = CHANGE_NONE;
    return change;
}

static struct material rough(float roughness)
{
    struct material material = viewer.document.scene.materials[1];
    material.roughness = roughness;
    return material;
}

// --- tests ---------------------------------------------------------------------------------------

TEST(no_difference_is_no_step)
{
    REQUIRE(set_up());
    struct material same = viewer.document.scene.materials[1];
    CHECK(edit_material(&viewer, 1, &same, "material.roughness"));
    CHECK(edit_camera(&viewer, &viewer.view.camera, "keys.camera"));
    CHECK(edit_surroundings(&viewer, &viewer.document.surroundings, "scene.strength"));
    CHECK(edit_visible(&viewer, 1, true, "object.visible"));
    CHECK(asked(0) == CHANGE_NONE);
    CHECK(edit_undo_count(&viewer) == 0 && !edit_undo_name(&viewer));
    tear_down();
}

TEST(undo_restores_every_bit)
{
    REQUIRE(set_up());
    struct material before = viewer.document.scene.materials[1];
    struct light light = viewer.document.scene.lights[0];
    struct camera camera = viewer.view.camera;
    struct material material = rough(0.25f);
    edit_material(&viewer, 1, &material, "material.roughness");
    edit_close(&viewer);
    struct light other = light;
    other.position[1] = 7;
    edit_light(&viewer, 0, &other, "light.position");
    struct camera moved = camera;
    moved.position[2] = 1e-300;
    edit_camera(&viewer, &moved, "keys.camera");
    edit_visible(&viewer, 0, false, "object.visible");
    edit_visible(&viewer, 1, false, "object.visible");
    CHECK(viewer.document.scene.instances[0].hidden && viewer.document.scene.shapes[0].hidden);
    CHECK(edit_undo_count(&viewer) == 5, "%u", edit_undo_count(&viewer));
    for (int i = 0; i < 5; i++)
        CHECK(edit_undo(&viewer));
    CHECK(!edit_undo(&viewer));
    CHECK(memcmp(&viewer.document.scene.materials[1], &before, sizeof before) == 0);
    CHECK(memcmp(&viewer.document.scene.lights[0], &light, sizeof light) == 0);
    CHECK(memcmp(&viewer.view.camera, &camera, sizeof camera) == 0);
    CHECK(!viewer.document.scene.instances[0].hidden && !viewer.document.scene.shapes[0].hidden);
    for (int i = 0; i < 5; i++)
        CHECK(edit_redo(&viewer));
    CHECK(!edit_redo(&viewer));
    CHECK(memcmp(&viewer.document.scene.materials[1], &material, sizeof before) == 0);
    CHECK(memcmp(&viewer.view.camera, &moved, sizeof camera) == 0);
    tear_down();
}

TEST(a_drag_is_one_step)
{
    REQUIRE(set_up());
    struct material before = viewer.document.scene.materials[1];
    for (int i = 1; i <= 50; i++) {
        struct material material = rough((float)i / 64);
        edit_material(&viewer, 1, &material, "material.roughness");
    }
    CHECK(edit_undo_count(&viewer) == 1);
    edit_close(&viewer);
    struct material material = rough(1);
    edit_material(&viewer, 1, &material, "material.roughness");
    CHECK(edit_undo_count(&viewer) == 2, "a new drag is a new step");
    material.metallic = 1;
    edit_material(&viewer, 1, &material, "material.metallic");
    CHECK(edit_undo_count(&viewer) == 3, "another control is a new step");
    CHECK(strcmp(edit_undo_name(&viewer), "material.metallic") == 0);
    edit_undo(&viewer);
    edit_undo(&viewer);
    CHECK(viewer.document.scene.materials[1].roughness == 50.0f / 64);
    edit_undo(&viewer);
    CHECK(memcmp(&viewer.document.scene.materials[1], &before, sizeof before) == 0);
    tear_down();
}

TEST(a_drag_back_to_its_start_is_no_step)
{
    REQUIRE(set_up());
    struct material before = viewer.document.scene.materials[1], material = rough(0.7f);
    edit_material(&viewer, 1, &material, "material.roughness");
    edit_material(&viewer, 1, &before, "material.roughness");
    edit_close(&viewer);
    CHECK(edit_undo_count(&viewer) == 0 && edit_redo_count(&viewer) == 0);
    tear_down();
}

TEST(what_is_edited_after_undo_ends_redo)
{
    REQUIRE(set_up());
    struct material material = rough(0.25f);
    edit_material(&viewer, 1, &material, "a");
    edit_close(&viewer);
    material = rough(0.5f);
    edit_material(&viewer, 1, &material, "a");
    edit_undo(&viewer);
    CHECK(edit_redo_count(&viewer) == 1);
    material = rough(0.75f);
    edit_material(&viewer, 1, &material, "a");
    CHECK(edit_redo_count(&viewer) == 0 && edit_undo_count(&viewer) == 2);
    CHECK(viewer.document.scene.materials[1].roughness == 0.75f);
    tear_down();
}

TEST(no_more_is_asked_for_than_is_needed)
{
    REQUIRE(set_up());
    struct material material = rough(0.25f);
    edit_material(&viewer, 1, &material, "a");
    CHECK(asked(0) == CHANGE_TABLES && asked(1) == CHANGE_TABLES);
    struct light light = viewer.document.scene.lights[0];
    light.radiant[0] = 3;
    edit_light(&viewer, 0, &light, "a");
    CHECK(asked(0) == CHANGE_METHOD && asked(1) == CHANGE_METHOD);
    edit_visible(&viewer, 0, false, "a");
    CHECK(asked(0) == CHANGE_GEOMETRY && asked(1) == CHANGE_GEOMETRY);
    struct camera camera = viewer.view.camera;
    camera.fov_y = 0.5;
    edit_camera(&viewer, &camera, "a");
    CHECK(asked(0) == CHANGE_CAMERA && asked(1) == CHANGE_CAMERA);
    struct method method = viewer.stage.sides[1].method;
    method.settings.max_bounces = 2;
    edit_method(&viewer, 1, &method, "a");
    CHECK(asked(0) == CHANGE_NONE && asked(1) == CHANGE_METHOD, "the other side goes on");
    method.fresh_frames = true;
    method.samples_a_frame = 3;
    edit_method(&viewer, 1, &method, "a");
    CHECK(asked(0) == CHANGE_NONE && asked(1) == CHANGE_SHOWN);
    edit_undo(&viewer);
    CHECK(asked(1) == CHANGE_METHOD, "one drag of one control: both changes at once");
    tear_down();
}

TEST(what_is_shown_keeps_what_is_accumulated)
{
    REQUIRE(set_up());
    viewer.stage.sides[0].is_ready = viewer.stage.sides[1].is_ready = true;
    viewer.stage.sides[1].method.settings.sampler = SAMPLER_GRID;
    struct shown shown = viewer.stage.shown;
    shown.exposure = 2;
    edit_shown(&viewer, &shown, "view.exposure");
    CHECK(asked(0) == CHANGE_SHOWN && asked(1) == CHANGE_SHOWN);
    shown.spp_limit = 64;
    edit_shown(&viewer, &shown, "renderer.spp");
    CHECK(asked(0) == CHANGE_LIMIT, "more samples of the same");
    CHECK(asked(1) == CHANGE_METHOD, "a grid has other samples where there are more");
    viewer.stage.sides[1].method.settings.sampler = SAMPLER_BLUE_NOISE;
    shown.spp_limit = 128;
    edit_shown(&viewer, &shown, "renderer.spp");
    CHECK(asked(1) == CHANGE_METHOD, "and so has a blue-noise sampler");
    shown.what = SHOWN_ALBEDO;
    viewer.stage.sides[1].job.renderer.aovs = AOV_ALBEDO;
    edit_shown(&viewer, &shown, "view.aov");
    CHECK(asked(0) == CHANGE_METHOD, "has no albedo so far");
    CHECK(asked(1) == CHANGE_SHOWN);
    tear_down();
}

TEST(surroundings_come_and_go_with_the_sun)
{
    REQUIRE(set_up());
    struct light first = viewer.document.scene.lights[0];
    struct environment environment = viewer.document.scene.environment;
    struct surroundings sky = viewer.document.surroundings;
    sky.kind = SURROUNDINGS_SKY;
    REQUIRE(edit_surroundings(&viewer, &sky, "scene.kind"), "%s", viewer.shell.message);
    CHECK(viewer.document.scene.light_count == 2, "%u", viewer.document.scene.light_count);
    CHECK(viewer.document.scene.environment.texels != NULL);
    struct light sun = viewer.document.scene.lights[1];
    sun.radiant[0] = 123;
    edit_light(&viewer, 1, &sun, "light.colour");
    sky.rotation_degrees = 90;
    REQUIRE(edit_surroundings(&viewer, &sky, "scene.rotation"));
    CHECK(viewer.document.scene.lights[1].radiant[0] != 123, "a new sky has its own sun");
    edit_undo(&viewer);
    CHECK(viewer.document.scene.light_count == 2 &&
              memcmp(&viewer.document.scene.lights[1], &sun, sizeof sun) == 0,
          "the edited sun is there again");
    edit_undo(&viewer);
    edit_undo(&viewer);
    CHECK(viewer.document.scene.light_count == 1);
    CHECK(memcmp(&viewer.document.scene.environment, &environment, sizeof environment) == 0);
    CHECK(memcmp(&viewer.document.scene.lights[0], &first, sizeof first) == 0);
    tear_down();
}

TEST(a_file_that_is_not_there_changes_nothing)
{
    REQUIRE(set_up());
    struct scene before = viewer.document.scene;
    struct surroundings image = viewer.document.surroundings;
    image.kind = SURROUNDINGS_IMAGE;
    CHECK(!edit_surroundings(&viewer, &image, "scene.kind"));
    CHECK(strstr(viewer.shell.message, "no image"), "%s", viewer.shell.message);
    strcpy(image.image, "/nowhere/sky.hdr");
    CHECK(!edit_surroundings(&viewer, &image, "scene.image"));
    CHECK(strstr(viewer.shell.message, "/nowhere/sky.hdr"), "%s", viewer.shell.message);
    CHECK(memcmp(&viewer.document.scene.environment, &before.environment,
                 sizeof before.environment) == 0);
    CHECK(viewer.document.scene.light_count == before.light_count);
    CHECK(viewer.document.scene.hash == before.hash);
    CHECK(edit_undo_count(&viewer) == 0 && viewer.stage.changes[0] == CHANGE_NONE);
    tear_down();
}

TEST(reverting_leaves_no_trace)
{
    REQUIRE(set_up());
    struct material before = viewer.document.scene.materials[1], material = rough(0.25f);
    CHECK(!edit_revert(&viewer));
    edit_material(&viewer, 1, &material, "a");
    edit_close(&viewer);
    CHECK(edit_revert(&viewer));
    CHECK(memcmp(&viewer.document.scene.materials[1], &before, sizeof before) == 0);
    CHECK(edit_undo_count(&viewer) == 0 && edit_redo_count(&viewer) == 0);
    edit_material(&viewer, 1, &material, "a");
    edit_settle(&viewer);
    CHECK(!edit_revert(&viewer), "it was had");
    tear_down();
}

TEST(what_is_placed_comes_back)
{
    REQUIRE(set_up());
    struct shape shape = viewer.document.scene.shapes[0];
    struct placement to = placement_none(shape.center);
    asked(0);
    for (int i = 1; i <= 3; i++) { // changes of a single drag
        to.move[1] = i;
        REQUIRE(edit_place(&viewer, 1, &to, "object.position"), "%s", viewer.shell.message);
    }
    CHECK(asked(0) == CHANGE_GEOMETRY && edit_undo_count(&viewer) == 1);
    CHECK(viewer.document.scene.shapes[0].center[1] == 3);
    edit_undo(&viewer);
    CHECK(memcmp(&viewer.document.scene.shapes[0], &shape, sizeof shape) == 0);
    edit_redo(&viewer);
    CHECK(viewer.document.scene.shapes[0].center[1] == 3);
    to.scale[0] = 2; // scales a sphere along one axis
    CHECK(!edit_place(&viewer, 1, &to, "object.scale") && edit_undo_count(&viewer) == 1);
    CHECK(viewer.document.scene.shapes[0].center[1] == 3);
    tear_down();
}

// Adding a lamp with its material is one step, and so is replacing a lamp by a light.
TEST(lamps_come_and_go_as_one_step)
{
    REQUIRE(set_up());
    const struct scene *scene = &viewer.document.scene;
    for (int c = 0; c < 3; c++)
        viewer.document.bounds_max[c] = 2;
    REQUIRE(lamp_add(&viewer, "lights.add_area"), "%s", viewer.shell.message);
    uint32_t object = scene->instance_count + 1;
    CHECK(edit_undo_count(&viewer) == 1 && scene->shape_count == 2 && scene->material_count == 3);
    CHECK(lamp_is(scene, object) && viewer.document.chosen_object == object);
    CHECK(asked(0) == CHANGE_GEOMETRY);
    REQUIRE(light_add(&viewer, "lights.add") && scene->light_count == 2);
    const struct light light = scene->lights[1];
    REQUIRE(lamp_exchange(&viewer, object, "object.exchange"), "%s", viewer.shell.message);
    CHECK(scene->light_count == 3 && scene->shapes[1].hidden);
    for (int i = 0; i < 3; i++)
        CHECK(edit_undo(&viewer));
    CHECK(!edit_undo(&viewer) && scene->shape_count == 1 && scene->light_count == 1 &&
          scene->material_count == 2);
    for (int i = 0; i < 3; i++)
        CHECK(edit_redo(&viewer));
    CHECK(!edit_redo(&viewer) && scene->light_count == 3 && scene->shapes[1].hidden);
    CHECK(memcmp(&scene->lights[1], &light, sizeof light) == 0);
    tear_down();
}

// Both send the same light to the middle of the scene: 4 half edges^2 L / distance^2, face on.
TEST(lamps_are_as_bright_as_what_they_become)
{
    REQUIRE(set_up());
    const struct scene *scene = &viewer.document.scene;
    for (int c = 0; c < 3; c++) {
        viewer.document.bounds_min[c] = -3;
        viewer.document.bounds_max[c] = 3;
    }
    REQUIRE(light_add(&viewer, "a"));
    const struct light light = scene->lights[1];
    REQUIRE(light_exchange(&viewer, 1, "b") && scene->lights[1].hidden);
    const struct shape quad = scene->shapes[1];
    double normal[3], distance = vec3_length(quad.center);
    vec3_cross(quad.axes[0], quad.axes[1], normal);
    double irradiance =
        (double)scene->materials[2].emission[0] * 4 * vec3_length(normal) / (distance * distance);
    CHECK(fabs(irradiance - (double)light.radiant[0]) < 1e-6, "%g", irradiance);
    vec3_normalize(normal);
    CHECK(vec3_dot(normal, light.direction) > 1 - 1e-12, "its outside faces the middle");
    REQUIRE(lamp_exchange(&viewer, scene->instance_count + 1, "c"));
    CHECK(fabs((double)(scene->lights[2].radiant[0] - light.radiant[0])) < 1e-5, "%g",
          (double)scene->lights[2].radiant[0]);
    CHECK(vec3_dot(scene->lights[2].direction, light.direction) > 1 - 1e-12);
    tear_down();
}

// A texture scales the emission of the lamp by its mean, and opacity the emitting part of the
// surface.
TEST(lamps_with_textures_are_as_bright_as_their_means)
{
    static struct texture_image image = {.width = 1, .height = 1, .mean = {0.25f, 0.5f, 1, 0.125f}};
    static struct texture texture = {.flags = (uint32_t)TEXTURE_USE_SCALE << TEXTURE_USE_SHIFT |
                                              (PARAMETER_EMISSION / 4u) << TEXTURE_GROUP_SHIFT |
                                              7u << (TEXTURE_MASK_SHIFT + PARAMETER_EMISSION % 4) |
                                              (0u | 1u << 2 | 2u << 4) << TEXTURE_CHANNELS_SHIFT};
    REQUIRE(set_up());
    struct scene *scene = &viewer.document.scene;
    for (int c = 0; c < 3; c++) {
        viewer.document.bounds_min[c] = -3;
        viewer.document.bounds_max[c] = 3;
    }
    REQUIRE(lamp_add(&viewer, "a"));
    struct material *lamp = &scene->materials[2];
    uint32_t object = scene->instance_count + 1;
    REQUIRE(lamp_exchange(&viewer, object, "b"));
    const struct light plain = scene->lights[1];
    edit_visible(&viewer, object, true, "c");
    scene->textures = &texture;
    scene->images = &image;
    scene->texture_count = scene->image_count = lamp->texture_count = 1;
    lamp->opacity = 0.5f;
    lamp->flags |= MATERIAL_ALPHA_BLEND;
    REQUIRE(lamp_exchange(&viewer, object, "d"));
    for (int c = 0; c < 3; c++) {
        float ratio = scene->lights[2].radiant[c] / plain.radiant[c];
        CHECK(fabsf(ratio - 0.5f * image.mean[c]) < 1e-6f, "%d: %g", c, (double)ratio);
    }
    // An object that cannot light the scene is not a lamp.
    lamp->opacity = 0;
    CHECK(!lamp_is(scene, object));
    lamp->opacity = 1;
    CHECK(lamp_is(scene, object));
    memset(image.mean, 0, sizeof image.mean);
    CHECK(!lamp_is(scene, object) && !lamp_exchange(&viewer, object, "e"));
    scene->textures = NULL;
    scene->images = NULL;
    scene->texture_count = scene->image_count = 0;
    tear_down();
}

TEST(lights_are_added_beside_a_sun)
{
    REQUIRE(set_up());
    const struct scene *scene = &viewer.document.scene;
    struct surroundings sky = viewer.document.surroundings;
    sky.kind = SURROUNDINGS_SKY;
    REQUIRE(edit_surroundings(&viewer, &sky, "scene.kind"), "%s", viewer.shell.message);
    const struct light sun = scene->lights[1];
    REQUIRE(light_add(&viewer, "lights.add") && scene->light_count == 3);
    CHECK(memcmp(&scene->lights[2], &sun, sizeof sun) == 0 && scene_sun_light(scene) == 2);
    sky.kind = SURROUNDINGS_NONE;
    REQUIRE(edit_surroundings(&viewer, &sky, "scene.kind"));
    CHECK(scene->light_count == 2 && strcmp(scene->lights[1].name, "light") == 0);
    edit_undo(&viewer);
    CHECK(scene->light_count == 3 && memcmp(&scene->lights[2], &sun, sizeof sun) == 0);
    edit_undo(&viewer);
    CHECK(scene->light_count == 2 && memcmp(&scene->lights[1], &sun, sizeof sun) == 0);
    edit_undo(&viewer);
    CHECK(scene->light_count == 1);
    tear_down();
}

// There are more steps than the history holds: the oldest ones are discarded, and the newest can be
// undone.
TEST(histories_end)
{
    REQUIRE(set_up());
    for (int i = 1; i <= 1200; i++) {
        struct material material = rough((float)i);
        edit_material(&viewer, 1, &material, "a");
        edit_close(&viewer);
    }
    uint32_t count = edit_undo_count(&viewer);
    CHECK(count == 1000, "%u", count);
    while (edit_undo(&viewer))
        ;
    CHECK(viewer.document.scene.materials[1].roughness == 200, "%g",
          (double)viewer.document.scene.materials[1].roughness);
    tear_down();
}

TEST_MAIN(TEST_CASE(no_difference_is_no_step), TEST_CASE(undo_restores_every_bit),
          TEST_CASE(a_drag_is_one_step), TEST_CASE(a_drag_back_to_its_start_is_no_step),
          TEST_CASE(what_is_edited_after_undo_ends_redo),
          TEST_CASE(no_more_is_asked_for_than_is_needed),
          TEST_CASE(what_is_shown_keeps_what_is_accumulated),
          TEST_CASE(surroundings_come_and_go_with_the_sun),
          TEST_CASE(a_file_that_is_not_there_changes_nothing), TEST_CASE(reverting_leaves_no_trace),
          TEST_CASE(what_is_placed_comes_back), TEST_CASE(lamps_come_and_go_as_one_step),
          TEST_CASE(lamps_are_as_bright_as_what_they_become),
          TEST_CASE(lamps_with_textures_are_as_bright_as_their_means),
          TEST_CASE(lights_are_added_beside_a_sun), TEST_CASE(histories_end))
