// Objects that are moved are where their placement requires, and can be restored bit for bit.
#include "test.h"

#include "scene/core/affine.h"
#include "scene/core/environment.h"
#include "scene/core/light.h"
#include "scene/core/placement.h"

static struct scene scene;

// Makes a triangle that its instance moves and scales, and a quad: objects 0 and 1.
static bool set_up(void)
{
    static float positions[3][3] = {{0, 0, 0}, {2, 0, 0}, {0, 4, 0}};
    static const double transform[3][4] = {{0, -2, 0, 1}, {3, 0, 0, 2}, {0, 0, 1, 3}};
    struct mesh *mesh;
    struct instance *instance;
    struct shape *shape;
    memset(&scene, 0, sizeof scene);
    if (!(mesh = scene_add_mesh(&scene, NULL)) || !(instance = scene_add_instance(&scene, NULL)) ||
        !(shape = scene_add_shape(&scene, NULL)))
        return false;
    mesh->positions = positions;
    mesh->vertex_count = 3;
    memcpy(instance->transform, transform, sizeof transform);
    *shape =
        (struct shape){.kind = SHAPE_QUAD, .center = {5, 6, 7}, .axes = {{1, 0, 0}, {0, 2, 0}}};
    return true;
}

static bool is_near(const double a[3], double x, double y, double z)
{
    const double b[3] = {x, y, z};
    double difference[3];
    vec3_subtract(a, b, difference);
    return vec3_length(difference) < 1e-12;
}

TEST(an_object_has_a_middle)
{
    double middle[3];
    REQUIRE(set_up());
    scene_object_middle(&scene, 0, middle); // this is (1, 2, 0) in the mesh's space
    CHECK(is_near(middle, 1 - 4, 2 + 3, 3), "%g %g %g", middle[0], middle[1], middle[2]);
    scene_object_middle(&scene, 1, middle);
    CHECK(is_near(middle, 5, 6, 7));
    scene_finish(&scene);
}

TEST(a_mesh_is_scaled_along_its_own_axes)
{
    struct err err = {0};
    double corner[3], middle[3];
    REQUIRE(set_up());
    scene_object_middle(&scene, 0, middle);
    struct placement to = placement_none(middle);
    to.scale[0] = 2;
    to.turn_degrees[2] = 90;
    to.move[2] = 10;
    REQUIRE(scene_place(&scene, 0, &to, &err), "%s", err.msg);
    // The corner (2, 0, 0) is (1, -2, 0) relative to the middle, and (2, -2, 0) after scaling: (4,
    // 6, 0) in world space, which a quarter turn makes (-6, 4, 0).
    affine_point((const double(*)[4])scene.instances[0].transform, (const double[3]){2, 0, 0},
                 corner);
    CHECK(is_near(corner, -3 - 6, 5 + 4, 13), "%g %g %g", corner[0], corner[1], corner[2]);
    scene_object_middle(&scene, 0, middle);
    CHECK(is_near(middle, -3, 5, 13));
    scene_finish(&scene);
}

TEST(turns_go_about_x_then_y_then_z)
{
    struct err err = {0};
    REQUIRE(set_up());
    struct placement to = placement_none(scene.shapes[0].center);
    to.turn_degrees[0] = to.turn_degrees[1] = 90;
    REQUIRE(scene_place(&scene, 1, &to, &err), "%s", err.msg);
    // Rotation about x turns y into z. Rotation about y turns z into x, and x into -z.
    CHECK(is_near(scene.shapes[0].axes[0], 0, 0, -1) && is_near(scene.shapes[0].axes[1], 2, 0, 0));
    CHECK(is_near(scene.shapes[0].center, 5, 6, 7));
    scene_finish(&scene);
}

TEST(what_is_not_placed_any_more_has_its_bits)
{
    struct err err = {0};
    REQUIRE(set_up());
    const struct instance instance = scene.instances[0];
    const struct shape shape = scene.shapes[0];
    for (uint32_t object = 2; object-- > 0;) {
        struct placement to = placement_none((const double[3]){0.1, 0.2, 0.3});
        to.turn_degrees[1] = 17;
        to.scale[0] = 0.3;
        REQUIRE(scene_place(&scene, object, &to, &err), "%s", err.msg);
        to.move[0] = 0.7;
        REQUIRE(scene_place(&scene, object, &to, &err), "%s", err.msg);
    }
    CHECK(scene.placed_count == 2 && scene.placed[0].object == 0 && scene.placed[1].object == 1);
    for (uint32_t object = 0; object < 2; object++) {
        struct placement to = placement_none((const double[3]){0, 0, 0});
        REQUIRE(scene_place(&scene, object, &to, &err), "%s", err.msg);
    }
    CHECK(scene.placed_count == 0);
    CHECK(memcmp(scene.instances[0].transform, instance.transform, sizeof instance.transform) == 0);
    CHECK(memcmp(&scene.shapes[0], &shape, sizeof shape) == 0);
    scene_finish(&scene);
}

TEST(a_sphere_stays_one)
{
    struct err err = {0};
    REQUIRE(set_up());
    scene.shapes[0] = (struct shape){.kind = SHAPE_SPHERE, .radius = 3};
    struct placement to = placement_none(scene.shapes[0].center);
    to.scale[1] = 2;
    CHECK(!scene_place(&scene, 1, &to, &err) && strstr(err.msg, "along all axes"), "%s", err.msg);
    CHECK(scene.shapes[0].radius == 3 && !scene_find_placed(&scene, 1));
    to.scale[0] = to.scale[2] = 2;
    CHECK(scene_place(&scene, 1, &to, &err) && scene.shapes[0].radius == 6);
    to.move[1] = 2e13;
    CHECK(!scene_place(&scene, 1, &to, &err) && strstr(err.msg, "range of scenes"), "%s", err.msg);
    const struct placement kept = scene_placement(&scene, 1);
    CHECK(scene.shapes[0].radius == 6 && kept.scale[1] == 2 && kept.move[1] == 0);
    scene_finish(&scene);
}

TEST(lights_are_added_before_the_sun)
{
    uint32_t index = 9;
    REQUIRE(set_up());
    struct light *first = scene_add_light(&scene, NULL);
    struct light *sun = scene_add_light(&scene, NULL);
    REQUIRE(first && sun);
    sun->name = "sun";
    scene.environment.present = true;
    scene.environment.sun.light = 2;
    struct light *added = scene_insert_light(&scene, &index);
    REQUIRE(added && index == 1 && scene.light_count == 3);
    added->name = "added";
    CHECK(scene_sun_light(&scene) == 2 && strcmp(scene.lights[2].name, "sun") == 0);
    scene_take_light(&scene);
    CHECK(scene.light_count == 2 && scene_sun_light(&scene) == 1 &&
          strcmp(scene.lights[1].name, "sun") == 0);
    scene_finish(&scene);
}

TEST_MAIN(TEST_CASE(an_object_has_a_middle), TEST_CASE(a_mesh_is_scaled_along_its_own_axes),
          TEST_CASE(turns_go_about_x_then_y_then_z),
          TEST_CASE(what_is_not_placed_any_more_has_its_bits), TEST_CASE(a_sphere_stays_one),
          TEST_CASE(lights_are_added_before_the_sun))
