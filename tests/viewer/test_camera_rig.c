#include "scene/core/affine.h"
#include "test.h"
#include "viewer/core/camera_rig.h"

static struct camera looking(const double position[3], const double target[3], const double up[3])
{
    struct camera camera = {
        .kind = CAMERA_PERSPECTIVE, .fov_y = 40 * DEGREE, .height = 2.0, .focus_distance = 1.0};
    memcpy(camera.position, position, sizeof camera.position);
    memcpy(camera.up, up, sizeof camera.up);
    vec3_subtract(target, position, camera.direction);
    vec3_normalize(camera.direction);
    return camera;
}

static const double ZERO[3], UP_Y[3] = {0, 1, 0}, UP_Z[3] = {0, 0, 1};

static struct camera usual(void)
{
    return looking((const double[]){0, 0, 5}, ZERO, UP_Y);
}

static struct camera_rig camera_rig_of(const struct camera *camera)
{
    struct camera_rig rig;
    camera_rig_init(&rig, camera, (const double[]){-1, -1, -1}, (const double[]){1, 1, 1});
    return rig;
}

static double distance(const double a[3], const double b[3])
{
    double d[3];
    vec3_subtract(a, b, d);
    return vec3_length(d);
}

// Computes the place of a point in the picture, as tangents. Returns false if it is behind the
// camera.
static bool project(const struct camera *camera, const double point[3], double out[2])
{
    double right[3], up[3], way[3];
    vec3_cross(camera->direction, camera->up, right);
    vec3_normalize(right);
    vec3_cross(right, camera->direction, up);
    vec3_subtract(point, camera->position, way);
    double ahead = vec3_dot(way, camera->direction);
    out[0] = vec3_dot(way, right) / ahead;
    out[1] = vec3_dot(way, up) / ahead;
    return ahead > 0;
}

TEST(nothing_held_changes_no_bit)
{
    struct camera camera = looking((const double[]){0.3, 0.1, 7}, (const double[]){1, 2, 3}, UP_Y);
    struct camera before = camera;
    for (uint32_t mode = 0; mode < CAMERA_RIG_MODE_COUNT; mode++) {
        struct camera_rig rig = camera_rig_of(&camera);
        rig.mode = mode;
        CHECK(!camera_rig_step(&rig, &(struct camera_rig_input){.seconds = 0.1}, &camera));
        CHECK(memcmp(&camera, &before, sizeof camera) == 0);
    }
}

TEST(flying_goes_where_keys_say)
{
    struct camera camera = usual();
    struct camera_rig rig = camera_rig_of(&camera);
    rig.speed = 2.0;
    CHECK(camera_rig_step(&rig, &(struct camera_rig_input){.forward = 1, .seconds = 0.5}, &camera));
    CHECK(distance(camera.position, (const double[]){0, 0, 4}) < 1e-12);
    camera_rig_step(&rig, &(struct camera_rig_input){.right = 1, .seconds = 0.5}, &camera);
    CHECK(distance(camera.position, (const double[]){1, 0, 4}) < 1e-12);
    camera_rig_step(&rig, &(struct camera_rig_input){.up = -1, .slow = true, .seconds = 0.5},
                    &camera);
    CHECK(distance(camera.position, (const double[]){1, -0.1, 4}) < 1e-12);
    // Two keys held together are not faster than one.
    struct camera there = camera;
    camera_rig_step(&rig, &(struct camera_rig_input){.forward = 1, .right = 1, .seconds = 0.5},
                    &there);
    CHECK(fabs(distance(camera.position, there.position) - 1.0) < 1e-12);
}

TEST(looking_follows_the_mouse)
{
    struct camera camera = usual();
    struct camera_rig rig = camera_rig_of(&camera);
    camera_rig_step(&rig, &(struct camera_rig_input){.look = {30 / rig.look_degrees, 0}}, &camera);
    CHECK(fabs(camera.direction[0] - sin(30 * DEGREE)) < 1e-12, "to the right");
    camera_rig_step(&rig, &(struct camera_rig_input){.look = {0, 20 / rig.look_degrees}}, &camera);
    CHECK(fabs(camera.direction[1] + sin(20 * DEGREE)) < 1e-12, "downwards");
    CHECK(memcmp(camera.up, UP_Y, sizeof UP_Y) == 0, "without roll, up is the axis itself");
    CHECK(fabs(vec3_length(camera.direction) - 1) < 1e-15);
}

TEST(a_drag_across_the_window_orbits_by_half_a_turn)
{
    struct camera camera = usual();
    struct camera_rig rig = camera_rig_of(&camera);
    rig.mode = CAMERA_RIG_ORBIT;
    memset(rig.target, 0, sizeof rig.target);
    for (int i = 0; i < 10; i++)
        camera_rig_step(&rig, &(struct camera_rig_input){.look = {128, 0}, .window_width = 1280},
                        &camera);
    CHECK(distance(camera.position, (const double[]){0, 0, -5}) < 1e-12, "%g %g",
          camera.position[0], camera.position[2]);
    rig.mode = CAMERA_RIG_FLY;
    struct camera before = camera;
    camera_rig_step(&rig, &(struct camera_rig_input){.look = {10, 0}, .window_width = 1280},
                    &camera);
    CHECK(fabs(vec3_dot(before.direction, camera.direction) - cos(10 * rig.look_degrees * DEGREE)) <
              1e-12,
          "the window's width matters to orbits alone");
}

TEST(pitch_never_flips)
{
    for (uint32_t mode = 0; mode < CAMERA_RIG_MODE_COUNT; mode++)
        for (int sign = -1; sign <= 1; sign += 2) {
            struct camera camera = usual();
            struct camera_rig rig = camera_rig_of(&camera);
            rig.mode = mode;
            for (int i = 0; i < 100; i++) {
                struct camera before = camera;
                camera_rig_step(&rig, &(struct camera_rig_input){.look = {3, sign * 47.0}},
                                &camera);
                double right[3], old[3];
                vec3_cross(camera.direction, rig.up, right);
                vec3_cross(before.direction, rig.up, old);
                CHECK(vec3_length(right) > 5e-4, "at the pole: %g", vec3_length(right));
                vec3_normalize(right);
                vec3_normalize(old);
                CHECK(vec3_dot(right, old) > 0.99, "flipped");
            }
            CHECK(fabs(camera.direction[1]) > 0.999, "reaches the pole: %g", camera.direction[1]);
        }
}

TEST(orbits_keep_the_target_in_its_place)
{
    struct camera camera = looking((const double[]){2, 1, 5}, (const double[]){0.3, 0.2, 0}, UP_Y);
    struct camera_rig rig = camera_rig_of(&camera);
    rig.mode = CAMERA_RIG_ORBIT;
    memset(rig.target, 0, sizeof rig.target); // the target is not in the middle of the picture
    double before[2], after[2], way = distance(camera.position, rig.target);
    project(&camera, rig.target, before);
    for (int i = 0; i < 500; i++)
        camera_rig_step(&rig, &(struct camera_rig_input){.look = {7, i % 11 - 5.0}}, &camera);
    CHECK(project(&camera, rig.target, after));
    CHECK(fabs(before[0] - after[0]) < 1e-9 && fabs(before[1] - after[1]) < 1e-9, "%g %g",
          before[0] - after[0], before[1] - after[1]);
    CHECK(fabs(distance(camera.position, rig.target) - way) < 1e-9);
}

TEST(revolving_takes_its_time)
{
    struct camera camera = usual();
    struct camera_rig rig = camera_rig_of(&camera);
    rig.mode = CAMERA_RIG_ORBIT;
    rig.revolves = true;
    rig.revolve_speed = 90;
    memset(rig.target, 0, sizeof rig.target);
    for (int i = 0; i < 40; i++) // a full turn in four seconds
        CHECK(camera_rig_step(&rig, &(struct camera_rig_input){.seconds = 0.1}, &camera));
    CHECK(distance(camera.position, (const double[]){0, 0, 5}) < 1e-9);
    rig.revolves = false;
    CHECK(!camera_rig_step(&rig, &(struct camera_rig_input){.seconds = 0.1}, &camera));
}

// The key changes the speed by 45 degrees per second each second, up to 360. The camera stays on
// its circle.
TEST(keys_say_how_fast_it_revolves)
{
    struct camera camera = usual();
    struct camera_rig rig = camera_rig_of(&camera);
    rig.mode = CAMERA_RIG_ORBIT;
    rig.revolves = true;
    rig.revolve_speed = 10;
    memset(rig.target, 0, sizeof rig.target);
    for (int i = 0; i < 20; i++)
        camera_rig_step(&rig, &(struct camera_rig_input){.right = 1, .seconds = 0.1}, &camera);
    CHECK(fabs(rig.revolve_speed - 100) < 1e-9, "%g", rig.revolve_speed);
    CHECK(fabs(distance(camera.position, rig.target) - 5) < 1e-9);
    for (int i = 0; i < 200; i++)
        camera_rig_step(&rig, &(struct camera_rig_input){.right = -1, .seconds = 0.1}, &camera);
    CHECK(rig.revolve_speed == -360, "%g", rig.revolve_speed);
    rig.revolves = false;
    camera_rig_step(&rig, &(struct camera_rig_input){.right = 1, .seconds = 0.1}, &camera);
    CHECK(rig.revolve_speed == -360 && distance(camera.position, rig.target) > 0, "now it flies");
}

TEST(dolly_goes_to_the_target_and_never_through)
{
    struct camera camera = usual();
    struct camera_rig rig = camera_rig_of(&camera);
    rig.mode = CAMERA_RIG_ORBIT;
    memset(rig.target, 0, sizeof rig.target);
    camera_rig_step(&rig, &(struct camera_rig_input){.dolly = 1}, &camera);
    CHECK(fabs(camera.position[2] - 4.5) < 1e-12, "%g", camera.position[2]);
    camera_rig_step(&rig, &(struct camera_rig_input){.dolly = 100}, &camera);
    CHECK(camera.position[2] > 0 && camera.position[2] < 1e-3, "%g", camera.position[2]);
    camera = usual();
    camera.kind = CAMERA_ORTHOGRAPHIC;
    camera_rig_step(&rig, &(struct camera_rig_input){.dolly = 1}, &camera);
    CHECK(fabs(camera.height - 1.8) < 1e-12, "%g", camera.height);
    CHECK(camera.position[2] == 5.0, "%g", camera.position[2]);
}

TEST(panning_takes_the_target_along_with_the_mouse)
{
    struct camera camera = usual();
    struct camera_rig rig = camera_rig_of(&camera);
    memset(rig.target, 0, sizeof rig.target);
    double at[2];
    const struct camera_rig_input input = {.pan = {90, 45}, .picture_height = 360};
    camera_rig_step(&rig, &input, &camera);
    project(&camera, ZERO, at);
    double pixel = 2 * tan(0.5 * camera.fov_y) / 360;
    CHECK(fabs(at[0] / pixel - 90) < 1e-9, "%g", at[0] / pixel);
    CHECK(fabs(at[1] / pixel + 45) < 1e-9, "%g", at[1] / pixel);
}

TEST(up_axes_stay)
{
    struct camera camera = looking((const double[]){4, -4, 2}, ZERO, UP_Z);
    struct camera_rig rig = camera_rig_of(&camera);
    CHECK(rig.up[2] == 1 && rig.up[0] == 0 && rig.up[1] == 0);
    double height = camera.direction[2];
    camera_rig_step(&rig, &(struct camera_rig_input){.look = {200, 0}}, &camera);
    CHECK(fabs(camera.direction[2] - height) < 1e-12);
    camera = looking((const double[]){0, 0, 5}, ZERO, (const double[]){0.1, -1, 0});
    rig = camera_rig_of(&camera);
    CHECK(rig.up[1] == -1, "upside down stays so");
}

TEST(roll_is_kept)
{
    double tilt = 10 * DEGREE, right[3];
    struct camera camera =
        looking((const double[]){0, 0, 5}, ZERO, (const double[]){sin(tilt), cos(tilt), 0});
    struct camera_rig rig = camera_rig_of(&camera);
    for (int i = 0; i < 50; i++)
        camera_rig_step(&rig, &(struct camera_rig_input){.look = {5, 0}}, &camera);
    vec3_cross(camera.direction, camera.up, right);
    vec3_normalize(right);
    CHECK(fabs(vec3_dot(right, rig.up) + sin(tilt)) < 1e-9, "%g", vec3_dot(right, rig.up));
}

// The view of a scene must not depend on its size, or on its distance from the origin.
static void check_scale(double scale, const double offset[3])
{
    double position[3], target[3], min[3], max[3], seen[2];
    for (int c = 0; c < 3; c++) {
        target[c] = offset[c];
        position[c] = offset[c] + scale * (c == 2 ? 5 : 1);
        min[c] = offset[c] - scale;
        max[c] = offset[c] + scale;
    }
    struct camera camera = looking(position, target, UP_Y);
    struct camera_rig rig;
    camera_rig_init(&rig, &camera, min, max);
    CHECK(rig.speed > 0.1 * scale && rig.speed < 10 * scale, "%g: speed %g", scale, rig.speed);
    rig.mode = CAMERA_RIG_ORBIT;
    memcpy(rig.target, target, sizeof target);
    double way = distance(camera.position, target);
    for (int i = 0; i < 300; i++)
        camera_rig_step(&rig, &(struct camera_rig_input){.look = {11, i % 7 - 3.0}}, &camera);
    double roundings = 300 * 0x1p-50 * (vec3_length(offset) + scale);
    CHECK(fabs(distance(camera.position, target) - way) <= roundings, "%g: %g", scale,
          distance(camera.position, target) - way);
    camera_rig_frame(&rig, min, max, 16.0 / 9, &camera);
    for (int corner = 0; corner < 8; corner++) {
        double point[3];
        for (int c = 0; c < 3; c++)
            point[c] = corner >> c & 1 ? max[c] : min[c];
        CHECK(project(&camera, point, seen));
        CHECK(fabs(seen[1]) <= tan(0.5 * camera.fov_y) * 1.0001, "%g: %g", scale, seen[1]);
    }
}

TEST(sizes_and_places_do_not_matter)
{
    check_scale(1, ZERO);
    check_scale(1e6, ZERO);
    check_scale(1e-6, ZERO);
    check_scale(1, (const double[]){1e6, -1e6, 1e6});
    check_scale(1e12, ZERO);
}

TEST(framing_fits_the_narrow_side)
{
    struct camera camera = usual();
    struct camera_rig rig = camera_rig_of(&camera);
    const double min[] = {-1, -1, -1}, max[] = {1, 1, 1};
    double at[2];
    camera_rig_frame(&rig, min, max, 0.5, &camera);
    project(&camera, (const double[]){1, 0, 0}, at);
    CHECK(fabs(at[0]) < 0.5 * tan(0.5 * camera.fov_y), "%g", at[0]);
    camera.kind = CAMERA_ORTHOGRAPHIC;
    camera_rig_frame(&rig, min, max, 0.5, &camera);
    CHECK(fabs(camera.height - 4 * sqrt(3)) < 1e-12, "%g", camera.height);
}

TEST(focus_is_along_the_direction)
{
    struct camera camera = usual();
    struct camera_rig rig = camera_rig_of(&camera);
    const double point[] = {3, 0, 1};
    camera_rig_focus(&rig, point, &camera);
    CHECK(camera.focus_distance == 1.0, "a pinhole has none");
    CHECK(memcmp(rig.target, point, sizeof point) == 0);
    camera.lens_radius = 0.01;
    camera_rig_focus(&rig, point, &camera);
    CHECK(fabs(camera.focus_distance - 4.0) < 1e-12, "%g", camera.focus_distance);
}

TEST(empty_scenes_can_be_flown_through)
{
    struct camera camera = usual();
    struct camera_rig rig;
    camera_rig_init(&rig, &camera, (const double[]){1, 1, 1}, (const double[]){-1, -1, -1});
    CHECK(rig.speed > 0 && isfinite(rig.speed));
    struct camera before = camera;
    camera_rig_frame(&rig, (const double[]){1, 1, 1}, (const double[]){1, 1, 1}, 1, &camera);
    CHECK(memcmp(&before, &camera, sizeof camera) == 0);
}

TEST_MAIN(TEST_CASE(nothing_held_changes_no_bit), TEST_CASE(flying_goes_where_keys_say),
          TEST_CASE(looking_follows_the_mouse),
          TEST_CASE(a_drag_across_the_window_orbits_by_half_a_turn), TEST_CASE(pitch_never_flips),
          TEST_CASE(orbits_keep_the_target_in_its_place), TEST_CASE(revolving_takes_its_time),
          TEST_CASE(keys_say_how_fast_it_revolves),
          TEST_CASE(dolly_goes_to_the_target_and_never_through),
          TEST_CASE(panning_takes_the_target_along_with_the_mouse), TEST_CASE(up_axes_stay),
          TEST_CASE(roll_is_kept), TEST_CASE(sizes_and_places_do_not_matter),
          TEST_CASE(framing_fits_the_narrow_side), TEST_CASE(focus_is_along_the_direction),
          TEST_CASE(empty_scenes_can_be_flown_through))
